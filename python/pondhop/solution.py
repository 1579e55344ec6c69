"""Results as values: what a planner made of a problem, and the same with the farm and fleet it is for."""

from __future__ import annotations

from dataclasses import dataclass

from pondhop._core import Plan, Problem, Separation
from pondhop.farm.model import Farm
from pondhop.fleet import Fleet


@dataclass(frozen=True)
class Solution:
    """What a planner made of a problem.

    Attributes
    ----------
    problem, plan
        The task and the evaluated routes.
    planner, seed
        How it was made.
    elapsed_s
        Wall time of planning, from coordinates to finished routes.
    lower_bound
        No plan has a shorter longest route, in length units.
    separation
        `None` where nobody measured it.
    cpu_s
        Processor time of all threads of this process while it planned; 0 for a plan that was read.
    is_interrupted
        Whether Ctrl-C ended the planning; the plan is the best so far.
    reason
        What `auto` chose and why; empty for other planners.
    """

    problem: Problem
    plan: Plan
    planner: str
    seed: int
    elapsed_s: float
    lower_bound: float
    separation: Separation | None = None
    cpu_s: float = 0.0
    is_interrupted: bool = False
    reason: str = ""

    @property
    def gap_percent(self) -> float | None:
        """How far the longest route is above the lower bound; `None` if the bound is 0."""
        return gap_percent(self.plan.max_route_length, self.lower_bound)


def gap_percent(max_route_length: float, lower_bound: float) -> float | None:
    """Return how far a longest route is above the lower bound; `None` if the bound is 0."""
    return 100 * (max_route_length - lower_bound) / lower_bound if lower_bound > 0 else None


@dataclass(frozen=True)
class FarmPlan:
    """A solution for a real farm and fleet; pond indices of the routes are those of ``farm.ponds``."""

    farm: Farm
    fleet: Fleet
    solution: Solution

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know before flying, a sentence each."""
        notes = list(self.farm.notes)
        if self.solution.reason:
            notes.append(f"Planner {self.solution.planner} chose {self.solution.reason}.")
        if self.fleet.sampling == "splashdown":
            notes.append(
                "Splashdown: set bit 2 of the ArduPilot parameter MIS_OPTIONS (add 4) on every drone, or it disarms on "
                "the first pond and stays there."
            )
        return tuple(notes)
