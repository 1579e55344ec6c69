"""KML as features: placemarks with their folders, names, extended data and styles.

Read here and not by GDAL, whose driver drops rings and overlays and makes the names of a placemark its XML id.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple
from xml.etree.ElementTree import Element

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Geometry, Positions, Source, listed, shortened
from pondhop.farm.xml_tree import text_in

_HIDDEN = {"0", "false"}
"""What ``visibility`` says of what is unticked."""

_OVERLAYS = {"GroundOverlay", "PhotoOverlay", "ScreenOverlay"}


def read_kml(root: Element, source: Source) -> None:
    """Read the placemarks of a document; overlays are left out with a note, links to the web cannot be followed."""
    document = root.find("Document")
    source.name = (text_in(document, "name") if document is not None else "") or source.name
    others: dict[str, list[str]] = {"overlay": [], "link": []}
    for number, (element, around) in enumerate(_placemarks(root, others), start=1):
        _read_placemark(f"placemark {number}", element, around, source)
    if others["overlay"]:
        overlays = "overlay" if len(others["overlay"]) == 1 else f"{len(others['overlay'])} overlays"
        source.notes.add(f"Left out, because a picture is no pond: {overlays} {listed(others['overlay'])}.")
    if others["link"] and not source.features and not source.faults:
        message = f"the file holds only a link to the web, {others['link'][0]}"
        action = "export the map again without 'network link', so that the file holds the ponds themselves"
        source.faults.append(Fault("file", message, action))
    elif others["link"]:
        they_are = "it is a link" if len(others["link"]) == 1 else f"they are {len(others['link'])} links"
        source.notes.add(f"Left out, because {they_are} to the web: {listed(others['link'])}.")


class _Around(NamedTuple):
    """What stands around an element: the names of its folders, and whether one of them is hidden, or the element."""

    folders: tuple[str, ...] = ()
    is_hidden: bool = False


def _placemarks(root: Element, others: dict[str, list[str]]) -> Iterator[tuple[Element, _Around]]:
    """Placemarks with what is around them; whatever else can be seen on a map goes to `others`."""
    stack: list[tuple[Element, _Around]] = [(root, _Around())]
    while stack:
        node, around = stack.pop()
        # A placemark is seen if it and every folder around it are ticked.
        if text_in(node, "visibility").casefold() in _HIDDEN:
            around = around._replace(is_hidden=True)
        if node.tag == "Placemark":
            yield node, around
            continue
        if node.tag in _OVERLAYS:
            others["overlay"].append(repr(shortened(text_in(node, "name"))))
        elif node.tag == "NetworkLink":
            others["link"].append(repr(shortened(text_in(node, "name", "href"))))
        name = text_in(node, "name") if node.tag == "Folder" else ""
        inner = around._replace(folders=(*around.folders, name)) if name else around
        stack.extend((child, inner) for child in reversed(node) if child.tag not in {"Style", "StyleMap", "Schema"})


def _read_placemark(place: str, element: Element, around: _Around, source: Source) -> None:
    properties: dict[str, object] = {}
    for data in element.iter("Data"):
        properties[data.get("name", "")] = text_in(data, "value")
    for data in element.iter("SimpleData"):
        properties[data.get("name", "")] = (data.text or "").strip()
    own_name = text_in(element, "name")
    if own_name:
        properties = {"name": own_name, **{key: value for key, value in properties.items() if key.lower() != "name"}}
    description = text_in(element, "description")
    if description:
        properties.setdefault("description", description)
    geometry = Geometry()
    num_faults = len(source.faults)
    for child in element:
        _read_geometry(child, place, geometry, source)
    if len(source.faults) > num_faults:
        return
    style = text_in(element, "styleUrl").lstrip("#")
    source.features.append(
        Feature(
            place,
            f"{place}, {{}}",
            properties,
            geometry,
            element.get("id"),
            folders=around.folders,
            style=style,
            is_hidden=around.is_hidden,
        )
    )


def _read_geometry(element: Element, place: str, geometry: Geometry, source: Source) -> None:
    match element.tag:
        case "MultiGeometry" | "MultiTrack":
            # A stack, because geometries within geometries are allowed to any depth.
            for child in element.iter():
                if child.tag in {"Point", "LineString", "Polygon", "Track"}:
                    _read_geometry(child, place, geometry, source)
            rings = {id(ring) for polygon in element.iter("Polygon") for ring in polygon.iter("LinearRing")}
            for ring in element.iter("LinearRing"):
                if id(ring) not in rings:
                    _read_geometry(ring, place, geometry, source)
        case "Point":
            geometry.points.extend(_positions(element, place, source))
        case "LineString":
            geometry.lines.append(_positions(element, place, source))
        case "LinearRing":
            geometry.polygons.append([_positions(element, place, source)])
        case "Polygon":
            boundaries = [*element.findall("outerBoundaryIs"), *element.findall("innerBoundaryIs")]
            rings_of = [ring for boundary in boundaries for ring in boundary.findall("LinearRing")]
            rings_read = [_positions(ring, place, source) for ring in rings_of]
            if any(rings_read):
                geometry.polygons.append([ring for ring in rings_read if ring])
        case "Track":
            coordinates = [" ".join((coord.text or "").split()[:2]) for coord in element.findall("coord")]
            geometry.lines.append(_parsed([pair.replace(" ", ",") for pair in coordinates], place, source))


def _positions(element: Element, place: str, source: Source) -> Positions:
    coordinates = element.find("coordinates")
    text = (coordinates.text or "") if coordinates is not None else ""
    # Blanks around commas are wrong and common.
    return _parsed(text.replace(", ", ",").replace(" ,", ",").split(), place, source)


def _parsed(pairs: list[str], place: str, source: Source) -> Positions:
    positions: Positions = []
    for pair in pairs:
        try:
            lon, lat, *_ = map(float, pair.strip(",").split(","))
        except ValueError:
            lon = lat = math.nan
        if not (math.isfinite(lon) and math.isfinite(lat)):
            action = "write longitude,latitude in degrees, and a blank between positions"
            source.faults.append(Fault(place, f"{shortened(pair)!r} is no position", action))
            return []
        positions.append((lon, lat))
    return positions
