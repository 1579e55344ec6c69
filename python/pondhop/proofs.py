"""Proofs that so many drones cannot keep a limit, whatever their routes: what they show need not be searched for.

Take the ponds S that lie at least some distance from the depot, and k routes that visit them. Each flies out to one of
them and home from one, both at least that far; between them the routes make a spanning forest of S of k trees, which
is as long as the shortest spanning tree less its k - 1 longest edges; and they stop and stay at each pond of S. All of
that must be had within k times the limit, less what take-off and landing take in the k cheapest layers. Where no k up
to the number of drones is enough, no plan keeps the limit. It holds in the plane, where detours are never shorter.

Source: the bound by far customers of the capacitated routing problem (Haimovich and Rinnooy Kan, Bounds and heuristics
for capacitated routing problems, 1985), with spanning forests in place of tours. O(n^2) for each of a few sets S, once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pondhop._core import Problem

Numbers = NDArray[np.float64]

_TOLERANCE = 1e-6
"""By how much a limit must be missed: rounding proves nothing."""

_MOST_SETS, _MOST_LEGS = 60, 3e7
"""How many sets of far ponds are looked at, and how many pairs of ponds in all of them."""


@dataclass(frozen=True)
class _FarPonds:
    """Ponds at least some distance from the depot.

    Attributes
    ----------
    ponds
        Their indices.
    distance
        Of the nearest of them.
    num_places
        How many places they lie at: a drone stops at each, but not for a second pond in one place.
    forests
        Length of the shortest spanning forest by its number of trees, from one on.
    """

    ponds: NDArray[np.intp]
    distance: float
    num_places: int
    forests: Numbers


@dataclass(frozen=True)
class _Use:
    """What flights take of something that there is a limit of: length, time or energy.

    Attributes
    ----------
    limit
        For a route.
    per_length, per_length_home
        Of a leg, and of the last one.
    per_stop
        For each leg of some length.
    at_ponds
        For the time on station, by pond.
    by_layer
        Take-off and landing, by route.
    """

    limit: float
    per_length: float
    per_length_home: float
    per_stop: float
    at_ponds: Numbers
    by_layer: Numbers


class Proofs:
    """What any plan for the ponds of a problem must fly, whatever the number of drones.

    Parameters
    ----------
    problem
        Its places are looked at; numbers of drones and heights may be others later.
    """

    def __init__(self, problem: Problem) -> None:
        offsets = problem.ponds - problem.depot
        distances = np.hypot(*offsets.T)
        order = np.argsort(-distances, kind="stable")
        num_sets = min(_MOST_SETS, problem.num_ponds, max(1, int(_MOST_LEGS / problem.num_ponds**2)))
        sizes = sorted({math.ceil(problem.num_ponds * number / num_sets) for number in range(1, num_sets + 1)} | {1})
        self._sets = [
            _FarPonds(
                order[:size],
                float(distances[order[size - 1]]),
                len(np.unique(offsets[order[:size]], axis=0)),
                _forests(offsets[order[:size]]),
            )
            for size in sizes
            # A pond at the depot itself is no flight.
            if distances[order[size - 1]] > 0.0
        ]

    def is_out_of_reach(self, problem: Problem) -> bool:
        """Whether no plan of a problem with these ponds keeps all of its limits."""
        return any(self._is_too_much(use, far) for use in _uses(problem) for far in self._sets)

    def _is_too_much(self, use: _Use, far: _FarPonds) -> bool:
        num_routes = np.arange(1, min(len(use.by_layer), len(far.forests)) + 1)
        there_and_back = (use.per_length + min(use.per_length, use.per_length_home)) * far.distance
        needed = (
            float(use.at_ponds[far.ponds].sum())
            + far.num_places * use.per_stop
            + use.per_length * far.forests[: len(num_routes)]
            + there_and_back * num_routes
            + np.cumsum(np.sort(use.by_layer))[: len(num_routes)]
        )
        return bool((needed > use.limit * num_routes * (1.0 + _TOLERANCE)).all())


def _uses(problem: Problem) -> list[_Use]:
    """What there is a limit of in a problem."""
    num_routes = min(problem.num_drones, problem.num_ponds)
    layers = problem.layers
    energy = problem.energy
    if len(layers):
        rows = layers[np.minimum(np.arange(num_routes), len(layers) - 1)]
    else:
        row = (problem.takeoff_s, problem.way_home_fixed_s, energy.takeoff_j, energy.way_home_fixed_j)
        rows = np.tile(row, (num_routes, 1))
    if problem.way_home_speed_m_s is None:
        # Then the last leg is flown like the others, and has no fixed part.
        rows = rows * (1.0, 0.0, 1.0, 0.0)
    slowness, none = 1.0 / problem.speed_m_s, np.zeros(problem.num_ponds)
    slowness_home = 1.0 / (problem.way_home_speed_m_s or problem.speed_m_s)
    way_home_w = energy.leg_w if problem.way_home_speed_m_s is None else energy.way_home_w
    uses = [
        _Use(problem.max_length_m, 1.0, 1.0, 0.0, none, np.zeros(num_routes)),
        _Use(
            problem.max_duration_s,
            slowness,
            slowness_home,
            problem.leg_stop_s,
            problem.service_durations_s,
            rows[:, 0] + rows[:, 1],
        ),
        _Use(
            energy.usable_j,
            energy.leg_w * slowness,
            way_home_w * slowness_home,
            energy.leg_stop_w * problem.leg_stop_s,
            problem.service_energies_j,
            rows[:, 2] + rows[:, 3],
        ),
    ]
    return [use for use in uses if math.isfinite(use.limit)]


def _forests(places: Numbers) -> Numbers:
    """Lengths of the shortest spanning forests of one tree, two trees and so on (Prim's algorithm)."""
    distances = np.hypot(*(places - places[0]).T)
    is_outside = np.ones(len(places), dtype=bool)
    is_outside[0] = False
    edges = np.zeros(len(places) - 1)
    for index in range(len(edges)):
        nearest = int(np.where(is_outside, distances, np.inf).argmin())
        edges[index] = distances[nearest]
        is_outside[nearest] = False
        np.minimum(distances, np.hypot(*(places - places[nearest]).T), out=distances)
    # Without its longest edges the shortest tree falls into the shortest forests.
    longest_last = np.concatenate([[0.0], np.cumsum(np.sort(edges))])
    return longest_last[::-1]
