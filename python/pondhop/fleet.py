"""The fleet: what a drone is and how it samples a pond."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

SamplingStyle = Literal["hover-dip", "splashdown"]


@dataclass(frozen=True)
class Fleet:
    """A fleet of equal drones. The defaults are assumptions for a drone nobody has measured.

    Attributes
    ----------
    num_drones
        How many drones there are.
    speed_m_s
        Ground speed in cruise.
    transit_height_m
        Height above ground between ponds.
    leg_stop_s
        What stopping and starting adds to every leg.
    sampling
        How a pond is sampled: ``hover-dip`` lowers a probe on a line, ``splashdown`` lands on the water.
    dwell_s
        Time the probe stays in the water.
    dip_height_m
        Height above ground at which a drone holds while its probe hangs in the water (``hover-dip``).
    max_route_length_m, max_route_duration_s
        What one drone can fly; ``None`` where nothing limits it.
    """

    num_drones: int
    speed_m_s: float = 5.0
    transit_height_m: float = 7.0
    leg_stop_s: float = 3.0
    sampling: SamplingStyle = "hover-dip"
    dwell_s: float = 5.0
    dip_height_m: float = 2.0
    max_route_length_m: float | None = None
    max_route_duration_s: float | None = None
