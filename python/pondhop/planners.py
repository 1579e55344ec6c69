"""The family of planners by name, and planning with one of them.

A planner is a function from a problem to routes. Those of this package are in `PLANNERS`; a function of your own is
passed in place of a name: ``solve(problem, planner=my_planner)``.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import TYPE_CHECKING

from pondhop import _core
from pondhop._core import Problem
from pondhop.errors import Fault, InvalidInput
from pondhop.planfile import FarmPlan, Solution

if TYPE_CHECKING:
    from pondhop.farm import Farm
    from pondhop.fleet import Fleet

Routes = Sequence[Sequence[int]]
PlannerFunction = Callable[[Problem, int, float | None], Routes]
"""A planner of your own: problem, seed and time limit in seconds (`None`: as long as it takes) -> routes.

Routes hold pond indices in flying order, the depot implied at both ends; at most ``problem.num_drones`` of them.
"""


@dataclass(frozen=True)
class Effort:
    """How hard a planner tries.

    Attributes
    ----------
    seed
        Of all random choices: the same seed gives the same routes.
    time_limit_s
        Wall time from coordinates to finished routes; `None` lets the planner decide. One-shot planners ignore it.
    threads
        How many threads the planner may use. Planners that know only one ignore it.
    """

    seed: int = 1
    time_limit_s: float | None = None
    threads: int = 1


@dataclass(frozen=True)
class Planner:
    """A planner of this package.

    Attributes
    ----------
    name
        As in ``planner=`` and ``--planner``.
    description
        One line for help and tables.
    routes
        Problem and effort -> routes, and the seconds from coordinates to finished routes.
    """

    name: str
    description: str
    routes: Callable[[Problem, Effort], tuple[Routes, float]]


PLANNERS = {
    planner.name: planner
    for planner in (
        Planner(
            "hpp",
            "the paper's planner: k-means clusters, each flown back and forth; a territory for every drone",
            lambda problem, effort: _core.hpp(problem, seed=effort.seed),
        ),
    )
}
"""The planners of this package by name."""


def solve(
    problem: Problem,
    *,
    planner: str | PlannerFunction = "hpp",
    seed: int = 1,
    time_limit_s: float | None = None,
    threads: int = 1,
) -> Solution:
    """Plan routes for a problem.

    Parameters
    ----------
    problem
        What is to be planned.
    planner
        A name in `PLANNERS`, or a function of your own (see `PlannerFunction`).
    seed, time_limit_s, threads
        See `Effort`.

    Returns
    -------
    Solution
        The routes as `pondhop.evaluate` judges them: a plan that breaks a rule is returned with its ``violations``.

    Raises
    ------
    InvalidInput
        If the planner is unknown, an option has no meaning, or a route names a pond that does not exist.
    """
    effort = Effort(seed, time_limit_s, threads)
    faults = _faults(effort)
    chosen = _chosen(planner, faults)
    if chosen is None or faults:
        raise InvalidInput(faults)
    cpu_start_s = time.process_time()
    routes, elapsed_s = chosen.routes(problem, effort)
    cpu_s = time.process_time() - cpu_start_s
    return Solution(
        problem=problem,
        plan=_core.evaluate(problem, routes),
        planner=chosen.name,
        seed=seed,
        elapsed_s=elapsed_s,
        cpu_s=cpu_s,
        lower_bound=_core.lower_bound(problem),
    )


def plan(
    farm: Farm,
    fleet: Fleet,
    *,
    planner: str | PlannerFunction = "hpp",
    seed: int = 1,
    time_limit_s: float | None = None,
    threads: int = 1,
) -> FarmPlan:
    """Plan a round over a farm for a fleet.

    Parameters
    ----------
    farm
        See `pondhop.read_farm`.
    fleet
        The drones and how they sample.
    planner, seed, time_limit_s, threads
        See `solve`.

    Returns
    -------
    FarmPlan
        Lengths in metres, durations in seconds; pond indices are those of ``farm.ponds``.

    Raises
    ------
    InvalidInput
        As `solve`.
    """
    problem = farm.to_problem(fleet)
    solution = solve(problem, planner=planner, seed=seed, time_limit_s=time_limit_s, threads=threads)
    separation = _core.separation(problem, solution.plan.routes)
    return FarmPlan(farm=farm, fleet=fleet, solution=replace(solution, separation=separation))


def _faults(effort: Effort) -> list[Fault]:
    faults = []
    if not 0 <= effort.seed < 2**64:
        faults.append(Fault("seed", f"{effort.seed} is not a whole number from 0 to 2^64 - 1", "choose another seed"))
    if effort.time_limit_s is not None and not effort.time_limit_s > 0:
        faults.append(Fault("time_limit_s", f"{effort.time_limit_s} is not above 0", "give seconds, or leave it out"))
    if effort.threads < 1:
        faults.append(Fault("threads", f"{effort.threads} is below 1", "give at least one thread"))
    return faults


def _chosen(planner: str | PlannerFunction, faults: list[Fault]) -> Planner | None:
    """Return the planner meant, or add the fault that there is none."""
    if callable(planner):
        return _timed(planner)
    if planner not in PLANNERS:
        close = get_close_matches(planner, PLANNERS, n=1)
        action = f"did you mean {close[0]!r}?" if close else f"choose one of: {', '.join(PLANNERS)}"
        faults.append(Fault("planner", f"there is no planner {planner!r}", action))
        return None
    return PLANNERS[planner]


def _timed(function: PlannerFunction) -> Planner:
    """Put a function of the user into the shape of our planners."""

    def routes(problem: Problem, effort: Effort) -> tuple[Routes, float]:
        start = time.perf_counter()
        found = function(problem, effort.seed, effort.time_limit_s)
        return found, time.perf_counter() - start

    name = getattr(function, "__name__", type(function).__name__)
    return Planner(name, (function.__doc__ or "").partition("\n")[0], routes)
