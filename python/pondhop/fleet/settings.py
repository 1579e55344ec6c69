"""The settings of a fleet: what each may be, and where its default comes from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Source = Literal["assumed", "measured", "published"]
"""Where a default comes from.

``measured``: on a simulated ArduCopter 4.7 with its default quadcopter of 3 kg, flying pond missions in calm air;
``published``: the default of ArduPilot's parameter of that meaning; ``assumed``: somebody had to say a number.
"""

MAX_HEIGHT_M = 121.9
"""Highest flight above ground: 400 feet, the limit of the rules for small drones in the USA."""


@dataclass(frozen=True)
class Setting:
    """What one number of a fleet may be.

    Attributes
    ----------
    least, most
        The range of sensible values.
    source
        Of the default.
    """

    least: float
    most: float
    source: Source


NUMBERS = {
    "num_drones": Setting(1, 10_000, "assumed"),
    "speed_m_s": Setting(0.1, 20.0, "assumed"),
    "transit_height_m": Setting(1.0, MAX_HEIGHT_M, "assumed"),
    "dwell_s": Setting(0.0, 3_600.0, "assumed"),
    "dip_height_m": Setting(0.1, MAX_HEIGHT_M, "assumed"),
    "leg_stop_s": Setting(0.0, 600.0, "measured"),
    "first_leg_extra_s": Setting(0.0, 600.0, "measured"),
    "last_dip_extra_s": Setting(0.0, 600.0, "measured"),
    "dip_extra_s": Setting(0.0, 600.0, "measured"),
    "climb_speed_m_s": Setting(0.1, 10.0, "published"),
    "descent_speed_m_s": Setting(0.1, 5.0, "published"),
    "landing_speed_m_s": Setting(0.3, 2.0, "published"),
    "slow_landing_height_m": Setting(1.0, 100.0, "published"),
    "spool_up_s": Setting(0.0, 600.0, "measured"),
    "climb_extra_s": Setting(0.0, 600.0, "measured"),
    "landing_extra_s": Setting(0.0, 600.0, "measured"),
    "fast_landing_extra_s": Setting(0.0, 600.0, "measured"),
    "return_speed_m_s": Setting(0.1, 20.0, "published"),
    "return_height_m": Setting(1.0, MAX_HEIGHT_M, "published"),
    "return_loiter_s": Setting(0.0, 60.0, "published"),
    "return_extra_s": Setting(0.0, 600.0, "measured"),
    "layer_spacing_m": Setting(2.0, 50.0, "assumed"),
    "fence_margin_m": Setting(0.0, 1_000.0, "published"),
    "takeoff_interval_s": Setting(0.0, 600.0, "assumed"),
    "hover_power_w": Setting(0.0, 1e5, "measured"),
    "drag_power_w_per_m3_s3": Setting(0.0, 1e4, "measured"),
    "climb_power_w_per_m_s": Setting(0.0, 1e4, "measured"),
    "descent_power_w_per_m_s": Setting(0.0, 1e4, "measured"),
    "liftoff_power_w": Setting(0.0, 1e5, "measured"),
    "touchdown_power_w": Setting(0.0, 1e5, "measured"),
    "water_power_w": Setting(0.0, 1e5, "assumed"),
    "battery_wh": Setting(0.1, 1e5, "assumed"),
    "reserve_percent": Setting(0.0, 95.0, "assumed"),
    "health_percent": Setting(1.0, 100.0, "assumed"),
    "max_route_length_m": Setting(1.0, 1e7, "assumed"),
    "max_route_duration_s": Setting(1.0, 1e6, "assumed"),
    "max_airspeed_m_s": Setting(0.5, 50.0, "measured"),
    "swap_s": Setting(0.0, 86_400.0, "assumed"),
    "num_pads": Setting(1, 10_000, "assumed"),
    "max_trip_duration_s": Setting(1.0, 1e6, "assumed"),
    "samples_per_trip": Setting(1, 10_000, "assumed"),
}
"""Every number of a fleet. Speeds, landings and the wait above home end where ArduPilot's parameters for them do.

Looked up in the @Range comments of ArduPilot's source, of which ground stations make their warnings:

- libraries/AC_WPNav/AC_WPNav.cpp: WPNAV_SPEED 10 to 2000 cm/s (20 to 2000 in earlier versions, WP_SPD 0.1 to 20 m/s
  from 4.7), WPNAV_SPEED_UP 10 to 1000, WPNAV_SPEED_DN 10 to 500
- ArduCopter/Parameters.cpp: LAND_SPEED 30 to 200 cm/s, LAND_ALT_LOW 100 to 10000 cm, RTL_SPEED 0 to 2000 cm/s (0 is
  WPNAV_SPEED), RTL_LOIT_TIME 0 to 60000 ms, RTL_ALT 30 to 300000 cm (200 to 8000 in earlier versions, which hold it in
  32 bits all the same)
- ArduCopter/mode_rtl.cpp, from 4.7: RTL_SPEED_MS 0 to 20 m/s, RTL_ALT_M 0.3 to 3000 m
"""

AIRFRAME_SPEED_M_S = 10.0
"""The measured quadcopter flies no faster, however it is set: it leans 30 degrees then."""

LANDING_WIND_LIMIT_M_S = 5.0
"""Above this wind the landings of a simulated 3 kg quadcopter never ended."""

WHOLE = ("num_drones", "num_pads", "samples_per_trip")
"""Settings that are whole numbers."""

DECISIVE = ("speed_m_s", "transit_height_m", "sampling", "dwell_s", "dip_height_m")
"""Settings that decide what is flown: their defaults are told as assumptions wherever a plan is told."""
