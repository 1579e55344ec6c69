"""Places on the globe: what a position, a ring and an area are, and how far apart two places lie."""

from __future__ import annotations

import math

LonLat = tuple[float, float]
"""Longitude and latitude in degrees (WGS84), in this order."""

Ring = tuple[LonLat, ...]
"""A closed line: the last position repeats the first, unless a docstring says that it is open."""

Area = tuple[Ring, ...]
"""A polygon: the outer ring, then its holes."""

EARTH_RADIUS_M = 6_371_008.8
"""Mean radius of the Earth, for distances that need not be exact."""


def distance_m(a: LonLat, b: LonLat) -> float:
    """Great-circle distance of two places in metres (haversine formula)."""
    (a_lon, a_lat), (b_lon, b_lat) = ((math.radians(lon), math.radians(lat)) for lon, lat in (a, b))
    half_chord2 = (
        math.sin((b_lat - a_lat) / 2) ** 2 + math.cos(a_lat) * math.cos(b_lat) * math.sin((b_lon - a_lon) / 2) ** 2
    )
    return 2.0 * EARTH_RADIUS_M * math.asin(math.sqrt(min(1.0, half_chord2)))


def wrapped_longitude(longitude_deg: float) -> float:
    """The same meridian within -180..180; a longitude that lies there already comes back to the last bit."""
    if -180.0 <= longitude_deg <= 180.0:
        return longitude_deg
    return math.remainder(longitude_deg, 360.0)


def unrolled_longitude(longitude_deg: float, near_deg: float) -> float:
    """The same meridian within half a turn of another one, so that shapes across the 180th stay in one piece."""
    if abs(longitude_deg - near_deg) <= 180.0:
        return longitude_deg
    return longitude_deg - 360.0 * round((longitude_deg - near_deg) / 360.0)
