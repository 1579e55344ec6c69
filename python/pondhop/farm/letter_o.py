"""What the letter O says about a longitude: east (Ost, Oost) or west (Oeste, Ouest), by the language of a table."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from pondhop.errors import Fault
from pondhop.farm.columns import Columns
from pondhop.farm.degrees import side_written
from pondhop.farm.features import Source
from pondhop.farm.vocabulary import letter_o_words

MAX_LINES = 2_000
"""Lines that are read for words; more tell no more."""


def sign_of_o(columns: Columns, rows: Sequence[tuple[int, Sequence[str]]], word: str, source: Source) -> int:
    """The sign that O gives a longitude in a table: 1 for east, -1 for west, with a note.

    The letters of other longitudes tell first: beside W it is east, beside E it is west. Then the headings tell, and
    then the names below. Where nothing does, it is 0, and a fault asks.

    Parameters
    ----------
    columns
        Those of the table.
    rows
        The lines below the headings with their numbers.
    word
        What a line is called in messages: ``line``, ``row``.
    source
        Where fault and note go.
    """
    written = {lon for lon, _ in columns.corners}
    written |= {index for index in (columns.pair, columns.sides.get("lon")) if index is not None}
    first: str | None = f"heading {columns.names[columns.corners[0][0]]}" if columns.signs.get("lon") == 0 else None
    signs: set[int] = set()
    for number, row in rows:
        for index in written:
            cell = row[index] if index < len(row) else ""
            for part in _parts(cell) if index == columns.pair else (cell,):
                side = side_written(part)
                if side is None or side[0] != "lon":
                    continue
                signs.add(side[1])
                if side[1] == 0 and first is None:
                    first = f"{word} {number}, column {columns.names[index]}"
    if first is None:
        return -1
    texts = [cell for _, row in rows[:MAX_LINES] for index, cell in enumerate(row) if index not in written]
    for sign, because in (
        (-sum(signs) if len(signs & {-1, 1}) == 1 else 0, "the letters of other longitudes tell so"),
        (_language(columns.names), "the headings tell so"),
        (_language(texts), "the names tell so"),
    ):
        if sign:
            side_name = "east (Ost, Oost)" if sign > 0 else "west (Oeste, Ouest, Ovest)"
            source.notes.add(f"The letter O was taken as {side_name}, because {because}.")
            return sign
    message = "O is east in German and Dutch, and west in Spanish, Portuguese, French and Italian: which is it here?"
    source.faults.append(Fault(first, message, "write E or W"))
    return 0


def _parts(cell: str) -> list[str]:
    return [part.strip() for part in re.split(r"[;,]\s+|;|\s{2,}", cell.strip().strip("()[]"))]


def _language(texts: Iterable[str]) -> int:
    """1 where the words are of languages in which O is east, -1 where it is west, 0 where both or none are."""
    words = {word for text in texts for word in re.findall(r"[^\W\d_]+", text.casefold())}
    east, west = (bool(words & letter_o_words()[side]) for side in ("east", "west"))
    return int(east) - int(west)
