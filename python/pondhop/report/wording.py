"""The report's tables as Markdown, and its numbers as words: what `report.md.jinja` fills in."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from itertools import groupby
from math import sqrt
from statistics import fmean, stdev
from typing import Literal

from pondhop.report.methods import SEARCH, WITHIN_LIMITS_S, Method
from pondhop.report.printed import COLUMNS, TABLE_1, TABLE_2, Column, Printed
from pondhop.report.scope import MOST_PONDS_FOR_LEAST, NUM_ROUTES
from pondhop.report.tables import Character, Margin, Score, Tables
from pondhop.units import counted

Quantity = Literal["total_length", "max_route_length", "seconds"]
_NOTHING = "—"


class Wording:
    """Words for the numbers of a study.

    Parameters
    ----------
    tables
        The numbers.
    """

    def __init__(self, tables: Tables) -> None:
        self._tables = tables
        self._study = tables.study
        self._scope = tables.study.scope

    # Where the numbers come from

    @property
    def machines(self) -> str:
        """Every machine that ran a part."""
        return "; ".join(sorted({run.machine for run in self._tables.measurements.all_runs}))

    @property
    def versions(self) -> str:
        """Version, commit and Python of the runs."""
        runs = self._tables.measurements.all_runs
        versions = ", ".join(sorted({f"{run.version} ({run.commit or 'no commit known'})" for run in runs}))
        return f"pondhop {versions}, Python {', '.join(sorted({run.python for run in runs}))}"

    @property
    def dates(self) -> str:
        """First and last day of the runs."""
        days = sorted({run.finished_at[:10] for run in self._tables.measurements.all_runs})
        return days[0] if len(days) == 1 else f"{days[0]} to {days[-1]}"

    def core_share(self) -> str:
        """Return how much of a core planners had while they planned."""
        runs = self._tables.measurements.all_runs
        return f"{100 * sum(run.cpu_s for run in runs) / sum(run.elapsed_s for run in runs):.0f} %"

    @property
    def num_runs(self) -> int:
        """All runs of the study."""
        return len(self._tables.measurements.all_runs)

    def samples(self) -> list[str]:
        """Return a sentence for each method that did not plan all farms: which ones it planned, and why no more."""
        return [sentence for method in self._study.methods if (sentence := self._sample(method))]

    def _sample(self, method: Method) -> str:
        scope = self._scope
        counts = [(size, scope.num_farms_of(method, size)) for size in scope.num_ponds]
        groups = [(count, [size for size, _ in group]) for count, group in groupby(counts, key=lambda pair: pair[1])]
        parts = [
            f"the first {count} of {scope.num_farms} farms with {_list(sizes)} ponds"
            if count
            else f"no farm with {_list(sizes)} ponds (expected to take {_seconds(method.seconds(min(sizes)))} and more)"
            for count, sizes in groups
            if count < scope.num_farms
        ]
        return f"`{method.label}`: {'; '.join(parts)}" if parts else ""

    def least_num_farms(self) -> str:
        """Return how many farms a slow planner gets at least."""
        least = self._scope.least_num_farms
        return "one" if least == 1 else f"{least} with up to {MOST_PONDS_FOR_LEAST} ponds and one with more"

    def best_known(self) -> str:
        """Return what the gaps are measured from."""
        comparison = self._tables.comparison
        of_runs = "to the best plan that any of these runs has for a farm"
        if not comparison.num_listed:
            return of_runs
        listed = "to best known plans from a file, not from these runs"
        num_left = comparison.num_farms - comparison.num_listed
        return f"{listed}; for {counted(num_left, 'farm')} that it does not name, {of_runs}" if num_left else listed

    # Tables

    def table_1(self, quantity: Quantity) -> str:
        """Return one of the three parts of Table 1: a row a number of ponds, the paper's columns beside ours."""
        columns = self._columns()
        headings = ["ponds", *(name if printed is None else f"{name}, paper" for name, printed, _ in columns)]
        rows = []
        for size in self._scope.num_ponds:
            scores = [None if method is None else self._tables.score(method, size) for _, _, method in columns]
            complete = [score for score in scores if score and score.num_farms == self._scope.num_farms]
            best = min((_quantity(score, quantity) for score in complete), default=None)
            cells = [str(size)]
            for (_, printed, _), score in zip(columns, scores, strict=True):
                if printed is not None:
                    value = printed.get(size)
                    cells.append(_as_printed(getattr(value, quantity), quantity) if value else _NOTHING)
                else:
                    cells.append(self._cell(score, quantity, best))
            rows.append(cells)
        return _markdown_table(headings, rows)

    def _columns(self) -> list[tuple[str, dict[int, Printed] | None, Method | None]]:
        """Return the paper's columns, each followed by our run of the same method, and then one a planner."""
        of_column = {method.printed: method for method in self._study.methods if method.printed}
        columns: list[tuple[str, dict[int, Printed] | None, Method | None]] = []
        for column in COLUMNS:
            columns.append((column, TABLE_1[column], None))
            method = of_column.get(column)
            if method:
                columns.append((method.label, None, method))
        others = [method for method in self._study.compared_methods() if method.printed is None]
        others.sort(key=lambda method: (method.kind == "ours", method.name == SEARCH.name))
        return columns + [(method.label, None, method) for method in others]

    def _cell(self, score: Score | None, quantity: Quantity, best: float | None) -> str:
        if score is None:
            return _NOTHING
        value = _quantity(score, quantity)
        text = _number(value, quantity)
        if score.num_farms < self._scope.num_farms:
            return f"{text} ({score.num_farms})"
        return f"**{text}**" if value == best else text

    def margins_table(self, kind: Literal["max", "total"]) -> str:
        """Return how much shorter the plans of `search` are than each rival's, and on how many farms."""

        def cell(margin: Margin) -> str:
            if kind == "max":
                return f"{_signed(-margin.max_saved_percent)} ({margin.num_shorter_max}/{margin.num_farms})"
            mark = "" if margin.is_within else "*"
            return f"{_signed(-margin.total_saved_percent)}{mark} ({margin.num_dominated}/{margin.num_farms})"

        by_set = {(margin.rival, margin.num_ponds): cell(margin) for margin in self._tables.margins}
        return self._by_rival(by_set, f"{SEARCH.label}, against")

    def limits(self) -> str:
        """Return the time limits that `search` is given in turn."""
        searches = [method for method in self._study.methods if method.name == SEARCH.name]
        return ", ".join(_limit(method.time_limit.seconds) for method in searches if method.time_limit.seconds)

    def times_table(self) -> str:
        """Return the time that `search` needs to be no worse than each rival, for the longest route and the total."""

        def words(seconds: float | None) -> str:
            return f"> {_limit(WITHIN_LIMITS_S[-1])}" if seconds is None else _limit(seconds)

        by_set = {
            (margin.rival, margin.num_ponds): f"{words(margin.seconds_for_max)}, {words(margin.seconds_for_total)}"
            for margin in self._tables.margins
        }
        return self._by_rival(by_set, "longest, total: against")

    def _by_rival(self, by_set: dict[tuple[str, int], str], heading: str) -> str:
        """A row a rival, a column a set."""
        rows = [
            [rival.label, *(by_set.get((rival.label, size), _NOTHING) for size in self._scope.num_ponds)]
            for rival in self._study.rivals
        ]
        return _markdown_table([heading, *(f"{size} ponds" for size in self._scope.num_ponds)], rows)

    def optimality(self) -> str:
        """Return the first part of Table 2."""
        small, large = self._scope.halves
        headings = [f"above best, {_range(small)} ponds", f"above best, {_range(large)} ponds"]
        return self._table_2(headings, 0, lambda row: map(_percent, (row.gap_small_percent, row.gap_large_percent)))

    def scalability(self) -> str:
        """Return the second part of Table 2."""
        return self._table_2(
            ["time of a farm", "of ponds", "grows as", "most ponds"],
            1,
            lambda row: [
                _seconds(row.seconds_at_largest),
                str(row.largest_set),
                "by its limit" if row.growth is None else f"n^{row.growth:.1f}",
                f"{row.most_ponds:,}",
            ],
        )

    def practicality(self) -> str:
        """Return the third part of Table 2."""
        return self._table_2(
            ["overlap", "crossings", "plans within the rules", "same plan again", "needs"],
            2,
            lambda row: [
                _percent(100 * row.overlap),
                f"{row.num_crossings:.1f}",
                f"{row.num_within_rules} of {row.num_plans}",
                f"{row.num_same_again} of {row.num_again}",
                f"`{row.needs}`" if row.needs else "nothing",
            ],
        )

    def _table_2(self, headings: list[str], part: int, cells: Callable[[Character], Iterable[str]]) -> str:
        """A row a method that planned anything, with the paper's adjective last."""
        adjectives = {method.label: TABLE_2[method.printed][part] for method in self._study.methods if method.printed}
        rows = [
            [row.method, *cells(row), adjectives.get(row.method, "")]
            for row in self._tables.characters
            if row.num_plans
        ]
        return _markdown_table(["planner", *headings, "paper"], rows)

    def details(self, num_ponds: int) -> str:
        """Return every method on one set: all that is measured."""
        headings = [
            "planner",
            "farms",
            "longest",
            "above best",
            "total",
            "wall s",
            "CPU s",
            "routes used",
            "too many routes",
            "missed",
            "overlap",
            "crossings",
        ]
        rows = [
            [
                score.method,
                str(score.num_farms),
                f"{score.max_route_length:.3f}",
                _percent(score.gap_percent),
                f"{score.total_length:.3f}",
                _number(score.wall_s, "seconds"),
                _number(score.cpu_s, "seconds"),
                f"{score.num_routes_used:.2f}",
                f"{score.num_too_many_routes} of {score.num_farms}" if score.num_too_many_routes else "0",
                str(score.num_missed),
                _percent(100 * score.overlap),
                f"{score.num_crossings:.1f}",
            ]
            for score in self._tables.scores
            if score.num_ponds == num_ponds
        ]
        return _markdown_table(headings, rows)

    # Sentences

    def headline(self) -> list[str]:
        """Return what the comparison of `search` with its rivals comes to, a sentence each."""
        margins = self._tables.margins
        num_farms = sum(margin.num_farms for margin in margins)
        num_shorter = sum(margin.num_shorter_max for margin in margins)
        num_not_longer = sum(margin.num_not_longer_max for margin in margins)
        num_dominated = sum(margin.num_dominated for margin in margins)
        worst = min(margins, key=lambda margin: margin.max_saved_percent)
        least = min(margins, key=lambda margin: (margin.is_within, margin.total_saved_percent))
        sets_max = sum(margin.search_max_route_length < margin.rival_max_route_length for margin in margins)
        sets_total = sum(margin.seconds_for_total == WITHIN_LIMITS_S[0] for margin in margins)
        return [
            f"**Longest route.** `{SEARCH.label}` has the shorter average in {sets_max} of {len(margins)} comparisons "
            f"of a rival and a size. Of {num_farms} pairs of plans its longest route is the shorter one in "
            f"{num_shorter} and no longer in {num_not_longer}. The hardest is `{worst.rival}` at {worst.num_ponds} "
            f"ponds: {_signed(-worst.max_saved_percent)}.",
            f"**Total, at equal longest route.** Asked for the least total with no route longer than the rival's "
            f"longest, the same planner in the same time is no worse in either average in {sets_total} of "
            f"{len(margins)} comparisons; in {num_dominated} of {num_farms} pairs it is better in the total and no "
            f"worse in the longest route. The hardest is `{least.rival}` at {least.num_ponds} ponds: "
            f"{_signed(-least.total_saved_percent)}{'' if least.is_within else ', with a longer longest route'}.",
        ]

    def reproduced(self, column: Column) -> str:
        """Return least and greatest ratio of a method to its row in the paper, over the sets it planned whole."""
        scores = [
            score
            for method in self._study.methods
            if method.printed == column
            for score in self._tables.scores
            if score.method == method.label and score.num_farms == self._scope.num_farms and score.printed_s
        ]
        if not scores:
            return ""
        ratios = [
            (score.total_length / score.printed_total_length, score.max_route_length / score.printed_max_route_length)
            for score in scores
            if score.printed_total_length and score.printed_max_route_length
        ]
        totals, longest = zip(*ratios, strict=True)
        return f"total {_range_of(totals)} and longest route {_range_of(longest)} of the printed values"

    def ratios_to_ortools(self) -> str:
        """Return the ratios HPP to OR-Tools, which no choice of farms or machine changes much; paper beside ours."""
        hpp, ortools = (self._method_of(column) for column in ("HPP", "GLOP"))
        if hpp is None or ortools is None:
            return ""
        rows = []
        for size in self._scope.num_ponds:
            theirs = self._tables.measurements.runs(self._study.table(ortools, size))
            ours = self._tables.measurements.runs(self._study.table(hpp, size))[: len(theirs)]
            paper_hpp, paper_glop = TABLE_1["HPP"].get(size), TABLE_1["GLOP"].get(size)
            if theirs and paper_hpp and paper_glop:
                total = sum(run.total_length for run in ours) / sum(run.total_length for run in theirs)
                longest = sum(run.max_route_length for run in ours) / sum(run.max_route_length for run in theirs)
                printed = (
                    f"{paper_hpp.total_length / paper_glop.total_length:.2f}",
                    f"{paper_hpp.max_route_length / paper_glop.max_route_length:.2f}",
                )
                rows.append([str(size), str(len(theirs)), f"{total:.2f}", printed[0], f"{longest:.2f}", printed[1]])
        headings = ["ponds", "farms", "HPP / OR-Tools, total", "paper", "HPP / OR-Tools, longest", "paper"]
        return _markdown_table(headings, rows) if rows else ""

    def standard_error(self) -> str:
        """Return the standard error of HPP's mean longest route, as a share of the mean, over the sets."""
        hpp = self._method_of("HPP")
        if hpp is None or self._scope.num_farms < 2:
            return ""
        shares = []
        for size in self._scope.num_ponds:
            values = [run.max_route_length for run in self._tables.measurements.runs(self._study.table(hpp, size))]
            shares.append(stdev(values) / sqrt(len(values)) / fmean(values))
        return f"{100 * min(shares):.1f} to {100 * max(shares):.1f} %"

    def too_many_routes(self) -> list[str]:
        """Return for each method that breaks it how often it uses more routes than there are drones."""
        found = []
        for method in self._study.methods:
            scores = [score for score in self._tables.scores if score.method == method.label]
            if any(score.num_too_many_routes for score in scores):
                parts = [f"{score.num_too_many_routes} of {score.num_farms} at {score.num_ponds}" for score in scores]
                found.append(f"`{method.label}` in {', '.join(parts)} ponds")
        return found

    def growths(self) -> list[str]:
        """Return how the time of each method of the paper grows with the number of ponds."""
        names = {method.label: method.printed for method in self._study.methods if method.printed}
        return [
            f"n^{row.growth:.1f} for {names[row.method]}"
            for row in self._tables.characters
            if row.method in names and row.growth is not None
        ]

    def seconds(self, column: Column, num_ponds: int) -> str:
        """Return the measured seconds for 100 farms of a method of the paper."""
        method = self._method_of(column)
        score = self._tables.score(method, num_ponds) if method else None
        return _seconds(score.wall_s) if score else ""

    def _method_of(self, column: Column) -> Method | None:
        return next((method for method in self._study.methods if method.printed == column), None)

    @property
    def num_routes(self) -> int:
        """How many routes a plan may have."""
        return NUM_ROUTES


def _quantity(score: Score, quantity: Quantity) -> float:
    return score.wall_s if quantity == "seconds" else float(getattr(score, quantity))


def _number(value: float, quantity: Quantity) -> str:
    return f"{value:.2f}" if quantity != "seconds" else _three_digits(value)


def _as_printed(value: float, quantity: Quantity) -> str:
    return f"{value:.2f}" if quantity != "seconds" else f"{value:g}"


def _three_digits(value: float) -> str:
    return f"{value:,.0f}" if value >= 100 else f"{value:#.3g}"


def _seconds(value: float) -> str:
    if value < 1e-3:
        return f"{1e3 * value:.2f} ms"
    return f"{_three_digits(1e3 * value)} ms" if value < 1 else f"{_three_digits(value)} s"


def _limit(seconds: float) -> str:
    return f"{1e3 * seconds:g} ms" if seconds < 1 else f"{seconds:g} s"


def _percent(value: float | None) -> str:
    return _NOTHING if value is None else f"{value:.1f} %"


def _signed(percent: float) -> str:
    # Adding 0 makes a negative zero positive.
    return f"{round(percent, 1) + 0.0:+.1f} %".replace("-", "\u2212")


def _range_of(ratios: Sequence[float]) -> str:
    least, greatest = (f"{100 * ratio:.0f}" for ratio in (min(ratios), max(ratios)))
    return f"{least} %" if least == greatest else f"{least} to {greatest} %"


def _range(sizes: Sequence[int]) -> str:
    if not sizes:
        return "no"
    return str(sizes[0]) if len(sizes) == 1 else f"{sizes[0]} to {sizes[-1]}"


def _list(sizes: Sequence[int]) -> str:
    return " and ".join(filter(None, [", ".join(map(str, sizes[:-1])), str(sizes[-1])]))


def _markdown_table(headings: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table with its first column to the left and the others to the right."""
    # A number and its unit stay together where a heading takes two lines.
    headings = [re.sub(r"(\d) (m?s)\b", "\\1\u00a0\\2", heading) for heading in headings]
    lines = [f"| {' | '.join(headings)} |", "|---|" + "--:|" * (len(headings) - 1)]
    return "\n".join(lines + [f"| {' | '.join(row)} |" for row in rows])
