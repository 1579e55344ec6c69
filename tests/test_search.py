"""The search from Python: options, progress, start plans, what Ctrl-C does."""

import signal
import threading
import time

import numpy as np
import pytest

import pondhop
from pondhop import _core


def problem(num_ponds: int = 60, num_routes: int = 4, seed: int = 5) -> pondhop.Problem:
    return pondhop.generate(num_ponds, seed=seed)[0].to_problem(num_routes)


@pytest.mark.parametrize("threads", [1, 2])
def test_same_seed_and_iterations_give_the_same_routes(threads: int) -> None:
    first, second = (_core.search(problem(), seed=7, iterations=2000, threads=threads) for _ in range(2))
    assert first[0] == second[0]
    assert first[2] >= 2000


def test_seeds_differ() -> None:
    assert _core.search(problem(), seed=1, iterations=300)[0] != _core.search(problem(), seed=2, iterations=300)[0]


def test_a_longer_search_is_no_worse() -> None:
    task = problem(150)
    short, long = (pondhop.evaluate(task, _core.search(task, iterations=num)[0]) for num in (50, 20_000))
    assert long.max_route_length < short.max_route_length


def test_slack_shortens_the_total_and_keeps_to_its_cap() -> None:
    task = problem()
    tight, slack = (pondhop.evaluate(task, _core.search(task, iterations=20_000, slack=s)[0]) for s in (0.0, 0.05))
    assert slack.total_length < tight.total_length
    assert slack.max_route_length <= tight.max_route_length * 1.05 * (1 + 1e-9)


def test_without_limits_the_least_total_is_a_single_tour() -> None:
    task = problem(30, 3)
    plan = pondhop.evaluate(task, _core.search(task, iterations=20_000, objective="total")[0])
    assert len(plan.routes) == 1
    assert plan.is_feasible


def test_time_is_what_is_balanced() -> None:
    """A pond with a long service has a drone nearly to itself, though it is next to the others."""
    ponds = np.array([[float(x), 1.0] for x in range(8)])
    service_s = np.array([100.0] + [1.0] * 7)
    task = pondhop.Problem([0.0, 0.0], ponds, 2, service_durations_s=service_s, leg_stop_s=1.0)
    plan = pondhop.evaluate(task, _core.search(task, iterations=2000)[0])
    assert sorted(map(len, plan.routes)) == [1, 7]


def test_a_start_is_never_made_worse() -> None:
    task = problem()
    start = _core.search(task, iterations=20_000)[0]
    before = pondhop.evaluate(task, start)
    after = pondhop.evaluate(task, _core.search(task, iterations=100, seed=9, start=start)[0])
    assert after.max_route_length <= before.max_route_length * (1 + 1e-9)


def test_progress_is_told_and_may_stop_the_search() -> None:
    told: list[tuple[float, int, float]] = []

    def progress(longest: float, iterations: int, share: float) -> None:
        told.append((longest, iterations, share))
        if len(told) == 2:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        _core.search(problem(), time_limit_s=60.0, progress=progress)
    assert told[0][0] >= told[1][0]
    assert 0.0 <= told[0][2] < told[1][2] < 1.0


def test_ctrl_c_returns_the_best_so_far() -> None:
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    begin = time.monotonic()
    solution = pondhop.solve(problem(), planner="search", time_limit_s=60.0)
    assert solution.is_interrupted
    assert solution.plan.is_feasible
    assert time.monotonic() - begin < 30.0


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"time_limit_s": 0.0},
        {"time_limit_s": float("nan")},
        {"iterations": 0},
        {"iterations": 10, "threads": 0},
        {"iterations": 10, "slack": -0.1},
        {"iterations": 10, "objective": "mean"},
        {"iterations": 10, "start": [[0, 1]]},
        {"iterations": 10, "start": [[0, 99]]},
    ],
)
def test_options_without_meaning(options: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        _core.search(problem(), **options)  # type: ignore[arg-type]


def test_every_option_fault_is_named_at_once() -> None:
    with pytest.raises(pondhop.InvalidInput) as error:
        pondhop.solve(problem(), threads=0, iterations=0, slack_percent=-1.0, start=[[0, 0]])
    assert {fault.path for fault in error.value.faults} == {"threads", "iterations", "slack_percent", "start"}
