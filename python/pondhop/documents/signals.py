"""Signals that ask a program to stop: answered at once, held back where a step must not be torn, told apart."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from types import FrameType

STOPPING_SIGNALS = tuple(
    number for name in ("SIGINT", "SIGTERM", "SIGHUP") if (number := getattr(signal, name, None)) is not None
)
"""What stops a program: Ctrl-C, `kill` and the end of a session, a terminal that is closed."""

SIGNALLED = 128
"""A program that a signal stopped ends with this and the signal's number.

130 for Ctrl-C, 143 for a request to end, 129 for a terminal that was closed.
"""

_STDERR = 2


class Stopped(KeyboardInterrupt):
    """The program was asked to stop; whatever heeds Ctrl-C heeds every such signal."""


class StopSignals:
    """Which signal asked the program to stop, if any did.

    Attributes
    ----------
    last
        Number of the signal; Ctrl-C, until another comes.
    is_told
        Whether the user has read that the program was stopped.
    """

    def __init__(self) -> None:
        self.last: int = signal.SIGINT
        self.is_told = False

    @property
    def text(self) -> str:
        """What stopped the program, in words."""
        return _stopped_text(self.last)

    @contextmanager
    def raised(self) -> Iterator[None]:
        """Raise `Stopped` for each of `STOPPING_SIGNALS`, unless it is ignored, as under `nohup`."""
        self.last, self.is_told = signal.SIGINT, False
        with ExitStack() as handlers:
            for number in _heeded():
                handlers.callback(signal.signal, number, signal.signal(number, self.stop))
            yield

    def stop(self, number: int, _frame: FrameType | None = None) -> None:
        """Take note of a signal and raise `Stopped`."""
        self.last = number
        raise Stopped


STOPS = StopSignals()
"""Signals are those of the process, so there is one."""


def answer_signals_at_once() -> None:
    """Let each of `STOPPING_SIGNALS` end the program with a line, as long as there is nothing to put right.

    An exception would not do while modules are imported: some libraries swallow it, and Python prints it as a fault.
    """
    for number in _heeded():
        signal.signal(number, _end)


@contextmanager
def signals_held_back() -> Iterator[None]:
    """Let no signal tear what is done within: those that come are delivered at the end.

    Only the main thread hears signals in Python, so there is nothing to do in others.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    held: list[int] = []
    # Every handler is put back, whatever those that are already back do about a signal that comes meanwhile.
    with ExitStack() as handlers:
        handlers.callback(_deliver, held)
        for number in _heeded():
            handlers.callback(signal.signal, number, signal.signal(number, lambda number, _frame: held.append(number)))
        yield


def _heeded() -> list[int]:
    """The stopping signals that are not ignored; a handler that was not set from Python cannot be put back."""
    return [number for number in STOPPING_SIGNALS if signal.getsignal(number) not in (None, signal.SIG_IGN)]


def _deliver(numbers: list[int]) -> None:
    # One that stops the program raises, and the user need not stop it twice; one that a program of the user's heeds in
    # another way, as by reading its settings again, must not swallow those after it.
    for number in dict.fromkeys(numbers):
        signal.raise_signal(number)


def _stopped_text(number: int) -> str:
    return "stopped with Ctrl-C" if number == signal.SIGINT else f"stopped by {signal.Signals(number).name}"


def _end(number: int, _frame: FrameType | None) -> None:
    os.write(_STDERR, f"pondhop: {_stopped_text(number)}\n".encode())
    os._exit(SIGNALLED + number)
