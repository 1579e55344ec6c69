"""A plan with what it was made for: results as values, and as JSON and GeoJSON.

``plan.json`` is the contract for other programs (docs/reference/json.md, ``schemas/plan-1.json``); ``plan.geojson`` is
for maps.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from pondhop._core import Plan, Problem, Separation, __version__, evaluate, separation
from pondhop.atomic import write_all
from pondhop.errors import Fault, InvalidInput
from pondhop.farm import Farm, Pond
from pondhop.farm_features import LonLat
from pondhop.farm_geometry import Ring
from pondhop.fleet import Fleet
from pondhop.palette import route_colour
from pondhop.schemas import read_json

SCHEMA = "pondhop-plan/1"

_RELATIVE_TOLERANCE = 1e-6
_ABSOLUTE_TOLERANCE = 1e-3
"""How far the numbers of a file may be from what the evaluator finds: a millimetre, a millisecond, or rounding."""

_REMEDY = "change the routes only by planning again: all numbers of a plan follow from them"


@dataclass(frozen=True)
class Solution:
    """What a planner made of a problem.

    Attributes
    ----------
    problem, plan
        The task and the evaluated routes.
    planner, seed
        How it was made.
    elapsed_s
        Wall time of planning, from coordinates to finished routes.
    lower_bound
        No plan has a shorter longest route, in length units.
    separation
        `None` where nobody measured it.
    cpu_s
        Processor time of all threads of this process while it planned; 0 for a plan that was read.
    is_interrupted
        Whether Ctrl-C ended the planning; the plan is the best so far.
    reason
        What `auto` chose and why; empty for other planners.
    """

    problem: Problem
    plan: Plan
    planner: str
    seed: int
    elapsed_s: float
    lower_bound: float
    separation: Separation | None = None
    cpu_s: float = 0.0
    is_interrupted: bool = False
    reason: str = ""

    @property
    def gap_percent(self) -> float | None:
        """How far the longest route is above the lower bound; `None` if the bound is 0."""
        return gap_percent(self.plan.max_route_length, self.lower_bound)


def gap_percent(max_route_length: float, lower_bound: float) -> float | None:
    """Return how far a longest route is above the lower bound; `None` if the bound is 0."""
    return 100 * (max_route_length - lower_bound) / lower_bound if lower_bound > 0 else None


@dataclass(frozen=True)
class FarmPlan:
    """A solution for a real farm and fleet; pond indices of the routes are those of ``farm.ponds``."""

    farm: Farm
    fleet: Fleet
    solution: Solution

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know before flying, a sentence each."""
        notes = list(self.farm.notes)
        if self.solution.reason:
            notes.append(f"Planner {self.solution.planner} chose {self.solution.reason}.")
        if self.fleet.sampling == "splashdown":
            notes.append(
                "Splashdown: set bit 2 of the ArduPilot parameter MIS_OPTIONS (add 4) on every drone, or it disarms on "
                "the first pond and stays there."
            )
        return tuple(notes)


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
    OSError
        If the file cannot be written.
    """
    text = json.dumps(_plan_object(farm_plan), indent=1, ensure_ascii=False, allow_nan=False)
    write_all({Path(path): text + "\n"})


def write_plan_geojson(path: str | os.PathLike[str], farm_plan: FarmPlan) -> None:
    """Write ``plan.geojson``: a LineString per route, a Point per stop, the depot; styled for maps (simplestyle 1.1).

    Parameters
    ----------
    path
        The file; written whole or not at all.
    farm_plan
        What to write.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    collection = {"type": "FeatureCollection", "features": list(_features(farm_plan))}
    write_all({Path(path): json.dumps(collection, ensure_ascii=False, allow_nan=False) + "\n"})


def read_plan_json(path: str | os.PathLike[str]) -> FarmPlan:
    """Read a ``plan.json``; the routes are evaluated anew, and the file's numbers must agree.

    Parameters
    ----------
    path
        A file as `write_plan_json` writes it.

    Returns
    -------
    FarmPlan
        Equal to the one that was written.

    Raises
    ------
    InvalidInput
        With every place that breaks the schema; if none does, with every number, pond or sentence that disagrees with
        the rest of the file.
    OSError
        If the file cannot be read.
    """
    content = read_json(path, "plan-1")
    farm, fleet = _farm(content["farm"]), _fleet(content["fleet"])
    routes = [[stop["pond"] for stop in route["stops"]] for route in content["routes"]]
    unknown = list(_unknown_ponds(routes, len(farm.ponds)))
    if unknown:
        raise InvalidInput(unknown)
    problem = farm.to_problem(fleet)
    solution = Solution(
        problem=problem,
        plan=evaluate(problem, routes),
        planner=content["planner"],
        seed=content["seed"],
        elapsed_s=content["elapsed_s"],
        lower_bound=content["lower_bound_m"],
        separation=separation(problem, routes) if content["separation"] else None,
    )
    farm_plan = FarmPlan(farm, fleet, solution)
    # All numbers of a plan follow from its routes, so what the file should hold is what we would write.
    faults = list(_differences("", _without_version(content), _without_version(_plan_object(farm_plan))))
    if faults:
        raise InvalidInput(faults)
    return farm_plan


def _plan_object(farm_plan: FarmPlan) -> dict[str, Any]:
    farm, solution = farm_plan.farm, farm_plan.solution
    plan = solution.plan
    return {
        "schema": SCHEMA,
        "pondhop_version": __version__,
        "farm": _listed(asdict(farm)),
        "fleet": _listed(asdict(farm_plan.fleet)),
        "planner": solution.planner,
        "seed": solution.seed,
        "elapsed_s": solution.elapsed_s,
        "lower_bound_m": solution.lower_bound,
        "gap_percent": solution.gap_percent,
        "separation": solution.separation and _separation_object(solution.separation),
        "summary": {
            "num_ponds": len(farm.ponds),
            "num_routes": len(plan.routes),
            "num_unserved": len(plan.unserved),
            "max_route_length_m": plan.max_route_length,
            "total_length_m": plan.total_length,
            "makespan_s": plan.makespan_s,
            "is_feasible": plan.is_feasible,
        },
        "routes": [_route_object(farm_plan, index) for index in range(len(plan.routes))],
        "violations": plan.violations,
        "unserved": [{"pond": pond, "id": farm.ponds[pond].id} for pond in plan.unserved],
        "notes": list(farm_plan.notes),
    }


def _separation_object(measured: Separation) -> dict[str, Any]:
    return {"overlap": measured.overlap, "num_crossings": measured.num_crossings}


def _route_object(farm_plan: FarmPlan, index: int) -> dict[str, Any]:
    problem, plan = farm_plan.solution.problem, farm_plan.solution.plan
    route = plan.routes[index]
    legs = _leg_lengths_m(problem, route)
    stops = []
    for order, pond in enumerate(route):
        longitude, latitude = farm_plan.farm.ponds[pond].sampling_point
        stops.append(
            {
                "pond": pond,
                "id": farm_plan.farm.ponds[pond].id,
                "lon_deg": longitude,
                "lat_deg": latitude,
                "leg_length_m": legs[order],
                "arrival_s": float(plan.arrivals_s[index][order]),
                "departure_s": float(plan.departures_s[index][order]),
            }
        )
    return {
        "drone": index + 1,
        "length_m": float(plan.route_lengths[index]),
        "duration_s": float(plan.route_durations_s[index]),
        "stops": stops,
        "return_leg_length_m": legs[-1],
    }


def _leg_lengths_m(problem: Problem, route: list[int]) -> list[float]:
    """Lengths of the legs from depot to depot, one more than there are stops."""
    path = np.vstack([problem.depot, problem.ponds[route], problem.depot])
    return [float(length) for length in np.hypot(*np.diff(path, axis=0).T)]


def _features(farm_plan: FarmPlan) -> Iterator[dict[str, Any]]:
    farm, plan = farm_plan.farm, farm_plan.solution.plan
    yield _feature("Point", farm.depot, {"role": "depot", "title": "Depot", "marker-symbol": "airfield"})
    for index, route in enumerate(plan.routes):
        colour = route_colour(index)
        positions = [farm.depot, *(farm.ponds[pond].sampling_point for pond in route), farm.depot]
        properties = {
            "role": "route",
            "title": f"Drone {index + 1}",
            "drone": index + 1,
            "num_ponds": len(route),
            "length_m": round(float(plan.route_lengths[index]), 1),
            "duration_s": round(float(plan.route_durations_s[index]), 1),
            "stroke": colour,
            "stroke-width": 3,
            "stroke-opacity": 0.9,
        }
        yield _feature("LineString", positions, properties)
    for index, route in enumerate(plan.routes):
        for order, pond in enumerate(route):
            properties = {
                "role": "stop",
                "title": f"Drone {index + 1}, stop {order + 1}: pond {farm.ponds[pond].id}",
                "drone": index + 1,
                "order": order + 1,
                "pond": pond,
                "id": farm.ponds[pond].id,
                "arrival_s": round(float(plan.arrivals_s[index][order]), 1),
                "departure_s": round(float(plan.departures_s[index][order]), 1),
                "marker-color": route_colour(index),
                "marker-size": "small",
            }
            yield _feature("Point", farm.ponds[pond].sampling_point, properties)


def _feature(kind: str, coordinates: Any, properties: Mapping[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": dict(properties)}


def _farm(content: Mapping[str, Any]) -> Farm:
    return Farm(
        name=content["name"],
        ponds=tuple(
            Pond(pond["id"], _lon_lat(pond["sampling_point"]), _rings(pond["outline"]), pond["service_s"])
            for pond in content["ponds"]
        ),
        depot=_lon_lat(content["depot"]),
        stations=tuple(map(_lon_lat, content["stations"])),
        no_fly=tuple(map(_rings, content["no_fly"])),
        fences=tuple(map(_rings, content["fences"])),
        notes=tuple(content["notes"]),
    )


def _fleet(content: Mapping[str, Any]) -> Fleet:
    settings = {field.name: content[field.name] for field in fields(Fleet)}
    try:
        return Fleet(**settings | {"assumptions": tuple(content["assumptions"])})
    except InvalidInput as error:
        raise InvalidInput(replace(fault, path=f"fleet.{fault.path}") for fault in error.faults) from error


def _lon_lat(position: list[float]) -> LonLat:
    longitude, latitude = position
    return longitude, latitude


def _rings(rings: list[list[list[float]]]) -> tuple[Ring, ...]:
    return tuple(tuple(map(_lon_lat, ring)) for ring in rings)


def _unknown_ponds(routes: list[list[int]], num_ponds: int) -> Iterator[Fault]:
    for route, ponds in enumerate(routes):
        for order, pond in enumerate(ponds):
            if pond >= num_ponds:
                place = f"routes[{route}].stops[{order}].pond"
                yield Fault(place, f"there is no pond {pond}", f"give an index of 0 to {num_ponds - 1}")


def _listed(value: Any) -> Any:
    """Return the value with tuples as lists, as JSON gives them back."""
    if isinstance(value, dict):
        return {key: _listed(item) for key, item in value.items()}
    return [_listed(item) for item in value] if isinstance(value, tuple | list) else value


def _without_version(content: Mapping[str, Any]) -> dict[str, Any]:
    """Leave out what another version of pondhop may rightly write differently."""
    return {key: value for key, value in content.items() if key not in ("pondhop_version", "notes")}


def _differences(path: str, found: Any, expected: Any) -> Iterator[Fault]:
    """Every place where a file does not say what its routes imply."""
    if isinstance(expected, dict) and isinstance(found, dict):
        for key in expected:
            yield from _differences(f"{path}.{key}".removeprefix("."), found.get(key), expected[key])
    elif isinstance(expected, list) and isinstance(found, list):
        if len(expected) != len(found):
            yield Fault(path, f"it has {len(found)} items, but the routes of the file give {len(expected)}", _REMEDY)
            return
        for index, (found_item, expected_item) in enumerate(zip(found, expected, strict=True)):
            yield from _differences(f"{path}[{index}]", found_item, expected_item)
    elif not _agree(found, expected):
        yield Fault(path, f"it is {found!r}, but the routes of the file give {expected!r}", _REMEDY)


def _agree(found: Any, expected: Any) -> bool:
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in (found, expected))
    if numbers:
        return math.isclose(found, expected, rel_tol=_RELATIVE_TOLERANCE, abs_tol=_ABSOLUTE_TOLERANCE)
    return bool(found == expected)
