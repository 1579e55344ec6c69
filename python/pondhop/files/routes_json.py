"""The plans of research farms as JSON: what ``pondhop solve`` writes and ``pondhop evaluate`` judges.

A list with one object a farm, in the order of the farms; docs/reference/cli.md describes the fields.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from pondhop import _core
from pondhop._core import Problem
from pondhop.documents.atomic import check_is_file_or_absent
from pondhop.errors import Fault, InvalidInput
from pondhop.solution import Solution, gap_percent

PARTIAL_SUFFIX = ".partial"
"""Of the name of a file that is being written."""


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


class PlansWriter:
    """Writes the plans of research farms as they come: a JSON list with one object a line.

    With a path, what is finished stands in ``NAME.partial`` at once, so that nothing but the farm under way is lost
    whatever ends the program; it takes the place of the file in the end.

    Parameters
    ----------
    path
        The file; `None` where `stream` takes the text.
    stream
        Takes the text as well, piece by piece.
    """

    def __init__(self, path: Path | None, stream: Callable[[str], object] | None = None) -> None:
        self._path, self._stream, self.num_plans = path, stream, 0
        self._file = None
        if path is not None:
            check_is_file_or_absent(path)
            path.parent.mkdir(parents=True, exist_ok=True)
            self._partial = path.with_name(path.name + PARTIAL_SUFFIX)
            self._file = self._partial.open("w", encoding="utf-8", newline="")

    def add(self, solution: Solution) -> None:
        """Write the plan of the next farm."""
        separator = ",\n" if self.num_plans else "[\n"
        self._put(separator + json.dumps(_record(self.num_plans, solution)))
        self.num_plans += 1

    def finish(self) -> None:
        """End the list, and put the file in its place."""
        self._put("\n]\n" if self.num_plans else "[]\n")
        if self._file is not None and self._path is not None:
            self._file.close()
            self._partial.replace(self._path)

    def abandon(self) -> None:
        """Give up: what is finished stays in ``NAME.partial``, if anything is."""
        if self._file is not None:
            self._file.close()
            if not self.num_plans:
                self._partial.unlink()

    def _put(self, text: str) -> None:
        if self._file is not None:
            self._file.write(text)
            self._file.flush()
        if self._stream is not None:
            self._stream(text)


def read_routes(path: Path) -> list[list[list[int]]]:
    """Read the routes of every farm: pond indices per route, per farm.

    Parameters
    ----------
    path
        A file that `PlansWriter` wrote, or any JSON list of objects with ``routes``.

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
    except (ValueError, RecursionError) as error:
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
