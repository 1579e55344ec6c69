"""PyVRP, made to balance by shrinking the longest distance that it allows.

The problem: at most m routes through all ponds, the longest as short as possible, then the total. PyVRP (Wouda, Lan and
Kool, *PyVRP: a high-performance VRP solver package*, INFORMS J. Computing 2024; today an iterated local search)
minimises the total and has no objective for the longest route, but a limit on it. Its users balance with that limit,
and so does this planner:

1. Any plan.
2. Lower the limit below the longest route and solve from the best plan so far, until a plan keeps the limit. First the
   limit is halved; each time that no plan is found in a twelfth of the effort, the step is halved.
3. For the last fifth of the effort, the shortest total that keeps the longest route.

PyVRP's *distance* holds our seconds, which in research farms are lengths: that is what it minimises, and limits at
little cost. Its *duration* holds our lengths, where a problem limits them. Matrices and neighbour lists take O(n^2).
"""

from __future__ import annotations

import time
import warnings

import numpy as np
import pyvrp
from pyvrp.exceptions import PenaltyBoundWarning
from pyvrp.stop import FirstFeasible, MultipleCriteria, StoppingCriterion

from pondhop._core import Problem
from pondhop.baselines import integers
from pondhop.errors import Fault, InvalidInput

SECONDS_PER_NODE = 0.1
"""How long `solve` takes where neither a time limit nor iterations are given: for each pond and the depot."""

SHARE_OF_ATTEMPT = 1 / 12
SHARE_OF_SHRINKING = 0.8
"""Shares of the effort: the most that one limit is tried for, and all that is spent on the longest route."""

FIRST_STEP = 0.5
"""Share by which the limit is first lowered."""


def solve(
    problem: Problem, *, seed: int = 1, time_limit_s: float | None = None, iterations: int | None = None
) -> tuple[list[list[int]], float, bool]:
    """Plan by solving again and again with a lower limit on the routes.

    Parameters
    ----------
    problem
        What is to be planned. Its limits hold.
    seed
        Of PyVRP's random numbers. The same seed and iterations give the same routes, if no time limit ends the search.
    time_limit_s
        Wall time in seconds; without it and `iterations` `SECONDS_PER_NODE`. PyVRP's first plan is made in any case.
    iterations
        Steps of PyVRP's local search, over all limits.

    Returns
    -------
    routes : list of list of int
        Pond indices per route in flying order, the depot implied at both ends: at most one route per drone, every pond
        once.
    elapsed_s : float
        Wall time in seconds from the problem's coordinates to finished routes.
    is_interrupted : bool
        Whether Ctrl-C ended the search; the routes are the best so far.

    Raises
    ------
    InvalidInput
        If PyVRP finds no plan that keeps the limits of the drones, or there are more than `integers.MAX_PONDS` ponds.
    """
    start_s = time.perf_counter()
    if time_limit_s is None and iterations is None:
        time_limit_s = SECONDS_PER_NODE * (problem.num_ponds + 1)
    search = _Search(problem, seed, _Effort(start_s, time_limit_s, iterations))
    is_interrupted = False
    try:
        search.shrink_longest_route()
        search.shorten_total()
    except KeyboardInterrupt:
        is_interrupted = True
    return search.routes(), time.perf_counter() - start_s, is_interrupted


class _Effort:
    """What may be spent, and what is: wall time, iterations, or both."""

    def __init__(self, start_s: float, time_limit_s: float | None, iterations: int | None) -> None:
        self._start_s = start_s
        self._time_limit_s = time_limit_s
        self._iterations = iterations
        self._num_iterations = 0

    def spent(self) -> float:
        """Return the share of the effort that is used up."""
        share = 0.0
        if self._time_limit_s is not None:
            share = (time.perf_counter() - self._start_s) / self._time_limit_s
        if self._iterations is not None:
            share = max(share, self._num_iterations / self._iterations)
        return share

    def until(self, share: float) -> StoppingCriterion:
        """Return what ends a run of PyVRP at a share of the effort, and counts its iterations."""

        def is_used_up(best_cost: int) -> bool:  # noqa: ARG001 - PyVRP's signature
            if self.spent() >= share:
                return True
            self._num_iterations += 1
            return False

        return is_used_up


class _Search:
    """The best plan so far, and how PyVRP improves it."""

    def __init__(self, problem: Problem, seed: int, effort: _Effort) -> None:
        """Find any plan."""
        legs = integers.legs_of(problem)
        costs = integers.fine(legs.costs_s, problem.max_duration_s)
        lengths = integers.fine(legs.lengths_m, problem.max_length_m)
        self._data = _data(problem, costs, lengths)
        self._lower_bound = int((costs.legs[0] + costs.legs[:, 0]).max())
        self._seeds = np.random.default_rng(seed)
        self._effort = effort
        best = self._solved(self._data, None, [FirstFeasible(), effort.until(1.0)])
        if best is None:
            message = "PyVRP found no plan that keeps the limits of the drones"
            raise InvalidInput([Fault("planner", message, "raise the limits, the number of drones or the time limit")])
        self._best = best

    def shrink_longest_route(self) -> None:
        """Lower the limit on the routes as far as plans are found."""
        step = FIRST_STEP
        while self._effort.spent() < SHARE_OF_SHRINKING and (longest := _longest(self._best)) > self._lower_bound:
            limit = min(max(int(longest * (1.0 - step)), self._lower_bound), longest - 1)
            share = min(self._effort.spent() + SHARE_OF_ATTEMPT, SHARE_OF_SHRINKING)
            found = self._solved(self._limited(limit), self._best, [FirstFeasible(), self._effort.until(share)])
            if found is None:
                step /= 2.0
            else:
                self._best = found

    def shorten_total(self) -> None:
        """Shorten the total with the rest of the effort, the longest route growing no longer."""
        found = self._solved(self._limited(_longest(self._best)), self._best, [self._effort.until(1.0)])
        self._best = found or self._best

    def routes(self) -> list[list[int]]:
        """Return the pond indices of each route in flying order."""
        return _visits(self._best)

    def _limited(self, limit: int) -> pyvrp.ProblemData:
        """Return the problem with a limit on the routes."""
        return self._data.replace(vehicle_types=[self._data.vehicle_type(0).replace(max_distance=limit)])

    def _solved(
        self, data: pyvrp.ProblemData, start: pyvrp.Solution | None, criteria: list[StoppingCriterion]
    ) -> pyvrp.Solution | None:
        """Run PyVRP, from the routes of another plan if there is one; return its plan, or `None` if it found none."""
        with warnings.catch_warnings():
            # Limits that no plan can keep are part of the search; PyVRP warns when its penalties do not help.
            warnings.simplefilter("ignore", PenaltyBoundWarning)
            result = pyvrp.solve(
                data,
                MultipleCriteria(criteria),
                seed=int(self._seeds.integers(2**32)),
                collect_stats=False,
                initial_solution=pyvrp.Solution(data, _visits(start)) if start is not None else None,
            )
        return result.best if result.is_feasible() else None


def _data(problem: Problem, costs: integers.IntegerMatrix, lengths: integers.IntegerMatrix) -> pyvrp.ProblemData:
    """State the problem: all ponds, at most one route a drone, limits."""
    vehicle_type = pyvrp.VehicleType(min(problem.num_drones, problem.num_ponds))
    if costs.limit is not None:
        vehicle_type = vehicle_type.replace(max_distance=costs.limit)
    durations = np.zeros_like(lengths.legs)
    if lengths.limit is not None:
        vehicle_type = vehicle_type.replace(shift_duration=lengths.limit)
        durations = lengths.legs
    return pyvrp.ProblemData(
        locations=[pyvrp.Location(x, y) for x, y in (problem.depot, *problem.ponds)],
        clients=[pyvrp.Client(pond + 1) for pond in range(problem.num_ponds)],
        depots=[pyvrp.Depot(0)],
        vehicle_types=[vehicle_type],
        distance_matrices=[costs.legs],  # type: ignore[list-item] # its stub mistakes the shape for the type
        duration_matrices=[durations],  # type: ignore[list-item]
    )


def _longest(solution: pyvrp.Solution) -> int:
    return max(route.distance() for route in solution.routes())


def _visits(solution: pyvrp.Solution) -> list[list[int]]:
    """Return the ponds of each route; PyVRP numbers its clients as we number ponds."""
    return [[stop.idx for stop in route if stop.is_client()] for route in solution.routes()]
