"""OR-Tools' routing library, as the paper's authors configured it, and as one would today.

The problem: at most m routes through all ponds, the total plus 100 times the longest route (the global span) as short
as possible. OR-Tools builds a first plan along cheapest arcs and improves it by local search within constraint
programming; the simplex solver GLOP, after which the paper names this baseline, takes no part. Local search looks at
O(n^2) neighbours and more for each step.

- `solve_as_authors`: the configuration of Davis, Mukherjee, Wills and Ouyang, *Path Planning Algorithms for Robotic
  Aquaculture Monitoring*: local search until no neighbour is better, distances as ``int(1000 * d)``. They come from a
  Python callback, which takes more than half of the run time: a matrix leads to the same plan. The callback stays,
  because the paper's run times have it. The authors also limited each route to 3.0, which some farms cannot be
  planned with; here limits are those of the problem.
- `solve_guided`: guided local search (Voudouris and Tsang, *Guided local search and its application to the traveling
  salesman problem*, EJOR 1999) with a registered matrix, finer distances and a time limit.

OR-Tools keeps the interpreter while it solves and loses what a callback raises, so that after a plain Ctrl-C it would
go on with wrong distances. Here Ctrl-C cancels the search, which then returns its best plan.
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Any

from ortools.constraint_solver import pywrapcp, routing_enums_pb2

from pondhop._core import Problem
from pondhop.baselines import integers
from pondhop.documents.signals import STOPPING_SIGNALS, STOPS
from pondhop.errors import Fault, InvalidInput

SPAN_COST = 100
"""What a unit of the longest route costs; a unit of the total costs 1."""

AUTHORS_UNITS = 1000.0
"""Units in one unit of length or second, as the authors have it."""

GUIDED_SECONDS_PER_NODE = 0.1
"""How long `solve_guided` takes where neither a time limit nor solutions are given: for each pond and the depot."""

DEPOT = 0


def solve_as_authors(problem: Problem, *, time_limit_s: float | None = None) -> tuple[list[list[int]], float, bool]:
    """Plan as the paper's authors did: cheapest arcs, then local search until no neighbour is better.

    Parameters
    ----------
    problem
        What is to be planned. Its limits hold, up to the rounding of each leg down to a thousandth.
    time_limit_s
        Wall time in seconds, which the authors did not limit. OR-Tools' first plan is made in any case.

    Returns
    -------
    routes : list of list of int
        Pond indices per route in flying order, the depot implied at both ends: at most one route per drone, every pond
        once. The same for the same problem, where no time limit ends the search.
    elapsed_s : float
        Wall time in seconds from the problem's coordinates to finished routes.
    is_interrupted : bool
        Whether Ctrl-C ended the search; the routes are the best so far.

    Raises
    ------
    InvalidInput
        If OR-Tools finds no plan that keeps the limits of the drones, or if there are more than
        `integers.MAX_PONDS` ponds.
    """
    start_s = time.perf_counter()
    legs = integers.legs_of(problem)
    costs = integers.truncated(legs.costs_s, problem.max_duration_s, AUTHORS_UNITS, 1 + SPAN_COST)
    lengths = integers.truncated(legs.lengths_m, problem.max_length_m, AUTHORS_UNITS, 1 + SPAN_COST)
    model = _model(problem, costs, lengths, is_called_back=True)
    parameters = _parameters(start_s, time_limit_s)
    return _solved(model, parameters, start_s)


def solve_guided(
    problem: Problem, *, time_limit_s: float | None = None, max_solutions: int | None = None
) -> tuple[list[list[int]], float, bool]:
    """Plan by guided local search.

    Parameters
    ----------
    problem
        What is to be planned. Its limits hold.
    time_limit_s
        Wall time in seconds; without it and `max_solutions` `GUIDED_SECONDS_PER_NODE`. OR-Tools' first plan is made
        in any case.
    max_solutions
        Ends the search after so many plans, each a step of the local search.

    Returns
    -------
    routes, elapsed_s, is_interrupted
        As `solve_as_authors`.

    Raises
    ------
    InvalidInput
        As `solve_as_authors`.
    """
    start_s = time.perf_counter()
    if time_limit_s is None and max_solutions is None:
        time_limit_s = GUIDED_SECONDS_PER_NODE * (problem.num_ponds + 1)
    legs = integers.legs_of(problem)
    costs = integers.fine(legs.costs_s, problem.max_duration_s)
    lengths = integers.fine(legs.lengths_m, problem.max_length_m)
    model = _model(problem, costs, lengths, is_called_back=False)
    parameters = _parameters(start_s, time_limit_s)
    parameters.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    if max_solutions is not None:
        parameters.solution_limit = max_solutions
    return _solved(model, parameters, start_s)


@dataclass(frozen=True)
class _Model:
    """OR-Tools' model and its numbering of the places."""

    routing: Any
    manager: Any


def _model(
    problem: Problem, costs: integers.IntegerMatrix, lengths: integers.IntegerMatrix, *, is_called_back: bool
) -> _Model:
    """State the problem: all ponds, at most one route a drone, the total plus `SPAN_COST` times the longest."""
    num_routes = min(problem.num_drones, problem.num_ponds)
    manager = pywrapcp.RoutingIndexManager(problem.num_ponds + 1, num_routes, DEPOT)
    routing = pywrapcp.RoutingModel(manager)
    rows = costs.legs.tolist()

    def cost(from_index: int, to_index: int) -> int:
        leg: int = rows[manager.IndexToNode(from_index)][manager.IndexToNode(to_index)]
        return leg

    if is_called_back:
        transit = routing.RegisterTransitCallback(cost)
    else:
        transit = routing.RegisterTransitMatrix(rows)
        # Python answers Ctrl-C between its own steps, and asking for this limit is the only one.
        routing.AddSearchMonitor(routing.solver().CustomLimit(lambda: False))
    routing.SetArcCostEvaluatorOfAllVehicles(transit)
    _add_dimension(routing, transit, "cost", costs)
    routing.GetDimensionOrDie("cost").SetGlobalSpanCostCoefficient(SPAN_COST)
    if lengths.limit is not None:
        _add_dimension(routing, routing.RegisterTransitMatrix(lengths.legs.tolist()), "length", lengths)
    return _Model(routing, manager)


def _add_dimension(routing: Any, transit: int, name: str, matrix: integers.IntegerMatrix) -> None:
    """Add up the legs along every route, from 0 to the limit."""
    limit = matrix.horizon if matrix.limit is None else matrix.limit
    routing.AddDimension(transit, 0, limit, True, name)


def _parameters(start_s: float, time_limit_s: float | None) -> Any:
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    parameters.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PATH_CHEAPEST_ARC
    if time_limit_s is not None:
        left_s = time_limit_s - (time.perf_counter() - start_s)
        parameters.time_limit.FromMicroseconds(max(1, int(1e6 * left_s)))
    return parameters


def _solved(model: _Model, parameters: Any, start_s: float) -> tuple[list[list[int]], float, bool]:
    with _cancelled_by_signals(model.routing) as interrupt:
        assignment = model.routing.SolveWithParameters(parameters)
        if model.routing.status() == routing_enums_pb2.RoutingSearchStatus.ROUTING_FAIL_TIMEOUT:
            parameters.ClearField("time_limit")
            parameters.solution_limit = 1
            assignment = model.routing.SolveWithParameters(parameters)
    if assignment is None:
        if interrupt.is_set():
            raise KeyboardInterrupt
        message = "OR-Tools found no plan that keeps the limits of the drones"
        raise InvalidInput([Fault("planner", message, "raise the limits or the number of drones")])
    routes = _routes(model, assignment)
    return routes, time.perf_counter() - start_s, interrupt.is_set()


def _routes(model: _Model, assignment: Any) -> list[list[int]]:
    """Return the ponds of each drone that flies."""
    routes = []
    for vehicle in range(model.routing.vehicles()):
        route = []
        index = assignment.Value(model.routing.NextVar(model.routing.Start(vehicle)))
        while not model.routing.IsEnd(index):
            route.append(model.manager.IndexToNode(index) - 1)
            index = assignment.Value(model.routing.NextVar(index))
        if route:
            routes.append(route)
    return routes


@contextmanager
def _cancelled_by_signals(routing: Any) -> Iterator[threading.Event]:
    """Let Ctrl-C cancel the search, and whatever else stops the command line; yield whether it came."""
    interrupt = threading.Event()

    def cancel(number: int, _frame: FrameType | None) -> None:
        STOPS.last = number
        interrupt.set()
        routing.CancelSearch()

    with ExitStack() as handlers:
        for number in STOPPING_SIGNALS if threading.current_thread() is threading.main_thread() else ():
            before = signal.getsignal(number)
            # Ctrl-C where Python would answer it; of other signals only those that we answer ourselves.
            if before == STOPS.stop or (number == signal.SIGINT and callable(before)):
                handlers.callback(signal.signal, number, signal.signal(number, cancel))
        yield interrupt
