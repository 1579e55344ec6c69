"""Numbers and angles as people type them: decimal commas, degrees with minutes and seconds, letters of hemispheres."""

from __future__ import annotations

import math
import re
from typing import Literal

from pondhop.farm.features import number_of
from pondhop.farm.vocabulary import hemisphere_words

Axis = Literal["lon", "lat"]

_SIGNS = str.maketrans(
    dict.fromkeys("\u2010\u2011\u2012\u2013\u2014\u2212\uff0d", "-")
    | dict.fromkeys("\uff0b", "+")
    | dict.fromkeys("\u2018\u2019\u2032\u00b4\u0060", "'")
    | dict.fromkeys("\u201c\u201d\u2033", '"')
    | dict.fromkeys("\u00ba\u02da", "\u00b0")
    | dict.fromkeys("\u066b\uff0e", ".")
    | {"\uff0c": ","}
)
"""Signs that keyboards and word processors write for minus, plus, degree, minutes, seconds, and the point of a number.

Digits of any script are read as they are.
"""

_SIDES: dict[str, tuple[Axis, int]] = {
    "north": ("lat", 1),
    "south": ("lat", -1),
    "east": ("lon", 1),
    "west": ("lon", -1),
    "either": ("lon", 0),
}
_HEMISPHERES = {word: _SIDES[side] for side, words in hemisphere_words().items() for word in words}
"""Letters and words of each side, with the sign; that of O is 0: it is west in Spanish and French, east in German."""

_LETTERS = "|".join(sorted(map(re.escape, _HEMISPHERES), key=len, reverse=True))
_SIDE_PAIR = re.compile(rf"({_LETTERS})\.?\s*[/,;&-]?\s*({_LETTERS})\.?", re.IGNORECASE)
_PLAIN_SIGNS = {"+": 1, "1": 1, "+1": 1, "-": -1, "-1": -1}
_SIGNED = re.compile(
    rf"(?P<before>{_LETTERS})?\s*(?P<sign>[+-])?\s*"
    r"(?P<angle>\d[^A-Za-z]*?(?:d[^A-Za-z]+(?:m[^A-Za-z]*(?:s[^A-Za-z]*)?)?)?)\s*"
    rf"(?P<after>{_LETTERS})?\.?",
    re.IGNORECASE,
)
_ANGLE = re.compile(
    r"(?P<degrees>\d{1,3}(?:\.\d+)?)(?:\s*(?:[°d:]|\s|-)\s*"
    r"(?:(?P<minutes>\d{1,2}(?:\.\d+)?)\s*(?:['m:]|\s|-|$)\s*)?"
    r"(?:(?P<seconds>\d{1,2}(?:\.\d+)?)\s*(?:[\"s]|'')?)?)?\s*",
    re.IGNORECASE,
)


def plain_number(text: str) -> float | None:
    """A number with a decimal point or comma and any kind of minus; ``None`` for what is none."""
    plain = text.strip().translate(_SIGNS)
    number = number_of(plain)
    if number is None and re.fullmatch(r"[+-]?\d*,\d+", plain):
        number = number_of(plain.replace(",", "."))
    return number


def metres(text: str) -> float | None:
    """A coordinate of a projection, with or without thousands marked: ``1,116,600.5``, ``1.116.600,5``, ``576 800``."""
    plain = re.sub(r"(?<=\d)[  '](?=\d{3})", "", text.strip().translate(_SIGNS))
    plain = re.sub(r"\s*m(?:etres|eters)?$", "", plain, flags=re.IGNORECASE)
    if re.fullmatch(r"[+-]?\d{1,3}(?:,\d{3})+(?:\.\d+)?", plain):
        plain = plain.replace(",", "")
    elif re.fullmatch(r"[+-]?\d{1,3}(?:(?:\.\d{3}){2,}(?:,\d+)?|\.\d{3},\d+)", plain):
        plain = plain.replace(".", "").replace(",", ".")
    return plain_number(plain)


def parted_degrees(number: float) -> float | None:
    """Degrees of what GPS receivers write as one number: 1006.06 is 10 degrees and 6.06 minutes (NMEA 0183).

    Returns ``None`` where the minutes would be 60 or more.
    """
    degrees, minutes = divmod(abs(number), 100.0)
    return math.copysign(degrees + minutes / 60.0, number) if minutes < 60.0 else None


def parse_joined(text: str, axis: Axis, sign_of_o: int = -1) -> float | None:
    """Degrees of a cell that holds degrees and minutes as one number, with or without its letter: ``10542.000 E``."""
    number, side = joined_number(text), side_written(text)
    degrees = None if number is None else parted_degrees(number)
    if degrees is None or side is None:
        return degrees
    return (side[1] or sign_of_o) * degrees if side[0] == axis and degrees >= 0.0 else None


def joined_number(text: str) -> float | None:
    """The number of a cell, without the letter of its hemisphere."""
    match = _SIGNED.fullmatch(text.strip().translate(_SIGNS))
    return plain_number((match["sign"] or "") + match["angle"]) if match else None


def _angle(match: re.Match[str] | None) -> re.Match[str] | None:
    """Degrees, minutes and seconds of what may be an angle with its letter."""
    return _ANGLE.fullmatch(re.sub(r"(?<=\d),(?=\d)", ".", match["angle"].strip())) if match else None


def angle_fault(text: str) -> str | None:
    """What is wrong with an angle of which a part is 60 or more, as in ``10 66 01``; ``None`` for anything else."""
    angle = _angle(_SIGNED.fullmatch(text.strip().translate(_SIGNS)))
    parts = ((part, float(angle[part] or 0.0)) for part in ("minutes", "seconds")) if angle else ()
    told = [f"{number:g} {part}" for part, number in parts if number >= 60.0]
    return f"has {' and '.join(told)}, and each must be under 60" if told else None


def hemisphere(text: str) -> tuple[Axis, int] | None:
    """The axis and the sign that a letter or word stands for; the sign of O is 0, because languages differ."""
    return _HEMISPHERES.get(text.strip().strip(".").lower())


def side_of(text: str, axis: Axis) -> int | None:
    """The sign that a cell beside a coordinate gives it: of ``S``, ``south``, ``SW`` or ``N/E``, of ``-`` or ``-1``.

    That of O is 0; ``None`` for what says nothing about this axis.
    """
    plain = text.strip().translate(_SIGNS)
    return _PLAIN_SIGNS[plain] if plain in _PLAIN_SIGNS else _sides_named(plain).get(axis)


def names_both_sides(text: str) -> bool:
    """Whether a cell names north or south, and east or west: ``SW``, ``N/E``."""
    return len(_sides_named(text)) == 2


def _sides_named(text: str) -> dict[Axis, int]:
    """The sign of each axis whose side a cell names."""
    pair = _SIDE_PAIR.fullmatch(text.strip())
    parts = (text,) if hemisphere(text) is not None or pair is None else pair.groups()
    return dict(side for part in parts if (side := hemisphere(part)) is not None)


def side_written(text: str) -> tuple[Axis, int] | None:
    """The hemisphere of a cell that is its letter, or an angle with its letter."""
    match = _SIGNED.fullmatch(text.strip().translate(_SIGNS))
    return hemisphere((match["before"] or match["after"] or "") if match else text)


def number_given(value: object) -> float | None:
    """The number of a property: as the file has it, or as text with a decimal point or comma.

    ``None`` for what is none, and for text such as ``1,200``, of which nobody knows whether thousands are marked.
    """
    if not isinstance(value, str):
        return number_of(value)
    return None if re.fullmatch(r"\s*\d{1,3}(?:,\d{3})+\s*", value) else plain_number(value)


def parse_degrees(text: str, axis: Axis, sign_of_o: int = -1) -> float | None:
    """Degrees as people write them: ``-89.17``, ``89,17 W``, ``10°06'01.4"N``, ``N 10 06 01.4``, ``10d06m``.

    Returns ``None`` for what is no angle of this axis. The letter O has the sign that the language of a table gives it.
    """
    number = plain_number(text)
    if number is not None:
        return number
    match = _SIGNED.fullmatch(text.strip().translate(_SIGNS))
    angle = _angle(match)
    if match is None or angle is None or (match["before"] and match["after"]):
        return None
    degrees, minutes, seconds = (float(angle[part] or 0.0) for part in ("degrees", "minutes", "seconds"))
    has_fraction = any(
        "." in (angle[part] or "") and angle[finer] for part, finer in (("degrees", "minutes"), ("minutes", "seconds"))
    )
    if minutes >= 60.0 or seconds >= 60.0 or has_fraction:
        return None
    value = degrees + minutes / 60.0 + seconds / 3600.0
    letter = match["before"] or match["after"]
    if letter:
        letter_axis, sign = _HEMISPHERES[letter.lower()]
        sign = sign or sign_of_o
        if letter_axis != axis or (match["sign"] == "-" and sign > 0):
            return None
        return sign * value
    return -value if match["sign"] == "-" else value
