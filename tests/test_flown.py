"""The model of time and energy against flights on a simulated ArduCopter 4.7 (default quadcopter, 3 kg, calm air).

Every mission was planned by version 0.1.0, whose duration was d / v + 3 s a leg + its time on station a pond: the
length of each route follows from its duration of then. How far the way home was is what the log of the flight said.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from pondhop import Problem, evaluate
from pondhop.fleet import Fleet, SamplingStyle


@dataclass(frozen=True)
class Flight:
    """A flight: what was planned, the length that follows, how far the way home was, and what was flown."""

    name: str
    sampling: SamplingStyle
    num_ponds: int
    planned_s: float
    home_m: float
    flown_s: float
    flown_wh: float
    speed_m_s: float = 5.0
    height_m: float = 7.0
    dwell_s: float = 5.0

    @property
    def length_m(self) -> float:
        """Of the whole route: (planned - 3 s a leg - time on station) times the speed."""
        if self.sampling == "splashdown":
            station_s = self.height_m / 0.5 + 2.4 + self.dwell_s + 6.7 + (self.height_m - 7.0) / 2.5
        else:
            station_s = 9.8 + (self.height_m - 7.0) * (1 / 1.5 + 1 / 2.5) + self.dwell_s
        return (self.planned_s - 3.0 * (self.num_ponds + 1) - self.num_ponds * station_s) * self.speed_m_s


FLIGHTS = [
    Flight("LH, hover-dip", "hover-dip", 20, 1044.5, 827, 1005.2, 99.7),
    Flight("LH, splashdown", "splashdown", 22, 1321.4, 334, 1408.9, 122.9),
    Flight("SIU, hover-dip", "hover-dip", 45, 1069.3, 53, 1098.9, 108.2),
    Flight("hover-dip", "hover-dip", 6, 208.0, 60, 252.4, 24.5),
    Flight("hover-dip, 10 m/s", "hover-dip", 6, 158.9, 60, 222.8, 21.8, speed_m_s=10.0),
    Flight("hover-dip, 20 m", "hover-dip", 6, 291.2, 60, 336.4, 32.9, height_m=20.0),
    Flight("splashdown", "splashdown", 6, 287.8, 60, 345.6, 29.3),
    Flight("splashdown, 10 m/s", "splashdown", 6, 238.7, 60, 322.3, 27.2, speed_m_s=10.0),
    Flight("splashdown, home at 4000 m", "splashdown", 6, 287.8, 60, 346.1, 29.3),
    Flight("splashdown, dwell 15 s", "splashdown", 6, 347.8, 60, 408.3, 29.6, dwell_s=15.0),
]


def modelled(flight: Flight) -> tuple[float, float]:
    """Duration in seconds and energy in watt hours of a route of that length, with its ponds on a line."""
    fleet = Fleet(
        num_drones=1,
        speed_m_s=flight.speed_m_s,
        transit_height_m=flight.height_m,
        sampling=flight.sampling,
        dwell_s=flight.dwell_s,
    )
    # Out to the first pond, to and fro between two places, home from the last: legs of the right lengths in sum.
    leg_m = (flight.length_m - flight.home_m) / flight.num_ponds
    bearings = np.arange(flight.num_ponds)
    ponds = np.zeros((flight.num_ponds, 2))
    ponds[:, 0] = flight.home_m + leg_m * ((flight.num_ponds - 1 - bearings) % 2)
    first_leg_m = float(ponds[0, 0])
    problem = Problem(
        (0.0, 0.0),
        ponds,
        1,
        service_durations_s=[fleet.service_s] * flight.num_ponds,
        service_energies_j=[fleet.service_energy_j(fleet.service_s)] * flight.num_ponds,
        speed_m_s=fleet.speed_m_s,
        leg_stop_s=fleet.stop_s,
        takeoff_s=fleet.takeoff_s,
        way_home_speed_m_s=fleet.return_speed_m_s,
        way_home_fixed_s=fleet.way_home_fixed_s,
        energy=fleet.energy,
    )
    plan = evaluate(problem, [list(range(flight.num_ponds))])
    # The first leg is another one here than it was; what that makes is a cruise of the difference.
    missing_m = flight.length_m - float(plan.route_lengths[0])
    assert abs(missing_m) <= first_leg_m + leg_m
    missing_s = missing_m / fleet.speed_m_s
    duration_s = float(plan.route_durations_s[0]) + missing_s
    return duration_s, (float(plan.route_energies_j[0]) + missing_s * fleet.energy.leg_w) / 3600


@pytest.mark.parametrize("flight", FLIGHTS, ids=lambda flight: flight.name)
def test_durations_are_within_two_per_cent_of_what_was_flown(flight: Flight) -> None:
    duration_s, _ = modelled(flight)
    assert duration_s == pytest.approx(flight.flown_s, rel=0.02)


@pytest.mark.parametrize("flight", FLIGHTS, ids=lambda flight: flight.name)
def test_energies_are_within_five_per_cent_of_what_was_drawn(flight: Flight) -> None:
    _, energy_wh = modelled(flight)
    assert energy_wh == pytest.approx(flight.flown_wh, rel=0.05)


@pytest.mark.parametrize(
    ("height_m", "landing_s", "climb_s"),
    # Landings have two values, 1.1 s apart, by when the autopilot believes to have landed: their mean.
    [(7.0, 17.02, 6.75), (20.0, 31.05, 12.0), (40.0, 44.35, 20.0)],
)
def test_landings_and_climbs_take_what_was_measured(height_m: float, landing_s: float, climb_s: float) -> None:
    fleet = Fleet(1, sampling="splashdown", transit_height_m=height_m, dwell_s=5.0)
    assert fleet.service_s == pytest.approx(landing_s + 5.0 + climb_s, abs=0.35)


@pytest.mark.parametrize(("height_m", "takeoff_s"), [(7.0, 9.08), (20.0, 14.3), (40.0, 22.3)])
def test_the_first_take_off_takes_what_was_measured(height_m: float, takeoff_s: float) -> None:
    assert Fleet(1, sampling="splashdown", transit_height_m=height_m).takeoff_s == pytest.approx(takeoff_s, abs=0.05)


@pytest.mark.parametrize(("home_m", "flown_s"), [(53, 49.8), (60, 50.3), (334, 77.6), (827, 126.8)])
def test_the_way_home_takes_what_was_measured(home_m: float, flown_s: float) -> None:
    fleet = Fleet(1, sampling="splashdown")
    assert home_m / fleet.return_speed_m_s + fleet.way_home_fixed_s == pytest.approx(flown_s, abs=0.4)


@pytest.mark.parametrize(
    ("sampling", "speed_m_s", "stop_s"),
    [("hover-dip", 5.0, 2.45), ("hover-dip", 10.0, 4.65), ("splashdown", 5.0, 5.25), ("splashdown", 10.0, 7.4)],
)
def test_stops_take_what_was_measured(sampling: SamplingStyle, speed_m_s: float, stop_s: float) -> None:
    assert Fleet(1, sampling=sampling, speed_m_s=speed_m_s).stop_s == pytest.approx(stop_s, abs=0.06)


def test_power_is_that_of_the_airspeed() -> None:
    fleet = Fleet(1)
    for speed_m_s, power_w in [(2.0, 354.7), (5.0, 357.2), (8.0, 366.9), (10.0, 384.7)]:
        measured = Fleet(1, speed_m_s=speed_m_s).energy.leg_w
        assert measured == pytest.approx(power_w, abs=2.5)
    # Per pond at 7 m, in joules: a hover dip, and the mean of the two landings.
    assert fleet.service_energy_j(fleet.service_s) == pytest.approx(5330, rel=0.02)
    splashdown = Fleet(1, sampling="splashdown")
    assert splashdown.service_energy_j(splashdown.service_s) == pytest.approx((7360 + 7740) / 2, rel=0.02)
