"""Which ponds of a file lie together: one file may hold several farms."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from pondhop._core import LocalFrame
from pondhop.places import EARTH_RADIUS_M, LonLat

MAX_GAP_M = 20_000.0
"""Ponds and depot of one farm are linked by gaps below this; no sampling drone flies further and returns."""


def middle(points: Sequence[LonLat]) -> LonLat:
    """The mean position of places that lie together, wherever on the globe."""
    frame = LocalFrame(*points[0])
    lon, lat = frame.to_geographic(frame.to_local(np.array(points, dtype=np.float64)).mean(axis=0, keepdims=True))[0]
    return (float(lon), float(lat))


def neighbourhoods(points: Sequence[LonLat]) -> list[list[int]]:
    """Indices of the places, grouped so that groups lie apart; the largest group first.

    Places are put into cubes of side `MAX_GAP_M` in space, so that the 180th meridian is nothing special, and cubes
    that touch are joined: gaps below the side always join, gaps above twice the diagonal of a cube never do. Linear in
    the number of places.
    """
    cubes: dict[tuple[int, int, int], list[int]] = {}
    for index, (lon, lat) in enumerate(points):
        lam, phi = math.radians(lon), math.radians(lat)
        direction = (math.cos(phi) * math.cos(lam), math.cos(phi) * math.sin(lam), math.sin(phi))
        x, y, z = (math.floor(component * EARTH_RADIUS_M / MAX_GAP_M) for component in direction)
        cubes.setdefault((x, y, z), []).append(index)
    groups: list[list[int]] = []
    unseen = dict.fromkeys(cubes)
    while unseen:
        frontier = [unseen.popitem()[0]]
        group: list[int] = []
        while frontier:
            cube = frontier.pop()
            group.extend(cubes[cube])
            for step in itertools.product((-1, 0, 1), repeat=3):
                neighbour = (cube[0] + step[0], cube[1] + step[1], cube[2] + step[2])
                if neighbour in unseen:
                    del unseen[neighbour]
                    frontier.append(neighbour)
        groups.append(sorted(group))
    return sorted(groups, key=lambda group: (-len(group), group[0]))
