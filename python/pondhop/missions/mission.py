"""A mission as every autopilot understands it, built from a route, and the rules it must keep before it is written.

The commands per pond and the rules are those measured on a simulated ArduCopter 4.7 and listed in
docs/how-to/fly-with-qgroundcontrol.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import Enum

from pondhop.errors import Fault
from pondhop.farm.model import Farm, Pond
from pondhop.fleet import MAX_HEIGHT_M, Fleet
from pondhop.places import LonLat, Ring

MAX_HOLD_S = 65_535
"""ArduPilot keeps the hold of a waypoint as whole seconds in 16 bits."""

_NUM_DECIMALS = 8
"""What the files hold of degrees, metres and seconds: about a millimetre."""


class Action(Enum):
    """What a drone does at one item of its mission."""

    TAKEOFF = "TAKEOFF"
    CHANGE_SPEED = "CHANGE_SPEED"
    WAYPOINT = "WAYPOINT"
    LAND = "LAND"
    DELAY = "DELAY"
    RETURN_TO_LAUNCH = "RETURN_TO_LAUNCH"


POSITIONED = (Action.TAKEOFF, Action.WAYPOINT, Action.LAND)
"""Actions that happen at a position."""


@dataclass(frozen=True)
class MissionItem:
    """One item of a mission.

    Attributes
    ----------
    action
        What to do.
    position
        Where: longitude, latitude in degrees; `None` for actions that happen wherever the drone is.
    height_m
        Height above the depot; `None` where there is no position.
    hold_s
        How long a ``WAYPOINT`` or ``DELAY`` lasts.
    speed_m_s
        The ground speed from here on (``CHANGE_SPEED``).
    pond_id
        The pond it serves, for messages; no file holds it.
    """

    action: Action
    position: LonLat | None = None
    height_m: float | None = None
    hold_s: float = 0.0
    speed_m_s: float | None = None
    pond_id: str | None = field(default=None, compare=False)


@dataclass(frozen=True)
class Mission:
    """What one drone flies.

    Attributes
    ----------
    name
        ``drone-1`` and so on: the stem of its files.
    home
        The depot: longitude, latitude in degrees.
    speed_m_s
        Ground speed in cruise.
    items
        In flying order; home is not one of them.
    fences, no_fly
        Polygons to stay inside and outside of: open rings of longitude, latitude.
    """

    name: str
    home: LonLat
    speed_m_s: float
    items: tuple[MissionItem, ...]
    fences: tuple[Ring, ...] = ()
    no_fly: tuple[Ring, ...] = ()


def build_mission(name: str, farm: Farm, fleet: Fleet, route: Sequence[int]) -> Mission:
    """Return the mission that flies a route: take off, sample every pond in order, return to launch.

    The cruise speed is an item of its own: without it ArduPilot flies at the speed of its parameters, whatever was
    planned. A no-fly zone is forbidden with everything inside it; a hole in a fence is forbidden too.

    Parameters
    ----------
    name
        Of the mission and its files.
    farm, fleet
        What the route was planned for.
    route
        Indices of ``farm.ponds`` in flying order.
    """
    height_m = _rounded(fleet.transit_height_m)
    speed_m_s = _rounded(fleet.speed_m_s)
    home = _rounded_position(farm.depot)
    items = [
        MissionItem(Action.TAKEOFF, home, height_m),
        MissionItem(Action.CHANGE_SPEED, speed_m_s=speed_m_s),
    ]
    for index in route:
        items.extend(_sampling_items(farm.ponds[index], fleet, height_m))
    items.append(MissionItem(Action.RETURN_TO_LAUNCH))
    outlines = [_open(rings[0]) for rings in farm.fences]
    holes = [_open(ring) for rings in farm.fences for ring in rings[1:]]
    zones = [_open(rings[0]) for rings in farm.no_fly]
    return Mission(name, home, speed_m_s, tuple(items), tuple(outlines), tuple(zones + holes))


def _sampling_items(pond: Pond, fleet: Fleet, height_m: float) -> list[MissionItem]:
    position, dwell_s = _rounded_position(pond.sampling_point), _rounded(fleet.dwell_s)
    arrival = MissionItem(Action.WAYPOINT, position, height_m, pond_id=pond.id)
    if fleet.sampling == "hover-dip":
        dip = MissionItem(Action.WAYPOINT, position, _rounded(fleet.dip_height_m), hold_s=dwell_s, pond_id=pond.id)
        return [arrival, dip, arrival]
    return [
        arrival,
        MissionItem(Action.LAND, position, 0.0, pond_id=pond.id),
        MissionItem(Action.DELAY, hold_s=dwell_s, pond_id=pond.id),
        MissionItem(Action.TAKEOFF, position, height_m, pond_id=pond.id),
    ]


def check_mission(mission: Mission, *, max_num_items: int) -> list[Fault]:
    """Return every rule the mission breaks, each with the item and the remedy; empty for one that may be flown.

    The rules: all numbers finite and in range, the order of take-offs and landings sound, heights at most
    `MAX_HEIGHT_M`, holds in whole seconds, legs inside every fence and outside all no-fly zones, and no more items
    than the autopilot stores.

    Parameters
    ----------
    mission
        Any mission, also one read back from a file.
    max_num_items
        How many items the autopilot stores, home included.
    """
    faults = [*_value_faults(mission), *_order_faults(mission), *_size_faults(mission, max_num_items)]
    position_faults = list(_position_faults(mission))
    # Geometry with a latitude of 137 or NaN has no meaning.
    area_faults = [] if position_faults else list(_area_faults(mission))
    return position_faults + faults + area_faults


def _position_faults(mission: Mission) -> Iterator[Fault]:
    places = [(f"{mission.name}, home", mission.home)]
    places += [(_place(mission, index), item.position) for index, item in enumerate(mission.items) if item.position]
    for kind, rings in (("fence", mission.fences), ("no-fly zone", mission.no_fly)):
        for number, ring in enumerate(rings, start=1):
            places += [(f"{mission.name}, {kind} {number}", position) for position in ring]
    for place, (longitude, latitude) in places:
        if not -180 <= longitude <= 180:
            yield Fault(place, f"the longitude is {longitude}", "give one of -180 to 180 degrees")
        if not -90 <= latitude <= 90:
            yield Fault(place, f"the latitude is {latitude}", "give one of -90 to 90 degrees; are lon and lat swapped?")


def _value_faults(mission: Mission) -> Iterator[Fault]:
    for index, item in enumerate(mission.items):
        place = _place(mission, index)
        if item.action in POSITIONED and (item.position is None or item.height_m is None):
            yield Fault(place, "it has no position or height", "say where")
        if item.height_m is not None:
            if not 0 <= item.height_m <= MAX_HEIGHT_M:
                yield Fault(place, f"the height is {item.height_m} m", f"fly at 0 to {MAX_HEIGHT_M} m above ground")
            elif item.height_m == 0 and item.action is not Action.LAND:
                yield Fault(place, "the height is 0 m", "fly above the ground: set the fleet's heights")
        if not (0 <= item.hold_s <= MAX_HOLD_S and item.hold_s == math.floor(item.hold_s)):
            action = f"set the fleet's dwell_s to whole seconds of at most {MAX_HOLD_S}"
            yield Fault(place, f"the hold is {item.hold_s} s", action)
        elif item.hold_s == 0 and item.action is Action.DELAY:
            yield Fault(place, "the delay is 0 s, which some autopilots take for a time of day", "dwell 1 s or more")
        if item.speed_m_s is not None and not 0 < item.speed_m_s < math.inf:
            yield Fault(place, f"the speed is {item.speed_m_s} m/s", "give a positive speed")


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


def _size_faults(mission: Mission, max_num_items: int) -> Iterator[Fault]:
    num_items = len(mission.items) + 1
    if num_items > max_num_items:
        yield Fault(
            mission.name,
            f"it has {num_items} items with home, the autopilot stores {max_num_items}",
            "use more drones, or hover-dip in place of splashdown (3 items a pond in place of 4)",
        )


def _area_faults(mission: Mission) -> Iterator[Fault]:
    if not mission.fences and not mission.no_fly:
        return
    import shapely

    names, paths = _legs(mission)
    flown = [shapely.Point(mission.home), *shapely.linestrings(paths)] if paths else [shapely.Point(mission.home)]
    fences = [(f"fence {number}", ring, True) for number, ring in enumerate(mission.fences, start=1)]
    zones = [(f"no-fly zone {number}", ring, False) for number, ring in enumerate(mission.no_fly, start=1)]
    for area, ring, is_fence in fences + zones:
        polygon = shapely.Polygon(ring) if len(ring) >= 3 else shapely.Polygon()
        if polygon.is_empty or not polygon.is_valid:
            yield Fault(
                f"{mission.name}, {area}", "it is no simple polygon", "draw it so that it does not cross itself"
            )
            continue
        shapely.prepare(polygon)
        is_broken = ~shapely.covers(polygon, flown) if is_fence else shapely.intersects(polygon, flown)
        message = f"it is not inside {area}" if is_fence else f"it is not outside {area}"
        for index in is_broken.nonzero()[0]:
            yield Fault(
                f"{mission.name}, {['home', *names][index]}",
                message,
                "move the depot or the sampling point, leave the pond out, or correct the area: no detour is planned",
            )


def _legs(mission: Mission) -> tuple[list[str], list[tuple[LonLat, LonLat]]]:
    """Names and end points of all flights between different places, the way back included."""
    names, paths = [], []
    position, name = mission.home, "home"
    stops = [(item.position, f"pond {item.pond_id}" if item.pond_id else "home") for item in mission.items]
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
    pond = f", pond {item.pond_id}" if item.pond_id is not None else ""
    return f"{mission.name}, item {index + 1} ({item.action.value}{pond})"


def _rounded(value: float) -> float:
    return round(value, _NUM_DECIMALS)


def _rounded_position(position: LonLat) -> LonLat:
    return _rounded(position[0]), _rounded(position[1])


def _open(ring: Ring) -> Ring:
    """Return the ring without its repeated last position, rounded as files hold it."""
    positions = tuple(map(_rounded_position, ring))
    return positions[:-1] if len(positions) > 1 and positions[0] == positions[-1] else positions
