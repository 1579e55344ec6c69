"""Farm files of every format as features: GeoJSON by hand, tables in `tables`, all others through GDAL.

GeoJSON is parsed here, so that faults name their place in the file and the heavy packages stay unloaded. Anything else
that GDAL reads (KML, KMZ, Shapefile, GeoPackage, FlatGeobuf, ...) comes through pyogrio, imported only then.
"""

from __future__ import annotations

import json
import math
import re
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Geometry, Positions, Source, number_of, text_of
from pondhop.farm.tables import read_table
from pondhop.places import LonLat

if TYPE_CHECKING:
    import pyproj

FORMATS = "GeoJSON, KML, KMZ, Shapefile, GeoPackage, or CSV with columns lon and lat"


def read_source(path: Path) -> Source:
    """Read a farm file of any format.

    Parameters
    ----------
    path
        ``.geojson`` and ``.json`` are GeoJSON; ``.csv``, ``.tsv`` and ``.txt`` are tables; the rest is left to GDAL.

    Returns
    -------
    Source
        Features in WGS84 with the faults and notes of reading; a file that cannot be read has a fault and no feature.
    """
    source = Source(name=path.stem)
    suffix = path.suffix.lower()
    try:
        if not path.exists():
            source.faults.append(Fault(str(path), "there is no such file", "check the spelling and the folder"))
        elif path.is_dir() and suffix != ".gdb":
            source.faults.append(Fault(str(path), "this is a folder", f"name the file in it: {FORMATS}"))
        elif path.is_file() and path.stat().st_size == 0:
            source.faults.append(Fault(str(path), "the file is empty", "export the farm again"))
        elif suffix in {".geojson", ".json"}:
            _read_text(path, _read_geojson, source)
        elif suffix in {".csv", ".tsv", ".txt"}:
            _read_text(path, read_table, source)
        else:
            _read_gis(path, source)
    except OSError as error:
        source.faults.append(Fault(str(path), f"cannot be read: {error.strerror}", "check the file's permissions"))
    return source


def _read_text(path: Path, read: Callable[[str, Source], None], source: Source) -> None:
    text = _decode(path.read_bytes(), source)
    if re.search(r"[\x00-\x08\x0e-\x1f]", text[:10_000]):
        source.faults.append(Fault(str(path), "this is no text", f"name a file of {FORMATS}, by its usual ending"))
    else:
        read(text, source)


def _decode(content: bytes, source: Source) -> str:
    """Text of a file: UTF-8 with or without a byte order mark, UTF-16 with one, else Windows Latin with a note."""
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        source.notes.append("The file is not UTF-8; it was read as Windows Latin (cp1252).")
        return content.decode("cp1252", errors="replace")


def _read_geojson(text: str, source: Source) -> None:
    try:
        document = json.loads(text)
    except json.JSONDecodeError as error:
        at_end = error.pos >= len(text.rstrip())
        message = "the file ends too early" if at_end else f"this is no JSON: {error.msg}"
        action = "the file looks cut off: export or copy it again" if at_end else "export the farm again as GeoJSON"
        source.faults.append(Fault(f"line {error.lineno}, column {error.colno}", message, action))
        return
    except (ValueError, RecursionError) as error:
        message = "nested too deeply" if isinstance(error, RecursionError) else "holds a number of thousands of digits"
        source.faults.append(Fault("file", f"the JSON {message}", "export the farm again as GeoJSON"))
        return
    features = _feature_list(document, source)
    if isinstance(document, dict) and isinstance(document.get("name"), str) and document["name"].strip():
        source.name = document["name"].strip()
    for place, feature in features:
        _read_geojson_feature(place, feature, source)
    if isinstance(document, dict) and document.get("crs") is not None:
        _apply_geojson_crs(document["crs"], source)


def _feature_list(document: object, source: Source) -> list[tuple[str, object]]:
    """The features of a document with their places; a bare feature or geometry is a collection of one."""
    kind = document.get("type") if isinstance(document, dict) else None
    if isinstance(document, dict) and kind == "FeatureCollection":
        features = document.get("features")
        if isinstance(features, list):
            return [(f"features[{index}]", feature) for index, feature in enumerate(features)]
        source.faults.append(Fault("features", "the list of features is missing", "export the farm again as GeoJSON"))
    elif kind == "Feature":
        return [("feature", document)]
    elif isinstance(kind, str) and kind in {*_DEPTHS, "GeometryCollection"}:
        return [("feature", {"type": "Feature", "geometry": document})]
    else:
        found = f"a JSON {_json_name(document)}" + (f" of type {kind!r}" if kind is not None else "")
        action = 'the file must be {"type": "FeatureCollection", "features": [...]}'
        source.faults.append(Fault("file", f"{found} is no GeoJSON", action))
    return []


def _read_geojson_feature(place: str, feature: object, source: Source) -> None:
    action = 'write {"type": "Feature", "properties": {...}, "geometry": {...}}'
    if not isinstance(feature, dict) or feature.get("type") != "Feature":
        source.faults.append(Fault(place, f"{_shown(feature)} is no Feature", action))
        return
    properties = feature.get("properties")
    if properties is not None and not isinstance(properties, dict):
        source.faults.append(Fault(f"{place}.properties", f"{_shown(properties)} is no object", action))
    own_id = feature.get("id")
    geometry = Geometry()
    num_faults = len(source.faults)
    if feature.get("geometry") is not None:
        _read_geojson_geometry(f"{place}.geometry", feature["geometry"], geometry, source.faults)
    if len(source.faults) > num_faults:
        return
    source.features.append(
        Feature(
            place,
            f"{place}.properties.{{}}",
            properties if isinstance(properties, dict) else {},
            geometry,
            own_id=text_of(own_id) if isinstance(own_id, str | int | float) else None,
        )
    )


_DEPTHS = {"Point": 0, "MultiPoint": 1, "LineString": 1, "MultiLineString": 2, "Polygon": 2, "MultiPolygon": 3}
"""How many lists enclose a position of each kind of GeoJSON geometry (RFC 7946, section 3.1)."""


def _read_geojson_geometry(place: str, value: object, geometry: Geometry, faults: list[Fault]) -> None:
    kind = value.get("type") if isinstance(value, dict) else None
    if isinstance(value, dict) and kind == "GeometryCollection" and isinstance(value.get("geometries"), list):
        # Collections within collections are forbidden in spirit (RFC 7946, 3.1.8) and would recurse without end.
        for index, part in enumerate(value["geometries"]):
            if isinstance(part, dict) and part.get("type") in _DEPTHS:
                _read_geojson_geometry(f"{place}.geometries[{index}]", part, geometry, faults)
            else:
                message = f"{_shown(part)} is no geometry"
                faults.append(Fault(f"{place}.geometries[{index}]", message, "use a Polygon or a Point"))
        return
    if not isinstance(value, dict) or not isinstance(kind, str) or kind not in _DEPTHS:
        faults.append(Fault(place, f"{_shown(kind or value)} is no geometry", "use a Polygon or a Point"))
        return
    coordinates = _positions(f"{place}.coordinates", value.get("coordinates"), _DEPTHS[kind], faults)
    if coordinates is None:
        return
    match kind:
        case "Point":
            geometry.points.append(coordinates)
        case "MultiPoint":
            geometry.points.extend(coordinates)
        case "LineString":
            geometry.lines.append(coordinates)
        case "MultiLineString":
            geometry.lines.extend(coordinates)
        case "Polygon":
            geometry.polygons.append(coordinates)
        case _:
            geometry.polygons.extend(coordinates)


def _positions(place: str, value: Any, depth: int, faults: list[Fault]) -> Any:
    """Nested lists of positions as they stand, numbers made floats; ``None`` and a fault each where one is wrong."""
    if depth > 0:
        if not isinstance(value, list) or not value:
            action = "give a list of positions [longitude, latitude]"
            faults.append(Fault(place, f"{_shown(value)} is no list of positions", action))
            return None
        # Places are worked out only where something is wrong: large files hold millions of positions.
        if depth == 1 and all(map(_is_position, value)):
            return [(float(position[0]), float(position[1])) for position in value]
        parts = [_positions(f"{place}[{index}]", part, depth - 1, faults) for index, part in enumerate(value)]
        return None if any(part is None for part in parts) else parts
    if not isinstance(value, list) or len(value) < 2:
        faults.append(Fault(place, f"{_shown(value)} is no position", "write [longitude, latitude]"))
        return None
    numbers = [None if isinstance(number, str) else number_of(number) for number in value[:2]]
    for index, number in enumerate(numbers):
        if number is None:
            name = ("longitude", "latitude")[index]
            action = f"write the {name} as a number in degrees"
            faults.append(Fault(f"{place}[{index}]", f"{_shown(value[index])} is no number", action))
    return None if None in numbers else (numbers[0], numbers[1])


def _is_position(value: object) -> bool:
    return (
        isinstance(value, list)
        and len(value) >= 2
        and isinstance(value[0], float)
        and isinstance(value[1], float)
        and math.isfinite(value[0])
        and math.isfinite(value[1])
    )


def _json_name(value: object) -> str:
    names = {dict: "object", list: "list", str: "text", bool: "truth value", int: "number", float: "number"}
    return names.get(type(value), "null")


def _shown(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 40 else f"{text[:37]}..."


def _apply_geojson_crs(crs: object, source: Source) -> None:
    """The ``crs`` member of GeoJSON before RFC 7946, which many programs still write."""
    properties = crs.get("properties") if isinstance(crs, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    if not isinstance(name, str):
        action = "remove it if the coordinates are WGS84, or name an EPSG code"
        source.faults.append(Fault("crs", f"{_shown(crs)} names no coordinate system", action))
    elif not name.upper().endswith((":CRS84", "EPSG::4326", "EPSG:4326")):
        _reproject(name, "crs", source.features, source)


def _reproject(crs_name: str, place: str, features: list[Feature], source: Source) -> None:
    """Bring features into WGS84, longitude first, with a note."""
    import pyproj

    try:
        crs = pyproj.CRS.from_user_input(crs_name)
        if crs.is_geographic and crs.name in {"WGS 84", "WGS 84 (CRS84)"}:
            return
        transformer = pyproj.Transformer.from_crs(crs, "EPSG:4326", always_xy=True)
    except pyproj.exceptions.ProjError:
        action = "export the file in WGS84 (EPSG:4326)"
        source.faults.append(Fault(place, f"the coordinate system {_shown(crs_name)} is unknown", action))
        return
    for feature in features:
        geometry = feature.geometry
        feature.geometry = Geometry(
            _transformed(geometry.points, transformer),
            [_transformed(line, transformer) for line in geometry.lines],
            [[_transformed(ring, transformer) for ring in polygon] for polygon in geometry.polygons],
        )
        if not all(math.isfinite(lon) and math.isfinite(lat) for lon, lat in feature.geometry.positions()):
            message = f"the coordinates lie outside {crs.name}"
            source.faults.append(Fault(feature.place, message, "check the coordinate system of the file"))
            feature.geometry = Geometry()
    source.notes.append(f"Coordinates were converted from {crs.name} to WGS84.")


def _transformed(positions: Positions, transformer: pyproj.Transformer) -> Positions:
    if not positions:
        return []
    xs, ys = zip(*positions, strict=True)
    lons, lats = transformer.transform(xs, ys)
    return list(zip(map(float, lons), map(float, lats), strict=True))


def _read_gis(path: Path, source: Source) -> None:
    """Any format of GDAL, all layers with geometry; GDAL's own warnings become notes."""
    import pyogrio

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            layers = [str(name) for name, kind in pyogrio.list_layers(path) if kind is not None]
            for layer in layers:
                _read_layer(path, layer, len(layers) > 1, source)
        except (pyogrio.errors.DataSourceError, pyogrio.errors.DataLayerError) as error:
            detail = str(error).partition(";")[0]
            action = f"export the farm as {FORMATS}"
            source.faults.append(Fault(str(path), f"not a file of a known format: {detail}", action))
        except (pyogrio.errors.FeatureError, pyogrio.errors.GeometryError, RuntimeError) as error:
            source.faults.append(Fault(str(path), f"damaged: {error}", "export the farm again"))
    source.notes.extend(dict.fromkeys(f"While reading: {warning.message}" for warning in caught))


def _read_layer(path: Path, layer: str, has_siblings: bool, source: Source) -> None:
    import pyogrio
    import shapely

    read: Callable[..., Any] = pyogrio.raw.read
    options = {"layer": layer, "return_fids": True, "force_2d": True}
    try:
        meta, fids, wkbs, columns = read(path, **options)
    except UnicodeDecodeError:
        meta, fids, wkbs, columns = read(path, **options, encoding="cp1252")
        source.notes.append("Attributes are not in the encoding that the file names; read as Windows Latin (cp1252).")
    names = [str(name) for name in meta["fields"]]
    prefix = f"layer {layer!r}, feature " if has_siblings else "feature "
    features = []
    for row, shape in enumerate(shapely.from_wkb(wkbs, on_invalid="ignore")):
        values = {name: _scalar(column[row]) for name, column in zip(names, columns, strict=True)}
        geometry = Geometry()
        place = f"{prefix}{fids[row]}"
        if shape is not None and not shape.is_empty:
            _add_shape(shape, geometry)
        if not all(math.isfinite(lon) and math.isfinite(lat) for lon, lat in geometry.positions()):
            source.faults.append(Fault(place, "a coordinate is NaN or infinite", "draw the feature again"))
            continue
        features.append(Feature(place, f"{place}, field {{}}", values, geometry, layer=layer))
    source.features.extend(features)
    if meta["crs"] is not None:
        _reproject(meta["crs"], f"layer {layer!r}", features, source)
    elif features:
        source.notes.append("The file names no coordinate system; WGS84 (EPSG:4326) is assumed.")


def _scalar(value: Any) -> object:
    """A plain Python value; GDAL's missing numbers are NaN."""
    plain = value.tolist() if hasattr(value, "tolist") else value
    return None if isinstance(plain, float) and math.isnan(plain) else plain


def _add_shape(shape: Any, geometry: Geometry) -> None:
    """Sort a shapely geometry's parts by what they draw."""
    for part in _single_parts(shape):
        match part.geom_type:
            case "Point":
                geometry.points.append((part.x, part.y))
            case "Polygon":
                geometry.polygons.append([_lonlats(ring) for ring in (part.exterior, *part.interiors)])
            case _:
                geometry.lines.append(_lonlats(part))


def _single_parts(shape: Any) -> Iterator[Any]:
    if not hasattr(shape, "geoms"):
        yield shape
        return
    for part in shape.geoms:
        yield from _single_parts(part)


def _lonlats(line: Any) -> list[LonLat]:
    return [(float(position[0]), float(position[1])) for position in line.coords]
