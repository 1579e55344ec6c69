"""The family of planners by name, and planning with one of them.

A planner is a function from a problem to routes. Those of this package are in `PLANNERS`; a function of your own is
passed in place of a name: ``solve(problem, planner=my_planner)``.
"""

from __future__ import annotations

import inspect
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from functools import partial
from typing import Literal, TypedDict, Unpack, get_args

import numpy as np

from pondhop import _core, missions, nights
from pondhop._core import Problem
from pondhop.arguments import Arguments, shown
from pondhop.encounters import held_apart
from pondhop.errors import Fault, InvalidInput
from pondhop.farm.model import Farm
from pondhop.farm.words import pond_called
from pondhop.fleet import CALM, Fleet, Wind
from pondhop.proofs import Proofs
from pondhop.solution import FarmPlan, FarmViolation, Solution

Routes = Sequence[Sequence[int]]
PlannerFunction = Callable[[Problem, int, float | None], Routes]
"""A planner of your own: problem, seed and time limit in seconds (`None`: as long as it takes) -> routes.

Routes hold pond indices in flying order, the depot implied at both ends; at most ``problem.num_drones`` of them.
"""


SEARCH_STEPS_PER_POND, MOST_STEPS_BY_POND = 8_000, 500_000
"""Steps of `search` where neither time limit nor iterations are given: by pond on small farms, up to about a second."""

LEAST_SEARCH_STEPS_PER_POND, MOST_SEARCH_STEPS = 1_000, 20_000_000
"""Steps by pond on large farms: two milliseconds a pond, up to about a minute."""

ORTOOLS, PYVRP = "ortools>=9.12,<10", "pyvrp>=0.14.1,<0.15"
"""What the rivals need, as pip is asked for it; the extra ``baselines`` of pyproject.toml says the same."""

STEPS_PER_POND_OF_SIZING = 500
"""Steps of a search that finds out whether a number of drones is enough."""

LIMIT_KINDS = ("too_long", "too_slow", "too_much_energy")
"""Violations that more drones may cure."""

ADVISED = ("auto", "search", "territory")
"""Planners that keep the limits of a route wherever they find a plan that does."""

_LIMIT_NAMES = {
    "too_long": "max_route_length_m",
    "too_slow": "max_route_duration_s",
    "too_much_energy": "what the battery gives above its reserve",
}

LEAST_SECONDS, MOST_SECONDS, MOST_THREADS = sys.float_info.min, 1e7, 1024
"""Beyond these a limit of time or a number of threads is a slip of the fingers."""

Objective = Literal["max", "total"]
Decoding = Literal["greedy", "symmetries", "sampling"]
"""How the attention models choose: the likeliest at every step; the best of that for the farm turned and mirrored in
all eight ways; the best of plans drawn with the model's probabilities."""
_OBJECTIVES, _DECODINGS = get_args(Objective), get_args(Decoding)
ProgressFunction = Callable[[float, int, float], object]
"""Told about ten times a second: longest route so far in seconds, iterations, share of the effort used."""


@dataclass(frozen=True)
class Options:
    """How hard a planner tries, and for what. A planner passes over what it has no use for; the solution says so.

    Attributes
    ----------
    seed
        Of all random choices: the same seed and iterations give the same routes.
    time_limit_s
        Wall time from coordinates to finished routes; `None` lets the planner decide.
    threads
        How many threads the planner may use.
    iterations
        Steps of the search, in place of a time limit or beside one; plans drawn where ``decoding`` is ``sampling``.
    slack_percent
        How much the longest route may grow to shorten the total, within the time a drone can be under way.
    objective
        ``max``: the longest route, then the total; ``total``: the total.
    start
        Routes to begin with.
    progress
        See `ProgressFunction`.
    has_separate_airspace
        Whether every drone must keep to a territory of its own.
    decoding
        See `Decoding`.
    """

    seed: int = 1
    time_limit_s: float | None = None
    threads: int = 1
    iterations: int | None = None
    slack_percent: float = 0.0
    objective: Objective = "max"
    start: Routes | None = None
    progress: ProgressFunction | None = None
    has_separate_airspace: bool = False
    decoding: Decoding = "greedy"


_DEFAULTS = tuple((field.name, field.default) for field in fields(Options))


class PlainOptions(TypedDict, total=False):
    """The fields of `Options` that can be said in words and numbers, for type checkers and editors."""

    seed: int
    time_limit_s: float | None
    threads: int
    iterations: int | None
    slack_percent: float
    objective: Objective
    has_separate_airspace: bool
    decoding: Decoding


class OptionFields(PlainOptions, total=False):
    """All fields of `Options`."""

    start: Routes | None
    progress: ProgressFunction | None


@dataclass(frozen=True)
class Planned:
    """What a planner returns.

    Attributes
    ----------
    routes
        Pond indices per route in flying order.
    elapsed_s
        From coordinates to finished routes.
    is_interrupted
        Whether Ctrl-C ended the planning; the routes are the best so far.
    reason
        What was chosen and why, where the planner chose.
    """

    routes: Routes
    elapsed_s: float
    is_interrupted: bool = False
    reason: str = ""


def _nothing_more(_options: Options) -> frozenset[str]:
    return frozenset()


@dataclass(frozen=True)
class Planner:
    """A planner of this package.

    Attributes
    ----------
    name
        As in ``planner=`` and ``--planner``.
    description
        One line for help and tables.
    run
        Plans a problem as wished.
    obeys
        Fields of `Options` beside seed and progress that it always has a use for.
    also_obeys
        Those that it has a use for besides, where the others are as they are.
    is_airspace_shared
        Whether drones cross each other's airspace, so that separate airspace cannot be asked for.
    """

    name: str
    description: str
    run: Callable[[Problem, Options], Planned]
    obeys: frozenset[str]
    also_obeys: Callable[[Options], frozenset[str]] = _nothing_more
    is_airspace_shared: bool = False

    def passed_over(self, options: Options) -> tuple[str, ...]:
        """Return the options that were asked for and that the planner has no use for."""
        obeyed = self.obeys | self.also_obeys(options) | {"seed", "progress"}
        asked = [name for name, default in _DEFAULTS if getattr(options, name) != default]
        return tuple(name for name in asked if name not in obeyed)


_OF_SEARCH = frozenset({"time_limit_s", "threads", "iterations", "slack_percent", "objective", "start"})
_OF_TERRITORY = frozenset({"time_limit_s", "iterations", "has_separate_airspace"})


def _of_what_auto_chooses(options: Options) -> frozenset[str]:
    return _OF_TERRITORY if options.has_separate_airspace else _OF_SEARCH


def _of_decoding(options: Options) -> frozenset[str]:
    return frozenset({"iterations"}) if options.decoding == "sampling" else frozenset()


def _search_iterations(problem: Problem, options: Options) -> int | None:
    """Return how many steps to search: as asked, or by the size of the farm, so that every machine finds the same."""
    if options.time_limit_s is not None or options.iterations is not None:
        return options.iterations
    steps = min(SEARCH_STEPS_PER_POND * problem.num_ponds, MOST_STEPS_BY_POND)
    return max(steps, min(LEAST_SEARCH_STEPS_PER_POND * problem.num_ponds, MOST_SEARCH_STEPS))


def _search(problem: Problem, options: Options) -> Planned:
    routes, elapsed_s, _, is_interrupted = _core.search(
        problem,
        seed=options.seed,
        time_limit_s=options.time_limit_s,
        iterations=_search_iterations(problem, options),
        threads=options.threads,
        slack=options.slack_percent / 100,
        objective=options.objective,
        start=options.start,
        progress=options.progress,
    )
    return Planned(routes, elapsed_s, is_interrupted)


def _hpp(problem: Problem, options: Options) -> Planned:
    return Planned(*_core.hpp(problem, seed=options.seed))


def _territory(problem: Problem, options: Options) -> Planned:
    planned = _core.territory(
        problem,
        seed=options.seed,
        time_limit_s=options.time_limit_s,
        iterations=options.iterations,
        progress=options.progress,
    )
    return Planned(*planned)


def _auto(problem: Problem, options: Options) -> Planned:
    """Choose between `search` and `territory`, and how long to search."""
    if options.has_separate_airspace:
        reason = "territory, because separate airspace is asked for"
        return replace(_territory(problem, options), reason=reason)
    if options.time_limit_s is not None:
        how_long = f"{options.time_limit_s:g} s, as asked"
    elif options.iterations is not None:
        how_long = f"{options.iterations} steps, as asked"
    else:
        how_long = f"{_search_iterations(problem, options):,} steps, by the number of ponds"
    reason = f"search for {how_long}; it has the shortest routes where drones may share airspace"
    return replace(_search(problem, options), reason=reason)


@contextmanager
def _needed(requirement: str) -> Iterator[None]:
    """Import what needs a package that may be missing; name the remedy where it is."""
    try:
        yield
    except ModuleNotFoundError as error:
        package, _, _ = (error.name or "").partition(".")
        action = f"install it with: pip install '{requirement}'"
        raise InvalidInput([Fault("planner", f"it needs {package}, which is not installed", action)]) from error


def _ortools(problem: Problem, options: Options) -> Planned:
    with _needed(ORTOOLS):
        from pondhop.baselines import ortools
    return Planned(*ortools.solve_as_authors(problem, time_limit_s=options.time_limit_s))


def _ortools_gls(problem: Problem, options: Options) -> Planned:
    with _needed(ORTOOLS):
        from pondhop.baselines import ortools
    found = ortools.solve_guided(problem, time_limit_s=options.time_limit_s, max_solutions=options.iterations)
    return Planned(*found)


def _pyvrp(problem: Problem, options: Options) -> Planned:
    with _needed(PYVRP):
        from pondhop.baselines import pyvrp
    found = pyvrp.solve(problem, seed=options.seed, time_limit_s=options.time_limit_s, iterations=options.iterations)
    return Planned(*found)


def _attention(name: Literal["am50", "am_minmax"], problem: Problem, options: Options) -> Planned:
    from pondhop.baselines import attention

    return Planned(
        *attention.plan(problem, name, decoding=options.decoding, num_samples=options.iterations, seed=options.seed)
    )


PLANNERS = {
    planner.name: planner
    for planner in (
        Planner(
            "auto",
            "chooses planner and effort from the size of the farm, the time limit and whether airspace is separate",
            _auto,
            _OF_SEARCH & _OF_TERRITORY,
            _of_what_auto_chooses,
        ),
        Planner(
            "search",
            "the shortest longest route, then the shortest total, as good as the time allows",
            _search,
            _OF_SEARCH,
            is_airspace_shared=True,
        ),
        Planner(
            "hpp",
            "the paper's planner: k-means clusters, each flown back and forth; a territory for every drone",
            _hpp,
            frozenset({"has_separate_airspace"}),
        ),
        Planner(
            "territory",
            "balanced and short routes, each in a territory of its own: the hulls of their ponds do not touch",
            _territory,
            _OF_TERRITORY,
        ),
        Planner(
            "ortools",
            "OR-Tools as the paper's authors used it, who call it GLOP: descent from cheapest arcs until stuck",
            _ortools,
            frozenset({"time_limit_s"}),
            is_airspace_shared=True,
        ),
        Planner(
            "ortools-gls",
            "OR-Tools with guided local search for a time limit",
            _ortools_gls,
            frozenset({"time_limit_s", "iterations"}),
            is_airspace_shared=True,
        ),
        Planner(
            "pyvrp",
            "PyVRP, balanced by lowering its limit on the distance of a route as far as plans are found",
            _pyvrp,
            frozenset({"time_limit_s", "iterations"}),
            is_airspace_shared=True,
        ),
        Planner(
            "am",
            "the paper's attention model: trained for the least total; may use more routes than there are drones",
            partial(_attention, "am50"),
            frozenset({"decoding"}),
            _of_decoding,
            is_airspace_shared=True,
        ),
        Planner(
            "am-minmax",
            "an attention model trained for the shortest longest route; never more routes than drones",
            partial(_attention, "am_minmax"),
            frozenset({"decoding"}),
            _of_decoding,
            is_airspace_shared=True,
        ),
    )
}
"""The planners of this package by name."""


def solve(
    problem: Problem,
    *,
    planner: str | PlannerFunction = "auto",
    **options: Unpack[OptionFields],
) -> Solution:
    """Plan routes for a problem.

    Parameters
    ----------
    problem
        What is to be planned.
    planner
        A name in `PLANNERS`, or a function of your own (see `PlannerFunction`).
    **options
        Fields of `Options`, as in ``seed=7, time_limit_s=0.1``.

    Returns
    -------
    Solution
        The routes as `pondhop.evaluate` judges them: a plan that breaks a rule is returned with its ``violations``.

    Raises
    ------
    InvalidInput
        If the planner is unknown, an option has no meaning, or a route names a pond that does not exist.
    """
    wishes = _wishes(options)
    chosen, planner_faults = _chosen(planner)
    faults = [*_faults(wishes, problem, chosen), *planner_faults]
    if chosen is None or faults:
        raise InvalidInput(faults)
    if not isinstance(wishes.seed, int):
        wishes = replace(wishes, seed=int(wishes.seed))
    cpu_start_s = time.process_time()
    planned = chosen.run(_levelled(problem, problem.layers.max(axis=0, initial=0.0)), wishes)
    cpu_s = time.process_time() - cpu_start_s
    return Solution(
        problem=problem,
        plan=_core.evaluate(problem, _hungriest_lowest(problem, planned.routes)),
        planner=chosen.name,
        seed=wishes.seed,
        elapsed_s=planned.elapsed_s,
        cpu_s=cpu_s,
        is_interrupted=planned.is_interrupted,
        reason=planned.reason,
        passed_over=chosen.passed_over(wishes),
    )


def plan(
    farm: Farm,
    fleet: Fleet,
    *,
    wind: Wind = CALM,
    is_deconflicted: bool = False,
    planner: str | PlannerFunction = "auto",
    **options: Unpack[OptionFields],
) -> FarmPlan:
    """Plan a round over a farm for a fleet.

    Where the fleet changes batteries (``swap_s``), there is wind, ponds have time windows, or the round has an end, it
    is planned as trips by `pondhop.nights`; else each drone flies one route.

    Parameters
    ----------
    farm
        See `pondhop.read_farm`.
    fleet
        The drones and how they sample.
    wind
        How strong it blows and where from.
    is_deconflicted
        Whether trips are held back on the ground until no two drones come too near to each other: see
        `pondhop.encounters`.
    planner, **options
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
    arguments = Arguments()
    arguments.kind("farm", farm, Farm, "give a pondhop.Farm, as pondhop.read_farm returns it")
    arguments.kind("fleet", fleet, Fleet, "give a pondhop.Fleet, as in pondhop.Fleet(num_drones=3)")
    arguments.kind("wind", wind, Wind, "give a pondhop.Wind, as in pondhop.Wind(8.0, 225.0)")
    arguments.truth("is_deconflicted", is_deconflicted)
    arguments.check()
    if is_deconflicted or nights.needs_round(farm, fleet, wind):
        farm_plan = _plan_round(farm, fleet, wind, planner, options)
        farm_plan = held_apart(farm_plan) if is_deconflicted else farm_plan
        return replace(farm_plan, obstacles=missions.obstacles(farm_plan))
    problem = farm.to_problem(fleet)
    solved = solve(problem, planner=planner, **options)
    solution = replace(solved, separation=_core.separation(problem, solved.plan.routes))
    farm_plan = _in_layers(FarmPlan(farm, fleet, solution))
    beyond: tuple[FarmViolation, ...] = ()
    if any(violation.kind in LIMIT_KINDS for violation in farm_plan.plan.violations):
        beyond = tuple(_ponds_beyond_reach(farm, solution))
        if not beyond and not solution.is_interrupted:
            farm_plan = _with_enough_drones(farm_plan, Options(**options))
    return replace(farm_plan, obstacles=(*beyond, *missions.obstacles(farm_plan)))


_OF_ROUND = frozenset({"time_limit_s", "threads", "iterations", "objective"})
"""Options that the search for rounds knows, besides those that all planners have."""


def _plan_round(
    farm: Farm, fleet: Fleet, wind: Wind, planner: str | PlannerFunction, options: OptionFields
) -> FarmPlan:
    """Return a round of trips: by the search for rounds, or the routes of another planner cut into trips."""
    wishes = _wishes(options)
    chosen, faults = _chosen(planner)
    faults = [*_faults(replace(wishes, start=None), farm.to_problem(fleet), chosen), *faults]
    if wishes.start is not None:
        faults.append(Fault("start", "a round of trips cannot begin with routes yet", "leave it out"))
    if chosen is None or faults:
        raise InvalidInput(faults)
    effort = nights.Effort(
        int(wishes.seed), wishes.time_limit_s, wishes.threads, wishes.iterations, wishes.objective, wishes.progress
    )
    if planner in ("auto", "search"):
        passed_over = replace(PLANNERS["search"], obeys=_OF_ROUND, also_obeys=_nothing_more).passed_over(wishes)
        return nights.plan_round(farm, fleet, wind, effort, passed_over=passed_over)

    def routes(problem: Problem) -> Routes:
        """Plan as if no battery were ever empty; the trips are cut afterwards."""
        limitless = problem.replace(energy=problem.energy.replace(usable_j=float("inf")), layers=None)
        return chosen.run(limitless, wishes).routes

    return nights.plan_round(
        farm, fleet, wind, effort, planner=chosen.name, routes=routes, passed_over=chosen.passed_over(wishes)
    )


def _ponds_beyond_reach(farm: Farm, solution: Solution) -> Iterator[FarmViolation]:
    """Return a violation for each pond that breaks a limit even as the only one of its route."""
    for violation in solution.alone.violations:
        pond = violation.route
        if pond is not None:
            message = (
                f"{pond_called(farm.ponds[pond].id)} is out of reach: alone it breaks {_LIMIT_NAMES[violation.kind]}"
            )
            remedy = "leave the pond out, move the depot nearer to it, or raise the limit if the drones can do it"
            yield FarmViolation("out_of_reach", message, remedy, None, pond, violation.value, violation.limit)


def _levelled(problem: Problem, costs: Sequence[float]) -> Problem:
    """Return a problem for planners, who take all drones for equal: take-off and way home take the same for all."""
    if not len(problem.layers):
        return problem
    takeoff_s, way_home_s, takeoff_j, way_home_j = map(float, costs)
    energy = problem.energy.replace(takeoff_j=takeoff_j, way_home_fixed_j=way_home_j)
    return problem.replace(takeoff_s=takeoff_s, way_home_fixed_s=way_home_s, energy=energy, layers=None)


def _hungriest_lowest(problem: Problem, routes: Routes) -> Routes:
    """Return routes in an order in which those nearest to a limit are flown in the lowest layers.

    Every metre of height takes the same from each of them, so no other order keeps more of them within one limit.
    Where there is none, or energies are unknown, the routes that take longest come first.
    """
    if not len(problem.layers):
        return routes
    plan = _core.evaluate(problem.replace(layers=None), routes)
    shares = np.maximum(
        plan.route_energies_j / problem.energy.usable_j, plan.route_durations_s / problem.max_duration_s
    )
    order = np.lexsort((-plan.route_durations_s, -shares))
    return [plan.routes[index] for index in order]


def _in_layers(farm_plan: FarmPlan) -> FarmPlan:
    """Return a plan with all ways home above all ways out, if drones would come too near to each other without."""
    solution = farm_plan.solution
    if farm_plan.near_drones is None or not isinstance(solution, Solution):
        return farm_plan
    try:
        problem = farm_plan.farm.to_problem(farm_plan.fleet, are_layers_stacked=True)
    except InvalidInput:
        # They do not fit below the highest allowed flight; the plan tells which drones are too near.
        return farm_plan
    plan = _core.evaluate(problem, solution.plan.routes)
    return replace(farm_plan, solution=replace(solution, problem=problem, plan=plan), are_layers_stacked=True)


def _with_enough_drones(farm_plan: FarmPlan, options: Options) -> FarmPlan:
    """Return a plan that breaks a limit with the number of drones that keeps all, or one by which as many drones do.

    Every number is tried as it would be flown, each drone in its layer, and the first with a plan that keeps every
    limit is told: whoever follows the advice comes here again with that number, and gets that plan.
    """
    farm, fleet, solution = farm_plan.farm, farm_plan.fleet, farm_plan.solution
    if not isinstance(solution, Solution):
        return farm_plan
    is_separate = options.has_separate_airspace or solution.planner == "territory"
    proofs = Proofs(solution.problem)

    def found(num_drones: int) -> FarmPlan | None:
        try:
            wider = replace(fleet, num_drones=num_drones)
            problem = farm.to_problem(wider)
        except InvalidInput:
            return None
        if proofs.is_out_of_reach(problem):
            return None
        for costs in (problem.layers.min(axis=0), problem.layers.max(axis=0)):
            levelled = _levelled(problem, costs)
            routes = _sized(levelled, options, is_separate)
            plan = _core.evaluate(problem, _hungriest_lowest(problem, routes))
            flown = _in_layers(FarmPlan(farm, wider, replace(solution, problem=problem, plan=plan)))
            if flown.solution.plan.is_feasible and flown.near_drones is None:
                return flown
            if not _core.evaluate(levelled, routes).is_feasible:
                # Not even if all could fly lowest; higher up there is less to be had.
                return None
        return None

    most = max(fleet.num_drones, len(farm.ponds))
    too_few, enough = fleet.num_drones - 1, fleet.num_drones
    best = found(enough)
    while best is None and enough < most:
        too_few, enough = enough, min(max(enough + 1, enough * 5 // 4), most)
        best = found(enough)
    while best is not None and enough - too_few > 1:
        middle = (too_few + enough) // 2
        fewer = found(middle)
        too_few, enough, best = (too_few, middle, fewer) if fewer else (middle, enough, best)
    if best is None:
        return farm_plan
    if enough == fleet.num_drones and solution.planner in ADVISED:
        separation = _core.separation(best.solution.problem, best.plan.routes)
        return replace(best, solution=replace(best.solution, separation=separation))
    return replace(farm_plan, num_drones_needed=enough)


def _sized(problem: Problem, options: Options, is_separate: bool) -> Routes:
    """Return the routes of a short search."""
    steps = STEPS_PER_POND_OF_SIZING * problem.num_ponds
    if is_separate:
        return _core.territory(problem, seed=options.seed, iterations=steps)[0]
    return _core.search(problem, seed=options.seed, iterations=steps, objective=options.objective)[0]


def _faults(options: Options, problem: Problem, planner: Planner | None) -> list[Fault]:
    arguments = Arguments()
    is_problem = arguments.kind("problem", problem, Problem, "give a pondhop.Problem, as farm.to_problem returns it")
    arguments.whole("seed", options.seed, 0, 2**64 - 1, "give a whole number from 0 to 2^64 - 1")
    if options.time_limit_s is not None:
        action = f"give seconds above 0 and at most {MOST_SECONDS:g}, or leave it out"
        arguments.real("time_limit_s", options.time_limit_s, LEAST_SECONDS, MOST_SECONDS, action)
    arguments.whole("threads", options.threads, 1, MOST_THREADS, f"give the cores there are, 1 to {MOST_THREADS}")
    if options.iterations is not None:
        action = "give a whole number from 1 to 2^63 - 1, or leave it out"
        arguments.whole("iterations", options.iterations, 1, 2**63 - 1, action)
    action = "give per cent, 0 or more, as in 1.5"
    arguments.real("slack_percent", options.slack_percent, 0.0, sys.float_info.max, action)
    arguments.one_of("objective", options.objective, _OBJECTIVES)
    arguments.one_of("decoding", options.decoding, _DECODINGS)
    is_truth = arguments.truth("has_separate_airspace", options.has_separate_airspace)
    if is_truth and options.has_separate_airspace and planner is not None and planner.is_airspace_shared:
        message = f"{planner.name} lets drones share airspace"
        arguments.faults.append(Fault("has_separate_airspace", message, "use auto or territory"))
    if options.progress is not None and not callable(options.progress):
        action = "give a function of the longest route, the iterations and the share of the effort, or leave it out"
        arguments.refuse("progress", options.progress, action)
    faults = arguments.faults
    if options.start is not None and is_problem:
        faults += _start_faults(problem, options.start)
    return faults


def _start_faults(problem: Problem, start: Routes) -> list[Fault]:
    """Return what keeps routes from being a start: a pond missed or visited twice, a route too many."""
    try:
        plan = _core.evaluate(problem, start)
    except InvalidInput as error:
        return [replace(fault, path=f"start.{fault.path}") for fault in error.faults]
    visits = sorted(pond for route in plan.routes for pond in route)
    if visits == list(range(problem.num_ponds)) and len(plan.routes) <= problem.num_drones:
        return []
    return [
        Fault("start", str(violation), "give a plan that only time or length limits may break")
        for violation in plan.violations
    ]


def _chosen(planner: str | PlannerFunction) -> tuple[Planner | None, list[Fault]]:
    """Return the planner meant, or the fault that there is none."""
    action = "give the name of a planner, or a function from problem, seed and time limit to routes"
    if callable(planner):
        if _takes_three(planner):
            return _timed(planner), []
        return None, [Fault("planner", f"{_name_of(planner)} does not take problem, seed and time limit", action)]
    if not isinstance(planner, str):
        return None, [Fault("planner", f"it is {shown(planner)}", action)]
    if planner not in PLANNERS:
        close = get_close_matches(planner, PLANNERS, n=1)
        action = f"did you mean {close[0]!r}?" if close else f"choose one of: {', '.join(PLANNERS)}"
        return None, [Fault("planner", f"there is no planner {planner!r}", action)]
    return PLANNERS[planner], []


def _wishes(options: PlainOptions) -> Options:
    """Return options by name; as everywhere in Python, a name that is none is a `TypeError`."""
    known = [field.name for field in fields(Options)]
    for name in options:
        if name not in known:
            raise TypeError(f"there is no option {name!r}; options are: {', '.join(known)}")
    return Options(**options)


def _takes_three(function: PlannerFunction) -> bool:
    try:
        inspect.signature(function).bind(None, None, None)
    except TypeError:
        return False
    except ValueError:
        # Some functions that are not written in Python do not tell what they take.
        return True
    return True


def _name_of(function: PlannerFunction) -> str:
    return str(getattr(function, "__name__", type(function).__name__))


def _timed(function: PlannerFunction) -> Planner:
    """Put a function of the user into the shape of our planners."""

    def run(problem: Problem, options: Options) -> Planned:
        start = time.perf_counter()
        found = function(problem, options.seed, options.time_limit_s)
        return Planned(found, time.perf_counter() - start)

    return Planner(_name_of(function), (function.__doc__ or "").partition("\n")[0], run, frozenset({"time_limit_s"}))
