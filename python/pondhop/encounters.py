"""Drones apart in time: where they would come too near to each other, and trips held back until they do not.

A flight is a line through space and time, from the depot to the depot, by the laws of `pondhop.fleet.times`: climb to
the height of the drone's layer, out, down to the transit height at the first pond, dips, up and home in its layer,
wait and landing. Two drones are apart while they keep a distance over ground or a height between them. All drones stand
at one place here, the depot: a take-off and a landing there are never at the same time in a plan without encounters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pondhop import _core
from pondhop._core import Problem
from pondhop.fleet import Fleet
from pondhop.fleet.layers import Layers
from pondhop.fleet.times import climb_s, landing_s
from pondhop.solution import FarmPlan, RoundSolution
from pondhop.trips import Trip
from pondhop.units import Units, counted, duration_text, gap_text

APART_M, APART_HEIGHT_M = 15.0, 2.0
"""Drones keep the one or the other: positions are known to a metre or two, heights to half a metre each."""

HOLD_STEP_S, MOST_HOLD_S = 2.0, 900.0
"""In which steps, and up to how much, a trip is held back for another."""

MOST_HOLDS_PER_TRIP = 40
"""Trips held back more often than this, on average, do not come apart."""

Track = tuple[int, NDArray[np.float64]]
"""A drone, and its knots, shape (k, 4): seconds, metres east, north and up."""


@dataclass(frozen=True)
class Encounter:
    """Two drones nearer to each other than they may be.

    Attributes
    ----------
    trips
        Which trips of the plan.
    begin_s, end_s
        From when to when.
    distance_m, height_m
        How near they come over ground, and how far apart in height they are then.
    """

    trips: tuple[int, int]
    begin_s: float
    end_s: float
    distance_m: float
    height_m: float


def track_of(trip: Trip, problem: Problem, fleet: Fleet, layers: Layers) -> NDArray[np.float64]:
    """Return the knots of a trip above the ground, shape (k, 4): seconds, metres east, north and up."""
    out_m, home_m = layers.way_out_height_m(trip.drone), layers.way_home_height_m(trip.drone)
    transit_m, depot = fleet.transit_height_m, problem.depot
    low_m = fleet.dip_height_m if fleet.sampling == "hover-dip" else 0.0
    knots: list[tuple[float, float, float, float]] = []

    def add(time_s: float, place: NDArray[np.float64], height_m: float) -> None:
        # Rounding never makes a time fall.
        knots.append((max(time_s, knots[-1][0]) if knots else time_s, float(place[0]), float(place[1]), height_m))

    lift_s = trip.departure_s + fleet.spool_up_s
    add(lift_s, depot, 0.0)
    add(lift_s + fleet.climb_extra_s + climb_s(fleet, out_m), depot, out_m)
    down_s = (out_m - transit_m) / fleet.descent_speed_m_s
    for order, (pond, (arrival_s, start_s, departure_s)) in enumerate(zip(trip.ponds, trip.times_s, strict=True)):
        place = problem.ponds[pond]
        if order == 0 and down_s > 0.0:
            add(arrival_s - down_s, place, out_m)
        add(arrival_s, place, transit_m)
        add(start_s, place, transit_m)
        middle_s = departure_s - climb_s(fleet, transit_m - low_m)
        add(min(middle_s, start_s + (transit_m - low_m) / fleet.descent_speed_m_s), place, low_m)
        add(middle_s, place, low_m)
        add(departure_s, place, transit_m)
    last, leave_s = problem.ponds[trip.ponds[-1]], float(trip.times_s[-1, 2])
    up_s, landing = climb_s(fleet, home_m - transit_m), landing_s(fleet, home_m)
    add(leave_s + up_s, last, home_m)
    # What the way home takes besides its length: climb, then waiting, turning and landing above home.
    fixed_s = float(problem.layers[min(trip.drone, len(problem.layers) - 1), 1])
    add(trip.arrival_s - (fixed_s - up_s), depot, home_m)
    slow_m = min(home_m, fleet.slow_landing_height_m)
    add(trip.arrival_s - landing, depot, home_m)
    add(trip.arrival_s - landing + (home_m - slow_m) / fleet.descent_speed_m_s, depot, slow_m)
    add(trip.arrival_s - fleet.landing_extra_s, depot, 0.0)
    return np.array(knots)


def tracks_of(farm_plan: FarmPlan) -> list[Track]:
    """Return the track of every trip of a plan, in the order of its trips."""
    problem, fleet, layers = farm_plan.solution.problem, farm_plan.fleet, farm_plan.layers
    return [(trip.drone, track_of(trip, problem, fleet, layers)) for trip in farm_plan.trips]


def encounters_of(farm_plan: FarmPlan) -> list[Encounter]:
    """Return every time at which two drones of a plan are nearer than they may be, in order."""
    return [
        Encounter((one, other), begin_s, end_s, distance_m, height_m)
        for one, other, begin_s, end_s, _, distance_m, height_m in _core.encounters(
            tracks_of(farm_plan), APART_M, APART_HEIGHT_M
        )
    ]


def encounters_text(farm_plan: FarmPlan, units: Units = "metric") -> str:
    """Return how near the drones of a plan come to each other at the same moment, in a sentence or two."""
    found, trips = encounters_of(farm_plan), farm_plan.trips
    apart = f"{gap_text(APART_M, units)} over ground or {gap_text(APART_HEIGHT_M, units)} in height"
    held_s = sum(trip.hold_s for trip in trips)
    if not found:
        held = f"; trips are held back {duration_text(held_s)} in all for it" if held_s else ""
        nearest, least = _core.least_distance(tracks_of(farm_plan)), ""
        if nearest is not None:
            distance_m, one, other, time_s = nearest
            pair = f"{trips[one].name} and {trips[other].name}"
            least = f"; the least distance is {gap_text(distance_m, units)}, {pair} {farm_plan.moment(time_s)}"
        return f"At every moment all drones are {apart} apart{least}{held}."
    worst = min(found, key=lambda encounter: encounter.distance_m)
    first, second = (trips[index] for index in worst.trips)
    return (
        f"Drones come nearer than {apart} {counted(len(found), 'time')}: the nearest are {first.name} and "
        f"{second.name} {farm_plan.moment(worst.begin_s)}, {gap_text(worst.distance_m, units)} over ground. "
        + ("No hold of a trip helps." if held_s else "--deconflict holds trips back until they do not.")
    )


def held_apart(farm_plan: FarmPlan) -> FarmPlan:
    """Return a round in which trips are held back on the ground until no two drones meet, as far as that can be had.

    The earliest encounter is resolved first: of both trips the one that takes off later waits until it meets none of
    those that took off before it, and all that follows is timed anew. What is left of encounters the plan tells.
    """
    solution = farm_plan.solution
    if not isinstance(solution, RoundSolution):
        return farm_plan
    routes = [[list(trip.visits) for trip in trips] for trips in solution.plan.trips]
    holds_s = [[0.0] * len(trips) for trips in routes]
    best = farm_plan
    for _ in range(MOST_HOLDS_PER_TRIP * max(1, len(farm_plan.trips))):
        tracks, trips = tracks_of(best), best.trips
        found = _core.encounters(tracks, APART_M, APART_HEIGHT_M)
        if not found:
            return best
        one, other = found[0][:2]
        later = max((one, other), key=lambda index: (trips[index].departure_s, index))
        before = [index for index, trip in enumerate(trips) if trip.departure_s <= trips[later].departure_s]
        hold_s = _least_hold_s(tracks, later, [index for index in before if index != later])
        if hold_s is None:
            return best
        trip = trips[later]
        holds_s[trip.drone][trip.number] += hold_s
        plan = _core.evaluate_round(solution.round, routes, holds_s)
        held = replace(best, solution=replace(solution, plan=plan, holds_s=tuple(map(tuple, holds_s))))
        if len(plan.violations) > len(solution.plan.violations):
            # It would come too late for a window, or be back after the end.
            return best
        best = held
    return best


def _least_hold_s(tracks: Sequence[Track], later: int, others: Sequence[int]) -> float | None:
    """Return by how much a trip must be held back to meet none of some others; `None` if no time is enough."""
    drone, knots = tracks[later]
    fixed = [tracks[index] for index in others]
    for step in range(1, int(MOST_HOLD_S / HOLD_STEP_S) + 1):
        hold_s = step * HOLD_STEP_S
        shifted = knots + np.array([hold_s, 0.0, 0.0, 0.0])
        if not _core.encounters([(drone, shifted), *fixed], APART_M, APART_HEIGHT_M, of=0):
            return hold_s
    return None
