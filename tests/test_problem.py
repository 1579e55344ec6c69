"""Problems through the binding: what they take, what they refuse and in which words, and how they are values."""

import copy
import math
import pickle
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

import pondhop
from hand_made import make_farm, two_drones
from pondhop import (
    Energy,
    Fault,
    Fleet,
    InvalidInput,
    LocalFrame,
    Problem,
    Separation,
    Violation,
    evaluate,
    separation,
)
from pondhop._core import leg_durations, leg_lengths

PONDS = [[30, 0], [30, 40], [0, 40]]
ENERGY = Energy(takeoff_j=2000, leg_w=300, leg_stop_w=100, way_home_w=400, way_home_fixed_j=15_000, usable_j=math.inf)


@pytest.fixture
def problem() -> Problem:
    """A rectangle of 30 m x 40 m, and drones that take off and come home in a way of their own."""
    return Problem(
        [0, 0],
        PONDS,
        2,
        service_durations_s=[10, 10, 10],
        speed_m_s=5,
        leg_stop_s=3,
        takeoff_s=9,
        way_home_speed_m_s=10,
        way_home_fixed_s=44,
        service_energies_j=[1000, 1000, 1000],
        energy=ENERGY,
    )


def test_a_hand_computed_plan_with_take_off_way_home_and_energy(problem: Problem) -> None:
    plan = evaluate(problem, [[0, 1], [2]])
    assert plan.is_feasible
    # 9 + 6 + 3, 8 + 3, 50 / 10 + 44 s; 2000 + 1800 + 300, 2400 + 300, 2000 + 15000 J.
    assert [legs.tolist() for legs in plan.leg_lengths_m] == [[30, 40, 50], [40, 40]]
    assert [legs.tolist() for legs in plan.leg_durations_s] == [[18, 11, 49], [20, 48]]
    assert [legs.tolist() for legs in plan.leg_energies_j] == [[4100, 2700, 17_000], [4700, 16_600]]
    assert plan.arrivals_s[0].tolist() == [18, 39]
    assert plan.route_durations_s.tolist() == [98, 78]
    assert plan.route_energies_j.tolist() == [25_800, 22_300]
    assert plan.phase_durations_s.tolist() == [[9, 20, 20, 49], [9, 11, 10, 48]]
    assert plan.phase_energies_j.tolist() == [[2000, 4800, 2000, 17_000], [2000, 2700, 1000, 16_600]]


def test_without_figures_there_is_no_energy_and_every_leg_is_alike() -> None:
    plan = evaluate(Problem([0, 0], PONDS, 1, speed_m_s=5, leg_stop_s=3), [[0, 1, 2]])
    assert plan.leg_durations_s[0].tolist() == [9, 11, 9, 11]
    assert plan.phase_durations_s.tolist() == [[0, 29, 0, 11]]
    assert plan.route_energies_j.tolist() == [0]
    assert plan.phase_energies_j.tolist() == [[0, 0, 0, 0]]


def test_legs_as_matrices(problem: Problem) -> None:
    assert leg_lengths(problem).tolist() == [[0, 30, 50, 40], [30, 0, 40, 50], [50, 40, 0, 30], [40, 50, 30, 0]]
    durations = leg_durations(problem)
    assert durations.tolist() == [[0, 18, 22, 20], [47, 0, 11, 13], [49, 11, 0, 9], [48, 13, 9, 0]]
    plan = evaluate(problem, [[2, 0], [1]])
    for route, legs in zip(plan.routes, plan.leg_durations_s, strict=True):
        nodes = [0, *(pond + 1 for pond in route), 0]
        assert [durations[leg] for leg in pairwise(nodes)] == legs.tolist()


def test_legs_below_a_metre_take_their_time() -> None:
    plan = evaluate(Problem([0, 0], [[0.5, 0.0]], 1, speed_m_s=5, leg_stop_s=3), [[0]])
    assert plan.leg_durations_s[0].tolist() == [3.1, 3.1]


@pytest.mark.parametrize(
    "ponds",
    [
        np.array(PONDS, dtype=np.float32),
        np.array(PONDS, dtype=np.float16),
        np.array(PONDS, dtype=np.longdouble),
        np.array(PONDS, dtype=np.int8),
        np.array(PONDS, dtype=np.uint64),
        np.array(PONDS, dtype=">f8"),
        np.asfortranarray(np.array(PONDS, dtype=float)),
        np.array([[x, -1, y] for x, y in PONDS], dtype=float)[:, ::2],
        np.array(PONDS[::-1], dtype=float)[::-1],
        tuple(map(tuple, PONDS)),
        [np.array(pond) for pond in PONDS],
    ],
)
def test_positions_of_any_real_type(ponds: ArrayLike) -> None:
    made = Problem(np.zeros(2, dtype=np.float32), ponds, np.int16(2))
    assert made == Problem((0.0, 0.0), PONDS, 2)
    assert made.ponds.dtype == np.float64


def test_durations_of_any_real_type() -> None:
    for durations in ([1, 2, 3], np.array([1, 2, 3], dtype=np.float32), np.arange(1, 7)[:3], range(1, 4)):
        made = Problem([0, 0], PONDS, 1, service_durations_s=durations, service_energies_j=durations)
        assert made.service_durations_s.tolist() == made.service_energies_j.tolist() == [1, 2, 3]


Change = dict[str, object]


@pytest.mark.parametrize(
    ("change", "path", "words"),
    [
        ({"depot": [1]}, "depot", "it has shape (1,)"),
        ({"depot": [0, math.nan]}, "depot[1]", "NaN"),
        ({"depot": [1e10, 0]}, "depot[0]", "10000000000"),
        ({"depot": None}, "depot", "type object"),
        ({"ponds": [1, 2]}, "ponds", "it has shape (2,)"),
        ({"ponds": [[1, 2, 3]] * 3}, "ponds", "it has shape (3, 3)"),
        ({"ponds": [[1, 2], [3]]}, "ponds", "no array of numbers"),
        ({"ponds": [["a", "b"]]}, "ponds", "type <U1"),
        ({"ponds": np.ones((3, 2), dtype=complex)}, "ponds", "complex128"),
        ({"ponds": np.ones((3, 2), dtype=bool)}, "ponds", "bool"),
        ({"ponds": []}, "ponds", "no pond"),
        ({"ponds": np.zeros((0, 2))}, "ponds", "no pond"),
        ({"ponds": [[0, 0], [0, math.inf], [0, 0]]}, "ponds[1][1]", "inf"),
        ({"ponds": [[0, 0], [0, 0], [-1e300, 0]]}, "ponds[2][0]", "-1e300"),
        ({"num_drones": 0}, "num_drones", "no drone"),
        ({"num_drones": -1}, "num_drones", "-1"),
        ({"num_drones": 2**64}, "num_drones", "18446744073709551616"),
        ({"num_drones": 10**5000}, "num_drones", "very many digits"),
        ({"num_drones": 2.5}, "num_drones", "2.5"),
        ({"num_drones": True}, "num_drones", "True"),
        ({"num_drones": "5"}, "num_drones", "'5'"),
        ({"service_durations_s": [1, 2]}, "service_durations_s", "shape (2,)"),
        ({"service_durations_s": [1, 2, -3]}, "service_durations_s[2]", "-3"),
        ({"service_durations_s": [1, 1e308, 3]}, "service_durations_s[1]", "1e308"),
        ({"service_energies_j": 5}, "service_energies_j", "shape ()"),
        ({"service_energies_j": [1, 2, 1e300]}, "service_energies_j[2]", "1e300"),
        ({"speed_m_s": 0}, "speed_m_s", "0"),
        ({"speed_m_s": 1e-300}, "speed_m_s", "1e-300"),
        ({"speed_m_s": 10**400}, "speed_m_s", "inf"),
        ({"speed_m_s": "fast"}, "speed_m_s", "'fast'"),
        ({"leg_stop_s": -1}, "leg_stop_s", "-1"),
        ({"takeoff_s": math.inf}, "takeoff_s", "inf"),
        ({"way_home_speed_m_s": 5e-324}, "way_home_speed_m_s", "5e-324"),
        ({"way_home_speed_m_s": None}, "way_home_fixed_s", "no speed of the way home"),
        ({"way_home_fixed_s": 1e308}, "way_home_fixed_s", "1e308"),
        ({"max_length_m": math.nan}, "max_length_m", "NaN"),
        ({"max_duration_s": 0}, "max_duration_s", "0"),
        ({"energy": Energy(takeoff_j=1e300)}, "energy.takeoff_j", "1e300"),
        ({"energy": Energy(leg_w=-1)}, "energy.leg_w", "-1"),
        ({"energy": Energy(leg_stop_w=math.nan)}, "energy.leg_stop_w", "NaN"),
        ({"energy": Energy(way_home_w=math.inf)}, "energy.way_home_w", "inf"),
        ({"energy": Energy(way_home_fixed_j=-1)}, "energy.way_home_fixed_j", "-1"),
        ({"energy": Energy(usable_j=0)}, "energy.usable_j", "0"),
    ],
)
def test_faults_speak_the_words_of_the_api(problem: Problem, change: Change, path: str, words: str) -> None:
    with pytest.raises(InvalidInput) as error:
        problem.replace(**change)  # type: ignore[arg-type]
    faults = [fault for fault in error.value.faults if not (path == "ponds" and fault.path.startswith("service_"))]
    assert [fault.path for fault in faults] == [path]
    assert words in faults[0].message
    assert faults[0].action


def test_every_fault_is_told_at_once() -> None:
    with pytest.raises(InvalidInput) as error:
        Problem([0, math.nan], [[1, 2, 3]], 2.5, speed_m_s="fast", max_length_m=-1)  # type: ignore[arg-type]
    assert [fault.path for fault in error.value.faults] == [
        "ponds",
        "num_drones",
        "speed_m_s",
        "depot[1]",
        "max_length_m",
    ]


def test_no_sum_of_extreme_values_is_infinite() -> None:
    problem = Problem(
        [-1e9, -1e9],
        [[1e9, 1e9]] * 3,
        1,
        service_durations_s=[1e9] * 3,
        speed_m_s=1e-6,
        leg_stop_s=1e9,
        takeoff_s=1e9,
        way_home_speed_m_s=1e-6,
        way_home_fixed_s=1e9,
        service_energies_j=[1e12] * 3,
        energy=Energy(takeoff_j=1e12, leg_w=1e9, leg_stop_w=1e9, way_home_w=1e9, way_home_fixed_j=1e12),
    )
    plan = evaluate(problem, [[0, 1, 2]])
    assert math.isfinite(plan.makespan_s)
    assert np.isfinite(plan.route_energies_j).all()


def test_an_unknown_argument_is_a_type_error(problem: Problem) -> None:
    with pytest.raises(TypeError, match="num_pilots"):
        problem.replace(num_pilots=1)  # type: ignore[call-arg]
    with pytest.raises(InvalidInput, match=r"energy: it is 357 \(give a pondhop.Energy\)"):
        problem.replace(energy=357)  # type: ignore[arg-type]


def test_replacing_keeps_the_rest(problem: Problem) -> None:
    limited = problem.replace(max_duration_s=100, num_drones=3)
    assert (limited.max_duration_s, limited.num_drones) == (100, 3)
    assert limited.replace(max_duration_s=math.inf, num_drones=2) == problem
    assert problem.replace() == problem
    plain = problem.replace(way_home_speed_m_s=None, way_home_fixed_s=0)
    assert (plain.way_home_speed_m_s, plain.way_home_fixed_s) == (None, 0)


def test_ponds_can_be_replaced_by_another_number_of_them(problem: Problem) -> None:
    research = Problem([0, 0], PONDS, 2)
    assert research.replace(ponds=[[1, 2]]) == Problem([0, 0], [[1, 2]], 2)
    with pytest.raises(InvalidInput, match="service_durations_s: it has shape"):
        problem.replace(ponds=[[1, 2]])
    assert problem.replace(ponds=[[1, 2]], service_durations_s=[5], service_energies_j=None).num_ponds == 1


VALUES: list[tuple[str, Callable[[Problem], object]]] = [
    ("problem", lambda problem: problem),
    ("plain problem", lambda _: Problem([0, 0], PONDS, 2)),
    ("energy", lambda problem: problem.energy),
    ("plan", lambda problem: evaluate(problem, [[0, 1], [0]])),
    ("violation", lambda problem: evaluate(problem, [[0, 1], [0]]).violations[0]),
    ("separation", lambda problem: separation(problem, [[0], [1, 2]])),
    ("frame", lambda _: LocalFrame(-90.9, 33.4)),
    ("farm", lambda _: make_farm()),
    ("fleet", lambda _: Fleet(3, battery_wh=200.0)),
    ("planner", lambda _: pondhop.PLANNERS["hpp"]),
    ("fault", lambda _: Fault("here", "it is wrong", "mend it")),
]


@pytest.mark.parametrize("make", [value[1] for value in VALUES], ids=[value[0] for value in VALUES])
def test_values_are_pickled_and_compared(problem: Problem, make: Callable[[Problem], object]) -> None:
    value = make(problem)
    pickled = [pickle.loads(pickle.dumps(value, protocol)) for protocol in range(pickle.HIGHEST_PROTOCOL + 1)]
    for same in (make(problem), *pickled, copy.copy(value), copy.deepcopy(value)):
        assert same == value
        assert hash(same) == hash(value)
        assert repr(same) == repr(value)
    assert value != "something else"


def test_a_plan_of_a_farm_is_pickled_with_every_protocol() -> None:
    farm_plan = two_drones()
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(farm_plan, protocol)) == farm_plan


MASKED = np.ma.masked_invalid([[1.0, 2.0], [np.nan, 3.0], [4.0, 5.0]])


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("ponds", {"ponds": MASKED}),
        ("ponds", {"ponds": list(MASKED)}),
        ("depot", {"depot": MASKED[1]}),
        ("depot", {"depot": [np.ma.masked, 0.0]}),
        ("service_durations_s", {"service_durations_s": MASKED[:, 0]}),
        ("service_energies_j", {"service_energies_j": MASKED[:, 0]}),
        ("layers", {"layers": np.ma.masked_less(np.ones((2, 4)), 2.0)}),
        ("speed_m_s", {"speed_m_s": np.ma.masked}),
        ("way_home_speed_m_s", {"way_home_speed_m_s": MASKED[1, 0]}),
    ],
)
def test_masked_values_are_refused_by_name(name: str, arguments: dict[str, Any]) -> None:
    with pytest.raises(InvalidInput, match="masked") as error:
        Problem(**{"depot": [0, 0], "ponds": PONDS, "num_drones": 2, **arguments})
    assert [fault.path for fault in error.value.faults] == [name]


def test_masked_routes_and_places_are_refused_by_name(problem: Problem) -> None:
    with pytest.raises(InvalidInput, match=r"routes\[0\]\[1\]: there is no pond masked"):
        evaluate(problem, [np.ma.masked_equal([0, 1, 2], 1)])  # type: ignore[list-item]
    with pytest.raises(InvalidInput, match="lonlat_deg: some of its values are masked"):
        LocalFrame(-90.9, 33.4).to_local(MASKED)
    # Without anything below its mask such an array is like any other.
    assert Problem([0, 0], np.ma.asarray(PONDS), 2) == Problem([0, 0], PONDS, 2)


def test_energy_with_something_changed() -> None:
    assert ENERGY.replace() == ENERGY
    assert ENERGY.replace(usable_j=1.0).usable_j == 1.0
    with pytest.raises(InvalidInput, match="takeoff_j"):
        ENERGY.replace(takeoff_j="much")  # type: ignore[arg-type]


def test_what_differs_is_not_equal(problem: Problem) -> None:
    assert problem != problem.replace(takeoff_s=8)
    assert problem != problem.replace(service_energies_j=None)
    assert evaluate(problem, [[0, 1], [2]]) != evaluate(problem, [[1, 0], [2]])
    assert evaluate(problem, [[0, 1], [2]]) != evaluate(problem.replace(takeoff_s=8), [[0, 1], [2]])
    assert Separation(0.5, 1, 2) != Separation(0.5, 2, 1)


def test_zeros_of_both_signs_are_one_value() -> None:
    one, other = Problem([0.0, 0.0], PONDS, 2), Problem([-0.0, 0.0], PONDS, 2)
    assert one == other
    assert hash(one) == hash(other)


def test_representations(problem: Problem) -> None:
    assert repr(Problem([0, 0], PONDS, 2)) == "Problem(num_ponds=3, num_drones=2)"
    assert repr(problem.replace(energy=None)) == (
        "Problem(num_ponds=3, num_drones=2, speed_m_s=5.0, leg_stop_s=3.0, takeoff_s=9.0, way_home_speed_m_s=10.0, "
        "way_home_fixed_s=44.0)"
    )
    assert eval(repr(ENERGY), {"Energy": Energy, "inf": math.inf}) == ENERGY
    assert repr(evaluate(problem, [[0, 1, 2]])) == (
        "Plan(num_routes=1, max_route_length=140.0, total_length=140.0, makespan_s=116.0, is_feasible=True)"
    )
    assert eval(repr(Separation(0.25, 1, 2)), {"Separation": Separation}) == Separation(0.25, 1, 2)


def test_every_violation_is_a_value(problem: Problem) -> None:
    limited = problem.replace(
        num_drones=1, max_length_m=100, max_duration_s=90, energy=Energy(takeoff_j=2000, usable_j=3000)
    )
    violations = evaluate(limited, [[0, 1], [0]]).violations
    assert violations == [
        Violation("repeated", pond=0, value=2, limit=1),
        Violation("unserved", pond=2),
        Violation("too_many_routes", value=2, limit=1),
        Violation("too_long", route=0, value=120, limit=100),
        Violation("too_slow", route=0, value=98, limit=90),
        Violation("too_much_energy", route=0, value=4000, limit=3000),
    ]
    assert [str(violation) for violation in violations] == [
        "pond 0 is visited 2 times",
        "pond 2 is not visited",
        "2 routes for 1 drones",
        "route 0 is 120 long, the limit is 100",
        "route 0 takes 98 s, the limit is 90 s",
        "route 0 takes 4000 J, a drone may use 3000 J",
    ]
    first = violations[0]
    assert (first.kind, first.pond, first.route, first.value, first.limit) == ("repeated", 0, None, 2, 1)
    assert repr(violations[3]) == "Violation('too_long', route=0, value=120.0, limit=100.0)"
    assert [eval(repr(violation), {"Violation": Violation}) for violation in violations] == violations
    assert pickle.loads(pickle.dumps(violations)) == violations
    assert len({*violations, *violations}) == len(violations)


def test_one_violation_is_enough_to_be_infeasible(problem: Problem) -> None:
    for limits, routes in (
        ({"max_length_m": 119.0}, [[0, 1], [2]]),
        ({"max_duration_s": 97.0}, [[0, 1], [2]]),
        ({"num_drones": 1}, [[0, 1], [2]]),
        ({}, [[0, 1]]),
        ({"energy": Energy(takeoff_j=2000, usable_j=4000 - 1)}, [[0, 1], [2]]),
    ):
        plan = evaluate(problem.replace(**limits), routes)
        assert len(plan.violations) == 1
        assert not plan.is_feasible


@pytest.mark.parametrize(
    "fields",
    [
        ("late",),
        ("unserved",),
        ("unserved", 1, 2),
        ("too_long", 1, None, 2.0, 1.0),
        ("too_slow", None, 0, 1.0),
        ("repeated", 0, None, 2.0, 3.0),
    ],
)
def test_violations_that_there_are_not(fields: tuple[object, ...]) -> None:
    with pytest.raises(InvalidInput, match="violation"):
        Violation(*fields)  # type: ignore[arg-type]


def test_an_error_can_be_pickled() -> None:
    with pytest.raises(InvalidInput) as error:
        Problem([0, 0], [], 0)
    copied = pickle.loads(pickle.dumps(error.value))
    assert copied.faults == error.value.faults
    assert str(copied) == str(error.value)


def test_an_index_out_of_range_names_the_pond(problem: Problem) -> None:
    for judge in (evaluate, separation):
        with pytest.raises(InvalidInput) as error:
            judge(problem, [[0], [1, 3]])
        assert [(fault.path, fault.message) for fault in error.value.faults] == [("routes[1][1]", "there is no pond 3")]


@pytest.mark.parametrize(
    ("routes", "paths"),
    [
        ([[0], [1, -1]], ["routes[1][1]"]),
        ([[2**64, 0], [1.5]], ["routes[0][0]", "routes[1][0]"]),
        ([["a"], None], ["routes[0][0]", "routes[1]"]),
        (None, ["routes"]),
        (5, ["routes"]),
        ([0, 1, 2], ["routes[0]", "routes[1]", "routes[2]"]),
    ],
)
def test_routes_that_are_none_are_faults(problem: Problem, routes: object, paths: list[str]) -> None:
    for judge in (evaluate, separation):
        with pytest.raises(InvalidInput) as error:
            judge(problem, routes)  # type: ignore[arg-type]
        assert [fault.path for fault in error.value.faults] == paths


def test_routes_of_any_sequences(problem: Problem) -> None:
    expected = evaluate(problem, [[0, 1], [2]])
    for routes in (((0, 1), (2,)), [np.array([0, 1]), np.array([2], dtype=np.uint8)], iter([iter([0, 1]), [2]])):
        assert evaluate(problem, routes) == expected  # type: ignore[arg-type]
