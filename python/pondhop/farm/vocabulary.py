"""The words of `words.toml`, which anyone can add to without reading code."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from importlib.resources import files


@cache
def _tables() -> dict[str, dict[str, str]]:
    return tomllib.loads(files("pondhop.farm").joinpath("words.toml").read_text(encoding="utf-8"))


def _parted(text: str) -> tuple[str, ...]:
    return tuple(word.strip() for word in re.split(r"[,\n]", text) if word.strip())


def meaning_words() -> dict[str, tuple[str, ...]]:
    """Phrases by the name of their meaning."""
    return {meaning: _parted(text) for meaning, text in _tables()["meanings"].items()}


def column_words(kind: str) -> tuple[str, ...]:
    """Headings of one kind of column."""
    return _parted(_tables()["columns"][kind])


def hemisphere_words() -> dict[str, tuple[str, ...]]:
    """Letters and words for north, south, east and west."""
    return {side: _parted(text) for side, text in _tables()["hemispheres"].items()}


def letter_o_words() -> dict[str, frozenset[str]]:
    """Words of the languages in which the letter O is east, and of those in which it is west."""
    return {side: frozenset(word.casefold() for word in _parted(text)) for side, text in _tables()["letter_o"].items()}


@cache
def pond_like_words() -> frozenset[str]:
    """Words in names of ponds that are no words for ponds."""
    return frozenset(word.casefold() for word in _parted(_tables()["pond_like"]["words"]))
