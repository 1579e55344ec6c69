"""GPX as features: waypoints are points; tracks and routes are lines that someone walked, mostly around ponds."""

from __future__ import annotations

from xml.etree.ElementTree import Element

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Geometry, Positions, Source, number_of
from pondhop.farm.shapes import closed_line
from pondhop.farm.xml_tree import text_in


def read_gpx(root: Element, source: Source) -> None:
    """Read waypoints, tracks and routes.

    The segments of a track are one line, for a pause does not end a walk; unless each of them walks around something.
    """
    metadata = root.find("metadata")
    source.name = (text_in(metadata, "name") if metadata is not None else "") or source.name
    for number, point in enumerate(root.findall("wpt"), start=1):
        _add(f"waypoint {number}", point, Geometry(points=_positions([point], f"waypoint {number}", source)), source)
    for tag, word, point_tag in (("trk", "track", "trkpt"), ("rte", "route", "rtept")):
        for number, line in enumerate(root.findall(tag), start=1):
            place = f"{word} {number}"
            segments = [
                _positions(list(part.iter(point_tag)), place, source) for part in line.findall("trkseg") or [line]
            ]
            walked = [segment for segment in segments if segment]
            are_rounds = len(walked) > 1 and all(closed_line(segment) for segment in walked)
            lines = walked if are_rounds or not walked else [[position for segment in walked for position in segment]]
            _add(place, line, Geometry(lines=lines), source)


def _add(place: str, element: Element, geometry: Geometry, source: Source) -> None:
    texts = {child.tag: (child.text or "").strip() for child in element if child.tag in {"name", "cmt", "desc", "type"}}
    properties: dict[str, object] = {key: value for key, value in texts.items() if value}
    source.features.append(Feature(place, f"{place}, {{}}", properties, geometry))


def _positions(points: list[Element], place: str, source: Source) -> Positions:
    positions: Positions = []
    for point in points:
        lon, lat = number_of(point.get("lon")), number_of(point.get("lat"))
        if lon is None or lat is None:
            message = f"lon {point.get('lon')!r}, lat {point.get('lat')!r} is no position"
            source.faults.append(Fault(place, message, "export the tracks again"))
            return []
        positions.append((lon, lat))
    return positions
