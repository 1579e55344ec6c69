"""Results as values: what a planner made of a problem, and the same with the farm and fleet it is for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from pondhop import _core
from pondhop._core import Plan, Problem, Round, RoundPlan, RoundViolation, Separation, Violation, evaluate
from pondhop.arguments import Arguments
from pondhop.errors import Fault, InvalidInput
from pondhop.farm.features import listed
from pondhop.farm.model import Farm
from pondhop.farm.words import pond_called
from pondhop.fleet import CALM, Fleet, Wind
from pondhop.fleet.clock import clock_after
from pondhop.fleet.layers import Layers
from pondhop.fleet.settings import AIRFRAME_SPEED_M_S, LANDING_WIND_LIMIT_M_S
from pondhop.palette import route_colour
from pondhop.trips import Trip, trips_of_plan, trips_of_round
from pondhop.units import Units, clock_text, counted, duration_text, energy_text, length_text, speed_text

NO_NUMBER = "no number of drones is known to keep it"


@dataclass(frozen=True)
class Solution:
    """What a planner made of a problem.

    Attributes
    ----------
    problem, plan
        The task and the evaluated routes.
    planner, seed
        How it was made.
    elapsed_s
        Wall time of planning, from coordinates to finished routes; 0 for a plan that was read.
    separation
        `None` where nobody measured it.
    cpu_s
        Processor time of all threads of this process while it planned; 0 for a plan that was read.
    is_interrupted
        Whether Ctrl-C or another signal ended the planning; the plan is the best so far.
    reason
        What `auto` chose and why; empty for other planners.
    passed_over
        Options that were asked for and that the planner has no use for.
    known_lower_bound_s
        ``lower_bound_s`` where a file told it.
    """

    problem: Problem
    plan: Plan
    planner: str
    seed: int
    elapsed_s: float
    separation: Separation | None = None
    cpu_s: float = 0.0
    is_interrupted: bool = False
    reason: str = ""
    passed_over: tuple[str, ...] = ()
    known_lower_bound_s: float | None = None

    def __post_init__(self) -> None:
        arguments = Arguments()
        arguments.kind("problem", self.problem, Problem, "give a pondhop.Problem")
        arguments.kind("plan", self.plan, Plan, "give a pondhop.Plan, as pondhop.evaluate returns it")
        arguments.check()

    # A bound is found when it is asked for: that takes longer than HPP, and whoever needs one does not need the other.

    @cached_property
    def lower_bound(self) -> float:
        """No plan has a shorter longest route: in length units for research farms, whose drones only fly."""
        return _core.lower_bound(self.problem)

    @cached_property
    def lower_bound_s(self) -> float:
        """No plan has a route of less time as its longest: legs, stops, service, take-off and way home."""
        known_s = self.known_lower_bound_s
        return _core.lower_bound_of_makespan(self.problem) if known_s is None else known_s

    @cached_property
    def alone(self) -> Plan:
        """The plan in which every pond is the only one of its route, flown lowest: what sampling it takes at least."""
        num_ponds = self.problem.num_ponds
        return evaluate(self.problem.replace(num_drones=num_ponds, layers=None), [[pond] for pond in range(num_ponds)])

    @property
    def passed_over_text(self) -> str:
        """A sentence about the options that the planner has no use for; empty where there are none."""
        return passed_over_text(self.planner, self.passed_over)

    @property
    def gap_percent(self) -> float | None:
        """How far the longest route is above the lower bound, both in length units; `None` if the bound is 0."""
        return gap_percent(self.plan.max_route_length, self.lower_bound)

    @property
    def gap_s_percent(self) -> float | None:
        """How far the route that takes longest is above its lower bound, both in seconds; `None` if the bound is 0."""
        return gap_percent(self.plan.makespan_s, self.lower_bound_s)


@dataclass(frozen=True)
class RoundSolution:
    """What the search made of a round: trips, windows, wind.

    Attributes
    ----------
    round, problem
        The task, and what it was made of.
    plan
        The judged trips.
    planner, seed, elapsed_s, cpu_s, is_interrupted, reason, passed_over, known_lower_bound_s
        As of `Solution`.
    separation
        `None`: trips of one drone lie across those of others, and times keep them apart.
    holds_s
        By how much each trip of each drone is held back on the ground, so that it meets no other; empty for none.
    """

    round: Round
    problem: Problem
    plan: RoundPlan
    planner: str
    seed: int
    elapsed_s: float
    cpu_s: float = 0.0
    is_interrupted: bool = False
    reason: str = ""
    passed_over: tuple[str, ...] = ()
    known_lower_bound_s: float | None = None
    separation: Separation | None = None
    holds_s: tuple[tuple[float, ...], ...] = ()

    @property
    def passed_over_text(self) -> str:
        """A sentence about the options that the planner has no use for; empty where there are none."""
        return passed_over_text(self.planner, self.passed_over)

    @cached_property
    def lower_bound_s(self) -> float:
        """No plan that makes all visits has its last landing earlier."""
        known_s = self.known_lower_bound_s
        return _core.round_bound(self.round) if known_s is None else known_s

    @property
    def gap_s_percent(self) -> float | None:
        """How far the last landing is above its lower bound; `None` if ponds are left out, or the bound is 0."""
        is_whole = not any(violation.kind == "unserved" for violation in self.plan.violations)
        if not is_whole or not math.isfinite(self.lower_bound_s):
            return None
        return gap_percent(self.plan.makespan_s, self.lower_bound_s)


def passed_over_text(planner: str, passed_over: tuple[str, ...]) -> str:
    """Return a sentence about options that a planner has no use for; an empty one for none."""
    if not passed_over:
        return ""
    names = ", ".join(name.removesuffix("_s").removesuffix("_percent").removeprefix("has_") for name in passed_over)
    return f"Planner {planner} has no use for what was asked for, and passed it over: {names.replace('_', ' ')}."


def gap_percent(longest: float, lower_bound: float) -> float | None:
    """Return how far a longest route is above the lower bound; `None` if the bound is 0."""
    return 100 * (longest - lower_bound) / lower_bound if lower_bound > 0 else None


@dataclass(frozen=True)
class FarmViolation:
    """A rule that a plan of a farm breaks, in the words of the farm.

    Attributes
    ----------
    kind
        What kind of rule; docs/reference/json.md lists them.
    message
        What is wrong, in a sentence.
    remedy
        What the user can do about it.
    drone, trip
        Number of the drone and of its trip, from 1, where it concerns one.
    pond
        Index of the pond, where it concerns one.
    value, limit
        By how much: metres, seconds, joules or a number, by kind.
    """

    kind: str
    message: str
    remedy: str
    drone: int | None = None
    pond: int | None = None
    value: float | None = None
    limit: float | None = None
    trip: int | None = None


@dataclass(frozen=True)
class Unserved:
    """A pond that no drone samples, with why and what would help.

    Attributes
    ----------
    pond
        Its index.
    reason
        Why no drone does, in a sentence.
    remedies
        What would change it, the least first; each was planned, not guessed.
    """

    pond: int
    reason: str
    remedies: tuple[str, ...] = ()


@dataclass(frozen=True)
class FarmPlan:
    """A solution for a real farm and fleet; pond indices of the routes are those of ``farm.ponds``.

    Attributes
    ----------
    farm, fleet, solution
        What was planned, with what, and the routes.
    obstacles
        What keeps the routes from being flown beside the rules that the plan itself knows: legs that leave a fence or
        cross a no-fly zone, missions that no autopilot stores, data nobody confirmed.
    num_drones_needed
        How many drones keep every limit where this plan breaks one; `None` where it breaks none, or nobody tried.
    are_layers_stacked
        Whether all drones come home above all ways out, because time would not keep them apart.
    wind
        What the round was planned for.
    unserved
        Why ponds are left out of a round, and what would help.
    """

    farm: Farm
    fleet: Fleet
    solution: Solution | RoundSolution
    obstacles: tuple[FarmViolation, ...] = ()
    num_drones_needed: int | None = None
    are_layers_stacked: bool = False
    wind: Wind = CALM
    unserved: tuple[Unserved, ...] = ()

    def __post_init__(self) -> None:
        arguments = Arguments()
        arguments.kind("farm", self.farm, Farm, "give a pondhop.Farm, as pondhop.read_farm returns it")
        arguments.kind("fleet", self.fleet, Fleet, "give a pondhop.Fleet")
        if not isinstance(self.solution, RoundSolution):
            arguments.kind("solution", self.solution, Solution, "give a pondhop.Solution")
        arguments.kind("wind", self.wind, Wind, "give a pondhop.Wind, as in pondhop.Wind(8.0, 225.0)")
        arguments.all_kind("obstacles", self.obstacles, FarmViolation, "give violations of a farm's plan")
        arguments.truth("are_layers_stacked", self.are_layers_stacked)
        arguments.check()

    @property
    def violations(self) -> tuple[FarmViolation, ...]:
        """Every rule that the plan breaks, in metric units; empty for one that can be flown."""
        return self._violations("metric")

    def _violations(self, units: Units) -> tuple[FarmViolation, ...]:
        check_units(units)
        told = self._broken_by_round(units) if self.is_round else self._broken_by_plan(units)
        return (*told, *self.obstacles)

    def _broken_by_plan(self, units: Units) -> list[FarmViolation]:
        plan = self.solution.plan
        return [self._in_words(violation, units) for violation in plan.violations] if isinstance(plan, Plan) else []

    def _broken_by_round(self, units: Units) -> list[FarmViolation]:
        plan = self.solution.plan
        return [self._round_in_words(found, units) for found in plan.violations] if isinstance(plan, RoundPlan) else []

    @property
    def told_violations(self) -> tuple[FarmViolation, ...]:
        """The violations for people to read: ponds that break the same rule are told once, with their number."""
        return self.violations_told_in("metric")

    def violations_told_in(self, units: Units) -> tuple[FarmViolation, ...]:
        """Return `told_violations` in some units.

        Parameters
        ----------
        units
            Of lengths. Those of ``obstacles`` are as they were found: `pondhop.missions.judged` finds them in others.
        """
        violations = self._violations(units)
        ponds: dict[tuple[str, str], list[FarmViolation]] = {}
        for violation in violations:
            if violation.pond is not None:
                ponds.setdefault((violation.kind, self._without_pond(violation)), []).append(violation)
        told = []
        for violation in violations:
            alike = ponds.get((violation.kind, self._without_pond(violation)), [violation])
            if len(alike) > 1 and violation.pond is not None:
                if violation is alike[0]:
                    names = listed(self.farm.ponds[found.pond].id for found in alike if found.pond is not None)
                    message = f"{self._without_pond(violation)} ({counted(len(alike), 'pond')}: {names})"
                    told.append(replace(violation, message=message, pond=None))
            else:
                told.append(violation)
        return tuple(told)

    def _without_pond(self, violation: FarmViolation) -> str:
        """What a violation says of its pond, without the name of it."""
        if violation.pond is None:
            return violation.message
        return violation.message.replace(f"{pond_called(self.farm.ponds[violation.pond].id)} ", "a pond ", 1)

    @property
    def is_feasible(self) -> bool:
        """Whether the plan can be flown."""
        return not self.violations

    @cached_property
    def layers(self) -> Layers:
        """At which heights the drones fly out to their first pond and come home."""
        return self.fleet.layers(len(self.farm.ponds), are_stacked=self.are_layers_stacked)

    @property
    def plan(self) -> Plan:
        """The judged routes, where each drone flies one and nothing else was asked for.

        Raises
        ------
        InvalidInput
            If it is a round: its ``trips`` say what is flown.
        """
        if isinstance(self.solution, RoundSolution):
            message = "this is a round of trips, and has no plan of one route a drone"
            raise InvalidInput([Fault("plan", message, "look at its trips, or at solution.plan")])
        return self.solution.plan

    @property
    def is_round(self) -> bool:
        """Whether it was planned with trips, windows, wind or an end, not one route a drone alone."""
        return isinstance(self.solution, RoundSolution)

    @cached_property
    def trips(self) -> tuple[Trip, ...]:
        """What is flown, drone by drone, each trip with its times; a drone that flies once has one."""
        solution = self.solution
        if isinstance(solution, RoundSolution):
            are_numbered = self.fleet.swap_s is not None
            return trips_of_round(solution.problem, solution.plan, solution.holds_s, are_numbered=are_numbered)
        return trips_of_plan(solution.problem, solution.plan, solution.alone, self.fleet.takeoff_interval_s)

    @property
    def left_out(self) -> tuple[int, ...]:
        """Indices of the ponds that no trip visits."""
        visited = {pond for trip in self.trips for pond in trip.ponds}
        return tuple(pond for pond in range(len(self.farm.ponds)) if pond not in visited)

    @cached_property
    def reasons(self) -> dict[int, Unserved]:
        """Why ponds are left out, by their indices; not all that are left out need be there."""
        return {unserved.pond: unserved for unserved in self.unserved}

    @property
    def num_drones_flying(self) -> int:
        """How many drones fly."""
        return len({trip.drone for trip in self.trips})

    @property
    def near_drones(self) -> tuple[int, int, float] | None:
        """A drone that flies out while another comes home nearer to its height than the layers promise, if any.

        Ways out lie one spacing above each other, and so do ways home; a way out and a way home of different drones may
        lie nearer only where one has ended before the other begins, by the times of the plan.

        Returns
        -------
        tuple or None
            Both drones, from 0, and the metres between their heights.
        """
        layers = self.layers
        for out in self.trips:
            out_end_s = float(out.times_s[0, 0])
            for home in self.trips:
                apart_m = abs(layers.way_out_height_m(out.drone) - layers.way_home_height_m(home.drone))
                home_start_s = float(home.times_s[-1, 2])
                is_together = out.departure_s < home.arrival_s and home_start_s < out_end_s
                if out.drone != home.drone and apart_m < layers.spacing_m - 1e-9 and is_together:
                    return out.drone, home.drone, apart_m
        return None

    @property
    def all_back_s(self) -> float:
        """When the last drone is back, on the clock of the round: 0 is its start."""
        return max((trip.arrival_s for trip in self.trips), default=0.0)

    @property
    def span_s(self) -> float:
        """From the first take-off, which may be later than the start where ponds have windows, to the last landing."""
        return self.all_back_s - min((trip.departure_s for trip in self.trips), default=0.0)

    def moment(self, time_s: float) -> str:
        """Return a time of the round in a sentence: ``at 22:05:10``, or ``5 min 10 s after the start``."""
        if self.fleet.start is None:
            return f"{duration_text(time_s)} after the start"
        return f"at {clock_after(self.fleet.start, time_s)}"

    def clock(self, time_s: float) -> str:
        """Return a time of the round as people read it: by the clock where the start is known, else since the start."""
        return clock_text(time_s) if self.fleet.start is None else clock_after(self.fleet.start, time_s)

    @property
    def battery_text(self) -> str:
        """What a battery gives and what the hungriest trip takes of it, in a sentence or two."""
        fleet, most_j = self.fleet, max((trip.energy_j for trip in self.trips), default=0.0)
        usable_j, most = fleet.usable_energy_j, energy_text(most_j)
        what = "trip" if fleet.swap_s is not None else "route"
        if not math.isfinite(usable_j):
            return f"Flight time is unchecked: the fleet names no battery_wh. The hungriest {what} takes {most}."
        return (
            f"A battery gives {energy_text(usable_j)} above its reserve of {fleet.reserve_percent:g} %; "
            f"the hungriest {what} takes {most}, {100 * most_j / usable_j:.0f} % of it."
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know before flying, a sentence each, in metric units."""
        return self.notes_told_in("metric")

    def notes_told_in(self, units: Units) -> tuple[str, ...]:
        """Return the notes with speeds in some units; settings of a fleet are told as its file has them."""
        check_units(units)
        notes = list(self.farm.notes)
        if self.solution.passed_over:
            notes.append(self.solution.passed_over_text)
        if self.solution.reason:
            notes.append(f"Planner {self.solution.planner} chose {self.solution.reason}.")
        fast = [
            f"{name} {value:g}"
            for name, value in (
                ("speed_m_s", self.fleet.speed_m_s),
                ("return_speed_m_s", self.fleet.return_speed_m_s),
            )
            if value > AIRFRAME_SPEED_M_S
        ]
        if fast:
            notes.append(
                f"The plan counts with {' and '.join(fast)}: the quadcopter of its laws flies at most "
                f"{speed_text(AIRFRAME_SPEED_M_S, units)}, so see that yours does fly that fast."
            )
        if self.wind.speed_m_s > LANDING_WIND_LIMIT_M_S:
            limit = speed_text(LANDING_WIND_LIMIT_M_S, units)
            notes.append(
                f"The wind is above {limit}: the quadcopter that was measured does not notice then that it has landed, "
                "and its motors turn until somebody acts. Leave the drones on the ground unless yours do."
            )
        if self.solution.is_interrupted:
            notes.append("The planning was stopped: this is the best plan until then.")
        return tuple(notes)

    def _repr_html_(self) -> str:
        """What a notebook shows: the trips as a small map, and a row a trip."""
        rows = [
            f"<tr><td style='color:{route_colour(trip.drone)}'>&#9632; {trip.drone + 1}</td><td>{len(trip.ponds)}</td>"
            f"<td>{length_text(trip.length_m)}</td>"
            f"<td>{duration_text(trip.duration_s)}</td>"
            f"<td>{energy_text(trip.energy_j)}</td></tr>"
            for trip in self.trips
        ]
        heads = "".join(f"<th>{head}</th>" for head in ("Drone", "Ponds", "Length", "Duration", "Energy"))
        broken = "".join(f"<li>{escape(violation.message)}</li>" for violation in self.violations)
        return (
            f"<b>{escape(self.farm.name)}</b>: {counted(len(self.farm.ponds), 'pond')}, "
            f"{counted(len(self.trips), self.trip_word)}<br>{_map_svg(self.solution.problem, self.trips)}"
            f"<table><tr>{heads}</tr>{''.join(rows)}</table>" + (f"<ul>{broken}</ul>" if broken else "")
        )

    @property
    def trip_word(self) -> str:
        """What a trip is called: a route, where a drone flies once."""
        return "route" if self.fleet.swap_s is None else "trip"

    def _round_in_words(self, violation: RoundViolation, units: Units) -> FarmViolation:
        pond = None if violation.visit is None else pond_called(self.farm.ponds[violation.visit].id)
        drone = None if violation.route is None else violation.route + 1
        trip = None if violation.trip is None else violation.trip + 1
        whose = f"drone {drone}" + (f" on trip {trip}" if trip is not None and self.fleet.swap_s is not None else "")
        value, limit = violation.value or 0.0, violation.limit or 0.0
        match violation.kind:
            case "unserved":
                told = self.reasons.get(violation.visit or 0)
                message = f"{pond} is not visited" + (f": {told.reason}" if told and told.reason else "")
                remedy = "; or ".join(told.remedies) if told and told.remedies else "plan again"
            case "repeated":
                message, remedy = f"{pond} is visited {value:.0f} times", "plan again"
            case "too_many_routes":
                message = f"{counted(int(value), 'drone')} fly, the fleet has {limit:.0f}"
                remedy = f"plan again, with {value:.0f} drones if they are there"
            case "too_many_trips":
                message = f"drone {drone} flies {value:.0f} trips, and the fleet names no swap_s"
                remedy = "say swap_s, what changing a battery takes, or plan again"
            case "too_many_samples":
                message = f"{whose} samples {value:.0f} ponds, samples_per_trip is {limit:.0f}"
                remedy = "plan again"
            case "late":
                message, remedy = (
                    f"{pond} is sampled {duration_text(value)} too late for its time windows",
                    "plan again",
                )
            case "too_slow":
                message = f"{whose} is under way for {duration_text(value)}, a trip may take {duration_text(limit)}"
                remedy = "plan again, or raise max_trip_duration_s"
            case "too_long":
                message = (
                    f"{whose} flies {length_text(value, units)}, max_route_length_m is {length_text(limit, units)}"
                )
                remedy = "plan again, or raise the limit"
            case "too_much_energy":
                message = (
                    f"{whose} needs {energy_text(value)}, its battery gives {energy_text(limit)} above the reserve"
                )
                remedy = "plan again"
            case "no_way_home":
                message = f"{whose} has {energy_text(value)} too little for the way home from {pond}"
                remedy = "plan again"
            case "after_the_end":
                message = f"drone {drone} lands {duration_text(value)} after the end of the round"
                remedy = "plan again with a later end, or more drones"
            case _:
                message, remedy = str(violation), "plan again"
        return FarmViolation(
            violation.kind, message, remedy, drone, violation.visit, violation.value, violation.limit, trip
        )

    def _in_words(self, violation: Violation, units: Units) -> FarmViolation:
        pond = None if violation.pond is None else pond_called(self.farm.ponds[violation.pond].id)
        drone = None if violation.route is None else violation.route + 1
        value, limit = violation.value or 0.0, violation.limit or 0.0
        match violation.kind:
            case "unserved":
                message, remedy = f"{pond} is not visited", "plan again"
            case "repeated":
                message, remedy = f"{pond} is visited {value:.0f} times", "plan again"
            case "too_many_routes":
                message = f"there are {counted(int(value), 'route')} for {counted(int(limit), 'drone')}"
                remedy = f"plan again, with {value:.0f} drones if they are there"
            case "too_long":
                message = f"drone {drone} flies {length_text(value, units)}"
                message += f", max_route_length_m is {length_text(limit, units)}"
                remedy = self._more_drones
            case "too_slow":
                message = f"drone {drone} is under way for {duration_text(value)}"
                message += f", max_route_duration_s is {duration_text(limit)}"
                remedy = self._more_drones
            case "too_much_energy":
                message = f"drone {drone} needs {energy_text(value)}"
                message += f", its battery gives {energy_text(limit)} above the reserve"
                remedy = self._more_drones
            case _:
                message, remedy = str(violation), "plan again"
        return FarmViolation(violation.kind, message, remedy, drone, violation.pond, violation.value, violation.limit)

    @property
    def _more_drones(self) -> str:
        if self.num_drones_needed is None:
            return f"leave ponds out, or raise the limit if the drones can do it; {NO_NUMBER}"
        planned = "" if self.solution.planner in ("auto", "search", "territory") else ", planned by auto"
        return f"fly with {self.num_drones_needed} drones{planned}, or leave ponds out"


def check_units(units: object) -> None:
    """Refuse units that are none.

    Raises
    ------
    InvalidInput
        With what was given.
    """
    arguments = Arguments()
    arguments.one_of("units", units, get_args(Units))
    arguments.check()


def check_written(path: object, farm_plan: object, name: str = "path", units: object = "metric") -> None:
    """Refuse to write what is no plan of a farm, or to what is no file or folder.

    Raises
    ------
    InvalidInput
        With each of them.
    """
    arguments = Arguments()
    arguments.path(name, path)
    arguments.kind("farm_plan", farm_plan, FarmPlan, PLAN_WANTED)
    arguments.one_of("units", units, get_args(Units))
    arguments.check()


PLAN_WANTED = "give a plan of a farm, as pondhop.plan returns it"

_MAP_WIDTH = 420.0
"""Of the map in a notebook, in pixels."""


def _map_svg(problem: Problem, trips: Sequence[Trip]) -> str:
    """Routes as lines, north up; the depot is a square."""
    places = np.vstack([problem.depot, problem.ponds])
    west, south = places.min(axis=0)
    east, north = places.max(axis=0)
    scale = _MAP_WIDTH / max(east - west, north - south, 1e-9)

    def point(position: NDArray[np.float64]) -> str:
        return f"{5 + scale * (position[0] - west):.1f},{5 + scale * (north - position[1]):.1f}"

    lines = []
    for trip in trips:
        path = " ".join(map(point, (problem.depot, *problem.ponds[list(trip.ponds)], problem.depot)))
        lines.append(f"<polyline points='{path}' fill='none' stroke='{route_colour(trip.drone)}' stroke-width='1.5'/>")
    x, _, y = point(problem.depot).partition(",")
    depot = f"<rect x='{float(x) - 4:.1f}' y='{float(y) - 4:.1f}' width='8' height='8' fill='gray'/>"
    width, height = scale * (east - west) + 10, scale * (north - south) + 10
    return f"<svg width='{width:.0f}' height='{height:.0f}'>{''.join(lines)}{depot}</svg>"
