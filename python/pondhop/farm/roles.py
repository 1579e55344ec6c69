"""What each feature of a file is: a pond, the depot, an area to keep out of, or a thing that is none of these.

A property ``role`` always wins. Else names, kinds, folders and styles are read, in this order, for words that tell.
In doubt a feature is a fault that names it: a pond too few is told, a building too many would be flown to.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from pondhop.errors import Fault
from pondhop.farm.features import (
    Feature,
    Source,
    left_out_note,
    listed,
    normal_name,
    shortened,
)
from pondhop.farm.hints import ROLE_COLUMNS, Hint, Surroundings, decided, hint_of, surroundings_of
from pondhop.farm.remarks import remark_against
from pondhop.farm.series import doubtful_series
from pondhop.farm.shapes import closed_line
from pondhop.farm.vocabulary import pond_like_words
from pondhop.farm.words import (
    Meaning,
    is_unnamed,
    meanings,
    series_of,
    thing_named_for_pond,
    word_for,
)
from pondhop.units import counted

ROLES = ("pond", "depot", "station", "no_fly", "fence", "other")
"""What a feature can be, in the property ``role``; the first is the default."""

_DECLARING_COLUMNS = (
    "service_s",
    "time_windows",
    "sampling_point",
    "pond_id",
    "pond",
    "pond_name",
    "pond_no",
    "pond_number",
)

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
    around = surroundings_of(source.features)
    verdicts = [(feature, _verdict(feature, around, source)) for feature in features]
    judged = [(feature, verdict) for feature, verdict in verdicts if verdict is not None]
    for feature, by_name in _with_series(_without_doubtful_series(judged, around, source), source):
        verdict = _with_remarks(feature, by_name)
        if verdict.is_doubtful or (verdict.meaning is Meaning.UNCERTAIN and not feature.find(*_DECLARING_COLUMNS)):
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


def _without_doubtful_series(
    judged: Sequence[tuple[Feature, Verdict]], around: Surroundings, source: Source
) -> list[tuple[Feature, Verdict]]:
    """What each feature is, without series of one word that may be ponds, which are one fault each.

    Ponds they are if their folder, or a column that only ponds have, says so; and none if anything beside their names
    says what they are. A point among outlines is not drawn as the ponds are.
    """
    rivals = [feature for feature, verdict in judged if _may_be_pond(verdict) and not feature.is_hidden]
    are_outlines = any(map(_is_closed, rivals))
    named: list[tuple[Feature, Meaning]] = []
    ponds: set[str] = set()
    for feature, verdict in judged:
        is_told_by_name = not verdict.is_explicit and not _may_be_pond(verdict) and verdict.text == feature.name
        if verdict.meaning is None or not is_told_by_name or _is_line(feature) or (are_outlines and _is_point(feature)):
            continue
        hint = hint_of(feature, around)
        if hint is None or hint.meaning in {Meaning.POND, Meaning.UNCERTAIN}:
            named.append((feature, verdict.meaning))
            if (hint and hint.meaning is Meaning.POND) or feature.find(*_DECLARING_COLUMNS):
                ponds.add(feature.place)
    asked: set[str] = set()
    for word, members in doubtful_series(named, len(rivals)).items():
        asked.update(feature.place for feature in members)
        questions = [feature for feature in members if feature.place not in ponds]
        if questions:
            names = listed(map(_told_with_id, questions), MAX_TOLD)
            message = f"are these ponds? {counted(len(questions), 'feature')} with the word {word!r}: {names}"
            action = (
                "say so in a property role of each: pond, no_fly or other; or rename them, as in 'Pond 7' or 'No fly 1'"
            )
            source.faults.append(Fault(questions[0].place, message, action))
    ponds &= asked
    return [
        (feature, Verdict(Meaning.POND) if feature.place in ponds else verdict)
        for feature, verdict in judged
        if feature.place not in asked or feature.place in ponds
    ]


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
    """What a feature is, in doubt where it may be a pond and a remark says that nobody flies there or samples it."""
    if verdict.is_explicit or not _may_be_pond(verdict):
        return verdict
    remark = remark_against(feature)
    return Verdict(None, remark, is_doubtful=True) if remark else verdict


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
    if not feature.id or feature.id == feature.name:
        return feature.told()
    named = f"{shortened(feature.name)!r} " if feature.name else ""
    return f"{named}(id {shortened(feature.id)}, {feature.place})"


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


def _verdict(feature: Feature, around: Surroundings, source: Source) -> Verdict | None:
    found = feature.find(*ROLE_COLUMNS)
    if found is not None:
        return _explicit(feature, *found, source)
    name = feature.name
    first, said = None, ""
    if name and not is_unnamed(name):
        first, said = decided(name, is_line=_is_line(feature)), f"it is called {name!r}"
        if first is None and Meaning.SAMPLING in meanings(name):
            return Verdict(None)
    hint = hint_of(feature, around)
    if first is Meaning.POND:
        return _called_a_pond(feature, said, hint)
    if first is None and name and Meaning.UNUSED in meanings(name):
        return Verdict(None, said, name, is_doubtful=True)
    if first is None or (first is Meaning.UNCERTAIN and hint and hint.meaning is not Meaning.UNCERTAIN):
        return Verdict(hint.meaning, hint.because, hint.text) if hint else Verdict(None)
    if feature.find(*_DECLARING_COLUMNS) and series_of(name) is not None:
        return Verdict(Meaning.POND, said, name)
    if first not in {Meaning.UNCERTAIN, Meaning.DEPOT} and hint and hint.is_own and Meaning.POND in meanings(hint.text):
        return Verdict(None, f"{said}, but {hint.because}", name, is_doubtful=True)
    return Verdict(first, said, name)


def _called_a_pond(feature: Feature, said: str, hint: Hint | None) -> Verdict:
    """What a feature is that has a word for ponds in its name: a pond, unless name or kind speak against it."""
    name = feature.name
    if hint and (hint.meaning is Meaning.NO_FLY or (hint.is_own and hint.meaning in {Meaning.OTHER, Meaning.BOUNDARY})):
        return Verdict(None, f"{said}, but {hint.because}", name, is_doubtful=True)
    is_something_at_pond = _is_point(feature) and bool({Meaning.OTHER, Meaning.START} & meanings(name))
    is_named_for_pond = thing_named_for_pond(name) is not None
    if is_something_at_pond or is_named_for_pond or {Meaning.NO_FLY, Meaning.UNUSED} & meanings(name):
        return Verdict(None, said, name, is_doubtful=True)
    return Verdict(Meaning.POND, said, name)


def _explicit(feature: Feature, key: str, value: object, source: Source) -> Verdict | None:
    meaning = _EXPLICIT.get(normal_name(str(value))) or decided(str(value), is_line=False)
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
