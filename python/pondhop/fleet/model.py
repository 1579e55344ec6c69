"""A fleet as a value: how many drones, how they fly, how they sample, what their batteries hold."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import MISSING, dataclass, field, fields
from functools import cached_property
from numbers import Integral, Real
from typing import Any, Literal, get_args

import numpy as np

from pondhop._core import Energy
from pondhop.arguments import Arguments
from pondhop.errors import Fault
from pondhop.fleet import times
from pondhop.fleet.clock import clock_faults, seconds_between
from pondhop.fleet.layers import LEAST_SPACING_M, Layers, layers_of, layers_remedy, lowest_way_home_m
from pondhop.fleet.settings import AIRFRAME_SPEED_M_S, DECISIVE, MAX_HEIGHT_M, NUMBERS, WHOLE
from pondhop.units import JOULES_PER_WATT_HOUR

SamplingStyle = Literal["hover-dip", "splashdown"]

MOST_TIME_S = 1e9
"""Of a time on station, as the core has it."""


@dataclass(frozen=True)
class Fleet:
    """A fleet of equal drones. Where each default comes from stands in `pondhop.fleet.settings`.

    Attributes
    ----------
    num_drones
        How many drones there are.
    speed_m_s
        Ground speed in cruise.
    transit_height_m
        Height above ground between ponds.
    leg_stop_s
        What stopping and starting adds to every leg; ``None``: by sampling style and speed, as measured.
    sampling
        How a pond is sampled: ``hover-dip`` lowers a probe on a line, ``splashdown`` lands on the water.
    dwell_s
        Time the probe stays in the water, in whole seconds: autopilots store no others.
    dip_height_m
        Height above ground at which a drone holds while its probe hangs in the water (``hover-dip``).
    max_route_length_m, max_route_duration_s
        What one drone can fly; ``None`` where nothing limits it.
    takeoff_interval_s, layer_spacing_m
        What keeps drones apart at home: the time between two take-offs, and how much higher each drone flies out to its
        first pond and comes home than the one before it; ``None``: 3 m, or less, but at least 2 m, where so many drones
        would come home above the highest allowed flight.
    fence_margin_m
        How far every leg must stay inside of fences and outside of no-fly zones.
    battery_wh, reserve_percent, health_percent
        What the battery of a drone holds when new and full, how much of that stays unused, and how much of it is left
        with age. ``None``: unknown, and flight time is not checked.
    swap_s, num_pads
        What changing the battery of a drone at the depot takes, from landing to the next take-off, and how many drones
        can be served at once. ``None``: each drone flies once, and all can be served at once.
    max_trip_duration_s, samples_per_trip
        What one trip may take, and how many ponds it may sample; ``None`` where only the battery limits it.
    max_airspeed_m_s
        The fastest that a drone flies through the air: against the wind it is slower over ground.
    start, end
        Clock times of the first take-off and by which all must be back, as "22:00"; ``None``: no clock, no end.
    return_speed_m_s, return_height_m, return_loiter_s, return_extra_s
        The way home as the autopilot flies it (RTL): its speed, the height of the lowest drone, the wait above home,
        and what turning and stopping take.
    climb_speed_m_s, descent_speed_m_s, landing_speed_m_s, slow_landing_height_m
        Vertical speeds; below the last height a landing is slow.
    spool_up_s, climb_extra_s, landing_extra_s, fast_landing_extra_s, dip_extra_s, first_leg_extra_s, last_dip_extra_s
        What is left of the measured times besides heights over speeds: see `pondhop.fleet.times`.
    hover_power_w, drag_power_w_per_m3_s3, climb_power_w_per_m_s, descent_power_w_per_m_s
        Power of hovering, what the third power of the airspeed adds, what a climb adds and a descent saves.
    liftoff_power_w, touchdown_power_w, water_power_w
        Power during ``climb_extra_s``, while a landing settles, and at rest on the water.
    assumptions
        Names of decisive settings that hold a default nobody confirmed. `read_fleet` names those absent from the file;
        a fleet made directly names those equal to the default.

    Raises
    ------
    InvalidInput
        With every field that is out of range or of the wrong type.
    """

    num_drones: int
    speed_m_s: float = 5.0
    transit_height_m: float = 7.0
    leg_stop_s: float | None = None
    sampling: SamplingStyle = "hover-dip"
    dwell_s: float = 5.0
    dip_height_m: float = 2.0
    max_route_length_m: float | None = None
    max_route_duration_s: float | None = None
    takeoff_interval_s: float = 10.0
    layer_spacing_m: float | None = None
    fence_margin_m: float = 2.0
    battery_wh: float | None = None
    reserve_percent: float = 25.0
    health_percent: float = 100.0
    return_speed_m_s: float = 10.0
    return_height_m: float = 15.0
    return_loiter_s: float = 5.0
    return_extra_s: float = 8.27
    climb_speed_m_s: float = 2.5
    descent_speed_m_s: float = 1.5
    landing_speed_m_s: float = 0.5
    slow_landing_height_m: float = 10.0
    spool_up_s: float = 2.3
    climb_extra_s: float = 4.0
    landing_extra_s: float = 3.1
    fast_landing_extra_s: float = 1.4
    dip_extra_s: float = 4.54
    first_leg_extra_s: float = 1.5
    last_dip_extra_s: float = 1.3
    hover_power_w: float = 354.2
    drag_power_w_per_m3_s3: float = 0.028
    climb_power_w_per_m_s: float = 12.3
    descent_power_w_per_m_s: float = 10.3
    liftoff_power_w: float = 302.0
    touchdown_power_w: float = 123.0
    water_power_w: float = 0.0
    max_airspeed_m_s: float = AIRFRAME_SPEED_M_S
    swap_s: float | None = None
    num_pads: int | None = None
    max_trip_duration_s: float | None = None
    samples_per_trip: int | None = None
    start: str | None = None
    end: str | None = None
    assumptions: tuple[str, ...] = field(default=DECISIVE, compare=False, kw_only=True)

    def __post_init__(self) -> None:
        values = {item.name: _plain(getattr(self, item.name)) for item in fields(self) if item.name != "assumptions"}
        for name, value in values.items():
            object.__setattr__(self, name, value)
        optional = {item.name for item in fields(self) if item.default is None}
        arguments = Arguments()
        arguments.faults += fleet_faults(
            {name: value for name, value in values.items() if value is not None or name not in optional}
        )
        arguments.all_of("assumptions", self.assumptions, list(values))
        arguments.check()
        defaults = {item.name: item.default for item in fields(self)}
        still_default = tuple(name for name in self.assumptions if getattr(self, name) == defaults[name])
        object.__setattr__(self, "assumptions", still_default)

    @cached_property
    def _lowest(self) -> Layers:
        """The heights of the lowest drone: those of one that flies alone."""
        return self.layers(1)

    @property
    def stop_s(self) -> float:
        """What stopping and starting adds to a leg."""
        return times.leg_stop_s(self)

    @property
    def takeoff_s(self) -> float:
        """Time of the first take-off of a route, until the drone flies its first leg, for the lowest drone."""
        return times.takeoff_s(self, self._lowest.way_out_m)

    @property
    def service_s(self) -> float:
        """Time on station at one pond, from arriving above it at transit height to leaving from there."""
        return times.sampling_s(self)

    @property
    def least_service_s(self) -> float:
        """The least time on station at one pond: down, up, and on the water the second that autopilots need."""
        return self.service_s - self.dwell_s + (1.0 if self.sampling == "splashdown" else 0.0)

    def dwell_at(self, service_s: float | None) -> float:
        """Return how long the probe stays in the water, in whole seconds, at a pond with this time on station.

        Parameters
        ----------
        service_s
            What the pond says; `None`: nothing, and the fleet's dwell counts.
        """
        if service_s is None:
            return self.dwell_s
        _check_time(service_s)
        return max(0.0, float(round(service_s - (self.service_s - self.dwell_s))))

    def service_at(self, service_s: float | None) -> float:
        """Return the time on station as it is flown, with `dwell_at` whole seconds in the water."""
        return self.service_s - self.dwell_s + self.dwell_at(service_s)

    @property
    def way_home_fixed_s(self) -> float:
        """What the way home takes besides its length, for the lowest drone."""
        return times.way_home_fixed_s(self, self._lowest.way_home_m)

    @property
    def span_s(self) -> float:
        """How long a round may last, from its first take-off to its end; infinite where nothing says so."""
        if self.start is None or self.end is None:
            return math.inf
        return seconds_between(self.start, self.end)

    def num_flying(self, num_ponds: int) -> int:
        """Return how many drones can fly a round over so many ponds: none flies without a pond."""
        arguments = Arguments()
        arguments.whole("num_ponds", num_ponds, 0, 2**63, "give a whole number of ponds")
        arguments.check()
        return max(1, min(self.num_drones, num_ponds))

    def layers(self, num_ponds: int, *, are_stacked: bool = False) -> Layers:
        """Return the heights at which drones fly out and come home: see `pondhop.fleet.layers.layers_of`."""
        return layers_of(self, num_ponds, are_stacked=are_stacked)

    def layer_costs(self, num_ponds: int, *, are_stacked: bool = False) -> list[tuple[float, float, float, float]]:
        """Return what take-off and way home take: both in seconds, both in joules, a row a drone that can fly."""
        layers = self.layers(num_ponds, are_stacked=are_stacked)
        heights_m = [
            (layers.way_out_height_m(drone), layers.way_home_height_m(drone))
            for drone in range(self.num_flying(num_ponds))
        ]
        return [
            (
                times.takeoff_s(self, way_out_m),
                times.way_home_fixed_s(self, way_home_m),
                times.takeoff_j(self, way_out_m),
                times.way_home_fixed_j(self, way_home_m),
            )
            for way_out_m, way_home_m in heights_m
        ]

    @property
    def usable_energy_j(self) -> float:
        """What a route may take from its battery: its capacity at its age, less the reserve; infinite if unknown."""
        if self.battery_wh is None:
            return math.inf
        share = self.health_percent / 100 * (1 - self.reserve_percent / 100)
        return self.battery_wh * JOULES_PER_WATT_HOUR * share

    @property
    def energy(self) -> Energy:
        """What flying takes from the battery, for the lowest drone."""
        return Energy(
            takeoff_j=times.takeoff_j(self, self._lowest.way_out_m),
            leg_w=times.power_w(self, self.speed_m_s),
            leg_stop_w=self.hover_power_w,
            way_home_w=times.power_w(self, self.return_speed_m_s),
            way_home_fixed_j=times.way_home_fixed_j(self, self._lowest.way_home_m),
            usable_j=self.usable_energy_j,
        )

    def service_energy_j(self, service_s: float) -> float:
        """Return what a time on station takes from the battery, in joules."""
        _check_time(service_s)
        return times.sampling_j(self, service_s)


def _check_time(service_s: object) -> None:
    arguments = Arguments()
    arguments.real("service_s", service_s, -MOST_TIME_S, MOST_TIME_S, f"give seconds, at most {MOST_TIME_S:g}")
    arguments.check()


def _plain(value: object) -> object:
    """Return a number of numpy or the like as one of Python, with the digits it is written with."""
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, np.floating):
        # A float32 of 0.1 is 0.1.
        return float(str(value))
    if isinstance(value, (int, float)) or not isinstance(value, Real):
        return value
    try:
        return int(value) if isinstance(value, Integral) else float(value)
    except OverflowError:
        # No fleet has such a number, and the checks say so.
        return value


def fleet_faults(settings: Mapping[str, object]) -> list[Fault]:
    """Return all that is wrong with the settings of a fleet; those that are not given have their defaults."""
    faults = setting_faults(settings)
    return faults + _combined_faults(settings, {fault.path for fault in faults})


def setting_faults(settings: Mapping[str, object]) -> list[Fault]:
    """Return what is wrong with settings, each for itself."""
    arguments = Arguments()
    for name, value in settings.items():
        if name == "sampling":
            arguments.one_of(name, value, get_args(SamplingStyle))
            continue
        if name in ("start", "end"):
            arguments.faults += clock_faults(name, value)
            continue
        least, most = NUMBERS[name].least, NUMBERS[name].most
        if name in WHOLE:
            arguments.whole(name, value, int(least), int(most), f"give a whole number from {least:.0f} to {most:.0f}")
        elif arguments.real(name, value, least, most, f"give a number from {least:.9g} to {most:.9g}"):
            arguments.faults += _dwell_faults(value) if name == "dwell_s" else []
    return arguments.faults


def _dwell_faults(dwell_s: Any) -> list[Fault]:
    if dwell_s == math.floor(dwell_s):
        return []
    message = f"{dwell_s:g} s is no whole number of seconds, and autopilots store no other"
    return [Fault("dwell_s", message, f"give {math.ceil(dwell_s)}")]


def _combined_faults(settings: Mapping[str, object], faulty: Collection[str]) -> list[Fault]:
    """What is wrong with settings that are each in range; those that are not can be judged with no other."""
    faults: list[Fault] = []
    values: dict[str, Any] = {item.name: item.default for item in fields(Fleet) if item.default is not MISSING}
    values.update(settings)

    def are_good(*names: str) -> bool:
        return not any(name in faulty or values.get(name) is None for name in names)

    if are_good("sampling", "dwell_s") and values["dwell_s"] == 0 and values["sampling"] == "splashdown":
        message = "0 s on the water is no stay: autopilots take a delay of 0 for a time of day"
        faults.append(Fault("dwell_s", message, "give 1 second or more"))
    if are_good("sampling", "dip_height_m", "transit_height_m") and values["sampling"] == "hover-dip":
        dip_m, transit_m = values["dip_height_m"], values["transit_height_m"]
        if dip_m >= transit_m:
            message = f"{dip_m:g} m is not below the transit height of {transit_m:g} m"
            faults.append(Fault("dip_height_m", message, "dip lower or fly higher"))
    if are_good("end") and values["start"] is None:
        message = f"the round is to end at {values['end']}, and nothing says when it starts"
        faults.append(Fault("start", message, 'give start = "22:00", or on the command line --start 22:00'))
    if are_good("swap_s", "max_route_length_m"):
        message = "a drone whose battery is swapped has no longest route"
        faults.append(Fault("max_route_length_m", message, "leave it out: the battery limits every trip"))
    if are_good("swap_s", "max_route_duration_s"):
        message = "a drone whose battery is swapped has no longest route"
        faults.append(Fault("max_route_duration_s", message, "give max_trip_duration_s for one trip, or an end"))
    if are_good("num_drones", "layer_spacing_m", "return_height_m", "transit_height_m"):
        lowest_m = lowest_way_home_m(values["return_height_m"], values["transit_height_m"])
        faults += _spacing_faults(values["num_drones"] - 1, values["layer_spacing_m"], lowest_m)
    return faults


def _spacing_faults(num_above: int, spacing_m: float, lowest_m: float) -> list[Fault]:
    highest_m = lowest_m + num_above * spacing_m
    if highest_m <= MAX_HEIGHT_M:
        return []
    message = f"with {spacing_m:g} m between drones the highest comes home at {highest_m:g} m"
    most_m = math.floor(10 * (MAX_HEIGHT_M - lowest_m) / num_above) / 10
    remedy = f"give at most {most_m:g} m" if most_m >= LEAST_SPACING_M else layers_remedy(lowest_m, LEAST_SPACING_M)
    return [Fault("layer_spacing_m", message, f"{remedy}: nothing may fly above {MAX_HEIGHT_M} m")]
