"""What autopilots can hold, and what their parameters must be for a plan to be flown as it was planned.

Sources: ArduPilot's parameter reference, and flights on a simulated ArduCopter 4.7 (docs/explanation/flight-model.md).
How high a drone comes home says ArduCopter/mode_rtl.cpp: at RTL_ALT, but no higher than RTL_CONE_SLOPE (default 3, or 0
for none) times the distance from home, and at least RTL_CLIMB_MIN (default 0) above where it is. The same file renames
RTL_CLIMB_MIN to RTL_CLIMB_MIN_M and RTL_ALT_FINAL to RTL_ALT_FINAL_M in 4.7; RTL_CONE_SLOPE keeps its name.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from pondhop._core import LocalFrame
from pondhop.fleet import Fleet
from pondhop.solution import FarmPlan
from pondhop.trips import Trip
from pondhop.units import Units, gap_text

Kind = Literal["int8", "int16", "int32", "real"]
"""How an autopilot stores a parameter; QGroundControl may pass over one that a file gives another kind."""

CEILING_MARGIN_M = 15.0
"""How far above the highest flight a fence's ceiling is set: the autopilot keeps a margin below it, and gusts lift."""

RADIUS_MARGIN_M = 50.0
"""The same for the radius of a fence around home."""

MAX_FENCE_RADIUS_M = 10_000.0
"""The largest circle around home that ArduPilot keeps a drone in: FENCE_RADIUS is 30 to 10000 m, as the @Range of
libraries/AC_Fence/AC_Fence.cpp says; FENCE_ALT_MAX is 10 to 1000 m there."""

MAX_DISARM_DELAY_S = 127
"""The longest that ArduPilot waits on the ground before it disarms; 0 is for ever (DISARM_DELAY in
ArduCopter/Parameters.cpp, @Range 0 to 127)."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of an autopilot, and why it must have its value.

    Attributes
    ----------
    name, value
        In the units of the autopilot.
    why
        A sentence for the crew.
    kind
        How the autopilot stores it.
    """

    name: str
    value: float
    why: str
    kind: Kind


@dataclass(frozen=True)
class Generation:
    """Versions of an autopilot that share names and units of parameters.

    Attributes
    ----------
    tag
        In the names of its parameter files; empty for the first.
    versions
        For people.
    renamed
        Name in the first generation -> name and kind here, and what one of its units is in the units here.
    """

    tag: str
    versions: str
    renamed: Mapping[str, tuple[str, Kind, float]]

    def spelled(self, parameter: Parameter) -> Parameter:
        """Return a parameter of the first generation in the words of this one."""
        if parameter.name not in self.renamed:
            return parameter
        name, kind, factor = self.renamed[parameter.name]
        return replace(parameter, name=name, value=parameter.value * factor, kind=kind)


@dataclass(frozen=True)
class Autopilot:
    """What missions are written for.

    Attributes
    ----------
    name
        For people.
    max_num_items
        How many items it stores, home included.
    max_hold_s
        The longest hold at a waypoint, in whole seconds.
    parameters
        What the drone of a trip must be set to, in the words of the first generation; the reasons in some
        units.
    generations
        One set of parameter files each. No file mixes them: QGroundControl takes the new names for the old ones on a
        drone of the first generation, and would set it to 15 cm in place of 15 m.
    """

    name: str
    max_num_items: int
    max_hold_s: int
    parameters: Callable[[FarmPlan, Trip, Units], list[Parameter]]
    generations: tuple[Generation, ...]


_VERTICAL: tuple[tuple[str, str, Kind], ...] = (
    ("climb_speed_m_s", "WPNAV_SPEED_UP", "real"),
    ("descent_speed_m_s", "WPNAV_SPEED_DN", "real"),
    ("landing_speed_m_s", "LAND_SPEED", "int16"),
    ("slow_landing_height_m", "LAND_ALT_LOW", "int16"),
)
"""Settings whose defaults are ArduPilot's own: written only where the fleet has others.

A drone that a crew lets land with more care keeps its speed where the fleet file does not speak of it.
"""


def _ardupilot_parameters(farm_plan: FarmPlan, trip: Trip, units: Units) -> list[Parameter]:
    fleet, farm = farm_plan.fleet, farm_plan.farm
    layers = farm_plan.layers
    return_height_m = layers.way_home_height_m(trip.drone)
    speed_why = "a pause in flight forgets the speed of the mission and takes this one"
    home_why = f"drones come home in layers, {gap_text(layers.spacing_m, units)} above each other"
    found = [
        Parameter("WPNAV_SPEED", round(100 * fleet.speed_m_s), speed_why, "real"),
        Parameter("RTL_ALT", round(100 * return_height_m), home_why, "int32"),
        Parameter("RTL_CONE_SLOPE", 0, "the default, 3, keeps drones near home below their layers", "real"),
        Parameter("RTL_CLIMB_MIN", 0, "a climb before the way home would lift drones out of their layers", "int16"),
        Parameter("RTL_ALT_TYPE", 0, "heights above home; over terrain, layers would cross", "int8"),
        Parameter("RTL_ALT_FINAL", 0, "above 0 a drone hovers there and does not land", "int16"),
        Parameter("RTL_SPEED", round(100 * fleet.return_speed_m_s), "the plan counts with it on the way home", "int16"),
        Parameter("RTL_LOIT_TIME", round(1000 * fleet.return_loiter_s), "the plan counts with it (ms)", "int32"),
    ]
    found += [
        Parameter(name, round(100 * getattr(fleet, setting)), "the plan counts with it", kind)
        for setting, name, kind in _VERTICAL
        if getattr(fleet, setting) != getattr(Fleet, setting)
    ]
    if fleet.sampling == "splashdown":
        stays_s = 2 * max(fleet.dwell_at(farm.ponds[pond].service_s) for pond in trip.ponds) + 30
        delay_s = math.ceil(stays_s) if stays_s <= MAX_DISARM_DELAY_S else 0
        found += [
            Parameter("MIS_OPTIONS", 4, "bit 2: without it a drone ends on the first pond; add other bits", "int16"),
            Parameter("DISARM_DELAY", delay_s, "with less, a drone disarms on a pond before its stay is over", "int8"),
        ]
    ceiling_m = max(return_height_m, layers.way_out_height_m(trip.drone)) + CEILING_MARGIN_M
    reach_m = reach_of(farm_plan, trip) + RADIUS_MARGIN_M
    fence_why = "altitude, circle and polygons; a radius or ceiling left at its default ends the round on the way"
    found += [
        Parameter("FENCE_TYPE", 7, fence_why, "int8"),
        Parameter("FENCE_RADIUS", math.ceil(reach_m), "the farthest pond of this drone and some more (m)", "real"),
        Parameter("FENCE_ALT_MAX", math.ceil(ceiling_m), "the highest flight of this drone and some more (m)", "real"),
    ]
    if farm.fences or farm.no_fly:
        why = "the farm has fences or no-fly zones; only .plan files hold them"
        found.append(Parameter("FENCE_ENABLE", 1, why, "int8"))
    found += [
        Parameter("BATT_FS_LOW_ACT", 2, "come home on a low battery; the default, 0, does nothing", "int8"),
        Parameter("FS_GCS_ENABLE", 1, "come home without a ground station; the default, 0, does nothing", "int8"),
    ]
    return found


def reach_of(farm_plan: FarmPlan, trip: Trip) -> float:
    """Return how far from home a trip gets, in metres."""
    ponds = [farm_plan.farm.ponds[pond].sampling_point for pond in trip.ponds]
    local = LocalFrame(*farm_plan.farm.depot).to_local(np.array(ponds, dtype=np.float64))
    return float(np.hypot(*local.T).max())


ARDUPILOT = Autopilot(
    "ArduPilot",
    max_num_items=650,
    max_hold_s=65_535,
    parameters=_ardupilot_parameters,
    generations=(
        Generation("", "Copter to version 4.6", {}),
        Generation(
            "-4.7",
            "Copter from version 4.7",
            {
                "WPNAV_SPEED": ("WP_SPD", "real", 0.01),
                "RTL_ALT": ("RTL_ALT_M", "real", 0.01),
                "RTL_CLIMB_MIN": ("RTL_CLIMB_MIN_M", "real", 0.01),
                "RTL_ALT_FINAL": ("RTL_ALT_FINAL_M", "real", 0.01),
                "RTL_SPEED": ("RTL_SPEED_MS", "real", 0.01),
                "WPNAV_SPEED_UP": ("WP_SPD_UP", "real", 0.01),
                "WPNAV_SPEED_DN": ("WP_SPD_DN", "real", 0.01),
                "LAND_SPEED": ("LAND_SPD_MS", "real", 0.01),
                "LAND_ALT_LOW": ("LAND_ALT_LOW_M", "real", 0.01),
            },
        ),
    ),
)
"""ArduPilot Copter: 650 items on its smaller boards; a hold is kept as whole seconds in 16 bits."""
