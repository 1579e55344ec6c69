"""What autopilots can hold, and what their parameters must be for a plan to be flown as it was planned.

Sources: ArduPilot's parameter reference, and flights on a simulated ArduCopter 4.7 (docs/explanation/flight-model.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pondhop._core import LocalFrame
from pondhop.solution import FarmPlan

Kind = Literal["integer", "real"]

CEILING_MARGIN_M = 15.0
"""How far above the highest flight a fence's ceiling is set: the autopilot keeps a margin below it, and gusts lift."""

RADIUS_MARGIN_M = 50.0
"""The same for the radius of a fence around home."""

MAX_DISARM_DELAY_S = 127
"""The longest that ArduPilot waits on the ground before it disarms; 0 is for ever."""

LANDING_WIND_LIMIT_M_S = 5.0
"""Above this wind the landings of a simulated 3 kg quadcopter never ended."""


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
    kind: Kind = "integer"


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
        What a drone of a plan, from 0, must be set to.
    """

    name: str
    max_num_items: int
    max_hold_s: int
    parameters: Callable[[FarmPlan, int], list[Parameter]]


def _ardupilot_parameters(farm_plan: FarmPlan, drone: int) -> list[Parameter]:
    fleet, farm = farm_plan.fleet, farm_plan.farm
    speed, return_speed = fleet.speed_m_s, fleet.return_speed_m_s
    return_height_m = fleet.return_height_of(drone)
    speed_why = "a pause in flight forgets the speed of the mission and takes this one"
    home_why = "drones come home in layers, so that they do not meet"
    found = [
        Parameter("WPNAV_SPEED", round(100 * speed), speed_why + " (cm/s, to version 4.6)", "real"),
        Parameter("WP_SPD", speed, speed_why + " (m/s, from version 4.7)", "real"),
        Parameter("RTL_ALT", round(100 * return_height_m), home_why + " (cm, to version 4.6)"),
        Parameter("RTL_ALT_M", return_height_m, home_why + " (m, from version 4.7)", "real"),
        Parameter("RTL_SPEED", round(100 * return_speed), "the plan counts with it (cm/s, to version 4.6)"),
        Parameter("RTL_SPEED_MS", return_speed, "the plan counts with it (m/s, from version 4.7)", "real"),
        Parameter("RTL_LOIT_TIME", round(1000 * fleet.return_loiter_s), "the plan counts with it (ms)"),
    ]
    if fleet.sampling == "splashdown":
        stays_s = 2 * fleet.dwell_s + 30
        delay_s = math.ceil(stays_s) if stays_s <= MAX_DISARM_DELAY_S else 0
        found += [
            Parameter("MIS_OPTIONS", 4, "bit 2: without it a drone ends its mission on the first pond; add other bits"),
            Parameter("DISARM_DELAY", delay_s, "with less, a drone disarms on a pond before its stay is over"),
        ]
    ceiling_m = max(return_height_m, fleet.way_out_height_of(drone)) + CEILING_MARGIN_M
    reach_m = _reach_m(farm_plan, drone) + RADIUS_MARGIN_M
    fence_why = "altitude, circle and polygons; a radius or ceiling left at its default ends the round on the way"
    found += [
        Parameter("FENCE_TYPE", 7, fence_why),
        Parameter("FENCE_RADIUS", math.ceil(reach_m), "the farthest pond of this drone and some more (m)", "real"),
        Parameter("FENCE_ALT_MAX", math.ceil(ceiling_m), "the highest flight of this drone and some more (m)", "real"),
    ]
    if farm.fences or farm.no_fly:
        found.append(Parameter("FENCE_ENABLE", 1, "the farm has fences or no-fly zones; only .plan files hold them"))
    found += [
        Parameter("BATT_FS_LOW_ACT", 2, "come home on a low battery; the default, 0, does nothing"),
        Parameter("FS_GCS_ENABLE", 1, "come home when the ground station is lost; the default, 0, does nothing"),
    ]
    return found


def _reach_m(farm_plan: FarmPlan, drone: int) -> float:
    """How far from home a drone gets."""
    ponds = [farm_plan.farm.ponds[pond].sampling_point for pond in farm_plan.solution.plan.routes[drone]]
    local = LocalFrame(*farm_plan.farm.depot).to_local(np.array(ponds, dtype=np.float64))
    return float(np.hypot(*local.T).max())


ARDUPILOT = Autopilot("ArduPilot", max_num_items=650, max_hold_s=65_535, parameters=_ardupilot_parameters)
"""ArduPilot Copter: 650 items on its smaller boards; a hold is kept as whole seconds in 16 bits."""
