"""Lower bounds through the binding, and how tight they are on the development data."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from pondhop import Problem, _core, evaluate, instances
from pondhop._core import lower_bound, lower_bound_of_makespan, lower_bound_of_total

SHARED = Path(__file__).parents[1].parent / "shared" / "data"
needs_shared = pytest.mark.skipif(not SHARED.is_dir(), reason=f"the development data is not at {SHARED}")


def test_the_bounds_of_a_square() -> None:
    square = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert lower_bound(Problem([0, 0], square, 1)) == pytest.approx(4)
    assert lower_bound(Problem([0, 0], square, 3)) == pytest.approx(2 * 2**0.5)
    assert lower_bound_of_total(Problem([0, 0], square, 3)) == pytest.approx(4)


@needs_shared
@pytest.mark.parametrize(("name", "tightness"), [("farms200", 0.910), ("farms300", 0.920), ("farms700", 0.940)])
def test_bounds_are_below_the_best_known_plans_and_near_them(name: str, tightness: float) -> None:
    best_known = json.loads((SHARED / "instances" / "best_known.json").read_text())
    farms = instances.read_farms(SHARED / "instances" / f"{name}.json")
    ratios = []
    for best in best_known:
        if best["instance"] == name:
            problem = farms[best["index"]].to_problem(best["routes_allowed"])
            # The file rounds to six decimals.
            ratios.append(lower_bound(problem) / (best["best_max_route_length"] + 5e-7))
            assert lower_bound_of_total(problem) <= best["total_length_at_best"] + 5e-7
    assert len(ratios) == 10
    assert max(ratios) <= 1
    assert np.mean(ratios) > tightness


@needs_shared
def test_bounds_are_below_the_published_plans() -> None:
    for row in csv.DictReader((SHARED / "mtsp" / "best_known.csv").read_text().splitlines()):
        farm = instances.read_tsplib(SHARED / "mtsp" / f"{row['instance'].split('_')[0]}.tsp")
        problem = farm.to_problem(int(row["routes"]))
        # The file rounds to four decimals.
        assert lower_bound(problem) <= float(row["best_max_route_length"]) + 5e-5


def test_the_bound_in_seconds_by_hand() -> None:
    problem = Problem(
        [0, 0],
        [[60, 0], [20, 0]],
        2,
        service_durations_s=[10, 10],
        speed_m_s=5,
        leg_stop_s=3,
        takeoff_s=9,
        way_home_speed_m_s=10,
        way_home_fixed_s=44,
    )
    # 9 + 60 / 5 + 3, 10, 60 / 10 + 44 s.
    assert lower_bound_of_makespan(problem) == 84
    assert evaluate(problem, [[0], [1]]).makespan_s == 84
    plain = problem.replace(way_home_speed_m_s=None, way_home_fixed_s=0, takeoff_s=0)
    assert lower_bound_of_makespan(plain) == 15 + 10 + 15


def test_time_on_station_counts() -> None:
    ponds = np.random.default_rng(5).uniform(0, 100, (40, 2))
    problem = Problem([50, 50], ponds, 3, service_durations_s=np.full(40, 60.0), speed_m_s=5.0)
    bound = lower_bound_of_makespan(problem)
    plan = evaluate(problem, _core.search(problem, iterations=20_000)[0])
    assert 40 * 60 / 3 < bound <= plan.makespan_s < 1.05 * bound


def test_the_bounds_of_research_farms_are_one() -> None:
    problem = instances.generate(150, seed=4)[0].to_problem(5)
    assert lower_bound_of_makespan(problem) == lower_bound(problem)
