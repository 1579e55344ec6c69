"""Trips: what a drone flies between two stays at the depot, whichever planner and whichever judge said so.

A drone that flies once has one trip, its route. A trip is one battery and one mission.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain, repeat

import numpy as np
from numpy.typing import NDArray

from pondhop import _core
from pondhop._core import Plan, Problem, RoundPlan


@dataclass(frozen=True)
class EnergyPhases:
    """What a trip takes from its battery, in joules, by what the drone does.

    Attributes
    ----------
    takeoff_j, legs_j, sampling_j, way_home_j
        The first take-off; flights to and between ponds; time on station; the way home with its landing.
    """

    takeoff_j: float
    legs_j: float
    sampling_j: float
    way_home_j: float

    @property
    def total_j(self) -> float:
        """The whole trip."""
        return self.takeoff_j + self.legs_j + self.sampling_j + self.way_home_j


@dataclass(frozen=True, eq=False)
class Trip:
    """A trip of a plan; times in seconds after the first take-off of the round.

    Attributes
    ----------
    drone, number
        Whose it is, and which of its trips, both from 0.
    name
        ``drone-2``, or ``drone-2-trip-3`` where drones fly several: the stem of its files.
    ponds
        Indices in flying order.
    departure_s, arrival_s, ready_s
        Take-off, landing, and when the drone is ready for its next trip.
    length_m, energy_j
        From depot to depot.
    times_s
        Arrival, begin and end of sampling at each pond, shape (n, 3).
    legs
        Metres, seconds and joules of each leg, the way home last, shape (n + 1, 3).
    energies_j
        What is used when the drone leaves each pond, and what the way home from there takes, shape (n, 2).
    phases
        The energy by what the drone does.
    hold_s
        By how much it is held back on the ground, so that it meets no other drone.
    """

    drone: int
    number: int
    name: str
    ponds: tuple[int, ...]
    departure_s: float
    arrival_s: float
    ready_s: float
    length_m: float
    energy_j: float
    times_s: NDArray[np.float64]
    legs: NDArray[np.float64]
    energies_j: NDArray[np.float64]
    phases: EnergyPhases
    known_duration_s: float | None = None
    hold_s: float = 0.0

    @property
    def duration_s(self) -> float:
        """From take-off to landing."""
        return self.arrival_s - self.departure_s if self.known_duration_s is None else self.known_duration_s

    @property
    def waits_s(self) -> float:
        """What the drone waits in the air, for windows to open."""
        return float((self.times_s[:, 1] - self.times_s[:, 0]).sum())


def trips_of_plan(problem: Problem, plan: Plan, alone: Plan, takeoff_interval_s: float) -> tuple[Trip, ...]:
    """Return the routes of a plan as trips, one a drone, that take off one after the other.

    Parameters
    ----------
    problem, plan
        The task and its judged routes.
    alone
        The plan in which every pond is the only one of its route, flown lowest.
    takeoff_interval_s
        Between two take-offs.
    """
    # What the way home from each pond takes in the lowest layer, landing included.
    energies_home_j = [float(energies_j[-1]) for energies_j in alone.leg_energies_j]
    more_j = [float(way_home_j) - problem.energy.way_home_fixed_j for *_, way_home_j in problem.layers] or [0.0]
    found = []
    for drone, (ponds, layer_j) in enumerate(zip(plan.routes, chain(more_j, repeat(more_j[-1])), strict=False)):
        start_s = drone * takeoff_interval_s
        arrivals_s, departures_s = start_s + plan.arrivals_s[drone], start_s + plan.departures_s[drone]
        leg_energies_j, used_j, energies_j = plan.leg_energies_j[drone], 0.0, []
        for order, pond in enumerate(ponds):
            used_j += float(leg_energies_j[order] + problem.service_energies_j[pond])
            energies_j.append((used_j, energies_home_j[pond] + layer_j))
        duration_s = float(plan.route_durations_s[drone])
        found.append(
            Trip(
                drone=drone,
                number=0,
                name=f"drone-{drone + 1}",
                ponds=tuple(ponds),
                departure_s=start_s,
                arrival_s=start_s + duration_s,
                ready_s=start_s + duration_s,
                length_m=float(plan.route_lengths[drone]),
                energy_j=float(plan.route_energies_j[drone]),
                times_s=np.column_stack([arrivals_s, arrivals_s, departures_s]),
                legs=np.column_stack([plan.leg_lengths_m[drone], plan.leg_durations_s[drone], leg_energies_j]),
                energies_j=np.array(energies_j).reshape(-1, 2),
                phases=EnergyPhases(*map(float, plan.phase_energies_j[drone])),
                known_duration_s=duration_s,
            )
        )
    return tuple(found)


def trips_of_round(
    problem: Problem, plan: RoundPlan, holds_s: Sequence[Sequence[float]] = (), *, are_numbered: bool
) -> tuple[Trip, ...]:
    """Return the trips of a round, drone by drone.

    Parameters
    ----------
    problem
        What the round was made of.
    plan
        As it was judged.
    holds_s
        By how much each trip of each drone is held back.
    are_numbered
        Whether drones may fly several, so that each is called by its number.
    """
    takeoffs_j = [float(takeoff_j) for _, _, takeoff_j, _ in problem.layers] or [problem.energy.takeoff_j]
    return tuple(
        replace(
            _trip_of_round(trip, drone, number, takeoffs_j, problem.service_energies_j, are_numbered=are_numbered),
            hold_s=holds_s[drone][number] if holds_s else 0.0,
        )
        for drone, trips in enumerate(plan.trips)
        for number, trip in enumerate(trips)
    )


def _trip_of_round(
    trip: _core.Trip,
    drone: int,
    number: int,
    takeoffs_j: Sequence[float],
    services_j: NDArray[np.float64],
    *,
    are_numbered: bool,
) -> Trip:
    legs, energies_j = trip.legs, trip.energies_j
    takeoff_j, way_home_j = takeoffs_j[min(drone, len(takeoffs_j) - 1)], float(legs[-1, 2])
    legs_j = float(legs[:-1, 2].sum()) - takeoff_j
    # What is not flown is sampling: time on station, and waits for it.
    sampling_j = trip.energy_j - takeoff_j - legs_j - way_home_j
    if not trip.times_s[:, 1:2].size or np.array_equal(trip.times_s[:, 0], trip.times_s[:, 1]):
        sampling_j = float(services_j[trip.visits].sum())
    return Trip(
        drone=drone,
        number=number,
        name=f"drone-{drone + 1}-trip-{number + 1}" if are_numbered else f"drone-{drone + 1}",
        ponds=tuple(trip.visits),
        departure_s=trip.departure_s,
        arrival_s=trip.arrival_s,
        ready_s=trip.ready_s,
        length_m=trip.length_m,
        energy_j=trip.energy_j,
        times_s=trip.times_s,
        legs=legs,
        energies_j=energies_j,
        phases=EnergyPhases(takeoff_j, legs_j, sampling_j, way_home_j),
    )
