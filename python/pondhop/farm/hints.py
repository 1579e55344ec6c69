"""What stands beside the name of a feature and says what it is: kinds, tags of maps, folders and styles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import takewhile

from pondhop.farm.features import NAME_COLUMNS, Feature, is_blank, normal_name, shortened
from pondhop.farm.map_tags import OSM_KEYS, has_pond_tag, said_by_tags, tells_anything
from pondhop.farm.shapes import closed_line
from pondhop.farm.vocabulary import (
    column_words,
    kind_meanings,
    pond_like_words,
)
from pondhop.farm.words import (
    Meaning,
    heading_words,
    is_ordinary,
    is_unnamed,
    meanings,
    says_only,
    series_of,
    without_accents,
)

ROLE_COLUMNS = column_words("roles")
KIND_COLUMNS = column_words("kinds")
REMARK_COLUMNS = column_words("remarks")

POND_COLUMNS = frozenset(map(normal_name, column_words("ponds")))
"""Columns that tell one pond from another."""

MAX_KINDS = 30
"""A column with more values than this holds names or remarks, not kinds."""

_NO_KIND_COLUMNS = frozenset(map(normal_name, (*ROLE_COLUMNS, *REMARK_COLUMNS, *NAME_COLUMNS, *OSM_KEYS)))
"""Columns whose values say something else than what a feature is, even where they are words for things."""

_ATTRIBUTE_WORDS = frozenset(word for heading in column_words("attributes") for word in heading_words(heading))

_THINGS = frozenset(
    {Meaning.NO_FLY, Meaning.OTHER, Meaning.DEPOT, Meaning.START, Meaning.STATION, Meaning.FENCE, Meaning.SAMPLING}
)

_KNOWN_KIND_COLUMNS = frozenset(
    normal_name(form) for name in KIND_COLUMNS for form in (name, without_accents(name).replace("đ", "d"))
)
"""Shapefiles have no accents in their headings."""

_ORDER = (
    Meaning.POND,
    Meaning.NO_FLY,
    Meaning.OTHER,
    Meaning.DEPOT,
    Meaning.START,
    Meaning.STATION,
    Meaning.FENCE,
    Meaning.BOUNDARY,
    Meaning.UNCERTAIN,
)
"""Which of several meanings of a name counts: an "office at the base" is an office, a "pond by the office" a pond."""


@dataclass(frozen=True)
class Hint:
    """What something beside the name of a feature says.

    Attributes
    ----------
    meaning
        What the feature is; uncertain where that only may be no pond.
    because
        What says so, for messages: ``its type is 'road'``.
    text
        The text that was read for words.
    is_own
        Whether it is said of the feature itself, not of where it lies.
    """

    meaning: Meaning
    because: str
    text: str
    is_own: bool = False


@dataclass(frozen=True)
class Surroundings:
    """What the features of a file have in common, by which each of them is understood.

    Attributes
    ----------
    kind_columns
        Columns that say what a feature is, as the file spells them.
    asking_columns
        Columns of any heading that speak of other things than ponds alone: kinds, or what lies beside a pond.
    pond_kinds
        By column, a value that says of other features that they are ponds.
    has_layers
        Whether features lie in different folders.
    num_shared_folders
        Outermost folders that hold the whole file, which tell nothing apart.
    pond_folder
        A folder that is named for ponds; blank if none is, or all features lie in it.
    has_tagged_ponds
        Whether tags of OpenStreetMap say of any feature that it is a pond beyond doubt.
    has_outlines
        Whether any feature is drawn as an area.
    """

    kind_columns: tuple[str, ...] = ()
    asking_columns: tuple[str, ...] = ()
    pond_kinds: tuple[tuple[str, str], ...] = ()
    has_layers: bool = False
    num_shared_folders: int = 0
    pond_folder: str = ""
    has_tagged_ponds: bool = False
    has_outlines: bool = False


def decided(text: str, *, is_line: bool) -> Meaning | None:
    """Which of the meanings of a text counts."""
    found = meanings(text)
    first = next((meaning for meaning in _ORDER if meaning in found), None)
    if Meaning.SAMPLING in found and series_of(text) is not None:
        # A station where samples are taken is none of the drones.
        return None
    if first is Meaning.OTHER and Meaning.DEPOT in found:
        return Meaning.START
    return Meaning.OTHER if is_line and first in {Meaning.START, Meaning.STATION} else first


def surroundings_of(features: Sequence[Feature]) -> Surroundings:
    """What the features of a file have in common."""
    paths = list(dict.fromkeys(feature.folders for feature in features))
    num_shared = _num_shared(paths) if len(paths) > 1 else 0
    named = (folder for path in paths for folder in path[num_shared:] if len(paths) > 1)
    pond_folder = next((folder for folder in named if decided(folder, is_line=False) is Meaning.POND), "")
    known: list[str] = []
    asking: list[str] = []
    pond_kinds: list[tuple[str, str]] = []
    for column, values in _columns_of_texts(features).items():
        plain = normal_name(column)
        pond_kind = next((value for value in values if _of_kind(value) is Meaning.POND), None)
        if plain in _KNOWN_KIND_COLUMNS or (pond_kind is not None and _holds_kinds(column, values)):
            known.append(column)
            if pond_kind is not None:
                pond_kinds.append((column, pond_kind))
        elif _holds_kinds(column, values):
            asking.append(column)
    return Surroundings(
        tuple(known),
        tuple(asking),
        tuple(pond_kinds),
        len(paths) > 1,
        num_shared,
        pond_folder,
        any(map(has_pond_tag, features)),
        any(feature.geometry.polygons for feature in features),
    )


def _num_shared(paths: Sequence[tuple[str, ...]]) -> int:
    """How many of the outermost folders all features have in common."""
    levels = zip(*paths, strict=False)
    return sum(1 for _ in takewhile(lambda folders: len(set(folders)) == 1, levels))


def _columns_of_texts(features: Sequence[Feature]) -> dict[str, dict[str, int]]:
    """The values of every column that holds few different texts, each with how often it stands there."""
    columns: dict[str, dict[str, int]] = {}
    names: set[str] = set()
    dropped: set[str] = set()
    for feature in features:
        names.add(feature.name_column)
        for column, value in feature.properties.items():
            if column in dropped or is_blank(value):
                continue
            values = columns.setdefault(column, {})
            if isinstance(value, str):
                values[value] = values.get(value, 0) + 1
            is_known = normal_name(column) in _KNOWN_KIND_COLUMNS
            if not is_known and (not isinstance(value, str) or len(values) > MAX_KINDS):
                dropped.add(column)
                del columns[column]
    return {column: values for column, values in columns.items() if normal_name(column) not in names}


def _holds_kinds(column: str, values: dict[str, int]) -> bool:
    """Whether a column of any heading holds kinds: few words for things, none of them numbered as names are.

    A heading that is itself a word for a thing (``aerator``), or for what lies beside a pond (``water source``), has
    values that say what that thing is.
    """
    plain = normal_name(column)
    if plain in _NO_KIND_COLUMNS or plain in POND_COLUMNS or column.startswith("@"):
        return False
    if _THINGS & meanings(column) or _ATTRIBUTE_WORDS.intersection(heading_words(column)):
        return False
    worded = {value: meaning for value in values if says_only(value) and (meaning := _of_kind(value)) is not None}
    # Farms are called by words for land, blocks by words such as zone.
    if not set(worded.values()) - {Meaning.BOUNDARY, Meaning.UNCERTAIN}:
        return False
    is_repeated = len(values) < sum(values.values())
    return len(worded) == len(values) or (is_repeated and 2 * len(worded) >= len(values))


def _of_kind(value: str) -> Meaning | None:
    """What a value in a column of kinds says, where some words say more than in a name: ``water``, ``other``."""
    own = kind_meanings().get(value.strip().casefold())
    meaning = Meaning[own.upper()] if own else decided(value, is_line=False)
    # A pond for storage is a pond, and a hatchery may be one: its kind alone does not tell.
    return Meaning.UNCERTAIN if meaning is Meaning.OTHER and _is_of_ponds(value) else meaning


def hint_of(feature: Feature, around: Surroundings) -> Hint | None:
    """The nearest thing to a feature that says what it is, else the nearest that puts it in doubt."""
    hints = [*_kinds(feature, around), *_tags(feature, around), *_folders(feature, around), *_styles(feature)]
    doubts = (hint for hint in hints if hint.meaning is Meaning.UNCERTAIN)
    return next((hint for hint in hints if hint.meaning is not Meaning.UNCERTAIN), next(doubts, None))


def _kinds(feature: Feature, around: Surroundings) -> Iterator[Hint]:
    """What columns of kinds say; a value without a word is doubtful where others of its column are ponds."""
    pond_kinds = dict(around.pond_kinds)
    for column in (*around.kind_columns, *around.asking_columns):
        value = feature.properties.get(column)
        if not isinstance(value, str) or is_blank(value) or tells_anything(column, value):
            continue
        meaning, because = _of_kind(value), f"its {column} is {shortened(value)!r}"
        if column in around.asking_columns:
            meaning = meaning and Meaning.UNCERTAIN
        elif meaning is None and column in pond_kinds and not _is_of_ponds(value):
            meaning, because = Meaning.UNCERTAIN, f"{because}, and that of others is {shortened(pond_kinds[column])!r}"
        if meaning is not None:
            yield Hint(meaning, because, value, is_own=True)


def _is_of_ponds(value: str) -> bool:
    """Whether a kind is one of ponds by other words, such as ``nursery``, or one that a program wrote there."""
    words = heading_words(value)
    return is_unnamed(value) or (bool(words) and all(word in pond_like_words() for word in words))


def _folders(feature: Feature, around: Surroundings) -> Iterator[Hint]:
    """What folders say; one without a word is doubtful beside one that is named for ponds."""
    for depth, folder in reversed(list(enumerate(feature.folders))):
        meaning = decided(folder, is_line=False)
        is_telling = around.has_layers and depth >= around.num_shared_folders
        # What holds the whole file holds the ponds, whatever it is called, unless that is something to keep out of.
        if meaning in {Meaning.NO_FLY, Meaning.FENCE, Meaning.BOUNDARY} or (
            is_telling and meaning not in {None, Meaning.UNCERTAIN}
        ):
            yield Hint(meaning or Meaning.UNCERTAIN, f"it lies in {folder!r}", folder)
    own = feature.folders[around.num_shared_folders :]
    is_part = any(is_ordinary(folder) and not is_unnamed(folder) for folder in own)
    if around.pond_folder and not is_part and _is_drawn_as_pond(feature, around):
        where = f"it lies in {own[-1]!r}" if own else "it lies in no folder"
        yield Hint(Meaning.UNCERTAIN, f"{where}, and ponds lie in {around.pond_folder!r}", "")


def _is_drawn_as_pond(feature: Feature, around: Surroundings) -> bool:
    """Whether a feature is drawn as ponds are: open lines are roads, and points among outlines mostly labels."""
    geometry = feature.geometry
    is_outline = bool(geometry.polygons) or any(map(closed_line, geometry.lines))
    return is_outline or (bool(geometry.points) and not geometry.lines and not around.has_outlines)


def _styles(feature: Feature) -> Iterator[Hint]:
    meaning = decided(feature.style, is_line=False) if feature.style else None
    if meaning in {Meaning.NO_FLY, Meaning.FENCE}:
        yield Hint(meaning, f"its style is {shortened(feature.style)!r}", feature.style)


def _tags(feature: Feature, around: Surroundings) -> Iterator[Hint]:
    for meaning, text in said_by_tags(feature, has_sure_ponds=around.has_tagged_ponds):
        yield Hint(meaning, f"it has {text}", text, is_own=meaning is not Meaning.NO_FLY)
