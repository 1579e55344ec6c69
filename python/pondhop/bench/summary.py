"""Averages of the runs, and the Markdown page that shows them.

Gaps are excesses in per cent: over the longest route (or the total) of the best plan known of the farm, and over the
lower bound of the farm. The best plan known is that of a best-known file where it has one, and there a gap below 0 is a
new best; else it is the best of these runs that breaks no rule.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Any, TypeVar

from pondhop.bench.best_known import BestKnown, BestPlan
from pondhop.bench.measure import Run
from pondhop.errors import Fault, InvalidInput
from pondhop.solution import gap_percent

SAME_LENGTH = 1e-6
"""Lengths that differ by a smaller share are the same: best-known files round."""

_Row = TypeVar("_Row")


@dataclass(frozen=True)
class SetSummary:
    """The runs of one planner with one time limit on the farms of a set that have the same number of ponds.

    Attributes
    ----------
    set_name, num_ponds, num_routes, planner, time_limit, build
        What the runs have in common; see `Run`.
    num_farms, num_runs
        How many are averaged.
    max_route_length, total_length
        Averages.
    gap_percent, worst_gap_percent
        Of the longest route to the best known: average and worst; `None` where the best known is 0.
    total_gap_percent
        Of the total to that of the best plan known: average where it is known, else `None`.
    bound_gap_percent
        Of the longest route to the lower bound: average; `None` where the bound is 0.
    overlap, num_crossings, num_routes_used
        Averages.
    num_missed, num_violations
        Sums; 0 for a sound planner. A plan that misses ponds is shorter than it may be: its gaps mean nothing.
    elapsed_s, cpu_s
        Averages for a farm.
    """

    set_name: str
    num_ponds: int
    num_routes: int
    planner: str
    time_limit: str
    build: str
    num_farms: int
    num_runs: int
    max_route_length: float
    total_length: float
    gap_percent: float | None
    worst_gap_percent: float | None
    total_gap_percent: float | None
    bound_gap_percent: float | None
    overlap: float
    num_crossings: float
    num_routes_used: float
    num_missed: int
    num_violations: int
    elapsed_s: float
    cpu_s: float


@dataclass(frozen=True)
class OverallSummary:
    """All runs of one planner with one time limit.

    Attributes
    ----------
    planner, time_limit, build
        What the runs have in common; see `Run`.
    num_runs
        How many there are.
    gap_percent, worst_gap_percent
        As in `SetSummary`.
    num_reached
        Runs whose longest route is that of the best plan known, or shorter.
    num_open, num_open_reached
        Of the runs on farms whose best plan known is longer than the lower bound: how many there are, and how many
        reach it. A plan that meets the bound is easy to find where the bound is the farthest pond.
    """

    planner: str
    time_limit: str
    build: str
    num_runs: int
    gap_percent: float | None
    worst_gap_percent: float | None
    num_reached: int
    num_open: int
    num_open_reached: int


class Comparison:
    """Runs beside the best plans known of their farms.

    Parameters
    ----------
    runs
        At least one.
    best_known
        From files; empty if there are none.

    Raises
    ------
    InvalidInput
        If there are no runs.
    """

    def __init__(self, runs: Sequence[Run], best_known: BestKnown) -> None:
        if not runs:
            raise InvalidInput([Fault("runs", "no run is finished", "start 'pondhop bench run' first")])
        self.runs = runs
        self._listed = best_known
        self._best_of_runs = {farm: plan for farm, (_, plan) in _best_runs(runs).items()}
        self.num_farms = len({_farm(run) for run in runs})
        self.num_listed = len({_farm(run) for run in runs if self._find(run) is not None})

    def gap_percent(self, run: Run) -> float | None:
        """Return how far the longest route of a run is above the best known; `None` where that is 0 or not there."""
        best = self._best_of(run)
        return gap_percent(run.max_route_length, best.max_route_length) if best else None

    def sets(self) -> list[SetSummary]:
        """Return a summary for each set, number of ponds, number of routes, planner, time limit and build."""

        def key(run: Run) -> tuple[int, str, int, float, str, str, str]:
            limit = (_limit_order(run), run.time_limit)
            return (run.num_ponds, run.set_name, run.num_routes, *limit, run.planner, run.build)

        return [self._set_summary(group) for group in _groups(self.runs, key)]

    def overall(self) -> list[OverallSummary]:
        """Return a summary for each planner, time limit and build."""

        def key(run: Run) -> tuple[str, str, str]:
            return (run.time_limit, run.planner, run.build)

        return [self._overall_summary(group) for group in _groups(self.runs, key)]

    def best_plans(self) -> list[BestPlan]:
        """Return the plans listed as best known, each replaced by that of a run where that is better, and new ones."""
        plans = list(self._listed.plans)
        for run, plan in _best_runs(self.runs).values():
            listed = self._find(run)
            if listed is None:
                plans.append(plan)
            elif plan.quality < listed.quality:
                plans[plans.index(listed)] = plan
        return plans

    def _find(self, run: Run) -> BestPlan | None:
        return self._listed.find(run.set_name, run.farm, run.digest, run.num_routes)

    def _best_of(self, run: Run) -> BestPlan | None:
        return self._find(run) or self._best_of_runs.get(_farm(run))

    def _total_gap_percent(self, run: Run) -> float | None:
        best = self._best_of(run)
        return gap_percent(run.total_length, best.total_length) if best and best.total_length is not None else None

    def _set_summary(self, runs: Sequence[Run]) -> SetSummary:
        first = runs[0]
        gaps = [self.gap_percent(run) for run in runs]
        return SetSummary(
            set_name=first.set_name,
            num_ponds=first.num_ponds,
            num_routes=first.num_routes,
            planner=first.planner,
            time_limit=first.time_limit,
            build=first.build,
            num_farms=len({_farm(run) for run in runs}),
            num_runs=len(runs),
            max_route_length=fmean(run.max_route_length for run in runs),
            total_length=fmean(run.total_length for run in runs),
            gap_percent=_mean(gaps),
            worst_gap_percent=_worst(gaps),
            total_gap_percent=_mean(map(self._total_gap_percent, runs)),
            bound_gap_percent=_mean(gap_percent(run.max_route_length, run.lower_bound) for run in runs),
            overlap=fmean(run.overlap for run in runs),
            num_crossings=fmean(run.num_crossings for run in runs),
            num_routes_used=fmean(run.num_routes_used for run in runs),
            num_missed=sum(run.num_missed for run in runs),
            num_violations=sum(run.num_violations for run in runs),
            elapsed_s=fmean(run.elapsed_s for run in runs),
            cpu_s=fmean(run.cpu_s for run in runs),
        )

    def _overall_summary(self, runs: Sequence[Run]) -> OverallSummary:
        first = runs[0]
        gaps = [self.gap_percent(run) for run in runs]
        is_open = [_is_above_bound(run, self._best_of(run)) for run in runs]
        is_reached = [_reaches(run, self._best_of(run)) for run in runs]
        return OverallSummary(
            planner=first.planner,
            time_limit=first.time_limit,
            build=first.build,
            num_runs=len(runs),
            gap_percent=_mean(gaps),
            worst_gap_percent=_worst(gaps),
            num_reached=sum(is_reached),
            num_open=sum(is_open),
            num_open_reached=sum(both == (True, True) for both in zip(is_open, is_reached, strict=True)),
        )


def markdown(comparison: Comparison, best_known_name: str) -> str:
    """Return the page: where the runs come from, all runs of each planner, and each set.

    Parameters
    ----------
    comparison
        Of the runs.
    best_known_name
        What to call the best-known files.
    """
    runs = comparison.runs
    builds = {run.build for run in runs}
    lines = ["# Benchmark", ""]
    for build in sorted(builds, key=lambda build: min(run.finished_at for run in runs if run.build == build)):
        lines += _origin([run for run in runs if run.build == build])
    lines += ["", _best_known_sentence(comparison, best_known_name), ""]
    has_build = len({(run.planner, run.build) for run in runs}) > len({run.planner for run in runs})
    lines += _table(_OVERALL_COLUMNS, comparison.overall(), has_build)
    lines += ["", *_table(_SET_COLUMNS, comparison.sets(), has_build), ""]
    return "\n".join(lines)


def _origin(runs: Sequence[Run]) -> list[str]:
    """Return what made the runs of one build, as items of a list."""
    first, last = min(run.finished_at for run in runs), max(run.finished_at for run in runs)
    commits = ", ".join(sorted({run.commit or "unknown" for run in runs}))
    versions = f"pondhop {runs[0].version}, commit {commits}, build {runs[0].build}"
    pythons = ", ".join(sorted({run.python for run in runs}))
    machines = "; ".join(sorted({run.machine for run in runs}))
    return [f"- {versions}, Python {pythons}; {machines}; {len(runs)} runs, {first} to {last}"]


def _best_known_sentence(comparison: Comparison, best_known_name: str) -> str:
    if not comparison.num_listed:
        text = "the best of these runs"
    elif comparison.num_listed == comparison.num_farms:
        text = f"that of {best_known_name}"
    else:
        listed = f"{comparison.num_listed} of {comparison.num_farms}"
        text = f"that of {best_known_name} for {listed} pairs of farm and number of routes, else the best of these runs"
    return (
        f"Gaps are to the best plan known: {text}. Longest, total, gaps, overlap, crossings, routes used and "
        "seconds are averages; missed is the number of ponds in no route. Seconds are those of planning one farm."
    )


def _table(columns: Mapping[str, Callable[[_Row], str]], rows: Iterable[_Row], has_build: bool) -> list[str]:
    columns = {heading: cell for heading, cell in columns.items() if heading != "build" or has_build}
    lines = [f"| {' | '.join(columns)} |", "|" + "---|" * len(columns)]
    return lines + [f"| {' | '.join(cell(row).replace('|', '/') for cell in columns.values())} |" for row in rows]


def _farm(run: Run) -> tuple[str, int]:
    return run.digest, run.num_routes


def _best_runs(runs: Iterable[Run]) -> dict[tuple[str, int], tuple[Run, BestPlan]]:
    """Return the best run of each farm, of those that break no rule."""
    best: dict[tuple[str, int], tuple[Run, BestPlan]] = {}
    for run in runs:
        lengths = (run.max_route_length, run.total_length)
        plan = BestPlan(run.set_name, run.farm, run.num_routes, *lengths, run.digest)
        known = best.get(_farm(run))
        if not run.num_violations and (known is None or plan.quality < known[1].quality):
            best[_farm(run)] = (run, plan)
    return best


def _is_above_bound(run: Run, best: BestPlan | None) -> bool:
    return best is not None and best.max_route_length > run.lower_bound * (1 + SAME_LENGTH)


def _reaches(run: Run, best: BestPlan | None) -> bool:
    return (
        best is not None
        and not run.num_violations
        and run.max_route_length <= best.max_route_length * (1 + SAME_LENGTH)
    )


def _limit_order(run: Run) -> float:
    return run.time_limit_s if run.time_limit_s == run.time_limit_s else float("inf")


def _groups(runs: Iterable[Run], key: Callable[[Run], tuple[Any, ...]]) -> list[list[Run]]:
    groups: dict[tuple[Any, ...], list[Run]] = {}
    for run in runs:
        groups.setdefault(key(run), []).append(run)
    return [groups[value] for value in sorted(groups)]


def _mean(values: Iterable[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return fmean(known) if known else None


def _worst(values: Iterable[float | None]) -> float | None:
    return max((value for value in values if value is not None), default=None)


def _percent(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"


_OVERALL_COLUMNS: dict[str, Callable[[OverallSummary], str]] = {
    "planner": lambda row: row.planner,
    "time limit": lambda row: row.time_limit,
    "build": lambda row: row.build,
    "runs": lambda row: str(row.num_runs),
    "gap %": lambda row: _percent(row.gap_percent),
    "worst gap %": lambda row: _percent(row.worst_gap_percent),
    "best reached": lambda row: str(row.num_reached),
    "of those above the bound": lambda row: f"{row.num_open_reached} of {row.num_open}",
}

_SET_COLUMNS: dict[str, Callable[[SetSummary], str]] = {
    "set": lambda row: row.set_name,
    "ponds": lambda row: str(row.num_ponds),
    "routes": lambda row: str(row.num_routes),
    "planner": lambda row: row.planner,
    "time limit": lambda row: row.time_limit,
    "build": lambda row: row.build,
    "farms": lambda row: str(row.num_farms),
    "runs": lambda row: str(row.num_runs),
    "longest": lambda row: f"{row.max_route_length:.6g}",
    "total": lambda row: f"{row.total_length:.6g}",
    "gap %": lambda row: _percent(row.gap_percent),
    "worst gap %": lambda row: _percent(row.worst_gap_percent),
    "total gap %": lambda row: _percent(row.total_gap_percent),
    "bound gap %": lambda row: _percent(row.bound_gap_percent),
    "overlap": lambda row: f"{row.overlap:.1%}",
    "crossings": lambda row: f"{row.num_crossings:.1f}",
    "routes used": lambda row: f"{row.num_routes_used:.1f}",
    "missed": lambda row: str(row.num_missed),
    "wall s": lambda row: f"{row.elapsed_s:.3g}",
    "CPU s": lambda row: f"{row.cpu_s:.3g}",
}
