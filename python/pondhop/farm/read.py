"""Farm files of any format made into a `Farm`, or all that is wrong with them."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from pathlib import Path
from shlex import quote

from pondhop.arguments import Arguments
from pondhop.errors import Fault, InvalidInput
from pondhop.farm import shapes
from pondhop.farm.coordinates import check_coordinates, wrap_longitudes
from pondhop.farm.depot import depot_of, point_of, tell_depot_in_water
from pondhop.farm.distances import ponds_of_one_farm
from pondhop.farm.faults import told_faults
from pondhop.farm.features import Feature, Source, clean_text, listed, shortened
from pondhop.farm.formats import read_source
from pondhop.farm.meridian import join_at_meridian
from pondhop.farm.model import Doubt, Farm, Pond
from pondhop.farm.names import SAME_PLACE_M, adopt_names, name_ponds
from pondhop.farm.odd_names import odd_names
from pondhop.farm.ponds import Draft, areas_of, read_ponds
from pondhop.farm.projections import settle_zones
from pondhop.farm.roles import Sorted, are_numbered_stations, no_pond_fault, sort_by_role
from pondhop.farm.words import pond_called
from pondhop.places import Area, LonLat

ACCEPT_ALL = "all"
"""Accepts every doubt."""

MIN_WIDTH_M = 2.0
"""Of water in which a drone can tell that it is over it: satellites place it to a metre or two."""

MAX_NARROW_M = 10.0
"""An outline whose area is larger than its diagonal times this has room enough, and is not measured."""

MAX_SHORE_M = 5.0
"""Further outside an outline than positions are drawn wrong, a sampling point is not in the water at its shore."""

MIN_FENCED_SHARE = 0.9
"""Of the ponds must lie in an area for it to be taken as a fence by its name alone."""


def read_farm(
    path: str | Path,
    *,
    depot: LonLat | None = None,
    layers: Sequence[str] = (),
    accept: Sequence[str] = (),
) -> Farm:
    """Read a farm from a file; docs/how-to/farm-files.md shows every format and explains every fault.

    Parameters
    ----------
    path
        GeoJSON, KML, KMZ, GPX, Shapefile, GeoPackage, a workbook, a CSV table, or an archive that holds one of them.
    depot
        Longitude and latitude in degrees; replaces the depot of the file. In a file of several farms it tells which one
        is meant.
    layers
        Names of the layers, sheets or folders to read; all of them if there are none.
    accept
        Ids of ponds whose place is guessed and right as it is, or ``all``; they are no doubts of the farm any more.
        One text may hold several ids with commas between them; ids may hold commas themselves.

    Returns
    -------
    Farm
        With at least one pond, a note for everything that was assumed, converted or left out, and a doubt for every
        pond whose place is a guess.

    Raises
    ------
    InvalidInput
        With every fault of the file: its place, what is wrong, what to do.
    """
    arguments = Arguments()
    arguments.path("path", path)
    if depot is not None:
        arguments.position("depot", depot)
    arguments.all_kind("layers", layers, str, "give names of layers, sheets or folders as a list")
    if not isinstance(accept, str):
        arguments.all_kind("accept", accept, str, "give ids of ponds as a list, or 'all'")
    arguments.check()
    with _collection_paused():
        source = read_source(Path(path), layers)
        settle_zones(source, depot)
        features = list(source.features)
        told = _sorted(source)
        drafts = read_ponds(told, source)
        if not drafts and features and not source.faults:
            source.faults.append(no_pond_fault(told))
        name_ponds(drafts, source)
        found_depot = depot_of(told, depot, source)
        stations = [point for feature in told.stations if (point := point_of(feature, "station", source)) is not None]
        no_fly, fences = _areas(told, drafts, found_depot, source)
        doubts = [*_doubts(drafts, source), *_told_odd(drafts, told, source)]
        drafts = ponds_of_one_farm(
            drafts,
            found_depot,
            source,
            starts=told.starts,
            is_depot_given=depot is not None,
            is_depot_missing=depot is None and not told.has_depot_feature and bool(features),
        )
        if found_depot is not None:
            tell_depot_in_water(found_depot, drafts, source)
    if source.faults or found_depot is None:
        raise InvalidInput(told_faults(source.faults, features))
    if stations:
        are = "station is" if len(stations) == 1 else "stations are"
        names = listed(feature.told() for feature in told.stations)
        hint = " To sample there, give them the role pond." if are_numbered_stations(told.stations) else ""
        source.notes.add(f"{len(stations)} {are} in the file; plans do not use stations yet: {names}.{hint}")
    ids = [draft.id for draft in drafts]
    known = set(ids)
    return Farm(
        clean_text(source.name) or "farm",
        tuple(
            Pond(
                draft.id,
                draft.sampling_point,
                draft.outline,
                draft.task.service_s,
                draft.task.time_windows,
                draft.task.priority,
            )
            for draft in drafts
        ),
        found_depot,
        tuple(stations),
        tuple(no_fly),
        tuple(fences),
        source.notes.sentences(),
        _without_accepted([doubt for doubt in doubts if doubt.pond_id in known], _accepted_ids(accept, ids)),
    )


@contextmanager
def _collection_paused() -> Iterator[None]:
    """Spare the garbage collector the millions of small objects of a large file, none of which is garbage.

    It would walk through all of them again and again, which takes longer than reading them.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def _sorted(source: Source) -> Sorted:
    """The features with good coordinates by what they are."""
    if not source.features and not source.faults:
        action = "export the layer that holds the ponds"
        source.faults.append(Fault("file", "there is no feature in this file", action))
    adopt_names(source.features)
    wrap_longitudes(source.features, source.notes)
    misplaced = check_coordinates(source.features)
    source.faults.extend(misplaced)
    if len(misplaced) == 1 and misplaced[0].path.startswith("all "):
        has_depot_feature = sort_by_role(source.features, Source(source.name)).has_depot_feature
        return Sorted(has_depot_feature=has_depot_feature)
    misplaced_places = {fault.path for fault in misplaced}
    placed = [feature for feature in source.features if feature.place not in misplaced_places]
    join_at_meridian(placed, source.notes)
    return sort_by_role(placed, source)


def _areas(
    told: Sorted, drafts: Sequence[Draft], depot: LonLat | None, source: Source
) -> tuple[list[Area], list[Area]]:
    """No-fly areas and fences; those told by name alone must make sense: ponds outside of the one, inside the other."""
    points = [draft.sampling_point for draft in drafts]
    areas: dict[str, list[Area]] = {"no_fly": [], "fence": []}
    for role, features in (("no_fly", told.no_fly), ("fence", told.fences)):
        for feature in features:
            found = areas_of(feature, f"a {role} area", source)
            if feature.place in told.guessed and points and found:
                inside = len({index for index, _ in shapes.places_inside(points, found)}) / len(points)
                if inside > 0.5 if role == "no_fly" else inside < MIN_FENCED_SHARE:
                    _tell_misnamed(feature, role, inside, source)
            areas[role].extend(found)
            for area in found:
                _tell_holes(feature, role, area, depot, source)
    return areas["no_fly"], areas["fence"]


def _tell_holes(feature: Feature, role: str, area: Area, depot: LonLat | None, source: Source) -> None:
    """Note what becomes of the holes of an area, of which autopilots know nothing; see `Farm.kept_out`."""
    num_holes = len(area) - 1
    if not num_holes:
        return
    holes = "its hole is" if num_holes == 1 else f"its {num_holes} holes are"
    if role == "fence":
        told = f"{holes} kept out of, as {'a no-fly zone' if num_holes == 1 else 'no-fly zones'}"
    elif depot is not None and shapes.hole_around(depot, area) is not None:
        told = "the depot lies in a hole of it, and drones stay inside that hole"
    else:
        told = f"{holes} kept out of too, because autopilots store no-fly zones without holes"
    source.notes.add(f"{feature.told()}: {told}.", kind=f"holes of {role}")


def _tell_misnamed(feature: Feature, role: str, inside: float, source: Source) -> None:
    meaning = "an area to keep out of" if role == "no_fly" else "a fence around the farm"
    called = f"it is called {feature.name!r}" if feature.name else f"its words say {role}"
    message = f"{called}, but {inside:.0%} of the ponds lie in it: is it {meaning}?"
    action = "say what it is in a property role: no_fly, fence, pond or other; or rename it"
    source.faults.append(Fault(feature.place, message, action))


def _doubts(drafts: Sequence[Draft], source: Source) -> list[Doubt]:
    """What makes the place of a pond a guess: corners placed or joined while reading, and sampling points elsewhere."""
    doubts = [Doubt(draft.id, f"{draft.feature.place}: {told}") for draft in drafts for told in draft.feature.doubts]
    doubts.extend(_narrow(drafts, source))
    doubts.extend(_outside(drafts, source))
    points, outlines = [draft.sampling_point for draft in drafts], [draft.outline for draft in drafts]
    for inner, outer in shapes.places_inside(points, outlines):
        if inner == outer:
            continue
        told = f"the sampling point of {pond_called(drafts[inner].id)} lies in {pond_called(drafts[outer].id)}"
        source.notes.add(
            f"{drafts[inner].feature.place}: {told} ({drafts[outer].feature.place}); check both outlines.",
            kind="ponds in ponds",
        )
        doubts.append(Doubt(drafts[inner].id, f"{drafts[inner].feature.place}: {told}"))
    doubts.extend(_at_one_place(drafts, source))
    return doubts


def _outside(drafts: Sequence[Draft], source: Source) -> list[Doubt]:
    """Ponds whose sampling point the file puts outside their own outline: noted on the shore, in doubt further away."""
    offsets = [
        (-shapes.clearance_m(draft.sampling_point, draft.outline), draft)
        for draft in drafts
        if draft.outline and draft.feature.find("sampling_point")
    ]
    outside = [(offset_m, draft) for offset_m, draft in offsets if offset_m > 0.0]
    if outside:
        offset_m, furthest = max(outside, key=lambda item: item[0])
        lie = "sampling point lies" if len(outside) == 1 else "sampling points lie"
        whose, by = ("its pond", "by") if len(outside) == 1 else ("their pond", "the furthest by")
        source.notes.add(
            f"{len(outside)} {lie} outside the outline of {whose}, {by} {offset_m:.1f} m ({furthest.feature.place})."
        )
    return [
        Doubt(
            draft.id,
            f"{draft.feature.place}: the sampling point of {pond_called(draft.id)} lies {offset_m:.0f} m outside it",
        )
        for offset_m, draft in outside
        if offset_m > MAX_SHORE_M
    ]


def _at_one_place(drafts: Sequence[Draft], source: Source) -> list[Doubt]:
    """Ponds given as points that lie where another one does: of one of them the place is a copy."""
    single = [draft for draft in drafts if not draft.outline]
    doubts = []
    for first, second in shapes.places_together([draft.sampling_point for draft in single], SAME_PLACE_M):
        one, other = single[first], single[second]
        told = f"{pond_called(other.id)} lies where {pond_called(one.id)} lies ({one.feature.place})"
        source.notes.add(f"{other.feature.place}: {told}; correct one of the two.", kind="ponds at one place")
        doubts.append(Doubt(other.id, f"{other.feature.place}: {told}"))
    return doubts


def _narrow(drafts: Sequence[Draft], source: Source) -> list[Doubt]:
    """Ponds with less room around their sampling point than a drone that knows where it is only so well needs."""
    doubts = []
    for draft in drafts:
        if not draft.outline or draft.area_m2 > MAX_NARROW_M * shapes.extent_m(draft.outline):
            continue
        # The file may have put the sampling point anywhere; how wide the water is asked of the best place.
        width_m = 2.0 * shapes.clearance_m(shapes.point_inside(draft.outline), draft.outline)
        if width_m < MIN_WIDTH_M:
            told = f"{pond_called(draft.id)} is {width_m:.2g} m wide where it is widest, which is no room for a drone"
            source.notes.add(f"{draft.feature.place}: {told}; is it a sliver?", kind="narrow ponds")
            doubts.append(Doubt(draft.id, f"{draft.feature.place}: {told}"))
    return doubts


def _told_odd(drafts: Sequence[Draft], told: Sorted, source: Source) -> list[Doubt]:
    """Ponds that are not called like the others, with a note each."""
    doubts = odd_names(drafts, told.sure)
    for doubt in doubts:
        source.notes.add(f"{doubt.message}.", kind="odd names")
    return doubts


def _without_accepted(doubts: Sequence[Doubt], accept: Sequence[str]) -> tuple[Doubt, ...]:
    accepted = set(accept)
    return tuple(doubt for doubt in doubts if doubt.pond_id not in accepted)


def _accepted_ids(accept: Sequence[str], ids: Sequence[str]) -> list[str]:
    """Return the ids of the ponds that are accepted; an id may hold commas, and commas part ids.

    Raises
    ------
    InvalidInput
        With every name that no pond has.
    """
    known, accepted, faults = set(ids), list[str](), list[Fault]()
    for value in accept:
        if value.strip().lower() == ACCEPT_ALL:
            return list(ids)
        parts = value.split(",")
        while parts:
            # The longest id that the rest begins with, so that commas in ids need no quotes.
            ends = range(len(parts), 0, -1)
            end = next((end for end in ends if ",".join(parts[:end]).strip() in known), 0)
            name, parts = ",".join(parts[: end or 1]).strip(), parts[end or 1 :]
            if end:
                accepted.append(name)
            elif name:
                close = get_close_matches(name, ids, n=1)
                action = f"did you mean {close[0]!r}?" if close else f"give ids of ponds ({listed(ids)}), or all"
                faults.append(Fault("accept", f"there is no pond {shortened(name)!r}", action))
    if faults:
        raise InvalidInput(faults)
    return accepted


def doubt_fault(doubts: Sequence[Doubt]) -> Fault:
    """What keeps missions from being written where the place of a pond is a guess.

    Parameters
    ----------
    doubts
        Those of the farm; at least one.
    """
    options = " ".join(f"--accept {quote(name)}" for name in dict.fromkeys(doubt.pond_id for doubt in doubts))
    told = listed((doubt.message for doubt in doubts), 3)
    action = f"correct the file; or look where these ponds are sampled, and if that is right pass {options}"
    if any(": is " in doubt.message for doubt in doubts):
        action = f"give what is no pond a role, as in no_fly or other; {action}"
    return Fault("farm", f"the place of a pond is a guess: {told}", action)
