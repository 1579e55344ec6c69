"""Farm tables: a pond a line, as longitude and latitude, as four corners, or as an outline in WKT.

Real tables hold typing errors; those that can be told from the other numbers of the same line are worked around with a
note that names line and column (`_pond_from_corners`), all others are faults.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from pondhop.errors import Fault
from pondhop.farm.features import Feature, Geometry, Source, is_blank, normal_name, number_of
from pondhop.places import LonLat

Axis = Literal["lon", "lat"]
_AXES: tuple[Axis, Axis] = ("lon", "lat")

_LON = r"(?:gps)?(?:longitude|long|lon|lng|x)"
_LAT = r"(?:gps)?(?:latitude|lat|y)"
_UNIT = r"(?:deg|degrees|degree|dd|wgs84|decimal|epsg4326)?"
_CORNERS = {
    **dict.fromkeys(("ul", "tl", "nw", "upperleft", "topleft", "northwest"), 0),
    **dict.fromkeys(("ll", "bl", "sw", "lowerleft", "bottomleft", "southwest"), 1),
    **dict.fromkeys(("lr", "br", "se", "lowerright", "bottomright", "southeast"), 2),
    **dict.fromkeys(("ur", "tr", "ne", "upperright", "topright", "northeast"), 3),
    **{str(number): number - 1 for number in (1, 2, 3, 4)},
}
"""Position of a corner in a ring that runs upper left, lower left, lower right, upper right; or as numbered."""

OUTLIER_RATIO = 3.0
"""A corner further from its nearest sibling than this times the extent of the other three is mistyped.

In a rectangle of any shape the ratio is below 1; above 3 the pond would be a needle.
"""

HEADER_ACTION = "name the columns in the first line, as in: pond,lon,lat"


@dataclass(frozen=True)
class _Columns:
    """Which column holds what: ``corners`` has column indices of longitude and latitude, four times or for a point."""

    names: tuple[str, ...]
    corners: tuple[tuple[int, int], ...]
    wkt: int | None
    is_compass: bool


def read_table(text: str, source: Source) -> None:
    """Read delimited text into features, one a line.

    Parameters
    ----------
    text
        Comma, semicolon, tab or bar between the columns; with any but the comma, decimal commas are understood. The
        first line names the columns.
    source
        Where features, faults and notes go.
    """
    lines = text.splitlines()
    header_line = next((line for line in lines if line.strip()), "")
    delimiter = max(",;\t|", key=header_line.count)
    try:
        # Strict, because an unclosed quote would otherwise swallow the rest of the file as one cell.
        reader = csv.reader(lines, delimiter=delimiter, skipinitialspace=True, strict=True)
        rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except csv.Error as error:
        source.faults.append(Fault("file", f"this is no table: {error}", "export the table again as CSV"))
        return
    if not rows:
        source.faults.append(Fault("file", "the table is empty", HEADER_ACTION))
        return
    columns = _find_columns(rows[0][1], source)
    if columns is None:
        return
    if len(rows) == 1:
        source.faults.append(Fault("file", "the table has no line but the first", "add a line for each pond"))
    for line, row in rows[1:]:
        _read_row(line, row, delimiter != ",", columns, source)


def _axis(name: str) -> tuple[Axis, str] | None:
    """Which coordinate a column holds, and of which corner: ``lat_ul`` and ``UL Latitude`` are both (lat, ul)."""
    plain = normal_name(name)
    for axis, pattern in zip(_AXES, (_LON, _LAT), strict=True):
        corner = "|".join(sorted(_CORNERS, key=len, reverse=True))
        for form in (
            rf"{pattern}{_UNIT}(?P<corner>{corner})?{_UNIT}",
            rf"(?:corner)?(?P<corner>{corner}){pattern}{_UNIT}",
        ):
            match = re.fullmatch(form, plain)
            if match:
                return axis, match["corner"] or ""
    return None


def _find_columns(header: Sequence[str], source: Source) -> _Columns | None:
    names = tuple(name.strip() for name in header)
    wkt = next((i for i, name in enumerate(names) if normal_name(name) in {"wkt", "geometry", "geom", "thegeom"}), None)
    found: dict[tuple[Axis, str], int] = {}
    for index, name in enumerate(names):
        key = _axis(name)
        if key is None:
            continue
        if key in found:
            message = f"columns {names[found[key]]!r} and {name!r} both hold a {key[0]}"
            source.faults.append(Fault("line 1", message, "keep one of them"))
            return None
        found[key] = index
    if wkt is None and not found:
        shown = ", ".join(names)[:80]
        seen = "numbers" if sum(number_of(name) is not None for name in names) > 1 else f"columns {shown}"
        message = f"no longitude and latitude columns; the first line has {seen}"
        source.faults.append(Fault("line 1", message, HEADER_ACTION))
        return None
    if not found:
        return _Columns(names, (), wkt, is_compass=False)
    labels = sorted({corner for _, corner in found if corner})
    by_corner = {_CORNERS[label]: label for label in labels}
    is_compass = not any(label.isdecimal() for label in labels)
    expected = [
        by_corner.get(corner, ("ul", "ll", "lr", "ur")[corner] if is_compass else str(corner + 1))
        for corner in range(4)
    ]
    missing = [f"{axis} of corner {label}" for label in expected for axis in _AXES if (axis, label) not in found]
    if not missing:
        corners = tuple((found["lon", label], found["lat", label]) for label in expected)
        return _Columns(names, corners, None, is_compass)
    if not labels or any((axis, "") in found for axis in _AXES):
        missing = [axis for axis in _AXES if (axis, "") not in found]
        if not missing:
            return _Columns(names, ((found["lon", ""], found["lat", ""]),), None, is_compass=False)
    source.faults.append(Fault("line 1", f"no column for {', '.join(missing)}", HEADER_ACTION))
    return None


def _read_row(line: int, row: Sequence[str], has_decimal_comma: bool, columns: _Columns, source: Source) -> None:
    place = f"line {line}"
    names = columns.names
    if len(row) > len(names) and any(cell.strip() for cell in row[len(names) :]):
        message = f"{len(row)} values for {len(names)} columns"
        action = "put text with commas in quotes, and write decimals with a point or separate columns with semicolons"
        source.faults.append(Fault(place, message, action))
        return
    cells = dict(zip(names, (*row, *[""] * (len(names) - len(row))), strict=False))
    geometry = Geometry()
    num_faults = len(source.faults)
    if columns.wkt is not None:
        _read_wkt(f"{place}, column {names[columns.wkt]}", cells[names[columns.wkt]], geometry, source)
    else:
        numbers = {
            index: _number(f"{place}, column {names[index]}", cells[names[index]], has_decimal_comma, source)
            for pair in columns.corners
            for index in pair
        }
        positions = [
            (lon, lat)
            for lon, lat in ((numbers[lon_column], numbers[lat_column]) for lon_column, lat_column in columns.corners)
            if lon is not None and lat is not None
        ]
        if len(positions) == 1 == len(columns.corners):
            geometry.points.append(positions[0])
        elif len(positions) == 4:
            geometry.polygons.append([_pond_from_corners(place, positions, columns, source)])
    if len(source.faults) > num_faults:
        return
    used = {index for pair in columns.corners for index in pair} | {columns.wkt}
    properties = {name: cells[name] for index, name in enumerate(names) if index not in used}
    source.features.append(Feature(place, f"{place}, column {{}}", properties, geometry))


def _number(place: str, cell: str, has_decimal_comma: bool, source: Source) -> float | None:
    if is_blank(cell):
        source.faults.append(Fault(place, "the cell is empty", "fill in decimal degrees, or delete the line"))
        return None
    number = number_of(cell.replace(",", ".") if has_decimal_comma else cell)
    if number is None:
        source.faults.append(Fault(place, f"{cell.strip()[:40]!r} is no number", "write decimal degrees, as in -89.17"))
    return number


def _read_wkt(place: str, cell: str, geometry: Geometry, source: Source) -> None:
    import shapely

    shape = shapely.from_wkt(cell, on_invalid="ignore") if cell.strip() else None
    parts = [] if shape is None else list(shapely.get_parts(shape))
    for part in parts:
        lonlats = [(float(x), float(y)) for x, y in shapely.get_coordinates(part)]
        if not all(math.isfinite(value) for lonlat in lonlats for value in lonlat) or not lonlats:
            source.faults.append(Fault(place, "a coordinate is missing or no number", "write longitude, then latitude"))
        elif part.geom_type == "Point":
            geometry.points.extend(lonlats)
        elif part.geom_type == "Polygon":
            rings = (part.exterior, *part.interiors)
            geometry.polygons.append([[(float(x), float(y)) for x, y in shapely.get_coordinates(r)] for r in rings])
        else:
            geometry.lines.append(lonlats)
    if not parts:
        source.faults.append(
            Fault(place, f"{cell.strip()[:40]!r} is no WKT", "write POLYGON ((lon lat, lon lat, ...))")
        )


def _pond_from_corners(place: str, corners: list[LonLat], columns: _Columns, source: Source) -> list[LonLat]:
    """The outline of a pond whose four corners were typed by hand.

    A corner that lies off by more than `OUTLIER_RATIO` is replaced by the one that completes the other three to a
    parallelogram, which ponds nearly are, so that the centre of the pond stays right. Corners that do not lie around
    the pond in the order of their names are joined in the order that they do, by angle around their mean. Both leave a
    note.
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
        source.notes.append(
            f"{place}: one corner lies far from the other three and was placed from them ({'; '.join(off)})."
        )
    centre = (sum(lon for lon, _ in ring) / 4, sum(lat for _, lat in ring) / 4)
    around = sorted(range(4), key=lambda c: math.atan2(ring[c][1] - centre[1], ring[c][0] - centre[0]))
    start = around.index(0)
    order = around[start:] + around[:start]
    if order not in ([0, 1, 2, 3], [0, 3, 2, 1]):
        names = ", ".join(columns.names[lat] for _, lat in columns.corners)
        because = f"columns {names} contradict each other; one is mistyped" if columns.is_compass else "check them"
        source.notes.append(
            f"{place}: the corners are not in order around the pond and were joined by angle ({because})."
        )
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
