"""TopoJSON as features: shapes whose borders are shared as arcs (github.com/topojson/topojson-specification)."""

from __future__ import annotations

from typing import Any

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Geometry, Positions, Source, number_of, text_of
from pondhop.farm.json_values import shown

_ACTION = "export the layer as GeoJSON"


def read_topojson(document: dict[str, Any], source: Source) -> None:
    """Read the objects of a topology into features; an object is a layer."""
    try:
        scale, shift = _transform(document.get("transform"))
        arcs = [
            _decoded_arc(arc, scale, shift, is_quantised="transform" in document) for arc in document.get("arcs", [])
        ]
    except (TypeError, ValueError, AttributeError, IndexError):
        source.faults.append(Fault("arcs", "the arcs are no lists of positions", _ACTION))
        return
    objects = document["objects"]
    for layer, value in objects.items() if isinstance(objects, dict) else ():
        is_collection = isinstance(value, dict) and value.get("type") == "GeometryCollection"
        shapes = value.get("geometries") if is_collection else [value]
        if not isinstance(shapes, list):
            source.faults.append(Fault(f"objects.{layer}", f"{shown(value)} is no geometry", _ACTION))
            continue
        for index, shape in enumerate(shapes):
            place = f"objects.{layer}.geometries[{index}]" if is_collection else f"objects.{layer}"
            geometry = Geometry()
            try:
                _add(shape, arcs, scale, shift, geometry)
            except (TypeError, ValueError, AttributeError, IndexError, KeyError):
                source.faults.append(Fault(place, f"{shown(shape)} is no geometry", _ACTION))
                continue
            properties = shape.get("properties")
            own_id = shape.get("id")
            source.features.append(
                Feature(
                    place,
                    f"{place}.properties.{{}}",
                    properties if isinstance(properties, dict) else {},
                    geometry,
                    own_id=text_of(own_id) if isinstance(own_id, str | int | float) else None,
                    folders=(layer,) if len(objects) > 1 else (),
                )
            )


Pair = tuple[float, float]


def _pair(value: Any) -> Pair:
    x, y = (number_of(number) for number in value[:2])
    if x is None or y is None:
        raise ValueError(value)
    return x, y


def _transform(value: Any) -> tuple[Pair, Pair]:
    if value is None:
        return (1.0, 1.0), (0.0, 0.0)
    return _pair(value["scale"]), _pair(value["translate"])


def _decoded_arc(arc: Any, scale: Pair, shift: Pair, *, is_quantised: bool) -> Positions:
    """An arc's positions; those of a quantised topology are steps from one to the next."""
    x = y = 0.0
    positions: Positions = []
    for step in arc:
        dx, dy = _pair(step)
        x, y = (x + dx, y + dy) if is_quantised else (dx, dy)
        positions.append((x * scale[0] + shift[0], y * scale[1] + shift[1]))
    return positions


def _joined(indices: Any, arcs: list[Positions]) -> Positions:
    """Arcs one behind the other; a negative number is an arc walked backwards, ~0 the first one."""
    line: Positions = []
    for index in indices:
        arc = arcs[index] if index >= 0 else arcs[~index][::-1]
        line.extend(arc[1:] if line else arc)
    return line


def _add(shape: Any, arcs: list[Positions], scale: Pair, shift: Pair, geometry: Geometry) -> None:
    def placed(position: Any) -> Pair:
        x, y = _pair(position)
        return x * scale[0] + shift[0], y * scale[1] + shift[1]

    match shape["type"]:
        case "Point":
            geometry.points.append(placed(shape["coordinates"]))
        case "MultiPoint":
            geometry.points.extend(placed(position) for position in shape["coordinates"])
        case "LineString":
            geometry.lines.append(_joined(shape["arcs"], arcs))
        case "MultiLineString":
            geometry.lines.extend(_joined(line, arcs) for line in shape["arcs"])
        case "Polygon":
            geometry.polygons.append([_joined(ring, arcs) for ring in shape["arcs"]])
        case "MultiPolygon":
            geometry.polygons.extend([_joined(ring, arcs) for ring in polygon] for polygon in shape["arcs"])
        case None:
            pass
        case kind:
            raise ValueError(kind)
