"""Farms as GeoJSON files, which `pondhop.read_farm` reads back."""

from __future__ import annotations

import json
from pathlib import Path

from pondhop.arguments import Arguments
from pondhop.documents.atomic import write_all
from pondhop.farm.model import Farm, Pond
from pondhop.places import Area, LonLat

DECIMALS = 7
"""Decimals of degrees in written files: about a centimetre."""


def write_farm(path: str | Path, farm: Farm) -> None:
    """Write a farm as GeoJSON, one feature a line, with 7 decimals (a centimetre); `read_farm` reads it back.

    Notes are not written: they tell of the reading, not of the farm.

    Raises
    ------
    InvalidInput
        With what is no name of a file or no farm.
    OSError
        If the file cannot be written.
    """
    arguments = Arguments()
    arguments.path("path", path)
    arguments.kind("farm", farm, Farm, "give a pondhop.Farm, as pondhop.read_farm returns it")
    arguments.check()
    # The role is written for ponds, too: without it a pond given as a point would be a label in one that is an outline.
    features = [_feature_json({"id": pond.id, "role": "pond"} | _task_json(pond), pond) for pond in farm.ponds]
    features.append(_point_json({"role": "depot"}, farm.depot))
    features.extend(_point_json({"role": "station"}, station) for station in farm.stations)
    features.extend(_polygon_json({"role": "no_fly"}, area) for area in farm.no_fly)
    features.extend(_polygon_json({"role": "fence"}, area) for area in farm.fences)
    lines = ",\n".join(json.dumps(feature, separators=(",", ":"), allow_nan=False) for feature in features)
    head = f'{{"type":"FeatureCollection","name":{json.dumps(farm.name)},"features":[\n'
    write_all({Path(path): f"{head}{lines}\n]}}\n"})


def _task_json(pond: Pond) -> dict[str, object]:
    task: dict[str, object] = {} if pond.service_s is None else {"service_s": pond.service_s}
    if pond.time_windows:
        task["time_windows"] = [list(window) for window in pond.time_windows]
    return task if pond.priority == 1.0 else {**task, "priority": pond.priority}


def _feature_json(properties: dict[str, object], pond: Pond) -> dict[str, object]:
    if not pond.outline:
        return _point_json(properties, pond.sampling_point)
    return _polygon_json({**properties, "sampling_point": _rounded(pond.sampling_point)}, pond.outline)


def _point_json(properties: dict[str, object], point: LonLat) -> dict[str, object]:
    geometry = {"type": "Point", "coordinates": _rounded(point)}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def _polygon_json(properties: dict[str, object], area: Area) -> dict[str, object]:
    geometry = {"type": "Polygon", "coordinates": [[_rounded(position) for position in ring] for ring in area]}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def _rounded(position: LonLat) -> list[float]:
    return [round(position[0], DECIMALS), round(position[1], DECIMALS)]
