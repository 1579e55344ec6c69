"""Rounds of research files: what is read, what is refused, and what `pondhop solve` makes of them."""

from __future__ import annotations

import json
from itertools import pairwise
from math import floor, hypot
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pondhop import _core
from pondhop.cli import app
from pondhop.errors import InvalidInput
from pondhop.rounds import read_round

SOLOMON = """TINY

VEHICLE
NUMBER     CAPACITY
  2         20

CUSTOMER
CUST NO.  XCOORD.   YCOORD.    DEMAND   READY TIME  DUE DATE   SERVICE   TIME

    0      0         0          0          0       200          0
    1      3         4         10          0       100          5
    2      0        10         10         50        60          5
    3      6         8         10          0       100          5
"""

VRPLIB = """NAME : tiny
TYPE : MTVRPTWR
DIMENSION : 4
EDGE_WEIGHT_TYPE : EUC_2D
VEHICLES : 1
CAPACITY : 10
SERVICE_TIME : 5
NODE_COORD_SECTION
1 0 0
2 3 4
3 0 10
4 6 8
DEMAND_SECTION
1 0
2 10
3 10
4 10
TIME_WINDOW_SECTION
1 0 300
2 0 100
3 50 60
4 0 200
RELEASE_TIME_SECTION
1 0
2 0
3 0
4 70
VEHICLES_RELOAD_DEPOT_SECTION
1 1
DEPOT_SECTION
1
-1
EOF
"""


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text)
    return path


def faults_of(path: Path) -> list[str]:
    with pytest.raises(InvalidInput) as caught:
        read_round(path)
    return [str(fault) for fault in caught.value.faults]


def test_a_file_of_solomon_is_planned(tmp_path: Path) -> None:
    read = read_round(written(tmp_path, "tiny.txt", SOLOMON))
    assert (read.round.num_visits, read.has_trips) == (3, False)
    routes, _, num_steps, is_interrupted = _core.search_round(read.round, iterations=500, objective="total")
    plan = _core.evaluate_round(read.round, routes)
    # A trip takes two: 1 alone (10), 2 and 3 together (10 + 6.32 + 10).
    assert plan.total_length == pytest.approx(30.0 + hypot(6.0, 2.0))
    assert plan.is_feasible
    assert not plan.violations
    assert num_steps >= 500
    assert not is_interrupted


def test_a_drone_flies_several_trips_where_the_file_says_so(tmp_path: Path) -> None:
    read = read_round(written(tmp_path, "tiny.vrp", VRPLIB))
    routes, *_ = _core.search_round(read.round, iterations=500, objective="total")
    plan = _core.evaluate_round(read.round, routes)
    assert read.has_trips
    assert plan.is_feasible
    assert sorted(plan.routes[0]) == [[0], [1], [2]]
    assert plan.trips[0][-1].departure_s >= 70.0
    assert plan.total_length == pytest.approx(50.0)


def test_what_one_trip_cannot_take_is_left_out_and_told(tmp_path: Path) -> None:
    text = VRPLIB.replace("VEHICLES_RELOAD_DEPOT_SECTION\n1 1\n", "")
    read = read_round(written(tmp_path, "tiny.vrp", text))
    routes, *_ = _core.search_round(read.round, iterations=500, objective="total")
    assert len(_core.evaluate_round(read.round, routes).violations) == 2


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("    1      3         4         10", "    1      3         x         10", "line 11: '1 3 x"),
        ("    1      3         4         10          0", "    1      3         4", "no row of Solomon's format"),
        ("  2         20", "  2", "no row of Solomon's format"),
        ("CUSTOMER\n", "", "no row of Solomon's format"),
        ("50        60", "50        40", "windows[0]"),
        ("    3      6         8         10 ", "    3      6         8         30 ", "visits[2].load"),
    ],
)
def test_broken_files_of_solomon_are_refused(tmp_path: Path, old: str, new: str, told: str) -> None:
    assert old in SOLOMON
    faults = faults_of(written(tmp_path, "tiny.txt", SOLOMON.replace(old, new)))
    assert any(told.split()[0] in fault for fault in faults), faults


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("EUC_2D", "GEO", "EDGE_WEIGHT_TYPE is GEO"),
        ("3 0 10\n", "", "DEMAND"),
        ("2 0 100\n3 50 60", "3 50 60", "TIME_WINDOW_SECTION: node 2 is missing"),
        ("CAPACITY : 10", "CAPACITY : ten", "CAPACITY is 'ten'"),
        ("DEPOT_SECTION\n1\n", "DEPOT_SECTION\n2\n", "the depots are 2"),
        ("RELEASE_TIME_SECTION", "PICKUP_SECTION", "PICKUP_SECTION is not supported"),
        ("4 6 8\n", "4 6 8\n4 6 8\n", "NODE_COORD_SECTION has node 4 twice"),
        ("1 0 0\n", "1 0\n", "is no row of NODE_COORD_SECTION"),
    ],
)
def test_broken_files_of_vrplib_are_refused(tmp_path: Path, old: str, new: str, told: str) -> None:
    assert old in VRPLIB
    if told == "DEMAND":
        # A node less is a smaller round; rows of others are not looked at.
        assert read_round(written(tmp_path, "tiny.vrp", VRPLIB.replace(old, new))).round.num_visits == 2
        return
    assert any(told in fault for fault in faults_of(written(tmp_path, "tiny.vrp", VRPLIB.replace(old, new))))


def run(*arguments: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(map(str, arguments)))
    return result.exit_code, result.output


def test_solve_writes_the_plan_of_a_round(tmp_path: Path) -> None:
    path, output = written(tmp_path, "tiny.txt", SOLOMON), tmp_path / "plans.json"
    code, told = run("solve", path, "--objective", "total", "--iterations", 200, "-o", output)
    [record] = json.loads(output.read_text())
    assert (code, told) == (0, "2 trips, 36.3 long in all, the last ends at 65.0, feasible\n")
    assert sorted(visit for route in record["routes"] for visit in route) == [0, 1, 2]
    assert (record["is_feasible"], record["total_length"]) == (True, pytest.approx(30.0 + hypot(6.0, 2.0)))
    trips = written(tmp_path, "tiny.vrp", VRPLIB)
    code, told = run("solve", trips, "--objective", "total", "--iterations", 200)
    assert (code, len(json.loads(told)[0]["routes"][0])) == (0, 3)
    code, _ = run("solve", path, "--objective", "total", "--iterations", 200, "--routes", 1, "--require-feasible")
    assert code == 3


def test_options_that_a_round_knows_nothing_of_are_refused_at_once(tmp_path: Path) -> None:
    path = written(tmp_path, "tiny.txt", SOLOMON)
    result = CliRunner().invoke(app, ["solve", str(path), "--slack", "3", "--threads", "2", "--planner", "hpp"])
    assert isinstance(result.exception, InvalidInput)
    assert [fault.path for fault in result.exception.faults] == ["--slack", "--planner"]


def test_research_farms_still_need_the_number_of_routes(tmp_path: Path) -> None:
    farms = written(tmp_path, "farms.json", '[{"depot": [0, 0], "ponds": [[1, 0]]}]')
    result = CliRunner().invoke(app, ["solve", str(farms)])
    assert isinstance(result.exception, InvalidInput)
    assert result.exception.faults[0].path == "--routes"


BENCH = Path(__file__).resolve().parents[2] / "shared" / "data" / "bench"


def length_by_hand(path: Path, routes: list[list[int]]) -> float:
    """Total length of a file of Solomon's in tenths cut off, from its text alone."""
    rows = [line.split() for line in path.read_text().splitlines()[9:] if line.strip()]
    places = [(float(row[1]), float(row[2])) for row in rows]
    legs = (leg for route in routes for leg in pairwise([0, *(visit + 1 for visit in route), 0]))
    return sum(floor(10 * hypot(places[a][0] - places[b][0], places[a][1] - places[b][1])) / 10 for a, b in legs)


@pytest.mark.skipif(not BENCH.exists(), reason="the public instances lie beside the repository and are not there")
@pytest.mark.parametrize("name", ["C101", "R101", "RC108"])
def test_public_instances_are_near_the_best_known(name: str) -> None:
    path = BENCH / "solomon" / f"{name}.txt"
    best_known = {"C101": 827.3, "R101": 1637.7, "RC108": 1114.2}[name]
    read = read_round(path, rounding="dimacs")
    routes, *_ = _core.search_round(read.round, iterations=30_000, objective="total")
    plan = _core.evaluate_round(read.round, routes)
    assert plan.is_feasible
    assert best_known - 1e-6 <= plan.total_length <= 1.05 * best_known
    assert plan.total_length == pytest.approx(length_by_hand(path, [trip for route in routes for trip in route]))
