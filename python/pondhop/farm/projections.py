"""Coordinate systems of farm files: every feature is brought into WGS84, longitude first."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Geometry, OpenZone, Positions, Source, shortened
from pondhop.places import LonLat, distance_m

if TYPE_CHECKING:
    import pyproj

_NORTHERN_BANDS, _SOUTHERN_BANDS = "NPQRTUVWX", "CDEFGHJKLM"
"""Latitude bands of UTM. S is left out: it is a northern band, and people write it for the southern half."""

_BAND_S_END_M = 4_440_000.0
"""The largest northing of band S. In the southern half it lies beyond 50 degrees, where nobody farms."""

NEAR_M = 200_000.0
"""Places of one farm lie nearer to each other; the two halves of a zone lie thousands of kilometres apart."""


def reproject(crs_name: str, place: str, features: Sequence[Feature], source: Source) -> None:
    """Bring features into WGS84, longitude first, with a note."""
    import pyproj

    try:
        crs = pyproj.CRS.from_user_input(crs_name)
        if crs.is_geographic and crs.name in {"WGS 84", "WGS 84 (CRS84)"}:
            return
        transformer = pyproj.Transformer.from_crs(crs, "EPSG:4326", always_xy=True)
    except pyproj.exceptions.ProjError:
        action = "export the file in WGS84 (EPSG:4326)"
        shown = shortened(json.dumps(crs_name, ensure_ascii=False))
        source.faults.append(Fault(place, f"the coordinate system {shown} is unknown", action))
        return
    for feature in features:
        geometry = feature.geometry
        feature.geometry = Geometry(
            _transformed(geometry.points, transformer),
            [_transformed(line, transformer) for line in geometry.lines],
            [[_transformed(ring, transformer) for ring in polygon] for polygon in geometry.polygons],
        )
        if not all(math.isfinite(lon) and math.isfinite(lat) for lon, lat in feature.geometry.positions()):
            message = f"the coordinates lie outside {crs.name}"
            source.faults.append(Fault(feature.place, message, "check the coordinate system of the file"))
            feature.geometry = Geometry()
    source.notes.add(f"Coordinates were converted from {crs.name} to WGS84.")


def _transformed(positions: Positions, transformer: pyproj.Transformer) -> Positions:
    if not positions:
        return []
    xs, ys = zip(*positions, strict=True)
    lons, lats = transformer.transform(xs, ys)
    return list(zip(map(float, lons), map(float, lats), strict=True))


def utm_crs(text: str, side: int = 0, northing_m: float = 0.0, *, has_bands: bool = False) -> str | int | None:
    """The coordinate system that a cell of a column "zone" names: ``48N``, ``zone 17 S``, ``32P``, ``EPSG:32648``.

    ``None`` where zone or hemisphere are missing: half of the globe apart is no detail. Of a zone whose letter S may be
    the southern half or the northern band S, the number.

    Parameters
    ----------
    text
        The cell.
    side
        What a column of hemispheres says: 1 for north, -1 for south, 0 for nothing.
    northing_m
        The northing of the line: beyond those of band S the letter is the half.
    has_bands
        Whether other letters of the column can only be bands.
    """
    plain = text.strip().upper()
    code = re.search(r"EPSG:{1,2}(\d{4,6})|^(32[67]\d\d)$", plain)
    if code:
        return f"EPSG:{code[1] or code[2]}"
    zones = re.findall(r"(?<!\d)(\d{1,2})\s*(NORTH|SOUTH|NORTE|SUR|SUL|[C-HJ-NP-X]|$)(?![A-Z\d])", plain)
    for number, half in zones:
        if not 1 <= int(number) <= 60:
            continue
        sign = side
        if not sign and half == "S":
            if not has_bands and northing_m <= _BAND_S_END_M:
                return int(number)
            sign = 1 if has_bands else -1
        elif not sign and half:
            sign = -1 if half in {"SOUTH", "SUR", "SUL"} or (len(half) == 1 and half in _SOUTHERN_BANDS) else 1
        if sign:
            return half_zone(int(number), sign)
    return None


def half_zone(number: int, sign: int) -> str:
    """The coordinate system of the northern or southern half of a zone of UTM."""
    return f"EPSG:{(327 if sign < 0 else 326) * 100 + number}"


def names_band(text: str) -> bool:
    """Whether a zone of UTM is written with a letter that can only be a band of latitudes."""
    match = re.fullmatch(r"\D*\d{1,2}\s*([C-HJ-NP-X])", text.strip().upper())
    return match is not None and match[1] not in "NS"


def settle_zones(source: Source, depot: LonLat | None) -> None:
    """Bring features of zones that may be north or south where other places of the file or the depot are; else ask."""
    for zone in source.open_zones:
        in_question = {id(feature) for other in source.open_zones for feature in other.features}
        others = [feature for feature in source.features if id(feature) not in in_question]
        known = (
            [depot] if depot is not None else [place for other in others for place in other.geometry.positions()[:1]]
        )
        signs = [sign for sign in (1, -1) if _lies_near(zone, sign, known)]
        if len(signs) == 1:
            reproject(half_zone(zone.number, signs[0]), zone.place, zone.features, source)
            continue
        message = f"is {zone.number} north or south? S is a band of latitudes in the north, and the southern half"
        source.faults.append(Fault(zone.place, message, f"write {zone.number} north or {zone.number} south"))
        unsettled = {id(feature) for feature in zone.features}
        source.features = [feature for feature in source.features if id(feature) not in unsettled]
    source.open_zones.clear()


def _lies_near(zone: OpenZone, sign: int, known: Sequence[LonLat]) -> bool:
    import pyproj

    transformer = pyproj.Transformer.from_crs(half_zone(zone.number, sign), "EPSG:4326", always_xy=True)
    places = _transformed(
        [place for feature in zone.features for place in feature.geometry.positions()[:1]], transformer
    )
    return any(
        abs(lat) <= 90.0 and abs(known_lat) <= 90.0 and distance_m((lon, lat), (known_lon, known_lat)) <= NEAR_M
        for lon, lat in places[:1]
        for known_lon, known_lat in known
    )
