"""``pondhop solve`` and what goes with research farms: judging, drawing and generating."""

from __future__ import annotations

import json
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, Unpack

import typer

from pondhop.cli.shared import (
    EXIT_INFEASIBLE,
    Json,
    RequireFeasible,
    Seed,
    UnitsOption,
    exit_stopped,
    progress,
    require_matplotlib,
    search_progress,
    with_planning_options,
)
from pondhop.errors import Fault, InvalidInput
from pondhop.planners import PlainOptions
from pondhop.units import counted

if TYPE_CHECKING:
    from pondhop.files.routes_json import Judgement
    from pondhop.instances import ResearchFarm
    from pondhop.rounds import Rounding

MIN_ROUND_STEPS = 100_000
"""Steps that a round is planned for where neither steps nor seconds are said."""

ROUND_STEPS_PER_VISIT = 1_000

FarmsOption = Annotated[Path | None, typer.Option(help="The research farms that the plans are for.")]


@with_planning_options
def solve(
    farms: Annotated[
        Path,
        typer.Argument(
            exists=True, help="Research farms as JSON, a TSPLIB .tsp file, or a round: Solomon's .txt, VRPLIB's .vrp."
        ),
    ],
    routes: Annotated[
        int | None, typer.Option(min=1, help="At most this many routes a farm; in a round as many as the file says.")
    ] = None,
    start: Annotated[
        Path | None, typer.Option(exists=True, help="Plans of 'pondhop solve' that the search begins with.")
    ] = None,
    rounding: Annotated[
        Literal["exact", "dimacs"], typer.Option(help="Of a round: legs as they are, or cut to their first decimal.")
    ] = "exact",
    output: Annotated[Path | None, typer.Option("--output", "-o", help="File for the plans; else stdout.")] = None,
    require_feasible: RequireFeasible = False,
    as_json: Json = False,
    **options: Unpack[PlainOptions],
) -> None:
    """Plan every farm of a research file and write the routes as JSON, one object a farm.

    - `pondhop solve farms.json --routes 5 -o plans.json`
    - `pondhop solve farms.json --routes 5 --time-limit 0.1 --slack 1 -o plans.json`
    - `pondhop solve kroa200.tsp --routes 3 --planner hpp --seed 7`
    - `pondhop solve C101.txt --objective total --rounding dimacs --time-limit 5 -o plans.json`

    Ctrl-C ends the search of a farm with the best plan so far, and writes the plans of the farms until then.

    The fields of an object:

    - `index` of the farm in the file, `planner`, `seed`
    - `elapsed_s`: wall time from coordinates to finished routes; reading and writing files is not in it
    - `routes`: 0-based pond indices in flying order, the depot implied at both ends
    - `route_lengths`, `max_route_length`, `total_length` in the units of the farm
    - `lower_bound`: no plan has a shorter longest route

    Every pond is in exactly one route, and there are at most `--routes` of them.

    Of a round (time windows, loads, releases, trips) the last landing is minimised, or the total length. Customers
    count from 0 in the order of the file; where it has trips, a route is a list of them. Its object has `index`,
    `planner`, `seed`, `elapsed_s`, `routes`, `total_length`, `makespan`, `is_feasible` and `violations`.
    """
    from pondhop.rounds import is_round_file

    if is_round_file(farms):
        _solve_round(farms, routes, rounding, start, output, require_feasible, as_json, **options)
        return
    if routes is None:
        raise InvalidInput([Fault("--routes", "the number of routes is missing", "say how many, as in --routes 5")])
    from pondhop import planners
    from pondhop.cli.printed import SolvedFarms
    from pondhop.files.routes_json import PlansWriter, read_routes

    read = _research_farms(farms)
    starts = read_routes(start) if start is not None else None
    if starts is not None:
        _check_same_number(read, starts)
    writer = PlansWriter(output, None if output is not None and not as_json else partial(typer.echo, nl=False))
    totals = SolvedFarms()
    is_stopped = False
    with progress("Planning", total=len(read)) as advance:
        try:
            for index, farm in enumerate(read):
                solution = planners.solve(
                    farm.to_problem(routes),
                    start=starts[index] if starts is not None else None,
                    progress=search_progress(advance),
                    **options,
                )
                writer.add(solution)
                totals.add(solution)
                if index == 0 and solution.passed_over:
                    typer.echo(f"Note: {solution.passed_over_text}", err=True)
                advance()
                if solution.is_interrupted:
                    is_stopped = True
                    break
        except KeyboardInterrupt:
            is_stopped = True
        except BaseException:
            writer.abandon()
            raise
    writer.finish()
    if output is not None and not as_json and writer.num_plans:
        totals.print()
    if is_stopped:
        exit_stopped(f"stopped; {writer.num_plans} of {len(read)} farms are planned")
    if require_feasible and totals.num_infeasible:
        raise typer.Exit(EXIT_INFEASIBLE)


def _solve_round(
    path: Path,
    routes: int | None,
    rounding: Rounding,
    start: Path | None,
    output: Path | None,
    require_feasible: bool,
    as_json: bool,
    **options: Unpack[PlainOptions],
) -> None:
    """Plan the round of a file, and write what `solve` says of one."""
    from pondhop import _core
    from pondhop.documents.atomic import write_all
    from pondhop.rounds import read_round

    _check_round_options(start, **options)
    read = read_round(path, rounding=rounding, num_drones=routes)
    seconds, steps = options.get("time_limit_s"), options.get("iterations")
    if seconds is None and steps is None:
        steps = max(MIN_ROUND_STEPS, ROUND_STEPS_PER_VISIT * read.round.num_visits)
    with progress("Planning", total=1) as advance:
        trips, elapsed_s, _, is_stopped = _core.search_round(
            read.round,
            seed=options.get("seed", 1),
            time_limit_s=seconds,
            iterations=steps,
            threads=options.get("threads", 1),
            objective=options.get("objective", "max"),
            progress=search_progress(advance),
        )
    plan = _core.evaluate_round(read.round, trips)
    flown = [route for route in plan.routes if route]
    record = {
        "index": 0,
        "planner": "search",
        "seed": options.get("seed", 1),
        "elapsed_s": elapsed_s,
        "routes": flown if read.has_trips else [trip for route in flown for trip in route],
        "total_length": plan.total_length,
        "makespan": plan.makespan_s,
        "is_feasible": plan.is_feasible,
        "violations": [str(violation) for violation in plan.violations],
    }
    text = f"[\n{json.dumps(record)}\n]\n"
    if output is not None:
        write_all({output: text})
    if output is None or as_json:
        typer.echo(text, nl=False)
    else:
        num_trips = sum(map(len, plan.routes))
        told = "feasible" if plan.is_feasible else f"not feasible: {counted(len(plan.violations), 'violation')}"
        length, last = f"{plan.total_length:.1f} long in all", f"the last ends at {plan.makespan_s:.1f}"
        typer.echo(f"{counted(num_trips, 'trip')}, {length}, {last}, {told}")
    if is_stopped:
        exit_stopped("stopped; the best plan so far is written")
    if require_feasible and not plan.is_feasible:
        raise typer.Exit(EXIT_INFEASIBLE)


def _check_round_options(start: Path | None, **options: Unpack[PlainOptions]) -> None:
    """Refuse, all at once, what a search for a round does not know.

    Raises
    ------
    InvalidInput
        With every option that would be without effect.
    """
    faults = []
    for name, is_given in (
        ("--start", start is not None),
        ("--slack", options.get("slack_percent", 0.0) != 0.0),
        ("--separate-airspace", options.get("has_separate_airspace", False)),
        ("--planner", options.get("planner", "auto") not in {"auto", "search"}),
    ):
        if is_given:
            faults.append(Fault(name, "a round is planned without it", "leave it out"))
    if faults:
        raise InvalidInput(faults)


def evaluate(
    plans: Annotated[Path, typer.Argument(exists=True, help="plan.json of a farm, or the plans of 'pondhop solve'.")],
    farms: FarmsOption = None,
    routes: Annotated[
        int | None, typer.Option(min=1, help="How many routes are allowed; else as many as used.")
    ] = None,
    units: UnitsOption = "metric",
    require_feasible: RequireFeasible = False,
    as_json: Json = False,
) -> None:
    """Judge plans: lengths, durations and broken rules, recomputed from the bare routes.

    - `pondhop evaluate tonight/plan.json`
    - `pondhop evaluate plans.json --farms farms.json --routes 5 --json`

    Any program's plans can be judged: a JSON list of objects with `routes`, 0-based pond indices in flying order.
    """
    from pondhop.cli import printed

    if farms is None:
        from pondhop import missions
        from pondhop.files.plan_json import read_plan_json

        _check_plan_of_farm(plans)
        farm_plan = missions.judged(read_plan_json(plans), units)
        if as_json:
            typer.echo(plans.read_text(), nl=False)
        else:
            printed.print_farm_plan(farm_plan, units)
            printed.print_violations(farm_plan, units)
        is_feasible = farm_plan.is_feasible
    else:
        judgements = _judgements(plans, farms, routes)
        if as_json:
            typer.echo(json.dumps([asdict(judgement) for judgement in judgements], indent=1))
        else:
            printed.print_judgements(judgements)
        is_feasible = all(judgement.is_feasible for judgement in judgements)
    if require_feasible and not is_feasible:
        raise typer.Exit(EXIT_INFEASIBLE)


def plot(
    plans: Annotated[Path, typer.Argument(exists=True, help="plan.json of a farm, or the plans of 'pondhop solve'.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="The picture, .png or .svg.")],
    farms: FarmsOption = None,
    index: Annotated[int, typer.Option(min=0, help="Which of the research farms, from 0.")] = 0,
    units: UnitsOption = "metric",
    as_json: Json = False,
) -> None:
    """Draw a plan: outline, ponds, depot and routes, with their lengths in the legend.

    - `pondhop plot tonight/plan.json -o tonight/plan.svg`
    - `pondhop plot plans.json --farms farms.json --index 3 -o farm3.png`
    """
    require_matplotlib()
    if output.suffix.lower() not in (".png", ".svg"):
        raise InvalidInput([Fault("--output", f"{output} is neither .png nor .svg", "let the name end in one of them")])
    from pondhop import plot as figures

    with progress("Drawing", total=1) as advance:
        if farms is None:
            from pondhop import missions
            from pondhop.files.plan_json import read_plan_json

            _check_plan_of_farm(plans)
            axes = figures.plot_plan(missions.judged(read_plan_json(plans), units), units=units)
        else:
            farm, routes = _farm_and_routes(plans, farms, index)
            axes = figures.plot_solution(farm.to_problem(max(1, len(routes))), routes, boundary=farm.boundary)
        figures.save_figure(axes, output)
        advance()
    typer.echo(json.dumps({"figure": str(output)}) if as_json else f"Written: {output}")


def generate(
    ponds: Annotated[int, typer.Option(min=1, help="Ponds a farm.")],
    farms: Annotated[int, typer.Option(min=1, help="How many farms.")] = 1,
    seed: Seed = 1,
    variant: Annotated[
        Literal["authors", "paper"],
        typer.Option(help="As the paper's authors coded their farms, or as the paper describes them."),
    ] = "authors",
    output: Annotated[Path | None, typer.Option("--output", "-o", help="File for the farms; else stdout.")] = None,
    as_json: Json = False,
) -> None:
    """Draw research farms as the paper does: a grid of ponds in a random outline, in the unit square.

    - `pondhop generate --ponds 300 --farms 100 --seed 1 -o farms.json`
    """
    from pondhop import instances

    drawn = instances.generate(ponds, farms, seed=seed, variant=variant)
    if output is not None:
        instances.write_farms(output, drawn)
    if output is None or as_json:
        typer.echo(instances.farms_json(drawn), nl=False)
    else:
        typer.echo(f"Written to {output}: {counted(farms, 'farm')} of {counted(ponds, 'pond')}")


def _research_farms(path: Path) -> list[ResearchFarm]:
    from pondhop import instances

    return instances.read(path)


def _judgements(plans: Path, farms: Path, num_routes: int | None) -> list[Judgement]:
    from pondhop.files.routes_json import judge, read_routes

    routes_of_farms = read_routes(plans)
    read = _research_farms(farms)
    _check_same_number(read, routes_of_farms)
    judgements = []
    with progress("Evaluating", total=len(read)) as advance:
        for index, (farm, routes) in enumerate(zip(read, routes_of_farms, strict=True)):
            problem = farm.to_problem(num_routes or max(1, len(routes)))
            judgements.append(judge(index, problem, routes))
            advance()
    return judgements


def _farm_and_routes(plans: Path, farms: Path, index: int) -> tuple[ResearchFarm, list[list[int]]]:
    from pondhop.files.routes_json import read_routes

    routes = read_routes(plans)
    read = _research_farms(farms)
    _check_same_number(read, routes)
    if index >= len(read):
        action = f"give 0 to {len(read) - 1}"
        raise InvalidInput([Fault("--index", f"there is no farm {index} in {farms}", action)])
    return read[index], routes[index]


def _check_same_number(farms: list[ResearchFarm], routes: list[list[list[int]]]) -> None:
    if len(farms) != len(routes):
        message = f"{len(routes)} plans for {len(farms)} farms"
        raise InvalidInput([Fault("--farms", message, "give the farms that were solved, in the same order")])


def _check_plan_of_farm(path: Path) -> None:
    """Ask for the farms where a file holds plans of research farms: a list, and no ``plan.json``."""
    try:
        with path.open("rb") as file:
            is_list = file.read(4096).lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"[")
    except OSError:
        # Whoever reads it tells what is wrong.
        return
    if is_list:
        action = "pass --farms with the file of farms that they are for"
        raise InvalidInput([Fault(str(path), "it holds plans of research farms, and nothing says of which", action)])
