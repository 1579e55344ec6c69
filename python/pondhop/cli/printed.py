"""What the command line prints for people: tables of plans, averages and assumptions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import fmean

from rich.console import Console
from rich.table import Table

from pondhop.encounters import encounters_text
from pondhop.farm.features import listed
from pondhop.files.routes_json import Judgement
from pondhop.planners import LIMIT_KINDS
from pondhop.solution import FarmPlan, Solution
from pondhop.units import (
    Units,
    counted,
    duration_text,
    energy_text,
    height_text,
    length_text,
    speed_text,
)

LEAST_WAIT_S = 0.5
"""A wait that is told."""

MAX_ROWS = 20
"""Of a table with a row a farm; beyond it only the averages are printed."""


def print_farm_plan(farm_plan: FarmPlan, units: Units = "metric") -> None:
    """Print the routes of a farm's plan, what they take, what they rest on and how good they are."""
    console = Console(highlight=False, markup=False)
    solution, farm = farm_plan.solution, farm_plan.farm
    ponds, trips = counted(len(farm.ponds), "pond"), counted(len(farm_plan.trips), farm_plan.trip_word)
    drones = "" if farm_plan.fleet.swap_s is None else f" of {counted(farm_plan.num_drones_flying, 'drone')}"
    console.print(f"{farm.name}: {ponds}, {trips}{drones}", style="bold")
    console.print(_trips_table(farm_plan, units) if farm_plan.is_round else _routes_table(farm_plan, units))
    if farm_plan.is_round:
        console.print(farm_plan.battery_text)
        if farm_plan.wind.speed_m_s:
            console.print(f"Planned for {farm_plan.wind.told(units)}.")
    elif any(trip.energy_j for trip in farm_plan.trips):
        console.print(_energy_table(farm_plan))
        console.print(farm_plan.battery_text)
    _print_left_out(console, farm_plan)
    if farm_plan.num_drones_flying > 1:
        console.print(encounters_text(farm_plan, units))
    if farm_plan.trips:
        console.print(f"All drones are back {duration_text(farm_plan.span_s)} after the first take-off.")
    bound = f"No plan is done with its longest route in less than {duration_text(solution.lower_bound_s)}"
    if farm_plan.is_round:
        bound = "No plan visits all ponds: a bound proves it"
        if math.isfinite(solution.lower_bound_s):
            least_s = duration_text(solution.lower_bound_s)
            bound = f"No plan that visits all ponds has its last landing less than {least_s} after the start"
    if solution.gap_s_percent is not None:
        bound += f": this one takes at most {_gap(solution.gap_s_percent)} longer than the best there is"
    console.print(f"{bound}.")
    if solution.separation is not None:
        overlap, num_crossings = solution.separation.overlap, solution.separation.num_crossings
        on_ways = solution.separation.num_depot_leg_crossings
        console.print(
            f"Between ponds, routes of different drones cross {counted(num_crossings, 'time')}; "
            f"{counted(on_ways, 'more crossing')} {'is' if on_ways == 1 else 'are'} on their ways out and home. "
            f"They share {overlap:.1%} of the farm's area."
        )
    console.print(f"Planner {solution.planner}, seed {solution.seed}, {duration_of_planning(solution.elapsed_s)}.")
    _print_assumptions(console, farm_plan, units)


def _print_left_out(console: Console, farm_plan: FarmPlan) -> None:
    """Print the ponds that a round leaves out, those of the same reason together, and what would help."""
    groups: dict[tuple[str, tuple[str, ...]], list[int]] = {}
    for unserved in farm_plan.unserved:
        groups.setdefault((unserved.reason, unserved.remedies), []).append(unserved.pond)
    for (reason, remedies), ponds in groups.items():
        names = listed([farm_plan.farm.ponds[pond].id for pond in ponds])
        console.print(f"Left out: {counted(len(ponds), 'pond')} ({names}): {reason}.", style="bold red")
        if remedies:
            console.print(f"What would help: {'; or '.join(remedies)}.")
        else:
            console.print("Nothing that was tried helps: a later end, more drones, a smaller reserve.")


def print_violations(farm_plan: FarmPlan, units: Units = "metric") -> None:
    """Print every rule that a plan of a farm breaks, and what to do about it."""
    console = Console(highlight=False, markup=False)
    for violation in farm_plan.violations_told_in(units):
        drone = "" if violation.drone is None or violation.kind in LIMIT_KINDS else f"drone {violation.drone}, "
        console.print(f"Violation: {drone}{violation.message} -> {violation.remedy}", style="bold red")


def duration_of_planning(elapsed_s: float) -> str:
    """Return how long planning took, in milliseconds below a second."""
    return f"{1e3 * elapsed_s:.1f} ms" if elapsed_s < 1 else f"{elapsed_s:.2f} s"


def _gap(gap_percent: float) -> str:
    return "0.1 %" if 0 < gap_percent < 0.1 else f"{gap_percent:.1f} %"


def _routes_table(farm_plan: FarmPlan, units: Units) -> Table:
    """A row a drone; the one that takes longest is in bold and named below, so that no row mixes two drones."""
    trips = farm_plan.trips
    table = Table()
    for heading in ("Drone", "Ponds", "Length", "Duration", "Takes off", "Back"):
        table.add_column(heading, justify="right")
    longest = max(trips, key=lambda trip: trip.duration_s, default=None)
    for trip in trips:
        table.add_row(
            str(trip.drone + 1),
            str(len(trip.ponds)),
            length_text(trip.length_m, units),
            duration_text(trip.duration_s),
            farm_plan.clock(trip.departure_s),
            farm_plan.clock(trip.arrival_s),
            style="bold" if trip is longest else None,
        )
    table.add_section()
    num_ponds = sum(len(trip.ponds) for trip in trips)
    length, total_s = sum(trip.length_m for trip in trips), sum(trip.duration_s for trip in trips)
    table.add_row("total", str(num_ponds), length_text(length, units), duration_text(total_s), "", "")
    if longest is not None:
        table.caption = f"bold: drone {longest.drone + 1} takes longest"
    return table


def _trips_table(farm_plan: FarmPlan, units: Units) -> Table:
    """A row a trip, drone by drone; the last to land is in bold."""
    trips, usable_j = farm_plan.trips, farm_plan.fleet.usable_energy_j
    table = Table()
    has_waits = any(trip.waits_s > LEAST_WAIT_S for trip in trips)
    for heading in ("Drone", "Trip", "Ponds", "Length", "Takes off", "Back", "Energy", "Spare"):
        table.add_column(heading, justify="right", no_wrap=True)
    if has_waits:
        table.add_column("Waits", justify="right", no_wrap=True)
    last = max(trips, key=lambda trip: trip.arrival_s, default=None)
    drone = 0
    for trip in trips:
        if trip.drone != drone:
            table.add_section()
            drone = trip.drone
        # What is left above the reserve if the drone flies home from its worst place.
        spare_j = float((usable_j - trip.energies_j.sum(axis=1)).min())
        table.add_row(
            str(trip.drone + 1),
            str(trip.number + 1),
            str(len(trip.ponds)),
            length_text(trip.length_m, units),
            farm_plan.clock(trip.departure_s),
            farm_plan.clock(trip.arrival_s),
            energy_text(trip.energy_j),
            energy_text(spare_j) if math.isfinite(spare_j) else "unknown",
            *([duration_text(trip.waits_s) if trip.waits_s > LEAST_WAIT_S else ""] if has_waits else []),
            style="bold" if trip is last else None,
        )
    table.add_section()
    num_ponds, length = sum(len(trip.ponds) for trip in trips), sum(trip.length_m for trip in trips)
    energy = energy_text(sum(trip.energy_j for trip in trips))
    table.add_row("total", str(len(trips)), str(num_ponds), length_text(length, units), "", "", energy)
    table.caption = "bold: the last to land; spare: above the reserve, flying home from the worst place"
    return table


def _energy_table(farm_plan: FarmPlan) -> Table:
    usable_j = farm_plan.solution.problem.energy.usable_j
    table = Table()
    for heading in ("Drone", "Take-off", "Legs", "Sampling", "Way home", "Energy"):
        table.add_column(heading, justify="right")
    for trip in farm_plan.trips:
        phases = trip.phases
        is_over = phases.total_j > usable_j
        table.add_row(
            str(trip.drone + 1),
            *map(energy_text, (phases.takeoff_j, phases.legs_j, phases.sampling_j, phases.way_home_j, phases.total_j)),
            style="bold red" if is_over else None,
        )
    return table


class SolvedFarms:
    """What is told of the plans of many research farms, without keeping the plans."""

    def __init__(self) -> None:
        self._longest: list[float] = []
        self._totals: list[float] = []
        self._gaps: list[float | None] = []
        self._reasons: set[str] = set()
        self._planner = ""
        self._elapsed_s = 0.0
        self.num_infeasible = 0

    def add(self, solution: Solution) -> None:
        """Count the plan of a farm."""
        self._longest.append(solution.plan.max_route_length)
        self._totals.append(solution.plan.total_length)
        self._gaps.append(solution.gap_percent)
        self._reasons |= {solution.reason} - {""}
        self._planner = solution.planner
        self._elapsed_s += solution.elapsed_s
        self.num_infeasible += not solution.plan.is_feasible

    def print(self) -> None:
        """Print the averages."""
        title = f"{counted(len(self._longest), 'farm')}, planner {self._planner}"
        table = _averages_table(title, self._longest, self._totals, self._gaps)
        table.add_row("seconds for all farms", f"{self._elapsed_s:.4f}")
        for reason in sorted(self._reasons):
            table.add_row("chosen", reason)
        style = "bold red" if self.num_infeasible else None
        table.add_row("infeasible plans", str(self.num_infeasible), style=style)
        Console(highlight=False, markup=False).print(table)


def print_judgements(judgements: Sequence[Judgement]) -> None:
    """Print how the plans of research farms were judged: each farm if they are few, the averages, every violation."""
    console = Console(highlight=False, markup=False)
    if len(judgements) <= MAX_ROWS:
        table = Table()
        for heading in ("Farm", "Ponds", "Routes", "Longest", "Total", "Gap", "Overlap", "Crossings"):
            table.add_column(heading, justify="right")
        for farm in judgements:
            lengths = (f"{farm.max_route_length:.4f}", f"{farm.total_length:.4f}")
            gap = "unknown" if farm.gap_percent is None else f"{farm.gap_percent:.1f} %"
            quality = (gap, f"{farm.overlap:.1%}", str(farm.num_crossings))
            table.add_row(str(farm.index), str(farm.num_ponds), str(farm.num_routes), *lengths, *quality)
        console.print(table)
    averages = _averages_table(
        counted(len(judgements), "farm"),
        [farm.max_route_length for farm in judgements],
        [farm.total_length for farm in judgements],
        [farm.gap_percent for farm in judgements],
    )
    averages.add_row("overlap, average", f"{fmean(farm.overlap for farm in judgements):.1%}")
    averages.add_row("crossings, average", f"{fmean(farm.num_crossings for farm in judgements):.1f}")
    console.print(averages)
    for farm in judgements:
        for violation in farm.violations:
            console.print(f"Violation in farm {farm.index}: {violation}", style="bold red")


def _averages_table(
    title: str, longest: Sequence[float], totals: Sequence[float], gaps_percent: Sequence[float | None]
) -> Table:
    table = Table(title=title, show_header=False)
    table.add_column()
    table.add_column(justify="right")
    table.add_row("longest route, average", f"{fmean(longest):.4f}")
    table.add_row("total length, average", f"{fmean(totals):.4f}")
    known = [gap for gap in gaps_percent if gap is not None]
    table.add_row("gap to the lower bound, average", f"{fmean(known):.1f} %" if known else "unknown")
    return table


def _print_assumptions(console: Console, farm_plan: FarmPlan, units: Units) -> None:
    fleet = farm_plan.fleet
    console.print(
        f"Fleet: {speed_text(fleet.speed_m_s, units)}, {height_text(fleet.transit_height_m, units)} high, "
        f"{fleet.sampling} with {fleet.service_s:.1f} s a pond, {fleet.stop_s:.3g} s a leg to stop and start."
    )
    if fleet.assumptions:
        names = ", ".join(fleet.assumptions)
        console.print(f"Assumed, not measured: {names}. Say what is true of your drones in a --fleet file.")
    for note in farm_plan.notes_told_in(units):
        console.print(f"Note: {note}")
