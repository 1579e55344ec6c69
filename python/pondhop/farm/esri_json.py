"""The JSON of ArcGIS as features: feature sets (its REST interface, "Features To JSON"), and maps that hold some."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Geometry, Positions, Source, listed, number_of
from pondhop.farm.json_values import Features, shown
from pondhop.farm.projections import reproject
from pondhop.farm.rings import polygons_from_rings, signed_area

_WEB_MERCATOR = {102100: 3857, 102113: 3857}
"""Numbers that Esri gave to systems before EPSG did."""


def is_esri_json(document: object) -> bool:
    """Whether a document is a feature set of ArcGIS, or holds layers of such."""
    return _is_feature_set(document) or _is_map(document)


def _is_map(document: object) -> bool:
    """Whether a document is a web map, a collection of layers, or one of its layers."""
    if not isinstance(document, dict) or "type" in document:
        return False
    layers = document.get("layers")
    is_collection = isinstance(layers, list) and any(
        isinstance(layer, dict) and "featureSet" in layer for layer in layers
    )
    return "operationalLayers" in document or is_collection or "featureSet" in document


def _is_feature_set(document: object) -> bool:
    if (
        not isinstance(document, dict)
        or "type" in document
        or not isinstance(document.get("features"), list | Features)
    ):
        return False
    if "geometryType" in document or "spatialReference" in document:
        return True
    first = next(iter(document["features"]), None)
    return isinstance(first, dict) and "attributes" in first


def read_esri_json(document: dict[str, Any], source: Source) -> None:
    """Read a feature set, or those of a map, into features, in WGS84."""
    if _is_feature_set(document):
        _read_feature_set(document, "", (), source)
        return
    linked: list[str] = []
    sets = list(_feature_sets(document, "layer", linked))
    source.layers.extend(dict.fromkeys(name for name, _ in sets))
    for name, feature_set in sets:
        _read_feature_set(feature_set, f"layer {name!r}, ", (name,), source)
    if linked and sets:
        source.notes.add(f"Left out, because the map only links to them: layers {listed(map(repr, linked))}.")
    elif linked:
        message = (
            f"the map only links to its layers on a server ({listed(map(repr, linked))}), and holds none of their ponds"
        )
        action = "open the layer itself in ArcGIS, and export it as GeoJSON, shapefile or file geodatabase"
        source.faults.append(Fault("file", message, action))
    elif not sets:
        source.faults.append(Fault("file", "the map holds no layer with features", "export the layer of the ponds"))


def _feature_sets(layer: dict[str, Any], name: str, linked: list[str]) -> Iterator[tuple[str, dict[str, Any]]]:
    """The feature sets of a map or layer, with the names of their layers; names of mere links go into `linked`."""
    definition = layer.get("layerDefinition")
    titles = (layer.get("title"), layer.get("name"), definition.get("name") if isinstance(definition, dict) else None)
    name = next((title for title in titles if isinstance(title, str) and title.strip()), name)
    feature_set = layer.get("featureSet")
    if isinstance(feature_set, dict) and _is_feature_set(feature_set):
        yield name, feature_set
    collection = layer.get("featureCollection")
    inner = [collection] if isinstance(collection, dict) else []
    for member in ("operationalLayers", "layers"):
        inner.extend(value for value in layer.get(member) or () if isinstance(value, dict))
    for value in inner:
        yield from _feature_sets(value, name, linked)
    if not inner and "featureSet" not in layer and isinstance(layer.get("url"), str):
        linked.append(name)


def _read_feature_set(document: dict[str, Any], within: str, folders: tuple[str, ...], source: Source) -> None:
    features: list[Feature] = []
    reference = document.get("spatialReference")
    for index, value in enumerate(document["features"]):
        place = f"{within}features[{index}]"
        attributes = value.get("attributes") if isinstance(value, dict) else None
        if not isinstance(value, dict) or not isinstance(attributes, dict | None):
            source.faults.append(Fault(place, f"{shown(value)} is no feature", "export the layer as GeoJSON"))
            continue
        geometry, drawn = Geometry(), value.get("geometry")
        faults = _read_geometry(f"{place}.geometry", drawn, geometry)
        source.faults.extend(faults)
        # The features of a map know their coordinate system themselves, all the same one.
        reference = reference or (drawn.get("spatialReference") if isinstance(drawn, dict) else None)
        if not faults:
            told = place.replace("{", "{{").replace("}", "}}") + ".attributes.{}"
            features.append(Feature(place, told, attributes or {}, geometry, folders=folders))
    _apply_reference(reference, features, source)
    source.features.extend(features)


def _read_geometry(place: str, value: object, geometry: Geometry) -> list[Fault]:
    if value is None:
        return []
    action = "export the layer as GeoJSON"
    if not isinstance(value, dict):
        return [Fault(place, f"{shown(value)} is no geometry", action)]
    if "curveRings" in value or "curvePaths" in value:
        return [Fault(place, "a curve is no outline of straight lines", "densify the curves, then export the layer")]
    if "x" in value:
        point = _position([value.get("x"), value.get("y")])
        if point is None:
            return [Fault(place, f"{shown(value)} is no position", action)]
        geometry.points.append(point)
        return []
    for member in ("points", "paths", "rings"):
        if member not in value:
            continue
        lines = [value[member]] if member == "points" else value[member]
        parts = [_line(line) for line in lines] if isinstance(lines, list) else [None]
        whole = [part for part in parts if part is not None]
        if len(whole) < len(parts):
            return [Fault(f"{place}.{member}", f"{shown(value[member])} is no list of positions", action)]
        if member == "points":
            geometry.points.extend(whole[0])
        elif member == "paths":
            geometry.lines.extend(whole)
        else:
            # Esri's outer rings run clockwise and its holes anticlockwise.
            holes = [signed_area(ring) > 0.0 for ring in whole]
            if all(holes):
                holes = [False] * len(whole)
            geometry.polygons.extend(polygons_from_rings(whole, is_hole=holes))
    return []


def _line(value: object) -> Positions | None:
    if not isinstance(value, list) or not value:
        return None
    positions = [_position(position) for position in value]
    whole = [position for position in positions if position is not None]
    return whole if len(whole) == len(positions) else None


def _position(value: object) -> tuple[float, float] | None:
    if not isinstance(value, list) or len(value) < 2:
        return None
    x, y = (None if isinstance(number, str) else number_of(number) for number in value[:2])
    return None if x is None or y is None else (x, y)


def _apply_reference(reference: object, features: Sequence[Feature], source: Source) -> None:
    if not isinstance(reference, dict):
        return
    code = reference.get("latestWkid") or reference.get("wkid")
    if isinstance(code, int) and not isinstance(code, bool) and 0 < code < 1_000_000:
        code = _WEB_MERCATOR.get(code, code)
        if code != 4326:
            authority = "ESRI" if code > 100_000 else "EPSG"
            reproject(f"{authority}:{code}", "spatialReference", features, source)
    elif isinstance(reference.get("wkt"), str):
        reproject(reference["wkt"], "spatialReference", features, source)
