"""A farm: its ponds, depot, stations and areas, in WGS84 longitude and latitude."""

from __future__ import annotations

from dataclasses import dataclass

LonLat = tuple[float, float]
Ring = tuple[LonLat, ...]


@dataclass(frozen=True)
class Pond:
    """A pond.

    Attributes
    ----------
    id
        Unique on its farm.
    sampling_point
        Where a drone samples: longitude, latitude in degrees.
    outline
        Rings of the polygon, the outer one first, each closed; empty for a pond given as a point.
    service_s
        Time on station if it differs from that of the fleet.
    """

    id: str
    sampling_point: LonLat
    outline: tuple[Ring, ...] = ()
    service_s: float | None = None


@dataclass(frozen=True)
class Farm:
    """A farm as read from a file; see `pondhop.read_farm`.

    Attributes
    ----------
    name
        For tables and titles.
    ponds
        In the order of the file; a pond's index here is its index in a plan's routes.
    depot
        Longitude and latitude in degrees.
    stations, no_fly, fences
        Other features of the file.
    notes
        What the reader assumed or changed, a sentence each.
    """

    name: str
    ponds: tuple[Pond, ...]
    depot: LonLat
    stations: tuple[LonLat, ...] = ()
    no_fly: tuple[tuple[Ring, ...], ...] = ()
    fences: tuple[tuple[Ring, ...], ...] = ()
    notes: tuple[str, ...] = ()
