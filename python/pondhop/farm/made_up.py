"""Made-up farms that look like real ones: catfish farms of the Mississippi Delta.

What is imitated: rectangular levee ponds of 4 to 8 hectares of water, of one size within a block; blocks of two rows of
ponds back to back, levees narrower than the gravel roads between blocks, which carry the feed trucks; all of it aligned
to one direction near north, as the land survey laid out the fields; and a farm yard in the middle in place of a pond.

A field is filled band by band with blocks, and places are taken from it: linear in the number of ponds but for a sort.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

import numpy as np
from numpy.typing import NDArray

from pondhop._core import LocalFrame
from pondhop.arguments import Arguments
from pondhop.farm.coordinates import MAX_LATITUDE_DEG
from pondhop.farm.model import Farm, Pond
from pondhop.farm.shapes import point_inside
from pondhop.places import LonLat
from pondhop.units import counted

MAX_PONDS = 5_000
"""Such a farm is 18 km wide; nobody has one."""

LEVEE_M, ROAD_M = 14.0, 32.0
"""Land between the waters of two ponds of a block, and of two blocks."""

MIN_AREA_M2, MAX_AREA_M2 = 41_500.0, 78_500.0
"""Area of a pond as laid out; surveyed corners differ by `CORNER_OFFSET_M`, and the area stays within 4-8 ha."""

CORNER_OFFSET_M = 1.5
"""How far a dug corner lies from where it was laid out."""

ROW_DEPTHS_M = (180.0, 210.0, 240.0, 290.0)
"""Lengths of ponds across their row; a band of blocks has one."""

FIELD_ASPECT = 1.3
"""Width to height of the field."""


@dataclass(frozen=True)
class _Place:
    """Room for a pond, in metres in the frame of the field: lower left corner, width, depth."""

    x: float
    y: float
    width: float
    depth: float

    @property
    def centre(self) -> tuple[float, float]:
        return (self.x + self.width / 2.0, self.y + self.depth / 2.0)


def generate_farm(
    num_ponds: int, *, at: LonLat, seed: int = 1, missing_share: float = 0.0, irregular: bool = False
) -> Farm:
    """Make up a farm in the manner of the Mississippi Delta.

    Parameters
    ----------
    num_ponds
        From 1 to 5000.
    at
        Longitude and latitude in degrees of the farm yard, which is the depot.
    seed
        The same seed makes the same farm on every machine.
    missing_share
        Share of the places that hold no pond (drained, sold, built over), from 0 to below 0.9; there are ``num_ponds``
        ponds all the same, on a larger field.
    irregular
        Whether the outline of the farm is uneven, as where fields were bought one by one, instead of a rectangle.

    Returns
    -------
    Farm
        Ponds numbered from 1, block by block, each a closed rectangle of 4 to 8 ha.

    Raises
    ------
    InvalidInput
        With every parameter that is out of range.
    """
    _check(num_ponds, at, seed, missing_share, irregular)
    num_ponds, seed = int(num_ponds), int(seed)
    at = float(at[0]), float(at[1])
    # Of the standard generator only random() is used: its sequence is promised to stay the same for ever.
    random = Random(seed)
    num_places = 1 + math.ceil(num_ponds / (1.0 - missing_share))
    places = _irregular_field(num_places, random) if irregular else _field(num_places, random)[:num_places]
    middle_x = sum(place.centre[0] for place in places) / len(places)
    middle_y = sum(place.centre[1] for place in places) / len(places)
    yard = min(places, key=lambda place: math.dist(place.centre, (middle_x, middle_y)))
    candidates = [place for place in places if place is not yard]
    drawn = [random.random() for _ in candidates]
    kept = sorted(sorted(range(len(candidates)), key=drawn.__getitem__)[:num_ponds])
    angle = math.radians(-4.0 + 8.0 * random.random())
    frame = LocalFrame(*at)
    ponds = []
    for number, index in enumerate(kept, start=1):
        corners_m = _corners(candidates[index], yard.centre, angle, random)
        lonlats = [(round(float(lon), 7), round(float(lat), 7)) for lon, lat in frame.to_geographic(corners_m)]
        outline = ((*lonlats, lonlats[0]),)
        lon, lat = point_inside(outline)
        ponds.append(Pond(str(number), (round(lon, 7), round(lat, 7)), outline))
    return Farm(f"Delta farm of {counted(num_ponds, 'pond')} (made up, seed {seed})", tuple(ponds), at)


def _check(num_ponds: object, at: object, seed: object, missing_share: object, irregular: object) -> None:
    arguments = Arguments()
    arguments.whole("num_ponds", num_ponds, 1, MAX_PONDS, f"ask for 1 to {MAX_PONDS}")
    arguments.position("at", at, most_latitude_deg=MAX_LATITUDE_DEG)
    arguments.whole("seed", seed, 0, 2**64 - 1, "give a whole number from 0 to 2^64 - 1")
    most = math.nextafter(0.9, 0.0)
    arguments.real("missing_share", missing_share, 0.0, most, "give a number from 0 to below 0.9")
    arguments.truth("irregular", irregular)
    arguments.check()


def _field(num_places: int, random: Random) -> list[_Place]:
    """At least so many places, in bands of blocks from the south, block by block from the west."""
    mean_place_m2 = (MIN_AREA_M2 + MAX_AREA_M2) / 2.0 * 1.15
    field_width = math.sqrt(num_places * mean_place_m2 * FIELD_ASPECT)
    places: list[_Place] = []
    y = 0.0
    while len(places) < num_places:
        depth = ROW_DEPTHS_M[int(random.random() * len(ROW_DEPTHS_M))]
        x = 0.0
        while x < field_width and len(places) < num_places:
            area = MIN_AREA_M2 + (MAX_AREA_M2 - MIN_AREA_M2) * random.random()
            num_columns = min(3 + int(4 * random.random()), max(1, round((field_width - x) * depth / area)))
            block = _block(x, y, depth, area, num_columns, random)
            places.extend(block)
            x = max(place.x + place.width for place in block) + ROAD_M
        y += 2.0 * depth + LEVEE_M + ROAD_M
    return places


def _block(x: float, y: float, depth: float, area: float, num_columns: int, random: Random) -> list[_Place]:
    """Two rows of ponds back to back, numbered out along the southern row and home along the northern one."""
    widths = []
    for _ in range(num_columns):
        varied = area * (0.94 + 0.12 * random.random())
        widths.append(min(max(varied, MIN_AREA_M2), MAX_AREA_M2) / depth)
    south = []
    for width in widths:
        south.append(_Place(x, y, width, depth))
        x += width + LEVEE_M
    north = [_Place(place.x, y + depth + LEVEE_M, place.width, depth) for place in reversed(south)]
    return [*south, *north]


def _irregular_field(num_places: int, random: Random) -> list[_Place]:
    """Places of a larger field within an uneven outline, a circle with three waves on it."""
    places = _field(2 * num_places, random)
    middle_x = sum(place.centre[0] for place in places) / len(places)
    middle_y = sum(place.centre[1] for place in places) / len(places)
    waves = [(order, 0.22 * random.random(), 2.0 * math.pi * random.random()) for order in (2, 3, 5)]

    def scaled_distance(place: _Place) -> float:
        dx, dy = place.centre[0] - middle_x, place.centre[1] - middle_y
        bearing = math.atan2(dy, dx)
        return math.hypot(dx, dy) / (1.0 + sum(a * math.cos(order * bearing + phase) for order, a, phase in waves))

    nearest = sorted(range(len(places)), key=lambda index: scaled_distance(places[index]))[:num_places]
    return [places[index] for index in sorted(nearest)]


def _corners(place: _Place, origin: tuple[float, float], angle: float, random: Random) -> NDArray[np.float64]:
    """Corners of a dug pond counter-clockwise, shape (4, 2), in metres from the origin; the angle turns the field."""
    corners = []
    for right, up in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)):
        dx = place.x + right * place.width - origin[0] + CORNER_OFFSET_M * (2.0 * random.random() - 1.0)
        dy = place.y + up * place.depth - origin[1] + CORNER_OFFSET_M * (2.0 * random.random() - 1.0)
        corners.append((dx * math.cos(angle) - dy * math.sin(angle), dx * math.sin(angle) + dy * math.cos(angle)))
    return np.array(corners)
