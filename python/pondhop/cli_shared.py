"""What the commands share: options, and the progress bar."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Timer
from typing import Annotated

import typer

SECONDS_BEFORE_PROGRESS = 2.0

Json = Annotated[bool, typer.Option("--json", help="Results on stdout and faults on stderr as JSON, for programs.")]


@contextmanager
def progress(description: str, total: int) -> Iterator[Callable[[], None]]:
    """Show a progress bar on stderr once something has taken two seconds; yield what advances it by one."""
    if not sys.stderr.isatty():
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import Progress

    bar = Progress(console=Console(stderr=True), transient=True)
    task = bar.add_task(description, total=total)
    start = Timer(SECONDS_BEFORE_PROGRESS, bar.start)
    start.start()
    try:
        yield lambda: bar.advance(task)
    finally:
        start.cancel()
        start.join()
        bar.stop()
