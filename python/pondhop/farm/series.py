"""What features are by their neighbours in the file: numbered series, and folders beside those of ponds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Source, listed
from pondhop.farm.verdicts import Verdict, is_closed, is_declared, is_point, may_be_pond
from pondhop.farm.vocabulary import pond_like_words, roofed_words
from pondhop.farm.words import Meaning, meanings, name_stem, plain_words, series_of

MIN_HOUSES = 3
"""Houses with numbers that may be those of tanks; one or two are where people live."""

MIN_SERIES = 2
"""Numbered points of one word such as station that make a series."""

MAX_CODE_LETTERS = 2
"""Letters that count as a number: Station A, Station NE."""


def with_neighbours(judged: Sequence[tuple[Feature, Verdict]]) -> list[tuple[Feature, Verdict]]:
    """What each feature is, in doubt where only its neighbours in the file say so.

    Where a folder is named for ponds, what lies in another folder and says nothing of itself may be anything. And
    three or more houses with numbers may be those that hold tanks.
    """
    of_ponds = [feature.folders[-1] for feature, verdict in judged if _lies_in_ponds(feature, verdict)]
    pond_stems = {name_stem(feature.name) for feature, verdict in judged if _lies_in_ponds(feature, verdict)} - {None}
    roofed = Counter(name_stem(feature.name) for feature, verdict in judged if _is_numbered_house(feature, verdict))
    told = []
    for feature, verdict in judged:
        is_silent = verdict == Verdict(None) and not is_declared(feature) and bool(feature.folders) and bool(of_ponds)
        stem = name_stem(feature.name)
        if is_silent and stem not in pond_stems:
            because = f"it lies in {feature.folders[-1]!r}, and ponds in {of_ponds[0]!r}"
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
        and is_closed(feature)
        and name_stem(feature.name) is not None
        and any(word in words or (" " in word and word in feature.name.casefold()) for word in roofed_words())
    )


def with_series(judged: Sequence[tuple[Feature, Verdict]], source: Source) -> list[tuple[Feature, Verdict]]:
    """What each feature is, where numbered points of one word such as station may be the ponds.

    Who measures at points calls them Station 1, Station 2, ...; one Station beside ponds is where drones charge. They
    are ponds where nothing else may be one, and none where something else surely is. In between they are in doubt, all
    in one fault, unless they are stations by their word and fewer than the other points. Hidden ponds are ponds.
    """
    rivals = [(feature, verdict) for feature, verdict in judged if may_be_pond(verdict)]
    if any(_is_surely_pond(feature, verdict) for feature, verdict in rivals):
        return list(judged)
    num_rivals = sum(is_point(feature) for feature, _ in rivals)
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
    return is_named or is_closed(feature) or is_declared(feature)


def _series_word(feature: Feature, verdict: Verdict) -> str | None:
    """The word by which a point may be one of a series of sampling points."""
    if verdict.is_explicit or not is_point(feature) or may_be_pond(verdict):
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
