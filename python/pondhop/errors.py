"""What can be wrong with an input: every fault at once, each with its place and its remedy."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Fault:
    """One fault of an input.

    Attributes
    ----------
    path
        Where it is, in the words of the input: ``features[3].geometry``, ``line 17, column lat``.
    message
        What is wrong, with the offending value.
    action
        What the user can do about it.
    """

    path: str
    message: str
    action: str

    def __str__(self) -> str:
        return f"{self.path}: {self.message} ({self.action})"


class InvalidInput(ValueError):  # noqa: N818 - the words of the field, as in the core
    """An input that cannot be planned.

    Attributes
    ----------
    faults
        Everything that is wrong with it, in the order of the input; never empty.
    """

    def __init__(self, faults: Iterable[Fault | tuple[str, str, str]]) -> None:
        self.faults = tuple(fault if isinstance(fault, Fault) else Fault(*fault) for fault in faults)
        super().__init__("\n".join(map(str, self.faults)))

    def __reduce__(self) -> tuple[type[InvalidInput], tuple[tuple[Fault, ...]]]:
        """Pickle the faults, not their text: an error may come from a worker process."""
        return type(self), (self.faults,)
