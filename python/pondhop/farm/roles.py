"""What each feature of a file is: a pond, the depot, an area to keep out of, or a thing that is none of these.

A property ``role`` always wins. Else names, kinds, folders and styles are read, in this order, for words that tell.
In doubt a feature is a fault that names it: a pond too few is told, a building too many would be flown to.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Source, is_blank, listed, normal_name, present_columns
from pondhop.farm.vocabulary import column_words
from pondhop.farm.words import Meaning, is_unnamed, meanings

ROLES = ("pond", "depot", "station", "no_fly", "fence", "other")
"""What a feature can be, in the property ``role``; the first is the default."""

POND_COLUMNS = frozenset(map(normal_name, column_words("ponds")))
"""Columns that tell one pond from another."""

ROLE_COLUMNS = column_words("roles")
KIND_COLUMNS = column_words("kinds")
_DECLARING_COLUMNS = ("service_s", "sampling_point", "pond_id", "pond", "pond_name", "pond_no", "pond_number")

_OSM_OTHER = ("building", "highway", "railway", "aeroway", "power", "barrier", "man_made", "amenity")
_OSM_VALUES: dict[str, dict[str, Meaning]] = {
    "landuse": {
        **dict.fromkeys(("aquaculture", "basin", "reservoir", "pond", "salt_pond"), Meaning.POND),
        **dict.fromkeys(
            ("residential", "farmland", "farmyard", "forest", "industrial", "commercial", "meadow", "grass", "orchard"),
            Meaning.OTHER,
        ),
    },
    "natural": {
        "water": Meaning.POND,
        **dict.fromkeys(("tree", "wood", "scrub", "coastline", "wetland"), Meaning.OTHER),
    },
    "water": dict.fromkeys(("pond", "fishpond", "reservoir", "basin", "lake", "lagoon"), Meaning.POND),
    "waterway": dict.fromkeys(("river", "stream", "canal", "drain", "ditch", "dam", "weir"), Meaning.OTHER),
}

OSM_KEYS = (*_OSM_OTHER, *_OSM_VALUES)
"""Tags of OpenStreetMap that say what a feature is, not what it is called."""


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


@dataclass(frozen=True)
class _Verdict:
    """What a feature is and what says so."""

    meaning: Meaning | None
    because: str = ""
    is_explicit: bool = False
    is_doubtful: bool = False


def sort_by_role(features: Iterable[Feature], source: Source) -> Sorted:
    """Sort features by what they are; what is none of a farm's things is left out with one note for each reason."""
    told = Sorted()
    left_out: dict[Meaning, list[Feature]] = {Meaning.OTHER: [], Meaning.BOUNDARY: []}
    doubtful: list[tuple[Feature, str]] = []
    has_layers = len({feature.folders for feature in source.features}) > 1
    for feature in features:
        verdict = _verdict(feature, has_layers, source)
        if verdict is None:
            continue
        if verdict.is_doubtful or (verdict.meaning is Meaning.UNCERTAIN and not _is_declared(feature)):
            doubtful.append((feature, verdict.because))
            continue
        _file(feature, verdict, told, left_out, source)
    _tell_left_out(left_out, told, doubtful, source)
    for feature, because in doubtful:
        message = f"is this a pond? {because}"
        action = "say so in a property role: pond, no_fly, fence or other; or rename it, as in 'Pond 7' or 'No fly 1'"
        source.faults.append(Fault(feature.place, message, action))
    return told


def _file(
    feature: Feature, verdict: _Verdict, told: Sorted, left_out: dict[Meaning, list[Feature]], source: Source
) -> None:
    meaning = verdict.meaning
    if meaning in {Meaning.OTHER, Meaning.BOUNDARY}:
        if not verdict.is_explicit:
            left_out[meaning].append(feature)
        return
    lists = {
        Meaning.DEPOT: told.depots,
        Meaning.START: told.starts,
        Meaning.STATION: told.stations,
        Meaning.NO_FLY: told.no_fly,
        Meaning.FENCE: told.fences,
    }
    if meaning is Meaning.START and (feature.geometry.polygons or feature.geometry.lines):
        left_out[Meaning.OTHER].append(feature)
        return
    if meaning is Meaning.FENCE and not verdict.is_explicit and not _is_closed(feature):
        left_out[Meaning.BOUNDARY].append(feature)
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
    left_out: dict[Meaning, list[Feature]], told: Sorted, doubtful: list[tuple[Feature, str]], source: Source
) -> None:
    """Note what was left out; where that would be most of the outlines, the words mean something else here."""
    num_outlines = sum(bool(feature.geometry.polygons) for feature in told.ponds)
    for meaning, features in left_out.items():
        outlines = [feature for feature in features if feature.geometry.polygons]
        if len(outlines) > max(1, num_outlines) and not any(feature.folders for feature in outlines):
            doubtful.extend((feature, f"it is called {feature.name!r}") for feature in outlines if feature.name)
            features = [feature for feature in features if not feature.geometry.polygons or not feature.name]
        if features:
            names = listed(feature.told() for feature in features)
            what = "they are no ponds by their names" if meaning is Meaning.OTHER else "they bound land, not water"
            if len(features) == 1:
                what = "it is no pond by its name" if meaning is Meaning.OTHER else "it bounds land, not water"
            hint = "" if meaning is Meaning.OTHER else " To keep the drones inside, give it the role fence."
            source.notes.add(f"Left out, because {what}: {names}.{hint}")


def _is_declared(feature: Feature) -> bool:
    """Whether someone filled in what only ponds have: a column for ponds, or an id where there is no name."""
    if feature.find(*_DECLARING_COLUMNS):
        return True
    own = feature.own_id or ""
    return not feature.name and (feature.find("id") is not None or (bool(own) and "/" not in own))


def _is_closed(feature: Feature) -> bool:
    lines = feature.geometry.lines
    return bool(feature.geometry.polygons) or any(len(line) > 3 and line[0] == line[-1] for line in lines)


_EXPLICIT = {
    "pond": Meaning.POND,
    "depot": Meaning.DEPOT,
    "station": Meaning.STATION,
    "nofly": Meaning.NO_FLY,
    "fence": Meaning.FENCE,
    "other": Meaning.OTHER,
}


def _verdict(feature: Feature, has_layers: bool, source: Source) -> _Verdict | None:
    found = feature.find(*ROLE_COLUMNS)
    if found is not None:
        return _explicit(feature, *found, source)
    name = feature.name
    first, said = None, ""
    if name and not is_unnamed(name):
        first, said = _decided(name, is_line=_is_line(feature)), f"it is called {name!r}"
        if first is None and Meaning.SAMPLING in meanings(name):
            return _Verdict(None)
    hints = list(_hints(feature, has_layers))
    second, hinted = next(((meaning, hint) for meaning, hint in hints if meaning is not None), (None, ""))
    if first is Meaning.POND:
        if Meaning.NO_FLY in meanings(name) or second is Meaning.NO_FLY:
            return _Verdict(None, said if second is not Meaning.NO_FLY else f"{said}, but {hinted}", is_doubtful=True)
        if _is_point(feature) and {Meaning.OTHER, Meaning.START} & meanings(name):
            return _Verdict(None, said, is_doubtful=True)
        return _Verdict(first, said)
    if first is Meaning.UNCERTAIN:
        return _Verdict(second, hinted) if second is not None else _Verdict(first, said)
    if first is not None:
        return _Verdict(first, said)
    return _Verdict(second, hinted)


def _explicit(feature: Feature, key: str, value: object, source: Source) -> _Verdict | None:
    meaning = _EXPLICIT.get(normal_name(str(value))) or _decided(str(value), is_line=False)
    if meaning is Meaning.START:
        meaning = Meaning.DEPOT
    if meaning is None or meaning is Meaning.UNCERTAIN:
        roles = {normal_name(role): role for role in ROLES}
        close = difflib.get_close_matches(normal_name(str(value)), roles, n=1)
        hint = f"did you mean {roles[close[0]]!r}?" if close else f"use one of {', '.join(ROLES)}"
        source.faults.append(Fault(feature.property_place.format(key), f"{str(value)[:40]!r} is no role", hint))
        return None
    return _Verdict(meaning, is_explicit=True)


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
    if decided is Meaning.OTHER and Meaning.DEPOT in found:
        return Meaning.START
    return Meaning.OTHER if is_line and decided in {Meaning.START, Meaning.STATION} else decided


def _hints(feature: Feature, has_layers: bool) -> Iterator[tuple[Meaning | None, str]]:
    """What kinds, map tags, folders and styles say, the nearest to the feature first."""
    for key in present_columns(tuple(feature.properties), KIND_COLUMNS):
        value = feature.properties[key]
        if isinstance(value, str) and not is_blank(value):
            yield _decided(value, is_line=False), f"its {key} is {value[:40]!r}"
    yield from _tags(feature)
    for folder in reversed(feature.folders):
        meaning = _decided(folder, is_line=False)
        # The only layer of a file holds the ponds, whatever it is called, unless that is something to keep out of.
        if has_layers or meaning in {Meaning.NO_FLY, Meaning.FENCE, Meaning.BOUNDARY}:
            yield (None if meaning is Meaning.UNCERTAIN else meaning), f"it lies in {folder!r}"
    if feature.style:
        meaning = _decided(feature.style, is_line=False)
        yield (meaning if meaning in {Meaning.NO_FLY, Meaning.FENCE} else None), f"its style is {feature.style[:40]!r}"


def _tags(feature: Feature) -> Iterator[tuple[Meaning | None, str]]:
    """What the tags of OpenStreetMap say, and columns that are themselves a question: ``no_fly: yes``."""
    is_osm = any(key in feature.properties for key in ("@id", "osm_id", "osm_way_id"))
    for key, value in feature.properties.items():
        if is_blank(value) or str(value).strip().lower() in {"no", "false", "0", "none"}:
            continue
        told = f"it has {key}={str(value)[:40]}"
        if key in _OSM_OTHER and (is_osm or str(value) == "yes"):
            yield Meaning.OTHER, told
        elif key in _OSM_VALUES:
            yield _OSM_VALUES[key].get(str(value)), told
        elif str(value).strip().lower() in {"yes", "true", "1"} and meanings(key) == {Meaning.NO_FLY}:
            yield Meaning.NO_FLY, told
