"""A plan with what it was made for: results as values, and as JSON and GeoJSON."""

from __future__ import annotations

from dataclasses import dataclass

from pondhop._core import Plan, Problem
from pondhop.farm import Farm
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
    """

    problem: Problem
    plan: Plan
    planner: str
    seed: int
    elapsed_s: float
    lower_bound: float


@dataclass(frozen=True)
class FarmPlan:
    """A solution for a real farm and fleet; pond indices of the routes are those of ``farm.ponds``."""

    farm: Farm
    fleet: Fleet
    solution: Solution
