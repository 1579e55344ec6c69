"""Numbered names of one word that says "no pond", and that a farm may have for its ponds all the same.

CTR is a control zone of an airport and somebody's code for ponds; a hatchery is a building, and Hatchery 1, Hatchery 2,
... may be the ponds in it. One such name is what it says; a series of them may be either.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache

from pondhop.farm.features import Feature
from pondhop.farm.vocabulary import series_words
from pondhop.farm.words import Meaning, is_spaced, phrases_of, series_of, words_of

MIN_CODES = 2
"""Names of one code and a number that make a series."""

MIN_HOUSES = 3
"""Buildings of one word and a number that make a series, unless there are as many ponds."""

MAX_CODE_LETTERS = 3
"""A word of so few letters may be a code."""


def doubtful_series(named: Sequence[tuple[Feature, Meaning]], num_ponds: int) -> dict[str, list[Feature]]:
    """Series that may be ponds although their word says otherwise, by that word.

    Parameters
    ----------
    named
        Features that are no ponds by a word of their names, with what it says.
    num_ponds
        How many other features may be ponds.
    """
    series: dict[str, dict[str, Feature]] = {}
    meaning_of: dict[str, Meaning] = {}
    for feature, meaning in named:
        match = next(filter(None, (form.fullmatch(feature.name.strip()) for form in _NUMBERED)), None)
        if match and series_of(feature.name) is None:
            word = match["word"].strip(_SIGNS)
            series.setdefault(word.casefold(), {})[match["number"]] = feature
            meaning_of[word.casefold()] = meaning
    return {
        word: list(members.values())
        for word, members in series.items()
        if _is_doubtful(word, meaning_of[word], list(members.values()), num_ponds)
    }


_SIGNS = " _-.#:"
_NUMBERED = (
    re.compile(r"(?P<word>\D*[^\W\d_]\D*?)[\s_.#:-]*(?P<number>\d+)\s*[a-zA-Z]?[号號番]?"),
    re.compile(r"(?P<word>\D*[^\W\d_]\D*?)[\s_.#:-]+(?P<number>[a-zA-Z])"),
    re.compile(r"(?P<number>\d+)[\s_.#:-]*[号號番]?(?P<word>\D*[^\W\d_]\D*)"),
)
"""House 1, House A and 1 House, with the signs that people set between word and number."""


def _is_doubtful(word: str, meaning: Meaning, members: Sequence[Feature], num_ponds: int) -> bool:
    if _is_code(word):
        # "Lab 1" is written as a word, LAB1 as a code.
        is_word = meaning is not Meaning.NO_FLY and all(_is_written_as_word(feature.name) for feature in members)
        return len(members) >= (MIN_HOUSES if is_word else MIN_CODES)
    is_many = len(members) >= MIN_HOUSES or (len(members) >= MIN_CODES and len(members) >= num_ponds)
    return is_many and _holds_ponds(word)


def _is_code(word: str) -> bool:
    letters = [letter for letter in word if letter.isalpha()]
    return (
        len(letters) <= MAX_CODE_LETTERS and all(map(is_spaced, letters)) and word not in series_words("unmistakable")
    )


def _is_written_as_word(name: str) -> bool:
    return any(map(str.islower, name)) and re.search(r"[^\W\d_]\s+\d", name) is not None


def _holds_ponds(word: str) -> bool:
    """Whether a word is one for buildings in which there may be ponds, and nothing else."""
    found, rest = phrases_of(word)
    return bool(found) and not rest and all(_singular(phrase) in _houses() for phrase, _ in found)


@cache
def _houses() -> frozenset[str]:
    return frozenset(map(_singular, series_words("houses")))


def _singular(phrase: str) -> str:
    """A phrase in the form in which it is compared: words without their plural, signs as they are."""
    return " ".join(words_of(phrase)) if all(map(is_spaced, filter(str.isalpha, phrase))) else phrase
