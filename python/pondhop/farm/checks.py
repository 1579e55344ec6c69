"""Whether the shapes of a farm file can be ponds: coordinates, outlines, sampling points, distances.

Shapely is imported where it is used, so that importing pondhop stays cheap.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from pondhop._core import LocalFrame
from pondhop.errors import Fault
from pondhop.farm.features import Feature, Positions
from pondhop.places import EARTH_RADIUS_M, Area, LonLat, Ring, distance_m

if TYPE_CHECKING:
    import shapely

MAX_LATITUDE_DEG = 75.0
"""No pond is farmed nearer to a pole; a latitude beyond it is a longitude."""

MAX_GAP_M = 20_000.0
"""Ponds and depot of one farm are linked by gaps below this; no sampling drone flies further and returns."""

METRES_PER_DEGREE = math.radians(EARTH_RADIUS_M)
"""Length of a degree of latitude."""

MIN_AREA_M2 = 0.01
"""An outline around less encloses nothing but rounding noise of its corners."""


def exchanged(position: LonLat) -> bool:
    """Whether a position makes sense only with its two numbers exchanged."""
    lon, lat = position
    return abs(lat) > MAX_LATITUDE_DEG and abs(lon) <= MAX_LATITUDE_DEG and abs(lat) <= 180.0


def check_coordinates(features: Sequence[Feature]) -> list[Fault]:
    """Faults of coordinates that lie nowhere on the globe, or where no pond is, one a feature.

    Longitude and latitude exchanged throughout the file are one fault.
    """
    faults: list[Fault] = []
    num_exchanged = num_located = 0
    for feature in features:
        positions = feature.geometry.positions()
        if not positions:
            continue
        num_located += 1
        if all(map(exchanged, positions)):
            num_exchanged += 1
            lon, lat = positions[0]
            faults.append(
                Fault(
                    feature.place,
                    f"longitude {lon:g}, latitude {lat:g} look exchanged",
                    f"write longitude {lat:g} and latitude {lon:g}; in a pair, longitude comes first",
                )
            )
            continue
        for lon, lat in positions:
            fault = _coordinate_fault(feature.place, lon, lat)
            if fault is not None:
                faults.append(fault)
                break
    if num_located > 1 and num_exchanged == num_located:
        return [Fault(f"all {num_located} features", faults[0].message, faults[0].action)]
    return faults


def _coordinate_fault(place: str, lon: float, lat: float) -> Fault | None:
    if abs(lon) > 360.0 or abs(lat) > 360.0:
        message = f"{lon:g}, {lat:g} are no degrees; they look like metres of a map projection"
        return Fault(place, message, "export the file in WGS84 (EPSG:4326), or with its coordinate system")
    if abs(lat) > 90.0:
        return Fault(place, f"latitude {lat:g} is outside -90..90", "correct the latitude")
    if abs(lat) > MAX_LATITUDE_DEG:
        return Fault(place, f"no pond lies at latitude {lat:g}", "correct the latitude; is it a longitude?")
    if abs(lon) > 180.0:
        return Fault(place, f"longitude {lon:g} is outside -180..180", f"write {math.remainder(lon, 360.0):g}")
    return None


def close_ring(positions: Positions) -> Ring:
    """The ring, closed if it is not."""
    ring = tuple(positions)
    return ring if len(ring) > 1 and ring[0] == ring[-1] else (*ring, *ring[:1])


@lru_cache(maxsize=8)
def _polygon(rings: Area) -> shapely.Polygon:
    """The polygon as shapely has it; remembered, because each one is asked several questions in a row."""
    import shapely

    shell, *holes = (shapely.linearrings(np.array(ring)) for ring in rings)
    return shapely.Polygon(shell, holes)


def check_polygon(place: str, rings: Area) -> list[Fault]:
    """Faults of a polygon that bounds no area or crosses itself, with the position of the crossing."""
    import shapely

    for ring in rings:
        if len(set(ring)) < 3:
            message = f"the outline has {len(set(ring))} different corners"
            return [Fault(place, message, "give a pond at least three corners, or make it a Point")]
    polygon = _polygon(rings)
    square_degree_m2 = METRES_PER_DEGREE**2 * math.cos(math.radians(rings[0][0][1]))
    if polygon.is_valid and polygon.area * square_degree_m2 >= MIN_AREA_M2:
        return []
    # The hull, because the two halves of an outline that crosses itself may cancel out.
    if shapely.LineString(rings[0]).convex_hull.area * square_degree_m2 < MIN_AREA_M2:
        return [Fault(place, "the outline encloses no area", "draw around the water, or make the pond a Point")]
    reason, _, where = shapely.is_valid_reason(polygon).rstrip("]").partition("[")
    longitude, _, latitude = where.partition(" ")
    spot = f" at {float(longitude):.6f}, {float(latitude):.6f}" if latitude else ""
    meaning = "the outline crosses or touches itself" if "Self-intersection" in reason else reason.lower()
    action = "list the corners in order around the water; in QGIS: Vector > Geometry Tools > Check Validity"
    return [Fault(place, f"{meaning}{spot}", action)]


def point_inside(rings: Area) -> LonLat:
    """A place well inside a valid polygon: its centroid, or where that is outside the pole of inaccessibility.

    The pole is the centre of the largest circle inside, with longitudes shortened as on the ground.
    """
    import shapely

    polygon = _polygon(rings)
    centroid = polygon.centroid
    if polygon.contains(centroid):
        return (centroid.x, centroid.y)
    shrink = math.cos(math.radians(centroid.y))
    scaled = shapely.transform(polygon, lambda lonlat: lonlat * [shrink, 1.0])
    extent = max(scaled.bounds[2] - scaled.bounds[0], scaled.bounds[3] - scaled.bounds[1])
    centre = shapely.maximum_inscribed_circle(scaled, tolerance=extent / 1000.0).coords[0]
    return (centre[0] / shrink, centre[1])


def area_deg2(rings: Area) -> float:
    """Area of a polygon in square degrees, to tell the largest of several in one place."""
    return float(_polygon(rings).area)


def extent_m(rings: Area) -> float:
    """Diagonal in metres of the box around a polygon."""
    lons, lats = zip(*rings[0], strict=True)
    return distance_m((min(lons), min(lats)), (max(lons), max(lats)))


def distance_to_outline_m(point: LonLat, rings: Area) -> float:
    """How far a place lies outside a polygon in metres; 0 inside."""
    import shapely

    shrink = math.cos(math.radians(point[1]))
    polygon = shapely.transform(_polygon(rings), lambda lonlat: lonlat * [shrink, 1.0])
    return float(polygon.distance(shapely.Point(point[0] * shrink, point[1]))) * METRES_PER_DEGREE


def ponds_within_ponds(points: Sequence[LonLat], outlines: Sequence[Area]) -> list[tuple[int, int]]:
    """Pairs (i, j): the sampling point of pond i lies in pond j. Ponds given as points have an empty outline."""
    import shapely

    has_outline = [index for index, rings in enumerate(outlines) if rings]
    outer_rings = [outlines[index][0] for index in has_outline]
    corners = np.array([position for ring in outer_rings for position in ring])
    ring_of_corner = np.repeat(np.arange(len(outer_rings)), [len(ring) for ring in outer_rings])
    tree = shapely.STRtree(np.asarray(shapely.polygons(shapely.linearrings(corners, indices=ring_of_corner))))
    inside, container = tree.query(shapely.points(np.array(points)), predicate="within")
    pairs = ((int(i), has_outline[int(j)]) for i, j in zip(inside, container, strict=True))
    return sorted((i, j) for i, j in pairs if i != j)


def middle(points: Sequence[LonLat]) -> LonLat:
    """The mean position of places that lie together, wherever on the globe."""
    frame = LocalFrame(*points[0])
    lon, lat = frame.to_geographic(frame.to_local(np.array(points, dtype=np.float64)).mean(axis=0, keepdims=True))[0]
    return (float(lon), float(lat))


def neighbourhoods(points: Sequence[LonLat]) -> list[list[int]]:
    """Indices of the places, grouped so that groups lie apart; the largest group first.

    Places are put into cubes of side `MAX_GAP_M` in space, so that the 180th meridian is nothing special, and cubes
    that touch are joined: gaps below the side always join, gaps above twice the diagonal of a cube never do. Linear in
    the number of places.
    """
    cubes: dict[tuple[int, int, int], list[int]] = {}
    for index, (lon, lat) in enumerate(points):
        lam, phi = math.radians(lon), math.radians(lat)
        direction = (math.cos(phi) * math.cos(lam), math.cos(phi) * math.sin(lam), math.sin(phi))
        x, y, z = (math.floor(component * EARTH_RADIUS_M / MAX_GAP_M) for component in direction)
        cubes.setdefault((x, y, z), []).append(index)
    groups: list[list[int]] = []
    unseen = dict.fromkeys(cubes)
    while unseen:
        frontier = [unseen.popitem()[0]]
        group: list[int] = []
        while frontier:
            cube = frontier.pop()
            group.extend(cubes[cube])
            for step in itertools.product((-1, 0, 1), repeat=3):
                neighbour = (cube[0] + step[0], cube[1] + step[1], cube[2] + step[2])
                if neighbour in unseen:
                    del unseen[neighbour]
                    frontier.append(neighbour)
        groups.append(sorted(group))
    return sorted(groups, key=lambda group: (-len(group), group[0]))
