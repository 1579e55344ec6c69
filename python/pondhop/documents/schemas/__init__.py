"""JSON files checked against the JSON Schemas of this folder: every fault at once."""

from __future__ import annotations

import json
import math
import os
from importlib import resources
from pathlib import Path
from typing import Any, Literal, NoReturn

from pondhop.errors import Fault, InvalidInput

SchemaName = Literal["plan-1", "plan-2", "qgroundcontrol-plan"]

_MAX_MESSAGE_LENGTH = 200
"""A message of the validator quotes the offending value, which may be a whole farm."""


def load_schema(name: SchemaName) -> dict[str, Any]:
    """Return a shipped JSON Schema (draft 2020-12).

    Parameters
    ----------
    name
        ``plan-1`` and ``plan-2`` are our plan.json, ``qgroundcontrol-plan`` the part of QGroundControl's format that we
        write.
    """
    text = resources.files(__package__).joinpath(f"{name}.json").read_text(encoding="utf-8")
    schema: dict[str, Any] = json.loads(text)
    return schema


def read_json(path: str | os.PathLike[str]) -> Any:
    """Read a JSON file.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    The value; only objects, lists, strings, finite numbers, booleans and None.

    Raises
    ------
    InvalidInput
        With the byte at which the file stops being text, or the line at which it stops being JSON.
    OSError
        If the file cannot be read.
    """
    try:
        text = Path(path).read_bytes().decode("utf-8")
    except UnicodeDecodeError as error:
        fault = Fault(f"{path}, byte {error.start}", "this is not UTF-8 text", "save the file as UTF-8")
        raise InvalidInput([fault]) from error
    return _parse(text)


def parse_json(text: str, name: SchemaName) -> Any:
    """Parse JSON text and check it against a schema.

    Parameters
    ----------
    text
        The text.
    name
        The schema, as in `load_schema`.

    Returns
    -------
    The value; only objects, lists, strings, finite numbers, booleans and None.

    Raises
    ------
    InvalidInput
        With every place that breaks the schema, or the line at which the text stops being JSON.
    """
    value = _parse(text)
    check_schema(value, name)
    return value


def check_schema(value: Any, name: SchemaName) -> None:
    """Check a value of JSON against a schema.

    Raises
    ------
    InvalidInput
        With every place that breaks the schema.
    """
    import jsonschema

    validator = jsonschema.Draft202012Validator(load_schema(name))
    errors = sorted(validator.iter_errors(value), key=lambda error: [str(step) for step in error.absolute_path])
    if errors:
        raise InvalidInput(
            Fault(_path(error.absolute_path), _shortened(error.message), f"see the schema {name}.json")
            for error in errors
        )


def _parse(text: str) -> Any:
    def refuse(constant: str) -> NoReturn:
        raise InvalidInput([Fault("the file", f"it holds {constant}, which is not JSON", "write finite numbers")])

    def finite(digits: str) -> float:
        value = float(digits)
        if math.isinf(value):
            raise InvalidInput(
                [Fault("the file", f"it holds {digits[:40]}, which is too large", "write finite numbers")]
            )
        return value

    try:
        return json.loads(text, parse_constant=refuse, parse_float=finite)
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise InvalidInput([Fault(place, f"this is not JSON: {error.msg}", "write the file again")]) from error
    except (RecursionError, ValueError) as error:
        if isinstance(error, InvalidInput):
            raise
        fault = Fault("the file", f"it cannot be parsed: {error}", "write the file again")
        raise InvalidInput([fault]) from error


def _path(steps: Any) -> str:
    """Return the place as one writes it: ``routes[0].stops[3].arrival_s``."""
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in steps)
    return text.removeprefix(".") or "the file"


def _shortened(message: str) -> str:
    return (
        message if len(message) <= _MAX_MESSAGE_LENGTH else f"{message[:60]} ... {message[60 - _MAX_MESSAGE_LENGTH :]}"
    )
