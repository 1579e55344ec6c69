"""The baselines: hand-computed cases, an oracle, limits, and what they say where they cannot plan."""

import itertools
import signal
import sys
from collections.abc import Iterator
from types import FrameType

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pondhop
from pondhop import InvalidInput, Problem, baselines
from pondhop.baselines import integers

BASELINES = ("ortools", "ortools-gls", "pyvrp")
THOROUGH = ("ortools-gls", "pyvrp")
ITERATIONS = 300


def plan_of(problem: Problem, planner: str, iterations: int = ITERATIONS) -> pondhop.Plan:
    plan = pondhop.solve(problem, planner=planner, iterations=iterations).plan
    assert sorted(pond for route in plan.routes for pond in route) == list(range(problem.num_ponds))
    assert len(plan.routes) <= problem.num_drones
    return plan


@pytest.mark.parametrize("planner", BASELINES)
def test_two_ponds_north_and_one_east(planner: str) -> None:
    plan = plan_of(Problem((0.0, 0.0), np.array([[0.0, 3.0], [0.0, 6.0], [5.0, 0.0]]), 2), planner)
    assert sorted(plan.route_lengths) == [10.0, 12.0]


@pytest.mark.parametrize("planner", BASELINES)
def test_service_is_balanced_too(planner: str) -> None:
    ponds = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]])
    plan = plan_of(Problem((0.0, 0.0), ponds, 2, service_durations_s=np.array([10.0, 1.0, 1.0])), planner)
    assert plan.makespan_s == pytest.approx(12.0)
    assert [0] in plan.routes


@pytest.mark.parametrize("planner", BASELINES)
@pytest.mark.parametrize("num_drones", [1, 5])
def test_one_pond(planner: str, num_drones: int) -> None:
    assert plan_of(Problem((1.0, 1.0), np.array([[4.0, 5.0]]), num_drones), planner).route_lengths == [10.0]


@pytest.mark.parametrize("planner", BASELINES)
def test_more_drones_than_ponds(planner: str) -> None:
    plan = plan_of(Problem((0.0, 0.0), np.array([[0.0, 1.0], [1.0, 0.0], [-1.0, 0.0]]), 8), planner)
    assert plan.max_route_length == 2.0


@pytest.mark.parametrize("planner", BASELINES)
def test_ponds_in_one_place(planner: str) -> None:
    assert plan_of(Problem((0.0, 0.0), np.full((6, 2), 2.0), 3), planner).max_route_length == pytest.approx(32**0.5)
    assert plan_of(Problem((0.0, 0.0), np.zeros((4, 2)), 2), planner).total_length == 0.0


@pytest.mark.parametrize("planner", BASELINES)
def test_lengths_from_the_smallest_to_the_largest(planner: str) -> None:
    ponds = np.array([[0.0, 0.3], [0.0, 0.6], [0.5, 0.0]])
    for scale in (1.0, 1e3, 1e9) if planner == "ortools" else (1e-9, 1.0, 1e9):
        plan = plan_of(Problem((0.0, 0.0), scale * ponds, 2), planner)
        assert sorted(plan.route_lengths / scale) == pytest.approx([1.0, 1.2])


def least_makespan(problem: Problem) -> float:
    """Try every assignment of ponds to drones in every order."""
    best = float("inf")
    for order in itertools.permutations(range(problem.num_ponds)):
        for cut in range(problem.num_ponds):
            best = min(best, pondhop.evaluate(problem, [order[:cut], order[cut:]]).makespan_s)
    return best


@pytest.mark.parametrize("planner", THOROUGH)
@pytest.mark.parametrize("seed", [1, 2])
def test_small_farms_are_planned_best(planner: str, seed: int) -> None:
    random = np.random.default_rng(seed)
    services_s = random.uniform(0.0, 0.5, 6)
    problem = Problem(random.random(2), random.random((6, 2)), 2, service_durations_s=services_s, leg_stop_s=0.1)
    assert plan_of(problem, planner).makespan_s == pytest.approx(least_makespan(problem), rel=1e-5)


@settings(max_examples=15, deadline=None)
@given(
    places=st.lists(st.tuples(st.integers(-3, 3), st.integers(-3, 3)), min_size=1, max_size=7),
    num_drones=st.integers(1, 4),
    services_s=st.lists(st.floats(0.0, 100.0), min_size=7, max_size=7),
    speed_m_s=st.floats(0.1, 20.0),
)
@pytest.mark.parametrize("planner", BASELINES)
def test_every_pond_is_visited_once(
    planner: str, places: list[tuple[int, int]], num_drones: int, services_s: list[float], speed_m_s: float
) -> None:
    ponds = np.array(places, dtype=float)
    services = np.array(services_s[: len(ponds)])
    problem = Problem((0, 0), ponds, num_drones, service_durations_s=services, speed_m_s=speed_m_s, leg_stop_s=3.0)
    assert plan_of(problem, planner, iterations=20).is_feasible


@pytest.mark.parametrize("planner", BASELINES)
@pytest.mark.parametrize(("max_length_m", "max_duration_s"), [(12.001, np.inf), (np.inf, 12.001)])
def test_a_limit_that_one_plan_keeps(planner: str, max_length_m: float, max_duration_s: float) -> None:
    ponds = np.array([[0.0, 3.0], [0.0, 6.0], [5.0, 0.0]])
    problem = Problem((0.0, 0.0), ponds, 2, max_length_m=max_length_m, max_duration_s=max_duration_s)
    assert plan_of(problem, planner).is_feasible


@pytest.mark.parametrize("planner", BASELINES)
def test_a_limit_of_length_where_time_is_short_elsewhere(planner: str) -> None:
    # Alone with its service pond 0 would be the longest route; but ponds 1 and 2 are too far apart for one drone.
    ponds = np.array([[1.0, 0.0], [-4.0, 0.0], [4.0, 0.0]])
    services_s = np.array([20.0, 0.0, 0.0])
    free = Problem((0.0, 0.0), ponds, 2, service_durations_s=services_s)
    assert plan_of(free, planner).makespan_s == pytest.approx(22.0)
    limited = Problem((0.0, 0.0), ponds, 2, service_durations_s=services_s, max_length_m=15.0)
    plan = plan_of(limited, planner)
    assert plan.is_feasible
    assert plan.makespan_s == pytest.approx(28.0)


@pytest.mark.parametrize("planner", BASELINES)
@pytest.mark.parametrize(("max_length_m", "max_duration_s"), [(11.9, np.inf), (np.inf, 11.9)])
def test_no_plan_is_an_error(planner: str, max_length_m: float, max_duration_s: float) -> None:
    ponds = np.array([[0.0, 3.0], [0.0, 6.0], [5.0, 0.0]])
    problem = Problem((0.0, 0.0), ponds, 2, max_length_m=max_length_m, max_duration_s=max_duration_s)
    with pytest.raises(InvalidInput, match="found no plan that keeps the limits"):
        pondhop.solve(problem, planner=planner, iterations=ITERATIONS)


@pytest.mark.parametrize("planner", BASELINES)
def test_a_time_limit_long_over_leaves_the_first_plan(planner: str) -> None:
    problem = pondhop.generate(100)[0].to_problem(5)
    assert pondhop.solve(problem, planner=planner, time_limit_s=1e-6).plan.is_feasible


@pytest.mark.parametrize("planner", THOROUGH)
def test_without_time_limit_or_iterations_they_end(planner: str) -> None:
    problem = Problem((0.0, 0.0), np.array([[0.0, 1.0], [1.0, 0.0]]), 2)
    assert pondhop.solve(problem, planner=planner).plan.max_route_length == 2.0


def test_another_seed_is_another_search() -> None:
    problem = pondhop.generate(40, seed=4)[0].to_problem(5)
    plans = [pondhop.solve(problem, planner="pyvrp", seed=seed, iterations=3).plan.routes for seed in (1, 2**64 - 1)]
    assert plans[0] != plans[1]


@pytest.mark.parametrize("planner", BASELINES)
def test_too_many_ponds_are_refused(planner: str) -> None:
    problem = Problem((0.0, 0.0), np.zeros((integers.MAX_PONDS + 1, 2)), 5)
    with pytest.raises(InvalidInput, match="takes too much memory") as caught:
        pondhop.solve(problem, planner=planner, iterations=1)
    assert "search" in caught.value.faults[0].action


@pytest.mark.parametrize("planner", BASELINES)
def test_separate_airspace_is_not_promised(planner: str) -> None:
    problem = Problem((0.0, 0.0), np.array([[0.0, 1.0]]), 1)
    with pytest.raises(InvalidInput, match=f"{planner} lets drones share airspace"):
        pondhop.solve(problem, planner=planner, has_separate_airspace=True)


@pytest.mark.parametrize("planner", BASELINES)
def test_a_missing_package_is_named(planner: str, monkeypatch: pytest.MonkeyPatch) -> None:
    package = planner.partition("-")[0]
    for name in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.delitem(sys.modules, f"pondhop.baselines.{package}", raising=False)
    monkeypatch.delattr(baselines, package, raising=False)
    with pytest.raises(InvalidInput) as caught:
        pondhop.solve(Problem((0.0, 0.0), np.array([[0.0, 1.0]]), 1), planner=planner)
    (fault,) = caught.value.faults
    assert (fault.path, fault.message) == ("planner", f"it needs {package}, which is not installed")
    assert f"pip install '{package}>=" in fault.action


@pytest.fixture
def ctrl_c_after_half_a_second() -> Iterator[None]:
    """Press Ctrl-C once half a second of processor time is used, however busy the machine is."""

    def press(_number: int, _frame: FrameType | None) -> None:
        signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGVTALRM, press)
    signal.setitimer(signal.ITIMER_VIRTUAL, 0.5)
    yield
    signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    signal.signal(signal.SIGVTALRM, before)


@pytest.mark.usefixtures("ctrl_c_after_half_a_second")
@pytest.mark.parametrize("planner", BASELINES)
def test_ctrl_c_leaves_the_best_plan_so_far(planner: str) -> None:
    problem = pondhop.generate(100, seed=3)[0].to_problem(5)
    solution = pondhop.solve(problem, planner=planner, time_limit_s=600.0)
    assert solution.is_interrupted
    assert solution.plan.is_feasible
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_legs_hold_stop_and_service() -> None:
    problem = Problem(
        (0.0, 0.0),
        np.array([[3.0, 4.0], [3.0, 4.0], [0.0, 4.0]]),
        1,
        service_durations_s=np.array([10.0, 20.0, 30.0]),
        speed_m_s=0.5,
        leg_stop_s=2.0,
    )
    legs = integers.legs_of(problem)
    assert legs.lengths_m[0].tolist() == [0.0, 5.0, 5.0, 4.0]
    assert legs.costs_s.tolist() == [
        [0.0, 22.0, 32.0, 40.0],
        [12.0, 0.0, 20.0, 38.0],
        [12.0, 10.0, 0.0, 38.0],
        [10.0, 18.0, 28.0, 0.0],
    ]
    route = [2, 0, 1]
    nodes = [0, *(pond + 1 for pond in route), 0]
    cost = sum(legs.costs_s[a, b] for a, b in itertools.pairwise(nodes))
    assert cost == pondhop.evaluate(problem, [route]).makespan_s


def test_the_authors_distances_are_rounded_down_to_thousandths() -> None:
    matrix = integers.truncated(np.array([[0.0, 1.2349], [1.2349, 0.0]]), 2.0, 1000.0, 101)
    assert matrix.legs.tolist() == [[0, 1234], [1234, 0]]
    assert (matrix.units, matrix.limit) == (1000.0, 2000)


def test_units_grow_where_sums_would_overflow() -> None:
    matrix = integers.truncated(np.array([[0.0, 1e18], [1e18, 0.0]]), np.inf, 1000.0, 101)
    assert 0 < matrix.horizon * 101 < 2**63
    assert matrix.limit is None


def test_fine_legs_are_rounded_up_so_that_limits_hold() -> None:
    matrix = integers.fine(np.array([[0.0, 3.0], [1.0, 0.0]]), 4.0)
    assert matrix.legs.tolist() == [[0, 1_000_000], [333_334, 0]]
    assert matrix.limit == 1_333_333
    assert integers.fine(np.zeros((2, 2)), 4.0).limit is None


def test_the_matrix_of_legs_is_what_the_judge_counts() -> None:
    ponds = np.random.default_rng(2).uniform(0, 100, (8, 2))
    problem = Problem(
        [50, -20],
        ponds,
        2,
        service_durations_s=np.arange(8.0),
        speed_m_s=5.0,
        leg_stop_s=2.5,
        takeoff_s=9.0,
        way_home_speed_m_s=10.0,
        way_home_fixed_s=44.0,
    )
    legs = integers.legs_of(problem)
    plan = pondhop.evaluate(problem, [[3, 1, 4, 0], [7, 5, 2, 6]])
    for route, length, duration_s in zip(plan.routes, plan.route_lengths, plan.route_durations_s, strict=True):
        pairs = list(itertools.pairwise([0, *(pond + 1 for pond in route), 0]))
        assert sum(legs.lengths_m[pair] for pair in pairs) == pytest.approx(length)
        assert sum(legs.costs_s[pair] for pair in pairs) == pytest.approx(duration_s)


def test_legs_below_all_normal_numbers_are_one_unit() -> None:
    for leg in (5e-324, 1e-303):
        matrix = integers.fine(np.array([[0.0, leg], [leg, 0.0]]), np.inf)
        assert matrix.legs.tolist() == [[0, 1], [1, 0]]
    assert integers.fine(np.array([[0.0, 1e-301], [1e-301, 0.0]]), np.inf).legs.max() == integers.UNITS_OF_LONGEST_LEG


@pytest.mark.parametrize("planner", ["search", "territory", "hpp", *BASELINES])
@pytest.mark.parametrize("scale", [5e-324, 1e-310, 1e-200, 1e-100])
def test_farms_of_hardly_any_size_are_planned(planner: str, scale: float) -> None:
    ponds = scale * np.array([[1.0, 0.0], [0.0, 2.0], [3.0, 0.0], [0.0, -4.0], [0.0, 0.0]])
    assert plan_of(Problem((0.0, 0.0), ponds, 2), planner).is_feasible
    assert plan_of(Problem((0.0, 0.0), ponds, 2, service_durations_s=ponds[:, 0]), planner).is_feasible
