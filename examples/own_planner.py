"""A planner of one's own beside those of pondhop, on the same farms: `python examples/own_planner.py`."""

from statistics import fmean

import numpy as np

import pondhop


def sweep(problem: pondhop.Problem, seed: int, time_limit_s: float | None) -> list[list[int]]:  # noqa: ARG001
    """Cut the ponds, sorted by their direction from the depot, into routes of equal numbers of ponds."""
    offsets = problem.ponds - problem.depot
    by_angle = np.argsort(np.arctan2(offsets[:, 1], offsets[:, 0]))
    return [route.tolist() for route in np.array_split(by_angle, problem.num_drones)]


problems = [farm.to_problem(5) for farm in pondhop.generate(100, 20, seed=1)]
for planner in ("hpp", sweep):
    solutions = [pondhop.solve(problem, planner=planner) for problem in problems]
    longest = fmean(solution.plan.max_route_length for solution in solutions)
    print(f"{solutions[0].planner:>6}: longest route {longest:.2f} on average")
