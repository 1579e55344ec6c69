"""What the commands share: options, and the progress bar."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Timer
from typing import Annotated, Protocol

import typer

SECONDS_BEFORE_PROGRESS = 2.0

Json = Annotated[bool, typer.Option("--json", help="Results on stdout and faults on stderr as JSON, for programs.")]


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
