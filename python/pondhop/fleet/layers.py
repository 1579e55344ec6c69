"""Height layers: drones fly out to their first pond, and come home, each at a height of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pondhop.fleet.settings import MAX_HEIGHT_M

if TYPE_CHECKING:
    from pondhop.fleet.model import Fleet

LAYER_SPACING_M = 3.0
"""How much higher each drone comes home than the one before it, where nothing else is said."""


@dataclass(frozen=True)
class Layers:
    """At which heights the drones of a round fly out and come home; drones count from 0.

    Attributes
    ----------
    way_out_m, way_home_m
        Heights of the lowest drone.
    spacing_m
        How much higher each drone flies than the one before it.
    """

    way_out_m: float
    way_home_m: float
    spacing_m: float

    def way_out_height_m(self, drone: int) -> float:
        """Return the height at which a drone flies to its first pond."""
        return self.way_out_m + drone * self.spacing_m

    def way_home_height_m(self, drone: int) -> float:
        """Return the height at which a drone comes home."""
        return self.way_home_m + drone * self.spacing_m


def layers_of(fleet: Fleet, num_ponds: int) -> Layers:
    """Return the layers of a round over so many ponds: no more drones fly than there are ponds.

    The lowest drone comes home at ``return_height_m``, but not below the transit height: an autopilot does not descend
    for the way home.
    """
    way_home_m = max(fleet.return_height_m, fleet.transit_height_m)
    spacing_m = fleet.layer_spacing_m
    if spacing_m is None:
        spacing_m = min(LAYER_SPACING_M, (MAX_HEIGHT_M - way_home_m) / max(1, fleet.num_flying(num_ponds) - 1))
    return Layers(fleet.transit_height_m, way_home_m, spacing_m)
