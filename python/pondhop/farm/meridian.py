"""Shapes cut at the 180th meridian, as RFC 7946 (3.1.9) asks of files, put together again: one pond, not two."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import permutations

import numpy as np

from pondhop.farm.features import Feature, Geometry, Notes, Positions
from pondhop.places import LonLat, wrapped_longitude

CUT_DEG = 1e-5
"""How near the meridian a cut lies, about a metre: programs keep a little away from it, or round."""


def join_at_meridian(features: Iterable[Feature], notes: Notes) -> None:
    """Put the parts of each feature together that meet on the 180th meridian, with a note each."""
    for feature in features:
        geometry = feature.geometry
        if not _lies_on_both_sides(geometry):
            continue
        num_parts = len(geometry.polygons) + len(geometry.lines)
        geometry.polygons = _joined_polygons(geometry.polygons)
        geometry.lines = _joined_lines(geometry.lines)
        num_left = len(geometry.polygons) + len(geometry.lines)
        if num_left < num_parts:
            told = f"{num_parts} parts that meet on the 180th meridian were put together"
            if num_left > 1:
                told = (
                    f"of its {num_parts} parts, those that meet on the 180th meridian were put together, to {num_left}"
                )
            notes.add(f"{feature.told()}: {told}.", kind="parts at the meridian")


def _lies_on_both_sides(geometry: Geometry) -> bool:
    """Whether it has several parts, and some touch the meridian in the east and some in the west."""
    if len(geometry.polygons) < 2 and len(geometry.lines) < 2:
        return False
    sides = {lon > 0.0 for lon, _ in geometry.positions() if _is_on_cut(lon)}
    return len(sides) == 2


def _is_on_cut(lon: float) -> bool:
    return abs(lon) >= 180.0 - CUT_DEG


def _joined_polygons(polygons: list[list[Positions]]) -> list[list[Positions]]:
    """The polygons, those that share a stretch of the meridian as one; holes cut in two are whole again."""
    import shapely

    cut = [polygon for polygon in polygons if any(_is_on_cut(lon) for lon, _ in polygon[0])]
    shapes = [
        shapely.Polygon(_eastward(shell), [_eastward(hole) for hole in holes])
        for shell, *holes in cut
        if all(len(ring) >= 3 for ring in (shell, *holes))
    ]
    # What crosses itself is told as it stands in the file.
    if len(shapes) < len(cut) or not all(shape.is_valid for shape in shapes):
        return polygons
    pieces = list(shapely.get_parts(shapely.union_all(shapes)))
    if len(pieces) == len(cut):
        return polygons
    first = next(index for index, polygon in enumerate(polygons) if polygon is cut[0])
    joined = [
        [_wrapped(shapely.get_coordinates(ring)) for ring in (piece.exterior, *piece.interiors)] for piece in pieces
    ]
    whole = [polygon for polygon in polygons if not any(polygon is part for part in cut)]
    return [*whole[:first], *joined, *whole[first:]]


def _eastward(ring: Positions) -> Positions:
    """A ring with longitudes that go on beyond 180, and what is nearly on the meridian on it."""
    return [(180.0 if _is_on_cut(lon) else lon % 360.0, lat) for lon, lat in ring]


def _wrapped(corners: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Positions:
    return [(wrapped_longitude(float(lon)), float(lat)) for lon, lat in corners]


def _joined_lines(lines: list[Positions]) -> list[Positions]:
    """The lines, those that end on one place of the meridian as one."""
    joined = list(lines)
    while True:
        pair = next(
            ((a, b) for a, b in permutations(_either_way(joined), 2) if a[0] != b[0] and _meet(a[1][-1], b[1][0])),
            None,
        )
        if pair is None:
            return joined
        (first, before), (second, after) = pair
        joined[first] = [*before, *after[1:]]
        del joined[second]


def _either_way(lines: list[Positions]) -> list[tuple[int, Positions]]:
    """Lines that end on the meridian with their numbers, as they are and backwards."""
    ends = [(index, line) for index, line in enumerate(lines) if len(line) > 1]
    cut = [(index, line) for index, line in ends if _is_on_cut(line[0][0]) or _is_on_cut(line[-1][0])]
    return [*cut, *((index, line[::-1]) for index, line in cut)]


def _meet(end: LonLat, start: LonLat) -> bool:
    """Whether two ends are one place, seen from the east and from the west."""
    is_across = _is_on_cut(end[0]) and _is_on_cut(start[0]) and (end[0] > 0.0) != (start[0] > 0.0)
    return is_across and abs(end[1] - start[1]) <= CUT_DEG
