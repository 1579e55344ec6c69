"""Lengths, heights, speeds, times and energies in words, in metric or US units."""

from __future__ import annotations

from typing import Literal

Units = Literal["metric", "us"]
"""What people are told: metres, kilometres and m/s, or feet, miles and mph. Times and energies are the same in both."""

METRES_PER_FOOT = 0.3048
METRES_PER_MILE = 1609.344
JOULES_PER_WATT_HOUR = 3600.0

_SHORT_LENGTH_M = 1_000.0
_SHORT_LENGTH_FEET = 1_000.0
"""Below this a length is told in the small unit."""


def length_text(length_m: float, units: Units = "metric") -> str:
    """Return a distance as a person would say it: ``1.43 km`` and ``850 m``, or ``0.89 mi`` and ``620 ft``."""
    if units == "us":
        feet = length_m / METRES_PER_FOOT
        return f"{feet:.0f} ft" if feet < _SHORT_LENGTH_FEET else f"{length_m / METRES_PER_MILE:.2f} mi"
    return f"{length_m:.0f} m" if length_m < _SHORT_LENGTH_M else f"{length_m / 1000:.2f} km"


def height_text(height_m: float, units: Units = "metric") -> str:
    """Return a height: ``7 m``, or ``23 ft``."""
    return f"{height_m / METRES_PER_FOOT:.0f} ft" if units == "us" else f"{height_m:g} m"


def gap_text(gap_m: float, units: Units = "metric") -> str:
    """Return a distance of which a part of a foot matters, as the one between two drones: ``2.5 m``, or ``8.2 ft``."""
    return f"{gap_m / METRES_PER_FOOT:.1f} ft" if units == "us" else f"{gap_m:.3g} m"


def speed_text(speed_m_s: float, units: Units = "metric") -> str:
    """Return a speed: ``5 m/s``, or ``11.2 mph``."""
    return f"{speed_m_s * 3600 / METRES_PER_MILE:.1f} mph" if units == "us" else f"{speed_m_s:g} m/s"


def duration_text(duration_s: float) -> str:
    """Return a duration in minutes and seconds, as in ``5 min 50 s``; from an hour on as in ``1 h 05 min``."""
    minutes, seconds = divmod(round(duration_s), 60)
    if minutes < 60:
        return f"{minutes} min {seconds:02} s"
    hours, minutes = divmod(round(duration_s / 60), 60)
    return f"{hours} h {minutes:02} min"


def clock_text(time_s: float) -> str:
    """Return a time after the first take-off as on a stopwatch: ``5:50``, ``1:05:50``."""
    minutes, seconds = divmod(round(time_s), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes}:{seconds:02}"


def energy_text(energy_j: float) -> str:
    """Return an energy in watt hours: ``24.5 Wh``."""
    watt_hours = energy_j / JOULES_PER_WATT_HOUR
    return f"{watt_hours:.1f} Wh" if watt_hours < 100 else f"{watt_hours:.0f} Wh"


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: ``1 route``, ``2 routes``."""
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"
