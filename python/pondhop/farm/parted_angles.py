"""Degrees, minutes and seconds in columns of their own, joined to one column that is read like any other angle."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Literal

from pondhop.farm.columns import AXES, axis_of
from pondhop.farm.degrees import Axis, plain_number
from pondhop.farm.features import Notes, normal_name
from pondhop.farm.vocabulary import column_words

Part = Literal["degrees", "minutes", "seconds"]

_PARTS: dict[Part, frozenset[str]] = {
    "degrees": frozenset(map(normal_name, column_words("degrees_of_angle"))),
    "minutes": frozenset(map(normal_name, column_words("minutes_of_angle"))),
    "seconds": frozenset(map(normal_name, column_words("seconds_of_angle"))),
}
_MARKS = (("''", " seconds"), ('"', " seconds"), ("\u2033", " seconds"), ("'", " minutes"), ("\u2032", " minutes"))
"""Marks that stand for a part in a heading, the longer ones first."""

_MARK = re.compile(r"\s*(?:[°º'\u2032\"\u2033]|'')$")

Row = tuple[int, list[str]]
"""The number of a line and its cells."""


def join_parted_angles(rows: Sequence[Row], max_title_lines: int, notes: Notes) -> Sequence[Row]:
    """The lines of a table, minutes and seconds beside the degrees of their coordinate put into its cell.

    Parameters
    ----------
    rows
        The lines.
    max_title_lines
        How many lines may stand above the headings.
    notes
        Get a note where columns were joined.

    Returns
    -------
    sequence of (int, list of str)
        The same lines; where both coordinates come in parts, without the columns of minutes and seconds.
    """
    for top, (_, header) in enumerate(rows[: max_title_lines + 1]):
        groups = _groups(header)
        if groups is not None and _hold_parts([row for _, row in rows[top + 1 :]], groups):
            told = "; ".join(" ".join(header[index].strip() for index in group) for group in groups)
            notes.add(f"Coordinates were read as degrees, minutes and seconds in columns of their own: {told}.")
            return [*rows[:top], *_joined_rows(rows[top:], groups)]
    return rows


def _joined_rows(rows: Sequence[Row], groups: Sequence[Sequence[int]]) -> list[Row]:
    (top, header), below = rows[0], rows[1:]
    absorbed = {index for group in groups for index in group[1:]}
    by_degrees = {group[0]: group for group in groups}
    called = {
        group[0]: axis
        for group, axis in zip(groups, AXES, strict=True)
        if axis_of(normal_name(header[group[0]])) is None
    }
    joined = [(top, [called.get(index, name) for index, name in enumerate(header) if index not in absorbed])]
    for number, row in below:
        # A line that is too long keeps its last cells, which are a fault later.
        cells = [*row, *[""] * (len(header) - len(row))]
        kept = [
            _joined([cells[part] for part in by_degrees[index]]) if index in by_degrees else cell
            for index, cell in enumerate(cells)
            if index not in absorbed
        ]
        joined.append((number, kept))
    return joined


def _hold_parts(rows: Sequence[Sequence[str]], groups: Sequence[Sequence[int]]) -> bool:
    """Whether most degrees are whole and most minutes numbers: a typing error in one line is a fault later.

    Decimal degrees beside which the same angle stands once more in parts are no parts.
    """
    for degrees, minutes, *_ in groups:
        numbers = [(_number(row[degrees]), _number(row[minutes])) for row in rows if len(row) > max(degrees, minutes)]
        num_parted = sum(
            whole is not None and whole.is_integer() and part is not None and part >= 0.0 for whole, part in numbers
        )
        if 2 * num_parted <= len(numbers):
            return False
    return True


def _groups(header: Sequence[str]) -> list[list[int]] | None:
    """The columns of degrees, minutes and perhaps seconds of both coordinates; ``None`` where one is not in parts."""
    found: dict[Axis, dict[Part, int]] = {"lon": {}, "lat": {}}
    last: Axis | None = None
    for index, name in enumerate(header):
        axis, part = _meaning(name)
        # Minutes without a word of their own belong to the coordinate right before them.
        axis = axis or last
        last = None
        if axis is not None and part is not None and part not in found[axis]:
            found[axis][part] = index
            last = axis
    if not all({"degrees", "minutes"} <= parts.keys() for parts in found.values()):
        return None
    order: tuple[Part, ...] = ("degrees", "minutes", "seconds")
    return [[parts[part] for part in order if part in parts] for parts in found.values()]


def _meaning(name: str) -> tuple[Axis | None, Part | None]:
    """The coordinate and the part that a heading names: ``lat_min``, ``Longitude Sec``, ``Lat '``, ``min``."""
    text = name
    for mark, word in _MARKS:
        text = text.replace(mark, word)
    plain = normal_name(text)
    whole = axis_of(plain)
    if whole is not None:
        return whole, "degrees"
    for part, words in _PARTS.items():
        if plain in words:
            return None, part
        for word in words:
            for rest in (plain.removesuffix(word), plain.removeprefix(word)):
                if rest != plain and (axis := axis_of(rest)) is not None:
                    return axis, part
    return None, None


def _joined(parts: Sequence[str]) -> str:
    """One cell of several: ``10 6 1.4``. Cells without minutes and seconds stay what they are."""
    shown = [_plain(part) for part in parts]
    while len(shown) > 1 and not shown[-1]:
        shown.pop()
    if len(shown) == 1 or not shown[0]:
        return parts[0]
    return " ".join(part or "0" for part in shown)


def _number(cell: str) -> float | None:
    """The number of a cell, with or without the mark of its part: ``10``, ``10°``."""
    return plain_number(_MARK.sub("", cell.strip()))


def _plain(cell: str) -> str:
    """A number without the ``.0`` that spreadsheets add; else the cell itself."""
    number = _number(cell)
    return cell.strip() if number is None else f"{'-' if math.copysign(1.0, number) < 0.0 else ''}{abs(number):.12g}"
