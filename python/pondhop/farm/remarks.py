"""What people write about a thing beside its name: that nobody flies there, or that there is nothing to sample."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from functools import cache, lru_cache

from pondhop.farm.features import NAME_COLUMNS, Feature, clean_text, is_blank, normal_name, shortened, text_of
from pondhop.farm.hints import KIND_COLUMNS, POND_COLUMNS, REMARK_COLUMNS, ROLE_COLUMNS
from pondhop.farm.vocabulary import column_words, remark_words
from pondhop.farm.words import Meaning, is_spaced, meanings, phrases_of, words_of

_CLAUSE_ENDS = re.compile(r"[,;.!?/|()\[\]\n\uff0c\uff1b\u3002\u3001\uff01]|\s[-\u2013\u2014]\s")

_REMARK_COLUMNS = frozenset(map(normal_name, (*REMARK_COLUMNS, *KIND_COLUMNS)))
_NO_REMARK_COLUMNS = frozenset(map(normal_name, (*NAME_COLUMNS, *ROLE_COLUMNS)))
_QUESTIONS = frozenset(map(normal_name, column_words("questions")))


def remark_against(feature: Feature) -> str:
    """The remark that speaks against sampling a feature, for messages: ``its status is 'drained'``; else blank."""
    if Meaning.NO_FLY not in meanings(feature.name) and speaks_against(feature.name, is_remark=False):
        return f"it is called {feature.name!r}"
    for column, value in feature.properties.items():
        plain = normal_name(column)
        if is_blank(value) or plain in _NO_REMARK_COLUMNS or plain == feature.name_column:
            continue
        text = _without_markup(text_of(value)) if isinstance(value, str | bool | int) else ""
        if plain in POND_COLUMNS and Meaning.NO_FLY in meanings(text):
            # An id is a name, in which CTR may be anything.
            continue
        is_answer = _is_answer_against(column, text)
        if is_answer or (isinstance(value, str) and speaks_against(text, is_remark=plain in _REMARK_COLUMNS)):
            return f"its {column} is {shortened(clean_text(text), 60)!r}"
    return ""


def _without_markup(text: str) -> str:
    """A remark without the HTML in which map programs wrap it; what stands in lines of its own stays apart."""
    if "<" not in text:
        return text
    lines = re.sub(r"<\s*/?\s*(?:br|p|tr|div|li|table|h\d)\b[^>]*>", "\n", text, flags=re.IGNORECASE)
    return re.sub(r"<[^>]*>", " ", lines).strip()


def _is_answer_against(column: str, text: str) -> bool:
    """Whether a column asks a question, and the answer is that a thing is not sampled: ``active: no``."""
    answer = text.strip().casefold()
    if answer in remark_words("no"):
        return normal_name(column) in _QUESTIONS
    return answer in remark_words("yes") and speaks_against(column, is_remark=True)


@lru_cache(maxsize=65_536)
def speaks_against(remark: str, *, is_remark: bool) -> bool:
    """Whether a clause of a remark says of the thing itself that nobody flies there, or that it is out of use.

    "No-fly zone, military" does; "no-fly zone to the north" is said of another place. Words such as "dry" count only
    as a whole clause, and only where people write remarks: soil is dry, too.
    """
    return any(_is_against(clause, is_remark=is_remark) for clause in _CLAUSE_ENDS.split(remark))


def _is_against(clause: str, *, is_remark: bool) -> bool:
    if not any(map(str.isalpha, clause)):
        return False
    found, rest = phrases_of(clause)
    if found and not rest and all(said == {Meaning.NO_FLY} for _, said in found):
        return True
    if _without("orders", clause) is not None:
        return True
    beside_zone, beside_use = _without("no_fly", clause), _without("out_of_use", clause)
    if beside_zone is not None and not _is_elsewhere(beside_zone):
        return True
    # A pump out of order is none of the pond.
    if beside_use is not None and not _is_elsewhere(beside_use) and not _BESIDE & meanings(beside_use):
        return True
    return is_remark and _is_said_alone(clause)


_BESIDE = {Meaning.OTHER, Meaning.STATION, Meaning.START}


def _is_said_alone(clause: str) -> bool:
    """Whether a clause says nothing but that a pond is out of use: ``currently dry``."""
    others = _without("out_of_use_alone", clause)
    if others is None:
        return False
    fillers = _phrases("fillers").words
    return all(word in fillers or Meaning.POND in meanings(word) for word in words_of(others))


def _is_elsewhere(others: str) -> bool:
    phrases = _phrases("elsewhere")
    # "Ao" is a pond in Vietnamese, and "at" in Portuguese.
    words = [word for word in words_of(others) if Meaning.POND not in meanings(word)]
    return any(word in phrases.words for word in words) or phrases.signs.search(_plain(others)) is not None


def _without(kind: str, clause: str) -> str | None:
    """What is left of a clause without its longest phrase of a kind; ``None`` if none stands in it."""
    phrases, words = _phrases(kind), words_of(clause)
    found = [
        (len(phrase), at)
        for at, word in enumerate(words)
        for phrase in phrases.words.get(word, ())
        if tuple(words[at : at + len(phrase)]) == phrase
    ]
    if found:
        length, at = max(found)
        return " ".join([*words[:at], *words[at + length :]])
    plain = "" if clause.isascii() else _plain(clause)
    return phrases.signs.sub(" ", plain) if phrases.signs.search(plain) else None


def _plain(text: str) -> str:
    return unicodedata.normalize("NFKC", text).casefold()


@dataclass(frozen=True)
class _Phrases:
    """Phrases of one kind: of scripts that set words apart by their first word, and a pattern of all others."""

    words: dict[str, list[tuple[str, ...]]]
    signs: re.Pattern[str]


@cache
def _phrases(kind: str) -> _Phrases:
    words: dict[str, list[tuple[str, ...]]] = {}
    signs: list[str] = []
    for phrase in remark_words(kind):
        if all(is_spaced(letter) for letter in phrase if letter.isalpha()):
            split = tuple(words_of(phrase))
            words.setdefault(split[0], []).append(split)
        else:
            signs.append(_plain(phrase))
    # Without any the pattern must match nowhere.
    pattern = "|".join(map(re.escape, sorted(signs, key=len, reverse=True))) or r"(?!)"
    return _Phrases(words, re.compile(pattern))
