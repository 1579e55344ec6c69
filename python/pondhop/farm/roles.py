"""What each feature of a file is: a pond, the depot, an area to keep out of, or a thing that is none of these.

In doubt a feature is a fault that names it: a pond too few is told, a building too many would be flown to.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Source, clean_text, left_out_note, listed, shortened, text_of
from pondhop.farm.kinds import kind_columns
from pondhop.farm.series import with_neighbours, with_series
from pondhop.farm.verdicts import Verdict, is_closed, is_declared, may_be_pond, verdict_of, with_remarks
from pondhop.farm.words import Meaning, word_for
from pondhop.units import counted

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


def sort_by_role(features: Iterable[Feature], source: Source) -> Sorted:
    """Sort features by what they are; what is none of a farm's things is left out with one note for each reason."""
    told = Sorted()
    left_out: dict[Meaning, list[tuple[Feature, Verdict]]] = {Meaning.OTHER: [], Meaning.BOUNDARY: []}
    doubtful: list[tuple[Feature, str]] = []
    has_layers = len({feature.folders for feature in source.features}) > 1
    features = list(features)
    kinds = kind_columns(features)
    verdicts = [(feature, verdict_of(feature, has_layers, kinds, source)) for feature in features]
    judged = [(feature, verdict) for feature, verdict in verdicts if verdict is not None]
    for feature, by_name in with_neighbours(with_series(judged, source)):
        verdict = with_remarks(feature, by_name)
        if verdict.is_doubtful or (verdict.meaning is Meaning.UNCERTAIN and not is_declared(feature)):
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
    if not may_be_pond(verdict):
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
    if meaning is Meaning.FENCE and not verdict.is_explicit and not is_closed(feature):
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
        if meaning is Meaning.POND or is_declared(feature):
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
