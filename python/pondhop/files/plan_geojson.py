"""``plan.geojson``: a plan for maps, one LineString a route and one Point a stop, styled by simplestyle 1.1."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pondhop.documents.atomic import write_all
from pondhop.farm.words import pond_called
from pondhop.palette import route_colour
from pondhop.solution import FarmPlan, check_written
from pondhop.trips import Trip
from pondhop.units import JOULES_PER_WATT_HOUR


def plan_geojson(farm_plan: FarmPlan) -> str:
    """Return the text of ``plan.geojson``; the same plan gives the same text."""
    collection = {"type": "FeatureCollection", "features": list(_features(farm_plan))}
    return json.dumps(collection, ensure_ascii=False, allow_nan=False) + "\n"


def write_plan_geojson(path: str | os.PathLike[str], farm_plan: FarmPlan) -> None:
    """Write ``plan.geojson``: a LineString per route, a Point per stop, the depot; styled for maps (simplestyle 1.1).

    Parameters
    ----------
    path
        The file; written whole or not at all.
    farm_plan
        What to write.

    Raises
    ------
    InvalidInput
        With what is no name of a file or no plan of a farm.
    OSError
        If the file cannot be written.
    """
    check_written(path, farm_plan)
    write_all({Path(path): plan_geojson(farm_plan)})


def _features(farm_plan: FarmPlan) -> Iterator[dict[str, Any]]:
    farm = farm_plan.farm
    yield _feature("Point", farm.depot, {"role": "depot", "title": "Depot", "marker-symbol": "airfield"})
    for trip in farm_plan.trips:
        colour = route_colour(trip.drone)
        positions = [farm.depot, *(farm.ponds[pond].sampling_point for pond in trip.ponds), farm.depot]
        properties = {
            "role": "route",
            "title": _title(farm_plan, trip),
            "drone": trip.drone + 1,
            **({"trip": trip.number + 1} if farm_plan.is_round else {}),
            "num_ponds": len(trip.ponds),
            "length_m": round(trip.length_m, 1),
            "duration_s": round(trip.duration_s, 1),
            "departure_s": round(trip.departure_s, 1),
            "energy_wh": round(trip.energy_j / JOULES_PER_WATT_HOUR, 1),
            "stroke": colour,
            "stroke-width": 3,
            "stroke-opacity": 0.9,
        }
        yield _feature("LineString", positions, properties)
    for trip in farm_plan.trips:
        for order, pond in enumerate(trip.ponds):
            arrival_s, _, departure_s = map(float, trip.times_s[order])
            properties = {
                "role": "stop",
                "title": f"{_title(farm_plan, trip)}, stop {order + 1}: {pond_called(farm.ponds[pond].id)}",
                "drone": trip.drone + 1,
                **({"trip": trip.number + 1} if farm_plan.is_round else {}),
                "order": order + 1,
                "pond": pond,
                "id": farm.ponds[pond].id,
                "arrival_s": round(arrival_s, 1),
                "departure_s": round(departure_s, 1),
                "marker-color": route_colour(trip.drone),
                "marker-size": "small",
            }
            yield _feature("Point", farm.ponds[pond].sampling_point, properties)


def _title(farm_plan: FarmPlan, trip: Trip) -> str:
    return f"Drone {trip.drone + 1}" + (f", trip {trip.number + 1}" if farm_plan.is_round else "")


def _feature(kind: str, coordinates: Any, properties: Mapping[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": dict(properties)}
