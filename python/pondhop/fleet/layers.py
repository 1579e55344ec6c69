"""Height layers: drones fly out to their first pond, and come home, each at a height of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pondhop.arguments import Arguments
from pondhop.errors import Fault, InvalidInput
from pondhop.fleet.settings import MAX_HEIGHT_M

if TYPE_CHECKING:
    from pondhop.fleet.model import Fleet

LAYER_SPACING_M = 3.0
"""How much higher each drone comes home than the one before it, where nothing else is said and there is room."""

LEAST_SPACING_M = 2.0
"""Less is no distance: barometers of drones drift apart by a metre, and each keeps its height within half of one."""


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


def layers_of(fleet: Fleet, num_ponds: int, *, are_stacked: bool = False) -> Layers:
    """Return the layers of a round over so many ponds: no more drones fly than there are ponds.

    Parameters
    ----------
    are_stacked
        Whether all ways home lie above all ways out, by the spacing. Else they may lie between each other, and time
        must keep them apart.

    Raises
    ------
    InvalidInput
        If the layers do not fit below the highest allowed flight.
    """
    arguments = Arguments()
    arguments.truth("are_stacked", are_stacked)
    arguments.check()
    num_flying = fleet.num_flying(num_ponds)
    base_m = lowest_way_home_m(fleet.return_height_m, fleet.transit_height_m)
    num_above = num_flying - 1
    spacing_m = fleet.layer_spacing_m
    if spacing_m is None:
        fitting_m = [(MAX_HEIGHT_M - base_m) / max(1, num_above)]
        if are_stacked:
            fitting_m.append((MAX_HEIGHT_M - fleet.transit_height_m) / (num_flying + num_above))
        spacing_m = max(LEAST_SPACING_M, min(LAYER_SPACING_M, *fitting_m))
    if are_stacked:
        base_m = max(base_m, fleet.transit_height_m + num_flying * spacing_m)
    if num_above and base_m + num_above * spacing_m > MAX_HEIGHT_M + 1e-9:
        message = (
            f"{num_flying} drones fly, and come home {spacing_m:g} m above each other: "
            f"the highest at {base_m + num_above * spacing_m:g} m"
        )
        action = f"{layers_remedy(base_m, spacing_m)}: nothing may fly above {MAX_HEIGHT_M} m"
        raise InvalidInput([Fault("num_drones", message, action)])
    return Layers(fleet.transit_height_m, base_m, spacing_m)


def lowest_way_home_m(return_height_m: float, transit_height_m: float) -> float:
    """Return the height at which the lowest drone comes home: an autopilot does not descend for the way home."""
    return max(return_height_m, transit_height_m)


def layers_remedy(lowest_m: float, spacing_m: float) -> str:
    """Return what to do where the highest of some drones would come home above the highest allowed flight."""
    num_fitting = 1 + max(0, int((MAX_HEIGHT_M - lowest_m) / spacing_m))
    drones = "one drone" if num_fitting == 1 else f"at most {num_fitting} drones, {spacing_m:g} m apart"
    return f"fly {drones}, or lower (transit_height_m, return_height_m)"
