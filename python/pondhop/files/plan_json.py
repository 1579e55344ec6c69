"""``plan.json``: a plan with its schedule and what it was made for, the contract for other programs.

docs/reference/json.md describes it, ``documents/schemas/plan-1.json`` is its schema.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any

from pondhop._core import Separation, __version__, evaluate, separation
from pondhop.documents.atomic import write_all
from pondhop.documents.schemas import read_json
from pondhop.errors import Fault, InvalidInput
from pondhop.farm.model import Farm, Pond
from pondhop.fleet import Fleet
from pondhop.places import LonLat, Ring
from pondhop.solution import FarmPlan, Solution

SCHEMA = "pondhop-plan/1"

_RELATIVE_TOLERANCE = 1e-6
_ABSOLUTE_TOLERANCE = 1e-3
"""How far the numbers of a file may be from what the evaluator finds: a millimetre, a millisecond, or rounding."""

_REMEDY = "change the routes only by planning again: all numbers of a plan follow from them"


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
        "violations": [str(violation) for violation in plan.violations],
        "unserved": [{"pond": pond, "id": farm.ponds[pond].id} for pond in plan.unserved],
        "notes": list(farm_plan.notes),
    }


def _separation_object(measured: Separation) -> dict[str, Any]:
    return {"overlap": measured.overlap, "num_crossings": measured.num_crossings}


def _route_object(farm_plan: FarmPlan, index: int) -> dict[str, Any]:
    plan = farm_plan.solution.plan
    route = plan.routes[index]
    leg_lengths_m = plan.leg_lengths_m[index].tolist()
    stops = []
    for order, pond in enumerate(route):
        longitude, latitude = farm_plan.farm.ponds[pond].sampling_point
        stops.append(
            {
                "pond": pond,
                "id": farm_plan.farm.ponds[pond].id,
                "lon_deg": longitude,
                "lat_deg": latitude,
                "leg_length_m": leg_lengths_m[order],
                "arrival_s": float(plan.arrivals_s[index][order]),
                "departure_s": float(plan.departures_s[index][order]),
            }
        )
    return {
        "drone": index + 1,
        "length_m": float(plan.route_lengths[index]),
        "duration_s": float(plan.route_durations_s[index]),
        "stops": stops,
        "return_leg_length_m": leg_lengths_m[-1],
    }


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
