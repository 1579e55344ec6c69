"""Whether the coordinates of a farm file lie on the globe, and where ponds may be."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Geometry, Notes, Positions, listed
from pondhop.farm.joined_minutes import are_minutes_joined, joined_text
from pondhop.places import LonLat, wrapped_longitude

MAX_LATITUDE_DEG = 75.0
"""No pond is farmed nearer to a pole; a latitude beyond it is a longitude."""


def exchanged(position: LonLat) -> bool:
    """Whether a position makes sense only with its two numbers exchanged."""
    lon, lat = position
    return abs(lat) > MAX_LATITUDE_DEG and abs(lon) <= MAX_LATITUDE_DEG and abs(lat) <= 180.0


def wrap_longitudes(features: Sequence[Feature], notes: Notes) -> None:
    """Bring longitudes of one turn too many into -180..180, with a note; farms at the 180th meridian are drawn so."""
    wrapped: list[str] = []
    for feature in features:
        geometry = feature.geometry
        positions = geometry.positions()
        if not any(180.0 < abs(lon) <= 360.0 for lon, _ in positions) or not all(_is_wrappable(p) for p in positions):
            continue
        feature.geometry = Geometry(
            _wrapped(geometry.points),
            [_wrapped(line) for line in geometry.lines],
            [[_wrapped(ring) for ring in polygon] for polygon in geometry.polygons],
        )
        furthest = max((lon for lon, _ in positions), key=abs)
        wrapped.append(f"{feature.told()} from {furthest:.10g} to {wrapped_longitude(furthest):.10g}")
    if wrapped:
        notes.add(f"Longitudes beyond 180 were wrapped around the 180th meridian: {listed(wrapped, 3)}.")


def _is_wrappable(position: LonLat) -> bool:
    return abs(position[0]) <= 360.0 and abs(position[1]) <= MAX_LATITUDE_DEG


def _wrapped(positions: Positions) -> Positions:
    return [(wrapped_longitude(lon), lat) for lon, lat in positions]


def check_coordinates(features: Sequence[Feature]) -> list[Fault]:
    """Faults of coordinates that lie nowhere on the globe, or where no pond is, one a feature.

    Longitude and latitude exchanged throughout the file are one fault.
    """
    faults: list[Fault] = []
    num_exchanged = 0
    located = [(feature, positions) for feature in features if (positions := feature.geometry.positions())]
    astray = [(feature, positions) for feature, positions in located if not _lies_within(positions)]
    is_joined = are_minutes_joined([position for _, positions in astray for position in positions])
    for feature, positions in astray:
        if is_joined:
            faults.append(_joined_fault(feature.place, *positions[0]))
            continue
        if all(map(exchanged, positions)):
            num_exchanged += 1
            lon, lat = positions[0]
            faults.append(
                Fault(
                    feature.place,
                    f"longitude {lon:.10g}, latitude {lat:.10g} look exchanged",
                    f"write longitude {lat:.10g} and latitude {lon:.10g}; in a pair, longitude comes first",
                )
            )
            continue
        for lon, lat in positions:
            fault = _coordinate_fault(feature.place, lon, lat)
            if fault is not None:
                faults.append(fault)
                break
    if len(located) > 1 and num_exchanged == len(located):
        return [Fault(f"all {len(located)} features", faults[0].message, faults[0].action)]
    return faults


def _lies_within(positions: Positions) -> bool:
    """Whether all positions are good, which is quickly told of the many that are."""
    lons, lats = zip(*positions, strict=True)
    extremes = (min(lons), max(lons), min(lats), max(lats))
    return bool(max(map(abs, extremes[:2])) <= 180.0 and max(map(abs, extremes[2:])) <= MAX_LATITUDE_DEG)


def _joined_fault(place: str, lon: float, lat: float) -> Fault:
    told = f"longitude {joined_text(lon)}, latitude {joined_text(lat)}"
    action = (
        "write degrees and minutes apart, as in 10 06.06; in a table, letters N, S, E and W beside the numbers will do"
    )
    message = f"{lon:.10g}, {lat:.10g} are no degrees; they look like degrees and minutes in one number: {told}"
    return Fault(place, message, f"{action}; if they are metres, export the file in WGS84 (EPSG:4326)")


def _coordinate_fault(place: str, lon: float, lat: float) -> Fault | None:
    if abs(lon) > 360.0 or abs(lat) > 360.0:
        message = f"{lon:.10g}, {lat:.10g} are no degrees; they look like metres of a map projection"
        return Fault(
            place, message, "export the file in WGS84 (EPSG:4326); in a table add a column zone, as in 48N, for UTM"
        )
    if abs(lat) > 90.0:
        return Fault(place, f"latitude {lat:.10g} is outside -90..90", "correct the latitude")
    if abs(lat) > MAX_LATITUDE_DEG:
        return Fault(place, f"no pond lies at latitude {lat:.10g}", "correct the latitude; is it a longitude?")
    if abs(lon) > 180.0:
        return Fault(place, f"longitude {lon:.10g} is outside -180..180", f"write {math.remainder(lon, 360.0):.10g}")
    return None
