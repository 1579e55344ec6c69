"""What the commands share: exit codes, options, the progress bar, and how faults are printed."""

from __future__ import annotations

import functools
import inspect
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from threading import Timer
from typing import TYPE_CHECKING, Annotated, Literal, NoReturn, Protocol, TypeVar

import typer

from pondhop.documents.signals import STOPS
from pondhop.errors import Fault, InvalidInput
from pondhop.planners import PLANNERS

if TYPE_CHECKING:
    from pondhop.places import LonLat
    from pondhop.planners import ProgressFunction

EXIT_BUG = 1
EXIT_INVALID_INPUT = 2
EXIT_INFEASIBLE = 3
EXIT_INTERRUPTED = 130

SECONDS_BEFORE_PROGRESS = 2.0

INSTALL_MATPLOTLIB = "install it with: pip install matplotlib"

Json = Annotated[bool, typer.Option("--json", help="Results on stdout and faults on stderr as JSON, for programs.")]
Seed = Annotated[int, typer.Option(min=0, help="The same seed gives the same result, on every machine.")]
UnitsOption = Annotated[
    Literal["metric", "us"],
    typer.Option("--units", help="What people read: metres and m/s, or feet, miles and mph. plan.json has metres."),
]
RequireFeasible = Annotated[bool, typer.Option("--require-feasible", help="Exit with 3 if a plan breaks a rule.")]

_PLANNING_OPTIONS: dict[str, tuple[object, object]] = {
    "planner": (
        Annotated[str, typer.Option(metavar="NAME", help=f"Which planner: {', '.join(PLANNERS)}.")],
        "auto",
    ),
    "time_limit_s": (
        Annotated[
            float | None, typer.Option("--time-limit", metavar="SECONDS", help="Wall time of planning one farm.")
        ],
        None,
    ),
    "seed": (Seed, 1),
    "threads": (Annotated[int, typer.Option(min=1, help="Threads a planner may use for one farm.")], 1),
    "iterations": (
        Annotated[
            int | None,
            typer.Option(
                min=1,
                help="Steps of the search a farm and thread, or plans to draw: reproducible, unlike a time limit.",
            ),
        ],
        None,
    ),
    "slack_percent": (
        Annotated[
            float,
            typer.Option(
                "--slack",
                min=0.0,
                metavar="PERCENT",
                help="How much longer the longest route may get to shorten the total.",
            ),
        ],
        0.0,
    ),
    "objective": (
        Annotated[
            Literal["max", "total"],
            typer.Option(help="What to minimise: the longest route (then the total), or the total."),
        ],
        "max",
    ),
    "has_separate_airspace": (
        Annotated[bool, typer.Option("--separate-airspace", help="Every drone keeps to a territory of its own.")],
        False,
    ),
    "decoding": (
        Annotated[
            Literal["greedy", "symmetries", "sampling"],
            typer.Option(
                help="How am and am-minmax plan: likeliest choices, best of its 8 symmetries, best of 128 draws.",
            ),
        ],
        "greedy",
    ),
}
"""The options of `pondhop.planners.solve` on the command line: keyword -> annotation and default."""

_Command = TypeVar("_Command", bound=Callable[..., None])


def with_planning_options(command: _Command) -> _Command:
    """Give a command the options of planning, in the place of its parameter ``**options``."""
    signature = inspect.signature(command, eval_str=True)
    parameters: list[inspect.Parameter] = []
    for parameter in signature.parameters.values():
        if parameter.kind is not inspect.Parameter.VAR_KEYWORD:
            parameters.append(parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY))
            continue
        parameters += [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
            for name, (annotation, default) in _PLANNING_OPTIONS.items()
        ]

    @functools.wraps(command)
    def run(**arguments: object) -> None:
        command(**arguments)

    run.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return run  # type: ignore[return-value]


class Advance(Protocol):
    """What advances a progress bar."""

    def __call__(self, share: float = 1.0, note: str = "", size: float = 1.0) -> None:
        """Go to the end of the current step, or to a share of it; `size` is how much of the total the step is."""


def _advance_nothing(share: float = 1.0, note: str = "", size: float = 1.0) -> None:
    """Stand in where nobody watches."""


@contextmanager
def progress(description: str, total: float) -> Iterator[Advance]:
    """Show a progress bar on stderr once something has taken two seconds; yield what advances it."""
    if not sys.stderr.isatty():
        yield _advance_nothing
        return
    from rich.console import Console
    from rich.progress import Progress

    bar = Progress(console=Console(stderr=True), transient=True)
    task = bar.add_task(description, total=total)
    start = Timer(SECONDS_BEFORE_PROGRESS, bar.start)
    done = 0.0

    def advance(share: float = 1.0, note: str = "", size: float = 1.0) -> None:
        nonlocal done
        bar.update(task, completed=done + share * size, description=f"{description} {note}".rstrip())
        done += size if share >= 1.0 else 0.0

    start.start()
    try:
        yield advance
    finally:
        start.cancel()
        start.join()
        bar.stop()


def search_progress(advance: Advance) -> ProgressFunction:
    """Show how far a search is: its best longest route, in seconds or the units of a research farm."""

    def report(max_route_cost: float, num_iterations: int, share: float) -> None:
        advance(min(share, 0.999), f"longest {max_route_cost:.4g} after {num_iterations:,} steps")

    return report


def parse_lonlat(option: str, text: str) -> LonLat:
    """Return the position that an option names as ``LON,LAT``."""
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


def has_matplotlib() -> bool:
    """Whether pictures can be drawn."""
    from importlib.util import find_spec

    return find_spec("matplotlib") is not None


def require_matplotlib() -> None:
    """Refuse to draw where matplotlib is not installed, before anything is planned."""
    if not has_matplotlib():
        raise InvalidInput([Fault("figure", "pictures need matplotlib, which is not installed", INSTALL_MATPLOTLIB)])


def print_faults(faults: Sequence[Fault], status: str, heading: str, as_json: bool) -> None:
    """Print faults on stderr, for people or for programs."""
    if as_json:
        typer.echo(json.dumps({"status": status, "faults": [asdict(fault) for fault in faults]}), err=True)
        return
    typer.echo(heading, err=True)
    for number, fault in enumerate(faults, start=1):
        typer.echo(f"{number:3}. {fault.path}: {fault.message}\n     -> {fault.action}", err=True)


def exit_stopped(message: str) -> NoReturn:
    """End a command that a signal stopped; `main` knows the exit code of the signal."""
    typer.echo(f"pondhop: {message}", err=True)
    STOPS.is_told = True
    raise typer.Exit(EXIT_INTERRUPTED)
