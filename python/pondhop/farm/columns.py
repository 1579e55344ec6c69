"""Which column of a table holds what, in the headings of many languages and programs."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from pondhop.errors import Fault
from pondhop.farm.degrees import Axis, hemisphere, names_both_sides, side_of
from pondhop.farm.features import Source, normal_name, number_of
from pondhop.farm.vocabulary import column_words

AXES: tuple[Axis, Axis] = ("lon", "lat")

HEADER_ACTION = "name the columns in the first line, as in: pond,lon,lat"


def _any_of(*words: str) -> str:
    return "|".join(sorted((re.escape(normal_name(word)) for word in words), key=len, reverse=True))


_LON_WORDS = _any_of(*column_words("longitude"))
_LAT_WORDS = _any_of(*column_words("latitude"))
_BEFORE = (
    r"(?:gps|coordenadas?|coordinates?|coord|coor|koordinate|point|pos|position|map|geo|ponto|punto|centroid|center)?"
)
_AFTER = (
    r"(?:coordenada|coordinate|coord|coor)?(?:deg|degrees|degree|dd|wgs84|decimal|decimals|epsg4326|grados|graus|gps|dms|gms|"
    r"decimaldegrees|gradosdecimales|grausdecimais)?"
)
_SIDE = (
    r"(?P<side>north|south|east|west|norte|sur|sul|este|leste|oeste|"
    r"nord|süd|sud|ost|oost|noord|zuid|ouest|ovest|[nsewo])?"
)
_CORNERS = {
    **dict.fromkeys(("ul", "tl", "nw", "upperleft", "topleft", "northwest"), 0),
    **dict.fromkeys(("ll", "bl", "sw", "lowerleft", "bottomleft", "southwest"), 1),
    **dict.fromkeys(("lr", "br", "se", "lowerright", "bottomright", "southeast"), 2),
    **dict.fromkeys(("ur", "tr", "ne", "upperright", "topright", "northeast"), 3),
    **{str(number): number - 1 for number in (1, 2, 3, 4)},
}
"""Position of a corner in a ring that runs upper left, lower left, lower right, upper right; or as numbered."""

_EASTING = _any_of(*column_words("easting"))
_NORTHING = _any_of(*column_words("northing"))
_ZONE = _any_of(*column_words("zone"))
_BAND = _any_of(*column_words("band"))
_METRES = re.compile(r"[(\[]\s*m(?:et(?:re|er|ro)s?)?\.?\s*[)\]]", re.IGNORECASE)
_PAIR = _any_of(*column_words("pair"))
_LAT_SIDE = _any_of(*column_words("side_of_latitude"))
_SIDE_NAMES = frozenset(map(normal_name, column_words("side")))
_LON_SIDE = _any_of(*column_words("side_of_longitude"))


@dataclass(frozen=True)
class Columns:
    """Which column holds what.

    Attributes
    ----------
    names
        The headings.
    corners
        Column indices of longitude and latitude: one pair for a point, four for the corners of a pond.
    wkt
        The column of outlines as text.
    is_compass
        Whether corners are named by where they lie.
    sides
        Column with the letter of the hemisphere for each axis.
    signs
        What a heading such as ``Lat (S)`` says about positive numbers; 0 for the letter O.
    zone
        The column with the zone of UTM; then `corners` are easting and northing.
    zone_side
        The column that says whether the zone is the northern or the southern half.
    zone_band
        The column with the letter of the latitude band of the zone.
    pair
        A column that holds latitude and longitude, as map programs copy them.
    sign_of_o
        What the letter O says about a longitude.
    has_joined_minutes
        Whether degrees and minutes are one number, as GPS receivers write them.
    """

    names: tuple[str, ...]
    corners: tuple[tuple[int, int], ...] = ()
    wkt: int | None = None
    is_compass: bool = False
    sides: dict[Axis, int] = field(default_factory=dict)
    signs: dict[Axis, int] = field(default_factory=dict)
    zone: int | None = None
    zone_side: int | None = None
    zone_band: int | None = None
    pair: int | None = None
    sign_of_o: int = -1
    has_joined_minutes: bool = False

    def used(self) -> set[int]:
        """Indices of the columns that tell where a pond is."""
        found = {index for pair in self.corners for index in pair} | set(self.sides.values())
        return found | {
            index for index in (self.wkt, self.zone, self.zone_side, self.zone_band, self.pair) if index is not None
        }


def _axis(name: str) -> tuple[Axis, str, int] | None:
    """Which coordinate a column holds, of which corner, and the sign its heading gives.

    ``lat_ul`` and ``UL Latitude`` are both (lat, ul); ``Lat (S)`` is negative.
    """
    plain = normal_name(name)
    for axis, words in zip(AXES, (_LON_WORDS, _LAT_WORDS), strict=True):
        corner = "|".join(sorted(_CORNERS, key=len, reverse=True))
        for form in (
            rf"{_BEFORE}(?:{words}){_AFTER}(?P<corner>{corner})?{_AFTER}",
            rf"(?:corner)?(?P<corner>{corner}){_BEFORE}(?:{words}){_AFTER}",
        ):
            match = re.fullmatch(form, plain)
            if match:
                return axis, match["corner"] or "", 1
        match = re.fullmatch(rf"{_BEFORE}(?:{words}){_AFTER}{_SIDE}{_AFTER}", plain)
        side = hemisphere(match["side"]) if match and match["side"] else None
        if side is not None and side[0] == axis:
            return axis, "", side[1]
    return None


def axis_of(plain: str) -> Axis | None:
    """The coordinate that a normal heading names by a word and nothing else: ``lat``, ``gpslongitude``, not ``x``."""
    if plain in {"x", "y"}:
        return None
    for axis, words in zip(AXES, (_LON_WORDS, _LAT_WORDS), strict=True):
        if re.fullmatch(rf"{_BEFORE}(?:{words}){_AFTER}", plain):
            return axis
    return None


def find_columns(header: Sequence[str], rows: Sequence[Sequence[str]], place: str, source: Source) -> Columns | None:
    """Find the columns of a table, or tell what is missing.

    Parameters
    ----------
    header
        The headings.
    rows
        Some lines below, which tell letters of hemispheres from other letters.
    place
        Where the headings stand, for faults.
    source
        Gets the faults.
    """
    # A column without heading still may hold what tells the ponds apart, and faults must be able to name it.
    names = tuple(name.strip() or f"{number} (no heading)" for number, name in enumerate(header, start=1))
    plain = [normal_name(name) for name in names]
    wkt = next(
        (index for index, name in enumerate(plain) if name in {"wkt", "geometry", "geom", "thegeom", "shape"}), None
    )
    if wkt is not None and rows and not any("(" in row[wkt] for row in rows if len(row) > wkt):
        wkt = None
    found: dict[tuple[Axis, str], int] = {}
    signs: dict[Axis, int] = {}
    for index, name in enumerate(names):
        key = _axis(name)
        if key is None:
            continue
        axis, corner, sign = key
        if (axis, corner) in found:
            message = f"columns {names[found[axis, corner]]!r} and {name!r} both hold a {axis}"
            source.faults.append(Fault(place, message, "keep one of them"))
            return None
        found[axis, corner] = index
        if sign <= 0:
            signs[axis] = sign
    pair = _pair_column(plain, rows) if not found and wkt is None else None
    if pair is not None:
        return Columns(names, pair=pair)
    zone = next((index for index, name in enumerate(plain) if re.fullmatch(_ZONE, name)), None)
    eastings, northings = _metre_columns(names, found, zone, rows)
    if zone is not None and len(eastings) == len(northings) == 1:
        band = _zone_band(plain, rows, zone)
        side = _zone_side(plain, rows, zone) if band is None else None
        return Columns(names, ((eastings[0], northings[0]),), zone=zone, zone_side=side, zone_band=band)
    if wkt is None and not found:
        shown = ", ".join(names)[:80]
        seen = "numbers" if sum(number_of(name) is not None for name in names) > 1 else f"columns {shown}"
        action = HEADER_ACTION
        if eastings and northings:
            of_utm = f"{names[eastings[0]]} and {names[northings[0]]}"
            action = f"add a column zone, as in 48N, for the {of_utm} of UTM; or {action}"
        source.faults.append(Fault(place, f"no longitude and latitude columns; the first line has {seen}", action))
        return None
    if not found or (wkt is not None and ("lon", "") not in found):
        return Columns(names, (), wkt)
    sides, open_sides = _sides(plain, rows, found)
    for index in sorted(open_sides):
        letters = _filled(rows, index)[0]
        message = f"does column {names[index]!r} tell the hemisphere? It holds {letters!r}"
        action = "call the column hemisphere if it does; if not, leave it out or write words"
        source.faults.append(Fault(place, message, action))
    return None if open_sides else _with_corners(names, found, sides, signs, place, source)


def cell_of(row: Sequence[str], index: int | None) -> str:
    """A cell of a line without the blanks around it; empty where there is no such column, or the line is too short."""
    return "" if index is None or index >= len(row) else row[index].strip()


def _filled(rows: Sequence[Sequence[str]], index: int) -> list[str]:
    """The cells of a column that are not blank, without the blanks around them."""
    return [cell for row in rows if (cell := cell_of(row, index))]


def _metre_columns(
    names: Sequence[str], found: dict[tuple[Axis, str], int], zone: int | None, rows: Sequence[Sequence[str]]
) -> tuple[list[int], list[int]]:
    """The columns of eastings and of northings: called so; beside a zone, X and Y that are metres, or E and N."""
    plain = [normal_name(_METRES.sub("", name)) for name in names]
    eastings = [index for index, name in enumerate(plain) if re.fullmatch(_EASTING, name)]
    northings = [index for index, name in enumerate(plain) if re.fullmatch(_NORTHING, name)]
    if eastings or northings or zone is None:
        return eastings, northings
    if ("lon", "") in found and ("lat", "") in found:
        is_metres = any(_is_beyond_degrees(row, found["lon", ""]) for row in rows)
        return ([found["lon", ""]], [found["lat", ""]]) if is_metres else ([], [])
    for pair in (("x", "y"), ("e", "n")):
        if all(plain.count(name) == 1 for name in pair):
            return [plain.index(pair[0])], [plain.index(pair[1])]
    return [], []


def _zone_band(plain: Sequence[str], rows: Sequence[Sequence[str]], zone: int) -> int | None:
    """The column with the letter of the band, beside zones that are numbers."""
    if not all(map(str.isdecimal, _filled(rows, zone))):
        return None
    for index, name in enumerate(plain):
        cells = _filled(rows, index)
        if re.fullmatch(_BAND, name) and cells and all(re.fullmatch("[C-HJ-NP-Xc-hj-np-x]", cell) for cell in cells):
            return index
    return None


def _zone_side(plain: Sequence[str], rows: Sequence[Sequence[str]], zone: int) -> int | None:
    """The column that holds north or south for a zone of UTM: called so, or right beside it."""
    for index, name in enumerate(plain):
        cells = _filled(rows, index)
        is_named = name in _SIDE_NAMES or re.fullmatch(_LAT_SIDE, name) or index == zone + 1
        if is_named and cells and all((hemisphere(cell) or ("", 0))[0] == "lat" for cell in cells):
            return index
    return None


def _pair_column(plain: Sequence[str], rows: Sequence[Sequence[str]]) -> int | None:
    """The column of coordinates, latitude first, whose name says so and whose cells all hold two numbers."""
    for index, name in enumerate(plain):
        cells = _filled(rows, index)
        is_named = re.fullmatch(_PAIR, name) is not None
        if is_named and cells and all(len(parted_pair(cell)) == 2 for cell in cells):
            return index
    return None


def parted_pair(cell: str) -> list[str]:
    """The two coordinates of a cell such as ``10.1004, 105.7009``."""
    text = cell.strip().strip("()[]").replace("\N{ARABIC COMMA}", ",")
    for separator in (";", ", ", ",", " "):
        parts = [part.strip() for part in text.split(separator) if part.strip()]
        if len(parts) == 2:
            return parts
    return []


def _is_beyond_degrees(row: Sequence[str], index: int) -> bool:
    number = number_of(row[index].replace(",", "")) if index < len(row) else None
    return number is not None and abs(number) > 360.0


def _sides(
    plain: Sequence[str], rows: Sequence[Sequence[str]], found: dict[tuple[Axis, str], int]
) -> tuple[dict[Axis, int], set[int]]:
    """Columns with the letters of hemispheres, and those that may be such and may be something else.

    Surely they are such if they are called so, or are right beside their coordinate and nothing but letters. Where
    letters of both axes stand elsewhere under another heading, nobody knows.
    """
    sides: dict[Axis, int] = {}
    possible: dict[Axis, int] = {}
    coordinates = {found.get((axis, "")) for axis in AXES}
    for axis, words in zip(AXES, (_LON_SIDE, _LAT_SIDE), strict=True):
        coordinate = found.get((axis, ""))
        if coordinate is None:
            continue
        for index, name in enumerate(plain):
            cells = set(_filled(rows, index))
            if index in coordinates or not cells or any(side_of(cell, axis) is None for cell in cells):
                continue
            is_letters = all(hemisphere(cell) or names_both_sides(cell) for cell in cells)
            is_short = is_letters and max(map(len, cells)) <= 2
            # Within one farm, corners such as NE and SW are parts of it.
            is_one_pair = len(cells) == 1 or not any(map(names_both_sides, cells))
            is_named = re.fullmatch(words, name) or (name in _SIDE_NAMES and is_letters and is_one_pair)
            is_beside = index in {coordinate - 1, coordinate + 1} and not any(map(names_both_sides, cells))
            if is_named or (is_beside and is_short):
                sides[axis] = index
                break
            if is_short and is_one_pair and cells.isdisjoint({"no", "No", "NO"}):
                possible[axis] = index
    open_axes = possible.keys() - sides.keys()
    is_open = bool(open_axes) and len(possible.keys() | sides.keys()) == len(AXES)
    return sides, {possible[axis] for axis in open_axes} if is_open else set()


def _with_corners(
    names: tuple[str, ...],
    found: dict[tuple[Axis, str], int],
    sides: dict[Axis, int],
    signs: dict[Axis, int],
    place: str,
    source: Source,
) -> Columns | None:
    """The columns of a point or of four corners, or the fault of what is missing."""
    labels = sorted({corner for _, corner in found if corner})
    by_corner = {_CORNERS[label]: label for label in labels}
    is_compass = not any(label.isdecimal() for label in labels)
    expected = [
        by_corner.get(corner, ("ul", "ll", "lr", "ur")[corner] if is_compass else str(corner + 1))
        for corner in range(4)
    ]
    missing = [f"{axis} of corner {label}" for label in expected for axis in AXES if (axis, label) not in found]
    if not missing:
        corners = tuple((found["lon", label], found["lat", label]) for label in expected)
        return Columns(names, corners, None, is_compass)
    if not labels or any((axis, "") in found for axis in AXES):
        missing = [axis for axis in AXES if (axis, "") not in found]
        if not missing:
            return Columns(names, ((found["lon", ""], found["lat", ""]),), sides=sides, signs=signs)
    source.faults.append(Fault(place, f"no column for {', '.join(missing)}", HEADER_ACTION))
    return None
