"""Features made into ponds: outlines closed and checked, parts told apart, what is drawn among them left out."""

from __future__ import annotations

from dataclasses import dataclass

from pondhop.errors import Fault
from pondhop.farm import shapes
from pondhop.farm.columns import parted_pair
from pondhop.farm.coordinates import MAX_LATITUDE_DEG, exchanged
from pondhop.farm.degrees import plain_number
from pondhop.farm.features import Feature, Source, left_out_note, listed, number_of, shortened
from pondhop.farm.hints import ROLE_COLUMNS
from pondhop.farm.neighbourhoods import MAX_GAP_M
from pondhop.farm.roles import Sorted
from pondhop.farm.tasks import Task, read_task
from pondhop.farm.words import Meaning, meanings
from pondhop.places import Area, LonLat, distance_m, wrapped_longitude
from pondhop.units import counted

MAX_SAMPLING_OFFSET_M = 1_000.0
"""A sampling point further outside its pond than this is a typing error, not a shore."""

DWARFED_SHARE = 0.05
"""A part of a pond below this share of the largest is a corner of it, not a pond of its own."""

FILLED_SHARE = 0.8
"""A pond that takes more of a hole than this share is what the hole was cut out for."""

SLIVER_SHARE, SLIVER_M2 = 0.001, 10.0
"""A part below both is an error of drawing."""


@dataclass
class Draft:
    """A pond in the making.

    Attributes
    ----------
    feature
        What it is made of.
    outline
        Valid and closed; empty for a pond given as a point.
    sampling_point
        What the file says, or a place well inside.
    task
        What the file says of sampling it.
    part
        Which of several ponds of its feature it is, from 1; 0 if it is the only one.
    id
        Its name, once all ponds are known.
    area_m2
        Of the outline.
    """

    feature: Feature
    outline: Area
    sampling_point: LonLat
    task: Task
    part: int = 0
    id: str = ""
    area_m2: float = 0.0


def read_ponds(told: Sorted, source: Source) -> list[Draft]:
    """Make ponds of the features that may be some, in the order of the file; faults and notes go to the source."""
    outlines: dict[int, list[Draft]] = {}
    points: dict[int, Feature] = {}
    open_lines: list[Feature] = []
    blank: list[Feature] = []
    order = {id(feature): index for index, feature in enumerate(told.ponds)}
    for feature in told.ponds:
        geometry = feature.geometry
        if geometry.polygons or any(shapes.closed_line(line) for line in geometry.lines):
            outlines[order[id(feature)]] = _from_outlines(feature, source)
        elif geometry.points:
            points[order[id(feature)]] = feature
            _tell_lines_beside(feature, len(geometry.lines), source)
        elif geometry.lines:
            open_lines.append(feature)
        else:
            blank.append(feature)
    _tell_open_lines(open_lines, told, source, has_ponds=bool(outlines or points))
    _tell_blank(blank, told, source, has_ponds=bool(outlines or points))
    drafts = [draft for made in outlines.values() for draft in made]
    drafts = _without_surrounding(drafts, list(points.values()), source)
    kept = {id(draft) for draft in drafts}
    of_points = _from_points(points, drafts, told, source)
    in_order = {**{index: [d for d in made if id(d) in kept] for index, made in outlines.items()}, **of_points}
    return [draft for index in sorted(in_order) for draft in in_order[index]]


def _from_outlines(feature: Feature, source: Source) -> list[Draft]:
    num_faults = len(source.faults)
    sampling_point = _sampling_point(feature, source)
    task = read_task(feature, source)
    areas = areas_of(feature, "a pond", source, may_mend=True)
    for area in areas:
        extent_m = shapes.extent_m(area)
        if extent_m > MAX_GAP_M:
            message = f"the pond is {extent_m / 1000:.0f} km across"
            source.faults.append(Fault(feature.place, message, "look for a mistyped corner"))
    if len(source.faults) > num_faults or not areas:
        return []
    areas = _parts(feature, areas, source)
    if sampling_point is not None:
        areas = [_around(sampling_point, areas)]
        offset_m = -shapes.clearance_m(sampling_point, areas[0])
        if offset_m > MAX_SAMPLING_OFFSET_M:
            place = feature.property_place.format("sampling_point")
            message = f"the sampling point lies {offset_m / 1000:.1f} km outside the pond"
            source.faults.append(Fault(place, message, "correct it, or remove it to sample the middle"))
            return []
    elif len(areas) == 1:
        sampling_point = _marked_place(feature, areas[0], source)
    is_single = len(areas) == 1
    # Where it is sampled is asked here, while its polygon is still at hand.
    return [
        Draft(
            feature,
            area,
            sampling_point or shapes.point_inside(area),
            task,
            0 if is_single else number,
            area_m2=shapes.area_m2(area),
        )
        for number, area in enumerate(areas, start=1)
    ]


def _around(point: LonLat, areas: list[Area]) -> Area:
    """The area in which a place lies, or the nearest one."""
    return max(areas, key=lambda area: shapes.clearance_m(point, area))


def _parts(feature: Feature, areas: list[Area], source: Source) -> list[Area]:
    """The parts of a feature that are ponds: all of one size, or the largest where it dwarfs the rest."""
    if len(areas) == 1:
        return areas
    sizes_m2 = [shapes.area_m2(area) for area in areas]
    largest_m2 = max(sizes_m2)
    ponds = [
        area for area, size in zip(areas, sizes_m2, strict=True) if size > SLIVER_SHARE * largest_m2 or size > SLIVER_M2
    ]
    num_slivers = len(areas) - len(ponds)
    if num_slivers:
        slivers = f"{num_slivers} slivers of it were" if num_slivers > 1 else "a sliver of it was"
        source.notes.add(f"{feature.told()}: {slivers} left out.", kind="slivers")
    if len(ponds) == 1:
        return ponds
    large = [area for area in ponds if shapes.area_m2(area) >= DWARFED_SHARE * largest_m2]
    if len(large) == 1:
        source.notes.add(f"{feature.place}: the pond has {len(ponds)} parts; the largest is sampled.", kind="parts")
        return large
    num_small = len(ponds) - len(large)
    were = "part was" if num_small == 1 else "parts were"
    small = f"; {num_small} small {were} left out" if num_small else ""
    source.notes.add(
        f"{feature.told()}: its {len(large)} parts are {len(large)} ponds, numbered{small}.", kind="ponds of parts"
    )
    return large


def _marked_place(feature: Feature, area: Area, source: Source) -> LonLat | None:
    """Where points drawn together with an outline say that it is sampled; a label says nothing."""
    inside = [point for point in feature.geometry.points if shapes.clearance_m(point, area) > 0.0]
    if not inside:
        return None
    if len(inside) == 1 and Meaning.SAMPLING in meanings(feature.name):
        return inside[0]
    source.notes.add(
        f"{feature.told()}: the point drawn with its outline is its label and was left out.", kind="labels"
    )
    return None


def areas_of(feature: Feature, what: str, source: Source, *, may_mend: bool = False) -> list[Area]:
    """The polygons of a feature, closed and valid; closed lines count as polygons, faulty ones are left out.

    Parameters
    ----------
    feature
        What was drawn.
    what
        What it should be, for faults: ``a pond``.
    source
        Gets faults and notes.
    may_mend
        Whether parts that enclose nothing are dropped where another part is good: a sliver refuses no pond.
    """
    polygons = [*feature.geometry.polygons]
    num_beside = 0
    for line in feature.geometry.lines:
        closed = shapes.closed_line(line)
        if closed is None and feature.geometry.polygons:
            num_beside += 1
            continue
        if closed is None:
            action = "draw it as a polygon, or close the line"
            source.faults.append(Fault(feature.place, f"an open line is not {what}", action))
            continue
        polygons.append([closed])
        gap_m = distance_m(line[0], line[-1])
        if gap_m > 0.0:
            source.notes.add(f"{feature.told()}: the line was closed over the last {gap_m:.1f} m.", kind="closed lines")
    _tell_lines_beside(feature, num_beside, source)
    if not polygons and not feature.geometry.lines:
        message = f"without an outline this is not {what}"
        source.faults.append(Fault(feature.place, message, "draw it as a polygon"))
    valid: list[Area] = []
    faults: list[Fault] = []
    for polygon in polygons:
        area: Area = tuple(shapes.close_ring(ring) for ring in polygon)
        mended, fault = shapes.valid_areas(feature.place, area)
        if mended is not None and mended is not area:
            source.notes.add(f"{feature.told()}: small loops of its outline were cut off.", kind="loops")
        if mended is not None:
            valid.append(mended)
        if fault is not None:
            faults.append(fault)
    slivers = [fault for fault in faults if "no area" in fault.message or "different corner" in fault.message]
    if valid and may_mend and len(slivers) == len(faults):
        if faults:
            told = f"{len(faults)} slivers of it were" if len(faults) > 1 else "a sliver of it was"
            source.notes.add(f"{feature.told()}: {told} left out.", kind="slivers")
    else:
        source.faults.extend(faults)
    return valid


def _tell_open_lines(lines: list[Feature], told: Sorted, source: Source, *, has_ponds: bool) -> None:
    """Lines among ponds are roads and levees; one that has a pond's name, or none, or nothing beside it, is a fault."""
    left_out: list[Feature] = []
    for feature in lines:
        if has_ponds and feature.name and feature.place not in told.sure:
            left_out.append(feature)
        else:
            action = "draw it as a polygon, or close the line"
            source.faults.append(Fault(feature.place, "an open line is not a pond", action))
    if left_out:
        what = "lines are no ponds" if len(left_out) > 1 else "a line is no pond"
        source.notes.add(left_out_note(what, left_out))


def _tell_lines_beside(feature: Feature, num_lines: int, source: Source) -> None:
    """Lines drawn together with an outline or a point are inlets and levees, which nobody samples."""
    if num_lines:
        were = "an open line drawn with it was" if num_lines == 1 else f"{num_lines} open lines drawn with it were"
        source.notes.add(f"{feature.told()}: {were} left out.", kind="lines beside")


def _tell_blank(blank: list[Feature], told: Sorted, source: Source, *, has_ponds: bool) -> None:
    """Features without a place: a fault of what is a pond for certain, else a line of a table that was never drawn."""
    remarks = [feature for feature in blank if has_ponds and feature.place not in told.sure]
    for feature in blank:
        if feature not in remarks:
            action = "draw each pond as one polygon or point"
            source.faults.append(Fault(feature.place, "the feature has no geometry", action))
    if remarks:
        what = "nothing of them was drawn" if len(remarks) > 1 else "nothing of it was drawn"
        source.notes.add(left_out_note(what, remarks))


def _without_surrounding(drafts: list[Draft], pins: list[Feature], source: Source) -> list[Draft]:
    """The ponds without outlines drawn around several others, which are farms or blocks: a fault each.

    A property ``role`` says that one is a pond all the same. Single ponds within ponds stay, and so do ponds in holes:
    islands have ponds. Only where several holes are cut out for one pond each, the land around them was drawn.
    """
    outlines = [draft.outline for draft in drafts]
    points = [draft.sampling_point for draft in drafts]
    within: dict[int, int] = {}
    sizes_m2 = [draft.area_m2 for draft in drafts]
    cut_out: dict[int, int] = {}
    for inner, outer in shapes.places_within(points, outlines):
        if inner == outer:
            continue
        hole = shapes.hole_around(points[inner], outlines[outer])
        if hole is not None:
            is_filled = sizes_m2[inner] > FILLED_SHARE * shapes.area_m2((hole,))
            cut_out[outer] = cut_out.get(outer, 0) + is_filled
        elif sizes_m2[inner] < sizes_m2[outer]:
            within[outer] = within.get(outer, 0) + 1
    pin_points = [point for pin in pins if len(pin.geometry.points) == 1 for point in pin.geometry.points]
    pins_in: dict[int, int] = {}
    for _, outer in shapes.places_inside(pin_points, outlines):
        pins_in[outer] = pins_in.get(outer, 0) + 1
    surrounding: set[int] = set()
    for index, draft in enumerate(drafts):
        if draft.feature.find(*ROLE_COLUMNS):
            continue
        num_ponds, num_pins = max(within.get(index, 0), cut_out.get(index, 0)), pins_in.get(index, 0)
        if num_ponds >= 2 or (num_pins >= 3 and 2 * num_pins > len(pin_points)):
            surrounding.add(index)
            held = f"{num_ponds} other ponds" if num_ponds >= 2 else f"{num_pins} points"
            message = f"the outline lies around {held}: is it the boundary of the farm?"
            action = "remove it, or say what it is in a property role: fence, no_fly, other or pond"
            source.faults.append(Fault(draft.feature.place, message, action))
    return [draft for index, draft in enumerate(drafts) if index not in surrounding]


def _from_points(
    points: dict[int, Feature], outlines: list[Draft], told: Sorted, source: Source
) -> dict[int, list[Draft]]:
    """Ponds given as points. Among outlines a point is a pond only if it says so; in a pond it is a label."""
    made: dict[int, list[Draft]] = {}
    owners: dict[int, Draft] = {}
    singles = {index: feature.geometry.points[0] for index, feature in points.items()}
    # In an outline that was refused, too, a point is no pond of its own; the fault of the outline is told already.
    keys = list(singles)
    for inner, outer in shapes.places_within(list(singles.values()), [draft.outline for draft in outlines]):
        owners[keys[inner]] = outlines[outer]
    doubtful: list[Feature] = []
    labels: list[Feature] = []
    for index, feature in points.items():
        is_explicit = feature.find(*ROLE_COLUMNS) is not None
        owner = owners.get(index)
        if owner is not None and not is_explicit and not _is_on_island(feature, owner, told):
            _use_pin(feature, owner, labels, source)
        elif outlines and not is_explicit and feature.place not in told.sure:
            if Meaning.SAMPLING in meanings(feature.name):
                labels.append(feature)
            else:
                doubtful.append(feature)
        else:
            made[index] = _from_point(feature, source)
    if labels:
        source.notes.add(left_out_note("points in or beside ponds that are outlines are labels", labels))
    if doubtful:
        names = listed(feature.told() for feature in doubtful)
        among = counted(len(outlines), "outline")
        message = f"is this a pond? a point among {among}"
        if len(doubtful) > 1:
            message = f"are these ponds? {len(doubtful)} points among {among}: {names}"
        action = (
            "remove them, or put 'pond' into the names of those that are; or say it in a property role: pond or other"
        )
        source.faults.append(Fault(doubtful[0].place, message, action))
    return made


def _is_on_island(feature: Feature, owner: Draft, told: Sorted) -> bool:
    """Whether a point in the hole of a pond is a pond of its own: called so, and not as the pond around it is."""
    if feature.place not in told.sure or feature.name == owner.feature.name:
        return False
    return shapes.hole_around(feature.geometry.points[0], owner.outline) is not None


def _use_pin(feature: Feature, owner: Draft, labels: list[Feature], source: Source) -> None:
    """A point in a pond: where it is sampled if its name says so, else a label."""
    point = feature.geometry.points[0]
    is_sampling_point = Meaning.SAMPLING in meanings(feature.name) and owner.feature.find("sampling_point") is None
    is_in_water = shapes.hole_around(point, owner.outline) is None
    if is_sampling_point and is_in_water and not owner.part:
        owner.sampling_point = point
        source.notes.add(f"{feature.told()} is where {owner.feature.told()} is sampled.", kind="sampling points")
    else:
        labels.append(feature)


def _from_point(feature: Feature, source: Source) -> list[Draft]:
    num_faults = len(source.faults)
    sampling_point = _sampling_point(feature, source)
    task = read_task(feature, source)
    if len(source.faults) > num_faults:
        return []
    points = list(dict.fromkeys(feature.geometry.points))
    if len(points) == 1:
        return [Draft(feature, (), sampling_point or points[0], task)]
    source.notes.add(
        f"{feature.told()}: its {len(points)} points are {len(points)} ponds, numbered.", kind="ponds of parts"
    )
    return [Draft(feature, (), point, task, number) for number, point in enumerate(points, start=1)]


def _sampling_point(feature: Feature, source: Source) -> LonLat | None:
    found = feature.find("sampling_point")
    if found is None:
        return None
    key, value = found
    # GIS formats have no lists in their tables, so the pair comes as text.
    parts = parted_pair(value) if isinstance(value, str) else value
    numbers = (
        [plain_number(part) if isinstance(part, str) else number_of(part) for part in parts]
        if isinstance(parts, list)
        else []
    )
    place = feature.property_place.format(key)
    if len(numbers) == 2 and numbers[0] is not None and numbers[1] is not None:
        lonlat = (numbers[0], numbers[1])
        if abs(lonlat[0]) <= 360.0 and abs(lonlat[1]) <= MAX_LATITUDE_DEG:
            return (wrapped_longitude(lonlat[0]), lonlat[1])
        action = "exchange longitude and latitude" if exchanged(lonlat) else "correct longitude and latitude"
        source.faults.append(Fault(place, f"{lonlat[0]:.10g}, {lonlat[1]:.10g} is no place of a pond", action))
    else:
        action = "write [longitude, latitude] in degrees"
        source.faults.append(Fault(place, f"{shortened(str(value))!r} is no position", action))
    return None
