"""What ``plan.json`` says of farms and fleets in the same way in every version: read for all of them here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pondhop.errors import InvalidInput
from pondhop.farm.model import Farm, Pond
from pondhop.fleet import Fleet
from pondhop.places import LonLat, Ring


def read_farm_object(content: Mapping[str, Any]) -> Farm:
    """Return the farm that stands in a file, without what only some versions tell."""
    return Farm(
        name=content["name"],
        ponds=tuple(
            Pond(
                pond["id"],
                _lon_lat(pond["sampling_point"]),
                _rings(pond["outline"]),
                pond["service_s"],
                tuple((earliest, latest) for earliest, latest in pond.get("time_windows", ())),
                pond.get("priority", 1.0),
            )
            for pond in content["ponds"]
        ),
        depot=_lon_lat(content["depot"]),
        stations=tuple(map(_lon_lat, content["stations"])),
        no_fly=tuple(map(_rings, content["no_fly"])),
        fences=tuple(map(_rings, content["fences"])),
        notes=tuple(content["notes"]),
    )


def fleet_of(settings: Mapping[str, Any], assumptions: list[str]) -> Fleet:
    """Return the fleet of some settings.

    Raises
    ------
    InvalidInput
        With every setting that is out of range, by its place in the file.
    """
    try:
        return Fleet(**settings, assumptions=tuple(assumptions))
    except InvalidInput as error:
        raise InvalidInput(replace(fault, path=f"fleet.{fault.path}") for fault in error.faults) from error


def _lon_lat(position: list[float]) -> LonLat:
    longitude, latitude = position
    return longitude, latitude


def _rings(rings: list[list[list[float]]]) -> tuple[Ring, ...]:
    return tuple(tuple(map(_lon_lat, ring)) for ring in rings)
