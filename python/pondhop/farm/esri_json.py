"""The JSON of ArcGIS (feature sets of its REST interface and of "Features To JSON") as features."""

from __future__ import annotations

from typing import Any

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Geometry, Positions, Source, number_of
from pondhop.farm.json_values import Features, shown
from pondhop.farm.projections import reproject
from pondhop.farm.rings import polygons_from_rings, signed_area

_WEB_MERCATOR = {102100: 3857, 102113: 3857}
"""Numbers that Esri gave to systems before EPSG did."""


def is_esri_json(document: object) -> bool:
    """Whether a document is a feature set of ArcGIS."""
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
    """Read a feature set into features, in WGS84."""
    for index, value in enumerate(document["features"]):
        place = f"features[{index}]"
        attributes = value.get("attributes") if isinstance(value, dict) else None
        if not isinstance(value, dict) or not isinstance(attributes, dict | None):
            source.faults.append(Fault(place, f"{shown(value)} is no feature", "export the layer as GeoJSON"))
            continue
        geometry = Geometry()
        faults = _read_geometry(f"{place}.geometry", value.get("geometry"), geometry)
        source.faults.extend(faults)
        if not faults:
            source.features.append(Feature(place, f"{place}.attributes.{{}}", attributes or {}, geometry))
    _apply_reference(document.get("spatialReference"), source)


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


def _apply_reference(reference: object, source: Source) -> None:
    if not isinstance(reference, dict):
        return
    code = reference.get("latestWkid") or reference.get("wkid")
    if isinstance(code, int) and not isinstance(code, bool) and 0 < code < 1_000_000:
        code = _WEB_MERCATOR.get(code, code)
        if code != 4326:
            authority = "ESRI" if code > 100_000 else "EPSG"
            reproject(f"{authority}:{code}", "spatialReference", source.features, source)
    elif isinstance(reference.get("wkt"), str):
        reproject(reference["wkt"], "spatialReference", source.features, source)
