"""Numbers in words: hand-computed."""

import re
from pathlib import Path

import pytest

from hand_made import DEPOT, make_farm, make_plan, square
from pondhop import missions
from pondhop.cli.printed import print_farm_plan, print_violations
from pondhop.farm.model import Pond
from pondhop.fleet import Fleet
from pondhop.outputs import write_outputs
from pondhop.solution import FarmPlan
from pondhop.units import (
    clock_text,
    counted,
    duration_text,
    energy_text,
    gap_text,
    height_text,
    length_text,
    speed_text,
)


@pytest.mark.parametrize(
    ("length_m", "metric", "us"),
    [(0.0, "0 m", "0 ft"), (850.4, "850 m", "0.53 mi"), (999.4, "999 m", "0.62 mi"), (1434.0, "1.43 km", "0.89 mi")],
)
def test_lengths(length_m: float, metric: str, us: str) -> None:
    assert length_text(length_m) == metric
    assert length_text(length_m, "us") == us


def test_heights_and_speeds() -> None:
    assert (height_text(7.0), height_text(7.0, "us")) == ("7 m", "23 ft")
    assert (gap_text(2.5), gap_text(2.5, "us")) == ("2.5 m", "8.2 ft")
    assert (speed_text(5.0), speed_text(5.0, "us")) == ("5 m/s", "11.2 mph")


@pytest.mark.parametrize(
    ("duration_s", "words", "clock"),
    [
        (0.0, "0 min 00 s", "0:00"),
        (59.6, "1 min 00 s", "1:00"),
        (350.0, "5 min 50 s", "5:50"),
        (3599.6, "1 h 00 min", "1:00:00"),
        (3950.0, "1 h 06 min", "1:05:50"),
    ],
)
def test_durations(duration_s: float, words: str, clock: str) -> None:
    assert duration_text(duration_s) == words
    assert clock_text(duration_s) == clock


def test_energies_and_numbers_of_things() -> None:
    assert energy_text(88_200.0) == "24.5 Wh"
    assert energy_text(442_440.0) == "123 Wh"
    assert [counted(1, "route"), counted(2, "route"), counted(0, "pond"), counted(1200, "pond")] == [
        "1 route",
        "2 routes",
        "0 ponds",
        "1,200 ponds",
    ]


METRIC = re.compile(r"\d ?(m|km|m/s)\b")
"""A length or speed in metric units; "min" and "(m)", the unit of a parameter, are none."""


def broken_plans() -> list[FarmPlan]:
    """Plans that break every rule whose words hold a length: limit, fence, zone, height layers, distance, height."""
    long = make_plan(make_farm(), Fleet(1, max_route_length_m=300.0), [[0, 1, 2, 3, 4]])
    zone = make_plan(make_farm(no_fly=((square(-89.0015, 37.001, 0.0002),),)), Fleet(1), [[0, 1, 2, 3, 4]])
    fence = make_plan(make_farm(fences=((square(*DEPOT, 0.0011),),)), Fleet(1, fence_margin_m=12.0), [[0, 1, 2, 3, 4]])
    near = make_plan(make_farm(), Fleet(2, return_height_m=8.0, takeoff_interval_s=600.0), [[1], [0]])
    far_ponds = (Pond("far", (-88.8, 37.1), (square(-88.8, 37.1, 0.0004),)),)
    far = make_plan(make_farm(ponds=far_ponds, fences=()), Fleet(1), [[0]])
    fast = make_plan(make_farm(), Fleet(1, speed_m_s=20.0), [[0, 1, 2, 3, 4]])
    return [long, zone, fence, near, far, fast]


@pytest.mark.parametrize("farm_plan", broken_plans(), ids=["long", "zone", "fence", "near", "far", "fast"])
def test_people_read_no_metres_where_they_asked_for_feet(
    farm_plan: FarmPlan, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    written = write_outputs(tmp_path / "us", farm_plan, has_figure=False, units="us")
    metric = write_outputs(tmp_path / "metric", farm_plan, has_figure=False)
    assert written.plan_json == metric.plan_json
    told = missions.judged(farm_plan, "us")
    print_farm_plan(told, "us")
    print_violations(told, "us")
    assert not METRIC.search(capsys.readouterr().out)
    assert [fault.path for fault in written.faults] == [fault.path for fault in metric.faults]
    assert not any(METRIC.search(str(fault)) for fault in written.faults)
    for path in (tmp_path / "us" / "missions").glob("*.*"):
        if path.suffix in (".txt", ".param", ".params"):
            assert not METRIC.search(path.read_text()), path.name


def test_violations_are_told_in_feet_and_miles() -> None:
    long, zone, fence, near, far, fast = (missions.judged(plan, "us") for plan in broken_plans())
    assert "max_route_length_m is 984 ft" in long.violations_told_in("us")[0].message
    # The planning knew it in metres; asked again, each rule is told once.
    assert [found.kind for found in missions.judged(missions.judged(zone), "us").violations] == ["crosses_no_fly"]
    assert "by at least 6.6 ft" in zone.violations_told_in("us")[0].message
    assert "by at least 39.4 ft" in fence.violations_told_in("us")[0].message
    assert any("holds 6.18 mi" in found.message for found in far.violations_told_in("us"))
    assert any("22.4 mph" in note for note in fast.notes_told_in("us"))
    assert near.layers.spacing_m == 3.0
