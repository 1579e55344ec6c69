"""GeoJSON as features; parsed here, so that faults name their place and heavy packages stay unloaded."""

from __future__ import annotations

import itertools
import json
import math
import re
import sys
from collections.abc import Iterable, Iterator
from typing import Any

from pondhop.errors import Fault
from pondhop.farm.esri_json import is_esri_json, read_esri_json
from pondhop.farm.features import Feature, Geometry, Source, number_of, text_of
from pondhop.farm.json_values import Features, json_fault, json_name, parse_json, shown
from pondhop.farm.projections import reproject
from pondhop.farm.topojson import read_topojson


def read_json(text: str, source: Source) -> None:
    """Read GeoJSON, or the JSON of ArcGIS or TopoJSON, into features."""
    if not text.lstrip().startswith(("{", "[")) and text.lstrip()[:1] == "\x1e":
        text = text.replace("\x1e", "")
    document: Any = _parse_lines(text) or parse_json(text, source)
    if source.faults:
        return
    try:
        if is_esri_json(document):
            read_esri_json(document, source)
            return
    except (ValueError, RecursionError) as error:
        source.faults.append(json_fault(text, error))
        return
    if isinstance(document, dict) and document.get("type") == "Topology" and {"objects", "arcs"} <= document.keys():
        read_topojson(document, source)
        return
    try:
        for place, feature in _feature_list(document, source):
            _read_feature(place, feature, source)
    except (ValueError, RecursionError) as error:
        source.faults.append(json_fault(text, error))
        return
    if isinstance(document, dict) and isinstance(document.get("name"), str) and document["name"].strip():
        source.name = document["name"].strip()
    if isinstance(document, dict) and document.get("crs") is not None:
        _apply_crs(document["crs"], source)


def _parse_lines(text: str) -> object | None:
    """A document of one feature a line, as GeoJSON text sequences are; ``None`` where the text is none."""
    if not re.match(r"\s*\{[^\n]*\}\s*\n\s*\{", text):
        return None
    try:
        features = [json.loads(line) for line in text.splitlines() if line.strip()]
    except (ValueError, RecursionError):
        return None
    is_sequence = all(isinstance(feature, dict) and feature.get("type") == "Feature" for feature in features)
    return {"type": "FeatureCollection", "features": features} if is_sequence else None


def _feature_list(document: object, source: Source) -> Iterator[tuple[str, object]]:
    """The features of a document with their places; a bare feature or geometry is a collection of one."""
    kind = document.get("type") if isinstance(document, dict) else None
    if isinstance(document, dict) and kind == "FeatureCollection":
        features = document.get("features")
        if isinstance(features, list | Features):
            values: Iterable[object] = features
            for index, feature in enumerate(values):
                yield f"features[{index}]", feature
            return
        source.faults.append(Fault("features", "the list of features is missing", "export the farm again as GeoJSON"))
    elif kind == "Feature":
        yield "feature", document
    elif isinstance(kind, str) and kind in {*_DEPTHS, "GeometryCollection"}:
        yield "feature", {"type": "Feature", "geometry": document}
    else:
        found = f"a JSON {json_name(document)}" + (f" of type {kind!r}" if kind is not None else "")
        action = 'the file must be {"type": "FeatureCollection", "features": [...]}'
        source.faults.append(Fault("file", f"{found} is no GeoJSON", action))


def _read_feature(place: str, feature: object, source: Source) -> None:
    action = 'write {"type": "Feature", "properties": {...}, "geometry": {...}}'
    if not isinstance(feature, dict) or feature.get("type") != "Feature":
        source.faults.append(Fault(place, f"{shown(feature)} is no Feature", action))
        return
    properties = feature.get("properties")
    if properties is not None and not isinstance(properties, dict):
        source.faults.append(Fault(f"{place}.properties", f"{shown(properties)} is no object", action))
    own_id = feature.get("id")
    geometry = Geometry()
    num_faults = len(source.faults)
    if feature.get("geometry") is not None:
        read_geometry(f"{place}.geometry", feature["geometry"], geometry, source.faults)
    if len(source.faults) > num_faults:
        return
    # Interned, because every feature of a large file brings the names of its properties along.
    kept = {sys.intern(key): value for key, value in properties.items()} if isinstance(properties, dict) else {}
    source.features.append(
        Feature(
            place,
            f"{place}.properties.{{}}",
            kept,
            geometry,
            own_id=text_of(own_id) if isinstance(own_id, str | int | float) else None,
        )
    )


_DEPTHS = {"Point": 0, "MultiPoint": 1, "LineString": 1, "MultiLineString": 2, "Polygon": 2, "MultiPolygon": 3}
"""How many lists enclose a position of each kind of GeoJSON geometry (RFC 7946, section 3.1)."""


def read_geometry(place: str, value: object, geometry: Geometry, faults: list[Fault]) -> None:
    """Add a GeoJSON geometry's positions to `geometry`, or faults with their places."""
    kind = value.get("type") if isinstance(value, dict) else None
    if isinstance(value, dict) and kind == "GeometryCollection" and isinstance(value.get("geometries"), list):
        # Collections within collections are forbidden in spirit (RFC 7946, 3.1.8) and would recurse without end.
        for index, part in enumerate(value["geometries"]):
            if isinstance(part, dict) and isinstance(part.get("type"), str) and part["type"] in _DEPTHS:
                read_geometry(f"{place}.geometries[{index}]", part, geometry, faults)
            else:
                message = f"{shown(part)} is no geometry"
                faults.append(Fault(f"{place}.geometries[{index}]", message, "use a Polygon or a Point"))
        return
    if not isinstance(value, dict) or not isinstance(kind, str) or kind not in _DEPTHS:
        faults.append(Fault(place, f"{shown(kind or value)} is no geometry", "use a Polygon or a Point"))
        return
    if value.get("coordinates") == []:
        # Nothing drawn, as RFC 7946 (3.1) has it.
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
            faults.append(Fault(place, f"{shown(value)} is no list of positions", action))
            return None
        # Places are worked out only where something is wrong: large files hold millions of positions.
        if depth == 1 and _are_positions(value):
            return [(position[0], position[1]) for position in value]
        parts = [_positions(f"{place}[{index}]", part, depth - 1, faults) for index, part in enumerate(value)]
        return None if any(part is None for part in parts) else parts
    if not isinstance(value, list) or len(value) < 2:
        faults.append(Fault(place, f"{shown(value)} is no position", "write [longitude, latitude]"))
        return None
    numbers = [None if isinstance(number, str) else number_of(number) for number in value[:2]]
    for index, number in enumerate(numbers):
        if number is None:
            name = ("longitude", "latitude")[index]
            action = f"write the {name} as a number in degrees"
            faults.append(Fault(f"{place}[{index}]", f"{shown(value[index])} is no number", action))
    return None if None in numbers else (numbers[0], numbers[1])


def _are_positions(values: list[Any]) -> bool:
    """Whether a list holds nothing but finite positions, all numbers with a decimal point."""
    if set(map(type, values)) != {list} or min(map(len, values)) < 2:
        return False
    if set(map(type, itertools.chain.from_iterable(values))) != {float}:
        return False
    # One that is not finite makes the sum so.
    return math.isfinite(sum(itertools.chain.from_iterable(values)))


def _apply_crs(crs: object, source: Source) -> None:
    """The ``crs`` member of GeoJSON before RFC 7946, which many programs still write."""
    properties = crs.get("properties") if isinstance(crs, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    if not isinstance(name, str):
        action = "remove it if the coordinates are WGS84, or name an EPSG code"
        source.faults.append(Fault("crs", f"{shown(crs)} names no coordinate system", action))
    elif not name.upper().endswith((":CRS84", "EPSG::4326", "EPSG:4326")):
        reproject(name, "crs", source.features, source)
