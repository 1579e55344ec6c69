"""What each feature of a file is: a pond, the depot, an area to keep out of, or a thing that is none of these.

A property ``role`` always wins. Else names, kinds, folders and styles are read, in this order, for words that tell.
In doubt a feature is a fault that names it: a pond too few is told, a building too many would be flown to.
"""

from __future__ import annotations

import difflib
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache

from pondhop.errors import Fault
from pondhop.farm.features import (
    NAME_COLUMNS,
    Feature,
    Source,
    clean_text,
    is_blank,
    left_out_note,
    listed,
    normal_name,
    present_columns,
    shortened,
    text_of,
)
from pondhop.farm.shapes import closed_line
from pondhop.farm.vocabulary import column_words, pond_like_words, roofed_words, tag_meanings, tags_of_anything_else
from pondhop.farm.words import (
    Meaning,
    is_out_of_use,
    is_unnamed,
    keeps_drones_out,
    meanings,
    name_stem,
    plain_words,
    series_of,
    thing_named_for_pond,
    word_for,
)
from pondhop.units import counted

ROLES = ("pond", "depot", "station", "no_fly", "fence", "other")
"""What a feature can be, in the property ``role``; the first is the default."""

POND_COLUMNS = frozenset(map(normal_name, column_words("ponds")))
"""Columns that tell one pond from another."""

ROLE_COLUMNS = column_words("roles")
KIND_COLUMNS = column_words("kinds")
REMARK_COLUMNS = column_words("remarks")
_LAYER_COLUMNS = frozenset(map(normal_name, column_words("layers")))
"""Columns that may say what a feature is, or whose it is, or where."""
_DECLARING_COLUMNS = ("service_s", "sampling_point", "pond_id", "pond", "pond_name", "pond_no", "pond_number")

OSM_KEYS = tuple(dict.fromkeys((*tags_of_anything_else(), *(key for key, _ in tag_meanings()))))
"""Tags of OpenStreetMap that say what a feature is, not what it is called."""


MAX_KINDS = 12
"""Values that a column has at most that says what each feature is."""

MIN_HOUSES = 3
"""Houses with numbers that may be those of tanks; one or two are where people live."""

MIN_SERIES = 2
"""Numbered points of one word such as station that make a series."""

MAX_CODE_LETTERS = 2
"""Letters that count as a number: Station A, Station NE."""

MAX_TOLD = 10
"""Features of one kind that are named where none is a pond."""

_TAKEN_FOR = {
    Meaning.DEPOT: "the depot",
    Meaning.START: "a place to take off from",
    Meaning.STATION: "a station of the drones",
    Meaning.NO_FLY: "a no-fly zone",
    Meaning.FENCE: "a fence",
    Meaning.BOUNDARY: "a boundary of land",
    Meaning.OTHER: "something beside ponds",
}


@dataclass
class Sorted:
    """The features of a file by what they are.

    Attributes
    ----------
    ponds
        What is a pond, or may be one.
    sure
        Places of those that are ponds for certain: by role, name, kind or folder.
    depots, starts, stations, no_fly, fences
        The rest of what a plan uses; `starts` may be the depot, as "Home" may.
    guessed
        Places of areas that were told by their name alone.
    has_depot_feature
        Whether any feature is the depot, wherever it lies.
    others
        All that is no pond, with what says so.
    """

    ponds: list[Feature] = field(default_factory=list)
    sure: set[str] = field(default_factory=set)
    depots: list[Feature] = field(default_factory=list)
    starts: list[Feature] = field(default_factory=list)
    stations: list[Feature] = field(default_factory=list)
    no_fly: list[Feature] = field(default_factory=list)
    fences: list[Feature] = field(default_factory=list)
    guessed: set[str] = field(default_factory=set)
    has_depot_feature: bool = False
    others: list[tuple[Feature, Verdict]] = field(default_factory=list)


@dataclass(frozen=True)
class Verdict:
    """What a feature is and what says so.

    Attributes
    ----------
    meaning
        What it is; ``None`` for what nothing is said of, which may be a pond.
    because
        What says so, for messages: ``it is called 'Office'``.
    text
        The text that was read for words: its name, kind or folder.
    is_explicit
        Whether it has a role.
    is_doubtful
        Whether its words contradict each other.
    """

    meaning: Meaning | None
    because: str = ""
    text: str = ""
    is_explicit: bool = False
    is_doubtful: bool = False


def sort_by_role(features: Iterable[Feature], source: Source) -> Sorted:
    """Sort features by what they are; what is none of a farm's things is left out with one note for each reason."""
    told = Sorted()
    left_out: dict[Meaning, list[tuple[Feature, Verdict]]] = {Meaning.OTHER: [], Meaning.BOUNDARY: []}
    doubtful: list[tuple[Feature, str]] = []
    has_layers = len({feature.folders for feature in source.features}) > 1
    features = list(features)
    kinds = _kind_columns(features)
    verdicts = [(feature, _verdict(feature, has_layers, kinds, source)) for feature in features]
    judged = [(feature, verdict) for feature, verdict in verdicts if verdict is not None]
    for feature, by_name in _with_neighbours(_with_series(judged, source)):
        verdict = _with_remarks(feature, by_name)
        if verdict.is_doubtful or (verdict.meaning is Meaning.UNCERTAIN and not _is_declared(feature)):
            doubtful.append((feature, verdict.because))
            continue
        _file(feature, verdict, told, left_out, source)
    _leave_hidden(told, source)
    _tell_left_out(left_out, told, doubtful, source)
    for feature, because in doubtful:
        message = f"is this a pond? {because}"
        action = "say so in a property role: pond, no_fly, fence or other; or rename it, as in 'Pond 7' or 'No fly 1'"
        source.faults.append(Fault(feature.place, message, action))
    return told


def _leave_hidden(told: Sorted, source: Source) -> None:
    """Leave out the ponds that were unticked in the map program, as they are left out of its map, and say so.

    What keeps drones safe counts, seen or not. Where no pond is seen, the whole map was unticked, and all are taken.
    """
    hidden = [feature for feature in told.ponds if feature.is_hidden]
    if hidden and len(hidden) == len(told.ponds):
        ponds = "the only pond is" if len(hidden) == 1 else f"all {len(hidden)} ponds are"
        source.notes.add(f"In the map program {ponds} hidden; taken all the same, because the file has no other pond.")
    elif hidden:
        told.ponds = [feature for feature in told.ponds if not feature.is_hidden]
        are, them = ("it is", "it") if len(hidden) == 1 else ("they are", "them")
        why = f"{are} hidden in the map program (to sample {them}, tick {them} there and save the map again)"
        source.notes.add(left_out_note(why, hidden))
    if any(not feature.is_hidden for feature in told.depots):
        unused = [feature for feature in told.depots if feature.is_hidden]
        told.depots = [feature for feature in told.depots if not feature.is_hidden]
        if unused:
            source.notes.add(left_out_note("another depot is the one that can be seen in the map program", unused))
    areas = [feature for feature in (*told.no_fly, *told.fences) if feature.is_hidden]
    if areas:
        names = listed(feature.told() for feature in areas)
        source.notes.add(f"Hidden in the map program and kept all the same, because drones must know of them: {names}.")


def _with_neighbours(judged: Sequence[tuple[Feature, Verdict]]) -> list[tuple[Feature, Verdict]]:
    """What each feature is, in doubt where only its neighbours in the file say so.

    Where a folder is named for ponds, what lies in another folder and says nothing of itself may be anything. And
    three or more houses with numbers may be those that hold tanks.
    """
    of_ponds = {feature.folders for feature, verdict in judged if _lies_in_ponds(feature, verdict)}
    pond_stems = {name_stem(feature.name) for feature, verdict in judged if _lies_in_ponds(feature, verdict)} - {None}
    roofed = Counter(name_stem(feature.name) for feature, verdict in judged if _is_numbered_house(feature, verdict))
    told = []
    for feature, verdict in judged:
        is_silent = verdict == Verdict(None) and not _is_declared(feature) and bool(feature.folders) and bool(of_ponds)
        stem = name_stem(feature.name)
        if is_silent and stem not in pond_stems:
            because = f"it lies in {feature.folders[-1]!r}, and ponds in {next(iter(of_ponds))[-1]!r}"
            verdict = Verdict(None, because, feature.name, is_doubtful=True)
        elif _is_numbered_house(feature, verdict) and roofed[stem] >= MIN_HOUSES:
            because = f"it is called {feature.name!r}, as {roofed[stem] - 1} others are but for the number"
            verdict = Verdict(None, because, feature.name, is_doubtful=True)
        told.append((feature, verdict))
    return told


def _lies_in_ponds(feature: Feature, verdict: Verdict) -> bool:
    """Whether a folder says that a feature is a pond."""
    return verdict.meaning is Meaning.POND and bool(feature.folders) and verdict.text in feature.folders


def _is_numbered_house(feature: Feature, verdict: Verdict) -> bool:
    """Whether an outline was left out by a numbered name of a building that may hold tanks."""
    is_left_out = verdict.meaning in {Meaning.OTHER, Meaning.START} and verdict.text == feature.name
    words = set(plain_words(feature.name))
    return (
        is_left_out
        and not verdict.is_explicit
        and _is_closed(feature)
        and name_stem(feature.name) is not None
        and any(word in words or (" " in word and word in feature.name.casefold()) for word in roofed_words())
    )


def _with_series(judged: Sequence[tuple[Feature, Verdict]], source: Source) -> list[tuple[Feature, Verdict]]:
    """What each feature is, where numbered points of one word such as station may be the ponds.

    Who measures at points calls them Station 1, Station 2, ...; one Station beside ponds is where drones charge. They
    are ponds where nothing else may be one, and none where something else surely is. In between they are in doubt, all
    in one fault, unless they are stations by their word and fewer than the other points. Hidden ponds are ponds.
    """
    rivals = [(feature, verdict) for feature, verdict in judged if _may_be_pond(verdict)]
    if any(_is_surely_pond(feature, verdict) for feature, verdict in rivals):
        return list(judged)
    num_rivals = sum(_is_point(feature) for feature, _ in rivals)
    series = _series_to_judge(judged, rivals)
    if num_rivals == 0 and len(series) == 1:
        [(word, members)] = series.items()
        seen = [feature for feature, _ in members if not feature.is_hidden] or [feature for feature, _ in members]
        source.notes.add(
            f"{len(seen)} points with the word {word!r} are taken as ponds, because no other feature is one: "
            f"{listed(feature.told() for feature in seen)}. A station of the drones has the role station."
        )
        places = {feature.place for feature, _ in members}
        return [(feature, Verdict(Meaning.POND) if feature.place in places else verdict) for feature, verdict in judged]
    asked: set[str] = set()
    for word, members in series.items():
        if len(members) < num_rivals and all(verdict.meaning is Meaning.STATION for _, verdict in members):
            continue
        asked.update(feature.place for feature, _ in members)
        names = listed(feature.told() for feature, _ in members)
        message = (
            f"are these ponds? {len(members)} points with the word {word!r} beside others that may be ponds: {names}"
        )
        action = "say so in a property role of each: pond, station or other; or rename the ponds, as in 'Pond 7'"
        source.faults.append(Fault(members[0][0].place, message, action))
    return [(feature, verdict) for feature, verdict in judged if feature.place not in asked]


def _series_to_judge(
    judged: Sequence[tuple[Feature, Verdict]], rivals: Sequence[tuple[Feature, Verdict]]
) -> dict[str, list[tuple[Feature, Verdict]]]:
    """Points that may be series of sampling points, by their words; none hidden as a whole while others are seen."""
    series: dict[str, list[tuple[Feature, Verdict]]] = {}
    for feature, verdict in judged:
        word = _series_word(feature, verdict)
        if word is not None:
            series.setdefault(word, []).append((feature, verdict))
    series = {word: members for word, members in series.items() if len(members) >= MIN_SERIES}
    seen = {word: members for word, members in series.items() if any(not feature.is_hidden for feature, _ in members)}
    is_all_hidden = not seen and all(feature.is_hidden for feature, _ in rivals)
    return series if is_all_hidden else seen


def _is_surely_pond(feature: Feature, verdict: Verdict) -> bool:
    """Whether something that may be a pond is one beyond doubt, or is drawn as only ponds are."""
    is_named = verdict.meaning is Meaning.POND or Meaning.SAMPLING in meanings(feature.name)
    return is_named or _is_closed(feature) or _is_declared(feature)


def _with_remarks(feature: Feature, verdict: Verdict) -> Verdict:
    """What a feature is, in doubt where it may be a pond and a remark says that nobody flies or samples there."""
    if verdict.is_explicit or not _may_be_pond(verdict):
        return verdict
    for key in present_columns(tuple(feature.properties), REMARK_COLUMNS):
        value = feature.properties[key]
        remark = _without_tags(value) if isinstance(value, str) else ""
        if keeps_drones_out(remark) or is_out_of_use(remark):
            return Verdict(None, f"its {key} is {shortened(clean_text(remark), 60)!r}", is_doubtful=True)
    return verdict


def _without_tags(text: str) -> str:
    """A remark without the HTML in which map programs wrap it; what stands in lines of its own stays apart."""
    lines = re.sub(r"<\s*/?\s*(?:br|p|tr|div|li|table|h\d)\b[^>]*>", "\n", text, flags=re.IGNORECASE)
    return re.sub(r"<[^>]*>", " ", lines).strip()


def _may_be_pond(verdict: Verdict) -> bool:
    return verdict.is_doubtful or verdict.meaning in {None, Meaning.POND, Meaning.UNCERTAIN}


def _series_word(feature: Feature, verdict: Verdict) -> str | None:
    """The word by which a point may be one of a series of sampling points."""
    if verdict.is_explicit or not _is_point(feature) or _may_be_pond(verdict):
        return None
    series = series_of(verdict.text)
    if series is None:
        return None
    word, others = series
    is_code = bool(others) and all(len(other) <= MAX_CODE_LETTERS or other in pond_like_words() for other in others)
    is_numbered = any(letter.isdigit() for letter in feature.name)
    return word if is_numbered or is_code or verdict.text != feature.name else None


def are_numbered_stations(stations: Sequence[Feature]) -> bool:
    """Whether some places that were taken as stations are called as sampling points often are."""
    return any(series_of(feature.name) and any(map(str.isdigit, feature.name)) for feature in stations)


def no_pond_fault(told: Sorted) -> Fault:
    """The fault that no feature is a pond: what each one was taken for, and the word that says so."""
    groups: dict[tuple[str, str], list[Feature]] = {}
    for feature, verdict in told.others:
        if verdict.meaning is not None:
            word = "its role" if verdict.is_explicit else f"the word {word_for(verdict.text, verdict.meaning)!r}"
            groups.setdefault((_TAKEN_FOR[verdict.meaning], word), []).append(feature)
    reasons = [
        f"{counted(len(features), 'feature')} taken for {what} by {word}: "
        f"{listed(map(_told_with_id, features), MAX_TOLD)}"
        for (what, word), features in groups.items()
    ]
    held = f": {'; '.join(reasons)}" if reasons else ""
    action = "give what is a pond the role pond, or a name such as 'Pond 7'"
    if not reasons:
        action = "add the ponds as polygons or points"
    return Fault("file", f"there is no pond in this file{held}", action)


def _told_with_id(feature: Feature) -> str:
    """The name, id and place of a feature, for messages."""
    found = feature.find("id")
    own_id = clean_text(text_of(found[1])) if found else feature.own_id or ""
    if not own_id or own_id == feature.name:
        return feature.told()
    named = f"{shortened(feature.name)!r} " if feature.name else ""
    return f"{named}(id {shortened(own_id)}, {feature.place})"


def _file(
    feature: Feature,
    verdict: Verdict,
    told: Sorted,
    left_out: dict[Meaning, list[tuple[Feature, Verdict]]],
    source: Source,
) -> None:
    meaning = verdict.meaning
    if not _may_be_pond(verdict):
        told.others.append((feature, verdict))
    if meaning in {Meaning.OTHER, Meaning.BOUNDARY}:
        if not verdict.is_explicit:
            left_out[meaning].append((feature, verdict))
        return
    lists = {
        Meaning.DEPOT: told.depots,
        Meaning.START: told.starts,
        Meaning.STATION: told.stations,
        Meaning.NO_FLY: told.no_fly,
        Meaning.FENCE: told.fences,
    }
    if meaning is Meaning.START and (feature.geometry.polygons or feature.geometry.lines):
        left_out[Meaning.OTHER].append((feature, verdict))
        return
    if meaning is Meaning.FENCE and not verdict.is_explicit and not _is_closed(feature):
        left_out[Meaning.BOUNDARY].append((feature, verdict))
        return
    if meaning in lists:
        lists[meaning].append(feature)
        if not verdict.is_explicit:
            told.guessed.add(feature.place)
            if meaning is not Meaning.START:
                sentence = f"{feature.place}: taken as {meaning.value}, because {verdict.because}."
                source.notes.add(sentence, kind=f"taken as {meaning.value}")
    else:
        told.ponds.append(feature)
        if meaning is Meaning.POND or _is_declared(feature):
            told.sure.add(feature.place)
    told.has_depot_feature |= meaning is Meaning.DEPOT


def _tell_left_out(
    left_out: dict[Meaning, list[tuple[Feature, Verdict]]],
    told: Sorted,
    doubtful: list[tuple[Feature, str]],
    source: Source,
) -> None:
    """Note what was left out and what says so; where that is most of the outlines, their names mean something else."""
    # Where all ponds are points, outlines are what lies beside them.
    num_outlines = sum(bool(feature.geometry.polygons) for feature in told.ponds) or len(told.ponds)
    for meaning, judged in left_out.items():
        outlines = [
            feature for feature, verdict in judged if feature.geometry.polygons and feature.name == verdict.text
        ]
        is_most = 0 < num_outlines < len(outlines) and len(outlines) > 1
        asked: set[str] = set()
        if is_most and not any(feature.folders for feature in outlines):
            doubtful.extend((feature, f"it is called {feature.name!r}") for feature in outlines)
            asked = {feature.place for feature in outlines}
        groups: dict[str, list[Feature]] = {}
        for feature, verdict in judged:
            if feature.place not in asked:
                because = "" if feature.name == verdict.text else verdict.because
                groups.setdefault(because, []).append(feature)
        hint = "" if meaning is Meaning.OTHER else " To keep the drones inside, give it the role fence."
        for because, features in groups.items():
            why = _why_left_out(meaning, because, is_one=len(features) == 1)
            source.notes.add(
                f"{left_out_note(why, features)}{hint}", kind=f"left out as {meaning}" if because else None
            )


def _why_left_out(meaning: Meaning, because: str, *, is_one: bool) -> str:
    """Why things were left out: by their names, or by what else says so, as in ``it lies in 'Houses'``."""
    if meaning is Meaning.OTHER:
        what = "it is no pond" if is_one else "they are no ponds"
        by_name = " by its name" if is_one else " by their names"
    else:
        what, by_name = ("it bounds land, not water" if is_one else "they bound land, not water"), ""
    if not because:
        return f"{what}{by_name}"
    if not is_one:
        for one, many in (("it lies in ", "they lie in "), ("it has ", "they have "), ("its ", "their ")):
            if because.startswith(one):
                because = f"{many}{because.removeprefix(one)}"
    return f"{because}, so {what}"


def _is_declared(feature: Feature) -> bool:
    """Whether someone filled in what only ponds have: a column for ponds, or an id where there is no name."""
    if feature.find(*_DECLARING_COLUMNS):
        return True
    own = feature.own_id or ""
    return not feature.name and (feature.find("id") is not None or (bool(own) and "/" not in own))


def _is_closed(feature: Feature) -> bool:
    return bool(feature.geometry.polygons) or any(map(closed_line, feature.geometry.lines))


_EXPLICIT = {
    "pond": Meaning.POND,
    "depot": Meaning.DEPOT,
    "station": Meaning.STATION,
    "nofly": Meaning.NO_FLY,
    "fence": Meaning.FENCE,
    "other": Meaning.OTHER,
}


@dataclass(frozen=True)
class _KindColumns:
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


def _kind_columns(features: Sequence[Feature]) -> _KindColumns:
    """Columns of any heading whose few values are words for ponds and other things, and those that may be such."""
    known = {*map(normal_name, (*KIND_COLUMNS, *ROLE_COLUMNS, *REMARK_COLUMNS, *NAME_COLUMNS)), *POND_COLUMNS}
    values: dict[str, set[str]] = {}
    for feature in features:
        for key, value in feature.properties.items():
            name = normal_name(key)
            if name in known or key in OSM_KEYS or is_blank(value):
                continue
            held = values.setdefault(name, set())
            if len(held) <= MAX_KINDS:
                held.add(value if isinstance(value, str) else "")
    telling = set()
    for name, held in values.items():
        said = set(map(_kind_said, held))
        if len(held) <= MAX_KINDS and None not in said and Meaning.POND in said and len(said) > 1:
            telling.add(name)
    layers = values.keys() & _LAYER_COLUMNS
    return _KindColumns(sure=frozenset(telling & layers), doubtful=frozenset(telling ^ layers))


def _verdict(feature: Feature, has_layers: bool, kinds: _KindColumns, source: Source) -> Verdict | None:
    found = feature.find(*ROLE_COLUMNS)
    if found is not None:
        return _explicit(feature, *found, source)
    name = feature.name
    first, said = None, ""
    if name and not is_unnamed(name):
        first, said = _decided(name, is_line=_is_line(feature)), f"it is called {name!r}"
        if first is None and Meaning.SAMPLING in meanings(name):
            return Verdict(None)
    hints = list(_hints(feature, has_layers, kinds))
    second, hinted, text = next((hint for hint in hints if hint[0] is not None), (None, "", ""))
    if first is Meaning.POND:
        if Meaning.NO_FLY in meanings(name) or second is Meaning.NO_FLY:
            because = said if second is not Meaning.NO_FLY else f"{said}, but {hinted}"
            return Verdict(None, because, name, is_doubtful=True)
        is_something_at_pond = _is_point(feature) and bool({Meaning.OTHER, Meaning.START} & meanings(name))
        if is_something_at_pond or thing_named_for_pond(name) is not None or Meaning.UNUSED in meanings(name):
            return Verdict(None, said, name, is_doubtful=True)
        return Verdict(first, said, name)
    if first is None and name and Meaning.UNUSED in meanings(name):
        return Verdict(None, said, name, is_doubtful=True)
    if first is Meaning.UNCERTAIN and second is None:
        return Verdict(first, said, name)
    if first is None or first is Meaning.UNCERTAIN:
        doubt = _doubt_by_layer(feature, kinds) if second in {None, Meaning.UNCERTAIN} else None
        return doubt or Verdict(second, hinted, text)
    if feature.find(*_DECLARING_COLUMNS) and series_of(name) is not None:
        return Verdict(Meaning.POND, said, name)
    return Verdict(first, said, name)


def _doubt_by_layer(feature: Feature, kinds: _KindColumns) -> Verdict | None:
    """The doubt about a feature of which only its layer or use says that it is no pond."""
    if feature.find(*_DECLARING_COLUMNS):
        return None
    for key, value in feature.properties.items():
        if normal_name(key) not in kinds.doubtful or not isinstance(value, str):
            continue
        if _kind_said(value) not in {None, Meaning.POND, Meaning.UNCERTAIN}:
            return Verdict(None, f"its {key} is {shortened(value, 40)!r}", is_doubtful=True)
    return None


def _explicit(feature: Feature, key: str, value: object, source: Source) -> Verdict | None:
    meaning = _EXPLICIT.get(normal_name(str(value))) or _decided(str(value), is_line=False)
    if meaning is Meaning.START:
        meaning = Meaning.DEPOT
    if meaning is None or meaning is Meaning.UNCERTAIN:
        roles = {normal_name(role): role for role in ROLES}
        close = difflib.get_close_matches(normal_name(str(value)), roles, n=1)
        hint = f"did you mean {roles[close[0]]!r}?" if close else f"use one of {', '.join(ROLES)}"
        source.faults.append(Fault(feature.property_place.format(key), f"{str(value)[:40]!r} is no role", hint))
        return None
    return Verdict(meaning, is_explicit=True)


def _is_point(feature: Feature) -> bool:
    return bool(feature.geometry.points) and not feature.geometry.polygons and not feature.geometry.lines


def _is_line(feature: Feature) -> bool:
    return bool(feature.geometry.lines) and not feature.geometry.polygons


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


def _decided(text: str, *, is_line: bool) -> Meaning | None:
    found = meanings(text)
    decided = next((meaning for meaning in _ORDER if meaning in found), None)
    if Meaning.SAMPLING in found and series_of(text) is not None:
        # A station where samples are taken is none of the drones.
        return None
    if decided is Meaning.OTHER and Meaning.DEPOT in found:
        return Meaning.START
    return Meaning.OTHER if is_line and decided in {Meaning.START, Meaning.STATION} else decided


def _kind_said(value: str) -> Meaning | None:
    """What the value of a column of kinds says, in anybody's words or in those of OpenStreetMap."""
    decided = _decided(value, is_line=False)
    return decided if decided is not None else _meanings_of_tag_values().get(value.strip().casefold().replace(" ", "_"))


@cache
def _meanings_of_tag_values() -> dict[str, Meaning]:
    """Values of tags of OpenStreetMap that say the same with every key."""
    said: dict[str, set[str]] = {}
    for (_, value), meaning in tag_meanings().items():
        said.setdefault(value, set()).add(meaning)
    return {value: Meaning[meaning.upper()] for value, [meaning, *others] in said.items() if not others}


def _hints(feature: Feature, has_layers: bool, kinds: _KindColumns) -> Iterator[tuple[Meaning | None, str, str]]:
    """What kinds, map tags, folders and styles say, the nearest to the feature first, with the text of each."""
    called = present_columns(tuple(feature.properties), KIND_COLUMNS)
    for key in (*called, *(key for key in feature.properties if normal_name(key) in kinds.sure)):
        value = feature.properties[key]
        if isinstance(value, str) and not is_blank(value):
            yield _kind_said(value), f"its {key} is {value[:40]!r}", value
    yield from _tags(feature)
    for folder in reversed(feature.folders):
        meaning = _decided(folder, is_line=False)
        # The only layer of a file holds the ponds, whatever it is called, unless that is something to keep out of.
        if has_layers or meaning in {Meaning.NO_FLY, Meaning.FENCE, Meaning.BOUNDARY}:
            yield (None if meaning is Meaning.UNCERTAIN else meaning), f"it lies in {folder!r}", folder
    if feature.style:
        meaning = _decided(feature.style, is_line=False)
        told = f"its style is {feature.style[:40]!r}"
        yield (meaning if meaning in {Meaning.NO_FLY, Meaning.FENCE} else None), told, feature.style


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
