"""Fonts that hold the letters of a text: names of ponds and farms are written in every script.

Matplotlib takes, letter by letter, the first of a list of families that has it. The list is made here from the fonts of
the machine; a letter that none of them has is replaced, so that the picture has no empty boxes and nobody's screen is
filled with warnings.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

DEFAULT_FAMILY = "DejaVu Sans"
"""What matplotlib brings along."""

REPLACEMENT = "?"
"""Stands for a letter that no font of the machine has."""


@dataclass(frozen=True)
class Lettering:
    """How some texts can be written.

    Attributes
    ----------
    families
        Names of fonts, the first that has a letter is taken for it.
    missing
        Letters that none of them has.
    """

    families: tuple[str, ...]
    missing: frozenset[str]

    def written(self, text: str) -> str:
        """Return the text as it can be drawn: on one line, with a mark for each letter that is missing."""
        return "".join(REPLACEMENT if letter in self.missing else letter for letter in _printable(text))


def lettering(texts: Iterable[str]) -> Lettering:
    """Return the fonts of this machine that together hold the letters of some texts."""
    wanted = {letter for text in texts for letter in _printable(text)}
    families = [DEFAULT_FAMILY]
    missing = frozenset(wanted - _letters_of(DEFAULT_FAMILY))
    while missing:
        best = max(sorted(_font_files()), key=lambda family: len(missing & _letters_of(family)))
        if not missing & _letters_of(best):
            break
        families.append(best)
        missing -= _letters_of(best)
    return Lettering(tuple(families), missing)


def _printable(text: str) -> str:
    """The text without control characters, halves of surrogate pairs and marks of direction, line ends as blanks."""
    letters = (" " if letter.isspace() else letter for letter in text)
    return "".join(letter for letter in letters if unicodedata.category(letter) not in {"Cc", "Cf", "Cs", "Co", "Cn"})


@cache
def _font_files() -> dict[str, str]:
    """Upright fonts of normal weight by family; those that only draw boxes are none."""
    from matplotlib import font_manager

    return {
        entry.name: entry.fname
        for entry in font_manager.fontManager.ttflist
        if (entry.style, entry.variant, entry.stretch) == ("normal", "normal", "normal")
        and entry.weight in (400, "normal", "regular")
        and not entry.name.startswith("Last Resort")
    }


@cache
def _letters_of(family: str) -> frozenset[str]:
    from matplotlib import ft2font

    return frozenset(map(chr, ft2font.FT2Font(_font_files()[family]).get_charmap()))
