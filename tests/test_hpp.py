"""The binding of HPP; the method itself is tested in the core."""

import numpy as np
import pytest

from pondhop import _core


@pytest.fixture
def problem() -> _core.Problem:
    depot, ponds, _, _ = _core.generate(50, 1)
    return _core.Problem(depot, ponds, 5)


def test_every_pond_is_visited_once(problem: _core.Problem) -> None:
    routes, elapsed_s = _core.hpp(problem, seed=3)
    assert _core.evaluate(problem, routes).is_feasible
    assert len(routes) == 5
    assert elapsed_s > 0.0


def test_the_seed_decides(problem: _core.Problem) -> None:
    assert _core.hpp(problem, seed=3)[0] == _core.hpp(problem, seed=3)[0]
    assert any(_core.hpp(problem, seed=3)[0] != _core.hpp(problem, seed=seed)[0] for seed in range(4, 9))


def test_clusters_belong_to_the_routes(problem: _core.Problem) -> None:
    clusters = _core.hpp_clusters(problem, seed=3)
    assert [route for route, _, _ in clusters] == _core.hpp(problem, seed=3)[0]
    for route, hull, path in clusters:
        assert set(hull) <= set(route)
        assert len(hull) >= 3
        corners = problem.ponds[hull]
        following = np.roll(corners, -1, axis=0)
        assert np.sum(corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]) > 0
        assert path.shape[1] == 2


def test_one_pond_has_a_path_of_one_corner() -> None:
    clusters = _core.hpp_clusters(_core.Problem([0.0, 0.0], np.array([[3.0, 4.0]]), 5))
    assert len(clusters) == 1
    route, hull, path = clusters[0]
    assert (route, hull) == ([0], [0])
    assert path.tolist() == [[3.0, 4.0]]
