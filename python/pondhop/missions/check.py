"""The rules that a mission must keep before it is written: docs/how-to/fly-with-qgroundcontrol.md lists them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pondhop._core import LocalFrame
from pondhop.errors import Fault
from pondhop.farm.words import pond_called
from pondhop.fleet import MAX_HEIGHT_M
from pondhop.missions.autopilots import Autopilot
from pondhop.missions.mission import POSITIONED, Action, Mission
from pondhop.places import LonLat
from pondhop.units import Units, gap_text, height_text, speed_text

MAX_LEGS_TOLD = 5
"""Legs that are named where many break the same rule."""

_AREA_REMEDY = "move the depot or the sampling point, leave the pond out, or correct the area: no detour is planned"


@dataclass(frozen=True)
class BrokenRule:
    """A rule that a mission breaks.

    Attributes
    ----------
    kind
        ``too_many_items``, ``outside_fence``, ``crosses_no_fly``, or ``mission`` for what only a bug brings about.
    fault
        Place, what is wrong, remedy.
    value, limit
        The number of items, and how many the autopilot stores; of legs that break an area's rule, and of all legs.
    """

    kind: str
    fault: Fault
    value: float | None = None
    limit: float | None = None


def broken_rules(
    mission: Mission, autopilot: Autopilot, *, margin_m: float = 0.0, units: Units = "metric"
) -> list[BrokenRule]:
    """Return every rule the mission breaks, each with the item and the remedy; empty for one that may be flown.

    The rules: all numbers finite and in range, the order of take-offs and landings sound, heights at most
    `MAX_HEIGHT_M`, holds in whole seconds, legs inside every fence and outside all no-fly zones, and no more items
    than the autopilot stores.

    Parameters
    ----------
    mission
        Any mission, also one read back from a file.
    autopilot
        What it is for.
    margin_m
        How far legs must stay inside of fences and outside of no-fly zones.
    units
        Of heights, lengths and speeds in the faults.
    """
    faults = [*_value_faults(mission, autopilot, units), *_order_faults(mission)]
    positions = list(_position_faults(mission))
    rules = [BrokenRule("mission", fault) for fault in positions + faults]
    rules += _size_rules(mission, autopilot)
    # Geometry with a latitude of 137 or NaN has no meaning.
    if not positions:
        rules += _area_rules(mission, margin_m, units)
    return rules


def _position_faults(mission: Mission) -> Iterator[Fault]:
    places = [(f"{mission.name}, home", mission.home)]
    places += [(_place(mission, index), item.position) for index, item in enumerate(mission.items) if item.position]
    for name, ring in mission.named_fences() + mission.named_no_fly():
        places += [(f"{mission.name}, {name}", position) for position in ring]
    for place, (longitude, latitude) in places:
        if not -180 <= longitude <= 180:
            yield Fault(place, f"the longitude is {longitude}", "give one of -180 to 180 degrees")
        if not -90 <= latitude <= 90:
            yield Fault(place, f"the latitude is {latitude}", "give one of -90 to 90 degrees; are lon and lat swapped?")


def _value_faults(mission: Mission, autopilot: Autopilot, units: Units) -> Iterator[Fault]:
    for index, item in enumerate(mission.items):
        place = _place(mission, index)
        if item.action in POSITIONED and (item.position is None or item.height_m is None):
            yield Fault(place, "it has no position or height", "say where")
        if item.height_m is not None:
            if not 0 <= item.height_m <= MAX_HEIGHT_M:
                highest = _exact_height(MAX_HEIGHT_M, units)
                message = f"the height is {_exact_height(item.height_m, units)}"
                yield Fault(place, message, f"fly at 0 to {highest} above ground")
            elif item.height_m == 0 and item.action is not Action.LAND:
                yield Fault(
                    place, f"the height is {height_text(0.0, units)}", "fly above the ground: set the fleet's heights"
                )
        if not (0 <= item.hold_s <= autopilot.max_hold_s and item.hold_s == math.floor(item.hold_s)):
            action = f"hold for whole seconds of at most {autopilot.max_hold_s}"
            yield Fault(place, f"the hold is {item.hold_s} s", action)
        elif item.hold_s == 0 and item.action is Action.DELAY:
            yield Fault(place, "the delay is 0 s, which some autopilots take for a time of day", "wait 1 s or more")
        if item.speed_m_s is not None and not 0 < item.speed_m_s < math.inf:
            yield Fault(place, f"the speed is {_exact_speed(item.speed_m_s, units)}", "give a positive speed")


def _exact_height(height_m: float, units: Units) -> str:
    """A height as it is, where a rounded one might seem to keep the rule."""
    return f"{height_m} m" if units == "metric" else gap_text(height_m, units)


def _exact_speed(speed_m_s: float, units: Units) -> str:
    return f"{speed_m_s} m/s" if units == "metric" else speed_text(speed_m_s, units)


def _order_faults(mission: Mission) -> Iterator[Fault]:
    actions = [item.action for item in mission.items]
    if not actions or actions[0] is not Action.TAKEOFF:
        yield Fault(f"{mission.name}, item 1", "the mission does not begin with TAKEOFF", "begin with a take-off")
    if not actions or actions[-1] not in (Action.RETURN_TO_LAUNCH, Action.LAND):
        yield Fault(
            f"{mission.name}, item {len(actions)}",
            "the mission ends with neither RETURN_TO_LAUNCH nor LAND",
            "end with one of them, or the drone hovers until its battery is empty",
        )
    for index, action in enumerate(actions[:-1]):
        if action is Action.RETURN_TO_LAUNCH:
            yield Fault(_place(mission, index), "items follow the return to launch", "let it be the last item")
        if action is Action.LAND and actions[index + 1 : index + 3] != [Action.DELAY, Action.TAKEOFF]:
            action_text = "let a DELAY and a TAKEOFF follow every landing but the last"
            yield Fault(_place(mission, index), "the drone lands and does not take off again", action_text)


def _size_rules(mission: Mission, autopilot: Autopilot) -> Iterator[BrokenRule]:
    num_items, most = len(mission.items) + 1, autopilot.max_num_items
    if num_items > most:
        most_ponds = max_num_ponds(mission, autopilot)
        num_flights = math.ceil(_num_ponds(mission) / most_ponds)
        fault = Fault(
            mission.name,
            f"it has {num_items} items with home, {autopilot.name} stores {most}",
            f"fly its ponds in {num_flights} flights, at most {most_ponds} in each",
        )
        yield BrokenRule("too_many_items", fault, num_items, most)


def max_num_ponds(mission: Mission, autopilot: Autopilot) -> int:
    """Return how many ponds a mission like this one may sample: taking off and coming home need items too."""
    num_ponds = _num_ponds(mission)
    per_pond = max(1, sum(item.pond_id is not None for item in mission.items) // num_ponds)
    around = len(mission.items) + 1 - num_ponds * per_pond
    return max(1, (autopilot.max_num_items - around) // per_pond)


def _num_ponds(mission: Mission) -> int:
    return max(1, len({item.pond_id for item in mission.items if item.pond_id is not None}))


def _area_rules(mission: Mission, margin_m: float, units: Units) -> Iterator[BrokenRule]:
    """Legs and home that are outside a fence, or inside a no-fly zone, by the margin; one broken rule an area."""
    if not mission.fences and not mission.no_fly:
        return
    import shapely

    frame = LocalFrame(*mission.home)

    def local(positions: Sequence[LonLat]) -> NDArray[np.float64]:
        return frame.to_local(np.array(positions, dtype=np.float64))

    names, paths = _legs(mission)
    flown = [shapely.Point(local([mission.home])[0]), *(shapely.LineString(local(path)) for path in paths)]
    fences = [("outside_fence", name, ring) for name, ring in mission.named_fences()]
    zones = [("crosses_no_fly", name, ring) for name, ring in mission.named_no_fly()]
    for kind, area, ring in fences + zones:
        place = f"{mission.name}, {area}"
        polygon = shapely.Polygon(local(ring)) if len(ring) >= 3 else shapely.Polygon()
        if polygon.is_empty or not polygon.is_valid:
            fault = Fault(place, "it is no simple polygon", "draw it so that it does not cross itself")
            yield BrokenRule("mission", fault)
            continue
        is_near = shapely.distance(polygon.exterior, flown) < margin_m
        is_inside = shapely.covers(polygon, flown)
        is_broken = ~is_inside | is_near if kind == "outside_fence" else shapely.intersects(polygon, flown) | is_near
        is_home_broken, broken = bool(is_broken[0]), [names[index] for index in is_broken[1:].nonzero()[0]]
        if broken or is_home_broken:
            told = ", ".join(broken[:MAX_LEGS_TOLD]) + (", ..." if len(broken) > MAX_LEGS_TOLD else "")
            side = "inside" if kind == "outside_fence" else "outside"
            room = f"by at least {gap_text(margin_m, units)} " if margin_m > 0 else ""
            legs = f"{len(broken)} of {len(names)} legs"
            what = f"home and {legs}" if is_home_broken else legs
            message = f"{what} are not {side} it {room}({told})" if broken else f"home is not {side} it {room}".rstrip()
            yield BrokenRule(kind, Fault(place, message, _AREA_REMEDY), len(broken), len(names))


def _legs(mission: Mission) -> tuple[list[str], list[tuple[LonLat, LonLat]]]:
    """Names and end points of all flights between different places, the way back included."""
    names, paths = [], []
    position, name = mission.home, "home"
    stops = [(item.position, pond_called(item.pond_id) if item.pond_id else "home") for item in mission.items]
    if mission.items and mission.items[-1].action is Action.RETURN_TO_LAUNCH:
        stops.append((mission.home, "home"))
    for next_position, next_name in stops:
        if next_position is not None and next_position != position:
            names.append(f"leg from {name} to {next_name}")
            paths.append((position, next_position))
            position, name = next_position, next_name
    return names, paths


def _place(mission: Mission, index: int) -> str:
    item = mission.items[index]
    pond = f", {pond_called(item.pond_id)}" if item.pond_id is not None else ""
    return f"{mission.name}, item {index + 1} ({item.action.value}{pond})"
