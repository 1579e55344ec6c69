"""``.waypoints`` files: the text format QGC WPL 110, which Mission Planner, MAVProxy and QGroundControl load.

Format: mavlink.io, "File Formats", plain text. A line has 12 columns with tabs between them: sequence number, current,
frame, command, four parameters, latitude, longitude, height, autocontinue. The first row is home. There is no word for
"not set", no geofence and no cruise speed.
"""

from __future__ import annotations

import math

from pondhop.errors import Fault, InvalidInput
from pondhop.missions.formats.format import MissionFormat
from pondhop.missions.mavlink import (
    FRAME_GLOBAL,
    NAV_WAYPOINT,
    MavlinkItem,
    from_mavlink,
    to_mavlink,
    zeros_for_unset,
)
from pondhop.missions.mission import Mission
from pondhop.places import LonLat

_HEADER = "QGC WPL 110"
_NUM_COLUMNS = 12


def waypoints(mission: Mission) -> str:
    """Return the text of a ``.waypoints`` file.

    Parameters
    ----------
    mission
        A mission that `pondhop.missions.check.broken_rules` finds sound.
    """
    longitude, latitude = mission.home
    home = MavlinkItem(NAV_WAYPOINT, FRAME_GLOBAL, (0.0, 0.0, 0.0, 0.0, latitude, longitude, 0.0))
    rows = [home, *map(to_mavlink, mission.items)]
    return "\n".join([_HEADER, *(_row(sequence, item) for sequence, item in enumerate(rows))]) + "\n"


def parse_waypoints(text: str, name: str) -> Mission:
    """Return the mission of a ``.waypoints`` file of ours, read strictly.

    Parameters
    ----------
    text
        Of the file.
    name
        What the mission is called.

    Returns
    -------
    Mission
        Without fences and no-fly zones, which the format cannot hold.

    Raises
    ------
    InvalidInput
        With every line that pondhop would not write.
    """
    header, *lines = text.splitlines() or [""]
    faults = [] if header == _HEADER else [Fault("line 1", f"it is {header[:40]!r}", f"begin with {_HEADER!r}")]
    home, items = (0.0, 0.0), []
    for sequence, line in enumerate(lines):
        try:
            row = _parsed(sequence, line)
            if sequence == 0:
                home = _home(row)
            else:
                items.append(from_mavlink(row))
        except ValueError as error:
            faults.append(Fault(f"line {sequence + 2}", str(error), "write the mission again"))
    speeds = [item.speed_m_s for item in items if item.speed_m_s is not None]
    if not speeds:
        faults.append(Fault("the file", "no item sets the speed", "write the mission again"))
    if faults:
        raise InvalidInput(faults)
    return Mission(name, home, speeds[0], tuple(items))


def _row(sequence: int, item: MavlinkItem) -> str:
    is_current = sequence == 0
    numbers = [f"{param:.8f}" for param in zeros_for_unset(item.params)]
    return "\t".join([str(sequence), str(int(is_current)), str(item.frame), str(item.command), *numbers, "1"])


def _parsed(sequence: int, line: str) -> MavlinkItem:
    columns = line.split("\t")
    if len(columns) != _NUM_COLUMNS:
        raise ValueError(f"it has {len(columns)} columns with tabs between them, not {_NUM_COLUMNS}")
    expected = [str(sequence), str(int(sequence == 0))]
    if columns[:2] != expected or columns[-1] != "1":
        raise ValueError(f"sequence number, current and autocontinue are {[*columns[:2], columns[-1]]}")
    frame, command = int(columns[2]), int(columns[3])
    first, second, third, fourth, latitude, longitude, height = (_number(column) for column in columns[4:11])
    return MavlinkItem(command, frame, (first, second, third, fourth, latitude, longitude, height))


def _home(row: MavlinkItem) -> LonLat:
    *zeros, latitude, longitude, amsl_m = zeros_for_unset(row.params)
    if (row.frame, row.command) != (FRAME_GLOBAL, NAV_WAYPOINT) or any(zeros) or amsl_m:
        raise ValueError(f"it has frame {row.frame}, command {row.command} and {list(row.params)}, so it is not home")
    return longitude, latitude


def _number(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is no finite number")
    return value


WAYPOINTS = MissionFormat("Mission Planner", ".waypoints", waypoints, parse_waypoints, has_areas=False)
