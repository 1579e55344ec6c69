"""A mission as every autopilot understands it, built from a route.

The commands at a pond are those flown on a simulated ArduCopter 4.7; docs/how-to/fly-with-qgroundcontrol.md lists them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum

from pondhop.farm.model import Farm, Pond
from pondhop.fleet import Fleet
from pondhop.fleet.layers import Layers
from pondhop.places import LonLat, Ring

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
    fence_names, no_fly_names
        What each of them is on the farm, for messages; no file holds it. A mission read from a file has none.
    """

    name: str
    home: LonLat
    speed_m_s: float
    items: tuple[MissionItem, ...]
    fences: tuple[Ring, ...] = ()
    no_fly: tuple[Ring, ...] = ()
    fence_names: tuple[str, ...] = field(default=(), compare=False)
    no_fly_names: tuple[str, ...] = field(default=(), compare=False)

    def named_fences(self) -> list[tuple[str, Ring]]:
        """Return every fence with its name, or its number where it has none."""
        return _named("fence", self.fence_names, self.fences)

    def named_no_fly(self) -> list[tuple[str, Ring]]:
        """Return every no-fly zone with its name, or its number where it has none."""
        return _named("no-fly zone", self.no_fly_names, self.no_fly)


def build_mission(drone: int, farm: Farm, fleet: Fleet, route: Sequence[int], layers: Layers | None = None) -> Mission:
    """Return the mission that flies a route: take off, sample every pond in order, return to launch.

    The cruise speed is an item of its own: without it ArduPilot flies at the speed of its parameters, whatever was
    planned. Each drone flies out to its first pond in a height layer of its own and comes home in one (the height of
    the way home is a parameter of the autopilot, not part of the mission). Areas have no holes here: what they become
    says `Farm.kept_out`, and around a hole with the depot in it goes a fence.

    Parameters
    ----------
    drone
        Which of the fleet, from 0.
    farm, fleet
        What the route was planned for.
    route
        Indices of ``farm.ponds`` in flying order.
    layers
        At which heights drones fly out; those of the fleet, where all may lie between each other, if not given.
    """
    if layers is None:
        layers = fleet.layers(len(farm.ponds))
    height_m = _rounded(fleet.transit_height_m)
    way_out_m = _rounded(layers.way_out_height_m(drone))
    speed_m_s = _rounded(fleet.speed_m_s)
    home = _rounded_position(farm.depot)
    items = [
        MissionItem(Action.TAKEOFF, home, way_out_m),
        MissionItem(Action.CHANGE_SPEED, speed_m_s=speed_m_s),
    ]
    if way_out_m != height_m and route:
        first = farm.ponds[route[0]]
        items.append(MissionItem(Action.WAYPOINT, _rounded_position(first.sampling_point), way_out_m, pond_id=first.id))
    for index in route:
        items.extend(_sampling_items(farm.ponds[index], fleet, height_m))
    items.append(MissionItem(Action.RETURN_TO_LAUNCH))
    # An area is told as the farm's file has it: nobody looks for a fence where the file has none.
    fences = [(f"fence {number}", rings[0]) for number, rings in enumerate(farm.fences, start=1)]
    no_fly = []
    for name, (outer, *holes) in zip(_names_of_kept_out(farm), farm.kept_out, strict=True):
        fences += [(f"the hole of {name}", hole) for hole in holes]
        no_fly += [(name, outer)] if not holes else []
    return Mission(
        f"drone-{drone + 1}",
        home,
        speed_m_s,
        tuple(items),
        fences=tuple(_open(ring) for _, ring in fences),
        no_fly=tuple(_open(ring) for _, ring in no_fly),
        fence_names=tuple(name for name, _ in fences),
        no_fly_names=tuple(name for name, _ in no_fly),
    )


def _names_of_kept_out(farm: Farm) -> list[str]:
    """What each area of `Farm.kept_out` is: no-fly zones first, then the holes of fences."""
    names = [f"no-fly zone {number}" for number in range(1, len(farm.no_fly) + 1)]
    for number, (_, *holes) in enumerate(farm.fences, start=1):
        names += [f"hole {hole} of fence {number}" for hole in range(1, len(holes) + 1)]
    return names


def _named(kind: str, names: Sequence[str], rings: Sequence[Ring]) -> list[tuple[str, Ring]]:
    numbered = [f"{kind} {number}" for number in range(1, len(rings) + 1)]
    return list(zip(names if len(names) == len(rings) else numbered, rings, strict=True))


def _sampling_items(pond: Pond, fleet: Fleet, height_m: float) -> list[MissionItem]:
    position, dwell_s = _rounded_position(pond.sampling_point), _rounded(fleet.dwell_at(pond.service_s))
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


def _rounded(value: float) -> float:
    return round(value, _NUM_DECIMALS)


def _rounded_position(position: LonLat) -> LonLat:
    return _rounded(position[0]), _rounded(position[1])


def _open(ring: Ring) -> Ring:
    """Return the ring without its repeated last position, rounded as files hold it."""
    positions = tuple(map(_rounded_position, ring))
    return positions[:-1] if len(positions) > 1 and positions[0] == positions[-1] else positions
