"""A farm and a plan made by hand, small enough to check on paper."""

from __future__ import annotations

from pathlib import Path

from pondhop import evaluate
from pondhop.farm.model import Farm, Pond
from pondhop.fleet import Fleet
from pondhop.solution import FarmPlan, Solution

SHARED = Path(__file__).parents[1] / ".." / "shared"

DEPOT = (-89.0, 37.0)
"""About 89 m per 0.001 degrees of longitude, 111 m per 0.001 degrees of latitude."""


def square(longitude: float, latitude: float, half_width: float) -> tuple[tuple[float, float], ...]:
    """A closed square ring."""
    west, east, south, north = (
        longitude - half_width,
        longitude + half_width,
        latitude - half_width,
        latitude + half_width,
    )
    return ((west, south), (east, south), (east, north), (west, north), (west, south))


def make_farm(**changes: object) -> Farm:
    """Five ponds in a row, 0.001 degrees apart, north of the depot; the fence has room for them."""
    ponds = tuple(
        Pond(f"P{number}", (-89.002 + 0.001 * number, 37.001), (square(-89.002 + 0.001 * number, 37.001, 0.0004),))
        for number in range(5)
    )
    fields = {"name": "Test farm", "ponds": ponds, "depot": DEPOT, "fences": ((square(*DEPOT, 0.01),),)}
    return Farm(**(fields | changes))  # type: ignore[arg-type]


def make_plan(farm: Farm, fleet: Fleet, routes: list[list[int]]) -> FarmPlan:
    problem = farm.to_problem(fleet)
    plan = evaluate(problem, routes)
    return FarmPlan(farm, fleet, Solution(problem, plan, "by hand", seed=1, elapsed_s=0.0, known_lower_bound_s=100.0))


def two_drones() -> FarmPlan:
    """Two drones; the second has two ponds."""
    return make_plan(make_farm(), Fleet(num_drones=2), [[0, 1, 2], [4, 3]])
