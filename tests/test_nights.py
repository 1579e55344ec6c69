"""Rounds of a farm: batteries and swaps, wind, windows, ends, priorities, and how many drones it takes."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import pondhop
from hand_made import make_farm
from pondhop import Farm, FarmPlan, Fleet, InvalidInput, Pond, Wind, generate_farm, read_plan_json, write_plan_json
from pondhop.cli.main import app
from pondhop.encounters import encounters_of, encounters_text, tracks_of
from pondhop.fleet import parse_wind, read_fleet
from pondhop.fleet.clock import clock_after, seconds_between, windows_after
from pondhop.nights import Effort, sizes
from pondhop.outputs import write_outputs

FLEET = Fleet(2, speed_m_s=8.0, battery_wh=80.0, swap_s=240.0, start="22:00", end="05:30")


@pytest.fixture(scope="module")
def farm() -> Farm:
    return generate_farm(24, at=(-90.9, 33.4), seed=2)


@pytest.fixture(scope="module")
def night(farm: Farm) -> FarmPlan:
    return pondhop.plan(farm, FLEET, wind=Wind(4.0, 270.0), iterations=3000)


def test_a_night_keeps_battery_swaps_and_end(night: FarmPlan) -> None:
    assert night.is_round
    assert night.is_feasible
    assert not night.left_out
    assert sorted(pond for trip in night.trips for pond in trip.ponds) == list(range(24))
    assert max(trip.number for trip in night.trips) >= 1
    usable_j = FLEET.usable_energy_j
    for trip in night.trips:
        # Wherever the drone is, it can be home with its reserve.
        assert trip.energies_j.sum(axis=1).max() <= usable_j + 1e-6
        assert trip.energy_j == pytest.approx(trip.energies_j[-1].sum())
        assert trip.phases.total_j == pytest.approx(trip.energy_j)
        assert trip.duration_s == pytest.approx(trip.legs[:, 1].sum() + (trip.times_s[:, 2] - trip.times_s[:, 0]).sum())
    for before, after in zip(night.trips, night.trips[1:], strict=False):
        if before.drone == after.drone:
            assert after.departure_s >= before.arrival_s + 240.0 - 1e-6
    assert night.solution.lower_bound_s <= night.all_back_s <= FLEET.span_s


def test_a_trip_in_wind_is_a_hand_computed_one() -> None:
    # One pond 111 m north of the depot; 4 m/s from the north, 8 m/s over ground, 10 through the air.
    farm = Farm("one", (Pond("N", (-89.0, 37.001)),), (-89.0, 37.0))
    fleet = Fleet(1, speed_m_s=8.0, swap_s=60.0)
    plan = pondhop.plan(farm, fleet, wind=Wind(4.0, 0.0), iterations=10)
    (trip,) = plan.trips
    (out_m, out_s, _), (home_m, home_s, _) = trip.legs
    assert out_m == home_m == pytest.approx(111.0, abs=0.2)
    assert out_s == pytest.approx(fleet.takeoff_s + out_m / 6.0 + fleet.stop_s)
    assert home_s == pytest.approx(home_m / fleet.return_speed_m_s + fleet.way_home_fixed_s)
    calm = pondhop.plan(farm, fleet, iterations=10)
    assert calm.trips[0].legs[0, 1] == pytest.approx(fleet.takeoff_s + out_m / 8.0 + fleet.stop_s)


def test_a_night_is_read_as_it_was_written(night: FarmPlan, tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    write_plan_json(path, night)
    content = json.loads(path.read_text())
    assert content["wind"] == {"speed_m_s": 4.0, "from_deg": 270.0}
    assert content["summary"]["num_trips"] == len(night.trips)
    read = read_plan_json(path)
    assert [trip.ponds for trip in read.trips] == [trip.ponds for trip in night.trips]
    again = tmp_path / "again.json"
    write_plan_json(again, read)
    assert again.read_text() == path.read_text()
    # Edited by hand, it is judged anew: numbers that do not follow are told.
    content["routes"][0]["trips"][0]["stops"].reverse()
    path.write_text(json.dumps(content))
    with pytest.raises(InvalidInput, match="routes"):
        read_plan_json(path)


def test_every_trip_has_its_files_and_the_crew_a_list_of_swaps(night: FarmPlan, tmp_path: Path) -> None:
    written = write_outputs(tmp_path / "out", night, has_figure=False)
    assert not written.faults
    missions = tmp_path / "out" / "missions"
    for trip in night.trips:
        plan = json.loads((missions / f"{trip.name}.plan").read_text())
        assert len(plan["mission"]["items"]) >= 2 + 3 * len(trip.ponds)
    text = (missions / "README.txt").read_text()
    num_swaps = len(night.trips) - night.num_drones_flying
    assert text.count("give it battery") == num_swaps
    assert "22:00:00" in text
    assert "a wind of 4 m/s from 270 degrees" in " ".join(text.split())
    # A plan of one route a drone takes the place of the night, missions and all.
    write_outputs(tmp_path / "out", pondhop.plan(night.farm, Fleet(2), iterations=100), has_figure=False)
    assert not list(missions.glob("*trip*"))


def test_the_night_is_drawn(night: FarmPlan) -> None:
    plot = pytest.importorskip("pondhop.plot", reason="matplotlib is not installed: pip install pondhop[plot]")
    pytest.importorskip("matplotlib")
    for theme in ("light", "dark"):
        ax = plot.plot_night(night, theme=theme)
        assert [label.get_text() for label in ax.get_yticklabels()] == ["drone 1", "drone 2"]
        assert len(plot.figure_bytes(ax, "png")) > 10_000
    assert any("wind 4 m/s" in text.get_text() for text in plot.plot_plan(night).texts)


def test_windows_are_kept_and_waits_are_on_the_ground(farm: Farm) -> None:
    ponds = list(farm.ponds)
    for index in (3, 9, 15):
        ponds[index] = replace(ponds[index], time_windows=(("23:00", "23:10"), ("02:00", "02:30")))
    plan = pondhop.plan(replace(farm, ponds=tuple(ponds)), FLEET, iterations=3000)
    assert plan.is_feasible
    for trip in plan.trips:
        for pond, (_, start_s, _) in zip(trip.ponds, trip.times_s, strict=True):
            if pond in (3, 9, 15):
                assert 3600.0 <= start_s <= 4200.0
        assert trip.waits_s == pytest.approx(0.0, abs=1.0)


def test_the_most_important_ponds_come_first_and_the_rest_is_told_with_what_helps(farm: Farm) -> None:
    ponds = tuple(replace(pond, priority=5.0 if index % 4 == 0 else 1.0) for index, pond in enumerate(farm.ponds))
    fleet = replace(FLEET, num_drones=1, end="22:25")
    plan = pondhop.plan(replace(farm, ponds=ponds), fleet, iterations=6000)
    assert plan.left_out
    assert all(index % 4 for index in plan.left_out)
    assert {violation.kind for violation in plan.violations} == {"unserved"}
    reasons = {unserved.reason for unserved in plan.unserved}
    assert reasons == {"the fleet has no time left for it before the end at 22:25"}
    (remedies,) = {unserved.remedies for unserved in plan.unserved}
    later = next(remedy.removeprefix("end at ") for remedy in remedies if remedy.startswith("end at"))
    assert not pondhop.plan(plan.farm, replace(fleet, end=later), iterations=10_000).left_out
    more = next(remedy for remedy in remedies if remedy.startswith("fly with"))
    assert not pondhop.plan(plan.farm, replace(fleet, num_drones=int(more.split()[2])), iterations=10_000).left_out


def test_a_pond_out_of_reach_says_what_battery_it_needs(farm: Farm) -> None:
    far = Pond("far", (farm.depot[0] + 0.05, farm.depot[1]))
    plan = pondhop.plan(replace(farm, ponds=(*farm.ponds, far)), FLEET, iterations=2000)
    (unserved,) = plan.unserved
    assert unserved.pond == 24
    assert "alone it takes" in unserved.reason
    battery = next(remedy for remedy in unserved.remedies if remedy.startswith("fly a battery of"))
    needed_wh = float(battery.split()[4])
    larger = replace(FLEET, battery_wh=needed_wh + 1.0)
    assert not pondhop.plan(plan.farm, larger, iterations=4000).left_out


@pytest.mark.parametrize("planner", ["hpp", "territory"])
def test_other_planners_are_cut_into_trips_that_can_be_flown(farm: Farm, planner: str) -> None:
    plan = pondhop.plan(farm, FLEET, wind=Wind(4.0, 90.0), planner=planner)
    assert plan.is_feasible
    assert plan.solution.planner == planner
    assert sorted(pond for trip in plan.trips for pond in trip.ponds) == list(range(24))


def test_the_fewest_drones_are_found_and_fewer_are_proven_too_few(farm: Farm) -> None:
    fleet = replace(FLEET, end="22:20")
    found = list(sizes(farm, fleet, Wind(2.0, 45.0), Effort(iterations=3000), max_drones=12))
    enough = [size for size in found if size.is_enough]
    assert enough[0].num_drones > 1
    assert len(enough) == 3
    assert [size.num_drones for size in found] == list(range(1, enough[-1].num_drones + 1))
    assert found[0].is_proven_too_few
    assert not any(size.is_proven_too_few for size in enough)
    with pytest.raises(InvalidInput, match="by when"):
        list(sizes(farm, replace(FLEET, end=None), Wind(), Effort(), max_drones=2))


def test_places_for_swaps_are_never_overbooked(farm: Farm) -> None:
    plan = pondhop.plan(farm, replace(FLEET, num_drones=3, num_pads=1, battery_wh=45.0), iterations=3000)
    assert plan.is_feasible
    swaps = sorted((trip.ready_s - 240.0, trip.ready_s) for trip in plan.trips if trip.ready_s > trip.arrival_s)
    assert len(swaps) >= 2
    assert all(before[1] <= after[0] + 1e-6 for before, after in itertools.pairwise(swaps))


def test_clock_times() -> None:
    assert seconds_between("22:00", "05:30") == 7.5 * 3600
    assert seconds_between("06:00", "06:00") == 86_400
    assert clock_after("22:00", 7200.4) == "00:00:00"
    assert windows_after("22:00", (("22:30", "23:00"), ("21:00", "22:15"))) == [
        (0.0, 900.0),
        (1800.0, 3600.0),
        (82_800.0, 86_400.0),
    ]


def test_wind_is_told_by_where_it_blows_from() -> None:
    east_m_s, north_m_s = parse_wind("8@225").velocity_m_s
    assert (east_m_s, north_m_s) == pytest.approx((5.65685, 5.65685), abs=1e-4)
    assert Wind().told() == "calm air"


@pytest.mark.parametrize("text", ["8", "8@", "@90", "8@400", "-1@90", "x@y", "99@90", "1.2.3@4"])
def test_what_is_no_wind_is_refused(text: str) -> None:
    with pytest.raises(InvalidInput):
        parse_wind(text)


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        ("swap_s = -1", "swap_s"),
        ("num_pads = 0", "num_pads"),
        ("num_pads = 1.5", "num_pads"),
        ('start = "25:00"', "25:00"),
        ("start = 22", "no time of the day"),
        ('end = "05:30"', "nothing says when it starts"),
        ("swap_s = 240\nmax_route_length_m = 5000", "max_route_length_m"),
        ("swap_s = 240\nmax_route_duration_s = 5000", "max_trip_duration_s"),
        ("samples_per_trip = 0", "samples_per_trip"),
        ("max_airspeed_m_s = 0", "max_airspeed_m_s"),
        ("swap = 240", "did you mean swap_s"),
    ],
)
def test_a_wrong_fleet_file_is_refused(tmp_path: Path, lines: str, told: str) -> None:
    path = tmp_path / "fleet.toml"
    path.write_text(f"num_drones = 2\n{lines}\n")
    with pytest.raises(InvalidInput) as error:
        read_fleet(path)
    assert told in str(error.value)


def test_wind_above_the_airspeed_is_refused(farm: Farm) -> None:
    with pytest.raises(InvalidInput, match="none would come back against it"):
        pondhop.plan(farm, FLEET, wind=Wind(10.0, 0.0))


def test_windows_need_a_start() -> None:
    farm = make_farm()
    timed = replace(farm, ponds=(replace(farm.ponds[0], time_windows=(("22:00", "23:00"),)), *farm.ponds[1:]))
    with pytest.raises(InvalidInput, match="when the round starts"):
        pondhop.plan(timed, Fleet(1))


def test_samples_and_time_of_a_trip_are_limited(farm: Farm) -> None:
    plan = pondhop.plan(farm, Fleet(2, swap_s=60.0, samples_per_trip=5, max_trip_duration_s=500.0), iterations=2000)
    assert plan.is_feasible
    assert max(len(trip.ponds) for trip in plan.trips) <= 5
    assert max(trip.duration_s for trip in plan.trips) <= 500.0


def run(*arguments: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(map(str, arguments)))
    return result.exit_code, result.output


def test_the_command_line_plans_a_night_and_sizes_it(farm: Farm, tmp_path: Path) -> None:
    path, fleet = tmp_path / "farm.geojson", tmp_path / "fleet.toml"
    ponds = (replace(farm.ponds[0], time_windows=(("22:10", "22:40"),), priority=2.0), *farm.ponds[1:])
    pondhop.write_farm(path, replace(farm, ponds=ponds))
    fleet.write_text("num_drones = 2\nspeed_m_s = 8\nbattery_wh = 80\nswap_s = 240\n")
    read = pondhop.read_farm(path)
    assert (read.ponds[0].time_windows, read.ponds[0].priority) == ((("22:10", "22:40"),), 2.0)
    options = ("--fleet", fleet, "--wind", "4@225", "--start", "22:00", "--by", "23:30", "--iterations", 2000)
    code, told = run("plan", path, *options, "--no-figure", "-o", tmp_path / "out")
    assert (code, "trips of 2 drones" in told, "22:00:00" in told) == (0, True, True)
    assert (tmp_path / "out" / "missions" / "drone-1-trip-1.plan").exists()
    code, told = run("evaluate", tmp_path / "out" / "plan.json")
    assert (code, "trips of 2 drones" in told) == (0, True)
    short = ("--fleet", fleet, "--start", "22:00", "--by", "22:14", "--iterations", 2000)
    code, told = run("plan", path, *short, "--no-figure", "--require-feasible", "-o", tmp_path / "short")
    assert (code, "Left out:" in told, "What would help:" in told) == (3, True, True)
    code, told = run("size", path, *short)
    assert code == 0
    assert "sample all 24 ponds in time" in told
    code, told = run("size", path, *short, "--max-drones", 1, "--json")
    record = json.loads(told)
    assert (code, record["num_drones"], len(record["sizes"])) == (3, None, 1)


@pytest.mark.parametrize(
    ("properties", "told"),
    [
        ({"time_windows": "22:00"}, "no list of time windows"),
        ({"time_windows": [["22:00", "26:00"]]}, "26:00"),
        ({"time_windows": 5}, "no list of time windows"),
        ({"priority": "high"}, "no priority"),
        ({"priority": 0}, "no priority"),
    ],
)
def test_wrong_tasks_of_ponds_are_told_with_their_place(
    tmp_path: Path, properties: dict[str, object], told: str
) -> None:
    path = tmp_path / "farm.geojson"
    point = {"type": "Point", "coordinates": [-90.9, 33.4]}
    features = [
        {"type": "Feature", "properties": {"id": "P1", **properties}, "geometry": point},
        {
            "type": "Feature",
            "properties": {"role": "depot"},
            "geometry": {"type": "Point", "coordinates": [-90.901, 33.4]},
        },
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    with pytest.raises(InvalidInput) as error:
        pondhop.read_farm(path)
    assert told in str(error.value)


def test_trips_are_held_back_until_no_two_drones_meet() -> None:
    farm = generate_farm(60, at=(-90.9, 33.4), seed=5)
    fleet = replace(FLEET, num_drones=5, end="23:50")
    plan = pondhop.plan(farm, fleet, wind=Wind(3.0, 10.0), iterations=2000)
    apart = pondhop.plan(farm, fleet, wind=Wind(3.0, 10.0), is_deconflicted=True, iterations=2000)
    assert encounters_of(plan)
    assert not encounters_of(apart)
    assert apart.is_feasible
    assert [trip.ponds for trip in apart.trips] == [trip.ponds for trip in plan.trips]
    assert any(trip.hold_s > 0.0 for trip in apart.trips)
    assert apart.all_back_s <= 1.1 * plan.all_back_s


def test_a_plan_of_one_route_a_drone_is_held_apart_too(tmp_path: Path) -> None:
    plan = pondhop.plan(generate_farm(40, at=(-90.9, 33.4), seed=1), Fleet(4), is_deconflicted=True, iterations=2000)
    assert plan.is_round
    assert not encounters_of(plan)
    write_plan_json(tmp_path / "plan.json", plan)
    assert [trip.hold_s for trip in read_plan_json(tmp_path / "plan.json").trips] == [
        trip.hold_s for trip in plan.trips
    ]


def test_a_track_is_where_the_trip_says(night: FarmPlan) -> None:
    problem = night.solution.problem
    for trip, (drone, knots) in zip(night.trips, tracks_of(night), strict=True):
        assert drone == trip.drone
        assert np.all(np.diff(knots[:, 0]) >= 0.0)
        assert trip.departure_s < knots[0, 0] < knots[-1, 0] < trip.arrival_s
        assert knots[[0, -1], 1:] == pytest.approx(np.zeros((2, 3)))
        for pond, (arrival_s, _, departure_s) in zip(trip.ponds, trip.times_s, strict=True):
            for time_s in (arrival_s, departure_s):
                here = [np.interp(time_s, knots[:, 0], knots[:, axis]) for axis in (1, 2, 3)]
                assert here == pytest.approx([*problem.ponds[pond], FLEET.transit_height_m], abs=1e-6)
        # Between ponds and above home no drone is faster than it flies.
        steps = np.diff(knots, axis=0)
        speeds = np.hypot(steps[:, 1], steps[:, 2]) / np.maximum(steps[:, 0], 1e-9)
        assert speeds[steps[:, 0] > 1e-6].max() <= FLEET.return_speed_m_s + 1e-6


def test_what_no_plan_can_do_is_planned_and_told_all_the_same(farm: Farm, tmp_path: Path) -> None:
    # A battery that reaches only near ponds: a bound proves that no plan visits all.
    for fleet in (replace(FLEET, battery_wh=20.0), Fleet(1, battery_wh=40.0), replace(FLEET, reserve_percent=95.0)):
        plan = pondhop.plan(farm, fleet, wind=Wind(4.0, 225.0), iterations=500)
        assert plan.left_out
        assert len(plan.unserved) == len(plan.left_out)
        write_outputs(tmp_path / "out", plan, has_figure=False)
        content = json.loads((tmp_path / "out" / "plan.json").read_text())
        assert content["gap_percent"] is None
        assert read_plan_json(tmp_path / "out" / "plan.json").left_out == plan.left_out


def test_trips_that_wait_for_windows_are_held_apart_too(farm: Farm, tmp_path: Path) -> None:
    ponds = tuple(
        replace(pond, time_windows=(("22:30", "22:50"),) if index % 2 else (("04:00", "04:20"),))
        for index, pond in enumerate(farm.ponds)
    )
    timed = replace(farm, ponds=ponds)
    apart = pondhop.plan(timed, FLEET, is_deconflicted=True, iterations=3000)
    assert apart.is_feasible
    assert not encounters_of(apart)
    # The crew starts trips at their times, and the night is told from its first take-off on.
    write_outputs(tmp_path / "out", apart, has_figure=False)
    text = (tmp_path / "out" / "missions" / "README.txt").read_text()
    assert "Start each trip at its time" in text
    assert all(f"{apart.clock(trip.departure_s)}  {trip.name}" in text for trip in apart.trips)
    assert apart.span_s < apart.all_back_s - 900.0


def test_the_crew_is_told_what_is_not_sampled_and_how_near_drones_come(farm: Farm, tmp_path: Path) -> None:
    plan = pondhop.plan(farm, replace(FLEET, end="22:12"), iterations=2000)
    assert plan.left_out
    write_outputs(tmp_path / "out", plan, has_figure=False)
    text = " ".join((tmp_path / "out" / "missions" / "README.txt").read_text().split())
    assert "NOT SAMPLED in this round" in text
    assert encounters_text(plan).partition(":")[0] in text


def test_the_reason_names_the_windows_where_they_are_the_cause(farm: Farm) -> None:
    def reason_with(*windows: tuple[str, str]) -> str:
        ponds = (replace(farm.ponds[0], time_windows=windows), *farm.ponds[1:])
        (unserved,) = pondhop.plan(replace(farm, ponds=ponds), FLEET, iterations=1500).unserved
        return unserved.reason

    assert "21:00-21:30" in reason_with(("21:00", "21:30"))
    ponds = tuple(replace(pond, time_windows=(("23:00", "23:00"),)) for pond in farm.ponds)
    plan = pondhop.plan(replace(farm, ponds=ponds), FLEET, iterations=500)
    assert {unserved.reason for unserved in plan.unserved} == {
        "no drone has time for it within the time windows (23:00-23:00)"
    }


def test_wind_above_the_limit_of_landings_is_a_note(farm: Farm) -> None:
    plan = pondhop.plan(farm, FLEET, wind=Wind(6.0, 225.0), iterations=300)
    assert any("does not notice" in note for note in plan.notes)
    assert not any("does not notice" in note for note in pondhop.plan(farm, FLEET, iterations=300).notes)


@pytest.mark.parametrize(
    ("value", "windows"),
    [
        ([], ()),
        ("22:10\N{EN DASH}22:20", (("22:10", "22:20"),)),
        (["22:30-23:30", "01:00-02:00"], (("22:30", "23:30"), ("01:00", "02:00"))),
        (["22:30", "23:30"], (("22:30", "23:30"),)),
    ],
)
def test_windows_may_be_written_as_people_do(
    tmp_path: Path, value: object, windows: tuple[tuple[str, str], ...]
) -> None:
    path = tmp_path / "farm.geojson"
    features = [
        {
            "type": "Feature",
            "properties": properties,
            "geometry": {"type": "Point", "coordinates": [longitude, 33.4]},
        }
        for properties, longitude in (({"id": "P1", "time_windows": value}, -90.9), ({"role": "depot"}, -90.901))
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    assert pondhop.read_farm(path).ponds[0].time_windows == windows
