"""Faults as they are told: each with the name of its feature, and what repeats itself once, with a count."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from pondhop.errors import Fault
from pondhop.farm.features import MAX_ALIKE, Feature, clean_text, listed, shortened, text_of

MAX_FAULTS = 200
"""Faults that are listed one by one; more are counted."""


def told_faults(faults: Sequence[Fault], features: Sequence[Feature]) -> list[Fault]:
    """The faults for people to read: with names, those alike counted, and not too many."""
    named = {feature.place: feature for feature in features}
    kinds: dict[tuple[str, str], list[Fault]] = {}
    for fault in faults:
        kinds.setdefault(_kind(fault), []).append(fault)
    told: list[Fault] = []
    for alike in kinds.values():
        if len(alike) <= MAX_ALIKE:
            told.extend(_named(fault, named) for fault in alike)
        else:
            first = _named(alike[0], named)
            others = listed((_place_with_name(fault.path, named) for fault in alike[1:]), 3)
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


def _feature_at(path: str, features: Mapping[str, Feature]) -> Feature | None:
    """The feature in which a place lies, as ``features[3].geometry`` lies in ``features[3]``."""
    if path in features:
        return features[path]
    for end in sorted((match.start() for match in re.finditer(r"[.,:]", path)), reverse=True):
        if path[:end] in features:
            return features[path[:end]]
    return None


def _called(feature: Feature | None) -> str:
    """What a feature is called and its id, if they differ; empty if it has neither."""
    if feature is None or not (feature.name or feature.id):
        return ""
    found = feature.find("id")
    own_id = shortened(clean_text(text_of(found[1]))) if found and feature.name else ""
    name = shortened(feature.name or feature.id)
    return f"{name!r} (id {own_id})" if own_id not in {"", name} else repr(name)


def _named(fault: Fault, features: Mapping[str, Feature]) -> Fault:
    feature = _feature_at(fault.path, features)
    message, called = fault.message, _called(feature)
    if feature is not None and called and (feature.name or feature.id) not in message:
        message = f"{called}: {message}"
    return Fault(clean_text(fault.path), clean_text(message), clean_text(fault.action))


def _place_with_name(path: str, features: Mapping[str, Feature]) -> str:
    called = _called(_feature_at(path, features))
    return f"{path} {called}" if called else path
