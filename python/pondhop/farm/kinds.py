"""What kinds, map tags, layers, folders and styles say of a feature."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

from pondhop.farm.features import NAME_COLUMNS, Feature, is_blank, normal_name, present_columns
from pondhop.farm.vocabulary import column_words, tag_meanings, tags_of_anything_else
from pondhop.farm.words import Meaning, meanings, series_of

ROLES = ("pond", "depot", "station", "no_fly", "fence", "other")
"""What a feature can be, in the property ``role``; the first is the default."""

POND_COLUMNS = frozenset(map(normal_name, column_words("ponds")))
"""Columns that tell one pond from another."""

ROLE_COLUMNS = column_words("roles")
KIND_COLUMNS = column_words("kinds")
REMARK_COLUMNS = column_words("remarks")
_LAYER_COLUMNS = frozenset(map(normal_name, column_words("layers")))
"""Columns that may say what a feature is, or whose it is, or where."""
DECLARING_COLUMNS = ("service_s", "sampling_point", "pond_id", "pond", "pond_name", "pond_no", "pond_number")

OSM_KEYS = tuple(dict.fromkeys((*tags_of_anything_else(), *(key for key, _ in tag_meanings()))))
"""Tags of OpenStreetMap that say what a feature is, not what it is called."""


MAX_KINDS = 12
"""Values that a column has at most that says what each feature is."""


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


def decided(text: str, *, is_line: bool) -> Meaning | None:
    """What counts most of all that a text says; a line is no place to take off from or to charge at."""
    found = meanings(text)
    meaning = next((other for other in _ORDER if other in found), None)
    if Meaning.SAMPLING in found and series_of(text) is not None:
        # A station where samples are taken is none of the drones.
        return None
    if meaning is Meaning.OTHER and Meaning.DEPOT in found:
        return Meaning.START
    return Meaning.OTHER if is_line and meaning in {Meaning.START, Meaning.STATION} else meaning


def kind_said(value: str) -> Meaning | None:
    """What the value of a column of kinds says, in anybody's words or in those of OpenStreetMap."""
    said = decided(value, is_line=False)
    return said if said is not None else _meanings_of_tag_values().get(value.strip().casefold().replace(" ", "_"))


@cache
def _meanings_of_tag_values() -> dict[str, Meaning]:
    """Values of tags of OpenStreetMap that say the same with every key."""
    said: dict[str, set[str]] = {}
    for (_, value), meaning in tag_meanings().items():
        said.setdefault(value, set()).add(meaning)
    return {value: Meaning[meaning.upper()] for value, [meaning, *others] in said.items() if not others}


@dataclass(frozen=True)
class KindColumns:
    """Columns besides those called type that say what features are, by their plain names.

    Attributes
    ----------
    sure
        Called like a layer or a use, and every value says something, one of them pond and another something else.
    doubtful
        Only the one or the other: a use may be that of the land, and a column of pond and road say what is nearest.
    """

    sure: frozenset[str]
    doubtful: frozenset[str]


def kind_columns(features: Sequence[Feature]) -> KindColumns:
    """Columns of any heading whose few values are words for ponds and other things, and those that may be such."""
    known = {*map(normal_name, (*KIND_COLUMNS, *ROLE_COLUMNS, *REMARK_COLUMNS, *NAME_COLUMNS)), *POND_COLUMNS}
    values: dict[str, set[str]] = {}
    keys = dict.fromkeys(key for feature in features for key in feature.properties)
    for key in keys:
        name = normal_name(key)
        if name in known or (key in OSM_KEYS and name not in _LAYER_COLUMNS):
            continue
        held = values.setdefault(name, set())
        for feature in features:
            value = feature.properties.get(key)
            if not is_blank(value):
                held.add(value if isinstance(value, str) else "")
                if len(held) > MAX_KINDS:
                    break
    telling = set()
    for name, held in values.items():
        said = set(map(kind_said, held)) if len(held) <= MAX_KINDS else {None}
        if None not in said and Meaning.POND in said and len(said) > 1:
            telling.add(name)
    layers = values.keys() & _LAYER_COLUMNS
    return KindColumns(sure=frozenset(telling & layers), doubtful=frozenset(telling ^ layers))


def hints(feature: Feature, has_layers: bool, kinds: KindColumns) -> Iterator[tuple[Meaning | None, str, str]]:
    """What kinds, map tags, folders and styles say, the nearest to the feature first, with the text of each."""
    called = present_columns(tuple(feature.properties), KIND_COLUMNS)
    told = [key for key in feature.properties if normal_name(key) in kinds.sure] if kinds.sure else []
    for key in (*called, *told):
        value = feature.properties[key]
        if isinstance(value, str) and not is_blank(value):
            yield kind_said(value), f"its {key} is {value[:40]!r}", value
    yield from _tags(feature)
    for folder in reversed(feature.folders):
        meaning = decided(folder, is_line=False)
        # The only layer of a file holds the ponds, whatever it is called, unless that is something to keep out of.
        if has_layers or meaning in {Meaning.NO_FLY, Meaning.FENCE, Meaning.BOUNDARY}:
            yield (None if meaning is Meaning.UNCERTAIN else meaning), f"it lies in {folder!r}", folder
    if feature.style:
        meaning = decided(feature.style, is_line=False)
        why = f"its style is {feature.style[:40]!r}"
        yield (meaning if meaning in {Meaning.NO_FLY, Meaning.FENCE} else None), why, feature.style


def _tags(feature: Feature) -> Iterator[tuple[Meaning | None, str, str]]:
    """What the tags of OpenStreetMap say, and columns that are themselves a question: ``no_fly: yes``."""
    is_osm = any(key in feature.properties for key in ("@id", "osm_id", "osm_way_id"))
    # That something is water is said of ponds and rivers alike; which it is, another tag tells.
    for key, value in sorted(feature.properties.items(), key=lambda tag: tag == ("natural", "water")):
        if is_blank(value) or str(value).strip().lower() in {"no", "false", "0", "none"}:
            continue
        text = f"{key}={str(value)[:40]}"
        told = f"it has {text}"
        meaning = tag_meanings().get((key, str(value)))
        if meaning is not None:
            yield Meaning[meaning.upper()], told, text
        elif key in tags_of_anything_else() and (is_osm or str(value) == "yes"):
            yield Meaning.OTHER, told, text
        elif str(value).strip().lower() in {"yes", "true", "1"} and meanings(key) == {Meaning.NO_FLY}:
            yield Meaning.NO_FLY, told, text
