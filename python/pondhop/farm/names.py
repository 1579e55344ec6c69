"""What each pond is called: the column of the file that tells all ponds apart, or numbers where none does."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from pondhop.errors import Fault
from pondhop.farm.degrees import plain_number
from pondhop.farm.features import (
    NAME_COLUMNS,
    Feature,
    Source,
    clean_text,
    is_blank,
    listed,
    normal_name,
    shortened,
    text_of,
)
from pondhop.farm.hints import KIND_COLUMNS, POND_COLUMNS, ROLE_COLUMNS
from pondhop.farm.map_tags import OSM_KEYS
from pondhop.farm.ponds import Draft
from pondhop.farm.shapes import places_together
from pondhop.farm.vocabulary import column_words, english_words
from pondhop.farm.words import Meaning, heading_words, is_plain_word, is_unnamed, meanings
from pondhop.places import distance_m

_CODE_WORDS = frozenset(column_words("codes"))
"""Words in headings of columns of numbers that people call a place by."""

_PREFERRED = ("id", "pond_id", "pond", "pond_name", "pond_no", "name", "label")
"""Columns that hold ids, the first one best; then those of other languages, in the order of the file."""

_PROGRAM_COLUMNS = ("@id", "fid", "osm_id", "osm_way_id", "objectid", "gid", "ogc_fid", "uid", "uuid", "gml_id")
"""Columns that programs fill in: they tell ponds apart, but nobody calls them so."""

_NO_NAME_COLUMNS = frozenset(
    map(
        normal_name,
        (
            *ROLE_COLUMNS,
            *KIND_COLUMNS,
            *OSM_KEYS,
            *_PROGRAM_COLUMNS,
            "service_s",
            "sampling_point",
            "time_windows",
            "priority",
        ),
    )
)
"""Columns that name no pond, whatever they hold."""

_OF_PONDS = frozenset({Meaning.POND, Meaning.SAMPLING, Meaning.SERIES, Meaning.UNCERTAIN, Meaning.UNNAMED})
"""What the name of a pond may say."""

MAX_ID_LETTERS = 40
"""A column with longer values is a remark."""

COPY_M = 25.0
"""Ponds nearer than this with one id in two layers are one pond, surveyed twice."""

SAME_PLACE_M = 1.0
"""Ponds nearer than this have room for nothing; in two layers they are one pond, whatever they are called."""


def adopt_names(features: Sequence[Feature]) -> None:
    """Take the first column of texts that tells the features apart as their names, where no column is known to be one.

    Before anything is told by its name: an area to keep out of may have its name in a column of any heading. What has a
    role, or is no pond by its own name, as one depot beside ponds without names is, says nothing of the others.
    """
    known = (*NAME_COLUMNS, *POND_COLUMNS)
    candidates = []
    for feature in features:
        found = feature.find(*known)
        if feature.find(*ROLE_COLUMNS) is None and (found is None or _may_name_pond(clean_text(text_of(found[1])))):
            candidates.append(feature)
    if len(candidates) < 2 or any(feature.find(*known) for feature in candidates):
        return
    column = next(_other_columns(candidates, ()), None)
    if column is not None:
        for feature in features:
            feature.name_column = column


def _may_name_pond(name: str) -> bool:
    """Whether a name says nothing, or anything else than that a thing is none of the ponds."""
    return not meanings(name) or bool(meanings(name) & _OF_PONDS)


def name_ponds(drafts: Sequence[Draft], source: Source) -> None:
    """Give every pond an id of its own, with notes, or faults where two have the same."""
    features = list({id(draft.feature): draft.feature for draft in drafts}.values())
    ids = _ids(features, source)
    for draft in drafts:
        draft.id = ids[id(draft.feature)]
    _number_unnamed(drafts, source)
    for draft in drafts:
        if draft.part:
            draft.id = f"{draft.id} {draft.part}"
    _tell_copies(drafts, source)


def _columns(features: Sequence[Feature]) -> list[str]:
    """The columns that may hold ids, by their plain names, the best ones first."""
    in_file = dict.fromkeys(normal_name(key) for feature in features for key in feature.properties)
    preferred = [normal_name(name) for name in _PREFERRED]
    of_ponds = [key for key in in_file if key in POND_COLUMNS and key not in preferred]
    of_names = [normal_name(name) for name in NAME_COLUMNS if normal_name(name) in in_file]
    adopted = [feature.name_column for feature in features if feature.name_column in in_file]
    return list(dict.fromkeys([*(key for key in preferred if key in in_file), *of_ponds, *of_names, *adopted]))


def _heading(features: Sequence[Feature], column: str) -> str:
    """A column as the file spells it."""
    return next((found[0] for feature in features if (found := feature.find(column)) is not None), column)


def _value(feature: Feature, column: str) -> str:
    found = feature.find(column)
    if found is None or isinstance(found[1], dict | list):
        return ""
    return clean_text(text_of(found[1]))


def _ids(features: Sequence[Feature], source: Source) -> dict[int, str]:
    """The id of each feature, by its identity; blank where the file has none."""
    columns = _columns(features)
    values = {column: [_value(feature, column) for feature in features] for column in columns}
    telling = next((column for column in columns if _tells_apart(values[column])), None)
    is_any_named = any(map(any, values.values()))
    if telling is None and (
        any(len(set(filter(None, values[column]))) > 1 for column in columns)
        or len(features) > (2 if is_any_named else 1)
    ):
        telling = next(_other_columns(features, columns), None)
        if telling is not None:
            values[telling] = [_value(feature, telling) for feature in features]
    if telling is not None:
        passed = [
            column
            for column in columns[: columns.index(telling) if telling in columns else None]
            if any(values[column])
        ]
        if passed or telling not in columns or telling == features[0].name_column:
            why = "no column is known to hold names"
            if passed:
                why = f"column {_heading(features, passed[0])!r} does not tell them apart"
            source.notes.add(f"The ponds are named by column {_heading(features, telling)!r}, because {why}.")
        return {id(feature): value for feature, value in zip(features, values[telling], strict=True)}
    own = [feature.own_id or "" for feature in features]
    programs = ([_value(feature, normal_name(name)) for feature in features] for name in _PROGRAM_COLUMNS)
    by_program = next((ids for ids in (own, *programs) if _tells_apart(ids)), None)
    if by_program is not None and not any(len(set(filter(None, ids))) > 1 for ids in values.values()):
        if any(any(ids) for ids in values.values()):
            source.notes.add(
                "The ponds are named by the ids of the program that made the file; no name tells them apart."
            )
        return {id(feature): value for feature, value in zip(features, by_program, strict=True)}
    # No column names them all: the one that names most, and the others for the rest.
    ranked = sorted(columns, key=lambda column: -len(set(filter(None, values[column]))))
    return {
        id(feature): next((values[column][index] for column in ranked if values[column][index]), feature.own_id or "")
        for index, feature in enumerate(features)
    }


def _tells_apart(values: Sequence[str]) -> bool:
    return all(values) and len(set(values)) == len(values) and not any(map(is_unnamed, values))


def _other_columns(features: Sequence[Feature], columns: Sequence[str]) -> Iterator[str]:
    """Columns of any other name that tell the features apart: short texts, then numbers under a heading for codes."""
    left_out = {*columns, *_NO_NAME_COLUMNS}
    codes: list[str] = []
    for key in dict.fromkeys(key for feature in features for key in feature.properties if not key.startswith("@")):
        values = [feature.properties.get(key) for feature in features]
        is_short = all(
            isinstance(value, str | int) and not is_blank(value) and len(str(value)) <= MAX_ID_LETTERS
            for value in values
        )
        if normal_name(key) in left_out or not is_short or not _tells_apart([text_of(value) for value in values]):
            continue
        if all(isinstance(value, str) and any(letter.isalpha() for letter in value) for value in values):
            yield normal_name(key)
        elif _is_code_heading(key) and not any(map(_is_decimal, values)):
            codes.append(normal_name(key))
    yield from codes


def _is_code_heading(heading: str) -> bool:
    """Whether a heading says that it holds codes: by its last word, as ``Site Code``, or of ponds, as ``nº estanque``.

    "Unit area", "point depth" and "number of fish" are measured, not called.
    """
    words = heading_words(heading)
    if not words or english_words("before_places").intersection(words):
        return False
    is_of_pond = words[0] in _CODE_WORDS and is_plain_word(words[-1]) and not words[-1].endswith("s")
    return words[-1] in _CODE_WORDS or is_of_pond


def _is_decimal(value: object) -> bool:
    number = plain_number(text_of(value))
    return number is not None and not number.is_integer()


def _number_unnamed(drafts: Sequence[Draft], source: Source) -> None:
    """Number ponds without an id, and those that share what is no name."""
    features = list({id(draft.feature): draft.feature for draft in drafts}.values())
    id_of = {id(draft.feature): draft.id for draft in drafts}
    counts = Counter(id_of.values())
    is_one_for_all = len(features) > 2 and len(counts) == 1 and not any(feature.folders for feature in features)
    used = set(counts)
    numbered: list[str] = []
    num_unnamed = 0
    for name, count in counts.items():
        says_nothing = is_unnamed(name) or is_plain_word(name) or (is_one_for_all and bool(name))
        if not name or (count > 1 and is_one_for_all and name.isdecimal()):
            num_unnamed += _number(features, id_of, name, used, "")
        elif count > 1 and says_nothing:
            _number(features, id_of, name, used, f"{name} ")
            numbered.append(name)
    if num_unnamed:
        ponds = "1 pond without an id was" if num_unnamed == 1 else f"{num_unnamed} ponds without an id were"
        source.notes.add(f"{ponds} numbered in the order of the file.")
    if numbered:
        example = f"{shortened(numbered[0])} 2"
        source.notes.add(f"Ponds called alike were numbered in the order of the file, as in {example!r}.")
    for draft in drafts:
        draft.id = id_of[id(draft.feature)]


def _number(features: Sequence[Feature], id_of: dict[int, str], name: str, used: set[str], prefix: str) -> int:
    """Number the features of one name: by their place in the file without a prefix, among themselves with one."""
    members = [(index, feature) for index, feature in enumerate(features) if id_of[id(feature)] == name]
    for count, (index, feature) in enumerate(members, start=1):
        number = count if prefix else index + 1
        while f"{prefix}{number}" in used:
            number += len(features)
        id_of[id(feature)] = f"{prefix}{number}"
        used.add(f"{prefix}{number}")
    return len(members)


def _tell_copies(drafts: Sequence[Draft], source: Source) -> None:
    """Tell of ponds that are there twice: in two layers, or with one id that is no number in two folders."""
    copies = _copies(drafts)
    if copies:
        layers = dict.fromkeys(_layer(draft) for pair in copies for draft in pair)
        ponds = "1 pond is" if len(copies) == 1 else f"{len(copies)} ponds are"
        message = f"{ponds} there twice, in layers {listed(map(repr, layers))}"
        source.faults.append(
            Fault("file", message, f"choose one with --layer {next(iter(layers))!r}, or remove the other")
        )
    doubles = _doubles(drafts)
    across = [(first, second) for first, second in doubles if first.feature.folders != second.feature.folders]
    if doubles and not copies and len(across) == len(doubles):
        shared = {first.id for first, _ in doubles}
        for draft in drafts:
            if draft.id in shared and draft.feature.folders:
                draft.id = f"{_layer(draft)} {draft.id}"
        source.notes.add(
            f"Ponds of one name in different folders were named with their folders, as in {doubles[0][1].id!r}."
        )
        doubles = [] if len({draft.id for draft in drafts}) == len(drafts) else across
    told = {id(draft) for _, draft in copies}
    for first, draft in doubles:
        if id(draft) not in told:
            message = f"id {shortened(draft.id)!r} is already that of {first.feature.place}"
            source.faults.append(Fault(draft.feature.place, message, "give every pond an id of its own"))


def _doubles(drafts: Sequence[Draft]) -> list[tuple[Draft, Draft]]:
    """The first pond of each id with every other one of that id."""
    firsts: dict[str, Draft] = {}
    pairs = [(firsts.setdefault(draft.id, draft), draft) for draft in drafts]
    return [(first, draft) for first, draft in pairs if first is not draft]


def _copies(drafts: Sequence[Draft]) -> list[tuple[Draft, Draft]]:
    """Ponds of two layers that are one pond, each with the first one."""
    pairs = [
        (first, draft)
        for first, draft in _doubles(drafts)
        if distance_m(first.sampling_point, draft.sampling_point) < COPY_M
    ]
    if len({draft.feature.folders for draft in drafts}) > 1:
        together = places_together([draft.sampling_point for draft in drafts], SAME_PLACE_M)
        pairs.extend((drafts[first], drafts[second]) for first, second in together)
    across = [pair for pair in pairs if pair[0].feature.folders != pair[1].feature.folders]
    return list({id(second): (first, second) for first, second in across}.values())


def _layer(draft: Draft) -> str:
    return draft.feature.folders[-1] if draft.feature.folders else "none"
