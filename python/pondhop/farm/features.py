"""What a farm file holds before anyone asks whether it makes a farm: features, each with its place in the file."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

from pondhop.errors import Fault
from pondhop.places import LonLat

Positions = list[LonLat]


@dataclass
class Geometry:
    """Positions of one feature, sorted by what they draw; longitude before latitude.

    Attributes
    ----------
    points
        Single places.
    lines
        Open or closed lines.
    polygons
        Rings per polygon, the outer one first; closed or not, as the file has them.
    """

    points: Positions = field(default_factory=list)
    lines: list[Positions] = field(default_factory=list)
    polygons: list[list[Positions]] = field(default_factory=list)

    def positions(self) -> Positions:
        """All positions, in the order points, lines, polygons."""
        rings = [ring for polygon in self.polygons for ring in polygon]
        return [*self.points, *(position for part in (*self.lines, *rings) for position in part)]


@dataclass
class Feature:
    """One feature of a file.

    Attributes
    ----------
    place
        Where the feature stands, in the words of the file: ``features[3]``, ``line 17``.
    property_place
        The same for one of its properties, whose name replaces ``{}``: ``line 17, column {}``.
    properties
        As in the file; an absent value is ``None`` or blank.
    geometry
        Its positions in WGS84; empty where the file gives none.
    own_id
        What the format calls the feature, for want of a property: the ``id`` of a GeoJSON feature.
    layer
        The layer, folder or sheet it stands in, if the format has them.
    """

    place: str
    property_place: str
    properties: Mapping[str, object]
    geometry: Geometry
    own_id: str | None = None
    layer: str | None = None

    @cached_property
    def _keys(self) -> dict[str, str]:
        return {normal_name(key): key for key in self.properties}

    def find(self, *names: str) -> tuple[str, object] | None:
        """The first property that is there under one of the names, as the file spells it, and its value.

        Spelling is forgiving: ``Pond ID`` is ``pond_id``. Blank values count as absent.
        """
        for name in names:
            key = self._keys.get(normal_name(name))
            if key is not None and not is_blank(self.properties[key]):
                return key, self.properties[key]
        return None


@dataclass
class Source:
    """A farm file, read but not yet judged.

    Attributes
    ----------
    name
        What the file calls itself, else the name of the file.
    features
        In the order of the file.
    faults
        What is wrong with the file as such; features they concern may be missing above.
    notes
        What the reader assumed or changed, a sentence each.
    """

    name: str
    features: list[Feature] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@lru_cache(maxsize=4096)
def normal_name(name: str) -> str:
    """A property name without case, blanks and punctuation."""
    return re.sub(r"[\W_]+", "", name).lower()


def is_blank(value: object) -> bool:
    """Whether a property is there in name only."""
    return value is None or (isinstance(value, str) and not value.strip())


def text_of(value: object) -> str:
    """An identifier as text: whole numbers lose the decimal point that a spreadsheet or GIS gave them."""
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return str(value).strip()


def number_of(value: object) -> float | None:
    """A finite number, or ``None`` if the value is none. Truth values are no numbers; numeric text is one."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    if isinstance(value, str) and "_" in value:
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if math.isfinite(number) else None
