"""The public functions with values that they do not take: each is refused in our words, by its name."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import fields
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pondhop
from hand_made import make_farm, two_drones
from pondhop import Fleet, InvalidInput, _core, instances, missions, outputs
from pondhop.arguments import shown
from pondhop.files.plan_json import write_plan_json

FARM_PLAN = two_drones()
PROBLEM = FARM_PLAN.solution.problem
FARM = FARM_PLAN.farm
RESEARCH_FARMS = pondhop.generate(20, seed=1)
RESEARCH = RESEARCH_FARMS[0].to_problem(2)


class Bad:
    """A value that cannot even be shown."""

    def __repr__(self) -> str:
        raise RuntimeError("no words for it")


PLANNING: dict[str, object] = {
    "planner": "search",
    "seed": 1,
    "time_limit_s": 0.1,
    "threads": 1,
    "iterations": 10,
    "slack_percent": 0.0,
    "objective": "max",
    "start": None,
    "progress": None,
    "has_separate_airspace": False,
    "decoding": "greedy",
}

WRONG: list[Any] = [
    None,
    3,
    -1,
    1.5,
    "x",
    "",
    b"x",
    True,
    math.nan,
    math.inf,
    2**70,
    -(2**70),
    10**5000,
    [],
    [1],
    {},
    (1,),
    (1, 2, 3),
    np.array([1.0, 2.0]),
    np.zeros((30, 30)),
    np.array(1.5),
    np.bool_(True),
    np.ma.masked,
    Bad(),
    [Bad()],
    Fraction(10**400),
    Decimal("1.5"),
    ("1", "2"),
    "two\nlines",
    object(),
    lambda: 0,
    complex(1, 2),
    Path("nope/x"),
    "a\0b",
    [["a"]],
    {1},
    RESEARCH_FARMS[0],
    FARM_PLAN,
    Fleet(2),
    PROBLEM,
]

FUNCTIONS: dict[str, tuple[Callable[..., object], dict[str, object]]] = {
    "Problem": (
        pondhop.Problem,
        {
            "depot": [0, 0],
            "ponds": [[1, 1], [2, 2]],
            "num_drones": 2,
            "service_durations_s": [1, 1],
            "speed_m_s": 1.0,
            "leg_stop_s": 0.0,
            "max_length_m": 1e3,
            "max_duration_s": 1e3,
            "takeoff_s": 1.0,
            "way_home_speed_m_s": 1.0,
            "way_home_fixed_s": 1.0,
            "service_energies_j": [1, 1],
            "energy": pondhop.Energy(),
            "layers": None,
        },
    ),
    "Energy": (pondhop.Energy, {"takeoff_j": 1.0, "leg_w": 1.0, "usable_j": 1.0}),
    "LocalFrame": (pondhop.LocalFrame, {"longitude_deg": 1.0, "latitude_deg": 1.0}),
    "LocalFrame.to_local": (pondhop.LocalFrame(1, 1).to_local, {"lonlat_deg": [[1, 1]]}),
    "LocalFrame.to_geographic": (pondhop.LocalFrame(1, 1).to_geographic, {"local_m": [[1, 1]]}),
    "Separation": (pondhop.Separation, {"overlap": 0.1, "num_crossings": 1, "num_depot_leg_crossings": 2}),
    "Violation": (pondhop.Violation, {"kind": "too_long", "route": 0, "value": 1.0, "limit": 1.0}),
    "evaluate": (pondhop.evaluate, {"problem": PROBLEM, "routes": [[0]]}),
    "separation": (pondhop.separation, {"problem": PROBLEM, "routes": [[0]]}),
    "lower_bound": (pondhop.lower_bound, {"problem": PROBLEM}),
    "lower_bound_of_makespan": (pondhop.lower_bound_of_makespan, {"problem": PROBLEM}),
    "generate": (pondhop.generate, {"num_ponds": 5, "num_farms": 1, "seed": 1, "variant": "paper"}),
    "plan": (pondhop.plan, {"farm": FARM, "fleet": Fleet(2), **PLANNING}),
    "solve": (pondhop.solve, {"problem": PROBLEM, **PLANNING}),
    "read_farm": (pondhop.read_farm, {"path": "farm.geojson", "depot": None, "layers": (), "accept": ()}),
    "write_farm": (pondhop.write_farm, {"path": "written.geojson", "farm": FARM}),
    "generate_farm": (
        pondhop.generate_farm,
        {"num_ponds": 5, "at": (-90.0, 33.0), "seed": 1, "missing_share": 0.1, "irregular": False},
    ),
    "Farm.to_problem": (FARM.to_problem, {"fleet": Fleet(2), "are_layers_stacked": False}),
    "read_farms": (pondhop.read_farms, {"path": "farms.json"}),
    "read_tsplib": (instances.read_tsplib, {"path": "farms.tsp"}),
    "read_fleet": (pondhop.read_fleet, {"path": "fleet.toml"}),
    "read_plan_json": (pondhop.read_plan_json, {"path": "plan.json"}),
    "write_farms": (pondhop.write_farms, {"path": "written.json", "farms": RESEARCH_FARMS}),
    "write_missions": (pondhop.write_missions, {"folder": "missions", "farm_plan": FARM_PLAN, "units": "us"}),
    "write_plan_geojson": (pondhop.write_plan_geojson, {"path": "plan.geojson", "farm_plan": FARM_PLAN}),
    "write_plan_json": (pondhop.write_plan_json, {"path": "written.json", "farm_plan": FARM_PLAN}),
    "write_outputs": (
        lambda **given: outputs.write_outputs(**given, has_figure=False),
        {"folder": "out", "farm_plan": FARM_PLAN, "units": "us"},
    ),
    "ResearchFarm": (
        pondhop.ResearchFarm,
        {"depot": np.zeros(2), "ponds": np.ones((2, 2)), "boundary": None, "spacing": None},
    ),
    "ResearchFarm.to_problem": (RESEARCH_FARMS[0].to_problem, {"num_routes": 2}),
    "FarmPlan": (
        pondhop.FarmPlan,
        {"farm": FARM, "fleet": Fleet(2), "solution": FARM_PLAN.solution, "obstacles": (), "are_layers_stacked": False},
    ),
    "FarmPlan.violations_told_in": (FARM_PLAN.violations_told_in, {"units": "us"}),
    "FarmPlan.notes_told_in": (FARM_PLAN.notes_told_in, {"units": "us"}),
    "Solution": (
        pondhop.Solution,
        {"problem": PROBLEM, "plan": FARM_PLAN.solution.plan, "planner": "by hand", "seed": 1, "elapsed_s": 0.0},
    ),
    "Fleet": (Fleet, {item.name: getattr(Fleet(2), item.name) for item in fields(Fleet)}),
    "Fleet.dwell_at": (Fleet(2).dwell_at, {"service_s": 30.0}),
    "Fleet.service_at": (Fleet(2).service_at, {"service_s": 30.0}),
    "Fleet.num_flying": (Fleet(2).num_flying, {"num_ponds": 3}),
    "Fleet.layers": (Fleet(2).layers, {"num_ponds": 3, "are_stacked": False}),
    "Fleet.layer_costs": (Fleet(2).layer_costs, {"num_ponds": 3, "are_stacked": False}),
    "Fleet.service_energy_j": (Fleet(2).service_energy_j, {"service_s": 3.0}),
    "missions.obstacles": (missions.obstacles, {"farm_plan": FARM_PLAN}),
    "missions.judged": (missions.judged, {"farm_plan": FARM_PLAN, "units": "us"}),
    "hpp": (_core.hpp, {"problem": PROBLEM, "seed": 1}),
    "hpp_clusters": (_core.hpp_clusters, {"problem": PROBLEM, "seed": 1}),
    "territory": (
        lambda **given: _core.territory(**given),
        {"problem": RESEARCH, "seed": 1, "time_limit_s": 1.0, "iterations": 5, "progress": None},
    ),
    "search": (
        lambda **given: _core.search(**({"iterations": 5} | given)),
        {
            "problem": RESEARCH,
            "seed": 1,
            "time_limit_s": 0.01,
            "threads": 1,
            "slack": 0.0,
            "objective": "max",
            "start": None,
            "progress": None,
        },
    ),
    "search with iterations": (lambda **given: _core.search(RESEARCH, time_limit_s=0.01, **given), {"iterations": 5}),
    "_core.generate": (_core.generate, {"num_ponds": 5, "seed": 1, "variant": "paper"}),
    "leg_lengths": (_core.leg_lengths, {"problem": PROBLEM}),
}


def assert_wrong_values_are_told(function: Callable[..., object], good: dict[str, object]) -> None:
    """No value in the place of any argument leads to anything but a result or a fault in our words."""
    function(**good)
    told: list[str] = []
    files: list[str] = []
    for name in good:
        for wrong in WRONG:
            try:
                function(**(good | {name: wrong}))
            except InvalidInput as error:
                told += [fault.message for fault in error.faults]
            except OSError as error:
                # A name of no file that can be read or written is told by its name.
                files.append(str(error.filename))
    # Nobody reads numbers of some thousand digits.
    assert max(map(len, told + files)) < 400
    assert "\n" not in "".join(told)


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_plan_json("plan.json", FARM_PLAN)
    pondhop.write_farm("farm.geojson", FARM)
    instances.write_farms("farms.json", RESEARCH_FARMS)
    Path("fleet.toml").write_text("num_drones = 3")
    Path("farms.tsp").write_text(
        "TYPE: TSP\nDIMENSION: 2\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 0 3\nEOF\n"
    )


@pytest.mark.usefixtures("files")
@pytest.mark.parametrize("name", FUNCTIONS)
def test_no_wrong_value_leads_into_the_depths(name: str) -> None:
    assert_wrong_values_are_told(*FUNCTIONS[name])


@pytest.mark.usefixtures("files")
@pytest.mark.parametrize("name", ["plot_plan", "plot_solution", "plot_clusters", "save_figure", "figure_bytes"])
def test_no_wrong_value_leads_into_the_depths_of_matplotlib(name: str) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install matplotlib")
    from pondhop import plot

    figures: dict[str, dict[str, object]] = {
        "plot_plan": {"farm_plan": FARM_PLAN, "ax": None, "theme": "dark", "units": "us"},
        "plot_solution": {"problem": RESEARCH, "routes": [[0, 1]], "boundary": None, "ax": None, "theme": "dark"},
        "plot_clusters": {
            "problem": RESEARCH,
            "clusters": _core.hpp_clusters(RESEARCH),
            "boundary": None,
            "ax": None,
            "theme": "dark",
        },
        "save_figure": {"ax": plot.plot_plan(FARM_PLAN), "path": "plan.png"},
        "figure_bytes": {"ax": plot.plot_plan(FARM_PLAN), "kind": "png"},
    }
    assert_wrong_values_are_told(getattr(plot, name), figures[name])


@pytest.mark.parametrize(
    ("call", "fault"),
    [
        (lambda: pondhop.plan(FARM, 3), "fleet: it is 3 (give a pondhop.Fleet"),  # type: ignore[arg-type]
        (lambda: pondhop.plan("x.geojson", Fleet(2)), "farm: it is 'x.geojson' (give a pondhop.Farm"),  # type: ignore[arg-type]
        (lambda: pondhop.solve(PROBLEM, seed=1.5), "seed: it is 1.5 (give a whole number from 0"),  # type: ignore[arg-type]
        (lambda: pondhop.solve(PROBLEM, seed=2**64), "seed: it is 18446744073709551616 (give a whole"),
        (lambda: pondhop.solve(PROBLEM, seed=-1), "seed: it is -1 (give a whole number from 0"),
        (lambda: pondhop.solve(PROBLEM, planner=3), "planner: it is 3 (give the name of a planner"),  # type: ignore[arg-type]
        (lambda: pondhop.solve(PROBLEM, planner=list), "planner: list does not take problem, seed"),  # type: ignore[arg-type]
        (lambda: pondhop.generate_farm(5, at=(1,)), "at: it is (1,) (give longitude -180..180, then latitude"),  # type: ignore[arg-type]
        (lambda: pondhop.solve(3), "problem: it is 3 (give a pondhop.Problem"),  # type: ignore[arg-type]
        (lambda: pondhop.LocalFrame(math.nan, 0.0), "longitude_deg: it is NaN (give degrees of -360 to 360"),
        (lambda: pondhop.LocalFrame(0.0, "x"), "latitude_deg: it is 'x' (give a real number"),  # type: ignore[arg-type]
        (lambda: pondhop.LocalFrame(0.0, 91.0), "latitude_deg: it is 91 (give degrees of -90 to 90"),
        (lambda: _core.hpp(PROBLEM, seed=2**64), "seed: it is 18446744073709551616 (give a whole"),
        (lambda: _core.hpp_clusters(PROBLEM, seed=-1), "seed: it is -1 (give a whole number from 0"),
        (lambda: pondhop.write_plan_json(3, FARM_PLAN), "path: it is 3 (give the name of a file"),  # type: ignore[arg-type]
        (lambda: pondhop.write_missions("x", None), "farm_plan: it is None (give a plan of a farm"),  # type: ignore[arg-type]
        (lambda: pondhop.write_farms("x", [FARM]), "farms[0]: it is Farm(name="),  # type: ignore[list-item]
        (lambda: Fleet(2, assumptions=("speed",)), "assumptions[0]: it is 'speed' (choose one of: num_drones"),
    ],
)
def test_a_wrong_value_is_told_with_the_name_of_its_argument(call: Callable[[], object], fault: str) -> None:
    with pytest.raises(InvalidInput) as error:
        call()
    assert str(error.value).startswith(fault)


def faults_of(call: Callable[..., object], **given: object) -> list[str]:
    try:
        call(**given)
    except InvalidInput as error:
        return [str(fault) for fault in error.faults]
    return []


@pytest.mark.parametrize("function", [_core.hpp, _core.hpp_clusters, _core.territory, _core.search])
@pytest.mark.parametrize("name", ["problem", "seed"])
def test_python_and_the_core_say_the_same_of_a_wrong_value(name: str, function: Callable[..., object]) -> None:
    effort = {"iterations": 5} if function is _core.search else {}
    for wrong in WRONG:
        given = {"problem": RESEARCH, "seed": 1, name: wrong}
        told = faults_of(pondhop.solve, **given, iterations=5)
        assert faults_of(function, **given, **effort) == told, shown(wrong)


def test_python_and_the_core_take_the_same_for_numbers() -> None:
    for wrong in WRONG:
        by_core = faults_of(pondhop.Energy, takeoff_j=wrong)
        told = faults_of(Fleet(2).service_energy_j, service_s=wrong)
        # What is a number and out of range is told with the range, which differs.
        if any("give a real number" in fault for fault in by_core):
            assert [fault.partition(" (")[0].partition(": ")[2] for fault in by_core] == [
                fault.partition(" (")[0].partition(": ")[2] for fault in told
            ]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (Bad(), "a Bad"),
        ([Bad()], "a list"),
        (np.zeros((30, 30)), "an ndarray"),
        (np.ma.masked, "masked"),
        (object(), "an object"),
        (2**200, "a number of very many digits"),
        ([10**5000], "a list"),
        ("x" * 50, "'" + "x" * 36 + "..."),
        ([np.eye(2)], "[array([[1., 0.], [0., 1.]])]"),
        (len, "a builtin_function_or_method"),
    ],
    ids=["bad", "list of bad", "array", "masked", "object", "digits", "list of digits", "long", "lines", "function"],
)
def test_a_value_is_shown_on_one_line(value: object, text: str) -> None:
    assert shown(value) == text
    with pytest.raises(InvalidInput, match=re.escape(f"num_drones: it is {text} (give a whole number from 1")):
        Fleet(value)  # type: ignore[arg-type]


@pytest.mark.parametrize("wrong", [True, np.bool_(True), np.array(1.5), "1.5"])
def test_what_is_no_number_is_no_speed(wrong: Any) -> None:
    with pytest.raises(InvalidInput, match=r"speed_m_s: it is .* \(give a real number"):
        pondhop.Problem([0, 0], [[1, 1]], 1, speed_m_s=wrong)


@pytest.mark.parametrize("wrong", [("1", "2"), (1 + 2j, 3), (True, False), [np.ma.masked, 1.0], Fraction(10**400)])
def test_what_is_no_number_is_no_position(wrong: Any) -> None:
    with pytest.raises(InvalidInput, match=r"at: it is .* \(give longitude"):
        pondhop.generate_farm(5, at=wrong)


def test_every_wrong_argument_of_the_search_is_told_at_once() -> None:
    told = faults_of(
        _core.search,
        problem=RESEARCH,
        seed=-1,
        time_limit_s=0,
        iterations="x",
        threads=0,
        slack=math.nan,
        objective=3,
        progress=3,
    )
    assert [fault.partition(" (")[0] for fault in told] == [
        "seed: it is -1",
        "time_limit_s: it is 0",
        "iterations: it is 'x'",
        "threads: it is 0",
        "slack: it is NaN",
        "objective: it is 3",
        "progress: it is 3",
    ]


def test_every_wrong_argument_is_told_at_once() -> None:
    with pytest.raises(InvalidInput) as error:
        pondhop.plan(make_farm, "fleet")  # type: ignore[arg-type]
    assert [fault.path for fault in error.value.faults] == ["farm", "fleet"]


def test_numbers_of_numpy_are_numbers() -> None:
    solution = pondhop.solve(PROBLEM, seed=np.int64(3), iterations=np.int32(10), time_limit_s=np.float32(5))  # type: ignore[arg-type]
    assert type(solution.seed) is int
    fleet = Fleet(np.int64(2), speed_m_s=Fraction(5, 2), leg_stop_s=np.float32(0.1))  # type: ignore[arg-type]
    assert (fleet.num_drones, fleet.speed_m_s, fleet.leg_stop_s) == (2, 2.5, 0.1)
    assert pondhop.LocalFrame(np.float32(1.5), 2).origin_deg == (1.5, 2.0)  # type: ignore[arg-type]
