"""The plans of research farms as JSON: what ``pondhop solve`` writes and ``pondhop evaluate`` judges.

A list with one object a farm, in the order of the farms; docs/reference/cli.md describes the fields.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pondhop import _core
from pondhop._core import Problem
from pondhop.errors import Fault, InvalidInput
from pondhop.solution import Solution, gap_percent


@dataclass(frozen=True)
class Judgement:
    """What `pondhop.evaluate` finds out about the routes of one farm.

    Attributes
    ----------
    index
        Of the farm in its file.
    num_ponds, num_routes
        Sizes of the farm and of the plan.
    route_lengths, max_route_length, total_length
        In the units of the farm.
    lower_bound, gap_percent
        No plan has a shorter longest route than the bound; the gap is the excess over it, `None` where the bound is 0.
    overlap
        Area shared by the hulls of different routes as a share of the area of the farm's hull.
    num_crossings
        How often routes of different drones cross.
    is_feasible, violations
        The broken rules, a sentence each.
    """

    index: int
    num_ponds: int
    num_routes: int
    route_lengths: list[float]
    max_route_length: float
    total_length: float
    lower_bound: float
    gap_percent: float | None
    overlap: float
    num_crossings: int
    is_feasible: bool
    violations: list[str]


def judge(index: int, problem: Problem, routes: Sequence[Sequence[int]]) -> Judgement:
    """Judge the routes of one farm.

    Raises
    ------
    InvalidInput
        If a route names a pond that does not exist.
    """
    plan = _core.evaluate(problem, routes)
    separation = _core.separation(problem, routes)
    lower_bound = _core.lower_bound(problem)
    return Judgement(
        index=index,
        num_ponds=problem.num_ponds,
        num_routes=len(plan.routes),
        route_lengths=plan.route_lengths.tolist(),
        max_route_length=plan.max_route_length,
        total_length=plan.total_length,
        lower_bound=lower_bound,
        gap_percent=gap_percent(plan.max_route_length, lower_bound),
        overlap=separation.overlap,
        num_crossings=separation.num_crossings,
        is_feasible=plan.is_feasible,
        violations=[str(violation) for violation in plan.violations],
    )


def solutions_json(solutions: Sequence[Solution]) -> str:
    """Return the JSON list, one farm a line."""
    records = (_record(index, solution) for index, solution in enumerate(solutions))
    return "[\n" + ",\n".join(map(json.dumps, records)) + "\n]\n"


def read_routes(path: Path) -> list[list[list[int]]]:
    """Read the routes of every farm: pond indices per route, per farm.

    Parameters
    ----------
    path
        A file that `solutions_json` made, or any JSON list of objects with ``routes``.

    Returns
    -------
    list of list of list of int
        Whether the ponds exist is for `pondhop.evaluate` to say.

    Raises
    ------
    InvalidInput
        With every object that holds no routes.
    OSError
        If the file cannot be read.
    """
    try:
        document = json.loads(path.read_bytes())
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise InvalidInput([Fault(str(path), f"this is not JSON: {error}", "give a file of 'pondhop solve'")]) from None
    if not isinstance(document, list):
        action = "give a file of 'pondhop solve'"
        raise InvalidInput([Fault(str(path), f"a list was expected, not {type(document).__name__}", action)])
    faults = [
        Fault(f"{path}[{index}].routes", "a list of lists of pond indices was expected", "name ponds by 0-based index")
        for index, record in enumerate(document)
        if not _has_routes(record)
    ]
    if faults:
        raise InvalidInput(faults)
    return [record["routes"] for record in document]


def _record(index: int, solution: Solution) -> dict[str, object]:
    plan = solution.plan
    return {
        "index": index,
        "planner": solution.planner,
        "seed": solution.seed,
        "elapsed_s": solution.elapsed_s,
        "routes": plan.routes,
        "route_lengths": plan.route_lengths.tolist(),
        "max_route_length": plan.max_route_length,
        "total_length": plan.total_length,
        "lower_bound": solution.lower_bound,
    }


def _has_routes(record: object) -> bool:
    routes = record.get("routes") if isinstance(record, dict) else None
    return isinstance(routes, list) and all(
        isinstance(route, list)
        and all(isinstance(pond, int) and not isinstance(pond, bool) and pond >= 0 for pond in route)
        for route in routes
    )
