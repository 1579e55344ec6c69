"""Coordinate systems of farm files: every feature is brought into WGS84, longitude first."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Geometry, Positions, Source, shortened

if TYPE_CHECKING:
    import pyproj

_NORTHERN_BANDS, _SOUTHERN_BANDS = "NPQRTUVWX", "CDEFGHJKLM"
"""Latitude bands of UTM. S, a northern band, is left out: people write it for the southern hemisphere."""


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


def utm_crs(text: str) -> str | None:
    """The coordinate system that a cell of a column "zone" names: ``48N``, ``zone 17 S``, ``32P``, ``EPSG:32648``.

    ``None`` where zone or hemisphere are missing: half of the globe apart is no detail.
    """
    plain = text.strip().upper()
    code = re.search(r"EPSG:{1,2}(\d{4,6})|^(32[67]\d\d)$", plain)
    if code:
        return f"EPSG:{code[1] or code[2]}"
    zones = re.findall(r"(?<!\d)(\d{1,2})\s*(NORTH|SOUTH|NORTE|SUR|SUL|[C-HJ-NP-X])(?![A-Z\d])", plain)
    for number, half in zones:
        is_south = half in {"S", "SOUTH", "SUR", "SUL"} or (len(half) == 1 and half in _SOUTHERN_BANDS)
        is_north = half in {"NORTH", "NORTE"} or (len(half) == 1 and half in _NORTHERN_BANDS)
        if 1 <= int(number) <= 60 and (is_south or is_north):
            return f"EPSG:{(327 if is_south else 326) * 100 + int(number)}"
    return None
