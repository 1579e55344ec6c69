"""Clock times of a round: "22:00" of the evening, "05:30" of the morning after."""

from __future__ import annotations

import re

from pondhop.arguments import shown
from pondhop.errors import Fault, InvalidInput

DAY_S = 86_400.0

_CLOCK = re.compile(r"([01]?[0-9]|2[0-3]):([0-5][0-9])(?::([0-5][0-9]))?")

_ACTION = 'give hours and minutes of the day, as "22:00"'


def clock_faults(name: str, value: object) -> list[Fault]:
    """Return what is wrong with a clock time; nothing with what `seconds_of_day` understands."""
    if isinstance(value, str) and _CLOCK.fullmatch(value.strip()):
        return []
    return [Fault(name, f"{shown(value)} is no time of the day", _ACTION)]


def seconds_of_day(clock: str) -> float:
    """Return the seconds since midnight of a clock time.

    Raises
    ------
    InvalidInput
        If it is none.
    """
    match = _CLOCK.fullmatch(clock.strip())
    if match is None:
        raise InvalidInput(clock_faults("clock", clock))
    hours, minutes, seconds = (int(part or 0) for part in match.groups())
    return 3600.0 * hours + 60.0 * minutes + seconds


def seconds_between(start: str, end: str) -> float:
    """Return how long it is from one clock time to the next occurrence of another: a whole day if they are the same."""
    return (seconds_of_day(end) - seconds_of_day(start)) % DAY_S or DAY_S


def clock_after(start: str, seconds: float) -> str:
    """Return what a clock shows some seconds after a clock time, to the second."""
    total = round(seconds_of_day(start) + seconds) % int(DAY_S)
    return f"{total // 3600:02}:{total // 60 % 60:02}:{total % 60:02}"


def windows_after(start: str, windows: tuple[tuple[str, str], ...]) -> list[tuple[float, float]]:
    """Return windows of the day as seconds after a clock time, those of one day long.

    A window that is open at that time begins at once, and again a day later less what has passed of it.
    """
    found = []
    for earliest, latest in windows:
        begin_s = (seconds_of_day(earliest) - seconds_of_day(start)) % DAY_S
        end_s = begin_s + (seconds_of_day(latest) - seconds_of_day(earliest)) % DAY_S
        if end_s > DAY_S:
            found.append((0.0, end_s - DAY_S))
        found.append((begin_s, min(end_s, DAY_S)))
    return sorted(found)
