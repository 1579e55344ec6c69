"""Rounds of a farm: trips within batteries, windows, wind and an end; what is left out, why, and what would help.

What a plain route a drone cannot say is planned here, by `search` alone or by cutting the routes of another planner
into trips. `needs_round` is where the two kinds of planning part.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from pondhop import _core
from pondhop._core import Problem, Round
from pondhop.errors import Fault, InvalidInput
from pondhop.farm.model import Farm
from pondhop.fleet import Fleet, Wind
from pondhop.fleet.clock import DAY_S, clock_after
from pondhop.solution import FarmPlan, RoundSolution, Unserved
from pondhop.units import counted, duration_text, energy_text

Routes = Sequence[Sequence[int]]
Trips = list[list[list[int]]]

LEAST_STEPS, STEPS_PER_POND = 60_000, 300
"""Steps of a search where neither time limit nor iterations are given: about a second for 60 ponds."""

STEPS_PER_POND_OF_REMEDIES = 150
"""Steps by pond of a search that finds out whether a remedy is enough."""

MOST_DRONES_TRIED = 1_000
"""More drones are no remedy."""


def needs_round(farm: Farm, fleet: Fleet, wind: Wind) -> bool:
    """Whether something is asked for that one route a drone in calm air cannot say."""
    settings = (fleet.swap_s, fleet.end, fleet.max_trip_duration_s, fleet.samples_per_trip)
    is_asked = any(setting is not None for setting in settings)
    return is_asked or wind.speed_m_s > 0.0 or any(pond.time_windows for pond in farm.ponds)


@dataclass(frozen=True)
class Effort:
    """How hard a round is searched for.

    Attributes
    ----------
    seed, time_limit_s, threads, iterations, objective, progress
        As of `pondhop.planners.Options`.
    """

    seed: int = 1
    time_limit_s: float | None = None
    threads: int = 1
    iterations: int | None = None
    objective: str = "max"
    progress: Callable[[float, int, float], object] | None = None


def plan_round(
    farm: Farm,
    fleet: Fleet,
    wind: Wind,
    effort: Effort,
    *,
    planner: str = "search",
    routes: Callable[[Problem], Routes] | None = None,
    passed_over: tuple[str, ...] = (),
) -> FarmPlan:
    """Plan a round of a farm.

    Parameters
    ----------
    farm, fleet, wind
        What is asked for.
    effort
        How hard to try.
    planner
        The name of who plans.
    routes
        A planner that knows no trips: its routes are cut into some, in the order in which it flies. `None`: the search.
    passed_over
        Options without effect.

    Raises
    ------
    InvalidInput
        As `Farm.to_round`.
    """
    task, problem, are_stacked = _task(farm, fleet, wind)
    begin_s, begin_cpu_s = time.perf_counter(), time.process_time()
    is_interrupted = False
    if routes is None:
        trips, elapsed_s, is_interrupted = _searched(task, effort, LEAST_STEPS + STEPS_PER_POND * task.num_visits)
    else:
        trips = [cut_into_trips(task, drone, route) for drone, route in enumerate(routes(problem))]
        elapsed_s = time.perf_counter() - begin_s
    solution = RoundSolution(
        round=task,
        problem=problem,
        plan=_core.evaluate_round(task, trips),
        planner=planner,
        seed=effort.seed,
        elapsed_s=elapsed_s,
        cpu_s=time.process_time() - begin_cpu_s,
        is_interrupted=is_interrupted,
        passed_over=passed_over,
    )
    farm_plan = FarmPlan(farm, fleet, solution, are_layers_stacked=are_stacked, wind=wind)
    if not farm_plan.left_out or is_interrupted:
        return farm_plan
    try:
        return replace(farm_plan, unserved=tuple(_reasons(farm_plan, effort.seed)))
    except _Stopped:
        return replace(farm_plan, solution=replace(solution, is_interrupted=True))


class _Stopped(Exception):  # noqa: N818
    """Somebody stopped the search for remedies."""


def _task(farm: Farm, fleet: Fleet, wind: Wind) -> tuple[Round, Problem, bool]:
    """Return the round, the problem it is made of, and whether all ways home lie above all ways out.

    They do wherever they fit: trips take off while others land, all night long.
    """
    are_stacked = fleet.num_drones > 1
    if are_stacked:
        try:
            fleet.layers(len(farm.ponds), are_stacked=True)
        except InvalidInput:
            are_stacked = False
    task = farm.to_round(fleet, wind, are_layers_stacked=are_stacked)
    return task, farm.to_problem(fleet, are_layers_stacked=are_stacked), are_stacked


def _searched(task: Round, effort: Effort, default_steps: int) -> tuple[Trips, float, bool]:
    steps = effort.iterations
    if steps is None and effort.time_limit_s is None:
        steps = default_steps
    trips, elapsed_s, _, is_interrupted = _core.search_round(
        task,
        seed=effort.seed,
        time_limit_s=effort.time_limit_s,
        iterations=steps,
        threads=effort.threads,
        objective="total" if effort.objective == "total" else "max",
        progress=effort.progress,
    )
    return trips, elapsed_s, is_interrupted


def cut_into_trips(task: Round, drone: int, route: Sequence[int]) -> list[list[int]]:
    """Return a route as trips in its order, each as long as its limits allow when flown alone.

    A pond that breaks a limit even alone has a trip of its own, and the judge tells what it breaks.
    """
    trips: list[list[int]] = []
    for pond in route:
        if trips and not _breaks_alone(task, drone, [*trips[-1], pond]):
            trips[-1].append(pond)
        else:
            trips.append([pond])
    return trips


def _breaks_alone(task: Round, drone: int, ponds: list[int]) -> list[_core.RoundViolation]:
    """Return what a trip breaks if it is all that its drone flies."""
    trips: Trips = [[] for _ in range(drone)]
    plan = _core.evaluate_round(task, [*trips, [ponds]])
    return [violation for violation in plan.violations if violation.kind != "unserved"]


def _reasons(farm_plan: FarmPlan, seed: int) -> Iterator[Unserved]:
    """Return why each pond that is left out is, and what would help.

    Raises
    ------
    _Stopped
        If somebody did not want to wait for it.
    """
    task = farm_plan.solution.round  # type: ignore[union-attr]
    alone = {pond: _breaks_alone(task, 0, [pond]) for pond in farm_plan.left_out}
    late = {pond for pond, broken in alone.items() if broken and broken[0].kind == "after_the_end"}
    hopeless = {pond: _out_of_reach(farm_plan, pond, broken[0]) for pond, broken in alone.items() if broken}
    never = frozenset(hopeless) - late
    later = tuple(_later_end(farm_plan, never, seed)) if len(never) < len(alone) else ()
    others = tuple(_remedies(farm_plan, frozenset(hopeless), seed)) if len(hopeless) < len(alone) else ()
    for pond in farm_plan.left_out:
        if pond in late:
            yield replace(hopeless[pond], remedies=(*later, *hopeless[pond].remedies))
        elif pond in hopeless:
            yield hopeless[pond]
        else:
            yield Unserved(pond, _no_time(farm_plan, pond), (*later, *others))


def _no_time(farm_plan: FarmPlan, pond: int) -> str:
    """Return why a pond is left out that a drone could sample if it did nothing else."""
    fleet, windows = farm_plan.fleet, farm_plan.farm.ponds[pond].time_windows
    if windows:
        return f"no drone has time for it within the time windows ({_told_windows(windows)})"
    if fleet.swap_s is None:
        return "every drone flies once, and its trip is full without it"
    if fleet.end is not None:
        return f"the fleet has no time left for it before the end at {fleet.end}"
    return "no drone has time for it beside those that have their time windows"


def _told_windows(windows: tuple[tuple[str, str], ...]) -> str:
    return ", ".join(f"{earliest}-{latest}" for earliest, latest in windows)


def _out_of_reach(farm_plan: FarmPlan, pond: int, broken: _core.RoundViolation) -> Unserved:
    """Return why a pond cannot be sampled even by a drone that does nothing else."""
    fleet, value, limit = farm_plan.fleet, broken.value or 0.0, broken.limit or 0.0
    windows = farm_plan.farm.ponds[pond].time_windows
    leave_out = "leave it out, or move the depot nearer to it"
    match broken.kind:
        case "too_much_energy":
            reason = f"alone it takes {energy_text(value)}, a battery gives {energy_text(limit)} above the reserve"
            share = 1.0 - value / limit * (1.0 - fleet.reserve_percent / 100)
            remedies = [f"set reserve_percent to {math.floor(100 * share)} or less"] if share > 0.01 else []
            remedies.append(f"fly a battery of {math.ceil((fleet.battery_wh or 0.0) * value / limit)} Wh or more")
            return Unserved(pond, reason, (*remedies, leave_out))
        case "too_slow":
            reason = f"alone it takes {duration_text(value)}, a trip may take {duration_text(limit)}"
            return Unserved(pond, reason, (f"raise max_trip_duration_s to {math.ceil(value)}", leave_out))
        case "late":
            reason = f"no drone can be there before the time windows ({_told_windows(windows)}) end"
            return Unserved(pond, reason, ("start earlier, or give it a later time window",))
        case "after_the_end" if windows:
            reason = (
                f"the time windows ({_told_windows(windows)}) lie outside the round from {fleet.start} to {fleet.end}, "
                "or so late that a drone is back from it after the end"
            )
            return Unserved(pond, reason, ("give it a window within the round, or move start or end",))
        case "after_the_end":
            return Unserved(pond, f"a drone that does nothing else is back from it after the end at {fleet.end}")
        case "too_long":
            return Unserved(pond, "it is beyond max_route_length_m even alone", (leave_out,))
        case _:
            return Unserved(pond, str(broken), (leave_out,))


def _remedies(farm_plan: FarmPlan, hopeless: frozenset[int], seed: int) -> Iterator[str]:
    """Return what besides a later end lets the fleet sample all ponds but the hopeless ones, each planned."""
    fleet = farm_plan.fleet

    def is_enough(wider: Fleet) -> bool:
        return _enough(farm_plan, wider, hopeless, seed) is not None

    if fleet.swap_s is None:
        swapping = _changed(fleet, swap_s=240.0)
        if swapping is not None and is_enough(swapping):
            yield "change batteries at the depot, as with swap_s = 240"
    num_drones = _fewest_drones(fleet, is_enough)
    if num_drones is not None:
        yield f"fly with {counted(num_drones, 'drone')}"
    for reserve_percent in range(5 * math.ceil(fleet.reserve_percent / 5) - 5, 9, -5):
        if fleet.battery_wh is not None and is_enough(replace(fleet, reserve_percent=float(reserve_percent))):
            yield f"set reserve_percent to {reserve_percent}"
            return


def _later_end(farm_plan: FarmPlan, hopeless: frozenset[int], seed: int) -> Iterator[str]:
    """Return the end by which the fleet samples all ponds but the hopeless ones, planned with it, if one is found."""
    fleet = farm_plan.fleet
    if fleet.end is None or fleet.start is None:
        return
    endless = _enough(farm_plan, replace(fleet, end=None), hopeless, seed)
    if endless is None:
        return
    # In whole five minutes, and with some room if a search that begins with that end does not find it.
    first_s = 300.0 * math.ceil(endless.all_back_s / 300.0)
    for room_s in (0.0, 300.0, 900.0, 1800.0):
        later = replace(fleet, end=clock_after(fleet.start, first_s + room_s)[:5])
        if first_s + room_s < DAY_S and _enough(farm_plan, later, hopeless, seed):
            yield f"end at {later.end}"
            return


def _enough(farm_plan: FarmPlan, wider: Fleet, hopeless: frozenset[int], seed: int) -> FarmPlan | None:
    """Return a plan of another fleet that leaves out no pond but hopeless ones; `None` if a short search finds none."""
    farm, wind = farm_plan.farm, farm_plan.wind
    try:
        task, problem, are_stacked = _task(farm, wider, wind)
    except InvalidInput:
        return None
    steps = LEAST_STEPS // 2 + STEPS_PER_POND_OF_REMEDIES * task.num_visits
    trips, elapsed_s, is_interrupted = _searched(task, Effort(seed=seed), steps)
    if is_interrupted:
        raise _Stopped
    plan = _core.evaluate_round(task, trips)
    left_out = {violation.visit for violation in plan.violations if violation.kind == "unserved"}
    if left_out - hopeless or any(violation.kind != "unserved" for violation in plan.violations):
        return None
    solution = RoundSolution(task, problem, plan, "search", seed, elapsed_s)
    return FarmPlan(farm, wider, solution, are_layers_stacked=are_stacked, wind=wind)


def _changed(fleet: Fleet, **settings: float) -> Fleet | None:
    try:
        return replace(fleet, **settings)  # type: ignore[arg-type]
    except InvalidInput:
        return None


def _fewest_drones(fleet: Fleet, is_enough: Callable[[Fleet], object]) -> int | None:
    """Return the fewest drones, more than there are, with which all can be done; `None` if no number is found."""

    def found(num_drones: int) -> bool:
        wider = _changed(fleet, num_drones=num_drones)
        return wider is not None and bool(is_enough(wider))

    too_few, enough = fleet.num_drones, fleet.num_drones + 1
    while not found(enough):
        too_few, enough = enough, 2 * enough
        if enough > min(MOST_DRONES_TRIED, 8 * fleet.num_drones + 8):
            return None
    while enough - too_few > 1:
        middle = (too_few + enough) // 2
        too_few, enough = (too_few, middle) if found(middle) else (middle, enough)
    return enough


@dataclass(frozen=True)
class Size:
    """What a number of drones can do.

    Attributes
    ----------
    num_drones
        How many.
    all_back_s
        When the last one is back, in seconds after the first take-off.
    num_unserved
        Ponds that are left out.
    is_proven_too_few
        Whether no plan of so many drones can do all in time, whatever it is.
    is_interrupted
        Whether somebody stopped the search; the plan is the best until then.
    """

    num_drones: int
    all_back_s: float
    num_unserved: int
    is_proven_too_few: bool
    is_interrupted: bool = False

    @property
    def is_enough(self) -> bool:
        """Whether all ponds are sampled in time."""
        return self.num_unserved == 0


def sizes(
    farm: Farm, fleet: Fleet, wind: Wind, effort: Effort, *, max_drones: int, num_beyond: int = 2
) -> Iterator[Size]:
    """Plan a round with one drone, two, and so on, until some more than are enough have been planned.

    Parameters
    ----------
    farm, fleet, wind, effort
        As of `plan_round`; the number of drones of the fleet does not matter.
    max_drones
        The last number tried.
    num_beyond
        How many numbers are planned beyond the first that is enough, for the curve.

    Raises
    ------
    InvalidInput
        As `Farm.to_round`; if even a drone for each pond could not do all, with the reason of the first pond.
    """
    if fleet.span_s == math.inf and not any(pond.time_windows for pond in farm.ponds):
        message = "nothing says by when the round must be done"
        raise InvalidInput(
            [Fault("--by", message, "give --start 22:00 --by 05:30, or start and end in the fleet file")]
        )
    left = num_beyond
    for num_drones in range(1, max_drones + 1):
        sized = replace(fleet, num_drones=num_drones)
        task, _, _ = _task(farm, sized, wind)
        is_proven = _core.round_bound(task) > fleet.span_s * (1 + 1e-9)
        trips, _, is_interrupted = _searched(task, effort, LEAST_STEPS + STEPS_PER_POND * task.num_visits)
        plan = _core.evaluate_round(task, trips)
        num_unserved = sum(violation.kind == "unserved" for violation in plan.violations)
        size = Size(num_drones, plan.makespan_s, num_unserved, is_proven, is_interrupted)
        yield size
        if is_interrupted or (size.is_enough and left == 0):
            return
        left -= size.is_enough
