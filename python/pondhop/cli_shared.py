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

    def __call__(self, share: float = 1.0, note: str = "") -> None:
        """Go to the end of the current step, or to a share of it."""


def _advance_nothing(share: float = 1.0, note: str = "") -> None:
    """Stand in where nobody watches."""


@contextmanager
def progress(description: str, total: int) -> Iterator[Advance]:
    """Show a progress bar on stderr once something has taken two seconds; yield what advances it by one."""
    if not sys.stderr.isatty():
        yield _advance_nothing
        return
    from rich.console import Console
    from rich.progress import Progress

    bar = Progress(console=Console(stderr=True), transient=True)
    task = bar.add_task(description, total=total)
    start = Timer(SECONDS_BEFORE_PROGRESS, bar.start)
    num_done = 0

    def advance(share: float = 1.0, note: str = "") -> None:
        nonlocal num_done
        bar.update(task, completed=num_done + share, description=f"{description} {note}".rstrip())
        num_done += share >= 1.0

    start.start()
    try:
        yield advance
    finally:
        start.cancel()
        start.join()
        bar.stop()
