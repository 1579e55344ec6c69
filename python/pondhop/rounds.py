"""Research instances with windows, loads, releases and trips: files in the formats of Solomon and of VRPLIB."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, get_args

from pondhop import _core
from pondhop._core import Round
from pondhop.arguments import Arguments, checked_path, shortened
from pondhop.errors import Fault, InvalidInput
from pondhop.instances import read_text

Rounding = Literal["exact", "dimacs"]
"""What a leg of length d counts: d itself, or d without all but its first decimal, as the DIMACS challenge has it."""

SUFFIXES = (".txt", ".vrp")
"""Endings of files that hold a round."""

_SECTIONS = {
    "NODE_COORD_SECTION": 3,
    "DEMAND_SECTION": 2,
    "TIME_WINDOW_SECTION": 3,
    "SERVICE_TIME_SECTION": 2,
    "RELEASE_TIME_SECTION": 2,
    "VEHICLES_RELOAD_DEPOT_SECTION": 2,
    "DEPOT_SECTION": 1,
}
"""Sections of VRPLIB that are understood, with how many numbers a line of each has."""

_SOLOMON_COLUMNS = 7


@dataclass(frozen=True)
class RoundFile:
    """What a file says.

    Attributes
    ----------
    round
        What is to be flown; customers count from 0 in the order of the file.
    has_trips
        Whether its drones may fly several trips.
    """

    round: Round
    has_trips: bool


@dataclass
class _Table:
    """The numbers of a file: the depot in the first row, then the customers."""

    positions: list[tuple[float, float]] = field(default_factory=list)
    loads: list[float] = field(default_factory=list)
    windows: list[tuple[float, float]] = field(default_factory=list)
    services: list[float] = field(default_factory=list)
    releases: list[float] = field(default_factory=list)
    num_drones: int | None = None
    capacity: float = math.inf
    max_trip_duration: float = math.inf
    has_trips: bool = False


def is_round_file(path: Path) -> bool:
    """Whether a file is one of those that `read_round` reads, by its ending."""
    return path.suffix.lower() in SUFFIXES


def read_round(path: str | Path, *, rounding: Rounding = "exact", num_drones: int | None = None) -> RoundFile:
    """Read a round: VRPLIB if the name ends in ``.vrp``, else the format of Solomon.

    Of VRPLIB: ``TYPE`` CVRP, VRPTW and MTVRPTWR with planar nodes; ``DISTANCE`` limits legs and services of a trip.

    Parameters
    ----------
    path
        The file.
    rounding
        What a leg counts.
    num_drones
        Takes the place of the number in the file.

    Raises
    ------
    InvalidInput
        With every fault of the file, each with its line.

    References
    ----------
    Solomon. Algorithms for the Vehicle Routing and Scheduling Problems with Time Window Constraints. Operations
    Research 1987. Uchoa and others. New benchmark instances for the CVRP. EJOR 2017 (VRPLIB).
    """
    arguments = Arguments()
    arguments.one_of("rounding", rounding, get_args(Rounding))
    if num_drones is not None:
        arguments.whole("num_drones", num_drones, 1, 2**32, "give at least one drone")
    arguments.check()
    file = checked_path("path", path)
    text, faults = read_text(file), list[Fault]()
    table = _read_vrplib(text, faults) if file.suffix.lower() == ".vrp" else _read_solomon(text, faults)
    if len(table.positions) < 2 and not faults:
        faults.append(Fault(str(file), f"there are {len(table.positions)} places", "give a depot and a customer"))
    if faults:
        raise InvalidInput(faults)
    return RoundFile(_to_round(table, rounding, num_drones), table.has_trips)


def _to_round(table: _Table, rounding: Rounding, num_drones: int | None) -> Round:
    first, *rest = table.positions
    problem = _core.Problem(
        first,
        rest,
        num_drones or table.num_drones or len(rest),
        service_durations_s=table.services[1:] or None,
        max_duration_s=table.max_trip_duration,
    )
    return _core.Round(
        problem,
        loads=table.loads[1:] or None,
        releases_s=table.releases[1:] or None,
        windows=[[window] for window in table.windows[1:]] if table.windows else None,
        capacity=table.capacity,
        shift_s=table.windows[0] if table.windows else (0.0, math.inf),
        turnaround_s=0.0 if table.has_trips else None,
        rounding=rounding,
    )


def _numbers(words: Sequence[str]) -> list[float] | None:
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        return None
    return numbers if all(map(math.isfinite, numbers)) else None


def _read_solomon(text: str, faults: list[Fault]) -> _Table:
    """Read ``VEHICLE`` with number and capacity, then ``CUSTOMER`` with seven numbers a line, the depot first."""
    table, part = _Table(), ""
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        if not words:
            continue
        if words[0].upper() in {"VEHICLE", "CUSTOMER"}:
            part = words[0].upper()
            continue
        numbers = _numbers(words)
        if numbers is None:
            # Headings, and the name of the instance in the first line.
            if part and words[0][0].isdigit():
                faults.append(
                    Fault(f"line {number}", f"{shortened(line.strip())!r} is no row of numbers", "correct it")
                )
            continue
        if part == "VEHICLE" and len(numbers) == 2 and numbers[0] >= 1:
            table.num_drones, table.capacity = int(numbers[0]), numbers[1]
        elif part == "CUSTOMER" and len(numbers) == _SOLOMON_COLUMNS:
            _, x, y, load, earliest, latest, service = numbers
            table.positions.append((x, y))
            table.loads.append(load)
            table.windows.append((earliest, latest))
            table.services.append(service)
        else:
            message = f"{shortened(line.strip())!r} is no row of Solomon's format"
            action = "give number and capacity of the vehicles, then 7 numbers for each customer, the depot first"
            faults.append(Fault(f"line {number}", message, action))
    if not table.positions and not faults:
        faults.append(Fault("file", "there is no CUSTOMER section", "give a file in the format of Solomon"))
    return table


def _read_vrplib(text: str, faults: list[Fault]) -> _Table:
    header: dict[str, tuple[str, str]] = {}
    rows: dict[str, dict[int, tuple[str, list[float]]]] = {name: {} for name in _SECTIONS}
    section: str | None = None
    for number, line in enumerate(text.splitlines(), start=1):
        place, words = f"line {number}", line.split()
        if not words or words == ["-1"]:
            continue
        if words == ["EOF"]:
            break
        keyword, colon, value = line.partition(":")
        if words[0].rstrip(":").endswith("_SECTION"):
            section = words[0].rstrip(":")
            if section not in _SECTIONS:
                faults.append(Fault(place, f"{section} is not supported", "give a file without it"))
        elif colon:
            header[keyword.strip().upper()] = (place, value.strip())
        elif section in _SECTIONS:
            numbers = _numbers(words)
            if numbers is None or len(numbers) != _SECTIONS[section] or not numbers[0].is_integer():
                message = f"{shortened(line.strip())!r} is no row of {section}"
                faults.append(Fault(place, message, f"give {_SECTIONS[section]} numbers, the first a whole one"))
            elif int(numbers[0]) in rows[section]:
                faults.append(Fault(place, f"{section} has node {int(numbers[0])} twice", "keep one of them"))
            else:
                rows[section][int(numbers[0])] = (place, numbers[1:])
        elif section is None:
            message = f"{shortened(line.strip())!r} is no 'KEYWORD : value'"
            faults.append(Fault(place, message, "give a file in the format of VRPLIB"))
    if faults:
        return _Table()
    return _from_vrplib(header, rows, faults)


def _from_vrplib(
    header: dict[str, tuple[str, str]], rows: dict[str, dict[int, tuple[str, list[float]]]], faults: list[Fault]
) -> _Table:
    place, kind = header.get("EDGE_WEIGHT_TYPE", ("file", "missing"))
    if kind != "EUC_2D":
        faults.append(Fault(place, f"EDGE_WEIGHT_TYPE is {kind}", "give a file of planar places (EUC_2D)"))
    nodes = sorted(rows["NODE_COORD_SECTION"])
    if not nodes:
        faults.append(Fault("file", "there is no NODE_COORD_SECTION", "give the places of the depot and the customers"))
    depots = list(rows["DEPOT_SECTION"]) or nodes[:1]
    if nodes and depots != nodes[:1]:
        told = ", ".join(map(str, depots))
        faults.append(Fault("DEPOT_SECTION", f"the depots are {told}", f"give one depot, node {nodes[0]}"))
    for name in ("DEMAND_SECTION", "TIME_WINDOW_SECTION", "RELEASE_TIME_SECTION", "SERVICE_TIME_SECTION"):
        missing = [node for node in nodes if node not in rows[name]] if rows[name] else []
        if missing:
            faults.append(Fault(name, f"node {missing[0]} is missing", "give a row for every node"))

    def value(name: str) -> float | None:
        if name not in header:
            return None
        numbers = _numbers([header[name][1]])
        if numbers is None:
            faults.append(Fault(header[name][0], f"{name} is {header[name][1]!r}", "give a number"))
        return numbers[0] if numbers else None

    capacity, distance, service, vehicles = map(value, ("CAPACITY", "DISTANCE", "SERVICE_TIME", "VEHICLES"))
    if faults:
        return _Table()

    def column(name: str) -> list[float]:
        return [rows[name][node][1][0] for node in nodes] if rows[name] else []

    services = column("SERVICE_TIME_SECTION") or ([0.0, *[service] * (len(nodes) - 1)] if service else [])
    return _Table(
        positions=[(numbers[0], numbers[1]) for _, numbers in (rows["NODE_COORD_SECTION"][node] for node in nodes)],
        loads=column("DEMAND_SECTION"),
        windows=[(pair[0], pair[1]) for _, pair in (rows["TIME_WINDOW_SECTION"][node] for node in nodes)]
        if rows["TIME_WINDOW_SECTION"]
        else [],
        services=services,
        releases=column("RELEASE_TIME_SECTION"),
        num_drones=int(vehicles) if vehicles else None,
        capacity=math.inf if capacity is None else capacity,
        max_trip_duration=math.inf if distance is None else distance,
        has_trips=bool(rows["VEHICLES_RELOAD_DEPOT_SECTION"]),
    )
