"""What the command line prints for people: tables of plans, averages and assumptions."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean

from rich.console import Console
from rich.table import Table

from pondhop.files.routes_json import Judgement
from pondhop.solution import FarmPlan, Solution

MAX_ROWS = 20
"""Of a table with a row a farm; beyond it only the averages are printed."""


def print_farm_plan(farm_plan: FarmPlan) -> None:
    """Print the routes of a farm's plan, what it rests on and how good it is."""
    console = Console(highlight=False)
    solution, farm = farm_plan.solution, farm_plan.farm
    plan = solution.plan
    console.print(f"{farm.name}: {len(farm.ponds)} ponds, {len(plan.routes)} routes", style="bold")
    table = Table()
    for heading in ("Drone", "Ponds", "Length", "Duration"):
        table.add_column(heading, justify="right")
    for number, route in enumerate(plan.routes):
        length, duration = _km(plan.route_lengths[number]), _minutes(plan.route_durations_s[number])
        table.add_row(str(number + 1), str(len(route)), length, duration)
    table.add_section()
    table.add_row("longest", "", _km(plan.max_route_length), _minutes(plan.makespan_s), style="bold")
    table.add_row(
        "total", str(sum(map(len, plan.routes))), _km(plan.total_length), _minutes(sum(plan.route_durations_s))
    )
    console.print(table)

    bound = f"No plan has a longest route below {_km(solution.lower_bound)}"
    if solution.gap_percent is not None:
        bound += f": this one is at most {solution.gap_percent:.0f} % above the best"
    console.print(f"{bound}.")
    if solution.separation is not None:
        overlap, num_crossings = solution.separation.overlap, solution.separation.num_crossings
        console.print(
            f"Routes of different drones share {overlap:.1%} of the farm's area and cross {num_crossings} times."
        )
    console.print(f"Planner {solution.planner}, seed {solution.seed}, {1e3 * solution.elapsed_s:.2f} ms.")
    _print_assumptions(console, farm_plan)
    for violation in plan.violations:
        console.print(f"Violation: {violation}", style="bold red")


def print_solutions(solutions: Sequence[Solution]) -> None:
    """Print the averages of the plans of research farms."""
    table = _averages_table(
        f"{len(solutions)} farms, planner {solutions[0].planner}",
        [solution.plan.max_route_length for solution in solutions],
        [solution.plan.total_length for solution in solutions],
        [solution.gap_percent for solution in solutions],
    )
    table.add_row("seconds for all farms", f"{sum(solution.elapsed_s for solution in solutions):.4f}")
    for reason in sorted({solution.reason for solution in solutions} - {""}):
        table.add_row("chosen", reason)
    num_infeasible = sum(not solution.plan.is_feasible for solution in solutions)
    table.add_row("infeasible plans", str(num_infeasible), style="bold red" if num_infeasible else None)
    Console(highlight=False).print(table)


def print_judgements(judgements: Sequence[Judgement]) -> None:
    """Print how the plans of research farms were judged: each farm if they are few, the averages, every violation."""
    console = Console(highlight=False)
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
        f"{len(judgements)} farms",
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


def _print_assumptions(console: Console, farm_plan: FarmPlan) -> None:
    fleet = farm_plan.fleet
    console.print(
        f"Fleet: {fleet.speed_m_s:g} m/s, {fleet.transit_height_m:g} m high, {fleet.sampling} with "
        f"{fleet.service_s:.1f} s a pond, {fleet.leg_stop_s:g} s a leg to stop and start."
    )
    if fleet.assumptions:
        names = ", ".join(fleet.assumptions)
        console.print(f"Assumed, not measured: {names}. Say what is true of your drones in a --fleet file.")
    for note in farm_plan.notes:
        console.print(f"Note: {note}")


def _km(length_m: float) -> str:
    return f"{length_m / 1000:.2f} km"


def _minutes(duration_s: float) -> str:
    minutes, seconds = divmod(round(duration_s), 60)
    return f"{minutes} min {seconds:02} s"
