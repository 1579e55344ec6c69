"""What a farm file holds before anyone asks whether it makes a farm: features, each with its place in the file."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from unicodedata import category

from pondhop.errors import Fault
from pondhop.farm.vocabulary import column_words
from pondhop.places import LonLat
from pondhop.units import counted

Positions = list[LonLat]

NAME_COLUMNS = column_words("names")
"""Columns that hold what people call a feature."""

MAX_ALIKE = 4
"""Notes of one kind that are told in full; of more, the first ones are told and the rest are counted."""


@dataclass(slots=True)
class Geometry:
    """Positions of one feature, sorted by what they draw; longitude before latitude.

    Attributes
    ----------
    points
        Single places.
    lines
        Open or closed lines.
    polygons
        Rings per polygon, the outer one first; closed or not, as the file has them.
    """

    points: Positions = field(default_factory=list)
    lines: list[Positions] = field(default_factory=list)
    polygons: list[list[Positions]] = field(default_factory=list)

    def positions(self) -> Positions:
        """All positions, in the order points, lines, polygons."""
        rings = [ring for polygon in self.polygons for ring in polygon]
        return [*self.points, *(position for part in (*self.lines, *rings) for position in part)]


@dataclass(slots=True)
class Feature:
    """One feature of a file.

    Attributes
    ----------
    place
        Where the feature stands, in the words of the file: ``features[3]``, ``line 17``.
    property_place
        The same for one of its properties, whose name replaces ``{}``: ``line 17, column {}``.
    properties
        As in the file; an absent value is ``None`` or blank.
    geometry
        Its positions in WGS84; empty where the file gives none.
    own_id
        What the format calls the feature, for want of a property: the ``id`` of a GeoJSON feature.
    folders
        The layer, sheet or folders it stands in, the outermost first, if the format has them.
    style
        What the format calls the way it is drawn, which people name too: the style of a placemark.
    doubts
        What was guessed about its position while reading, a sentence each; only its owner can tell whether it is right.
    is_hidden
        Whether its owner had unticked it, or a folder around it, in the map program.
    name_column
        A column of any heading that holds its name where none is known to.
    """

    place: str
    property_place: str
    properties: Mapping[str, object]
    geometry: Geometry
    own_id: str | None = None
    folders: tuple[str, ...] = ()
    style: str = ""
    doubts: list[str] = field(default_factory=list)
    is_hidden: bool = False
    name_column: str = ""

    def find(self, *names: str) -> tuple[str, object] | None:
        """The first property that is there under one of the names, as the file spells it, and its value.

        Spelling is forgiving: ``Pond ID`` is ``pond_id``. Blank values count as absent.
        """
        for key in present_columns(tuple(self.properties), names):
            value = self.properties[key]
            if not is_blank(value):
                return key, value
        return None

    @property
    def name(self) -> str:
        """What people call it, for messages; empty if they do not."""
        found = self.find(*NAME_COLUMNS) or (self.find(self.name_column) if self.name_column else None)
        return clean_text(text_of(found[1])) if found else ""

    @property
    def id(self) -> str:
        """What tells it from others where it has no name, for messages; empty if nothing does."""
        found = self.find("id", "pond_id")
        return clean_text(text_of(found[1])) if found else self.own_id or ""

    def told(self) -> str:
        """Its name and its place, for messages."""
        return f"{shortened(self.name)!r} ({self.place})" if self.name else self.place


class Notes:
    """What the reader assumed or changed, a sentence each; what repeats itself is counted."""

    def __init__(self) -> None:
        self._kinds: dict[str, list[str]] = {}

    def add(self, sentence: str, kind: str | None = None) -> None:
        """Tell a sentence once; those of one `kind` are counted where they are many."""
        told = self._kinds.setdefault(kind or sentence, [])
        if sentence not in told[-1:]:
            told.append(sentence)

    def sentences(self) -> tuple[str, ...]:
        """All of them, in the order of their kinds."""
        lines: list[str] = []
        for told in self._kinds.values():
            if len(told) <= MAX_ALIKE:
                lines.extend(told)
            else:
                shown = told[: MAX_ALIKE - 1]
                lines.extend([*shown, f"The same {len(told) - len(shown)} times more."])
        return tuple(map(clean_text, lines))


@dataclass
class OpenZone:
    """Features in metres of a zone of UTM that may lie in the north or in the south.

    Attributes
    ----------
    number
        Of the zone.
    place
        Where the first of them names it.
    features
        With their metres in place of degrees, until other places tell.
    """

    number: int
    place: str
    features: list[Feature]


@dataclass
class Source:
    """A farm file, read but not yet judged.

    Attributes
    ----------
    name
        What the file calls itself, else the name of the file.
    features
        In the order of the file.
    faults
        What is wrong with the file as such; features they concern may be missing above.
    notes
        What the reader assumed or changed, a sentence each.
    layers
        The names of all layers, sheets or folders, also of those that were not asked for.
    open_zones
        What is settled when everything else is read.
    """

    name: str
    features: list[Feature] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    notes: Notes = field(default_factory=Notes)
    layers: list[str] = field(default_factory=list)
    open_zones: list[OpenZone] = field(default_factory=list)


@lru_cache(maxsize=4096)
def _spellings(keys: tuple[str, ...]) -> dict[str, str]:
    """The columns of a feature by their plain spelling; the first of two that are spelled alike.

    ``@id`` and its like are no columns of people, but of OpenStreetMap.
    """
    return {normal_name(key): key for key in reversed(keys) if not key.startswith("@")}


@lru_cache(maxsize=4096)
def present_columns(keys: tuple[str, ...], names: tuple[str, ...]) -> tuple[str, ...]:
    """Those of some columns that a feature has, as it spells them, in the order of `names`.

    Remembered, because all features of a large file have the same columns and are asked for dozens of names each.
    """
    spellings = _spellings(keys)
    return tuple(spellings[plain] for name in names if (plain := normal_name(name)) in spellings)


@lru_cache(maxsize=4096)
def normal_name(name: str) -> str:
    """A property name without case, blanks and punctuation."""
    return re.sub(r"[\W_]+", "", name).lower()


def is_blank(value: object) -> bool:
    """Whether a property is there in name only."""
    return value is None or (isinstance(value, str) and not value.strip())


def text_of(value: object) -> str:
    """An identifier as text: whole numbers lose the decimal point that a spreadsheet or GIS gave them."""
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return str(value).strip()


@lru_cache(maxsize=4096)
def clean_text(text: str) -> str:
    """A text that can be printed and written anywhere: one line, without half characters and control characters."""
    if text.isascii() and text.isprintable():
        return text.strip()
    plain = " ".join(text.split())
    return "".join(
        _REPLACEMENT if category(letter) in {"Cc", "Cs"} or letter in _TURNING else letter for letter in plain
    )


_REPLACEMENT = "\N{REPLACEMENT CHARACTER}"
_TURNING = "\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
"""Characters that turn the direction of what follows, which would garble the rest of a line."""


def shortened(text: str, max_letters: int = 40) -> str:
    """A text for a message, cut where it is long."""
    return text if len(text) <= max_letters else f"{text[: max_letters - 3]}..."


def listed(names: Iterable[str], max_names: int = 5) -> str:
    """Names for a message, the first ones where they are many."""
    told = list(names)
    more = f" and {len(told) - max_names} more" if len(told) > max_names else ""
    return ", ".join(told[:max_names]) + more


def left_out_note(why: str, features: Sequence[Feature]) -> str:
    """The note about features that were left out: why, which ones, and how many."""
    count = f": {counted(len(features), 'feature')} in all" if len(features) > 1 else ""
    return f"Left out, because {why}: {listed(feature.told() for feature in features)}{count}."


def number_of(value: object) -> float | None:
    """A finite number, or ``None`` if the value is none. Truth values are no numbers; numeric text is one."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    if isinstance(value, str) and "_" in value:
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if math.isfinite(number) else None
