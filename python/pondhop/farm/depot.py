"""Where drones start: the depot of the file or the one that was given, and dry places where there is none."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pondhop._core import LocalFrame
from pondhop.errors import Fault
from pondhop.farm import shapes
from pondhop.farm.coordinates import check_coordinates
from pondhop.farm.features import Feature, Geometry, Source, left_out_note, number_of, shortened
from pondhop.farm.neighbourhoods import middle
from pondhop.farm.ponds import Draft, areas_of
from pondhop.farm.roles import Sorted
from pondhop.farm.words import pond_called
from pondhop.places import LonLat, distance_m

DRY_M = 3.0
"""How far from the water a proposed depot lies at least."""

POINT_POND_M = 60.0
"""Half the width of a pond that is given as a point, for want of its outline, where no other pond is nearer."""


def depot_of(told: Sorted, given: LonLat | None, source: Source) -> LonLat | None:
    """The depot: what the user gave, else that of the file; ``None`` where there is none or it has a fault."""
    in_file: LonLat | None = None
    first: Feature | None = None
    for feature in told.depots:
        point = point_of(feature, "depot", source)
        if point is None:
            continue
        if first is None:
            first, in_file = feature, point
        elif given is None:
            message = f"a second depot; the first is {first.place}"
            source.faults.append(Fault(feature.place, message, "keep one, or pass --depot LON,LAT"))
    if told.starts and (given is not None or in_file is not None):
        source.notes.add(left_out_note("the depot is known", told.starts))
    if given is None:
        return in_file
    return _given(given, source, has_other=in_file is not None)


def _given(depot: LonLat, source: Source, *, has_other: bool) -> LonLat | None:
    lonlat = [number_of(value) for value in depot]
    if len(lonlat) != 2 or lonlat[0] is None or lonlat[1] is None:
        action = "give longitude and latitude in degrees"
        source.faults.append(Fault("depot", f"{depot!r} is no position", action))
        return None
    position = (lonlat[0], lonlat[1])
    faults = check_coordinates([Feature("depot", "depot", {}, Geometry(points=[position]))])
    source.faults.extend(faults)
    if faults:
        return None
    if has_other:
        source.notes.add("The depot of the file was replaced by the one that was given.")
    return position


def point_of(feature: Feature, role: str, source: Source) -> LonLat | None:
    """Where a feature stands that is one place; of an outline the middle."""
    geometry = feature.geometry
    if len(geometry.points) == 1 and not geometry.polygons:
        return geometry.points[0]
    if geometry.polygons or geometry.lines:
        areas = areas_of(feature, f"a {role}", source)
        return shapes.point_inside(areas[0]) if areas else None
    source.faults.append(Fault(feature.place, f"the {role} has no position", "draw it as a point"))
    return None


def tell_depot_in_water(depot: LonLat, drafts: Sequence[Draft], source: Source) -> None:
    """Note a depot that lies in a pond: the way home ends there."""
    for _, index in shapes.places_within([depot], [draft.outline for draft in drafts]):
        if shapes.clearance_m(depot, drafts[index].outline) > 0.0:
            lon, lat = dry_place(depot, drafts)
            source.notes.add(
                f"The depot lies in {pond_called(drafts[index].id)}: drones would land in the water. "
                f"The nearest dry place is {lon:.6f},{lat:.6f}."
            )


def missing_depot(groups: Sequence[Sequence[int]], drafts: Sequence[Draft], starts: Sequence[Feature]) -> Fault:
    """The fault that there is no depot, with what may be one: places with such names, dry places beside ponds."""
    told: list[str] = []
    for feature in starts[:3]:
        if feature.geometry.points:
            lon, lat = feature.geometry.points[0]
            told.append(f"{shortened(feature.name)!r} lies at {lon:.6f},{lat:.6f}")
    for group in groups:
        lon, lat = dry_place(
            middle([drafts[index].sampling_point for index in group]), [drafts[index] for index in group]
        )
        ponds = "1 pond lies" if len(group) == 1 else f"{len(group)} ponds lie"
        told.append(f"{ponds} around {lon:.6f},{lat:.6f}")
    action = f"pass --depot LON,LAT, or name a point Depot{': ' if told else ''}{'; '.join(told)}"
    return Fault("file", "there is no depot, where drones start and end", action)


def dry_place(wanted: LonLat, drafts: Sequence[Draft]) -> LonLat:
    """The place nearest to another one that lies in no pond: found on circles around it, each a little larger.

    A pond given as a point is taken to reach half way to the next one.
    """
    import shapely

    frame = LocalFrame(*wanted)
    water = []
    reach_m = _reach_m([draft.sampling_point for draft in drafts], frame)
    for draft, radius_m in zip(drafts, reach_m, strict=True):
        if draft.outline:
            water.append(shapely.Polygon(frame.to_local(np.array(draft.outline[0], dtype=np.float64))))
        else:
            water.append(shapely.Point(frame.to_local(np.array([draft.sampling_point]))[0]).buffer(radius_m))
    tree = shapely.STRtree(water)
    radius_m, furthest_m = (
        0.0,
        4.0 * max((math.hypot(*geometry.bounds[2:]) for geometry in water), default=0.0) + 1_000.0,
    )
    while radius_m < furthest_m:
        num_ways = max(1, min(64, round(2.0 * math.pi * radius_m / 10.0)))
        angles = np.arange(num_ways) * (2.0 * math.pi / num_ways)
        places = radius_m * np.column_stack([np.sin(angles), np.cos(angles)])
        wet = {int(index) for index in tree.query(shapely.points(places), predicate="dwithin", distance=DRY_M)[0]}
        dry = [index for index in range(num_ways) if index not in wet]
        if dry:
            lon, lat = frame.to_geographic(places[dry[:1]])[0]
            return (float(lon), float(lat))
        radius_m += max(2.0, 0.02 * radius_m)
    return wanted


def _reach_m(points: Sequence[LonLat], frame: LocalFrame) -> list[float]:
    """How far each pond may reach from its point: half way to the next one, and no further than `POINT_POND_M`."""
    import shapely

    if len(points) < 2:
        return [POINT_POND_M] * len(points)
    places = shapely.points(frame.to_local(np.array(points, dtype=np.float64)))
    tree = shapely.STRtree(np.asarray(places))
    reach_m = [POINT_POND_M] * len(points)
    # Places on one spot are no neighbours of each other.
    (indices, _), distances = tree.query_nearest(places, exclusive=True, all_matches=False, return_distance=True)
    for index, distance in zip(indices, distances, strict=True):
        reach_m[int(index)] = min(POINT_POND_M, float(distance) / 2.0)
    return reach_m


def away_km(depot: LonLat, points: Sequence[LonLat]) -> float:
    """How far a place lies from the nearest of others."""
    return min(distance_m(depot, point) for point in points) / 1000.0
