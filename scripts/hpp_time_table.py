"""Print the table "In HPP's time" of docs/benchmarks.md: the first plan of `search` against that of HPP.

Both plan each farm ten times on one thread, and the least processor time counts; `search` ends once it has a plan.

    python scripts/hpp_time_table.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pondhop import Problem, ResearchFarm, generate, solve

NUM_FARMS = 20
NUM_RUNS = 10
AT_ONCE_S = 1e-9
NUM_ROUTES = 5


@dataclass(frozen=True)
class Found:
    """The plan of one farm: its longest route, and the least processor seconds that it took."""

    max_route_length: float
    cpu_s: float


def found_by(planner: str, problem: Problem, time_limit_s: float | None) -> Found:
    """Plan a farm several times."""
    solutions = [solve(problem, planner=planner, time_limit_s=time_limit_s) for _ in range(NUM_RUNS)]
    return Found(solutions[0].plan.max_route_length, min(solution.cpu_s for solution in solutions))


def row(name: str, farms: Sequence[ResearchFarm], num_routes: int = NUM_ROUTES) -> str:
    """The row of a set of farms."""
    problems = [Problem(farm.depot, farm.ponds, num_routes) for farm in farms]
    pairs = [(found_by("search", problem, AT_ONCE_S), found_by("hpp", problem, None)) for problem in problems]
    ours = np.array([[found.max_route_length, found.cpu_s] for found, _ in pairs])
    theirs = np.array([[found.max_route_length, found.cpu_s] for _, found in pairs])
    shorter = 1.0 - ours[:, 0].sum() / theirs[:, 0].sum()
    worst = 1.0 - (ours[:, 0] / theirs[:, 0]).max()
    own_us, their_us = ours[:, 1].mean() * 1e6, theirs[:, 1].mean() * 1e6
    return f"| {name} | {shorter:.0%} | {worst:.0%} | {own_us / their_us:.2f} | {own_us:.0f} µs | {their_us:.0f} µs |"


def with_depot_in_the_centre(farm: ResearchFarm) -> ResearchFarm:
    """The same ponds around their depot."""
    return ResearchFarm((farm.ponds.min(axis=0) + farm.ponds.max(axis=0)) / 2, farm.ponds, None, farm.spacing)


def turned(farm: ResearchFarm) -> ResearchFarm:
    """The same farm, its grid not parallel to the axes."""
    cosine, sine = np.cos(0.3), np.sin(0.3)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    return ResearchFarm(farm.depot @ turn, farm.ponds @ turn, None, farm.spacing)


def without_grid(num_ponds: int, seed: int) -> ResearchFarm:
    """Ponds anywhere, and a depot."""
    points = np.random.default_rng(seed).uniform(size=(num_ponds + 1, 2))
    return ResearchFarm(points[0], points[1:], None, None)


def main() -> None:
    """Print the table row by row."""
    print(
        f"| farms, {NUM_ROUTES} routes unless said | shorter by | on the worst farm | time, in HPP's | search | HPP |"
    )
    print("|---|--:|--:|--:|--:|--:|")
    sets = {num_ponds: generate(num_ponds, NUM_FARMS) for num_ponds in (50, 100, 200, 400, 700, 1000, 2000)}
    for num_ponds, farms in sets.items():
        print(row(f"{num_ponds:,} ponds", farms))
    for num_routes in (2, 20):
        print(row(f"700, {num_routes} routes", sets[700], num_routes))
    print(row("700, depot in the centre", [with_depot_in_the_centre(farm) for farm in sets[700]]))
    print(row("700, a grid that is turned", [turned(farm) for farm in sets[700]]))
    print(row("700, at random, without a grid", [without_grid(700, seed) for seed in range(NUM_FARMS)]))


if __name__ == "__main__":
    main()
