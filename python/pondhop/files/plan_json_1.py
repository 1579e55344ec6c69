"""``plan.json`` of version 1, which pondhop 0.1.0 wrote: read for ever, written no more.

Its times are those of a model that left out take-off and way home and took every landing for one of 0.5 m/s
(docs/explanation/flight-model.md tells what flights showed). They are recomputed by that model here, so that a file is
checked by what it was made with; the plan that comes back has them, with a note.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from pondhop._core import LocalFrame, Problem, evaluate, separation
from pondhop.documents.schemas import check_schema
from pondhop.errors import InvalidInput
from pondhop.farm.model import Farm
from pondhop.files.compared import differences, unknown_ponds
from pondhop.files.plan_parts import fleet_of, read_farm_object
from pondhop.fleet import Fleet
from pondhop.solution import FarmPlan, Solution

SCHEMA = "pondhop-plan/1"

NOTE = (
    "This plan was made by version 0.1, whose times leave out take-off and way home: plan again before flying, "
    "with the same farm and fleet."
)

_FLEET_KEYS = (
    "num_drones",
    "speed_m_s",
    "transit_height_m",
    "leg_stop_s",
    "sampling",
    "dwell_s",
    "dip_height_m",
    "max_route_length_m",
    "max_route_duration_s",
)


def farm_plan(content: Mapping[str, Any]) -> FarmPlan:
    """Return the plan of a file of version 1.

    Raises
    ------
    InvalidInput
        With every place that breaks the schema, or every number that does not follow from the routes.
    """
    check_schema(content, "plan-1")
    farm = read_farm_object(content["farm"])
    routes = [[int(stop["pond"]) for stop in route["stops"]] for route in content["routes"]]
    unknown = list(unknown_ponds(routes, len(farm.ponds), "routes[{route}].stops[{order}].pond"))
    if unknown:
        raise InvalidInput(unknown)
    fleet, problem = _fleet(content["fleet"]), _problem(farm, content["fleet"])
    plan = evaluate(problem, routes)
    measured = separation(problem, routes) if content["separation"] else None
    solution = Solution(
        problem=problem,
        plan=plan,
        planner=content["planner"],
        seed=content["seed"],
        elapsed_s=content["elapsed_s"],
        separation=measured,
    )
    expected = {
        "summary": {
            "num_ponds": len(farm.ponds),
            "num_routes": len(plan.routes),
            "num_unserved": len(plan.unserved),
            "max_route_length_m": plan.max_route_length,
            "total_length_m": plan.total_length,
            "makespan_s": plan.makespan_s,
            "is_feasible": plan.is_feasible,
        },
        "separation": measured and {"overlap": measured.overlap, "num_crossings": measured.num_crossings},
        "routes": [
            {
                "drone": index + 1,
                "length_m": float(plan.route_lengths[index]),
                "duration_s": float(plan.route_durations_s[index]),
                "stops": [
                    {
                        "pond": pond,
                        "id": farm.ponds[pond].id,
                        "lon_deg": farm.ponds[pond].sampling_point[0],
                        "lat_deg": farm.ponds[pond].sampling_point[1],
                        "leg_length_m": float(plan.leg_lengths_m[index][order]),
                        "arrival_s": float(plan.arrivals_s[index][order]),
                        "departure_s": float(plan.departures_s[index][order]),
                    }
                    for order, pond in enumerate(route)
                ],
                "return_leg_length_m": float(plan.leg_lengths_m[index][-1]),
            }
            for index, route in enumerate(plan.routes)
        ],
        "unserved": [{"pond": pond, "id": farm.ponds[pond].id} for pond in plan.unserved],
    }
    faults = list(differences("", content, expected))
    if faults:
        raise InvalidInput(faults)
    return FarmPlan(replace(farm, notes=(*farm.notes, NOTE)), fleet, solution)


def _problem(farm: Farm, fleet: Mapping[str, Any]) -> Problem:
    """The task with the times of version 1."""
    service_s = _service_s(fleet)
    sampling_points = np.array([pond.sampling_point for pond in farm.ponds], dtype=np.float64)
    return Problem(
        (0.0, 0.0),
        LocalFrame(*farm.depot).to_local(sampling_points),
        fleet["num_drones"],
        service_durations_s=np.array([service_s if pond.service_s is None else pond.service_s for pond in farm.ponds]),
        speed_m_s=fleet["speed_m_s"],
        leg_stop_s=fleet["leg_stop_s"],
        max_length_m=np.inf if fleet["max_route_length_m"] is None else fleet["max_route_length_m"],
        max_duration_s=np.inf if fleet["max_route_duration_s"] is None else fleet["max_route_duration_s"],
    )


def _service_s(fleet: Mapping[str, Any]) -> float:
    """Time on station as version 1 had it: landing at 0.5 m/s from any height, 7 m up from the water in 6.7 s."""
    height_m, dwell_s = float(fleet["transit_height_m"]), float(fleet["dwell_s"])
    if fleet["sampling"] == "splashdown":
        return height_m / 0.5 + 2.4 + dwell_s + 6.7 + (height_m - 7.0) / 2.5
    return 9.8 + (height_m - float(fleet["dip_height_m"]) - 5.0) * (1.0 / 1.5 + 1.0 / 2.5) + dwell_s


def _fleet(content: Mapping[str, Any]) -> Fleet:
    settings = {key: content[key] for key in _FLEET_KEYS}
    # Version 1 planned with times on the water that no mission can hold; what was planned is in the problem.
    settings["dwell_s"] = max(1.0, float(math.ceil(content["dwell_s"])))
    return fleet_of(settings, content["assumptions"])
