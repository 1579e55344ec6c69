"""The fleet: what a drone is and how it samples a pond; and fleet files."""

from __future__ import annotations

import difflib
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal, get_args

from pondhop.errors import Fault, InvalidInput

SamplingStyle = Literal["hover-dip", "splashdown"]

MAX_HEIGHT_M = 121.9
"""Highest flight above ground: 400 feet, the limit of the rules for small drones in the USA."""

MEASURED_HEIGHT_M = 7.0
"""Transit height at which times on station were measured (simulated ArduCopter 4.7, 3 kg quadcopter)."""

MEASURED_DIP_M = 5.0
"""How far a drone went down at `MEASURED_HEIGHT_M` to dip its probe."""

HOVER_DIP_S = 9.8
"""Going down `MEASURED_DIP_M` and up again with all stops, without the dwell: 14.8 s with 5 s."""

SPLASHDOWN_CLIMB_S = 6.7
"""Taking off from the water and climbing to `MEASURED_HEIGHT_M`."""

LANDING_SPEED_M_S, LANDING_FLARE_S = 0.5, 2.4
"""Landing from height h takes h / 0.5 + 2.4 s at ArduCopter's default LAND_SPEED."""

DESCENT_SPEED_M_S, CLIMB_SPEED_M_S = 1.5, 2.5
"""ArduCopter's default vertical speeds in missions: what other transit heights than the measured one cost."""

_RANGES = {
    "num_drones": (1, 10_000),
    "speed_m_s": (0.1, 50.0),
    "transit_height_m": (1.0, MAX_HEIGHT_M),
    "leg_stop_s": (0.0, 600.0),
    "dwell_s": (0.0, 3_600.0),
    "dip_height_m": (0.1, MAX_HEIGHT_M),
    "max_route_length_m": (1.0, 1e7),
    "max_route_duration_s": (1.0, 1e6),
    "takeoff_interval_s": (0.0, 600.0),
}
"""Smallest and largest sensible value of each number."""

_ASSUMABLE = ("speed_m_s", "transit_height_m", "leg_stop_s", "sampling", "dwell_s", "dip_height_m")
"""Settings whose defaults are assumptions."""


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
    takeoff_interval_s
        Time between the take-offs of two drones, so that they do not meet in the yard.
    assumptions
        Names of the fields above that hold a default nobody confirmed. `read_fleet` names those absent from the file; a
        fleet made directly names those equal to the default. A limit of ``None`` assumes nothing.

    Raises
    ------
    InvalidInput
        With every field that is out of range or of the wrong type.
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
    takeoff_interval_s: float = 10.0
    assumptions: tuple[str, ...] = field(default=_ASSUMABLE, compare=False, kw_only=True)

    def __post_init__(self) -> None:
        faults = _check(_settings(self))
        if not faults and self.sampling == "hover-dip" and self.dip_height_m >= self.transit_height_m:
            message = f"{self.dip_height_m:g} m is not below the transit height of {self.transit_height_m:g} m"
            faults.append(Fault("dip_height_m", message, "dip lower or fly higher"))
        if faults:
            raise InvalidInput(faults)
        defaults = {item.name: item.default for item in fields(self)}
        still_default = tuple(name for name in self.assumptions if getattr(self, name) == defaults[name])
        object.__setattr__(self, "assumptions", still_default)

    @property
    def service_s(self) -> float:
        """Time on station at one pond in seconds, from arriving above it at transit height to leaving from there.

        Measured at 7 m: a hover dip takes 9.8 s (down to 2 m) and the dwell; a splashdown 16.4 s of landing, the dwell
        and 6.7 s of climb. Other heights add or save what the autopilot's default vertical speeds make of the
        difference: 1.5 m/s down and 2.5 m/s up for a hover dip, 0.5 m/s down and 2.5 m/s up for a splashdown.
        """
        if self.sampling == "splashdown":
            above_measured_m = self.transit_height_m - MEASURED_HEIGHT_M
            landing_s = self.transit_height_m / LANDING_SPEED_M_S + LANDING_FLARE_S
            return landing_s + self.dwell_s + SPLASHDOWN_CLIMB_S + above_measured_m / CLIMB_SPEED_M_S
        beyond_measured_m = self.transit_height_m - self.dip_height_m - MEASURED_DIP_M
        dip_s = HOVER_DIP_S + beyond_measured_m * (1.0 / DESCENT_SPEED_M_S + 1.0 / CLIMB_SPEED_M_S)
        return dip_s + self.dwell_s


def read_fleet(path: str | Path) -> Fleet:
    """Read a fleet from a TOML file whose keys are the fields of `Fleet`; only ``num_drones`` has no default.

    Raises
    ------
    InvalidInput
        With every fault of the file: unknown keys, missing and wrong values.
    """
    path = Path(path)
    try:
        settings = tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        action = "name a TOML file with a line num_drones = 3"
        raise InvalidInput([Fault(str(path), f"cannot be read: {error.strerror}", action)]) from error
    except UnicodeDecodeError as error:
        raise InvalidInput([Fault(str(path), "this is no text", "save the file as UTF-8 text")]) from error
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InvalidInput([Fault(str(path), f"this is no TOML: {error}", "write lines key = value")]) from error
    names = [item.name for item in fields(Fleet) if item.name != "assumptions"]
    faults = []
    for key in settings.keys() - set(names):
        close = difflib.get_close_matches(key, names, n=1)
        action = f"did you mean {close[0]}?" if close else f"use {', '.join(names)}"
        faults.append(Fault(key, "unknown setting", action))
    faults.sort(key=lambda fault: list(settings).index(fault.path))
    known = {key: value for key, value in settings.items() if key in names}
    if "num_drones" not in known:
        faults.append(Fault("num_drones", "the number of drones is missing", "add a line num_drones = 3"))
    faults.extend(_check(known))
    if faults:
        raise InvalidInput(faults)
    values: dict[str, Any] = dict(known)
    return Fleet(**values, assumptions=tuple(name for name in _ASSUMABLE if name not in known))


def _settings(fleet: Fleet) -> dict[str, object]:
    values = {item.name: getattr(fleet, item.name) for item in fields(fleet) if item.name != "assumptions"}
    return {name: value for name, value in values.items() if value is not None}


def _check(settings: Mapping[str, object]) -> list[Fault]:
    """Faults of the settings that are there."""
    faults = []
    for name, value in settings.items():
        if name == "sampling":
            if value not in get_args(SamplingStyle):
                action = f"use one of {', '.join(get_args(SamplingStyle))}"
                faults.append(Fault(name, f"{value!r} is no way of sampling", action))
            continue
        low, high = _RANGES[name]
        is_whole = name == "num_drones"
        kinds = (int,) if is_whole else (int, float)
        if isinstance(value, bool) or not isinstance(value, kinds) or not math.isfinite(value):
            noun = "whole number" if is_whole else "number"
            faults.append(Fault(name, f"{value!r} is no {noun}", f"give a {noun} from {low:g} to {high:g}"))
        elif not low <= value <= high:
            faults.append(Fault(name, f"{value!r} is out of range", f"give a value from {low:g} to {high:g}"))
    return faults
