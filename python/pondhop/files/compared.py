"""Whether a file of a plan says what its routes imply: every number of a plan follows from them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from pondhop.errors import Fault

_RELATIVE_TOLERANCE = 1e-6
_ABSOLUTE_TOLERANCE = 1e-3
"""How far the numbers of a file may be from what the evaluator finds: a millimetre, a millisecond, or rounding."""

_REMEDY = "change the routes only by planning again: all numbers of a plan follow from them"


def unknown_ponds(routes: Sequence[Sequence[int]], num_ponds: int, place: str) -> Iterator[Fault]:
    """Return a fault for every stop at a pond that the farm lacks; ``place`` names a stop by route and order."""
    for route, ponds in enumerate(routes):
        for order, pond in enumerate(ponds):
            if pond >= num_ponds:
                where = place.format(route=route, order=order)
                yield Fault(where, f"there is no pond {pond}", f"give an index of 0 to {num_ponds - 1}")


def differences(path: str, found: Any, expected: Any) -> Iterator[Fault]:
    """Return every place where a file does not say what its routes imply.

    Parameters
    ----------
    path
        Of the value in the file, in the words of JSON; empty for the whole file.
    found
        What the file says. Keys that nobody expects are passed over: another version may have written them.
    expected
        What follows from the routes.
    """
    if isinstance(expected, dict) and isinstance(found, dict):
        for key in expected:
            yield from differences(f"{path}.{key}".removeprefix("."), found.get(key), expected[key])
    elif isinstance(expected, list) and isinstance(found, list):
        if len(expected) != len(found):
            yield Fault(path, f"it has {len(found)} items, but the routes of the file give {len(expected)}", _REMEDY)
            return
        for index, (found_item, expected_item) in enumerate(zip(found, expected, strict=True)):
            yield from differences(f"{path}[{index}]", found_item, expected_item)
    elif not _agree(found, expected):
        yield Fault(path, f"it is {found!r}, but the routes of the file give {expected!r}", _REMEDY)


def _agree(found: Any, expected: Any) -> bool:
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in (found, expected))
    if numbers:
        return math.isclose(found, expected, rel_tol=_RELATIVE_TOLERANCE, abs_tol=_ABSOLUTE_TOLERANCE)
    return type(found) is type(expected) and bool(found == expected)
