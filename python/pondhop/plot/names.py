"""Names of ponds on a map, where there is room for them."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np

from pondhop.plot.canvas import Points
from pondhop.plot.fonts import lettering
from pondhop.plot.look import Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_FONT_SIZE = 6.5
_LETTER_WIDTH = 0.62
"""Width of a letter as a share of the size of the font."""

_LINE_HEIGHT = 1.3
_MAX_LETTERS = 24
_OFFSET = 5.0
"""How far below a pond's marker its name stands, in points."""

_NUMBER_OFFSET = 9.0
"""The same where the number of a route stands at the pond."""

_HALO_WIDTH = 1.6
"""Of the background around letters, so that a line behind them leaves them readable, in points."""


def draw_names(
    ax: Axes, positions: Points, names: Sequence[str], look: Look, *, numbered: Collection[int] = ()
) -> frozenset[str]:
    """Write the name of each pond below its sampling point, in order, where neither another name nor a marker is near.

    Parameters
    ----------
    ax
        Of a map; its limits must not change any more.
    positions
        Sampling points, shape (n, 2).
    names
        One a position.
    look
        Colours.
    numbered
        Positions at which the number of a route stands.

    Returns
    -------
    frozenset of str
        Letters of the names that no font of the machine has.
    """
    from matplotlib.patheffects import withStroke

    letters = lettering(names)
    texts = [letters.written(name).strip() for name in names]
    points = _in_points(ax, positions)
    widths = _FONT_SIZE * _LETTER_WIDTH * np.array([len(text) for text in texts])
    height = _FONT_SIZE * _LINE_HEIGHT
    boxes = _Boxes(points, margin=2.5)
    for index in np.lexsort((points[:, 0], -points[:, 1])):
        text, (x, y) = texts[index], points[index]
        if not text or len(text) > _MAX_LETTERS:
            continue
        offset = _NUMBER_OFFSET if index in numbered else _OFFSET
        box = (x - widths[index] / 2, x + widths[index] / 2, y - offset - height, y)
        if not boxes.add(box, own_marker=int(index)):
            continue
        ax.annotate(
            text,
            xy=tuple(positions[index]),
            xytext=(0, -offset),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=_FONT_SIZE,
            fontfamily=list(letters.families),
            parse_math=False,
            color=look.ink,
            path_effects=[withStroke(linewidth=_HALO_WIDTH, foreground=look.background)],
            zorder=5,
        )
    return letters.missing


def _in_points(ax: Axes, positions: Points) -> Points:
    """Positions in typographic points on the sheet."""
    ax.apply_aspect()
    figure = ax.get_figure(root=True)
    dots_per_inch = 72.0 if figure is None else figure.dpi
    return np.asarray(ax.transData.transform(positions)) * 72.0 / dots_per_inch


class _Boxes:
    """What is written already: markers and names that no other name may cover."""

    def __init__(self, markers: Points, margin: float) -> None:
        self._markers, self._margin = markers, margin
        self._boxes: list[tuple[float, float, float, float]] = []

    def add(self, box: tuple[float, float, float, float], own_marker: int) -> bool:
        """Take a box (left, right, bottom, top) if it covers nothing; return whether it does not."""
        left, right, bottom, top = box
        x, y = self._markers[:, 0], self._markers[:, 1]
        margin = self._margin
        covered = (x > left - margin) & (x < right + margin) & (y > bottom - margin) & (y < top + margin)
        covered[own_marker] = False
        if covered.any():
            return False
        for other_left, other_right, other_bottom, other_top in self._boxes:
            if left < other_right and right > other_left and bottom < other_top and top > other_bottom:
                return False
        self._boxes.append(box)
        return True
