"""QGroundControl ``.plan`` files: mission and geofence as JSON.

Format: docs.qgroundcontrol.com, developer guide, "Plan File Format". Latitude comes before longitude here.
"""

from __future__ import annotations

import json
from typing import Any

from pondhop.documents.schemas import parse_json
from pondhop.errors import Fault, InvalidInput
from pondhop.missions.formats.format import MissionFormat
from pondhop.missions.mavlink import MavlinkItem, from_mavlink, to_mavlink
from pondhop.missions.mission import Mission, MissionItem
from pondhop.places import Ring

_ARDUPILOT, _QUADCOPTER, _RELATIVE_TO_HOME = 3, 2, 1
_UNKNOWN_AMSL_M = 0.0
"""The depot's height above sea level: the drone measures it on arming, and all heights of the mission are relative."""


def qgroundcontrol_plan(mission: Mission) -> str:
    """Return the text of a ``.plan`` file.

    Parameters
    ----------
    mission
        A mission that `pondhop.missions.check.broken_rules` finds sound.
    """
    longitude, latitude = mission.home
    plan = {
        "fileType": "Plan",
        "version": 1,
        "groundStation": "QGroundControl",
        "mission": {
            "version": 2,
            "firmwareType": _ARDUPILOT,
            "vehicleType": _QUADCOPTER,
            "cruiseSpeed": mission.speed_m_s,
            "hoverSpeed": mission.speed_m_s,
            "globalPlanAltitudeMode": _RELATIVE_TO_HOME,
            "plannedHomePosition": [latitude, longitude, _UNKNOWN_AMSL_M],
            "items": [_item_object(item, number) for number, item in enumerate(mission.items, start=1)],
        },
        "geoFence": {
            "version": 2,
            "polygons": [_polygon_object(ring, True) for ring in mission.fences]
            + [_polygon_object(ring, False) for ring in mission.no_fly],
            "circles": [],
        },
        "rallyPoints": {"version": 2, "points": []},
    }
    return json.dumps(plan, indent=1, allow_nan=False) + "\n"


def parse_qgroundcontrol_plan(text: str, name: str) -> Mission:
    """Return the mission of a ``.plan`` file of ours, read strictly.

    Parameters
    ----------
    text
        Of the file.
    name
        What the mission is called.

    Raises
    ------
    InvalidInput
        With everything in the file that pondhop would not write.
    """
    plan = parse_json(text, "qgroundcontrol-plan")
    faults: list[Fault] = []
    items = [_item(content, number, faults) for number, content in enumerate(plan["mission"]["items"], start=1)]
    if faults:
        raise InvalidInput(faults)
    latitude, longitude, _amsl_m = plan["mission"]["plannedHomePosition"]
    polygons = [(polygon["inclusion"], _ring(polygon["polygon"])) for polygon in plan["geoFence"]["polygons"]]
    return Mission(
        name,
        (longitude, latitude),
        plan["mission"]["cruiseSpeed"],
        tuple(item for item in items if item is not None),
        fences=tuple(ring for is_inclusion, ring in polygons if is_inclusion),
        no_fly=tuple(ring for is_inclusion, ring in polygons if not is_inclusion),
    )


def _item_object(item: MissionItem, number: int) -> dict[str, Any]:
    encoded = to_mavlink(item)
    return {
        "type": "SimpleItem",
        "command": encoded.command,
        "frame": encoded.frame,
        "params": list(encoded.params),
        "autoContinue": True,
        "doJumpId": number,
    }


def _polygon_object(ring: Ring, is_inclusion: bool) -> dict[str, Any]:
    polygon = [[latitude, longitude] for longitude, latitude in ring]
    return {"version": 1, "inclusion": is_inclusion, "polygon": polygon}


def _item(content: dict[str, Any], number: int, faults: list[Fault]) -> MissionItem | None:
    """Return the item, or add the fault that it is none of ours."""
    place = f"mission.items[{number - 1}]"
    if content["doJumpId"] != number:
        faults.append(Fault(f"{place}.doJumpId", f"it is {content['doJumpId']}", f"number items from 1: {number}"))
    try:
        return from_mavlink(MavlinkItem(content["command"], content["frame"], tuple(content["params"])))
    except ValueError as error:
        faults.append(Fault(place, str(error), "write the mission again"))
        return None


def _ring(polygon: list[list[float]]) -> Ring:
    return tuple((longitude, latitude) for latitude, longitude in polygon)


QGROUNDCONTROL = MissionFormat(
    "QGroundControl", ".plan", qgroundcontrol_plan, parse_qgroundcontrol_plan, has_areas=True
)
