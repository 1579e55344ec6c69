"""Faults as they are told: each with the name of its feature, and what repeats itself once, with a count."""

from __future__ import annotations

import re
from collections.abc import Sequence

from pondhop.errors import Fault
from pondhop.farm.features import MAX_ALIKE, Feature, clean_text, listed, shortened

MAX_FAULTS = 200
"""Faults that are listed one by one; more are counted."""


def told_faults(faults: Sequence[Fault], features: Sequence[Feature]) -> list[Fault]:
    """The faults for people to read: with names, those alike counted, and not too many."""
    names = {feature.place: feature.name for feature in features}
    kinds: dict[tuple[str, str], list[Fault]] = {}
    for fault in faults:
        kinds.setdefault(_kind(fault), []).append(fault)
    told: list[Fault] = []
    for alike in kinds.values():
        if len(alike) <= MAX_ALIKE:
            told.extend(_named(fault, names) for fault in alike)
        else:
            first = _named(alike[0], names)
            others = listed((_place_with_name(fault.path, names) for fault in alike[1:]), 3)
            told.append(Fault(first.path, f"{first.message}; {len(alike) - 1} more alike: {others}", first.action))
    if len(told) <= MAX_FAULTS:
        return told
    hidden = len(told) - MAX_FAULTS
    return [*told[:MAX_FAULTS], Fault("file", f"{hidden} more faults", "correct the ones above first")]


def _kind(fault: Fault) -> tuple[str, str]:
    """What faults that say the same of different features have in common: all but numbers and quoted text."""
    return _plain(fault.message), _plain(fault.action)


def _plain(text: str) -> str:
    return re.sub(r"'[^']*'|\"[^\"]*\"|[\w.\[\]]*\d[\w.\[\]]*", "#", text)


def _name_of(path: str, names: dict[str, str]) -> str:
    """The name of the feature in which a place lies, as ``features[3].geometry`` lies in ``features[3]``."""
    if path in names:
        return names[path]
    for end in sorted((match.start() for match in re.finditer(r"[.,:]", path)), reverse=True):
        if path[:end] in names:
            return names[path[:end]]
    return ""


def _named(fault: Fault, names: dict[str, str]) -> Fault:
    name = _name_of(fault.path, names)
    message = fault.message
    if name and name not in message:
        message = f"{shortened(name)!r}: {message}"
    return Fault(clean_text(fault.path), clean_text(message), clean_text(fault.action))


def _place_with_name(path: str, names: dict[str, str]) -> str:
    name = _name_of(path, names)
    return f"{path} {shortened(name)!r}" if name else path
