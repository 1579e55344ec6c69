"""Proofs that drones are too few, against every plan of small problems and against the searches that they spare."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, permutations

import numpy as np
import pytest

import pondhop
from pondhop import Energy, Fleet, Problem, evaluate, planners
from pondhop.proofs import Proofs


def every_plan(num_ponds: int, num_drones: int) -> Iterator[list[list[int]]]:
    for order in permutations(range(num_ponds)):
        for num_routes in range(1, min(num_drones, num_ponds) + 1):
            for cuts in combinations(range(1, num_ponds), num_routes - 1):
                bounds = [0, *cuts, num_ponds]
                yield [list(order[bounds[i] : bounds[i + 1]]) for i in range(num_routes)]


def random_problem(seed: int) -> Problem:
    random = np.random.default_rng(seed)
    num_drones = int(random.integers(1, 4))
    ponds = random.uniform(-100.0, 100.0, (4, 2))
    if seed % 3 == 0:
        # Ponds in one place, and one at the depot.
        ponds[1], ponds[2] = ponds[0], 0.0
    way_home_m_s = None if seed % 4 == 0 else 8.0
    layers = random.uniform(0.0, 50.0, (num_drones, 4)) if seed % 2 and way_home_m_s else None
    return Problem(
        [0.0, 0.0],
        ponds,
        num_drones,
        service_durations_s=random.uniform(0.0, 5.0, 4),
        service_energies_j=random.uniform(0.0, 50.0, 4),
        speed_m_s=5.0,
        leg_stop_s=2.0,
        takeoff_s=9.0,
        way_home_speed_m_s=way_home_m_s,
        way_home_fixed_s=20.0 if way_home_m_s else 0.0,
        energy=Energy(takeoff_j=10.0, leg_w=3.0, leg_stop_w=2.0, way_home_w=4.0, way_home_fixed_j=20.0),
        layers=layers,
    )


@pytest.mark.parametrize("seed", range(24))
def test_no_plan_keeps_what_is_proved_to_be_out_of_reach(seed: int) -> None:
    problem = random_problem(seed)
    plans = [evaluate(problem, routes) for routes in every_plan(4, problem.num_drones)]
    least = {
        "max_length_m": min(plan.route_lengths.max() for plan in plans),
        "max_duration_s": min(plan.route_durations_s.max() for plan in plans),
        "energy": min(plan.route_energies_j.max() for plan in plans),
    }
    proofs = Proofs(problem)
    proved = 0
    for name, value in least.items():
        for share in (0.2, 0.4, 0.6, 0.8, 0.9, 1.0):
            limit = share * float(value)
            limited = problem.replace(energy=problem.energy.replace(usable_j=limit)) if name == "energy" else None
            limited = limited or problem.replace(**{name: limit})  # type: ignore[arg-type]
            is_out_of_reach = proofs.is_out_of_reach(limited)
            # The best plan keeps a limit of just what it takes, so that nothing may be proved there.
            assert not (is_out_of_reach and share == 1.0)
            proved += is_out_of_reach
    assert proved >= 3


@pytest.mark.parametrize("battery_wh", [90.0, 150.0, 300.0])
def test_proofs_spare_searches_and_change_no_answer(battery_wh: float, monkeypatch: pytest.MonkeyPatch) -> None:
    farm = pondhop.generate_farm(40, at=(-90.9, 33.4), seed=1)
    fleet = Fleet(2, battery_wh=battery_wh)
    tried: list[int] = []
    sized = planners._sized

    def counted(problem: Problem, options: planners.Options, is_separate: bool) -> planners.Routes:
        tried.append(problem.num_drones)
        return sized(problem, options, is_separate)

    monkeypatch.setattr(planners, "_sized", counted)
    proved = pondhop.plan(farm, fleet, iterations=2000)
    with_proofs = list(tried)
    tried.clear()
    monkeypatch.setattr(Proofs, "is_out_of_reach", lambda *_: False)
    searched = pondhop.plan(farm, fleet, iterations=2000)
    assert replace(proved.solution, elapsed_s=0.0, cpu_s=0.0) == replace(searched.solution, elapsed_s=0.0, cpu_s=0.0)
    assert proved.num_drones_needed == searched.num_drones_needed
    assert len(with_proofs) <= len(tried)
    assert len(with_proofs) < len(tried) or battery_wh == 300.0
