"""Parameter files: what each ground station loads into a drone.

Mission Planner and MAVProxy load ``.param``: a name, a comma and a value a line. QGroundControl loads ``.params``: five
columns with tabs between them, vehicle, component, name, value and the type of MAVLink. Both pass over lines that begin
with ``#``.
"""

from __future__ import annotations

from collections.abc import Sequence

from pondhop.missions.autopilots import Parameter

MISSION_PLANNER_SUFFIX, QGROUNDCONTROL_SUFFIX = ".param", ".params"

_TYPES = {"int8": 2, "int16": 4, "int32": 6, "real": 9}
"""``MAV_PARAM_TYPE``. QGroundControl passes over a parameter whose type is not the one that the drone stores."""

_VEHICLE, _COMPONENT = 1, 1


def mission_planner_parameters(title: str, parameters: Sequence[Parameter]) -> str:
    """Return the text of a ``.param`` file."""
    lines = [f"# {title}"]
    for parameter in parameters:
        lines += [f"# {parameter.why}", f"{parameter.name},{parameter.value:g}"]
    return "\n".join(lines) + "\n"


def qgroundcontrol_parameters(title: str, parameters: Sequence[Parameter]) -> str:
    """Return the text of a ``.params`` file."""
    lines = [f"# {title}", "#", "# Vehicle-Id Component-Id Name Value Type"]
    for parameter in parameters:
        kind = _TYPES[parameter.kind]
        lines.append(f"{_VEHICLE}\t{_COMPONENT}\t{parameter.name}\t{parameter.value:g}\t{kind}")
    return "\n".join(lines) + "\n"
