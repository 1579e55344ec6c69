"""Farm files written by hand, for tests of what is read of them."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

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


def workbook(folder: Path, **sheets: Sequence[Sequence[object]]) -> Path:
    """An Excel workbook, its sheets by name."""
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    relations = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006/relationships"
    numbered = list(enumerate(sheets, start=1))
    listed = "".join(f'<sheet name={quoteattr(name)} sheetId="{at}" r:id="rId{at}"/>' for at, name in numbered)
    targets = "".join(
        f'<Relationship Id="rId{at}" Type="{relations}/worksheet" Target="worksheets/sheet{at}.xml"/>'
        for at, _ in numbered
    )
    office = f'<Relationship Id="rId1" Type="{relations}/officeDocument" Target="xl/workbook.xml"/>'
    path = folder / "farm.xlsx"
    kind = "application/vnd.openxmlformats-officedocument.spreadsheetml"
    kinds = "".join(
        f'<Override PartName="/xl/worksheets/sheet{at}.xml" ContentType="{kind}.worksheet+xml"/>' for at, _ in numbered
    )
    book = f'<Override PartName="/xl/workbook.xml" ContentType="{kind}.sheet.main+xml"/>'
    types = "http://schemas.openxmlformats.org/package/2006/content-types"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("[Content_Types].xml", f'<Types xmlns="{types}">{book}{kinds}</Types>')
        archive.writestr("_rels/.rels", f'<Relationships xmlns="{package}">{office}</Relationships>')
        archive.writestr("xl/_rels/workbook.xml.rels", f'<Relationships xmlns="{package}">{targets}</Relationships>')
        archive.writestr(
            "xl/workbook.xml", f'<workbook xmlns="{main}" xmlns:r="{relations}"><sheets>{listed}</sheets></workbook>'
        )
        for at, name in numbered:
            rows = "".join(f"<row>{''.join(map(_cell, row))}</row>" for row in sheets[name])
            archive.writestr(
                f"xl/worksheets/sheet{at}.xml", f'<worksheet xmlns="{main}"><sheetData>{rows}</sheetData></worksheet>'
            )
    return path


def _cell(value: object) -> str:
    if isinstance(value, (int, float)):
        return f"<c><v>{value}</v></c>"
    return f'<c t="inlineStr"><is><t>{escape(str(value))}</t></is></c>'
