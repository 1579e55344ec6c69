"""What the names of features say, in the languages of those who farm ponds.

Words of the Latin, Greek and Cyrillic alphabets match as whole words, accents aside where they are long enough; of
other scripts, which do not set words apart or write endings onto them, they match anywhere; after a sign = only as the
whole name. Longer phrases match first
and their letters are used up: a "pump house" is no house, and the pond in "battery" (電池) is none.
"""

from __future__ import annotations

import re
import unicodedata
from enum import Enum
from functools import cache, lru_cache

from pondhop.farm.vocabulary import english_words, kind_meanings, meaning_words, pond_like_words


class Meaning(Enum):
    """What a word says about a feature."""

    POND = "pond"
    DEPOT = "depot"
    START = "start"
    """Perhaps the depot, perhaps a house: home, base, launch."""
    STATION = "station"
    NO_FLY = "no_fly"
    FENCE = "fence"
    BOUNDARY = "boundary"
    OTHER = "other"
    UNCERTAIN = "uncertain"
    """Said of ponds and of areas to keep out of: zone, sector."""
    SAMPLING = "sampling"
    """A place where water is taken."""
    SERIES = "series"
    """Said of stations of drones, and of the numbered places where a farm measures: station, waypoint, dock."""
    UNUSED = "unused"
    """Said of ponds in which there is nothing to measure: abandoned, under repair."""
    UNNAMED = "unnamed"
    """What a program calls things that nobody named."""


_LETTER_RUN = re.compile(r"[^\W\d_]+")
_SPACED_SCRIPTS = ("LATIN", "GREEK", "CYRILLIC")

MIN_PLAIN_LETTERS = 5
"""Shorter words mean other things without their accents: hồ is a lake, ho is not."""


def is_spaced(letter: str) -> bool:
    """Whether a letter is of a script that sets words apart and writes no endings onto them."""
    return unicodedata.name(letter, "").startswith(_SPACED_SCRIPTS)


def _stem(word: str) -> str:
    """A word without plural s, and without accents where it is long."""
    if len(word) >= MIN_PLAIN_LETTERS:
        word = without_accents(word)
    return word[:-1] if len(word) > 3 and word.endswith("s") and not word.endswith("ss") else word


def without_accents(text: str) -> str:
    """A text in the plain letters of its script."""
    return "".join(letter for letter in unicodedata.normalize("NFKD", text) if not unicodedata.combining(letter))


def _split(text: str) -> list[str]:
    """The words of a name as they are written: split at blanks, digits, signs and inner capitals, as in NoFlyZone_2."""
    text = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", unicodedata.normalize("NFC", text))
    return _LETTER_RUN.findall(text.replace("'", "").replace("\N{RIGHT SINGLE QUOTATION MARK}", "").casefold())


def words_of(text: str) -> list[str]:
    """The words of a name in the form in which they are compared."""
    return list(map(_stem, _split(text)))


def heading_words(text: str) -> list[str]:
    """The words of a heading, as in ``Site_Code`` and ``pondNo``."""
    return _split(text)


def plain_words(text: str) -> list[str]:
    """The words of a name without digits and signs, as they are written; in scripts without blanks whole runs."""
    return _LETTER_RUN.findall(unicodedata.normalize("NFC", text).casefold())


@cache
def _phrases() -> tuple[dict[str, list[tuple[tuple[str, ...], Meaning]]], list[tuple[str, Meaning]]]:
    """Phrases of spaced scripts by their first word, and those of the others; the longest first."""
    spaced: dict[str, list[tuple[tuple[str, ...], Meaning]]] = {}
    joined: list[tuple[str, Meaning]] = []
    for meaning_name, phrases in meaning_words().items():
        meaning = Meaning[meaning_name.upper()]
        for phrase in phrases:
            letters = [letter for letter in phrase if letter.isalpha()]
            if not letters:
                continue
            if all(map(is_spaced, letters)):
                words = tuple(words_of(phrase))
                spaced.setdefault(words[0], []).append((words, meaning))
            else:
                joined.append((unicodedata.normalize("NFKC", phrase).casefold(), meaning))
    for same_start in spaced.values():
        same_start.sort(key=lambda item: -len(item[0]))
    return spaced, sorted(joined, key=lambda item: -len(item[0]))


@lru_cache(maxsize=65_536)
def phrases_of(text: str) -> tuple[tuple[tuple[str, frozenset[Meaning]], ...], tuple[str, ...]]:
    """The phrases of a name with all that each of them says, and the words that say nothing."""
    spaced, joined = _phrases()
    found: list[tuple[str, frozenset[Meaning]]] = []
    if not text.isascii():
        plain = unicodedata.normalize("NFKC", text).casefold()
        for phrase, meaning in joined:
            if _stands_in(phrase, meaning, plain):
                sign = phrase.removeprefix("=")
                found.append((sign, frozenset(other for same, other in joined if same == phrase)))
                plain = plain.replace(sign, " ")
        foreign = [run for run in _LETTER_RUN.findall(plain) if not all(map(is_spaced, run))]
    else:
        foreign = []
    written = _split(text)
    words = list(map(_stem, written))
    rest: list[str] = []
    at = 0
    while at < len(words):
        matches = [item for item in spaced.get(words[at], ()) if tuple(words[at : at + len(item[0])]) == item[0]]
        if not matches:
            if all(map(is_spaced, written[at])):
                rest.append(written[at])
            at += 1
            continue
        longest = len(matches[0][0])
        said = frozenset(meaning for phrase, meaning in matches if len(phrase) == longest)
        found.append((" ".join(written[at : at + longest]), said))
        at += longest
    return tuple(found), (*rest, *foreign)


@lru_cache(maxsize=65_536)
def meanings(text: str) -> frozenset[Meaning]:
    """Everything that the words of a name say; empty for a name that says nothing."""
    return frozenset(meaning for _, said in phrases_of(text)[0] for meaning in said)


def pond_called(pond_id: str) -> str:
    """A pond in a sentence: ``pond A7``, but ``Pond 7`` and ``Laguna 2``, whose ids say already what they are."""
    return pond_id if Meaning.POND in meanings(pond_id) else f"pond {pond_id}"


def word_for(text: str, meaning: Meaning) -> str:
    """The word of a name that has a meaning, as it is written there; the whole name if no single word has it."""
    return next((word for word, said in phrases_of(text)[0] if meaning in said), text)


_THINGS = {Meaning.POND, Meaning.OTHER, Meaning.DEPOT, Meaning.START, Meaning.STATION, Meaning.FENCE, Meaning.BOUNDARY}


def thing_named_for_pond(text: str) -> str | None:
    """The word for what a thing is that has an English word for ponds in its name: a "pond road" is a road.

    ``None`` for ponds, such as a "road pond" or a "pond by the road", and for names in other languages, in many of
    which the first word says what a thing is.
    """
    if not any(_is_english_pond(phrase) for phrase, _ in phrases_of(text)[0]):
        return None
    written = _split(text)
    end = next((at for at, word in enumerate(written) if at and word in english_words("before_places")), len(written))
    things = [(phrase, said) for phrase, said in phrases_of(" ".join(written[:end]))[0] if _THINGS & said]
    if not things or written[end - 1] in pond_like_words():
        return None
    phrase, said = things[-1]
    return None if {Meaning.POND, Meaning.SERIES} & said else phrase


def _is_english_pond(phrase: str) -> bool:
    return {phrase, phrase.removesuffix("s")} & english_words("ponds") != set()


def series_of(text: str) -> tuple[str, tuple[str, ...]] | None:
    """The word by which a name may be one of a series of sampling points, and the words that say nothing.

    ``None`` for a name with any other word that says what a thing is: a "weather station" is no place in the water.
    """
    found, rest = phrases_of(text)
    words = [word for word, said in found if Meaning.SERIES in said]
    is_all = all({Meaning.SERIES, Meaning.SAMPLING} & said for _, said in found)
    return (_stem(words[0]), rest) if words and is_all else None


def _stands_in(phrase: str, meaning: Meaning, text: str) -> bool:
    """Whether a phrase of an unspaced script stands in a text.

    A single sign is part of too many names: pond "east of the river" is none. It counts at the end, where these
    languages put what a thing is; only a sign for ponds counts anywhere.
    """
    if phrase.startswith("="):
        return re.sub(r"[\W\d_号號]+", "", text) == re.sub(r"[\W_]+", "", phrase)
    if len(phrase) > 1 or meaning is Meaning.POND:
        return phrase in text
    return re.sub(r"[\W\d_号號]+$", "", text).endswith(phrase)


def is_unnamed(text: str) -> bool:
    """Whether a name is what a program calls things that nobody named, with or without a number."""
    rest = [word for word in words_of(text) if Meaning.UNNAMED not in meanings(word)]
    has_foreign = any(letter.isalpha() and not is_spaced(letter) for letter in text)
    return Meaning.UNNAMED in meanings(text) and (not rest or has_foreign or _is_phrase(text, Meaning.UNNAMED))


def _is_phrase(text: str, meaning: Meaning) -> bool:
    """Whether a name is exactly one phrase of the list."""
    words = tuple(words_of(text))
    return bool(words) and (words, meaning) in _phrases()[0].get(words[0], ())


def is_plain_word(text: str) -> bool:
    """Whether a name is a word for ponds alone, which tells no pond from another."""
    return _is_phrase(text, Meaning.POND) and not any(letter.isdigit() for letter in text)


def is_ordinary(text: str) -> bool:
    """Whether a text is a code, or says what ponds are called by: a side, a size, a fish."""
    if is_unnamed(text):
        return True
    words = plain_words(text)
    return all((len(word) <= 2 and word.isascii()) or word in pond_like_words() for word in words)


def says_only(text: str) -> bool:
    """Whether all words of a text say what a thing is, and no number tells it from others of its kind."""
    found, rest = phrases_of(text)
    is_numbered = any(letter.isdigit() for letter in text)
    is_kind = bool(found) or text.strip().casefold() in kind_meanings()
    return is_kind and not is_numbered and all(word in pond_like_words() for word in rest)
