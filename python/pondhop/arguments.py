"""What public functions are given: whatever is not what they take becomes a fault that names the argument.

A wrong value of Python would else come to light far below, in words about something that the caller never wrote.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from numbers import Integral, Real
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from pondhop.errors import Fault, InvalidInput

Kind = TypeVar("Kind")

_MAX_SHOWN = 40
"""Letters of a value that a message shows."""

_MOST_DIGITS = 2**128
"""Python refuses to print numbers of more than some thousand digits."""


class Arguments:
    """Looks at the arguments of a function, and collects what is wrong with them in `faults`."""

    def __init__(self) -> None:
        self.faults: list[Fault] = []

    def check(self) -> None:
        """Raise `InvalidInput` with all faults, if there are any."""
        if self.faults:
            raise InvalidInput(self.faults)

    def kind(self, name: str, value: object, kind: type, action: str) -> bool:
        """Whether a value is of some class."""
        return isinstance(value, kind) or self.refuse(name, value, action)

    def whole(self, name: str, value: object, least: int, most: int, action: str) -> bool:
        """Whether a value is a whole number in some range."""
        # Asking for a number of Python first spares nearly everybody the slow question for one of any package.
        if not isinstance(value, (int, Integral)) or isinstance(value, bool):
            return self.refuse(name, value, action)
        return least <= int(value) <= most or self.refuse(name, value, action)

    def real(self, name: str, value: object, least: float, most: float, action: str) -> bool:
        """Whether a value is a number in some range; no comparison holds for one that is none."""
        if not isinstance(value, (int, float, Real)) or isinstance(value, bool):
            return self.refuse(name, value, action)
        try:
            # Whole numbers may be beyond all floats, and compare with them all the same.
            number = (
                value
                if isinstance(value, (int, float))
                else int(value)
                if isinstance(value, Integral)
                else float(value)
            )
        except OverflowError:
            # As of a fraction.
            return self.refuse(name, value, action)
        return least <= number <= most or self.refuse(name, value, action)

    def truth(self, name: str, value: object) -> bool:
        """Whether a value is true or false."""
        return isinstance(value, (bool, np.bool_)) or self.refuse(name, value, "give True or False")

    def one_of(self, name: str, value: object, possible: Sequence[str]) -> bool:
        """Whether a value is one of some words."""
        is_known = isinstance(value, str) and value in possible
        return is_known or self.refuse(name, value, f"choose one of: {', '.join(possible)}")

    def path(self, name: str, value: object) -> bool:
        """Whether a value names a file or folder."""
        action = "give the name of a file or folder, as text or a path"
        if not isinstance(value, (str, os.PathLike)) or not isinstance(os.fspath(value), str):
            return self.refuse(name, value, action)
        return "\0" not in os.fspath(value) or self.refuse(name, value, action)

    def position(self, name: str, value: object, most_latitude_deg: float = 90.0) -> bool:
        """Whether a value is a longitude and a latitude in degrees."""
        action = f"give longitude -180..180, then latitude -{most_latitude_deg:g}..{most_latitude_deg:g}, in degrees"
        degrees = _reals(value)
        if degrees is None or degrees.shape != (2,):
            return self.refuse(name, value, action)
        is_on_globe = abs(degrees[0]) <= 180.0 and abs(degrees[1]) <= most_latitude_deg
        return bool(is_on_globe) or self.refuse(name, value, action)

    def array(self, name: str, value: object, action: str) -> bool:
        """Whether a value is an array of numbers, of which none is masked."""
        is_good = isinstance(value, np.ndarray) and value.dtype.kind in "iuf" and not np.ma.is_masked(value)
        return is_good or self.refuse(name, value, action)

    def positions(self, name: str, value: object) -> bool:
        """Whether a value is an array of positions, shape (n, 2)."""
        action = "give finite positions as an array of shape (n, 2)"
        places = _reals(value)
        if places is None or places.ndim != 2 or places.shape[1] != 2 or len(places) == 0:
            return self.refuse(name, value, action)
        return bool(np.isfinite(places).all()) or self.refuse(name, value, action)

    def indices(self, name: str, value: object, number: int) -> bool:
        """Whether a value is a sequence of indices below a number."""
        action = f"give indices from 0 to {number - 1}"
        if isinstance(value, (str, bytes)) or not isinstance(value, Sequence | np.ndarray):
            return self.refuse(name, value, action)
        are_known = [self.whole(f"{name}[{place}]", index, 0, number - 1, action) for place, index in enumerate(value)]
        return all(are_known)

    def all_kind(self, name: str, values: object, kind: type[Kind], action: str) -> Sequence[Kind]:
        """Return a sequence whose items are all of some class; an empty one where the value is something else."""
        if isinstance(values, (str, bytes)) or not isinstance(values, Sequence):
            self.refuse(name, values, action)
            return ()
        for index, value in enumerate(values):
            self.kind(f"{name}[{index}]", value, kind, action)
        return values if all(isinstance(value, kind) for value in values) else ()

    def all_of(self, name: str, values: object, possible: Sequence[str]) -> None:
        """Look at a value that is to be a sequence of some words."""
        words = self.all_kind(name, values, str, f"give some of: {', '.join(possible)}")
        for index, word in enumerate(words):
            self.one_of(f"{name}[{index}]", word, possible)

    def refuse(self, name: str, value: object, action: str) -> bool:
        """Add the fault that a value cannot be taken; return that it cannot."""
        self.faults.append(Fault(name, f"it is {shown(value)}", action))
        return False


def checked_path(name: str, value: object) -> Path:
    """Return a path that was given as text or as one.

    Raises
    ------
    InvalidInput
        If it is neither.
    """
    arguments = Arguments()
    arguments.path(name, value)
    arguments.check()
    return Path(value)  # type: ignore[arg-type]


def _reals(value: object) -> NDArray[np.float64] | None:
    """Return real numbers as an array; `None` for all else, also for what lies below a mask and digits in a text."""
    is_masked = np.ma.is_masked(value) or (isinstance(value, (list, tuple)) and any(map(np.ma.is_masked, value)))
    if is_masked:
        return None
    try:
        array = np.asarray(value)
    except (TypeError, ValueError, OverflowError):
        return None
    return array.astype(np.float64) if array.dtype.kind in "iuf" else None


def shown(value: object) -> str:
    """Return a value as a message shows it, on one line, cut where it is too long to read.

    What has many values, and what cannot tell what it is, is told by its type. The core shows values by this, too.
    """
    if value is np.ma.masked:
        return "masked"
    if isinstance(value, Integral) and not isinstance(value, bool) and abs(int(value)) >= _MOST_DIGITS:
        return "a number of very many digits"
    if (isinstance(value, Iterable) and not isinstance(value, (str, bytes, list, tuple))) or callable(value):
        return _type_text(value)
    if type(value).__repr__ is object.__repr__:
        return _type_text(value)
    try:
        return shortened(repr(value))
    except Exception:  # noqa: BLE001 - a class of the caller's may raise anything, and a list with it
        return _type_text(value)


def _type_text(value: object) -> str:
    name = type(value).__name__
    return f"{'an' if name[0] in 'aeiouAEIOU' or name == 'ndarray' else 'a'} {name}"


def shortened(text: str) -> str:
    """Return a text for a message: on one line, and cut where it is too long to read."""
    line = " ".join(part.strip() for part in text.splitlines())
    return line if len(line) <= _MAX_SHOWN else f"{line[: _MAX_SHOWN - 3]}..."
