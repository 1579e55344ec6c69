"""The command line: ``pondhop COMMAND --help`` teaches each command.

Exit codes: 0 done, 2 invalid input, 3 infeasible with ``--require-feasible``, 1 a bug, 130 stopped with Ctrl-C.
Results go to stdout, everything else to stderr. Heavy packages are imported where they are used, because
``pondhop plan`` should take no longer than planning does.
"""

from __future__ import annotations

import json
import shlex
import signal
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NoReturn

import typer

from pondhop.cli_bench import bench
from pondhop.cli_shared import Advance, Json, progress
from pondhop.cli_train import train_am
from pondhop.errors import Fault, InvalidInput

if TYPE_CHECKING:
    from pondhop.farm_features import LonLat
    from pondhop.fleet import Fleet, SamplingStyle
    from pondhop.instances import ResearchFarm
    from pondhop.planfile import FarmPlan, Solution
    from pondhop.planners import ProgressFunction
    from pondhop.solutionfile import Judgement

EXIT_BUG = 1
EXIT_INVALID_INPUT = 2
EXIT_INFEASIBLE = 3
EXIT_INTERRUPTED = 130
FIGURE_NAMES = ("plan.png", "plan.svg")

app = typer.Typer(
    name="pondhop",
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    add_completion=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(bench, name="bench")

Seed = Annotated[int, typer.Option(min=0, help="The same seed gives the same result, on every machine.")]
PlannerName = Annotated[
    str,
    typer.Option(
        help="Which planner: auto, search, territory, hpp; to compare: ortools, ortools-gls, pyvrp, am, am-minmax."
    ),
]
TimeLimit = Annotated[
    float | None, typer.Option("--time-limit", metavar="SECONDS", help="Wall time of planning one farm.")
]
Threads = Annotated[int, typer.Option(min=1, help="Threads a planner may use for one farm.")]
Iterations = Annotated[
    int | None,
    typer.Option(
        min=1, help="Steps of the search a farm and thread, or plans to draw: reproducible, unlike a time limit."
    ),
]
Slack = Annotated[
    float,
    typer.Option(
        "--slack", min=0.0, metavar="PERCENT", help="How much longer the longest route may get to shorten the total."
    ),
]
Objective = Annotated[
    Literal["max", "total"], typer.Option(help="What to minimise: the longest route (then the total), or the total.")
]
SeparateAirspace = Annotated[
    bool, typer.Option("--separate-airspace", help="Every drone keeps to a territory of its own.")
]
Decoding = Annotated[
    Literal["greedy", "symmetries", "sampling"],
    typer.Option(
        help="How am and am-minmax plan: likeliest choices, best of 8 symmetries of the farm, best of 128 draws."
    ),
]
RequireFeasible = Annotated[bool, typer.Option("--require-feasible", help="Exit with 3 if a plan breaks a rule.")]
FarmsOption = Annotated[Path | None, typer.Option(help="The research farms that the plans are for.")]


def main() -> None:
    """Run the command line and answer what goes wrong in words a user can act on."""
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    arguments = sys.argv[1:]
    try:
        app(arguments, prog_name="pondhop")
    except InvalidInput as error:
        _print_invalid_input(error.faults, "--json" in arguments)
        sys.exit(EXIT_INVALID_INPUT)
    except OSError as error:
        if error.filename is None:
            _exit_with_bug(error, arguments)
        fault = Fault(str(error.filename), error.strerror or str(error), "check the path, its permissions and the disk")
        _print_invalid_input((fault,), "--json" in arguments)
        sys.exit(EXIT_INVALID_INPUT)
    except Exception as error:  # noqa: BLE001 - the last resort: a user never sees a traceback unasked
        _exit_with_bug(error, arguments)


@app.callback()
def _pondhop(
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of a bug.")] = False,  # noqa: ARG001 - read by main
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    """Balanced routes and checked missions for drone fleets that sample aquaculture ponds.

    Start with a farm of your own, or with one that pondhop makes up:

    - `pondhop generate-farm --ponds 120 --at -90.9,33.4 -o farm.geojson`
    - `pondhop plan farm.geojson --drones 5 -o tonight`

    Exit codes: 0 done, 2 invalid input, 3 infeasible with `--require-feasible`, 1 a bug.
    """
    if version:
        from pondhop import __version__

        typer.echo(f"pondhop {__version__}")
        raise typer.Exit


@app.command(no_args_is_help=True)
def plan(
    farm: Annotated[
        Path,
        typer.Argument(exists=True, help="GeoJSON, KML, KMZ, Shapefile, GeoPackage, or CSV of positions or corners."),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for plan, picture and missions.")],
    drones: Annotated[int | None, typer.Option(min=1, help="How many drones fly; all else is assumed.")] = None,
    fleet: Annotated[
        Path | None, typer.Option(exists=True, help="The fleet as a TOML file, instead of --drones.")
    ] = None,
    depot: Annotated[
        str | None, typer.Option(metavar="LON,LAT", help="Where drones start and land, if the file does not say.")
    ] = None,
    sampling: Annotated[Literal["hover-dip", "splashdown"] | None, typer.Option(help="How a pond is sampled.")] = None,
    planner: PlannerName = "auto",
    time_limit_s: TimeLimit = None,
    seed: Seed = 1,
    threads: Threads = 1,
    iterations: Iterations = None,
    slack_percent: Slack = 0.0,
    objective: Objective = "max",
    separate_airspace: SeparateAirspace = False,
    decoding: Decoding = "greedy",
    figure: Annotated[bool, typer.Option(help="Draw the plan (PNG and SVG).")] = True,
    require_feasible: RequireFeasible = False,
    as_json: Json = False,
) -> None:
    """Plan a round over a real farm: routes, a picture and one checked mission file per drone.

    - `pondhop plan farm.geojson --drones 3 -o tonight`
    - `pondhop plan farm.kml --drones 3 --depot -89.21,37.70 -o tonight`
    - `pondhop plan farm.gpkg --fleet fleet.toml --sampling splashdown --no-figure -o tonight`

    Everything wrong with the farm file is reported at once, each fault with its place and its remedy.
    """
    from pondhop import planfile, planners
    from pondhop.farm import read_farm

    if figure:
        _require_matplotlib()
    chosen_fleet = _fleet(drones, fleet, sampling)
    with progress("Planning", total=4 if figure else 3) as advance:
        read = read_farm(farm, depot=_lonlat("--depot", depot) if depot is not None else None)
        advance()
        farm_plan = planners.plan(
            read,
            chosen_fleet,
            planner=planner,
            seed=seed,
            time_limit_s=time_limit_s,
            threads=threads,
            iterations=iterations,
            slack_percent=slack_percent,
            objective=objective,
            progress=_search_progress(advance),
            has_separate_airspace=separate_airspace,
            decoding=decoding,
        )
        advance()
        output.mkdir(parents=True, exist_ok=True)
        planfile.write_plan_json(output / "plan.json", farm_plan)
        planfile.write_plan_geojson(output / "plan.geojson", farm_plan)
        faults = _write_missions(output / "missions", farm_plan)
        advance()
        if figure:
            from pondhop import plot as figures

            axes = figures.plot_plan(farm_plan)
            for name in FIGURE_NAMES:
                figures.save_figure(axes, output / name)
            advance()
        else:
            for name in FIGURE_NAMES:
                (output / name).unlink(missing_ok=True)
    if as_json:
        typer.echo((output / "plan.json").read_text(encoding="utf-8"), nl=False)
    else:
        from pondhop import tables

        tables.print_farm_plan(farm_plan)
        written = ["plan.json", "plan.geojson", *(() if faults else ["missions/"])]
        written += FIGURE_NAMES if figure else ()
        typer.echo(f"Written to {output}: {', '.join(written)}")
    if faults:
        _print_faults(faults, "no_missions", "No mission was written, because this plan cannot be flown", as_json)
    if require_feasible and (faults or not farm_plan.solution.plan.is_feasible):
        raise typer.Exit(EXIT_INFEASIBLE)


@app.command(no_args_is_help=True)
def solve(
    farms: Annotated[Path, typer.Argument(exists=True, help="Research farms as JSON, or a TSPLIB .tsp file.")],
    routes: Annotated[int, typer.Option(min=1, help="At most this many routes a farm.")],
    planner: PlannerName = "auto",
    time_limit_s: TimeLimit = None,
    seed: Seed = 1,
    threads: Threads = 1,
    iterations: Iterations = None,
    slack_percent: Slack = 0.0,
    objective: Objective = "max",
    separate_airspace: SeparateAirspace = False,
    decoding: Decoding = "greedy",
    start: Annotated[
        Path | None, typer.Option(exists=True, help="Plans of 'pondhop solve' that the search begins with.")
    ] = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="File for the plans; else stdout.")] = None,
    require_feasible: RequireFeasible = False,
    as_json: Json = False,
) -> None:
    """Plan every farm of a research file and write the routes as JSON, one object a farm.

    - `pondhop solve farms.json --routes 5 -o plans.json`
    - `pondhop solve farms.json --routes 5 --time-limit 0.1 --slack 1 -o plans.json`
    - `pondhop solve kroa200.tsp --routes 3 --planner hpp --seed 7`

    Ctrl-C ends the search of a farm with the best plan so far, and writes the plans of the farms until then.

    The fields of an object:

    - `index` of the farm in the file, `planner`, `seed`
    - `elapsed_s`: wall time from coordinates to finished routes; reading and writing files is not in it
    - `routes`: 0-based pond indices in flying order, the depot implied at both ends
    - `route_lengths`, `max_route_length`, `total_length` in the units of the farm
    - `lower_bound`: no plan has a shorter longest route

    Every pond is in exactly one route, and there are at most `--routes` of them.
    """
    from pondhop import planners
    from pondhop.solutionfile import read_routes, solutions_json

    read = _research_farms(farms)
    starts = read_routes(start) if start is not None else None
    if starts is not None:
        _check_same_number(read, starts)
    solutions: list[Solution] = []
    with progress("Planning", total=len(read)) as advance:
        for index, farm in enumerate(read):
            problem = farm.to_problem(routes)
            solution = planners.solve(
                problem,
                planner=planner,
                seed=seed,
                time_limit_s=time_limit_s,
                threads=threads,
                iterations=iterations,
                slack_percent=slack_percent,
                objective=objective,
                start=starts[index] if starts is not None else None,
                progress=_search_progress(advance),
                has_separate_airspace=separate_airspace,
                decoding=decoding,
            )
            solutions.append(solution)
            advance()
            if solution.is_interrupted:
                break
    text = solutions_json(solutions)
    if output is not None:
        _write_text(output, text)
    if output is None or as_json:
        typer.echo(text, nl=False)
    else:
        from pondhop import tables

        tables.print_solutions(solutions)
    if solutions[-1].is_interrupted:
        typer.echo(f"pondhop: stopped; {len(solutions)} of {len(read)} farms are planned", err=True)
        raise typer.Exit(EXIT_INTERRUPTED)
    if require_feasible and not all(solution.plan.is_feasible for solution in solutions):
        raise typer.Exit(EXIT_INFEASIBLE)


@app.command(no_args_is_help=True)
def evaluate(
    plans: Annotated[Path, typer.Argument(exists=True, help="plan.json of a farm, or the plans of 'pondhop solve'.")],
    farms: FarmsOption = None,
    routes: Annotated[
        int | None, typer.Option(min=1, help="How many routes are allowed; else as many as used.")
    ] = None,
    require_feasible: RequireFeasible = False,
    as_json: Json = False,
) -> None:
    """Judge plans: lengths, durations and broken rules, recomputed from the bare routes.

    - `pondhop evaluate tonight/plan.json`
    - `pondhop evaluate plans.json --farms farms.json --routes 5 --json`

    Any program's plans can be judged: a JSON list of objects with `routes`, 0-based pond indices in flying order.
    """
    from pondhop import tables

    if farms is None:
        from pondhop.planfile import read_plan_json

        farm_plan = read_plan_json(plans)
        if as_json:
            typer.echo(plans.read_text(), nl=False)
        else:
            tables.print_farm_plan(farm_plan)
        is_feasible = farm_plan.solution.plan.is_feasible
    else:
        judgements = _judgements(plans, farms, routes)
        if as_json:
            typer.echo(json.dumps([asdict(judgement) for judgement in judgements], indent=1))
        else:
            tables.print_judgements(judgements)
        is_feasible = all(judgement.is_feasible for judgement in judgements)
    if require_feasible and not is_feasible:
        raise typer.Exit(EXIT_INFEASIBLE)


@app.command(no_args_is_help=True)
def plot(
    plans: Annotated[Path, typer.Argument(exists=True, help="plan.json of a farm, or the plans of 'pondhop solve'.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="The picture, .png or .svg.")],
    farms: FarmsOption = None,
    index: Annotated[int, typer.Option(min=0, help="Which of the research farms, from 0.")] = 0,
    as_json: Json = False,
) -> None:
    """Draw a plan: outline, ponds, depot and routes, with their lengths in the legend.

    - `pondhop plot tonight/plan.json -o tonight/plan.svg`
    - `pondhop plot plans.json --farms farms.json --index 3 -o farm3.png`
    """
    _require_matplotlib()
    if output.suffix.lower() not in (".png", ".svg"):
        raise InvalidInput([Fault("--output", f"{output} is neither .png nor .svg", "let the name end in one of them")])
    from pondhop import plot as figures

    with progress("Drawing", total=1) as advance:
        if farms is None:
            from pondhop.planfile import read_plan_json

            axes = figures.plot_plan(read_plan_json(plans))
        else:
            farm, routes = _farm_and_routes(plans, farms, index)
            axes = figures.plot_solution(farm.to_problem(max(1, len(routes))), routes, boundary=farm.boundary)
        figures.save_figure(axes, output)
        advance()
    typer.echo(json.dumps({"figure": str(output)}) if as_json else f"Written: {output}")


@app.command(no_args_is_help=True)
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
        output.parent.mkdir(parents=True, exist_ok=True)
        instances.write_farms(output, drawn)
    if output is None or as_json:
        typer.echo(instances.farms_json(drawn), nl=False)
    else:
        typer.echo(f"Written to {output}: {farms} farms of {ponds} ponds")


@app.command(no_args_is_help=True)
def generate_farm(
    ponds: Annotated[int, typer.Option(min=1, help="How many ponds.")],
    at: Annotated[str, typer.Option(metavar="LON,LAT", help="Where the farm lies.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="The GeoJSON file.")],
    seed: Seed = 1,
    missing_share: Annotated[float, typer.Option(min=0.0, max=0.9, help="Share of the ponds left out.")] = 0.0,
    irregular: Annotated[bool, typer.Option(help="Give the farm an irregular outline.")] = False,
    as_json: Json = False,
) -> None:
    """Make up a real-world farm: ponds of 4-8 ha in blocks with levees and a yard, as in the Mississippi Delta.

    - `pondhop generate-farm --ponds 700 --at -90.9,33.4 -o farm.geojson`
    """
    from pondhop.farm import write_farm
    from pondhop.farm_generator import generate_farm as generate

    farm = generate(ponds, at=_lonlat("--at", at), seed=seed, missing_share=missing_share, irregular=irregular)
    output.parent.mkdir(parents=True, exist_ok=True)
    write_farm(output, farm)
    message = {"farm": str(output), "num_ponds": len(farm.ponds)}
    typer.echo(json.dumps(message) if as_json else f"Written to {output}: {len(farm.ponds)} ponds")


app.command(no_args_is_help=True)(train_am)


def _fleet(num_drones: int | None, path: Path | None, sampling: SamplingStyle | None) -> Fleet:
    """Return the fleet of the options; one of ``--drones`` and ``--fleet`` says how many drones there are."""
    from pondhop.fleet import Fleet, read_fleet

    if num_drones is not None and path is not None:
        raise InvalidInput([Fault("--drones, --fleet", "both say how many drones there are", "give one of them")])
    if path is not None:
        fleet = read_fleet(path)
    elif num_drones is not None:
        fleet = Fleet(num_drones)
    else:
        action = "give --drones N, or --fleet fleet.toml"
        raise InvalidInput([Fault("--drones", "nothing says how many drones fly", action)])
    return fleet if sampling is None else replace(fleet, sampling=sampling)


def _write_missions(folder: Path, farm_plan: FarmPlan) -> tuple[Fault, ...]:
    """Write the missions; return what keeps the plan from being flown, which like every broken rule is a result."""
    from pondhop import missions

    try:
        missions.write_missions(folder, farm_plan)
    except InvalidInput as error:
        return error.faults
    return ()


def _lonlat(option: str, text: str) -> LonLat:
    parts = text.split(",")
    try:
        longitude_deg, latitude_deg = map(float, parts)
    except ValueError:
        action = f"write longitude first, as in {option} -90.9,33.4"
        raise InvalidInput([Fault(option, f"{text!r} is not LON,LAT in degrees", action)]) from None
    if not (abs(longitude_deg) <= 180 and abs(latitude_deg) <= 90):
        swapped = abs(latitude_deg) <= 180 and abs(longitude_deg) <= 90
        action = f"did you mean {parts[1]},{parts[0]}? Longitude comes first" if swapped else "give degrees"
        raise InvalidInput([Fault(option, f"{text!r} is no place on the globe", action)])
    return longitude_deg, latitude_deg


def _research_farms(path: Path) -> list[ResearchFarm]:
    from pondhop import instances

    return instances.read(path)


def _judgements(plans: Path, farms: Path, num_routes: int | None) -> list[Judgement]:
    from pondhop.solutionfile import judge, read_routes

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
    from pondhop.solutionfile import read_routes

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


def _require_matplotlib() -> None:
    from importlib.util import find_spec

    if find_spec("matplotlib") is None:
        action = "install it with: pip install 'pondhop[plot]'; or plan with --no-figure"
        raise InvalidInput([Fault("figure", "pictures need matplotlib, which is not installed", action)])


def _write_text(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def _search_progress(advance: Advance) -> ProgressFunction:
    """Show how far a search is: its best longest route, in seconds or the units of a research farm."""

    def report(max_route_cost: float, num_iterations: int, share: float) -> None:
        advance(min(share, 0.999), f"longest {max_route_cost:.4g} after {num_iterations:,} steps")

    return report


def _print_invalid_input(faults: tuple[Fault, ...], as_json: bool) -> None:
    heading = f"pondhop: {len(faults)} {'problem' if len(faults) == 1 else 'problems'} in the input"
    _print_faults(faults, "invalid_input", heading, as_json)


def _print_faults(faults: tuple[Fault, ...], status: str, heading: str, as_json: bool) -> None:
    if as_json:
        typer.echo(json.dumps({"status": status, "faults": [asdict(fault) for fault in faults]}), err=True)
        return
    typer.echo(heading, err=True)
    for number, fault in enumerate(faults, start=1):
        typer.echo(f"{number:3}. {fault.path}: {fault.message}\n     -> {fault.action}", err=True)


def _exit_with_bug(error: Exception, arguments: list[str]) -> NoReturn:
    if "--debug" in arguments:
        raise error
    typer.echo(
        f"pondhop: this is a bug in pondhop, not in your input: {type(error).__name__}: {error}\n"
        f"Please report it with your file and what this prints: pondhop --debug {shlex.join(arguments)}",
        err=True,
    )
    sys.exit(EXIT_BUG)
