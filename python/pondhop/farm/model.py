"""A farm as a value: its ponds, depot, stations and areas, in WGS84 longitude and latitude."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pondhop._core import LocalFrame, Problem, Round
from pondhop.arguments import Arguments
from pondhop.errors import Fault, InvalidInput
from pondhop.farm.features import listed
from pondhop.farm.shapes import hole_around
from pondhop.farm.words import pond_called
from pondhop.fleet import CALM, Fleet, Wind
from pondhop.fleet.clock import windows_after
from pondhop.places import Area, LonLat

_ROUNDING_S = 1e-6


@dataclass(frozen=True)
class Pond:
    """A pond.

    Attributes
    ----------
    id
        Unique on its farm.
    sampling_point
        Where a drone samples: longitude, latitude in degrees.
    outline
        Rings of the polygon, the outer one first, each closed; empty for a pond given as a point.
    service_s
        Time on station if it differs from that of the fleet.
    time_windows
        Pairs of clock times, as ("22:30", "23:30"), between which sampling may begin; at any time if there are none.
    priority
        What sampling it is worth beside other ponds, where a fleet cannot do all.
    """

    id: str
    sampling_point: LonLat
    outline: Area = ()
    service_s: float | None = None
    time_windows: tuple[tuple[str, str], ...] = ()
    priority: float = 1.0


@dataclass(frozen=True)
class Doubt:
    """A pond whose place was guessed while reading: its owner must look at it before anything flies there.

    Attributes
    ----------
    pond_id
        Of the pond; the name by which the doubt is accepted.
    message
        What was guessed, with the place in the file.
    """

    pond_id: str
    message: str


@dataclass(frozen=True)
class Farm:
    """A farm as read from a file; see `pondhop.read_farm`.

    Attributes
    ----------
    name
        For tables and titles.
    ponds
        In the order of the file; a pond's index here is its index in a plan's routes.
    depot
        Longitude and latitude in degrees.
    stations, no_fly, fences
        Other features of the file.
    notes
        What the reader assumed or changed, a sentence each.
    doubts
        Ponds whose place is a guess. While there are any, no mission may be written; see `read_farm`'s ``accept`` and
        `pondhop.farm.doubt_fault`.
    """

    name: str
    ponds: tuple[Pond, ...]
    depot: LonLat
    stations: tuple[LonLat, ...] = ()
    no_fly: tuple[Area, ...] = ()
    fences: tuple[Area, ...] = ()
    notes: tuple[str, ...] = ()
    doubts: tuple[Doubt, ...] = ()

    @property
    def kept_out(self) -> tuple[Area, ...]:
        """Areas that no drone enters, as autopilots can be told: no-fly zones, and the holes of fences.

        Autopilots store areas without holes. So what lies in the hole of a no-fly zone is kept out of with the zone,
        unless the depot lies in that hole, the only one that an area then has: drones stay inside of it.
        """
        zones = []
        for area in self.no_fly:
            home = hole_around(self.depot, area)
            zones.append(area[:1] if home is None else (area[0], home))
        return (*zones, *((hole,) for _, *holes in self.fences for hole in holes))

    def to_problem(self, fleet: Fleet, *, are_layers_stacked: bool = False) -> Problem:
        """The planning task in metres, in the local frame whose origin is the depot.

        Parameters
        ----------
        fleet
            The drones; its time on station applies to every pond without its own. A pond's own is rounded to whole
            seconds of dwell, as it is flown.
        are_layers_stacked
            Whether all drones come home above all ways out: see `pondhop.fleet.layers.layers_of`.

        Returns
        -------
        Problem
            Pond i is ``ponds[i]``; route i of a plan is flown by drone i + 1, in its layer.

        Raises
        ------
        InvalidInput
            With the ponds whose own time on station is less than what sampling takes, or if so many drones do not fit
            above each other.
        """
        arguments = Arguments()
        arguments.kind("fleet", fleet, Fleet, "give a pondhop.Fleet, as in pondhop.Fleet(num_drones=3)")
        arguments.truth("are_layers_stacked", are_layers_stacked)
        arguments.check()
        _check_service(self.ponds, fleet)
        sampling_points = np.array([pond.sampling_point for pond in self.ponds], dtype=np.float64)
        durations_s = [fleet.service_at(pond.service_s) for pond in self.ponds]
        return Problem(
            (0.0, 0.0),
            LocalFrame(*self.depot).to_local(sampling_points),
            fleet.num_drones,
            service_durations_s=durations_s,
            service_energies_j=[fleet.service_energy_j(duration_s) for duration_s in durations_s],
            speed_m_s=fleet.speed_m_s,
            leg_stop_s=fleet.stop_s,
            takeoff_s=fleet.takeoff_s,
            way_home_speed_m_s=fleet.return_speed_m_s,
            way_home_fixed_s=fleet.way_home_fixed_s,
            energy=fleet.energy,
            layers=fleet.layer_costs(len(self.ponds), are_stacked=are_layers_stacked),
            max_length_m=np.inf if fleet.max_route_length_m is None else fleet.max_route_length_m,
            max_duration_s=np.inf if fleet.max_route_duration_s is None else fleet.max_route_duration_s,
        )

    def to_round(self, fleet: Fleet, wind: Wind = CALM, *, are_layers_stacked: bool = True) -> Round:
        """The planning task with all that `to_problem` leaves out: trips, windows, wind, and the end of the round.

        Times count from the first take-off of the round.

        Parameters
        ----------
        fleet, are_layers_stacked
            As of `to_problem`.
        wind
            How strong it blows and where from.

        Raises
        ------
        InvalidInput
            As `to_problem`; if drones make no way against the wind; if ponds have windows, and nothing says when the
            round starts.
        """
        problem = self.to_problem(fleet, are_layers_stacked=are_layers_stacked)
        timed = [pond.id for pond in self.ponds if pond.time_windows]
        if timed and fleet.start is None:
            message = f"ponds have time windows ({listed(timed)}), and nothing says when the round starts"
            action = 'give start = "22:00" in the fleet file, or --start 22:00 on the command line'
            raise InvalidInput([Fault("start", message, action)])
        if fleet.max_trip_duration_s is not None:
            problem = problem.replace(max_duration_s=fleet.max_trip_duration_s)
        _check_wind(fleet, wind)
        return Round(
            problem,
            windows=[windows_after(fleet.start or "00:00", pond.time_windows) for pond in self.ponds]
            if timed
            else None,
            priorities=[pond.priority for pond in self.ponds],
            loads=None if fleet.samples_per_trip is None else np.ones(len(self.ponds)),
            capacity=np.inf if fleet.samples_per_trip is None else fleet.samples_per_trip,
            shift_s=(0.0, fleet.span_s),
            takeoff_interval_s=fleet.takeoff_interval_s,
            turnaround_s=fleet.swap_s,
            num_pads=fleet.num_pads,
            wind_m_s=wind.velocity_m_s,
            max_airspeed_m_s=fleet.max_airspeed_m_s,
            drag_power_w_per_m3_s3=fleet.drag_power_w_per_m3_s3,
        )


def _check_wind(fleet: Fleet, wind: Wind) -> None:
    if wind.speed_m_s < fleet.max_airspeed_m_s:
        return
    message = (
        f"it blows with {wind.speed_m_s:g} m/s, and the drones fly at most {fleet.max_airspeed_m_s:g} m/s through the "
        "air (max_airspeed_m_s): none would come back against it"
    )
    raise InvalidInput(
        [Fault("wind", message, "wait for less wind, or say max_airspeed_m_s if your drones are faster")]
    )


def _check_service(ponds: Sequence[Pond], fleet: Fleet) -> None:
    least_s = fleet.least_service_s
    short = {pond.id: pond.service_s for pond in ponds if pond.service_s is not None}
    short = {name: service_s for name, service_s in short.items() if service_s < least_s - _ROUNDING_S}
    if short:
        # Rounded up, so that whoever gives the number that is told gives enough.
        least = f"{math.ceil(10 * (least_s - _ROUNDING_S)) / 10:g} s"
        values = listed([f"{value:g} s" for value in sorted(set(short.values()))], 3)
        place = pond_called(*short) if len(short) == 1 else f"ponds {listed(short)}"
        message = f"service_s is {values}, and {fleet.sampling} takes {least} at least"
        action = f"give {least} or more, from arriving above the pond to leaving from there, or leave service_s out"
        raise InvalidInput([Fault(place, message, action)])
