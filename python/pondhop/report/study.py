"""The runs that the report asks for, and their execution."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from pathlib import Path
from statistics import fmean

from pondhop import _core
from pondhop._core import Problem
from pondhop.bench.execute import execute
from pondhop.bench.farm_sets import BenchFarm, Task, generate_farm_set
from pondhop.bench.measure import Entrant, Request, Run, TimeLimit
from pondhop.bench.results import Results
from pondhop.bench.summary import SAME_LENGTH
from pondhop.report.methods import ANYTIME, LONG_SEARCH, SEARCH, WITHIN_LIMITS_S, LeftOut, Method
from pondhop.report.scope import FARM_SEED, NUM_ROUTES, PLANNER_SEED, Scope


@dataclass(frozen=True)
class SearchWithin:
    """A planner: `search` for the least total with no route longer than that of another plan.

    Attributes
    ----------
    max_route_length
        The longest route allowed.
    """

    max_route_length: float

    def __call__(self, problem: Problem, seed: int, time_limit_s: float | None) -> list[list[int]]:
        """Plan; where no plan is found that is as balanced, the longest route is as short as it gets."""
        # On a research farm, where drones fly at speed 1 and never stop, a second is a length unit.
        limited = problem.replace(max_duration_s=self.max_route_length)
        routes, *_ = _core.search(limited, seed=seed, time_limit_s=time_limit_s, objective="total")
        return routes


@dataclass(frozen=True)
class Study:
    """Planners and farms.

    Attributes
    ----------
    scope
        Which farms, and how many.
    methods
        Those that can run here.
    left_out
        Those that cannot.
    """

    scope: Scope
    methods: Sequence[Method]
    left_out: Sequence[LeftOut] = ()

    @cached_property
    def farms(self) -> dict[int, list[BenchFarm]]:
        """The sets by number of ponds: those of Table 1 and the larger ones."""
        scope = self.scope
        sizes = dict.fromkeys(scope.scaling_num_ponds, scope.scaling_num_farms)
        sizes |= dict.fromkeys(scope.num_ponds, scope.num_farms)
        return {size: generate_farm_set(size, sizes[size], seed=FARM_SEED) for size in sorted(sizes)}

    @property
    def rivals(self) -> list[Method]:
        """What `search` is compared with: the paper's methods, today's solvers and planners of your own."""
        return [method for method in self.methods if method.kind != "ours" or method.printed is not None]

    @cached_property
    def pairs(self) -> list[tuple[Method, int]]:
        """Each rival with each set of Table 1 of which it planned farms."""
        return [(rival, size) for rival in self.rivals for size in self.scope.num_ponds if self.table(rival, size)]

    def table(self, method: Method, num_ponds: int) -> list[Request]:
        """Return the runs of a method on a set of Table 1."""
        farms = self.farms[num_ponds][: self.scope.num_farms_of(method, num_ponds)]
        return [_request(farm, method) for farm in farms]

    def anytime(self, method: Method, num_ponds: int, limit_s: float) -> list[Request]:
        """Return the runs of a planner with a time limit for the plot of quality against time."""
        farms = self.farms[num_ponds][: self.scope.anytime_num_farms]
        return [replace(_request(farm, method), time_limit=TimeLimit(limit_s)) for farm in farms]

    def scaling(self, method: Method, num_ponds: int) -> list[Request]:
        """Return the runs of a method on a set of larger farms."""
        farms = self.farms[num_ponds][: self.scope.num_scaling_farms_of(method, num_ponds)]
        return [_request(farm, method) for farm in farms]

    def repeats(self, method: Method) -> list[tuple[Request, Request]]:
        """Return runs of a method on farms of the smallest set, each with a second one that should give the same."""
        first = self.table(method, min(self.scope.num_ponds))[: self.scope.num_repeats]
        return [(request, _again(request)) for request in first]

    def pictured(self, method: Method) -> list[Request]:
        """Return the run of a method on the farm that figure 3 shows, nothing if that would take too long."""
        num_ponds = self.scope.figure_num_ponds[1]
        if not self.scope.num_farms_of(method, num_ponds):
            return []
        return [_request(self.farms[num_ponds][self.scope.figure_farm], method)]

    def anytime_methods(self) -> list[Method]:
        """Return one method for each planner that gets better with more time."""
        found = {method.name: method for method in self.methods if method.name in ANYTIME}
        return list(found.values())

    def shown_methods(self) -> list[Method]:
        """Return the methods that figures show: one for each planner, and of `search` the one that rivals meet."""
        found: dict[str, Method] = {}
        for method in self.methods:
            if method.name not in found or method == SEARCH:
                found[method.name] = method
        return list(found.values())

    def compared_methods(self) -> list[Method]:
        """Return what Table 1 and the scaling plot compare: the methods that figures show, and `LONG_SEARCH`."""
        return [*self.shown_methods(), *(method for method in self.methods if method == LONG_SEARCH)]

    def requests(self) -> list[Request]:
        """Return all runs but those of `within`, each once, smaller farms first."""
        scope = self.scope
        groups: list[Iterable[Request]] = []
        for num_ponds in self.farms:
            sets = self.table if num_ponds in scope.num_ponds else self.scaling
            groups += [sets(method, num_ponds) for method in self.methods]
            if num_ponds in scope.anytime_num_ponds:
                groups += [
                    self.anytime(method, num_ponds, limit_s)
                    for method in self.anytime_methods()
                    for limit_s in scope.anytime_limits_of(method)
                ]
        groups += [self.pictured(method) for method in self.shown_methods()]
        groups += [[again for _, again in self.repeats(method)] for method in self.methods]
        return list({request.key: request for request in chain.from_iterable(groups)}.values())


class Measurements:
    """The finished runs of a study.

    Parameters
    ----------
    study
        What was asked for.
    results
        What is finished.
    """

    def __init__(self, study: Study, results: Results) -> None:
        self.study = study
        self._runs = {run.key: run for run in results.runs}
        self._results = results

    def runs(self, requests: Iterable[Request]) -> list[Run]:
        """Return the runs that were asked for, in that order.

        Raises
        ------
        KeyError
            If one is not finished.
        """
        return [self._runs[request.key] for request in requests]

    @cached_property
    def _routes(self) -> dict[tuple[object, ...], list[list[int]]]:
        return self._results.routes()

    def routes(self, request: Request) -> list[list[int]]:
        """Return the plan of a finished run."""
        return self._routes[request.key]

    @cached_property
    def all_runs(self) -> list[Run]:
        """Every run of the study."""
        within = (self.within(rival, size, limit_s) for rival, size in self.study.pairs for limit_s in WITHIN_LIMITS_S)
        finished = [request for request in chain(*within) if request.key in self._runs]
        return self.runs([*self.study.requests(), *finished])

    def within(self, rival: Method, num_ponds: int, limit_s: float) -> list[Request]:
        """Return for each run of a rival one of `search` that may fly routes as long as the rival's longest."""
        rival_runs = self.runs(self.study.table(rival, num_ponds))
        return [
            Request(
                Task(farm, NUM_ROUTES),
                Entrant(f"search within {rival.label}", SearchWithin(run.max_route_length)),
                TimeLimit(limit_s),
                PLANNER_SEED,
            )
            for farm, run in zip(self.study.farms[num_ponds], rival_runs, strict=False)
        ]

    def seconds_for_total(self, rival: Method, num_ponds: int) -> float | None:
        """Return the least of `WITHIN_LIMITS_S` in which `search` is no worse than a rival, `None` if none is enough.

        Averages count: the total is no longer than the rival's, and neither is the longest route.
        """
        theirs = self.runs(self.study.table(rival, num_ponds))
        for limit_s in WITHIN_LIMITS_S:
            requests = self.within(rival, num_ponds, limit_s)
            if not all(request.key in self._runs for request in requests):
                return None
            ours = self.runs(requests)
            if is_no_longer(ours, theirs, "total_length") and is_no_longer(ours, theirs, "max_route_length"):
                return limit_s
        return None

    def next_within(self, limit_s: float) -> list[Request]:
        """Return the runs of `within` with this limit where no lower limit was enough."""
        return [
            request
            for rival, size in self.study.pairs
            if self.seconds_for_total(rival, size) is None
            for request in self.within(rival, size, limit_s)
        ]


def is_no_longer(ours: Sequence[Run], theirs: Sequence[Run], quantity: str) -> bool:
    """Return whether the average of a length is that of the others, up to rounding, or less."""
    mine, other = (fmean(getattr(run, quantity) for run in runs) for runs in (ours, theirs))
    return mine <= other * (1 + SAME_LENGTH)


def execute_study(
    study: Study, folder: Path, *, num_jobs: int = 1, advance: Callable[[float], object]
) -> tuple[Measurements, int]:
    """Run what is missing of a study.

    Parameters
    ----------
    study
        What to run.
    folder
        Where results.csv and plans.jsonl are, or will be.
    num_jobs
        How many run at once.
    advance
        Called after each run with the seconds that it was expected to take.

    Returns
    -------
    Measurements
        All runs of the study.
    int
        How many of them are new.

    Raises
    ------
    InvalidInput
        As `pondhop.solve`, or if there is a file of another kind in the folder.
    BrokenProcessPool
        If a process dies, as for want of memory. Whatever is raised, finished runs stay.
    """
    results = Results(folder, is_keeping_plans=True)
    num_new = 0

    def run_missing(requests: Sequence[Request]) -> None:
        nonlocal num_new
        finished = results.finished
        missing = [request for request in requests if request.key not in finished]
        execute(missing, results, num_jobs=num_jobs, advance=lambda request: advance(expected_seconds(study, request)))
        num_new += len(missing)

    run_missing(study.requests())
    # What the rivals' longest routes are is known only now, and what they take to match only step by step.
    for limit_s in WITHIN_LIMITS_S:
        run_missing(Measurements(study, results).next_within(limit_s))
    return Measurements(study, results), num_new


def seconds_missing(study: Study, folder: Path) -> float:
    """Return the seconds that the missing runs of a study are expected to take on one core.

    The comparisons within a rival's longest route are not counted: which they are is known when the others are done.
    """
    finished = Results(folder, is_keeping_plans=True).finished
    return sum(expected_seconds(study, request) for request in study.requests() if request.key not in finished)


def expected_seconds(study: Study, request: Request) -> float:
    """Return the seconds that a run is expected to take."""
    if request.time_limit.seconds is not None:
        return request.time_limit.seconds
    label, num_ponds = request.entrant.label, len(request.task.farm.farm.ponds)
    return max((method.seconds(num_ponds) for method in study.methods if method.planner == label), default=0.0)


def _request(farm: BenchFarm, method: Method) -> Request:
    return Request(Task(farm, NUM_ROUTES), method.entrant, method.time_limit, PLANNER_SEED)


def _again(request: Request) -> Request:
    farm = request.task.farm
    again = BenchFarm(f"{farm.set_name} again", farm.index, farm.farm)
    return replace(request, task=Task(again, request.task.num_routes))
