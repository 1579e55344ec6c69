"""On which farms the report compares planners, and how many of them a planner gets that is slow."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, replace
from pathlib import Path

from pondhop.report.methods import Method

NUM_ROUTES = 5
"""In the whole paper."""

FARM_SEED = 1
"""Of all sets of farms."""

PLANNER_SEED = 1

MOST_PONDS_FOR_LEAST = 200
"""Of sets of which slow planners get more than one farm, too: a comparison on one farm says nothing."""

MAX_LIMIT_SHARE = 0.5
"""Of a budget for a set of farms: the longest time limit for quality against time."""


@dataclass(frozen=True)
class Scope:
    """How much is measured.

    Attributes
    ----------
    options
        Of the command that measures it.
    num_ponds, num_farms
        Of the sets of farms of Table 1.
    farm_budget_s
        A planner that is expected to take longer for a farm is too slow for farms of this size: it plans none.
    set_budget_s
        A planner that is expected to take longer for a set plans its first farms only, as many as fit, at least
        ``least_num_farms`` where they have at most ``MOST_PONDS_FOR_LEAST`` ponds, else at least one.
    least_num_farms
        See ``set_budget_s``.
    anytime_num_ponds, anytime_num_farms, anytime_limits_s
        Sets, first farms of each, and time limits for quality against time.
    scaling_num_ponds, scaling_num_farms
        Sets of larger farms for the scaling plot, which also shows those of Table 1.
    num_repeats
        Farms of the smallest set that are planned a second time, to see whether the plan is the same.
    figure_farm, figure_num_ponds
        Index of the farm that figures show, and number of ponds: in the paper's figures 1b and 2, and in figure 3.
    """

    options: str
    num_ponds: tuple[int, ...]
    num_farms: int
    farm_budget_s: float
    set_budget_s: float
    anytime_num_ponds: tuple[int, ...]
    anytime_num_farms: int
    anytime_limits_s: tuple[float, ...]
    scaling_num_ponds: tuple[int, ...]
    scaling_num_farms: int
    num_repeats: int
    least_num_farms: int = 1
    figure_farm: int = 2
    figure_num_ponds: tuple[int, int] = (300, 100)

    @property
    def halves(self) -> tuple[list[int], list[int]]:
        """Numbers of ponds of the smaller sets of Table 1, and of the larger ones."""
        sizes = sorted(self.num_ponds)
        num_small = -(-len(sizes) // 2)
        return sizes[:num_small], sizes[num_small:]

    def with_budget(self, set_budget_s: float) -> Scope:
        """Return this scope with fewer or more farms for slow planners, and no time limit beyond half the budget."""
        limits_s = tuple(limit_s for limit_s in FULL.anytime_limits_s if limit_s <= MAX_LIMIT_SHARE * set_budget_s)
        options = f"{self.options} --budget {set_budget_s:g}"
        return replace(self, options=options, set_budget_s=set_budget_s, anytime_limits_s=limits_s)

    def with_best_known(self, path: Path) -> Scope:
        """Return this scope, where gaps are measured from the plans of a file; a shell can read its name again."""
        return replace(self, options=f"{self.options} --best-known {shlex.quote(str(path))}")

    def num_farms_of(self, method: Method, num_ponds: int) -> int:
        """Return how many farms of a set of Table 1 a method plans: all, the first few, or none."""
        least = self.least_num_farms if num_ponds <= MOST_PONDS_FOR_LEAST else 1
        return self._fitting(method, num_ponds, self.num_farms, least)

    def num_scaling_farms_of(self, method: Method, num_ponds: int) -> int:
        """Return how many farms of a larger set a method plans."""
        return self._fitting(method, num_ponds, self.scaling_num_farms)

    def anytime_limits_of(self, method: Method) -> list[float]:
        """Return the time limits that a planner gets: baselines start at a second, below it they have no plan."""
        return [limit_s for limit_s in self.anytime_limits_s if method.kind == "ours" or limit_s >= 1.0]

    def _fitting(self, method: Method, num_ponds: int, num_farms: int, least: int = 1) -> int:
        seconds = method.seconds(num_ponds)
        if num_ponds > method.most_ponds or seconds > self.farm_budget_s:
            return 0
        return min(num_farms, max(least, int(self.set_budget_s / seconds))) if seconds else num_farms


FULL = Scope(
    options="",
    num_ponds=(50, 100, 200, 300, 500, 700),
    num_farms=100,
    farm_budget_s=60.0,
    set_budget_s=400.0,
    anytime_num_ponds=(50, 200, 700),
    anytime_num_farms=2,
    anytime_limits_s=(1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0, 10.0, 60.0),
    scaling_num_ponds=(1000, 2000, 5000, 10_000),
    scaling_num_farms=3,
    num_repeats=3,
    least_num_farms=10,
)

QUICK = Scope(
    options=" --quick",
    num_ponds=FULL.num_ponds,
    num_farms=10,
    farm_budget_s=45.0,
    set_budget_s=25.0,
    anytime_num_ponds=FULL.anytime_num_ponds,
    anytime_num_farms=1,
    anytime_limits_s=FULL.anytime_limits_s[:-1],
    scaling_num_ponds=FULL.scaling_num_ponds,
    scaling_num_farms=1,
    num_repeats=1,
)
