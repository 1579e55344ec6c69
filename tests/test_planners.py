"""The family of planners: by name, one's own, and what is said about wrong ones."""

from functools import partial
from typing import get_type_hints

import numpy as np
import pytest

import pondhop
from hand_made import make_farm
from pondhop import InvalidInput, Problem, _core
from pondhop.farm.made_up import generate_farm
from pondhop.fleet import Fleet
from pondhop.planners import PLANNERS, OptionFields, Options


@pytest.fixture
def problem() -> Problem:
    """Two ponds north and one east of the depot, two drones."""
    return Problem((0.0, 0.0), np.array([[0.0, 3.0], [0.0, 6.0], [5.0, 0.0]]), 2)


def test_planners_are_registered_under_their_names() -> None:
    assert "hpp" in PLANNERS
    assert all(planner.name == name and planner.description for name, planner in PLANNERS.items())


def test_a_problem_says_what_it_was_made_of() -> None:
    problem = Problem(
        (1.0, 2.0),
        np.array([[0.0, 3.0], [0.0, 6.0]]),
        2,
        service_durations_s=np.array([4.0, 5.0]),
        speed_m_s=6.0,
        leg_stop_s=7.0,
        max_length_m=8.0,
        max_duration_s=9.0,
    )
    assert problem.service_durations_s.tolist() == [4.0, 5.0]
    assert (problem.speed_m_s, problem.leg_stop_s, problem.max_length_m, problem.max_duration_s) == (6.0, 7.0, 8.0, 9.0)
    free = Problem((1.0, 2.0), np.array([[0.0, 3.0]]), 1)
    assert (free.speed_m_s, free.leg_stop_s, free.max_length_m, free.max_duration_s) == (1.0, 0.0, np.inf, np.inf)


@pytest.mark.parametrize("planner", PLANNERS)
def test_every_planner_serves_every_pond_and_repeats_itself(planner: str) -> None:
    for farm in pondhop.generate(20, 2, seed=11):
        solution = pondhop.solve(farm.to_problem(5), planner=planner, seed=3, iterations=300)
        # Nothing limits the routes of the paper's attention model.
        assert solution.plan.is_feasible or planner == "am"
        assert not solution.plan.unserved
        assert solution.planner == planner
        assert solution.seed == 3
        assert 0.0 < solution.lower_bound <= solution.plan.max_route_length
        assert (
            solution.plan.routes
            == pondhop.solve(farm.to_problem(5), planner=planner, seed=3, iterations=300).plan.routes
        )


def test_a_planner_of_ones_own(problem: Problem) -> None:
    seen = []

    def by_hand(task: Problem, seed: int, time_limit_s: float | None) -> list[list[int]]:
        seen.append((task, seed, time_limit_s))
        return [[0, 1], [2]]

    solution = pondhop.solve(problem, planner=by_hand, seed=9, time_limit_s=2.5)
    assert seen == [(problem, 9, 2.5)]
    assert solution.planner == "by_hand"
    assert solution.plan.route_lengths.tolist() == [12.0, 10.0]
    assert solution.elapsed_s >= 0.0
    assert solution.lower_bound == pytest.approx(12.0)


def test_a_bound_is_found_once_and_only_where_it_is_asked_for(
    problem: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    found: list[str] = []

    def bound(name: str, _problem: Problem) -> float:
        found.append(name)
        return 12.0

    for name in ("lower_bound", "lower_bound_of_makespan"):
        monkeypatch.setattr(_core, name, partial(bound, name))
    solution = pondhop.solve(problem, planner="hpp")
    assert found == []
    assert solution.lower_bound == solution.lower_bound == 12.0
    assert found == ["lower_bound"]
    assert (solution.lower_bound_s, solution.gap_s_percent) == (12.0, solution.gap_percent)
    assert found == ["lower_bound", "lower_bound_of_makespan"]


def test_a_wrong_plan_is_a_result_with_violations(problem: Problem) -> None:
    solution = pondhop.solve(problem, planner=lambda *_: [[0], [0], [1]])
    assert not solution.plan.is_feasible
    assert solution.plan.unserved == [2]


def test_an_unknown_pond_is_invalid(problem: Problem) -> None:
    with pytest.raises(InvalidInput):
        pondhop.solve(problem, planner=lambda *_: [[3]])


def test_every_wrong_option_is_named_at_once(problem: Problem) -> None:
    with pytest.raises(InvalidInput) as caught:
        pondhop.solve(problem, planner="hpq", seed=-1, time_limit_s=0.0, threads=0)
    assert [fault.path for fault in caught.value.faults] == ["seed", "time_limit_s", "threads", "planner"]
    assert caught.value.faults[-1].action == "did you mean 'hpp'?"


def test_a_name_like_no_other_lists_the_planners(problem: Problem) -> None:
    with pytest.raises(InvalidInput) as caught:
        pondhop.solve(problem, planner="simulated annealing")
    assert "hpp" in caught.value.faults[0].action


def test_territory_keeps_drones_apart_on_shorter_routes_than_hpp() -> None:
    for farm in pondhop.generate(120, 4, seed=5):
        problem = farm.to_problem(5)
        territory = pondhop.solve(problem, planner="territory").plan
        separation = _core.separation(problem, territory.routes)
        assert separation.overlap < 1e-9
        assert separation.num_crossings == 0
        assert territory.max_route_length < 0.9 * pondhop.solve(problem, planner="hpp").plan.max_route_length


def test_territory_within_a_time_limit_long_over() -> None:
    (farm,) = pondhop.generate(150, 1, seed=5)
    assert pondhop.solve(farm.to_problem(5), planner="territory", time_limit_s=1e-6).plan.is_feasible


def test_auto_says_what_it_chose_and_why() -> None:
    task = pondhop.generate(60, seed=2)[0].to_problem(4)
    shared = pondhop.solve(task, iterations=300)
    assert shared.planner == "auto"
    assert shared.reason.startswith("search for 300 steps")
    apart = pondhop.solve(task, has_separate_airspace=True)
    assert apart.reason.startswith("territory")
    assert _core.separation(task, apart.plan.routes).overlap == 0.0


def test_search_does_not_pretend_to_keep_drones_apart(problem: Problem) -> None:
    with pytest.raises(InvalidInput, match="has_separate_airspace"):
        pondhop.solve(problem, planner="search", has_separate_airspace=True)


def test_the_options_are_the_fields_of_effort() -> None:
    assert get_type_hints(OptionFields) == get_type_hints(Options)
    with pytest.raises(TypeError, match="speed"):
        pondhop.solve(Problem((0.0, 0.0), np.array([[0.0, 1.0]]), 1), speed=3)  # type: ignore[call-arg]


def test_drones_that_stay_at_home_cost_nothing() -> None:
    farm = make_farm(ponds=make_farm().ponds[:1])
    alone = pondhop.plan(farm, Fleet(1, battery_wh=25)).solution.plan
    assert alone.is_feasible
    for num_drones in (2, 5, 36, 10_000):
        assert pondhop.plan(farm, Fleet(num_drones, battery_wh=25)).solution.plan == alone


def test_each_drone_takes_as_long_as_its_own_layer() -> None:
    farm, fleet = make_farm(), Fleet(4)
    plan = pondhop.plan(farm, fleet).plan
    assert len(plan.routes) > 2
    for drone, route in enumerate(plan.routes):
        # A fleet of one that comes home that much higher, and what the way out takes more: up, and down at its pond.
        higher = Fleet(1, return_height_m=15.0 + 3.0 * drone)
        alone = pondhop.evaluate(farm.to_problem(higher), [route])
        way_out_s = 3.0 * drone * (1 / 2.5 + 1 / 1.5)
        assert plan.route_durations_s[drone] == pytest.approx(alone.route_durations_s[0] + way_out_s)
    lowest_s = pondhop.evaluate(farm.to_problem(fleet).replace(layers=None), plan.routes).route_durations_s
    assert list(lowest_s) == sorted(lowest_s, reverse=True)


@pytest.mark.parametrize("battery_wh", [45.0, 70.0])
@pytest.mark.parametrize("planner", ["auto", "hpp"])
def test_the_number_of_drones_that_is_told_is_enough(battery_wh: float, planner: str) -> None:
    farm = generate_farm(24, at=(-90.9, 33.4), seed=4)
    feasible = []
    for num_drones in (1, 2, 3, 5, 8, 12):
        farm_plan = pondhop.plan(farm, Fleet(num_drones, battery_wh=battery_wh), planner=planner, iterations=9_000)
        feasible.append(farm_plan.is_feasible)
        needed = farm_plan.num_drones_needed
        if needed is not None:
            assert not farm_plan.is_feasible
            assert pondhop.plan(farm, Fleet(needed, battery_wh=battery_wh), iterations=9_000).is_feasible
        elif not farm_plan.is_feasible:
            assert all("fly with" not in found.remedy for found in farm_plan.violations)
    if planner == "auto":
        # More drones are never worse than fewer.
        assert feasible == sorted(feasible)


@pytest.mark.parametrize("planner", PLANNERS)
def test_options_that_a_planner_cannot_obey_are_told(planner: str) -> None:
    task = pondhop.generate(12, seed=3)[0].to_problem(2)
    asked = {"time_limit_s": 0.05, "threads": 2, "iterations": 7, "slack_percent": 3.0, "objective": "total"}
    asked |= {"start": [list(range(6)), list(range(6, 12))]}
    obeyed = {
        "auto": set(asked),
        "search": set(asked),
        "territory": {"time_limit_s", "iterations"},
        "ortools": {"time_limit_s"},
        "ortools-gls": {"time_limit_s", "iterations"},
        "pyvrp": {"time_limit_s", "iterations"},
    }
    solution = pondhop.solve(task, planner=planner, **asked)  # type: ignore[arg-type]
    assert set(solution.passed_over) == set(asked) - obeyed.get(planner, set())
    decoded = pondhop.solve(task, planner=planner, iterations=5, decoding="sampling")
    is_network = planner.startswith("am")
    assert ("decoding" in decoded.passed_over) != is_network
    assert not (is_network and decoded.passed_over)
    assert pondhop.solve(task, planner=planner, seed=7).passed_over == ()


def test_what_is_passed_over_is_a_note_of_the_plan() -> None:
    def by_hand(task: Problem, _seed: int, _time_limit_s: float | None) -> list[list[int]]:
        return [list(range(task.num_ponds))]

    for planner in ("hpp", by_hand):
        notes = pondhop.plan(make_farm(), Fleet(2), planner=planner, objective="total", slack_percent=5.0).notes
        assert any("has no use for what was asked for, and passed it over: slack, objective." in note for note in notes)
    apart = pondhop.plan(make_farm(), Fleet(2), has_separate_airspace=True, objective="total")
    assert apart.solution.passed_over == ("objective",)


def test_nothing_is_told_as_less_than_nothing() -> None:
    apart = pondhop.Problem((0.0, 0.0), [[0, 1], [1, 2], [1, 1], [0, -1], [1, -2], [1, -1]], 2)
    overlap = _core.separation(apart, [[0, 1, 2], [3, 4, 5]]).overlap
    total = pondhop.evaluate(apart, []).total_length
    assert [str(overlap), str(total)] == ["0.0", "0.0"]


def test_ponds_out_of_reach_are_told_once() -> None:
    farm_plan = pondhop.plan(generate_farm(24, at=(-90.9, 33.4), seed=4), Fleet(2, battery_wh=5.0))
    beyond = [found for found in farm_plan.violations if found.kind == "out_of_reach"]
    assert len(beyond) == 24
    (told,) = (found for found in farm_plan.told_violations if found.kind == "out_of_reach")
    assert told.message.startswith(
        "a pond is out of reach: alone it breaks what the battery gives above its reserve (24 ponds: "
    )
    assert told.message.endswith("and 19 more)")
    assert not any("more drones" in found.remedy or "fly with" in found.remedy for found in farm_plan.violations)


def test_an_unknown_option_is_told_with_those_there_are(problem: Problem) -> None:
    with pytest.raises(TypeError, match=r"^there is no option 'tempo'; options are: seed, time_limit_s, "):
        pondhop.solve(problem, planner="search", tempo=1)  # type: ignore[call-arg]
