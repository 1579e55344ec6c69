"""The wind of a round."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from pondhop.arguments import Arguments, shortened
from pondhop.errors import Fault, InvalidInput
from pondhop.units import Units, speed_text

MAX_WIND_M_S = 50.0
"""A storm in which nothing flies."""

_TEXT = re.compile(r"\s*([0-9.]+)\s*@\s*([0-9.]+)\s*")


@dataclass(frozen=True)
class Wind:
    """How strong it blows, and where from.

    Attributes
    ----------
    speed_m_s
        At the height of flight.
    from_deg
        Where it blows from, in degrees from north over east: 225 is a wind from the south-west.

    Raises
    ------
    InvalidInput
        If one of them is out of range.
    """

    speed_m_s: float = 0.0
    from_deg: float = 0.0

    def __post_init__(self) -> None:
        arguments = Arguments()
        action = f"give 0 to {MAX_WIND_M_S:g} m/s"
        arguments.real("wind.speed_m_s", self.speed_m_s, 0.0, MAX_WIND_M_S, action)
        arguments.real(
            "wind.from_deg", self.from_deg, 0.0, 360.0, "give 0 to 360 degrees, 270 for a wind from the west"
        )
        arguments.check()

    @property
    def velocity_m_s(self) -> tuple[float, float]:
        """How fast the air moves towards east and north."""
        angle = math.radians(self.from_deg)
        return -self.speed_m_s * math.sin(angle), -self.speed_m_s * math.cos(angle)

    def told(self, units: Units = "metric") -> str:
        """Return it in words: ``a wind of 8 m/s from 225 degrees``."""
        return (
            f"a wind of {speed_text(self.speed_m_s, units)} from {self.from_deg:g} degrees"
            if self.speed_m_s
            else "calm air"
        )


CALM = Wind()
"""No wind."""


def parse_wind(text: str) -> Wind:
    """Return the wind of a text as ``8@225``: metres per second, and where it blows from in degrees.

    Raises
    ------
    InvalidInput
        If it is none.
    """
    match = _TEXT.fullmatch(text)
    try:
        speed_m_s, from_deg = map(float, match.groups() if match else ())
    except ValueError:
        action = "give metres per second and where it blows from in degrees, as 4@225"
        raise InvalidInput([Fault("wind", f"{shortened(text)!r} is no wind", action)]) from None
    return Wind(speed_m_s, from_deg)
