"""What one feature is by all that its file says of it: role, name, kind, folder and remarks.

A property ``role`` always wins. Else names, kinds, folders and styles are read, in this order, for words that tell.
"""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Source, clean_text, normal_name, present_columns, shortened
from pondhop.farm.kinds import (
    DECLARING_COLUMNS,
    REMARK_COLUMNS,
    ROLE_COLUMNS,
    ROLES,
    KindColumns,
    decided,
    hints,
    kind_said,
)
from pondhop.farm.shapes import closed_line
from pondhop.farm.words import (
    Meaning,
    is_out_of_use,
    is_unnamed,
    keeps_drones_out,
    meanings,
    series_of,
    thing_named_for_pond,
)

_EXPLICIT = {
    "pond": Meaning.POND,
    "depot": Meaning.DEPOT,
    "station": Meaning.STATION,
    "nofly": Meaning.NO_FLY,
    "fence": Meaning.FENCE,
    "other": Meaning.OTHER,
}


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


def verdict_of(feature: Feature, has_layers: bool, kinds: KindColumns, source: Source) -> Verdict | None:
    """What a feature is by all that is said of it; ``None`` with a fault where its role is none."""
    found = feature.find(*ROLE_COLUMNS)
    if found is not None:
        return _explicit(feature, *found, source)
    name = feature.name
    first, said = None, ""
    if name and not is_unnamed(name):
        first, said = decided(name, is_line=_is_line(feature)), f"it is called {name!r}"
        if first is None and Meaning.SAMPLING in meanings(name):
            return Verdict(None)
    given = list(hints(feature, has_layers, kinds))
    second, hinted, text = next((hint for hint in given if hint[0] is not None), (None, "", ""))
    if first is Meaning.POND:
        if Meaning.NO_FLY in meanings(name) or second is Meaning.NO_FLY:
            because = said if second is not Meaning.NO_FLY else f"{said}, but {hinted}"
            return Verdict(None, because, name, is_doubtful=True)
        is_something_at_pond = is_point(feature) and bool({Meaning.OTHER, Meaning.START} & meanings(name))
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
    if feature.find(*DECLARING_COLUMNS) and series_of(name) is not None:
        return Verdict(Meaning.POND, said, name)
    return Verdict(first, said, name)


def _doubt_by_layer(feature: Feature, kinds: KindColumns) -> Verdict | None:
    """The doubt about a feature of which only its layer or use says that it is no pond."""
    if not kinds.doubtful or feature.find(*DECLARING_COLUMNS):
        return None
    for key, value in feature.properties.items():
        if normal_name(key) not in kinds.doubtful or not isinstance(value, str):
            continue
        if kind_said(value) not in {None, Meaning.POND, Meaning.UNCERTAIN}:
            return Verdict(None, f"its {key} is {shortened(value, 40)!r}", is_doubtful=True)
    return None


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


def with_remarks(feature: Feature, verdict: Verdict) -> Verdict:
    """What a feature is, in doubt where it may be a pond and a remark says that nobody flies or samples there."""
    if verdict.is_explicit or not may_be_pond(verdict):
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


def may_be_pond(verdict: Verdict) -> bool:
    """Whether something is a pond, or nobody says that it is none."""
    return verdict.is_doubtful or verdict.meaning in {None, Meaning.POND, Meaning.UNCERTAIN}


def is_declared(feature: Feature) -> bool:
    """Whether someone filled in what only ponds have: a column for ponds, or an id where there is no name."""
    if feature.find(*DECLARING_COLUMNS):
        return True
    own = feature.own_id or ""
    return not feature.name and (feature.find("id") is not None or (bool(own) and "/" not in own))


def is_closed(feature: Feature) -> bool:
    """Whether a feature is drawn as an outline, be it a line that ends where it began."""
    return bool(feature.geometry.polygons) or any(map(closed_line, feature.geometry.lines))


def is_point(feature: Feature) -> bool:
    """Whether a feature is drawn as a point and nothing else."""
    return bool(feature.geometry.points) and not feature.geometry.polygons and not feature.geometry.lines


def _is_line(feature: Feature) -> bool:
    return bool(feature.geometry.lines) and not feature.geometry.polygons
