"""``README.txt`` of a folder of missions: what the crew must know, in the order in which they need it."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from textwrap import fill

from pondhop.encounters import encounters_text
from pondhop.fleet.settings import LANDING_WIND_LIMIT_M_S
from pondhop.missions.autopilots import Autopilot, Generation, Parameter
from pondhop.missions.formats import FORMATS
from pondhop.solution import FarmPlan
from pondhop.trips import Trip
from pondhop.units import (
    JOULES_PER_WATT_HOUR,
    Units,
    counted,
    duration_text,
    energy_text,
    gap_text,
    height_text,
    length_text,
    speed_text,
)

_WIDTH = 88

_TITLE = "Pondhop missions for"

_EARLIER_TITLE = r"Missions for (?:(?!\n\s*\n).)+?,\s+(?:hover-dip|splashdown)(?:,\s+for\s+ArduPilot\s+Copter)?\r?\n"

BEGINNING = re.compile(rf"{_TITLE}\b|{_EARLIER_TITLE}".encode(), re.DOTALL)
"""How every such text begins, and hardly one of the user's own. Version 0.1 began with "Missions for", as people might:
its whole title tells."""

STANDS_APART_M = 5.0
"""Between two drones at the depot: positions are known to 1 or 2 m."""


def crew_readme(farm_plan: FarmPlan, autopilot: Autopilot, units: Units = "metric") -> str:
    """Return the text, with lengths, heights and speeds in some units; parameters have those of the autopilot."""
    sections = [
        [f"{_TITLE} {farm_plan.farm.name}, {farm_plan.fleet.sampling}, for {autopilot.name} Copter"],
        ["DRONES", *_drones(farm_plan, units)],
        ["BATTERY", f"{farm_plan.battery_text} Start every drone with a full battery."],
        *([["SWAPS", *swaps]] if (swaps := _swaps(farm_plan)) else []),
        ["SET EVERY DRONE", *_settings(farm_plan, autopilot, units)],
        ["START", *_start(farm_plan, units)],
        ["WIND", *_wind(farm_plan, units)],
        ["KNOW", *_knowledge(farm_plan, units)],
    ]
    return "\n\n".join("\n".join(map(_wrapped, section)) for section in sections) + "\n"


def _wrapped(paragraph: str) -> str:
    indent = " " * (len(paragraph) - len(paragraph.lstrip()))
    return fill(paragraph, _WIDTH, subsequent_indent=f"{indent}  ", break_long_words=False, break_on_hyphens=False)


def _drones(farm_plan: FarmPlan, units: Units) -> list[str]:
    layers, rows = farm_plan.layers, list[str]()
    for trip in farm_plan.trips:
        start, back, phases = farm_plan.clock(trip.departure_s), farm_plan.clock(trip.arrival_s), trip.phases
        length, energy = length_text(trip.length_m, units), energy_text(phases.total_j)
        way_out = height_text(round(layers.way_out_height_m(trip.drone), 1), units)
        way_home = height_text(round(layers.way_home_height_m(trip.drone), 1), units)
        rows += [
            f"{trip.name}: {counted(len(trip.ponds), 'pond')}, {length}, {duration_text(trip.duration_s)}, {energy}",
            f"  takes off at {start}, flies out {way_out} high, comes home {way_home} high, is back at {back}",
            f"  energy: take-off {energy_text(phases.takeoff_j)}, legs {energy_text(phases.legs_j)}, "
            f"sampling {energy_text(phases.sampling_j)}, way home {energy_text(phases.way_home_j)}",
        ]
    air = "in calm air"
    if farm_plan.wind.speed_m_s:
        air = f"in {farm_plan.wind.told(units)}"
    return [*rows, f"All are back {duration_text(farm_plan.span_s)} after the first take-off, {air}."]


def _swaps(farm_plan: FarmPlan) -> list[str]:
    """When the crew changes which battery, in the order of the landings."""
    if farm_plan.fleet.swap_s is None:
        return []
    landings = sorted((trip for trip in farm_plan.trips), key=lambda trip: (trip.arrival_s, trip.drone))
    later = {(trip.drone, trip.number) for trip in farm_plan.trips}
    swaps = [
        f"{farm_plan.clock(trip.arrival_s)}  drone {trip.drone + 1} lands"
        f"{'' if math.isnan(left_j := _left_j(farm_plan, trip)) else f' with {energy_text(left_j)} left'}: "
        f"give it battery {trip.number + 2}, load "
        f"drone-{trip.drone + 1}-trip-{trip.number + 2}, ready at {farm_plan.clock(trip.ready_s)}"
        for trip in landings
        if (trip.drone, trip.number + 1) in later
    ]
    num_batteries = len(farm_plan.trips)
    return [
        f"{num_batteries} full batteries in all if none is charged in between, one a trip; a swap takes "
        f"{duration_text(farm_plan.fleet.swap_s)}.",
        *swaps,
    ]


def _left_j(farm_plan: FarmPlan, trip: Trip) -> float:
    """What is in the battery at the landing, the reserve with it."""
    fleet = farm_plan.fleet
    if fleet.battery_wh is None:
        return math.nan
    return fleet.battery_wh * JOULES_PER_WATT_HOUR * fleet.health_percent / 100 - trip.energy_j


def _settings(farm_plan: FarmPlan, autopilot: Autopilot, units: Units) -> list[str]:
    parameters = autopilot.parameters(farm_plan, farm_plan.trips[0], units)
    first = farm_plan.trips[0].name
    each = "Each drone has parameters of its own" if not farm_plan.is_round else "Each trip has parameters of its own"
    own = "drone-N-trip-M" if farm_plan.fleet.swap_s is not None else "drone-N"
    return [
        f"{each}: load {own}.param with Mission Planner, or {own}.params with "
        "QGroundControl, into drone N and no other.",
        *(
            f"{generation.versions}: load {own}{generation.tag}.param or {own}{generation.tag}.params instead, and "
            f"never into an older version: {_renamed(generation, parameters)}."
            for generation in autopilot.generations[1:]
        ),
        f"Then read what the drone holds and compare. For {first}, {autopilot.generations[0].versions}:",
        *(f"  {found.name} {found.value:g}: {found.why}" for found in parameters),
        "WARNING: with the defaults of ArduPilot nothing happens when a battery runs low (BATT_FS_LOW_ACT 0) or the "
        "ground station is lost (FS_GCS_ENABLE 0). Set BATT_LOW_VOLT and BATT_LOW_MAH for your battery, or "
        "BATT_FS_LOW_ACT never acts. "
        "BATT_FS_CRT_ACT 1 lands where the drone is, maybe on a pond: choose it yourself.",
    ]


def _renamed(generation: Generation, parameters: list[Parameter]) -> str:
    found = [
        (parameter.name, *generation.renamed[parameter.name])
        for parameter in parameters
        if parameter.name in generation.renamed
    ]
    return ", ".join(f"{old} is {new} x {1 / factor:g}" for old, new, _, factor in found)


def _start(farm_plan: FarmPlan, units: Units) -> list[str]:
    own = "drone-N-trip-M" if farm_plan.fleet.swap_s is not None else "drone-N"
    files = ", ".join(f"{own}{mission_format.suffix} with {mission_format.name}" for mission_format in FORMATS)
    return [
        f"Load {files}: the same mission, but only .plan holds the fence and the no-fly zones.",
        f"Stand the drones at least {height_text(STANDS_APART_M, units)} apart: each comes home to where it was armed.",
        *_order(farm_plan),
        "QGroundControl: slide Start Mission. Mission Planner: Actions, Mission Start. From a transmitter: arm, switch "
        "to AUTO and raise the throttle to the middle, or set AUTO_OPTIONS 3: a drone in AUTO with its throttle down "
        "disarms after 10 s.",
    ]


def _order(farm_plan: FarmPlan) -> list[str]:
    """When each trip is started: where all fly once and none waits, a rule; else a list by time."""
    if not farm_plan.is_round:
        return [
            f"Start drone 1, then each drone {farm_plan.fleet.takeoff_interval_s:g} s after the one before it, in the "
            "order of their numbers."
        ]
    trips = sorted(farm_plan.trips, key=lambda trip: (trip.departure_s, trip.drone))
    return [
        "Start each trip at its time, not before: drones that start early meet others, or wait in the air.",
        *(f"{farm_plan.clock(trip.departure_s)}  {trip.name}" for trip in trips),
    ]


def _wind(farm_plan: FarmPlan, units: Units) -> list[str]:
    limit = speed_text(LANDING_WIND_LIMIT_M_S, units)
    rows = [
        f"Do not fly above {limit} of wind. Measured on a simulated 3 kg quadcopter: a landing at home then never "
        "ends; the drone stands with its motors turning until somebody disarms it."
    ]
    if farm_plan.fleet.sampling == "splashdown":
        rows.append(
            f"Above {limit} no landing on a pond ends either, and the drone stays there: climb out by hand in LOITER "
            "or ALT_HOLD, then RTL."
        )
    return rows


def _knowledge(farm_plan: FarmPlan, units: Units) -> list[str]:
    fleet = farm_plan.fleet
    speed, return_speed = speed_text(fleet.speed_m_s, units), speed_text(fleet.return_speed_m_s, units)
    return [
        f"Planned: {speed}, {height_text(fleet.transit_height_m, units)} above the depot between ponds, "
        f"{fleet.service_s:.0f} s at a pond, of these {fleet.dwell_s:g} s of sampling.",
        *_own_times(farm_plan),
        "Heights are above the depot; the ground is taken to be flat.",
        *_layers(farm_plan, units),
        *([encounters_text(farm_plan, units)] if farm_plan.is_round and farm_plan.num_drones_flying > 1 else []),
        *_left_out(farm_plan),
        f"The way home (RTL) is flown at {return_speed}, at the height of each drone above.",
        *farm_plan.notes_told_in(units),
    ]


def _left_out(farm_plan: FarmPlan) -> list[str]:
    """Ponds that nobody samples."""
    if not farm_plan.left_out:
        return []
    names = ", ".join(farm_plan.farm.ponds[pond].id for pond in farm_plan.left_out)
    return [f"NOT SAMPLED in this round: {counted(len(farm_plan.left_out), 'pond')}: {names}."]


def _own_times(farm_plan: FarmPlan) -> list[str]:
    """Ponds with a time on station of their own, those of the same time together."""
    fleet, names = farm_plan.fleet, defaultdict[float, list[str]](list)
    for pond in farm_plan.farm.ponds:
        if pond.service_s is not None:
            names[pond.service_s].append(pond.id)
    return [
        f"  {fleet.service_at(service_s):.0f} s, of these {fleet.dwell_at(service_s):g} s of sampling, at: "
        f"{', '.join(names[service_s])}."
        for service_s in sorted(names)
    ]


def _layers(farm_plan: FarmPlan, units: Units) -> list[str]:
    """What keeps drones apart in height, where more than one flies."""
    if farm_plan.num_drones_flying < 2:
        return []
    spacing = gap_text(farm_plan.layers.spacing_m, units)
    crossing = (
        "all ways home lie above all ways out."
        if farm_plan.are_layers_stacked
        else "where a way out and a way home lie nearer, the times above keep them apart, so start each drone on time."
    )
    return [f"Ways out lie at least {spacing} above each other, and so do ways home; {crossing}"]
