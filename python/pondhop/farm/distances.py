"""Whether ponds and depot lie together: single ponds far away are mistyped, several are another farm."""

from __future__ import annotations

from collections.abc import Sequence

from pondhop.errors import Fault
from pondhop.farm.depot import away_km, missing_depot
from pondhop.farm.features import Feature, Source, listed
from pondhop.farm.neighbourhoods import MAX_GAP_M, middle, neighbourhoods
from pondhop.farm.ponds import Draft
from pondhop.farm.words import pond_called
from pondhop.places import LonLat, distance_m


def ponds_of_one_farm(
    drafts: list[Draft],
    depot: LonLat | None,
    source: Source,
    *,
    starts: Sequence[Feature],
    is_depot_given: bool,
    is_depot_missing: bool,
) -> list[Draft]:
    """The ponds around the depot; a missing depot is a fault here, for it tells farms apart.

    A single pond far from all others is mistyped. Several together far away are another farm: with a depot from the
    user, who thereby says which farm is meant, they are left out with a note; else they are faults.
    """
    points = [draft.sampling_point for draft in drafts]
    groups = neighbourhoods(points if depot is None else [*points, depot])
    main = groups[0] if groups else []
    if depot is not None:
        main = next(group for group in groups if len(points) in group)
    others = [group for group in groups if group is not main]
    main = [index for index in main if index < len(points)]
    if is_depot_missing:
        told = [group for group in (main, *others) if len(group) > 1 or group == main != []]
        source.faults.append(missing_depot(told, drafts, starts))
    if not main:
        if points and depot is not None:
            source.faults.append(_far_depot(depot, points, [[drafts[index] for index in group] for group in others]))
        return drafts
    centre = depot or middle([points[index] for index in main])
    left_out: set[int] = set()
    for group in others:
        if len(group) > 1 and is_depot_given:
            left_out.update(group)
            ids = ", ".join(drafts[index].id for index in group[:5]) + (", ..." if len(group) > 5 else "")
            source.notes.add(
                f"{len(group)} ponds ({ids}) lie {_km(centre, points[group[0]])} km from the depot: "
                "another farm, left out."
            )
        elif len(group) == 1 or depot is not None:
            source.faults.extend(_far_ponds([drafts[index] for index in group], centre))
    return [draft for index, draft in enumerate(drafts) if index not in left_out]


def _far_depot(depot: LonLat, points: Sequence[LonLat], groups: Sequence[Sequence[Draft]]) -> Fault:
    swapped_km = away_km((depot[1], depot[0]), points)
    if swapped_km * 1000.0 <= MAX_GAP_M:
        action = "longitude and latitude of the depot, or of all ponds, look exchanged; longitude comes first"
    else:
        action = f"correct it: {listed(map(_described, groups))}"
    return Fault("depot", f"the depot lies {away_km(depot, points):.0f} km from the nearest pond", action)


def _km(a: LonLat, b: LonLat) -> str:
    return f"{distance_m(a, b) / 1000.0:.0f}"


def _described(group: Sequence[Draft]) -> str:
    lon, lat = middle([draft.sampling_point for draft in group])
    ponds = "1 pond lies" if len(group) == 1 else f"{len(group)} ponds lie"
    return f"{ponds} around {lon:.6f},{lat:.6f}"


def _far_ponds(group: Sequence[Draft], centre: LonLat) -> list[Fault]:
    action = "correct its coordinates, or remove it"
    if len(group) > 1:
        action += "; or pass --depot LON,LAT to plan only the farm there"
    return [
        Fault(
            draft.feature.place,
            f"{pond_called(draft.id)} lies {_km(centre, draft.sampling_point)} km from the rest of the farm",
            action,
        )
        for draft in group
    ]
