"""How long the phases of a flight take, and what they draw from the battery.

The laws are those that flights of pond missions on a simulated ArduCopter 4.7 (default quadcopter, 3 kg, calm air) were
fitted by; docs/explanation/flight-model.md tells how well they meet each flight. Every constant is a setting of the
fleet, because another airframe has others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pondhop.fleet.model import Fleet

STOP_PER_SPEED_S2_M = 0.43
"""Seconds that stopping and starting cost for each metre per second of cruise, at an acceleration of 2.5 m/s2."""

STOP_AT_REST_S = {"hover-dip": 0.35, "splashdown": 3.1}
"""The part of a stop that does not depend on speed: a drone that lands must stand still first."""


def leg_stop_s(fleet: Fleet) -> float:
    """Return what stopping and starting add to a leg: 2.5 s at 5 m/s for a hover dip, 5.25 s for a splashdown."""
    if fleet.leg_stop_s is not None:
        return fleet.leg_stop_s
    return STOP_AT_REST_S[fleet.sampling] + STOP_PER_SPEED_S2_M * fleet.speed_m_s


def climb_s(fleet: Fleet, height_m: float) -> float:
    """Return the time of a climb of some height that is under way."""
    return height_m / fleet.climb_speed_m_s


def landing_s(fleet: Fleet, height_m: float) -> float:
    """Return the time from the begin of a landing at some height to the motors at rest.

    An autopilot descends at its speed for missions down to ``slow_landing_height_m`` and slowly from there; then it
    waits until it is sure to have landed.
    """
    fast_m, slow_m, settling_s = _landing(fleet, height_m)
    return slow_m / fleet.landing_speed_m_s + fast_m / fleet.descent_speed_m_s + settling_s


def _landing(fleet: Fleet, height_m: float) -> tuple[float, float, float]:
    """Return how far a landing is fast and how far slow, in metres, and how long it settles, in seconds."""
    slow_m = min(height_m, fleet.slow_landing_height_m)
    fast_m = height_m - slow_m
    return fast_m, slow_m, fleet.landing_extra_s + (fleet.fast_landing_extra_s if fast_m > 0 else 0.0)


def _first_leg_extra_s(fleet: Fleet) -> float:
    return fleet.first_leg_extra_s if fleet.sampling == "hover-dip" else 0.0


def _last_dip_extra_s(fleet: Fleet) -> float:
    return fleet.last_dip_extra_s if fleet.sampling == "hover-dip" else 0.0


def takeoff_s(fleet: Fleet, height_m: float) -> float:
    """Return the time of the first take-off, with what the first leg takes more than others.

    A drone flies to its first pond at the height of its layer, and goes down to the transit height there.
    """
    down_s = (height_m - fleet.transit_height_m) / fleet.descent_speed_m_s
    return fleet.spool_up_s + fleet.climb_extra_s + climb_s(fleet, height_m) + down_s + _first_leg_extra_s(fleet)


def sampling_s(fleet: Fleet) -> float:
    """Return the time on station at a pond, from arriving above it at transit height to leaving from there."""
    if fleet.sampling == "splashdown":
        rise_s = fleet.climb_extra_s + climb_s(fleet, fleet.transit_height_m)
        return landing_s(fleet, fleet.transit_height_m) + fleet.dwell_s + rise_s
    dip_m = fleet.transit_height_m - fleet.dip_height_m
    return dip_m / fleet.descent_speed_m_s + climb_s(fleet, dip_m) + fleet.dip_extra_s + fleet.dwell_s


def way_home_fixed_s(fleet: Fleet, height_m: float) -> float:
    """Return what the way home takes besides its length: climb to the height of its layer, wait above home, landing."""
    up_s = climb_s(fleet, height_m - fleet.transit_height_m)
    extra_s = _last_dip_extra_s(fleet)
    return up_s + fleet.return_loiter_s + landing_s(fleet, height_m) + fleet.return_extra_s + extra_s


def power_w(fleet: Fleet, airspeed_m_s: float) -> float:
    """Return the power of level flight: that of hovering, and drag by the third power of the airspeed."""
    return fleet.hover_power_w + fleet.drag_power_w_per_m3_s3 * airspeed_m_s**3


def climb_j(fleet: Fleet, height_m: float) -> float:
    """Return the energy of a climb."""
    power = fleet.hover_power_w + fleet.climb_power_w_per_m_s * fleet.climb_speed_m_s
    return climb_s(fleet, height_m) * power


def rise_j(fleet: Fleet, height_m: float) -> float:
    """Return the energy of lifting off and climbing to some height."""
    return fleet.climb_extra_s * fleet.liftoff_power_w + climb_j(fleet, height_m)


def descent_j(fleet: Fleet, height_m: float, speed_m_s: float) -> float:
    """Return the energy of a descent."""
    power = max(0.0, fleet.hover_power_w - fleet.descent_power_w_per_m_s * speed_m_s)
    return height_m / speed_m_s * power


def landing_j(fleet: Fleet, height_m: float) -> float:
    """Return the energy of `landing_s`."""
    fast_m, slow_m, settling_s = _landing(fleet, height_m)
    descents_j = descent_j(fleet, slow_m, fleet.landing_speed_m_s) + descent_j(fleet, fast_m, fleet.descent_speed_m_s)
    return descents_j + settling_s * fleet.touchdown_power_w


def takeoff_j(fleet: Fleet, height_m: float) -> float:
    """Return the energy of `takeoff_s`; spooling up draws next to nothing."""
    down_j = descent_j(fleet, height_m - fleet.transit_height_m, fleet.descent_speed_m_s)
    return rise_j(fleet, height_m) + down_j + _first_leg_extra_s(fleet) * fleet.hover_power_w


def sampling_j(fleet: Fleet, duration_s: float) -> float:
    """Return the energy of a time on station: that of `sampling_s`, with whatever it lasts longer spent on dwelling."""
    beyond_s = duration_s - sampling_s(fleet)
    if fleet.sampling == "splashdown":
        dwell_j = max(0.0, fleet.dwell_s + beyond_s) * fleet.water_power_w
        return landing_j(fleet, fleet.transit_height_m) + dwell_j + rise_j(fleet, fleet.transit_height_m)
    dip_m = fleet.transit_height_m - fleet.dip_height_m
    hover_j = max(0.0, fleet.dip_extra_s + fleet.dwell_s + beyond_s) * fleet.hover_power_w
    return descent_j(fleet, dip_m, fleet.descent_speed_m_s) + climb_j(fleet, dip_m) + hover_j


def way_home_fixed_j(fleet: Fleet, height_m: float) -> float:
    """Return the energy of `way_home_fixed_s`."""
    hover_s = fleet.return_loiter_s + fleet.return_extra_s + _last_dip_extra_s(fleet)
    up_j = climb_j(fleet, height_m - fleet.transit_height_m)
    return up_j + hover_s * fleet.hover_power_w + landing_j(fleet, height_m)
