"""What a farm file says of sampling a pond: how long, when, and how important it is."""

from __future__ import annotations

import re
from dataclasses import dataclass

from pondhop.errors import Fault
from pondhop.farm.degrees import number_given
from pondhop.farm.features import Feature, Source, shortened
from pondhop.fleet.clock import clock_faults

_DASH = re.compile("[-\N{EN DASH}\N{EM DASH}]")
"""Between two clock times, as spreadsheets and telephones write it."""

MAX_SERVICE_S = 86_400.0
MAX_PRIORITY = 1_000.0


@dataclass(frozen=True)
class Task:
    """Sampling a pond.

    Attributes
    ----------
    service_s
        Seconds on station; `None`: those of the fleet.
    time_windows
        Pairs of clock times between which it may begin.
    priority
        What it is worth beside others.
    """

    service_s: float | None = None
    time_windows: tuple[tuple[str, str], ...] = ()
    priority: float = 1.0


def read_task(feature: Feature, source: Source) -> Task:
    """Return what the properties of a pond say; faults go to the source."""
    return Task(_service_s(feature, source), _time_windows(feature, source), _priority(feature, source))


def _service_s(feature: Feature, source: Source) -> float | None:
    found = feature.find("service_s")
    if found is None:
        return None
    number = number_given(found[1])
    if number is None or not 0.0 <= number <= MAX_SERVICE_S:
        place = feature.property_place.format(found[0])
        message = f"{shortened(str(found[1]))!r} is no time on station"
        source.faults.append(Fault(place, message, f"give seconds as a number, 0 to {MAX_SERVICE_S:.0f}"))
    return number


def _priority(feature: Feature, source: Source) -> float:
    found = feature.find("priority")
    if found is None:
        return 1.0
    number = number_given(found[1])
    if number is None or not 0.0 < number <= MAX_PRIORITY:
        place = feature.property_place.format(found[0])
        action = f"give a number above 0, at most {MAX_PRIORITY:g}; ponds without one have 1"
        source.faults.append(Fault(place, f"{shortened(str(found[1]))!r} is no priority", action))
        return 1.0
    return number


def _time_windows(feature: Feature, source: Source) -> tuple[tuple[str, str], ...]:
    """Windows as lists of pairs, as one pair, or as text: ``22:30-23:30, 04:00-05:30``."""
    found = feature.find("time_windows", "time_window")
    if found is None:
        return ()
    key, value = found
    pairs = _pairs(value)
    place = feature.property_place.format(key)
    if pairs is None:
        action = 'give pairs of clock times, as [["22:30", "23:30"]], or text: 22:30-23:30, 04:00-05:30'
        source.faults.append(Fault(place, f"{shortened(str(value))!r} is no list of time windows", action))
        return ()
    faults = [fault for pair in pairs for clock in pair for fault in clock_faults(place, clock)]
    source.faults.extend(faults)
    return () if faults else tuple(pairs)


def _pairs(value: object) -> list[tuple[str, str]] | None:
    if isinstance(value, list) and not value:
        return []
    if isinstance(value, list) and all(isinstance(part, str) and _DASH.search(part) for part in value):
        value = ",".join(value)
    if isinstance(value, str):
        value = _DASH.sub("-", value)
        value = [[clock.strip() for clock in part.split("-")] for part in value.replace(";", ",").split(",")]
    if isinstance(value, list) and len(value) == 2 and all(isinstance(clock, str) for clock in value):
        value = [value]
    if not isinstance(value, list) or not value:
        return None
    if not all(isinstance(pair, list) and len(pair) == 2 for pair in value):
        return None
    return [(str(pair[0]), str(pair[1])) for pair in value]
