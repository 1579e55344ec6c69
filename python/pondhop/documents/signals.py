"""Signals that ask a program to stop: held back where a step must not be torn, and told apart afterwards."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

STOPPING_SIGNALS = tuple(
    number for name in ("SIGINT", "SIGTERM", "SIGHUP") if (number := getattr(signal, name, None)) is not None
)
"""What stops a program: Ctrl-C, `kill` and the end of a session, a terminal that is closed."""


class Stopped(KeyboardInterrupt):
    """The program was asked to stop by another signal than Ctrl-C; whatever heeds Ctrl-C heeds it, too."""


class StopSignals:
    """Which signal asked the program to stop, if any did.

    Attributes
    ----------
    last
        Number of the signal; Ctrl-C, until another comes.
    """

    def __init__(self) -> None:
        self.last: int = signal.SIGINT

    @contextmanager
    def raised(self) -> Iterator[None]:
        """Raise `Stopped` for each of `STOPPING_SIGNALS` but Ctrl-C, unless it is ignored, as under `nohup`."""
        before = {}
        for number in STOPPING_SIGNALS:
            if number != signal.SIGINT and signal.getsignal(number) != signal.SIG_IGN:
                before[number] = signal.signal(number, self._stop)
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def _stop(self, number: int, _frame: FrameType | None) -> None:
        self.last = number
        raise Stopped


@contextmanager
def signals_held_back() -> Iterator[None]:
    """Let no signal tear what is done within: those that come are delivered at the end.

    Only the main thread hears signals in Python, so there is nothing to do in others.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    held: list[int] = []
    before = {}
    try:
        for number in STOPPING_SIGNALS:
            # A handler that was not set from Python cannot be put back.
            if signal.getsignal(number) not in (None, signal.SIG_IGN):
                before[number] = signal.signal(number, lambda number, _frame: held.append(number))
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in held:
            signal.raise_signal(number)
