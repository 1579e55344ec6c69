"""Outlines of ponds and areas: whether they bound water, where inside to sample, and what lies in what.

Shapely is imported where it is used, so that importing pondhop stays cheap.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from pondhop.errors import Fault
from pondhop.farm.features import Positions
from pondhop.places import EARTH_RADIUS_M, Area, LonLat, Ring, distance_m, unrolled_longitude, wrapped_longitude
from pondhop.units import counted

if TYPE_CHECKING:
    import shapely

METRES_PER_DEGREE = math.radians(EARTH_RADIUS_M)
"""Length of a degree of latitude."""

MIN_AREA_M2 = 0.01
"""An outline around less encloses nothing but rounding noise of its corners."""

MIN_CLEARANCE_SHARE = 0.5
"""A centroid nearer to the bank than this share of the best place is near the bank."""

CLOSING_SHARE = 0.05
"""A walk that ends within this share of its length from its start went around something."""

MIN_MENDED_SHARE = 0.98
"""Of the area of an outline that crosses itself must be in one piece for the rest to be cut off."""


def close_ring(positions: Positions) -> Ring:
    """The ring, closed if it is not."""
    ring = tuple(positions)
    return ring if len(ring) > 1 and ring[0] == ring[-1] else (*ring, *ring[:1])


def closed_line(line: Positions) -> Positions | None:
    """The ring of a line that goes around something: it ends where it began, or nearly so."""
    if len(line) <= 3:
        return None
    if line[0] == line[-1]:
        return line
    lons = [unrolled_longitude(lon, line[0][0]) for lon, _ in line]
    shrink = math.cos(math.radians(line[0][1]))
    steps = [
        math.hypot((lons[index + 1] - lons[index]) * shrink, line[index + 1][1] - line[index][1])
        for index in range(len(line) - 1)
    ]
    gap = math.hypot((lons[-1] - lons[0]) * shrink, line[-1][1] - line[0][1])
    return [*line, line[0]] if gap <= CLOSING_SHARE * sum(steps) else None


@lru_cache(maxsize=8)
def _polygon(rings: Area) -> shapely.Polygon:
    """The polygon in degrees, as shapely has it; remembered, because each one is asked several questions in a row.

    Across the 180th meridian its longitudes go on beyond 180.
    """
    import shapely

    near = rings[0][0][0]
    shell, *holes = (shapely.linearrings(_unrolled(ring, near)) for ring in rings)
    return shapely.Polygon(shell, holes)


def _unrolled(ring: Ring, near_deg: float) -> Any:
    corners = np.array(ring, dtype=np.float64)
    corners[:, 0] -= 360.0 * np.round((corners[:, 0] - near_deg) / 360.0)
    return corners


@lru_cache(maxsize=8)
def _on_ground(rings: Area) -> tuple[shapely.Polygon, float, LonLat]:
    """The polygon in metres, how much degrees of longitude are shortened there, and the position of its origin."""
    import shapely

    polygon = _polygon(rings)
    lon, lat = rings[0][0]
    shrink = math.cos(math.radians(lat))
    metres = METRES_PER_DEGREE * np.array([shrink, 1.0])
    return shapely.transform(polygon, lambda lonlat: (lonlat - [lon, lat]) * metres), shrink, (lon, lat)


def valid_areas(place: str, rings: Area) -> tuple[Area | None, Fault | None]:
    """The polygon if it bounds an area without crossing itself, or its fault, with the position of the crossing.

    Loops that are next to nothing, as where a walk around a pond passes its own start, are cut off: the polygon comes
    back without them.
    """
    import shapely

    for ring in rings:
        if len(set(ring)) < 3:
            message = f"the outline has {counted(len(set(ring)), 'different corner')}"
            return None, Fault(place, message, "give a pond at least three corners, or make it a Point")
    polygon = _polygon(rings)
    if polygon.is_valid and area_m2(rings) >= MIN_AREA_M2:
        return rings, None
    # The hull, because the two halves of an outline that crosses itself may cancel out.
    square_degree_m2 = METRES_PER_DEGREE**2 * math.cos(math.radians(rings[0][0][1]))
    if shapely.LineString(_unrolled(rings[0], rings[0][0][0])).convex_hull.area * square_degree_m2 < MIN_AREA_M2:
        return None, Fault(place, "the outline encloses no area", "draw around the water, or make the pond a Point")
    mended = _without_loops(polygon)
    if mended is not None:
        return mended, None
    reason, _, where = shapely.is_valid_reason(polygon).rstrip("]").partition("[")
    longitude, _, latitude = where.partition(" ")
    spot = f" at {wrapped_longitude(float(longitude)):.6f}, {float(latitude):.6f}" if latitude else ""
    meaning = "the outline crosses or touches itself" if "Self-intersection" in reason else reason.lower()
    action = "list the corners in order around the water; in QGIS: Vector > Geometry Tools > Check Validity"
    return None, Fault(place, f"{meaning}{spot}", action)


def _without_loops(polygon: shapely.Polygon) -> Area | None:
    """An invalid polygon's largest part, if it is nearly all of it."""
    import shapely

    parts = [part for part in shapely.get_parts(shapely.make_valid(polygon)) if part.geom_type == "Polygon"]
    pieces = [piece for part in parts for piece in shapely.get_parts(part)]
    if not pieces:
        return None
    largest = max(pieces, key=lambda piece: float(piece.area))
    if float(largest.area) < MIN_MENDED_SHARE * sum(float(piece.area) for piece in pieces):
        return None
    rings = [shapely.get_coordinates(ring) for ring in (largest.exterior, *largest.interiors)]
    return tuple(tuple((wrapped_longitude(float(lon)), float(lat)) for lon, lat in ring) for ring in rings)


def point_inside(rings: Area) -> LonLat:
    """A place well inside a valid polygon: its centroid, unless that is outside or near the bank.

    Near means less than half as far from the bank as the place furthest from it, which is taken then: the centre of the
    largest circle inside, with longitudes shortened as on the ground.
    """
    import shapely

    polygon, shrink, (lon, lat) = _on_ground(rings)
    centroid = polygon.centroid
    clearance_m = polygon.boundary.distance(centroid) if polygon.contains(centroid) else 0.0
    west, south, east, north = polygon.bounds
    # No circle inside has a larger radius, and few outlines need to be asked for more than that.
    limit_m = min(east - west, north - south, 2.0 * math.sqrt(polygon.area / math.pi)) / 2.0
    if clearance_m < MIN_CLEARANCE_SHARE * limit_m:
        circle = shapely.maximum_inscribed_circle(polygon, tolerance=max(east - west, north - south) / 1000.0)
        (x, y), radius_m = circle.coords[0], circle.length
        if clearance_m < MIN_CLEARANCE_SHARE * radius_m:
            return (wrapped_longitude(lon + x / METRES_PER_DEGREE / shrink), lat + y / METRES_PER_DEGREE)
    centre = _polygon(rings).centroid
    return (wrapped_longitude(centre.x), centre.y)


def clearance_m(point: LonLat, rings: Area) -> float:
    """How far a place lies inside a polygon in metres; negative if it lies outside."""
    import shapely

    polygon, shrink, (lon, lat) = _on_ground(rings)
    x = (unrolled_longitude(point[0], lon) - lon) * shrink * METRES_PER_DEGREE
    place = shapely.Point(x, (point[1] - lat) * METRES_PER_DEGREE)
    away_m = float(polygon.boundary.distance(place))
    return away_m if polygon.contains(place) else -away_m


def area_m2(rings: Area) -> float:
    """Area of a polygon."""
    return float(_on_ground(rings)[0].area)


def extent_m(rings: Area) -> float:
    """Diagonal in metres of the box around a polygon."""
    west, south, east, north = _on_ground(rings)[0].bounds
    return math.hypot(east - west, north - south)


def hole_around(point: LonLat, rings: Area) -> Ring | None:
    """The hole of a polygon in which a place lies."""
    return next((hole for hole in rings[1:] if clearance_m(point, (hole,)) > 0.0), None)


def places_inside(points: Sequence[LonLat], areas: Sequence[Area]) -> list[tuple[int, int]]:
    """Pairs (i, j): place i lies in area j, and in none of its holes. Ponds given as points have an empty outline."""
    pairs = places_within(points, areas)
    return [(i, j) for i, j in pairs if hole_around(points[i], areas[j]) is None]


def places_within(points: Sequence[LonLat], outlines: Sequence[Area]) -> list[tuple[int, int]]:
    """Pairs (i, j): place i lies in the outer ring of outline j. Ponds given as points have an empty outline."""
    import shapely

    has_outline = [index for index, rings in enumerate(outlines) if rings]
    if not has_outline or not points:
        return []
    near = outlines[has_outline[0]][0][0][0]
    outer_rings = [_unrolled(outlines[index][0], near) for index in has_outline]
    ring_of_corner = np.repeat(np.arange(len(outer_rings)), [len(ring) for ring in outer_rings])
    rings = shapely.linearrings(np.concatenate(outer_rings), indices=ring_of_corner)
    tree = shapely.STRtree(np.asarray(shapely.polygons(rings)))
    inside, container = tree.query(shapely.points(_unrolled(tuple(points), near)), predicate="within")
    return sorted((int(i), has_outline[int(j)]) for i, j in zip(inside, container, strict=True))


def places_together(points: Sequence[LonLat], within_m: float) -> list[tuple[int, int]]:
    """Pairs (i, j): place j lies that near to place i, which comes before it and is itself near none before.

    Found in cells at least that wide, so that thousands of places on one spot take no longer than others.
    """
    if len(points) < 2:
        return []
    lonlats = _unrolled(tuple(points), points[0][0])
    # One cosine, for degrees that are each shortened by their own are sheared; the smallest, for cells wide enough.
    shrink = np.cos(np.radians(np.abs(lonlats[:, 1]).max()))
    metres = METRES_PER_DEGREE * (lonlats - lonlats[0]) * [shrink, 1.0]
    alone: dict[tuple[int, int], list[int]] = {}
    pairs = []
    for place, (column, row) in enumerate(np.floor(metres / within_m).astype(int).tolist()):
        around = (cell for x in (-1, 0, 1) for y in (-1, 0, 1) for cell in alone.get((column + x, row + y), ()))
        near = [other for other in around if distance_m(points[place], points[other]) < within_m]
        if near:
            pairs.append((min(near), place))
        else:
            alone.setdefault((column, row), []).append(place)
    return pairs
