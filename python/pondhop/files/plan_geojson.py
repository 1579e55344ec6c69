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
    farm, plan = farm_plan.farm, farm_plan.solution.plan
    yield _feature("Point", farm.depot, {"role": "depot", "title": "Depot", "marker-symbol": "airfield"})
    for index, route in enumerate(plan.routes):
        colour = route_colour(index)
        positions = [farm.depot, *(farm.ponds[pond].sampling_point for pond in route), farm.depot]
        properties = {
            "role": "route",
            "title": f"Drone {index + 1}",
            "drone": index + 1,
            "num_ponds": len(route),
            "length_m": round(float(plan.route_lengths[index]), 1),
            "duration_s": round(float(plan.route_durations_s[index]), 1),
            "departure_s": round(farm_plan.takeoff_times_s[index], 1),
            "energy_wh": round(float(plan.route_energies_j[index]) / JOULES_PER_WATT_HOUR, 1),
            "stroke": colour,
            "stroke-width": 3,
            "stroke-opacity": 0.9,
        }
        yield _feature("LineString", positions, properties)
    for index, route in enumerate(plan.routes):
        start_s = farm_plan.takeoff_times_s[index]
        for order, pond in enumerate(route):
            properties = {
                "role": "stop",
                "title": f"Drone {index + 1}, stop {order + 1}: {pond_called(farm.ponds[pond].id)}",
                "drone": index + 1,
                "order": order + 1,
                "pond": pond,
                "id": farm.ponds[pond].id,
                "arrival_s": round(start_s + float(plan.arrivals_s[index][order]), 1),
                "departure_s": round(start_s + float(plan.departures_s[index][order]), 1),
                "marker-color": route_colour(index),
                "marker-size": "small",
            }
            yield _feature("Point", farm.ponds[pond].sampling_point, properties)


def _feature(kind: str, coordinates: Any, properties: Mapping[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": dict(properties)}
