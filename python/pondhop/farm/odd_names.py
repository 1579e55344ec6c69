"""Ponds that are not called like all others of their farm: no list of words ends, but farms name ponds by a pattern."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

from pondhop.farm.features import listed, shortened
from pondhop.farm.model import Doubt
from pondhop.farm.ponds import Draft
from pondhop.farm.words import Meaning, is_ordinary, meanings

MIN_NUMBERED = 4
"""Ponds of one word and a number that make a pattern."""

MIN_WORDED = 5
"""Ponds with a word for ponds in their names that make a pattern."""

MAX_ODD_SHARE = 1.0 / 3.0
"""Of those that follow the pattern may be as many others for them to be odd; more are names of another kind."""

MIN_OTHER_SERIES = 3
"""Names of another word and a number that are a series of their own."""


def odd_names(drafts: Sequence[Draft], sure: set[str]) -> list[Doubt]:
    """Doubts about the few ponds that are not called like the others: one may be a house, or an area to keep out of.

    Parameters
    ----------
    drafts
        All ponds of the file, named.
    sure
        Places of the features that are ponds by their role, kind, folder or columns, whatever they are called.
    """
    first_of = {id(draft.feature): draft for draft in reversed(drafts)}
    firsts = [first_of[key] for key in dict.fromkeys(id(draft.feature) for draft in drafts)]
    names = [draft.feature.name or draft.id for draft in firsts]
    stems = [_stem(name) for name in names]
    counts = Counter(stem for stem in stems if stem is not None)
    stem, num_numbered = counts.most_common(1)[0] if counts else (None, 0)
    is_worded = [Meaning.POND in meanings(name) for name in names]
    if num_numbered < MIN_NUMBERED and sum(is_worded) < MIN_WORDED:
        return []
    follows = [
        has_word or (num_numbered >= MIN_NUMBERED and own == stem)
        for has_word, own in zip(is_worded, stems, strict=True)
    ]
    odd = [
        draft
        for draft, name, own, fits in zip(firsts, names, stems, follows, strict=True)
        if not fits
        and draft.feature.place not in sure
        and (own is None or counts[own] < MIN_OTHER_SERIES)
        and draft.feature.name
        and not is_ordinary(name)
    ]
    if len(odd) > max(1, int(MAX_ODD_SHARE * sum(follows))):
        return []
    others = listed((repr(shortened(name)) for name, fits in zip(names, follows, strict=True) if fits), 2)
    odd_features = {id(draft.feature) for draft in odd}
    return [
        Doubt(
            draft.id,
            f"{draft.feature.place}: is {shortened(draft.feature.name)!r} a pond? The others are called {others}",
        )
        for draft in drafts
        if id(draft.feature) in odd_features
    ]


def _stem(name: str) -> str | None:
    """What a name with a number has in common with others of its series; ``None`` without a number."""
    plain = re.sub(r"[\W_]+", "", name.casefold())
    stem, count = re.subn(r"(?:no|nr|num)?\d+[a-z]?(?![a-z])", "#", plain)
    return re.sub(r"[号號番#]+$", "#", stem) if count else None
