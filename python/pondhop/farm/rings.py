"""Rings of a polygon in formats that list them in any order: which one bounds water, and which one an island."""

from __future__ import annotations

from pondhop.farm.features import Positions


def polygons_from_rings(rings: list[Positions], *, is_hole: list[bool]) -> list[list[Positions]]:
    """Give every hole to the outer ring around it; a hole in none is an outer ring of its own."""
    polygons = [[ring] for ring, hole in zip(rings, is_hole, strict=True) if not hole]
    for ring, hole in zip(rings, is_hole, strict=True):
        if hole:
            owner = next((polygon for polygon in polygons if ring and _is_inside(ring[0], polygon[0])), None)
            if owner is None:
                polygons.append([ring])
            else:
                owner.append(ring)
    return polygons


def signed_area(ring: Positions) -> float:
    """Area of a ring in square units of its coordinates; positive if it runs anticlockwise."""
    closed = zip(ring, [*ring[1:], *ring[:1]], strict=True)
    return sum(ax * by - bx * ay for (ax, ay), (bx, by) in closed) / 2.0


def _is_inside(point: tuple[float, float], ring: Positions) -> bool:
    """Whether a ray from the point to the east crosses the ring an odd number of times."""
    x, y = point
    inside = False
    for (ax, ay), (bx, by) in zip(ring, [*ring[1:], *ring[:1]], strict=True):
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            inside = not inside
    return inside
