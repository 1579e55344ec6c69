"""The rows of the report's tables, and their CSV files.

Every number of the report is a field of a row here, and every row is in a CSV file: the pages only lay them out.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, fields
from functools import cached_property
from pathlib import Path
from statistics import fmean, linear_regression

from pondhop.bench.best_known import NO_BEST_KNOWN, BestKnown
from pondhop.bench.measure import Request, Run
from pondhop.bench.summary import SAME_LENGTH, Comparison
from pondhop.report.methods import SEARCH, WITHIN_LIMITS_S, Method
from pondhop.report.printed import TABLE_1
from pondhop.report.study import Measurements, is_no_longer

FARMS_OF_A_RUN_TIME = 100
"""The paper's run times are for 100 farms."""


@dataclass(frozen=True)
class Score:
    """A method on a set of farms: a cell of Table 1, with what the paper prints.

    Attributes
    ----------
    method, num_ponds
        Which.
    num_farms
        How many farms are averaged: the first ones of the set.
    max_route_length, total_length
        Averages.
    gap_percent
        Of the longest route to the best known of each farm, on average; `None` where the best known is 0.
    wall_s, cpu_s
        Of planning 100 farms: 100 times the average.
    num_routes_used, overlap, num_crossings
        Averages.
    num_too_many_routes
        Plans with more routes than allowed.
    num_missed
        Ponds in no route, in all plans.
    num_violations
        Broken rules in all plans, the two above included.
    printed_total_length, printed_max_route_length, printed_s
        The paper's values; `None` where it has none.
    """

    method: str
    num_ponds: int
    num_farms: int
    max_route_length: float
    total_length: float
    gap_percent: float | None
    wall_s: float
    cpu_s: float
    num_routes_used: float
    overlap: float
    num_crossings: float
    num_too_many_routes: int
    num_missed: int
    num_violations: int
    printed_total_length: float | None
    printed_max_route_length: float | None
    printed_s: float | None


@dataclass(frozen=True)
class Margin:
    """`search` and a rival on the farms that the rival planned.

    Attributes
    ----------
    rival, num_ponds, num_farms
        Which.
    search_max_route_length, rival_max_route_length
        Averages of the longest routes; `search` minimises the longest route.
    num_shorter_max, num_not_longer_max
        Farms where the longest route of `search` is the shorter one, and where it is not the longer one.
    within_max_route_length, within_total_length, rival_total_length
        Averages; here `search` minimises the total with routes as long as the rival's longest allowed.
    num_dominated
        Farms where that plan has a shorter total and no longer longest route than the rival's.
    num_too_many_routes
        Farms where the rival used more routes than allowed; they are compared all the same.
    seconds_for_max
        Least time limit of Table 1 with which the longest route of `search` is no longer than the rival's on average;
        `None` if none is enough.
    seconds_for_total
        The same for the total at the rival's longest route: see `Measurements.seconds_for_total`.
    """

    rival: str
    num_ponds: int
    num_farms: int
    search_max_route_length: float
    rival_max_route_length: float
    num_shorter_max: int
    num_not_longer_max: int
    within_max_route_length: float
    within_total_length: float
    rival_total_length: float
    num_dominated: int
    num_too_many_routes: int
    seconds_for_max: float | None
    seconds_for_total: float | None

    @property
    def max_saved_percent(self) -> float:
        """How much shorter the longest route of `search` is, as a share of the rival's."""
        return 100 * (1 - self.search_max_route_length / self.rival_max_route_length)

    @property
    def is_within(self) -> bool:
        """Whether the average longest route of `search` is no longer than the rival's where it minimises the total."""
        return self.within_max_route_length <= self.rival_max_route_length * (1 + SAME_LENGTH)

    @property
    def total_saved_percent(self) -> float:
        """How much shorter the total of `search` is at the rival's longest route, as a share of the rival's."""
        return 100 * (1 - self.within_total_length / self.rival_total_length)


@dataclass(frozen=True)
class Character:
    """What a method is like over all sets: a row of Table 2.

    Attributes
    ----------
    method
        Which.
    gap_small_percent, gap_large_percent
        Longest route above the best known, mean over the smaller and the larger half of the sets; `None` if it planned
        none of them.
    seconds_at_largest, largest_set
        Wall time of a farm of the largest set of Table 1 that it planned, and the number of ponds of that set.
    growth
        The time of a farm grows with this power of the number of ponds; `None` where a time limit ends the method.
    most_ponds
        Of the largest farm it planned within the budget.
    overlap, num_crossings
        Means over the plans of Table 1.
    num_within_rules, num_plans
        Plans of Table 1 that break no rule, and all of them.
    num_same_again, num_again
        Second runs that gave the same plan, and all of them.
    needs
        What to install beside pondhop.
    """

    method: str
    gap_small_percent: float | None
    gap_large_percent: float | None
    seconds_at_largest: float
    largest_set: int
    growth: float | None
    most_ponds: int
    overlap: float
    num_crossings: float
    num_within_rules: int
    num_plans: int
    num_same_again: int
    num_again: int
    needs: str


@dataclass(frozen=True)
class Point:
    """A method on a few farms of one size: a point of the plots of quality against time and of scaling.

    Attributes
    ----------
    method, planner, time_limit
        Which; the planner is the method without options and limit.
    num_ponds, num_farms
        Of the farms.
    seconds
        Wall time of a farm, average.
    gap_percent
        Of the longest route to the best known of each farm, on average; `None` where the best known is 0.
    """

    method: str
    planner: str
    time_limit: str
    num_ponds: int
    num_farms: int
    seconds: float
    gap_percent: float | None


class Tables:
    """The rows of all tables of a study.

    Parameters
    ----------
    measurements
        Every run of the study.
    best_known
        What gaps are measured from; of farms that it does not have, the best of the runs.
    """

    def __init__(self, measurements: Measurements, best_known: BestKnown = NO_BEST_KNOWN) -> None:
        self.measurements = measurements
        self.study = measurements.study
        self.comparison = Comparison(measurements.all_runs, best_known)

    @cached_property
    def scores(self) -> list[Score]:
        """Table 1: every method on every set that it planned."""
        return [
            self._score(method, num_ponds, runs)
            for num_ponds in self.study.scope.num_ponds
            for method in self.study.methods
            if (runs := self._runs(self.study.table(method, num_ponds)))
        ]

    @cached_property
    def margins(self) -> list[Margin]:
        """`search` against each rival on every set that the rival planned."""
        return [self._margin(rival, num_ponds) for rival, num_ponds in self.study.pairs]

    @cached_property
    def characters(self) -> list[Character]:
        """Table 2: a row a method."""
        return [self._character(method) for method in self.study.methods]

    @cached_property
    def quality_against_time(self) -> list[Point]:
        """Planners with time limits, and all methods on the same farms."""
        study, scope = self.study, self.study.scope
        points = []
        for num_ponds in scope.anytime_num_ponds:
            for method in study.anytime_methods():
                for limit_s in scope.anytime_limits_of(method):
                    points.append(self._point(method, num_ponds, study.anytime(method, num_ponds, limit_s)))
            for method in study.methods:
                requests = study.table(method, num_ponds)[: scope.anytime_num_farms]
                if requests and method.time_limit.seconds is None:
                    points.append(self._point(method, num_ponds, requests))
        return points

    @cached_property
    def scaling(self) -> list[Point]:
        """Every method on every set, from those of Table 1 to the largest."""
        study, scope = self.study, self.study.scope
        return [
            self._point(method, num_ponds, requests)
            for num_ponds in study.farms
            for method in study.methods
            if (requests := (study.table if num_ponds in scope.num_ponds else study.scaling)(method, num_ponds))
        ]

    def score(self, method: Method, num_ponds: int) -> Score | None:
        """Return the row of Table 1, `None` if the method planned no farm of the set."""
        return self._scores.get((method.label, num_ponds))

    @cached_property
    def _scores(self) -> dict[tuple[str, int], Score]:
        return {(score.method, score.num_ponds): score for score in self.scores}

    def _runs(self, requests: Iterable[Request]) -> list[Run]:
        return self.measurements.runs(requests)

    def _gap(self, runs: Iterable[Run]) -> float | None:
        gaps = [gap for gap in map(self.comparison.gap_percent, runs) if gap is not None]
        return fmean(gaps) if gaps else None

    def _score(self, method: Method, num_ponds: int, runs: Sequence[Run]) -> Score:
        printed = TABLE_1[method.printed].get(num_ponds) if method.printed else None
        return Score(
            method=method.label,
            num_ponds=num_ponds,
            num_farms=len(runs),
            max_route_length=fmean(run.max_route_length for run in runs),
            total_length=fmean(run.total_length for run in runs),
            gap_percent=self._gap(runs),
            wall_s=FARMS_OF_A_RUN_TIME * fmean(run.elapsed_s for run in runs),
            cpu_s=FARMS_OF_A_RUN_TIME * fmean(run.cpu_s for run in runs),
            num_routes_used=fmean(run.num_routes_used for run in runs),
            overlap=fmean(run.overlap for run in runs),
            num_crossings=fmean(run.num_crossings for run in runs),
            num_too_many_routes=sum(map(_has_too_many_routes, runs)),
            num_missed=sum(run.num_missed for run in runs),
            num_violations=sum(run.num_violations for run in runs),
            printed_total_length=printed.total_length if printed else None,
            printed_max_route_length=printed.max_route_length if printed else None,
            printed_s=printed.seconds if printed else None,
        )

    def _margin(self, rival: Method, num_ponds: int) -> Margin:
        theirs = self._runs(self.study.table(rival, num_ponds))
        ours = self._runs(self.study.table(SEARCH, num_ponds)[: len(theirs)])
        within = self._runs(self.measurements.within(rival, num_ponds, WITHIN_LIMITS_S[0]))
        return Margin(
            rival=rival.label,
            num_ponds=num_ponds,
            num_farms=len(theirs),
            search_max_route_length=fmean(run.max_route_length for run in ours),
            rival_max_route_length=fmean(run.max_route_length for run in theirs),
            num_shorter_max=sum(map(_is_shorter_max, ours, theirs)),
            num_not_longer_max=sum(map(_is_not_longer_max, ours, theirs)),
            within_max_route_length=fmean(run.max_route_length for run in within),
            within_total_length=fmean(run.total_length for run in within),
            rival_total_length=fmean(run.total_length for run in theirs),
            num_dominated=sum(
                _is_not_longer_max(mine, other) and mine.total_length < other.total_length
                for mine, other in zip(within, theirs, strict=True)
            ),
            num_too_many_routes=sum(map(_has_too_many_routes, theirs)),
            seconds_for_max=self._seconds_for_max(theirs, num_ponds),
            seconds_for_total=self.measurements.seconds_for_total(rival, num_ponds),
        )

    def _seconds_for_max(self, theirs: Sequence[Run], num_ponds: int) -> float | None:
        """Return the least time limit of `search` with which it is no worse on the same farms."""
        enough = []
        for method in self.study.methods:
            ours = self._runs(self.study.table(method, num_ponds)[: len(theirs)])
            is_complete = method.name == SEARCH.name and len(ours) == len(theirs)
            if is_complete and is_no_longer(ours, theirs, "max_route_length"):
                enough.append(method.time_limit.seconds or 0.0)
        return min(enough, default=None)

    def _character(self, method: Method) -> Character:
        study = self.study
        sets = {size: self._runs(study.table(method, size)) for size in study.scope.num_ponds}
        sets = {size: runs for size, runs in sets.items() if runs}
        runs = [run for of_set in sets.values() for run in of_set]
        scaling = [point for point in self.scaling if point.method == method.label]
        small, large = (_mean([self._gap(sets[size]) for size in half if size in sets]) for half in study.scope.halves)
        repeats = study.repeats(method)
        same = [self.measurements.routes(first) == self.measurements.routes(again) for first, again in repeats]
        return Character(
            method=method.label,
            gap_small_percent=small,
            gap_large_percent=large,
            seconds_at_largest=fmean(run.elapsed_s for run in sets[max(sets)]) if sets else math.nan,
            largest_set=max(sets, default=0),
            growth=_growth(scaling) if method.time_limit.seconds is None else None,
            most_ponds=max((point.num_ponds for point in scaling), default=0),
            overlap=fmean(run.overlap for run in runs) if runs else math.nan,
            num_crossings=fmean(run.num_crossings for run in runs) if runs else math.nan,
            num_within_rules=sum(run.num_violations == 0 for run in runs),
            num_plans=len(runs),
            num_same_again=sum(same),
            num_again=len(same),
            needs=method.needs,
        )

    def _point(self, method: Method, num_ponds: int, requests: Sequence[Request]) -> Point:
        runs = self._runs(requests)
        return Point(
            method=method.label,
            planner=method.name,
            time_limit=runs[0].time_limit,
            num_ponds=num_ponds,
            num_farms=len(runs),
            seconds=fmean(run.elapsed_s for run in runs),
            gap_percent=self._gap(runs),
        )


def csv_files(tables: Tables, folder: Path) -> dict[Path, str]:
    """Return the CSV files of all tables by the path in a folder, a row each, numbers unrounded."""
    return {
        folder / "table1.csv": _csv(Score, tables.scores),
        folder / "table2.csv": _csv(Character, tables.characters),
        folder / "margins.csv": _csv(Margin, tables.margins),
        folder / "quality_against_time.csv": _csv(Point, tables.quality_against_time),
        folder / "scaling.csv": _csv(Point, tables.scaling),
    }


def _csv(kind: type, rows: Iterable[Score | Character | Margin | Point]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in fields(kind)])
    writer.writerows(["" if value is None else value for value in astuple(row)] for row in rows)
    return text.getvalue()


def _growth(points: Sequence[Point]) -> float | None:
    """Return the slope of time over ponds on logarithmic axes, `None` for fewer than two sizes."""
    if len(points) < 2:
        return None
    logarithms = [(math.log(point.num_ponds), math.log(point.seconds)) for point in points]
    return linear_regression(*zip(*logarithms, strict=True)).slope


def _mean(values: Iterable[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return fmean(known) if known else None


def _has_too_many_routes(run: Run) -> bool:
    return run.num_routes_used > run.num_routes


def _is_shorter_max(mine: Run, other: Run) -> bool:
    return mine.max_route_length < other.max_route_length * (1 - SAME_LENGTH)


def _is_not_longer_max(mine: Run, other: Run) -> bool:
    return mine.max_route_length <= other.max_route_length * (1 + SAME_LENGTH)
