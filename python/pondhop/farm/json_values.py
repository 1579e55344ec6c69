"""JSON of farm files: a document taken apart feature by feature, so that large files stay small in memory."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from pondhop.errors import Fault
from pondhop.farm.features import Source, shortened

_BLANK = re.compile(r"[ \t\n\r]*")
_LARGE = 1_000_000
"""Documents of fewer characters are read in one go."""


class Features:
    """The list ``features`` of a large document, parsed one by one while it is walked through.

    The members of the document that follow the list are there once the walk is over.
    """

    def __init__(self, text: str, start: int, members: dict[str, Any]) -> None:
        self._text = text
        self._start = start
        self._members = members

    def __iter__(self) -> Iterator[Any]:
        """Yield the values; raises `json.JSONDecodeError` where the text is no JSON."""
        text, decode = self._text, json.JSONDecoder().raw_decode
        at = _after_blank(text, self._start + 1)
        while text[at : at + 1] != "]":
            value, at = decode(text, at)
            yield value
            at = _after_blank(text, at)
            if text[at : at + 1] == ",":
                at = _after_blank(text, at + 1)
            elif text[at : at + 1] != "]":
                raise json.JSONDecodeError("Expecting ',' delimiter", text, at)
        _parse_members(text, _after_comma(text, at + 1), self._members)
        # Let go, because the members hold this list, and a circle would keep the text in memory.
        self._members = {}


def parse_json(text: str, source: Source) -> Any:
    """The document, or ``None`` with a fault; the list ``features`` of a large one is left to be walked through."""
    try:
        return _parse_large(text) if len(text) > _LARGE else json.loads(text)
    except (ValueError, RecursionError) as error:
        source.faults.append(json_fault(text, error))
        return None


def json_fault(text: str, error: ValueError | RecursionError) -> Fault:
    """What is wrong with a text that is no JSON."""
    if isinstance(error, json.JSONDecodeError):
        at_end = error.pos >= len(text.rstrip())
        message = "the file ends too early" if at_end else f"this is no JSON: {error.msg}"
        action = "the file looks cut off: export or copy it again" if at_end else "export the farm again as GeoJSON"
        return Fault(f"line {error.lineno}, column {error.colno}", message, action)
    message = "nested too deeply" if isinstance(error, RecursionError) else "holds a number of thousands of digits"
    return Fault("file", f"the JSON {message}", "export the farm again as GeoJSON")


def _parse_large(text: str) -> Any:
    """A document whose list ``features`` is put off, if it is of the usual shape."""
    at = _after_blank(text, 0)
    if text[at : at + 1] != "{":
        return json.loads(text)
    members: dict[str, Any] = {}
    _parse_members(text, _after_blank(text, at + 1), members)
    features = members.get("features")
    if isinstance(features, Features) and "type" not in members and "geometryType" not in members:
        # What the features are stands behind them: walked through twice, which costs less than holding all at a time.
        for _ in features:
            pass
    return members


def _parse_members(text: str, at: int, members: dict[str, Any]) -> None:
    """Add the members of an object from a position on, up to its end or to a list ``features``."""
    decode = json.JSONDecoder().raw_decode
    while text[at : at + 1] != "}":
        key, at = decode(text, at)
        at = _after_blank(text, at)
        if not isinstance(key, str) or text[at : at + 1] != ":":
            raise json.JSONDecodeError("Expecting ':' delimiter", text, at)
        at = _after_blank(text, at + 1)
        if key == "features" and text[at : at + 1] == "[" and key not in members:
            members[key] = Features(text, at, members)
            return
        members[key], at = decode(text, at)
        at = _after_comma(text, at)
    if _after_blank(text, at + 1) != len(text):
        raise json.JSONDecodeError("Extra data", text, at + 1)


def _after_comma(text: str, at: int) -> int:
    """The next member, or the end of the object."""
    at = _after_blank(text, at)
    if text[at : at + 1] == ",":
        return _after_blank(text, at + 1)
    if text[at : at + 1] != "}":
        raise json.JSONDecodeError("Expecting ',' delimiter", text, at)
    return at


def _after_blank(text: str, at: int) -> int:
    match = _BLANK.match(text, at)
    return match.end() if match else at


def json_name(value: object) -> str:
    """What JSON calls a value."""
    names = {dict: "object", list: "list", str: "text", bool: "truth value", int: "number", float: "number"}
    return names.get(type(value), "null")


def shown(value: object) -> str:
    """A value for a message."""
    if isinstance(value, Features):
        return "a list"
    return shortened(json.dumps(value, ensure_ascii=False))
