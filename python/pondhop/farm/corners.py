"""Ponds given by four corners in a line of a table, typed by hand.

Typing errors that can be told from the other numbers of the same line are worked around with a note that names line and
column.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from pondhop.farm.columns import Columns
from pondhop.farm.features import Source
from pondhop.places import LonLat

OUTLIER_RATIO = 3.0
"""A corner further from its nearest sibling than this times the extent of the other three is mistyped.

In a rectangle of any shape the ratio is below 1; above 3 the pond would be a needle.
"""


def pond_from_corners(
    place: str, corners: list[LonLat], columns: Columns, doubts: list[str], source: Source
) -> list[LonLat]:
    """The outline of a pond whose four corners were typed by hand.

    A corner that lies off by more than `OUTLIER_RATIO` is replaced by the one that completes the other three to a
    parallelogram, which ponds nearly are, so that the centre of the pond stays right. Corners that do not lie around
    the pond in the order of their names are joined in the order that they do, by angle around their mean. Both leave a
    note; where columns named by the compass contradict each other, or a corner was placed, the middle of the pond is a
    guess, which is a doubt as well.
    """
    ring = list(corners)
    wrong = _outlier(ring)
    if wrong is not None:
        before, opposite, after = ring[wrong - 1], ring[wrong - 2], ring[wrong - 3]
        typed, ring[wrong] = (
            ring[wrong],
            (
                before[0] + after[0] - opposite[0],
                before[1] + after[1] - opposite[1],
            ),
        )
        off = [
            f"column {columns.names[columns.corners[wrong][axis]]} has {typed[axis]:.6f}, "
            f"expected about {ring[wrong][axis]:.6f}"
            for axis in (0, 1)
            if abs(typed[axis] - ring[wrong][axis]) > OUTLIER_RATIO * _extent([before, opposite, after])
        ]
        doubts.append(f"one corner lies far from the other three and was placed from them ({'; '.join(off)})")
        source.notes.add(f"{place}: {doubts[-1]}.")
    centre = (sum(lon for lon, _ in ring) / 4, sum(lat for _, lat in ring) / 4)
    around = sorted(range(4), key=lambda c: math.atan2(ring[c][1] - centre[1], ring[c][0] - centre[0]))
    start = around.index(0)
    order = around[start:] + around[:start]
    if order not in ([0, 1, 2, 3], [0, 3, 2, 1]):
        names = ", ".join(columns.names[lat] for _, lat in columns.corners)
        because = f"columns {names} contradict each other; one is mistyped" if columns.is_compass else "check them"
        told = f"the corners are not in order around the pond and were joined by angle ({because})"
        source.notes.add(f"{place}: {told}.", kind=None if columns.is_compass else "joined by angle")
        if columns.is_compass:
            doubts.append(told)
    return [ring[c] for c in order]


def _extent(points: Sequence[LonLat]) -> float:
    """Largest distance of any two points, in degrees."""
    return max(math.dist(a, b) for a in points for b in points)


def _outlier(corners: Sequence[LonLat]) -> int | None:
    """Index of the corner that lies far from the other three, if one does."""
    for index, corner in enumerate(corners):
        siblings = [sibling for other, sibling in enumerate(corners) if other != index]
        if min(math.dist(corner, sibling) for sibling in siblings) > OUTLIER_RATIO * _extent(siblings):
            return index
    return None
