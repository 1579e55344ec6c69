"""Mission items as MAVLink commands, as ArduPilot Copter understands them, and back.

Source: MAVLink, common message set, ``MAV_CMD`` (mavlink.io/en/messages/common.html). ArduPilot takes "not set" (NaN on
the wire) only for the yaw of TAKEOFF, WAYPOINT and LAND; everything else unused is 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pondhop.missions.mission import POSITIONED, Action, MissionItem

FRAME_GLOBAL = 0
FRAME_MISSION = 2
FRAME_GLOBAL_RELATIVE_ALT = 3

NAV_WAYPOINT = 16

_GROUND_SPEED, _KEEP_THROTTLE, _NO_TIME_OF_DAY = 1.0, -1.0, -1.0

Parameters = tuple[float | None, ...]


@dataclass(frozen=True)
class MavlinkItem:
    """A mission item in MAVLink's words.

    Attributes
    ----------
    command, frame
        ``MAV_CMD`` and ``MAV_FRAME``.
    params
        The seven parameters; with a position the last three are latitude, longitude, height. `None`: not set.
    """

    command: int
    frame: int
    params: Parameters


_COMMANDS = {
    Action.TAKEOFF: 22,
    Action.CHANGE_SPEED: 178,
    Action.WAYPOINT: NAV_WAYPOINT,
    Action.LAND: 21,
    Action.DELAY: 93,
    Action.RETURN_TO_LAUNCH: 20,
}
_ACTIONS = {command: action for action, command in _COMMANDS.items()}


def to_mavlink(item: MissionItem) -> MavlinkItem:
    """Return the item in MAVLink's words."""
    return MavlinkItem(_COMMANDS[item.action], _frame(item), _params(item))


def from_mavlink(item: MavlinkItem) -> MissionItem:
    """Return the mission item that a MAVLink item stands for.

    Raises
    ------
    ValueError
        If it is none that `to_mavlink` writes: another command, or parameters we never set.
    """
    action = _ACTIONS.get(item.command)
    if action is None:
        raise ValueError(f"command {item.command} is none that pondhop writes")
    first, second, _third, _yaw, latitude, longitude, height = item.params
    has_position = action in POSITIONED
    if has_position and (latitude is None or longitude is None or height is None):
        raise ValueError("the position is not set")
    decoded = MissionItem(
        action,
        position=(longitude, latitude) if longitude is not None and latitude is not None and has_position else None,
        height_m=height if has_position else None,
        hold_s=first if first is not None and action in (Action.WAYPOINT, Action.DELAY) else 0.0,
        speed_m_s=second if action is Action.CHANGE_SPEED else None,
    )
    expected = to_mavlink(decoded)
    # Text formats write an unset yaw as 0.
    if item not in (expected, replace(expected, params=tuple(zeros_for_unset(expected.params)))):
        raise ValueError(f"frame {item.frame} and {list(item.params)} are none that pondhop writes for {action.value}")
    return decoded


def _frame(item: MissionItem) -> int:
    return FRAME_GLOBAL_RELATIVE_ALT if item.action in POSITIONED else FRAME_MISSION


def _params(item: MissionItem) -> Parameters:
    longitude, latitude = item.position or (0.0, 0.0)
    height_m = item.height_m or 0.0
    match item.action:
        case Action.WAYPOINT:
            return item.hold_s, 0.0, 0.0, None, latitude, longitude, height_m
        case Action.TAKEOFF | Action.LAND:
            return 0.0, 0.0, 0.0, None, latitude, longitude, height_m
        case Action.DELAY:
            return item.hold_s, _NO_TIME_OF_DAY, _NO_TIME_OF_DAY, _NO_TIME_OF_DAY, 0.0, 0.0, 0.0
        case Action.CHANGE_SPEED:
            return _GROUND_SPEED, item.speed_m_s, _KEEP_THROTTLE, 0.0, 0.0, 0.0, 0.0
        case Action.RETURN_TO_LAUNCH:
            return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


def zeros_for_unset(params: Sequence[float | None]) -> list[float]:
    """Return the parameters with 0 where nothing is set."""
    return [param or 0.0 for param in params]
