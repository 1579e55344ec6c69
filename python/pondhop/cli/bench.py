"""``pondhop bench``: planners against each other, as tables."""

from __future__ import annotations

import json
import math
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, TypeVar

import typer

from pondhop.cli.shared import Json, progress
from pondhop.errors import Fault, InvalidInput

if TYPE_CHECKING:
    from pondhop.bench.best_known import BestKnown, BestPlan
    from pondhop.bench.farm_sets import BenchFarm
    from pondhop.bench.measure import Entrant, TimeLimit
    from pondhop.bench.summary import Comparison

TABLE_NAME = "results.md"
_Number = TypeVar("_Number", int, float)

bench = typer.Typer(no_args_is_help=True, help="Compare planners: on which farms, for how long, how good, as tables.")

BestKnownFile = Annotated[
    Path | None,
    typer.Option("--best-known", exists=True, help="Best plans known, .json or .csv: what gaps are measured from."),
]


@bench.command(no_args_is_help=True)
def run(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for results.csv and results.md.")],
    files: Annotated[
        list[Path] | None, typer.Argument(exists=True, help="Research farms as JSON, or TSPLIB .tsp files.")
    ] = None,
    generate: Annotated[
        str | None, typer.Option(metavar="N,N,...", help="Draw a set of farms for each of these numbers of ponds.")
    ] = None,
    farms: Annotated[int, typer.Option(min=1, help="Farms in each drawn set.")] = 20,
    farm_seed: Annotated[int, typer.Option(min=0, help="Seed of the drawn farms.")] = 1,
    variant: Annotated[
        Literal["authors", "paper"], typer.Option(help="How farms are drawn; see 'pondhop generate'.")
    ] = "authors",
    routes: Annotated[
        str | None,
        typer.Option(metavar="N,N,...", help="Routes allowed; else each number that --best-known has for a farm."),
    ] = None,
    planners: Annotated[
        str,
        typer.Option(
            metavar="NAME,NAME,...", help="Planners, with options as in search:threads=2; yours as MODULE:FUNCTION."
        ),
    ] = "search",
    time_limits: Annotated[
        str | None, typer.Option(metavar="S,S,...", help="Wall seconds for a farm; else as the planner likes.")
    ] = None,
    seconds_per_node: Annotated[
        str | None,
        typer.Option(metavar="S,S,...", help="Time limits that grow with the farm: for each pond and the depot."),
    ] = None,
    seeds: Annotated[str, typer.Option(metavar="N,N,...", help="Seeds of the planners.")] = "1",
    jobs: Annotated[int, typer.Option(min=1, help="Runs at once; more than idle cores falsifies the times.")] = 1,
    best_known: BestKnownFile = None,
    update_best: Annotated[
        Path | None,
        typer.Option(
            help="Write the best plans known after these runs to this .json file; it is read first if it exists."
        ),
    ] = None,
    keep_plans: Annotated[
        bool, typer.Option("--keep-plans", help="Keep the routes of each run in plans.jsonl.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Run planners on farms and write results.csv, a row a run, and results.md, averages with gaps.

    - `pondhop bench run --generate 50,100,700 --farms 20 --routes 5 --planners search,hpp --time-limits 0.1 -o bench`
    - `pondhop bench run farms50.json --routes 3,5 --planners search:slack_percent=1 --seeds 1,2,3 --jobs 2 -o bench`
    - `pondhop bench run mtsp/*.tsp --best-known best.csv --seconds-per-node 0.1 -o bench`

    Every farm is planned with every number of routes, planner, time limit and seed. What is in results.csv already is
    not run again, as long as the code that plans is the same: the same command goes on where it was stopped.
    """
    from pondhop.bench import execute, farm_sets
    from pondhop.bench.best_known import write_best_known
    from pondhop.bench.measure import parse_entrants
    from pondhop.bench.results import Results, read_results
    from pondhop.bench.summary import Comparison, markdown
    from pondhop.documents.atomic import write_all

    faults: list[Fault] = []
    bench_farms: list[BenchFarm] = []
    with _collecting(faults):
        bench_farms += farm_sets.read_farm_sets(files or ())
    for num_ponds in _numbers("--generate", generate, int, 1, faults):
        with _collecting(faults):
            bench_farms += farm_sets.generate_farm_set(num_ponds, farms, seed=farm_seed, variant=variant)
    if not files and generate is None:
        faults.append(Fault("FILES, --generate", "there are no farms", "give files, or --generate 50,100"))
    best_known_files = [path for path in (best_known, update_best) if path is not None and path.exists()]
    known = _best_known(best_known_files, faults)
    if update_best is not None and update_best.suffix.lower() != ".json":
        faults.append(Fault("--update-best", f"{update_best} is no .json file", "let the name end in .json"))
    num_routes = _numbers("--routes", routes, int, 1, faults)
    limits = _time_limits(time_limits, seconds_per_node, faults)
    chosen_seeds = _numbers("--seeds", seeds, int, 0, faults)
    entrants: list[Entrant] = []
    with _collecting(faults), _modules_of_this_folder():
        entrants += parse_entrants(planners)
    tasks: list[farm_sets.Task] = []
    if routes is None or num_routes:
        with _collecting(faults):
            tasks += farm_sets.tasks(bench_farms, num_routes, known)
    if faults:
        raise InvalidInput(faults)

    requested = execute.requests(tasks, entrants, limits, chosen_seeds)
    results = Results(output, is_keeping_plans=keep_plans)
    finished = results.finished
    missing = [request for request in requested if request.key not in finished]
    with _broken_pipes_as_errors(), _modules_of_this_folder(), progress("Running", total=len(missing)) as advance:
        execute.execute(missing, results, num_jobs=jobs, advance=lambda _request: advance())
    comparison = Comparison(read_results(results.path), known)
    table_path = output / TABLE_NAME
    write_all({table_path: markdown(comparison, _name(best_known_files))})
    if update_best is not None:
        write_best_known(update_best, comparison.best_plans())
    if as_json:
        files_written = {"results": str(results.path), "table": str(table_path)}
        numbers = {"num_new_runs": len(missing), "num_runs": len(comparison.runs)}
        typer.echo(json.dumps(files_written | numbers | _rows(comparison), indent=1))
    else:
        _print_comparison(comparison)
        skipped = f", {len(requested) - len(missing)} were there already" if len(requested) > len(missing) else ""
        typer.echo(f"Written to {output}: {results.path.name}, {TABLE_NAME}; {len(missing)} runs{skipped}")


@bench.command(no_args_is_help=True)
def table(
    results: Annotated[Path, typer.Argument(exists=True, help="results.csv of 'pondhop bench run'.")],
    best_known: BestKnownFile = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="File for the table; else stdout.")] = None,
    as_json: Json = False,
) -> None:
    """Make the table of finished runs, of a benchmark under way too.

    - `pondhop bench table bench/results.csv`
    - `pondhop bench table bench/results.csv --best-known best_known.json -o bench/results.md`
    """
    from pondhop.bench.results import read_results
    from pondhop.bench.summary import Comparison, markdown
    from pondhop.documents.atomic import write_all

    faults: list[Fault] = []
    best_known_files = [best_known] if best_known is not None else []
    known = _best_known(best_known_files, faults)
    with _collecting(faults):
        runs = read_results(results)
    if faults:
        raise InvalidInput(faults)
    comparison = Comparison(runs, known)
    page = markdown(comparison, _name(best_known_files))
    if output is not None:
        write_all({output: page})
    if as_json:
        typer.echo(json.dumps(_rows(comparison), indent=1))
    elif output is None:
        typer.echo(page, nl=False)


@bench.command(no_args_is_help=True)
def paper(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the report, its data and its pictures.")],
    quick: Annotated[
        bool, typer.Option("--quick", help="10 farms of each size instead of 100: minutes instead of hours.")
    ] = False,
    budget: Annotated[
        float | None,
        typer.Option(
            min=0,
            metavar="SECONDS",
            help="What a planner may take for all farms of a size, else it plans fewer: 400, with --quick 25.",
        ),
    ] = None,
    planner: Annotated[
        list[str] | None, typer.Option(metavar="MODULE:FUNCTION", help="A planner of your own to compare, too.")
    ] = None,
    best_known: BestKnownFile = None,
    jobs: Annotated[int, typer.Option(min=1, help="Runs at once; more than idle cores falsifies the times.")] = 1,
    as_json: Json = False,
) -> None:
    """Compare all planners as the paper does: its tables and figures from new measurements, as one page to send.

    - `pondhop bench paper -o report`
    - `pondhop bench paper -o report --budget 60 --jobs 2`
    - `pondhop bench paper -o report --best-known best.json`
    - `pondhop bench paper -o report --quick --planner my_module:my_planner`

    Writes report.html, which needs no other file, report.md, and the data as CSV files. Baselines that are not
    installed are left out, and the report says so. What is measured already is not run again, as long as the code
    that plans is the same: the same command goes on where it was stopped.
    """
    from pondhop.report import scope as scopes
    from pondhop.report.methods import METHODS, installed, own_methods
    from pondhop.report.page import require_packages, write_report
    from pondhop.report.study import Study, execute_study, seconds_missing
    from pondhop.report.tables import Tables

    scope = scopes.QUICK if quick else scopes.FULL
    if budget is not None:
        scope = scope.with_budget(budget)
    if best_known is not None:
        scope = scope.with_best_known(best_known)
    faults: list[Fault] = []
    known = _best_known([best_known] if best_known is not None else [], faults)
    own = []
    with _collecting(faults):
        require_packages()
    with _collecting(faults), _modules_of_this_folder():
        own += own_methods(planner or (), max(scope.num_ponds))
    if faults:
        raise InvalidInput(faults)
    methods, left_out = installed(METHODS)
    study = Study(scope, [*methods, *own], left_out)
    seconds = seconds_missing(study, output)
    with _broken_pipes_as_errors(), _modules_of_this_folder(), progress("Measuring", total=seconds) as advance:
        measurements, num_new = execute_study(
            study, output, num_jobs=jobs, advance=lambda seconds: advance(size=seconds)
        )
    files = write_report(Tables(measurements, known), output)
    if as_json:
        left = [asdict(method) for method in left_out]
        answer = {"num_new_runs": num_new, "left_out": left, "files": list(map(str, files))}
        typer.echo(json.dumps(answer, indent=1))
    else:
        for method in left_out:
            typer.echo(f"Left out: {method.label}: {method.reason} ({method.action})", err=True)
        typer.echo(f"Written to {output}: {files[0].name} and {len(files) - 1} other files; {num_new} new runs")


@contextmanager
def _modules_of_this_folder() -> Iterator[None]:
    """Find the user's modules in the current folder, as `python -m` does."""
    folder = str(Path.cwd())
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path.remove(folder)


@contextmanager
def _broken_pipes_as_errors() -> Iterator[None]:
    """Let a write to a process that has died fail, where elsewhere a reader of ours that leaves ends the command."""
    if not hasattr(signal, "SIGPIPE"):
        yield
        return
    before = signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGPIPE, before)


def _rows(comparison: Comparison) -> dict[str, object]:
    return {
        "overall": [asdict(row) for row in comparison.overall()],
        "sets": [asdict(row) for row in comparison.sets()],
    }


def _best_known(paths: list[Path], faults: list[Fault]) -> BestKnown:
    """Read the best plans known of all files."""
    from pondhop.bench.best_known import BestKnown, read_best_known

    plans: list[BestPlan] = []
    for path in paths:
        with _collecting(faults):
            plans += read_best_known(path).plans
    return BestKnown(plans)


def _name(paths: list[Path]) -> str:
    return " and ".join(dict.fromkeys(path.name for path in paths))


def _time_limits(seconds: str | None, seconds_per_node: str | None, faults: list[Fault]) -> list[TimeLimit]:
    from pondhop.bench.measure import TimeLimit

    limits = [TimeLimit(value) for value in _numbers("--time-limits", seconds, float, 0, faults)]
    per_node = _numbers("--seconds-per-node", seconds_per_node, float, 0, faults)
    limits += [TimeLimit(value, is_per_node=True) for value in per_node]
    return limits or [TimeLimit()]


def _numbers(
    option: str, text: str | None, kind: Callable[[str], _Number], minimum: int, faults: list[Fault]
) -> list[_Number]:
    """Return the numbers of a list; whole ones from the minimum up, others above it."""
    numbers: list[_Number] = []
    for part in text.split(",") if text is not None else ():
        try:
            number = kind(part)
        except ValueError:
            number = None
        is_low = number is None or number < minimum or (kind is float and number == minimum)
        if number is None or is_low or not math.isfinite(number):
            wanted = f"numbers above {minimum}" if kind is float else f"whole numbers from {minimum} up"
            faults.append(
                Fault(option, f"{part.strip()!r} is not one of its numbers", f"give {wanted}, with commas between")
            )
        elif number in numbers:
            faults.append(Fault(option, f"{part.strip()} is there twice", "give each number once"))
        else:
            numbers.append(number)
    return numbers


@contextmanager
def _collecting(faults: list[Fault]) -> Iterator[None]:
    """Add what is wrong to the faults, so that all of them are told at once."""
    try:
        yield
    except InvalidInput as error:
        faults += error.faults


def _print_comparison(comparison: Comparison) -> None:
    """Print the averages of a benchmark, a row a set and planner."""
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, header_style="bold")
    for heading in ("Set", "Routes", "Planner", "Limit"):
        table.add_column(heading)
    for heading in ("Longest", "Gap", "Worst", "Seconds"):
        table.add_column(heading, justify="right")
    for row in comparison.sets():
        name = (row.set_name, str(row.num_routes), row.planner, row.time_limit)
        gaps = map(_percent, (row.gap_percent, row.worst_gap_percent))
        table.add_row(*name, f"{row.max_route_length:.6g}", *gaps, f"{row.elapsed_s:.3g}")
    console = Console(highlight=False)
    console.print(table)
    num_broken = sum(run.num_violations > 0 for run in comparison.runs)
    if num_broken:
        console.print(f"{num_broken} of {len(comparison.runs)} plans break a rule", style="bold red")


def _percent(value: float | None) -> str:
    return "unknown" if value is None else f"{value:.2f} %"
