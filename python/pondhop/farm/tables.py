"""Farm tables: a pond a line, as longitude and latitude, as four corners, or as an outline in WKT; or a corner a line.

Real tables hold typing errors; those that can be told from the other numbers of the same line are worked around with a
note that names line and column (`corners`), all others are faults.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import replace

from pondhop.errors import Fault
from pondhop.farm.columns import AXES, HEADER_ACTION, Columns, cell_of, find_columns, parted_pair
from pondhop.farm.corners import pond_from_corners
from pondhop.farm.degrees import Axis, angle_fault, hemisphere, metres, parse_degrees, parse_joined, side_of
from pondhop.farm.features import Feature, Geometry, OpenZone, Source, is_blank, listed, normal_name, shortened
from pondhop.farm.hints import POND_COLUMNS
from pondhop.farm.joined_minutes import table_has_joined_minutes
from pondhop.farm.letter_o import sign_of_o
from pondhop.farm.parted_angles import Row, join_parted_angles
from pondhop.farm.projections import names_band, reproject, utm_crs
from pondhop.farm.vocabulary import column_words
from pondhop.farm.words import is_plain_word, is_unnamed
from pondhop.places import LonLat
from pondhop.units import counted

MAX_CELL_CHARACTERS = 10_000_000
"""Python's own limit of 131,072 is less than an outline in WKT may have."""

MAX_TITLE_LINES = 10
"""How far below the top of a sheet the headings may stand."""

MIN_CORNERS = 3

_CORNER_ORDER = (
    "order",
    "vertex",
    "corner",
    "corner_no",
    "point",
    "point_no",
    "seq",
    "sequence",
    "vertice",
    "esquina",
    "orden",
)

_TOTALS = frozenset(map(normal_name, column_words("totals")))


def read_table(text: str, source: Source) -> None:
    """Read delimited text into features, one a line.

    Parameters
    ----------
    text
        Comma, semicolon, tab or bar between the columns, or what a first line ``sep=`` says. The first line with
        headings names the columns.
    source
        Where features, faults and notes go.
    """
    lines = text.splitlines()
    first = next((index for index, line in enumerate(lines) if line.strip()), 0)
    separator = re.fullmatch(r"\s*\"?sep=(.|\\t)\"?\s*", lines[first], re.IGNORECASE) if lines else None
    if separator:
        lines[first] = ""
    header_line = next((line for line in lines if line.strip()), "")
    delimiter = separator[1].replace("\\t", "\t") if separator else max(",;\t|", key=header_line.count)
    previous_limit = csv.field_size_limit(MAX_CELL_CHARACTERS)
    try:
        # Strict, because an unclosed quote would otherwise swallow the rest of the file as one cell.
        reader = csv.reader(lines, delimiter=delimiter, skipinitialspace=True, strict=True)
        rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except csv.Error as error:
        if '"' not in header_line and _has_inch_marks(lines):
            # Seconds of an angle are written with the very sign that quotes text.
            rows = [(number, line.split(delimiter)) for number, line in enumerate(lines, start=1) if line.strip()]
        else:
            source.faults.append(Fault("file", f"this is no table: {error}", "export the table again as CSV"))
            return
    finally:
        csv.field_size_limit(previous_limit)
    if not rows:
        source.faults.append(Fault("file", "the table is empty", HEADER_ACTION))
        return
    read_rows(rows, "line", source)


def _has_inch_marks(lines: Sequence[str]) -> bool:
    return any(re.search(r"\d[°º].*\d\"", line) for line in lines)


def read_sheet_rows(sheets: dict[str, list[list[str]]], source: Source) -> None:
    """Read the sheets of a workbook; those without coordinates are left out where another one has some."""
    source.layers.extend(sheets)
    readable: dict[str, Source] = {}
    failed: dict[str, Source] = {}
    for name, sheet in sheets.items():
        rows = [(number, row) for number, row in enumerate(sheet, start=1) if any(cell.strip() for cell in row)]
        if not rows:
            continue
        inner = Source(name=source.name)
        has_places = read_rows(rows, "row" if len(sheets) == 1 else f"sheet {name!r}, row", inner)
        for feature in inner.features:
            feature.folders = (name,) if len(sheets) > 1 else ()
        (readable if has_places else failed)[name] = inner
    if readable and failed:
        source.notes.add(f"Left out, because they have no coordinates: sheets {listed(map(repr, failed))}.")
    for inner in (readable or failed).values():
        source.features.extend(inner.features)
        source.open_zones.extend(inner.open_zones)
        source.faults.extend(inner.faults)
        for sentence in inner.notes.sentences():
            source.notes.add(sentence)
    if not readable and not failed and not source.faults:
        source.faults.append(Fault("file", "the table is empty", HEADER_ACTION))


def read_rows(rows: Sequence[Row], word: str, source: Source) -> bool:
    """Read the lines of a table, headings first, into features.

    Parameters
    ----------
    rows
        The lines that are not blank.
    word
        What a line is called in messages: ``line``, ``row``.
    source
        Where features, faults and notes go.

    Returns
    -------
    bool
        Whether headings name coordinates and there are lines below.
    """
    rows = join_parted_angles(rows, MAX_TITLE_LINES, source.notes)
    header, columns = _header(rows, word, source)
    if columns is None:
        return False
    below = rows[header + 1 :]
    if not below:
        source.faults.append(Fault("file", "the table has no line but the first", "add a line for each pond"))
        return False
    below = _without_totals(below, word, source)
    columns = replace(columns, sign_of_o=sign_of_o(columns, below, word, source))
    if not columns.sign_of_o:
        return True
    columns = replace(columns, has_joined_minutes=table_has_joined_minutes(columns, below, source.notes))
    features: list[Feature] = []
    zones: dict[str | int, list[Feature]] = {}
    has_bands = columns.zone is not None and any(names_band(_zone_text(row, columns)) for _, row in below)
    for number, row in below:
        feature = _read_row(f"{word} {number}", row, columns, source)
        if feature is None:
            continue
        if columns.zone is not None:
            zone = _zone(feature, row, columns, source, has_bands=has_bands)
            if zone is None:
                continue
            zones.setdefault(zone, []).append(feature)
        features.append(feature)
    for zone, members in zones.items():
        if isinstance(zone, str):
            reproject(zone, f"column {columns.names[columns.zone or 0]}", members, source)
    joined = _joined_corners(features, columns, source)
    for zone, members in zones.items():
        if isinstance(zone, int):
            places = {feature.place for feature in members}
            told = members[0].property_place.format(columns.names[columns.zone or 0])
            source.open_zones.append(OpenZone(zone, told, [feature for feature in joined if feature.place in places]))
    source.features.extend(joined)
    return True


def _without_totals(rows: Sequence[Row], word: str, source: Source) -> Sequence[Row]:
    """The lines without those at the end whose first cell says that they sum up the table, with a note."""
    end = len(rows)
    while end > 1 and _is_total(rows[end - 1][1]):
        end -= 1
    if end < len(rows):
        places = listed(f"{word} {number}" for number, _ in rows[end:])
        source.notes.add(f"Left out, because it sums up the table: {places}.")
    return rows[:end]


def _is_total(row: Sequence[str]) -> bool:
    first = next((cell for cell in row if cell.strip()), "")
    return normal_name(re.sub(r"\d", "", first)) in _TOTALS


def _degrees(cell: str, axis: Axis, columns: Columns) -> float | None:
    """The degrees of a cell, in the form of its table."""
    parse = parse_joined if columns.has_joined_minutes else parse_degrees
    return parse(cell, axis, columns.sign_of_o)


def _zone_text(row: Sequence[str], columns: Columns) -> str:
    """The zone of a line, with its band where that has a column of its own: ``48P``."""
    return cell_of(row, columns.zone) + cell_of(row, columns.zone_band)


def _zone(
    feature: Feature, row: Sequence[str], columns: Columns, source: Source, *, has_bands: bool
) -> str | int | None:
    """The coordinate system of a line with a zone of UTM, or its fault."""
    text = _zone_text(row, columns)
    side = hemisphere(cell_of(row, columns.zone_side))
    northing_m = feature.geometry.points[0][1] if feature.geometry.points else 0.0
    zone = utm_crs(text, side[1] if side else 0, northing_m, has_bands=has_bands)
    if zone is None:
        place = feature.property_place.format(columns.names[columns.zone or 0])
        action = "write number and hemisphere, as in 48N or 17S, or add a column hemisphere"
        told = f"{shortened(feature.name)!r}: " if feature.name else ""
        source.faults.append(Fault(place, f"{told}{shortened(text)!r} is no zone of UTM", action))
    return zone


def _header(rows: Sequence[Row], word: str, source: Source) -> tuple[int, Columns | None]:
    """The headings: the first line, or the first below a title that names coordinates."""
    faults: list[Fault] = []
    for index, (number, row) in enumerate(rows[: MAX_TITLE_LINES + 1]):
        tried = Source(source.name)
        columns = find_columns(row, [cells for _, cells in rows[index + 1 : index + 200]], f"{word} {number}", tried)
        if columns is not None:
            if index:
                source.notes.add(f"The headings were found in {word} {number}; the lines above it were left out.")
            return index, columns
        faults = faults or tried.faults
    source.faults.extend(faults)
    return 0, None


def _read_row(place: str, row: Sequence[str], columns: Columns, source: Source) -> Feature | None:
    names = columns.names
    if len(row) > len(names) and any(cell.strip() for cell in row[len(names) :]):
        message = f"{counted(len(row), 'value')} for {counted(len(names), 'column')}"
        action = "put text with commas in quotes, and write decimals with a point or separate columns with semicolons"
        source.faults.append(Fault(place, message, action))
        return None
    cells = (*row, *[""] * (len(names) - len(row)))
    geometry = Geometry()
    doubts: list[str] = []
    num_faults = len(source.faults)
    if columns.wkt is not None:
        _read_wkt(f"{place}, column {names[columns.wkt]}", cells[columns.wkt], geometry, source)
    else:
        if columns.pair is not None:
            parts = parted_pair(cells[columns.pair])
            column = f"{place}, column {names[columns.pair]}"
            if len(parts) != 2:
                source.faults.append(Fault(column, "the cell holds no pair of numbers", "write latitude, longitude"))
                return None
            lat, lon = _degrees(parts[0], "lat", columns), _degrees(parts[1], "lon", columns)
            if lat is None or lon is None:
                shown = shortened(cells[columns.pair].strip())
                wrong = next(filter(None, map(angle_fault, parts)), "is no number")
                source.faults.append(Fault(column, f"{shown!r} {wrong}", "write latitude, longitude in degrees"))
                return None
            geometry.points.append((lon, lat))
        positions = [
            position for pair in columns.corners if (position := _position(place, cells, pair, columns, source))
        ]
        if len(positions) == 1 == len(columns.corners):
            geometry.points.append(positions[0])
        elif len(positions) == 4:
            geometry.polygons.append([pond_from_corners(place, positions, columns, doubts, source)])
    if len(source.faults) > num_faults:
        return None
    used = columns.used()
    properties = {name: cells[index] for index, name in enumerate(names) if index not in used}
    return Feature(place, f"{place}, column {{}}", properties, geometry, doubts=doubts)


def _position(
    place: str, cells: Sequence[str], pair: tuple[int, int], columns: Columns, source: Source
) -> LonLat | None:
    numbers = [_number(place, cells, index, axis, columns, source) for index, axis in zip(pair, AXES, strict=True)]
    return None if numbers[0] is None or numbers[1] is None else (numbers[0], numbers[1])


def _number(
    row_place: str, cells: Sequence[str], index: int, axis: Axis, columns: Columns, source: Source
) -> float | None:
    cell, place = cells[index], f"{row_place}, column {columns.names[index]}"
    if is_blank(cell):
        source.faults.append(Fault(place, "the cell is empty", "fill in decimal degrees, or delete the line"))
        return None
    number = metres(cell) if columns.zone is not None else _degrees(cell, axis, columns)
    if number is None:
        action = "write metres, as in 576800" if columns.zone is not None else "write decimal degrees, as in -89.17"
        wrong = None if columns.zone is not None else angle_fault(cell)
        if wrong is not None:
            action = "correct the minutes or seconds, or write decimal degrees, as in -89.17"
        source.faults.append(Fault(place, f"{shortened(cell.strip())!r} {wrong or 'is no number'}", action))
        return None
    sign, told = columns.signs.get(axis, 1) or columns.sign_of_o, "its heading"
    if axis in columns.sides:
        letter = cells[columns.sides[axis]]
        side = side_of(letter, axis)
        told = f"column {columns.names[columns.sides[axis]]}"
        if side is None and not is_blank(letter):
            source.faults.append(
                Fault(place, f"{shortened(letter)!r} in {told} is no hemisphere", "write N, S, E or W")
            )
            return None
        sign = side or columns.sign_of_o if side is not None else 1
        if number < 0.0 < sign and side is not None:
            message = f"{cell.strip()} is negative, but {told} says {letter.strip()}"
            source.faults.append(Fault(place, message, "correct the sign, or the letter"))
            return None
    if sign < 0 < number:
        axis_name = "Longitudes" if axis == "lon" else "Latitudes"
        source.notes.add(f"{axis_name} were taken as negative where {told} says so (west and south).")
        return -number
    return number


def _read_wkt(place: str, cell: str, geometry: Geometry, source: Source) -> None:
    import shapely

    try:
        shape = shapely.from_wkt(cell, on_invalid="ignore") if cell.strip() else None
    except NotImplementedError:
        message = f"{shortened(cell.strip())!r} has curves"
        source.faults.append(
            Fault(place, message, "turn the curves into straight lines (in QGIS: Convert curved geometry)")
        )
        return
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
            Fault(place, f"{shortened(cell.strip())!r} is no WKT", "write POLYGON ((lon lat, lon lat, ...))")
        )


def _joined_corners(features: list[Feature], columns: Columns, source: Source) -> list[Feature]:
    """The features, those joined to one outline that are points with one id: tables with a corner a line.

    Only where every id that is there several times is there at least three times: two lines are a typing error.
    """
    id_column = next((name for name in columns.names if normal_name(name) in POND_COLUMNS), None)
    if len(columns.corners) != 1 or id_column is None:
        return features
    groups: dict[str, list[Feature]] = {}
    for number, feature in enumerate(features):
        value = feature.properties.get(id_column)
        text = "" if is_blank(value) else str(value).strip()
        # What a program or nobody in particular calls a pond is no id that corners could share.
        is_id = text and not is_unnamed(text) and not is_plain_word(text) and not feature.find("role")
        key = text if is_id else f"\0{number}"
        groups.setdefault(key, []).append(feature)
    repeated = [members for members in groups.values() if len(members) > 1]
    if not repeated or min(map(len, repeated)) < MIN_CORNERS or _is_one_name(groups):
        return features
    joined: list[Feature] = []
    for members in groups.values():
        if len(members) == 1:
            joined.extend(members)
            continue
        if all(member.find(*_CORNER_ORDER) for member in members):
            members = sorted(members, key=_corner_number)
        first = members[0]
        ring = [member.geometry.points[0] for member in members]
        joined.append(Feature(first.place, first.property_place, first.properties, Geometry(polygons=[[ring]])))
    num_lines, outlines = sum(map(len, repeated)), counted(len(repeated), "outline")
    source.notes.add(f"{num_lines} lines were joined to {outlines}, a corner a line, by column {id_column!r}.")
    return joined


def _is_one_name(groups: dict[str, list[Feature]]) -> bool:
    """Whether all lines have one and the same name, which names nothing."""
    return len(groups) == 1 and len(next(iter(groups.values()))) > 50


def _corner_number(feature: Feature) -> float:
    found = feature.find(*_CORNER_ORDER)
    number = parse_degrees(str(found[1]), "lon") if found else None
    return math.inf if number is None else number
