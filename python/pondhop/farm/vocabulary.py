"""The words of `words.toml`, which anyone can add to without reading code."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from importlib.resources import files
from typing import Any


@cache
def _tables() -> dict[str, Any]:
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
def tags_of_anything_else() -> tuple[str, ...]:
    """Tags of OpenStreetMap of which every value says that a thing is no pond."""
    return _parted(_tables()["map_tags"]["anything"])


@cache
def tag_meanings() -> dict[tuple[str, str], str]:
    """What tags of OpenStreetMap say, by key and value: the name of a meaning."""
    groups = {name: tags for name, tags in _tables()["map_tags"].items() if name not in {"anything", "perhaps_pond"}}
    return {tag: meaning for meaning, tags in groups.items() for tag in _tags(tags)}


@cache
def perhaps_pond_tags() -> frozenset[tuple[str, str]]:
    """Tags of OpenStreetMap of water that may be a pond, by key and value."""
    return frozenset(_tags(_tables()["map_tags"]["perhaps_pond"]))


def _tags(table: dict[str, str]) -> list[tuple[str, str]]:
    return [(key, value) for key, values in table.items() for value in _parted(values)]


@cache
def kind_meanings() -> dict[str, str]:
    """What values of a column of kinds say that say nothing, or less, in a name: the name of a meaning."""
    return {value.casefold(): meaning for meaning, text in _tables()["kinds"].items() for value in _parted(text)}


@cache
def english_words(kind: str) -> frozenset[str]:
    """English words for ponds, or those before which the name of a thing ends."""
    return frozenset(word.casefold() for word in _parted(_tables()["english"][kind]))


@cache
def remark_words(kind: str) -> tuple[str, ...]:
    """Phrases of remarks of one kind: those that keep drones out, that say that a pond is out of use, or where else."""
    return _parted(_tables()["remarks"][kind])


@cache
def pond_like_words() -> frozenset[str]:
    """Words in names of ponds that are no words for ponds."""
    return frozenset(word.casefold() for word in _parted(_tables()["pond_like"]["words"]))


@cache
def series_words(kind: str) -> frozenset[str]:
    """Words for buildings that may hold ponds, or codes that mean one thing only, however many are numbered."""
    return frozenset(word.casefold() for word in _parted(_tables()["series"][kind]))
