"""Degrees and minutes in one number, as GPS receivers write them (NMEA 0183): 10542.000 is 105 degrees 42 minutes."""

from __future__ import annotations

from collections.abc import Sequence

from pondhop.farm.columns import Columns, cell_of, parted_pair
from pondhop.farm.degrees import Axis, joined_number, parted_degrees, side_of, side_written
from pondhop.farm.features import Notes
from pondhop.places import LonLat

MAX_EXTENT_DEG = 1.0
"""Numbers that would lie further apart than this as degrees and minutes are metres of a farm."""


def are_minutes_joined(positions: Sequence[LonLat]) -> bool:
    """Whether positions that are no degrees make one farm if each number is degrees and minutes."""
    if not any(max(abs(lon), abs(lat)) > 360.0 for lon, lat in positions):
        return False
    for axis, limit_deg in ((0, 180.0), (1, 90.0)):
        degrees = [parted_degrees(position[axis]) for position in positions]
        known = [number for number in degrees if number is not None and abs(number) <= limit_deg]
        if len(known) < len(positions) or max(known) - min(known) > MAX_EXTENT_DEG:
            return False
    return True


def table_has_joined_minutes(columns: Columns, rows: Sequence[tuple[int, Sequence[str]]], notes: Notes) -> bool:
    """Whether the coordinates of a table are such numbers; only with letters of hemispheres that is sure, with a note.

    Parameters
    ----------
    columns
        Those of the table.
    rows
        The lines below the headings with their numbers.
    notes
        Get the note.
    """
    if columns.zone is not None:
        return False
    positions: list[LonLat] = []
    has_letters = False
    for _, row in rows:
        for cells in _places(row, columns):
            lon, lat = joined_number(cells["lon"]), joined_number(cells["lat"])
            if lon is not None and lat is not None:
                positions.append((lon, lat))
                has_letters |= all(_has_letter(cell, axis, row, columns) for axis, cell in cells.items())
    if not has_letters or not are_minutes_joined(positions):
        return False
    notes.add(
        "Coordinates were read as degrees and minutes in one number, as GPS receivers write them: "
        f"{joined_text(positions[0][1])}."
    )
    return True


def joined_text(number: float) -> str:
    """What such a number says, for messages: ``1006.06 is 10 degrees 6.06 minutes``."""
    degrees, minutes = divmod(abs(number), 100.0)
    return f"{number:.10g} is {degrees:.0f} degrees {minutes:.6g} minutes"


def _places(row: Sequence[str], columns: Columns) -> list[dict[Axis, str]]:
    """The cells of a line that hold longitude and latitude, a pair for each place."""
    if columns.pair is not None:
        parts = parted_pair(cell_of(row, columns.pair))
        return [{"lat": parts[0], "lon": parts[1]}] if len(parts) == 2 else []
    return [{"lon": cell_of(row, lon), "lat": cell_of(row, lat)} for lon, lat in columns.corners]


def _has_letter(cell: str, axis: Axis, row: Sequence[str], columns: Columns) -> bool:
    """Whether a letter of a hemisphere stands in a cell, beside it or in its heading."""
    beside = cell_of(row, columns.sides.get(axis))
    return side_written(cell) is not None or side_of(beside, axis) is not None or axis in columns.signs
