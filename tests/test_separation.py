"""How well routes keep apart, through the binding."""

import numpy as np
import pytest

from pondhop import InvalidInput, Problem
from pondhop._core import separation


def test_two_routes_that_share_a_square_and_cross() -> None:
    squares = [[0, 0], [4, 0], [4, 4], [0, 4], [2, 2], [6, 2], [6, 6], [2, 6]]
    problem = Problem([0, -1], np.array(squares, dtype=float), 2)
    measured = separation(problem, [[0, 1, 2, 3], [4, 5, 6, 7]])
    assert measured.overlap == pytest.approx(4 / 32)
    assert (measured.num_crossings, measured.num_depot_leg_crossings) == (1, 3)
    assert repr(measured) == "Separation(overlap=0.125, num_crossings=1, num_depot_leg_crossings=3)"


def test_an_unknown_pond_is_a_clean_error() -> None:
    problem = Problem([0, 0], np.ones((1, 2)), 1)
    with pytest.raises(InvalidInput, match="there is no pond 1"):
        separation(problem, [[0], [1]])


def test_a_way_home_over_the_route_of_another_drone_is_counted_apart() -> None:
    # The second drone comes home across the row that the first one flies.
    ponds = np.array([[-10.0, 10.0], [10.0, 10.0], [0.0, 20.0], [40.0, 20.0]])
    measured = separation(Problem([0, 0], ponds, 2), [[0, 1], [3, 2]])
    assert (measured.num_crossings, measured.num_depot_leg_crossings) == (0, 1)
