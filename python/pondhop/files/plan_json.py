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
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import chain, repeat
from pathlib import Path
from typing import Any

from pondhop._core import Problem, Separation, __version__, evaluate, separation
from pondhop.arguments import checked_path
from pondhop.documents.atomic import write_all
from pondhop.documents.schemas import check_schema, read_json
from pondhop.errors import InvalidInput
from pondhop.farm.model import Doubt, Farm
from pondhop.files import plan_json_1
from pondhop.files.compared import differences, unknown_ponds
from pondhop.files.plan_parts import fleet_of, read_farm_object
from pondhop.fleet import Fleet
from pondhop.places import Ring
from pondhop.solution import FarmPlan, FarmViolation, Solution, check_written
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
    derived = FarmPlan(
        farm,
        fleet,
        solution,
        num_drones_needed=content["num_drones_needed"],
        are_layers_stacked=are_layers_stacked,
    )
    kinds = {violation.kind for violation in derived.violations}
    obstacles = tuple(_violation(violation) for violation in content["violations"] if violation["kind"] not in kinds)
    farm_plan = replace(derived, obstacles=obstacles)
    # All numbers of a plan follow from its routes, so what the file should hold is what we would write.
    faults = list(differences("", _without_words(content), _without_words(_plan_object(farm_plan))))
    if faults:
        raise InvalidInput(faults)
    return farm_plan


def _plan_object(farm_plan: FarmPlan) -> dict[str, Any]:
    farm, solution = farm_plan.farm, farm_plan.solution
    plan = solution.plan
    # What the way home from each pond takes in the lowest layer, landing included.
    energies_home_j = [float(energies_j[-1]) for energies_j in solution.alone.leg_energies_j]
    return {
        "schema": SCHEMA,
        "pondhop_version": __version__,
        "farm": _farm_object(farm),
        "fleet": _fleet_object(farm_plan.fleet),
        "planner": solution.planner,
        "seed": solution.seed,
        "reason": solution.reason,
        "is_interrupted": solution.is_interrupted,
        "lower_bound_s": solution.lower_bound_s,
        "gap_percent": solution.gap_s_percent,
        "separation": solution.separation and _separation_object(solution.separation),
        "summary": {
            "num_ponds": len(farm.ponds),
            "num_routes": len(plan.routes),
            "num_unserved": len(plan.unserved),
            "makespan_s": plan.makespan_s,
            "all_back_s": farm_plan.all_back_s,
            "max_route_length_m": plan.max_route_length,
            "total_length_m": plan.total_length,
            "total_energy_wh": float(plan.route_energies_j.sum()) / JOULES_PER_WATT_HOUR,
            "is_feasible": farm_plan.is_feasible,
        },
        "routes": [
            _route_object(farm_plan, index, [energy_j + layer_j for energy_j in energies_home_j])
            for index, layer_j in zip(range(len(plan.routes)), _layers_home_j(solution.problem), strict=False)
        ],
        "violations": [_violation_object(farm, violation) for violation in farm_plan.violations],
        "num_drones_needed": farm_plan.num_drones_needed,
        "are_layers_stacked": farm_plan.are_layers_stacked,
        "unserved": [
            {
                "pond": pond,
                "id": farm.ponds[pond].id,
                "reason": "no route visits it",
                "remedies": ["plan again"],
            }
            for pond in plan.unserved
        ],
        "notes": list(farm_plan.notes),
    }


def _farm_object(farm: Farm) -> dict[str, Any]:
    """Return a farm as it stands in the file."""
    return {
        "name": farm.name,
        "ponds": [
            {
                "id": pond.id,
                "sampling_point": list(pond.sampling_point),
                "outline": _rings_object(pond.outline),
                "service_s": pond.service_s,
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


def _fleet_object(fleet: Fleet) -> dict[str, Any]:
    return {**{key: getattr(fleet, key) for key in FLEET_KEYS}, "assumptions": list(fleet.assumptions)}


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
        "pond": violation.pond,
        "id": None if violation.pond is None else farm.ponds[violation.pond].id,
        "value": violation.value,
        "limit": violation.limit,
        "message": violation.message,
        "remedy": violation.remedy,
    }


def _layers_home_j(problem: Problem) -> Iterator[float]:
    """What the way home of each route takes more than that of the lowest drone; it has no end."""
    more_j = [float(way_home_j) - problem.energy.way_home_fixed_j for *_, way_home_j in problem.layers] or [0.0]
    return chain(more_j, repeat(more_j[-1]))


def _route_object(farm_plan: FarmPlan, index: int, energies_home_j: list[float]) -> dict[str, Any]:
    """A route is one trip: one battery, flown from the depot to the depot."""
    plan, problem = farm_plan.solution.plan, farm_plan.solution.problem
    route, start_s = plan.routes[index], farm_plan.takeoff_times_s[index]
    lengths_m, energies_j = plan.leg_lengths_m[index], plan.leg_energies_j[index]
    usable_j = problem.energy.usable_j
    used_j, stops = 0.0, []
    for order, pond in enumerate(route):
        longitude, latitude = farm_plan.farm.ponds[pond].sampling_point
        used_j += float(energies_j[order] + problem.service_energies_j[pond])
        arrival_s = start_s + float(plan.arrivals_s[index][order])
        stops.append(
            {
                "pond": pond,
                "id": farm_plan.farm.ponds[pond].id,
                "lon_deg": longitude,
                "lat_deg": latitude,
                "leg_length_m": float(lengths_m[order]),
                "arrival_s": arrival_s,
                "start_s": arrival_s,
                "departure_s": start_s + float(plan.departures_s[index][order]),
                "energy_left_wh": (usable_j - used_j) / JOULES_PER_WATT_HOUR if math.isfinite(usable_j) else None,
                "energy_home_wh": energies_home_j[pond] / JOULES_PER_WATT_HOUR,
            }
        )
    phases = farm_plan.energy_phases(index)
    length_m, duration_s = float(plan.route_lengths[index]), float(plan.route_durations_s[index])
    energy_wh = float(plan.route_energies_j[index]) / JOULES_PER_WATT_HOUR
    trip = {
        "departure_s": start_s,
        "arrival_s": farm_plan.back_times_s[index],
        "length_m": length_m,
        "energy_wh": energy_wh,
        "usable_energy_wh": usable_j / JOULES_PER_WATT_HOUR if math.isfinite(usable_j) else None,
        "start_place": _DEPOT,
        "end_place": _DEPOT,
        "stops": stops,
        "return_leg_length_m": float(lengths_m[-1]),
    }
    return {
        "drone": index + 1,
        "length_m": length_m,
        "duration_s": duration_s,
        "energy_wh": energy_wh,
        "energy_by_phase_wh": {
            "takeoff": phases.takeoff_j / JOULES_PER_WATT_HOUR,
            "legs": phases.legs_j / JOULES_PER_WATT_HOUR,
            "sampling": phases.sampling_j / JOULES_PER_WATT_HOUR,
            "way_home": phases.way_home_j / JOULES_PER_WATT_HOUR,
        },
        "trips": [trip],
    }


def _farm(content: Mapping[str, Any]) -> Farm:
    doubts = tuple(Doubt(doubt["pond_id"], doubt["message"]) for doubt in content["doubts"])
    return replace(read_farm_object(content), doubts=doubts)


def _fleet(content: Mapping[str, Any]) -> Fleet:
    return fleet_of({key: content[key] for key in FLEET_KEYS}, content["assumptions"])


def _violation(content: Mapping[str, Any]) -> FarmViolation:
    keys = ("kind", "message", "remedy", "drone", "pond", "value", "limit")
    return FarmViolation(**{key: content[key] for key in keys})


def _without_words(content: Mapping[str, Any]) -> dict[str, Any]:
    """Leave out what another version of pondhop may rightly write differently: sentences, and its own name."""
    kept = {key: value for key, value in content.items() if key not in ("pondhop_version", "notes")}
    words = ("message", "remedy", "reason", "remedies")
    for name in ("violations", "unserved"):
        kept[name] = [{key: value for key, value in item.items() if key not in words} for item in content[name]]
    return kept
