"""Problems in whole numbers: the matrices that general routing solvers compute with.

Node 0 is the depot, node i + 1 pond i. What is minimised is what `pondhop.evaluate` calls the duration of a route:
legs, stops and service; the service of a pond is part of every leg that leads to it. In research farms durations are
lengths. Matrices take O(n^2) memory: 60 to 80 bytes for each pair of places, here and in the solver together.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pondhop._core import Problem, leg_durations, leg_lengths
from pondhop.errors import Fault, InvalidInput

MAX_PONDS = 3000
"""Beyond it matrices would take more than about 0.7 GB."""

LARGEST_COST = 2**62
"""Sums stay below this, half of what 64 bits hold."""

UNITS_OF_LONGEST_LEG = 1_000_000
"""In the longest leg of a fine matrix: rounding changes a route by at most a millionth of that for each of its legs."""


@dataclass(frozen=True)
class Legs:
    """All legs of a problem.

    Attributes
    ----------
    costs_s
        Seconds from the start of a leg to the end of the service it leads to, shape (n + 1, n + 1), 0 on the diagonal.
    lengths_m
        Lengths, shape (n + 1, n + 1).
    """

    costs_s: NDArray[np.float64]
    lengths_m: NDArray[np.float64]


@dataclass(frozen=True)
class IntegerMatrix:
    """Legs in whole units.

    Attributes
    ----------
    legs
        Shape (n + 1, n + 1).
    units
        How many units a second, or a metre, is.
    limit
        No route may be longer; `None` where nothing limits it.
    """

    legs: NDArray[np.int64]
    units: float
    limit: int | None

    @property
    def horizon(self) -> int:
        """No route that visits every place once is longer."""
        return int(self.legs.max()) * len(self.legs)


def legs_of(problem: Problem) -> Legs:
    """Return all legs of a problem.

    Raises
    ------
    InvalidInput
        If there are more than `MAX_PONDS` ponds.
    """
    if problem.num_ponds > MAX_PONDS:
        message = f"a matrix of the legs between {problem.num_ponds} ponds takes too much memory"
        raise InvalidInput([Fault("planner", message, f"give at most {MAX_PONDS} ponds, or use search or territory")])
    costs_s = leg_durations(problem)
    costs_s[:, 1:] += problem.service_durations_s
    np.fill_diagonal(costs_s, 0.0)
    return Legs(costs_s, leg_lengths(problem))


def fine(legs: NDArray[np.float64], limit: float) -> IntegerMatrix:
    """Return legs rounded up: what keeps the limit in units does so in truth, if not always the other way round."""
    longest = float(legs.max())
    # Where the longest leg is shorter, there would be more units than a float can count.
    units = UNITS_OF_LONGEST_LEG / longest if longest > UNITS_OF_LONGEST_LEG * sys.float_info.min else 1.0
    in_units = np.ceil(legs * units).astype(np.int64)
    return IntegerMatrix(in_units, units, _limit_in_units(limit, units, in_units))


def truncated(legs: NDArray[np.float64], limit: float, units: float, cost_per_unit: int) -> IntegerMatrix:
    """Return legs rounded down to units; to larger ones where that many could add up beyond `LARGEST_COST`.

    Parameters
    ----------
    legs
        Shape (n + 1, n + 1).
    limit
        Of every route; infinite for none.
    units
        How many units a second or a metre is.
    cost_per_unit
        The most that a unit can cost in the objective of the solver.
    """
    most = float(legs.max()) * len(legs) * cost_per_unit
    units = min(units, LARGEST_COST / most) if most > 0.0 else units
    in_units = (legs * units).astype(np.int64)
    return IntegerMatrix(in_units, units, _limit_in_units(limit, units, in_units))


def _limit_in_units(limit: float, units: float, legs: NDArray[np.int64]) -> int | None:
    """Return the limit, or `None` if no route can reach it."""
    is_reachable = math.isfinite(limit) and limit * units < float(legs.max()) * len(legs)
    return math.floor(limit * units) if is_reachable else None
