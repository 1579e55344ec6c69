"""``plan.json``: a plan with its schedule and what it was made for, the contract for other programs.

docs/reference/json.md describes it, ``documents/schemas/plan-2.json`` is its schema. It is written by the tables below,
key by key: a new field of a farm or fleet enters the file only here, and `tests/test_plan_json.py` asks for it.
Files of version 1 are read by `plan_json_1`.
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

from pondhop._core import Separation, __version__, evaluate, evaluate_round, separation
from pondhop.arguments import checked_path
from pondhop.documents.atomic import write_all
from pondhop.documents.schemas import check_schema, read_json
from pondhop.errors import InvalidInput
from pondhop.farm.model import Doubt, Farm
from pondhop.files import plan_json_1
from pondhop.files.compared import differences, unknown_ponds
from pondhop.files.plan_parts import fleet_of, read_farm_object
from pondhop.fleet import Fleet, Wind
from pondhop.places import Ring
from pondhop.solution import FarmPlan, FarmViolation, RoundSolution, Solution, Unserved, check_written
from pondhop.trips import Trip
from pondhop.units import JOULES_PER_WATT_HOUR

SCHEMA = "pondhop-plan/2"

BEGINNING = re.compile(rb'\s*\{\s*"schema"\s*:\s*"pondhop-plan/')
"""How a plan of any version begins, whoever laid out its lines."""

FLEET_KEYS = (
    "num_drones",
    "speed_m_s",
    "transit_height_m",
    "leg_stop_s",
    "sampling",
    "dwell_s",
    "dip_height_m",
    "max_route_length_m",
    "max_route_duration_s",
    "takeoff_interval_s",
    "layer_spacing_m",
    "fence_margin_m",
    "battery_wh",
    "reserve_percent",
    "health_percent",
    "return_speed_m_s",
    "return_height_m",
    "return_loiter_s",
    "return_extra_s",
    "climb_speed_m_s",
    "descent_speed_m_s",
    "landing_speed_m_s",
    "slow_landing_height_m",
    "spool_up_s",
    "climb_extra_s",
    "landing_extra_s",
    "fast_landing_extra_s",
    "dip_extra_s",
    "first_leg_extra_s",
    "last_dip_extra_s",
    "hover_power_w",
    "drag_power_w_per_m3_s3",
    "climb_power_w_per_m_s",
    "descent_power_w_per_m_s",
    "liftoff_power_w",
    "touchdown_power_w",
    "water_power_w",
)
"""Fields of a fleet in the file, each a number, a word or null; its assumptions stand beside them as a list."""

ROUND_KEYS = (
    "max_airspeed_m_s",
    "swap_s",
    "num_pads",
    "max_trip_duration_s",
    "samples_per_trip",
    "start",
    "end",
)
"""Fields of a fleet that only files of rounds hold: with trips, windows, wind or an end."""

_DEPOT = "depot"


def plan_json(farm_plan: FarmPlan) -> str:
    """Return the text of ``plan.json``; the same plan gives the same text."""
    return json.dumps(_plan_object(farm_plan), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def write_plan_json(path: str | os.PathLike[str], farm_plan: FarmPlan) -> None:
    """Write ``plan.json``: the plan, its schedule, and the farm and fleet it is for.

    Parameters
    ----------
    path
        The file; written whole or not at all.
    farm_plan
        What to write. `read_plan_json` gives it back.

    Raises
    ------
    InvalidInput
        With what is no name of a file or no plan of a farm.
    OSError
        If the file cannot be written.
    """
    check_written(path, farm_plan)
    write_all({Path(path): plan_json(farm_plan)})


def read_plan_json(path: str | os.PathLike[str]) -> FarmPlan:
    """Read a ``plan.json`` of any version; the routes are evaluated anew, and the file's numbers must agree.

    Parameters
    ----------
    path
        A file as `write_plan_json` of this version or an earlier one wrote it.

    Returns
    -------
    FarmPlan
        Equal to the one that was written, but for the times that planning took. What keeps a plan from being flown
        beside its routes (``obstacles``) is taken from the file; a plan of version 1 has the times of version 1.

    Raises
    ------
    InvalidInput
        With every place that breaks the schema; if none does, with every number, pond or sentence that disagrees with
        the rest of the file.
    OSError
        If the file cannot be read.
    """
    content = read_json(checked_path("path", path))
    if isinstance(content, dict) and content.get("schema") == plan_json_1.SCHEMA:
        return plan_json_1.farm_plan(content)
    check_schema(content, "plan-2")
    derived = _derived_round(content) if "wind" in content else _derived(content)
    kinds = {violation.kind for violation in derived.violations}
    obstacles = tuple(_violation(violation) for violation in content["violations"] if violation["kind"] not in kinds)
    farm_plan = replace(derived, obstacles=obstacles)
    # All numbers of a plan follow from its routes, so what the file should hold is what we would write.
    faults = list(differences("", _without_words(content), _without_words(_plan_object(farm_plan))))
    if faults:
        raise InvalidInput(faults)
    return farm_plan


def _derived(content: Mapping[str, Any]) -> FarmPlan:
    """Return the plan of one route a drone that the routes of a file are, without what stands in its way."""
    farm, fleet = _farm(content["farm"]), _fleet(content["fleet"])
    routes = [[int(stop["pond"]) for trip in route["trips"] for stop in trip["stops"]] for route in content["routes"]]
    unknown = list(unknown_ponds(routes, len(farm.ponds), "routes[{route}].trips[0].stops[{order}].pond"))
    if unknown:
        raise InvalidInput(unknown)
    are_layers_stacked = content.get("are_layers_stacked", False)
    problem = farm.to_problem(fleet, are_layers_stacked=are_layers_stacked)
    solution = Solution(
        problem=problem,
        plan=evaluate(problem, routes),
        planner=content["planner"],
        seed=content["seed"],
        elapsed_s=0.0,
        separation=separation(problem, routes) if content["separation"] else None,
        is_interrupted=content["is_interrupted"],
        reason=content["reason"],
        known_lower_bound_s=content["lower_bound_s"],
    )
    return FarmPlan(
        farm,
        fleet,
        solution,
        num_drones_needed=content["num_drones_needed"],
        are_layers_stacked=are_layers_stacked,
    )


def _derived_round(content: Mapping[str, Any]) -> FarmPlan:
    """Return the plan of a round that the trips of a file are, without what stands in its way."""
    farm, fleet = _farm(content["farm"]), _fleet(content["fleet"])
    wind = Wind(content["wind"]["speed_m_s"], content["wind"]["from_deg"])
    routes: list[list[list[int]]] = [[] for _ in range(max((route["drone"] for route in content["routes"]), default=0))]
    for route in content["routes"]:
        routes[route["drone"] - 1] = [[int(stop["pond"]) for stop in trip["stops"]] for trip in route["trips"]]
    unknown = [
        fault
        for index, route in enumerate(content["routes"])
        for fault in unknown_ponds(
            routes[route["drone"] - 1],
            len(farm.ponds),
            f"routes[{index}].trips[{{route}}].stops[{{order}}].pond",
        )
    ]
    if unknown:
        raise InvalidInput(unknown)
    holds_s: list[list[float]] = [[] for _ in routes]
    for route in content["routes"]:
        holds_s[route["drone"] - 1] = [float(trip.get("hold_s", 0.0)) for trip in route["trips"]]
    are_layers_stacked = content.get("are_layers_stacked", False)
    task = farm.to_round(fleet, wind, are_layers_stacked=are_layers_stacked)
    solution = RoundSolution(
        round=task,
        problem=farm.to_problem(fleet, are_layers_stacked=are_layers_stacked),
        plan=evaluate_round(task, routes, holds_s),
        planner=content["planner"],
        seed=content["seed"],
        elapsed_s=0.0,
        is_interrupted=content["is_interrupted"],
        reason=content["reason"],
        known_lower_bound_s=math.inf if content["lower_bound_s"] is None else content["lower_bound_s"],
        holds_s=tuple(map(tuple, holds_s)) if any(map(any, holds_s)) else (),
    )
    return FarmPlan(
        farm,
        fleet,
        solution,
        are_layers_stacked=are_layers_stacked,
        wind=wind,
        unserved=tuple(
            Unserved(unserved["pond"], unserved["reason"], tuple(unserved["remedies"]))
            for unserved in content["unserved"]
        ),
    )


def _plan_object(farm_plan: FarmPlan) -> dict[str, Any]:
    farm, solution, trips = farm_plan.farm, farm_plan.solution, farm_plan.trips
    lengths_m, energies_j = [trip.length_m for trip in trips], [trip.energy_j for trip in trips]
    told = farm_plan.reasons
    return {
        "schema": SCHEMA,
        "pondhop_version": __version__,
        "farm": _farm_object(farm, has_times=farm_plan.is_round),
        "fleet": _fleet_object(farm_plan.fleet, is_of_round=farm_plan.is_round),
        **({"wind": _wind_object(farm_plan.wind)} if farm_plan.is_round else {}),
        "planner": solution.planner,
        "seed": solution.seed,
        "reason": solution.reason,
        "is_interrupted": solution.is_interrupted,
        "lower_bound_s": solution.lower_bound_s if math.isfinite(solution.lower_bound_s) else None,
        "gap_percent": solution.gap_s_percent,
        "separation": solution.separation and _separation_object(solution.separation),
        "summary": {
            "num_ponds": len(farm.ponds),
            "num_routes": farm_plan.num_drones_flying,
            **({"num_trips": len(trips)} if farm_plan.is_round else {}),
            "num_unserved": len(farm_plan.left_out),
            "makespan_s": solution.plan.makespan_s,
            "all_back_s": farm_plan.all_back_s,
            "max_route_length_m": _longest_m(farm_plan),
            "total_length_m": float(sum(lengths_m)),
            "total_energy_wh": float(sum(energies_j)) / JOULES_PER_WATT_HOUR,
            "is_feasible": farm_plan.is_feasible,
        },
        "routes": [
            _route_object(farm_plan, drone, list(own)) for drone, own in groupby(trips, key=lambda trip: trip.drone)
        ],
        "violations": [_violation_object(farm, violation) for violation in farm_plan.violations],
        "num_drones_needed": farm_plan.num_drones_needed,
        "are_layers_stacked": farm_plan.are_layers_stacked,
        "unserved": [
            {
                "pond": pond,
                "id": farm.ponds[pond].id,
                "reason": told[pond].reason if pond in told else "no route visits it",
                "remedies": list(told[pond].remedies) if pond in told else ["plan again"],
            }
            for pond in farm_plan.left_out
        ],
        "notes": list(farm_plan.notes),
    }


def _longest_m(farm_plan: FarmPlan) -> float:
    """Return the length of the longest route: of all trips of one drone."""
    by_drone = groupby(farm_plan.trips, key=lambda trip: trip.drone)
    return max((sum(trip.length_m for trip in own) for _, own in by_drone), default=0.0)


def _wind_object(wind: Wind) -> dict[str, Any]:
    return {"speed_m_s": wind.speed_m_s, "from_deg": wind.from_deg}


def _farm_object(farm: Farm, *, has_times: bool) -> dict[str, Any]:
    """Return a farm as it stands in the file."""
    return {
        "name": farm.name,
        "ponds": [
            {
                "id": pond.id,
                "sampling_point": list(pond.sampling_point),
                "outline": _rings_object(pond.outline),
                "service_s": pond.service_s,
                **(
                    {"time_windows": [list(window) for window in pond.time_windows], "priority": pond.priority}
                    if has_times
                    else {}
                ),
            }
            for pond in farm.ponds
        ],
        "depot": list(farm.depot),
        "stations": [list(station) for station in farm.stations],
        "no_fly": [_rings_object(area) for area in farm.no_fly],
        "fences": [_rings_object(area) for area in farm.fences],
        "notes": list(farm.notes),
        "doubts": [{"pond_id": doubt.pond_id, "message": doubt.message} for doubt in farm.doubts],
    }


def _fleet_object(fleet: Fleet, *, is_of_round: bool) -> dict[str, Any]:
    keys = (*FLEET_KEYS, *ROUND_KEYS) if is_of_round else FLEET_KEYS
    return {**{key: getattr(fleet, key) for key in keys}, "assumptions": list(fleet.assumptions)}


def _rings_object(rings: tuple[Ring, ...]) -> list[list[list[float]]]:
    return [[list(position) for position in ring] for ring in rings]


def _separation_object(measured: Separation) -> dict[str, Any]:
    return {
        "overlap": measured.overlap,
        "num_crossings": measured.num_crossings,
        "num_depot_leg_crossings": measured.num_depot_leg_crossings,
    }


def _violation_object(farm: Farm, violation: FarmViolation) -> dict[str, Any]:
    return {
        "kind": violation.kind,
        "drone": violation.drone,
        **({} if violation.trip is None else {"trip": violation.trip}),
        "pond": violation.pond,
        "id": None if violation.pond is None else farm.ponds[violation.pond].id,
        "value": violation.value,
        "limit": violation.limit,
        "message": violation.message,
        "remedy": violation.remedy,
    }


def _route_object(farm_plan: FarmPlan, drone: int, trips: Sequence[Trip]) -> dict[str, Any]:
    """Return a route: all trips of a drone, each one battery from the depot to the depot."""
    phases = [trip.phases for trip in trips]

    def total_wh(name: str) -> float:
        return float(sum(getattr(phase, name) for phase in phases)) / JOULES_PER_WATT_HOUR

    return {
        "drone": drone + 1,
        "length_m": float(sum(trip.length_m for trip in trips)),
        "duration_s": trips[-1].arrival_s - trips[0].departure_s if len(trips) > 1 else trips[0].duration_s,
        "energy_wh": float(sum(trip.energy_j for trip in trips)) / JOULES_PER_WATT_HOUR,
        "energy_by_phase_wh": {
            "takeoff": total_wh("takeoff_j"),
            "legs": total_wh("legs_j"),
            "sampling": total_wh("sampling_j"),
            "way_home": total_wh("way_home_j"),
        },
        "trips": [_trip_object(farm_plan, trip) for trip in trips],
    }


def _trip_object(farm_plan: FarmPlan, trip: Trip) -> dict[str, Any]:
    usable_j = farm_plan.fleet.usable_energy_j
    is_known = math.isfinite(usable_j)
    stops = []
    for order, pond in enumerate(trip.ponds):
        longitude, latitude = farm_plan.farm.ponds[pond].sampling_point
        arrival_s, start_s, departure_s = map(float, trip.times_s[order])
        used_j, home_j = map(float, trip.energies_j[order])
        stops.append(
            {
                "pond": pond,
                "id": farm_plan.farm.ponds[pond].id,
                "lon_deg": longitude,
                "lat_deg": latitude,
                "leg_length_m": float(trip.legs[order, 0]),
                "arrival_s": arrival_s,
                "start_s": start_s,
                "departure_s": departure_s,
                "energy_left_wh": (usable_j - used_j) / JOULES_PER_WATT_HOUR if is_known else None,
                "energy_home_wh": home_j / JOULES_PER_WATT_HOUR,
            }
        )
    return {
        "departure_s": trip.departure_s,
        **({"hold_s": trip.hold_s} if trip.hold_s else {}),
        "arrival_s": trip.arrival_s,
        "length_m": trip.length_m,
        "energy_wh": trip.energy_j / JOULES_PER_WATT_HOUR,
        "usable_energy_wh": usable_j / JOULES_PER_WATT_HOUR if is_known else None,
        "start_place": _DEPOT,
        "end_place": _DEPOT,
        "stops": stops,
        "return_leg_length_m": float(trip.legs[-1, 0]),
    }


def _farm(content: Mapping[str, Any]) -> Farm:
    doubts = tuple(Doubt(doubt["pond_id"], doubt["message"]) for doubt in content["doubts"])
    return replace(read_farm_object(content), doubts=doubts)


def _fleet(content: Mapping[str, Any]) -> Fleet:
    settings = {key: content[key] for key in (*FLEET_KEYS, *ROUND_KEYS) if key in content}
    return fleet_of(settings, content["assumptions"])


def _violation(content: Mapping[str, Any]) -> FarmViolation:
    keys = ("kind", "message", "remedy", "drone", "pond", "value", "limit")
    return FarmViolation(**{key: content[key] for key in keys}, trip=content.get("trip"))


def _without_words(content: Mapping[str, Any]) -> dict[str, Any]:
    """Leave out what another version of pondhop may rightly write differently: sentences, and its own name."""
    kept = {key: value for key, value in content.items() if key not in ("pondhop_version", "notes")}
    words = ("message", "remedy", "reason", "remedies")
    for name in ("violations", "unserved"):
        kept[name] = [{key: value for key, value in item.items() if key not in words} for item in content[name]]
    return kept
