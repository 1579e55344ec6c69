"""One run of one planner on one farm: what is asked, the measurement, and the record of it."""

from __future__ import annotations

import dataclasses
import importlib
import math
import platform
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pondhop import __version__, _core, planners
from pondhop._core import Problem
from pondhop.bench.farm_sets import Task
from pondhop.bench.provenance import build_digest, commit, machine
from pondhop.errors import Fault, InvalidInput

if TYPE_CHECKING:
    from pondhop.planners import PlannerFunction

SECONDS_OF_WARM_UP = 0.1
"""At most; a planner that counts iterations stops after one."""


@dataclass(frozen=True)
class Entrant:
    """A planner and the options it is run with.

    Attributes
    ----------
    label
        What tables call it.
    planner
        A name in `pondhop.PLANNERS`, or a function of your own that other processes can import.
    options
        Arguments of `pondhop.solve` beside planner, seed and time limit.
    """

    label: str
    planner: str | PlannerFunction
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class TimeLimit:
    """How long a planner may take for a farm.

    Attributes
    ----------
    seconds
        `None` leaves it to the planner.
    is_per_node
        Whether the seconds are for each pond and the depot, as the literature on the min-max travelling salesmen
        has it.
    """

    seconds: float | None = None
    is_per_node: bool = False

    def __str__(self) -> str:
        if self.seconds is None:
            return "none"
        return f"{self.seconds:g} s/node" if self.is_per_node else f"{self.seconds:g} s"

    def of(self, num_ponds: int) -> float | None:
        """Return the seconds for a farm of so many ponds."""
        if self.seconds is None:
            return None
        return self.seconds * (num_ponds + 1) if self.is_per_node else self.seconds


@dataclass(frozen=True)
class Request:
    """A run that is asked for."""

    task: Task
    entrant: Entrant
    time_limit: TimeLimit
    seed: int

    @property
    def key(self) -> tuple[object, ...]:
        """What tells this run from others; see `Run.key`."""
        farm = self.task.farm
        name = (farm.set_name, farm.index, farm.digest)
        build = build_digest(self.entrant.planner)
        return (*name, self.task.num_routes, self.entrant.label, str(self.time_limit), self.seed, build)


@dataclass(frozen=True)
class Run:
    """A finished run: a row of results.csv.

    Attributes
    ----------
    set_name, farm, digest
        The set, the index of the farm in it, and what its positions hash to.
    num_ponds, num_routes
        How many ponds there are, and how many routes were allowed.
    planner, time_limit, seed
        Label of the entrant, time limit as asked (``0.1 s``, ``0.1 s/node``, ``none``), seed.
    time_limit_s
        The seconds the planner was given; NaN for no limit.
    max_route_length, total_length
        Of the plan, in the units of the farm.
    lower_bound
        No plan has a shorter longest route.
    overlap, num_crossings
        See `pondhop.separation`.
    num_routes_used, num_missed, num_violations
        Routes with ponds, ponds in no route, broken rules.
    elapsed_s, cpu_s
        Wall time from coordinates to finished routes, and the processor time of all threads meanwhile.
    version, commit, build
        Of pondhop; the commit is empty outside a checkout; `build` is a hash of the code that plans.
    python, machine, finished_at
        Where and when (UTC).
    """

    set_name: str
    farm: int
    digest: str
    num_ponds: int
    num_routes: int
    planner: str
    time_limit: str
    time_limit_s: float
    seed: int
    max_route_length: float
    total_length: float
    lower_bound: float
    overlap: float
    num_crossings: int
    num_routes_used: int
    num_missed: int
    num_violations: int
    elapsed_s: float
    cpu_s: float
    version: str
    commit: str
    build: str
    python: str
    machine: str
    finished_at: str

    @property
    def key(self) -> tuple[object, ...]:
        """Set, farm, digest, routes, planner, limit, seed and build: a second run of the same key is the same run."""
        name = (self.set_name, self.farm, self.digest)
        return (*name, self.num_routes, self.planner, self.time_limit, self.seed, self.build)


def parse_entrants(text: str) -> list[Entrant]:
    """Return the planners and options of ``name,name:option=value:option=value,module:function``.

    Options are the fields of `pondhop.planners.Options` that hold a number or a word; a short run on two ponds shows
    whether the planner is there and takes their values. ``module:function`` is a planner of your own: see
    `pondhop.planners.PlannerFunction`.

    Raises
    ------
    InvalidInput
        With everything that is wrong.
    """
    faults: list[Fault] = []
    entrants = [_parse_entrant(part.strip(), faults) for part in text.split(",")]
    labels = [entrant.label for entrant in entrants]
    for label in sorted({label for label in labels if labels.count(label) > 1}):
        faults.append(Fault(f"planner {label}", "this planner is there twice", "give each planner once"))
    if faults:
        raise InvalidInput(faults)
    return entrants


def _parse_entrant(text: str, faults: list[Fault]) -> Entrant:
    name, *assignments = text.split(":")
    planner: str | PlannerFunction = name
    if assignments and "=" not in assignments[0] and name not in planners.PLANNERS:
        function = _imported(name, assignments.pop(0), faults)
        if function is None:
            return Entrant(text, name)
        planner = function
    options: dict[str, int | float | str] = {}
    known = {option.name for option in dataclasses.fields(planners.Options)} - {
        "seed",
        "time_limit_s",
        "start",
        "progress",
    }
    for assignment in assignments:
        option, equals, value = assignment.partition("=")
        if equals and option in known:
            options[option] = _value(value)
        else:
            action = f"give OPTION=VALUE with one of: {', '.join(sorted(known))}"
            faults.append(Fault(f"planner {text}", f"{assignment!r} is not an option of a planner", action))
    entrant = Entrant(text, planner, options)
    try:
        warm_up(entrant)
    except InvalidInput as error:
        faults += [Fault(f"planner {text}: {fault.path}", fault.message, fault.action) for fault in error.faults]
    return entrant


def _imported(module_name: str, function_name: str, faults: list[Fault]) -> PlannerFunction | None:
    """Return the function, or add the fault that there is none. What its module raises is for its author to see."""
    place = f"planner {module_name}:{function_name}"
    action = "give MODULE:FUNCTION of a planner of your own, its module in the current folder or installed"
    if not all(part.isidentifier() for part in module_name.split(".")):
        faults.append(Fault(place, f"{module_name!r} is not the name of a module", action))
        return None
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{module_name}.".startswith(f"{error.name}."):
            raise
        faults.append(Fault(place, f"there is no module {error.name!r}", action))
        return None
    function: PlannerFunction | None = getattr(module, function_name, None)
    if not callable(function):
        faults.append(Fault(place, f"there is no function {function_name!r} in {module_name}", action))
        return None
    return function


def _value(text: str) -> bool | int | float | str:
    if text in ("True", "False"):
        return text == "True"
    for number in (int, float):
        try:
            return number(text)
        except ValueError:
            continue
    return text


def warm_up(entrant: Entrant) -> None:
    """Plan two ponds, so that what a planner loads once is not in the time of its first farm.

    Raises
    ------
    InvalidInput
        If there is no such planner or an option has no meaning.
    """
    problem = Problem((0.0, 0.0), np.array([[0.0, 1.0], [1.0, 0.0]]), 2)
    options = {"iterations": 1, "time_limit_s": SECONDS_OF_WARM_UP} | dict(entrant.options)
    with _told_of(entrant):
        planners.solve(problem, planner=entrant.planner, **options)


def measure(request: Request) -> tuple[Run, list[list[int]]]:
    """Run the planner and judge its plan.

    Returns
    -------
    tuple of Run and list of list of int
        The record and the routes.

    Raises
    ------
    InvalidInput
        As `pondhop.solve`.
    """
    farm, num_ponds = request.task.farm, len(request.task.farm.farm.ponds)
    problem = farm.farm.to_problem(request.task.num_routes)
    time_limit_s = request.time_limit.of(num_ponds)
    entrant = request.entrant
    with _told_of(entrant):
        solution = planners.solve(
            problem, planner=entrant.planner, seed=request.seed, time_limit_s=time_limit_s, **entrant.options
        )
    plan = solution.plan
    separation = _core.separation(problem, plan.routes)
    run = Run(
        set_name=farm.set_name,
        farm=farm.index,
        digest=farm.digest,
        num_ponds=num_ponds,
        num_routes=request.task.num_routes,
        planner=entrant.label,
        time_limit=str(request.time_limit),
        time_limit_s=math.nan if time_limit_s is None else time_limit_s,
        seed=request.seed,
        max_route_length=plan.max_route_length,
        total_length=plan.total_length,
        lower_bound=solution.lower_bound,
        overlap=separation.overlap,
        num_crossings=separation.num_crossings,
        num_routes_used=sum(bool(route) for route in plan.routes),
        num_missed=len(plan.unserved),
        num_violations=len(plan.violations),
        elapsed_s=solution.elapsed_s,
        cpu_s=solution.cpu_s,
        version=__version__,
        commit=commit(),
        build=build_digest(entrant.planner),
        python=platform.python_version(),
        machine=machine(),
        finished_at=datetime.now(UTC).isoformat(timespec="seconds"),
    )
    return run, plan.routes


@contextmanager
def _told_of(entrant: Entrant) -> Iterator[None]:
    """Say of a planner of the user's own that fails that it is theirs, and how."""
    try:
        yield
    except InvalidInput:
        raise
    except Exception as error:
        if not callable(entrant.planner):
            raise
        where = traceback.extract_tb(error.__traceback__)[-1]
        message = f"it raises {type(error).__name__}: {error} ({Path(where.filename).name}, line {where.lineno})"
        raise InvalidInput(
            [Fault(entrant.label, message, "correct the planner, and try it with pondhop.solve")]
        ) from error
