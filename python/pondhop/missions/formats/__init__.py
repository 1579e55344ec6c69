"""Formats of mission files. A new one is a module like those here, and a line in the list below.

`tests/test_mission_formats.py` asks of every format in the list that what it writes reads back as the same mission.
"""

from pondhop.missions.formats.format import MissionFormat
from pondhop.missions.formats.qgroundcontrol import QGROUNDCONTROL
from pondhop.missions.formats.waypoints import WAYPOINTS

__all__ = ["FORMATS", "MissionFormat"]

FORMATS: tuple[MissionFormat, ...] = (QGROUNDCONTROL, WAYPOINTS)
"""Every drone gets a file in each of them."""
