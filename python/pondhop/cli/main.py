"""The command line: ``pondhop COMMAND --help`` teaches each command.

Exit codes stand in its help, those of signals in `pondhop.documents.signals`.
Results go to stdout, everything else to stderr. Heavy packages are imported where they are used, because
``pondhop plan`` should take no longer than planning does.
"""

from __future__ import annotations

import io
import shlex
import signal
import sys
from typing import Annotated, NoReturn

import typer

from pondhop.cli.bench import bench
from pondhop.cli.plan import generate_farm, plan
from pondhop.cli.research import evaluate, generate, plot, solve
from pondhop.cli.shared import EXIT_BUG, EXIT_INTERRUPTED, EXIT_INVALID_INPUT, print_faults
from pondhop.cli.size import size
from pondhop.cli.train import train_am
from pondhop.documents.signals import SIGNALLED, STOPS
from pondhop.errors import Fault, InvalidInput

app = typer.Typer(
    name="pondhop",
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    add_completion=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(bench, name="bench")


def main() -> None:
    """Run the command line and answer what goes wrong in words a user can act on."""
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    # A terminal or a file that cannot show a letter gets a mark for it, not a bug.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    arguments = sys.argv[1:]
    try:
        with STOPS.raised():
            _check_none_is_empty(arguments)
            app(arguments, prog_name="pondhop")
    except SystemExit as ended:
        if ended.code == EXIT_INTERRUPTED:
            _exit_stopped()
        raise SystemExit(ended.code) from None
    except KeyboardInterrupt:
        _exit_stopped()
    except InvalidInput as error:
        _print_invalid_input(error.faults, "--json" in arguments)
        sys.exit(EXIT_INVALID_INPUT)
    except OSError as error:
        place = str(error.filename) if error.filename is not None else "the output"
        fault = Fault(place, error.strerror or str(error), "check the path, its permissions and the space on the disk")
        _print_invalid_input((fault,), "--json" in arguments)
        sys.exit(EXIT_INVALID_INPUT)
    except MemoryError:
        fault = Fault("the input", "it needs more memory than there is", "plan fewer ponds or farms at once")
        _print_invalid_input((fault,), "--json" in arguments)
        sys.exit(EXIT_INVALID_INPUT)
    except Exception as error:  # noqa: BLE001 - the last resort: a user never sees a traceback unasked
        _exit_with_bug(error, arguments)


def _check_none_is_empty(arguments: list[str]) -> None:
    """Refuse empty arguments, as of shell variables that are not set: an empty path would be the current folder."""
    faults = [
        Fault(f"after {before}", "there is an empty argument", "give a value; is a variable of the shell empty?")
        for before, argument in zip(["pondhop", *arguments], arguments, strict=False)
        if not argument.strip()
    ]
    if faults:
        raise InvalidInput(faults)


def _print_version(is_wanted: bool) -> None:
    if is_wanted:
        from pondhop import __version__

        typer.echo(f"pondhop {__version__}")
        raise typer.Exit


@app.callback()
def _pondhop(
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of a bug.")] = False,
    version: Annotated[
        bool, typer.Option("--version", help="Show the version.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    """Balanced routes and checked missions for drone fleets that sample aquaculture ponds.

    Start with a farm of your own, or with one that pondhop makes up:

    - `pondhop generate-farm --ponds 120 --at -90.9,33.4 -o farm.geojson`
    - `pondhop plan farm.geojson --drones 5 -o tonight`

    Exit codes: 0 done, 2 invalid input, 3 a plan that cannot be flown (or, with `--require-feasible`, breaks a rule),
    1 a bug, 130 stopped with Ctrl-C, 143 asked to end, 129 its terminal was closed.
    """


for _command in (plan, size, solve, evaluate, plot, generate, generate_farm, train_am):
    app.command(no_args_is_help=True)(_command)


def _print_invalid_input(faults: tuple[Fault, ...], as_json: bool) -> None:
    heading = f"pondhop: {len(faults)} {'problem' if len(faults) == 1 else 'problems'} in the input"
    print_faults(faults, "invalid_input", heading, as_json)


def _exit_stopped() -> NoReturn:
    if not STOPS.is_told:
        typer.echo(f"pondhop: {STOPS.text}", err=True)
    sys.exit(SIGNALLED + STOPS.last)


def _exit_with_bug(error: Exception, arguments: list[str]) -> NoReturn:
    if "--debug" in arguments:
        raise error
    typer.echo(
        f"pondhop: this is a bug in pondhop, not in your input: {type(error).__name__}: {error}\n"
        f"Please report it with your file and what this prints: pondhop --debug {shlex.join(arguments)}",
        err=True,
    )
    sys.exit(EXIT_BUG)
