"""Farm files written by hand, for tests of what is read of them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pytest

from pondhop import InvalidInput
from pondhop.farm import Farm, read_farm

DEPOT = (105.6985, 10.0995)
PONDS = [f"Pond {number}" for number in range(1, 7)]


def faults_of(path: Path, **options: object) -> list[tuple[str, str, str]]:
    with pytest.raises(InvalidInput) as caught:
        read_farm(path, **options)  # type: ignore[arg-type]
    return [(fault.path, fault.message, fault.action) for fault in caught.value.faults]


def ids(farm: Farm) -> list[str]:
    return [pond.id for pond in farm.ponds]


def square(column: int, row: int, size: float = 0.0018) -> list[list[float]]:
    west, south = 105.7 + 0.002 * column, 10.1 + 0.001 * row
    east, north = west + size, south + size / 2
    return [[west, south], [east, south], [east, north], [west, north], [west, south]]


def polygon(column: int, row: int, **properties: object) -> dict[str, object]:
    geometry = {"type": "Polygon", "coordinates": [square(column, row)]}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def shape(kind: str, coordinates: object, **properties: object) -> dict[str, object]:
    return {"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": coordinates}}


def ponds(number: int = 3) -> list[dict[str, object]]:
    return [polygon(index % 3, index // 3, name=f"Pond {index + 1}") for index in range(number)]


def geojson(folder: Path, *features: Mapping[str, object], **members: object) -> Path:
    path = folder / "farm.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", **members, "features": list(features)}), "utf-8")
    return path


def table(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    path = folder / "farm.csv"
    path.write_bytes(text.encode(encoding))
    return path


def placemark(name: str, body: str) -> str:
    return f"<Placemark><name>{name}</name>{body}</Placemark>"


def kml_polygon(column: int, row: int) -> str:
    corners = " ".join(f"{lon},{lat},0" for lon, lat in square(column, row))
    ring = f"<LinearRing><coordinates>{corners}</coordinates></LinearRing>"
    return f"<Polygon><outerBoundaryIs>{ring}</outerBoundaryIs></Polygon>"


def kml(folder: Path, *parts: str, suffix: str = ".kml") -> Path:
    path = folder / f"farm{suffix}"
    path.write_text(f'<kml xmlns="http://www.opengis.net/kml/2.2"><Document>{"".join(parts)}</Document></kml>', "utf-8")
    return path
