from __future__ import annotations

import json
import math
import re
import struct
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import pondhop
import pondhop.missions
from hand_made import DEPOT, make_farm, make_plan, square, two_drones
from pondhop import plan as pondhop_plan
from pondhop.errors import Fault, InvalidInput
from pondhop.farm.model import Farm, Pond
from pondhop.fleet import Fleet, SamplingStyle
from pondhop.fleet.settings import NUMBERS
from pondhop.missions import write_missions
from pondhop.missions.autopilots import ARDUPILOT
from pondhop.missions.check import broken_rules
from pondhop.missions.formats.qgroundcontrol import parse_qgroundcontrol_plan, qgroundcontrol_plan
from pondhop.missions.formats.waypoints import parse_waypoints, waypoints
from pondhop.missions.mavlink import MavlinkItem, from_mavlink, to_mavlink
from pondhop.missions.mission import Action, Mission, MissionItem, build_mission
from pondhop.solution import FarmPlan, FarmViolation, Solution
from pondhop.units import clock_text

STYLES = [Fleet(num_drones=2), Fleet(num_drones=2, sampling="splashdown", dwell_s=30)]


def build(fleet: Fleet, route: list[int], **changes: object) -> Mission:
    return build_mission(0, make_farm(**changes), fleet, route)


def check(mission: Mission) -> list[Fault]:
    return [rule.fault for rule in broken_rules(mission, ARDUPILOT)]


def with_item(mission: Mission, index: int, **changes: Any) -> Mission:
    items = list(mission.items)
    items[index] = replace(items[index], **changes)
    return replace(mission, items=tuple(items))


def test_hover_dip_lowers_the_probe_at_each_pond() -> None:
    mission = build(Fleet(num_drones=1, dwell_s=5, dip_height_m=2), [1])
    pond = (-89.001, 37.001)
    assert mission.items == (
        MissionItem(Action.TAKEOFF, DEPOT, 7.0),
        MissionItem(Action.CHANGE_SPEED, speed_m_s=5.0),
        MissionItem(Action.WAYPOINT, pond, 7.0),
        MissionItem(Action.WAYPOINT, pond, 2.0, hold_s=5.0),
        MissionItem(Action.WAYPOINT, pond, 7.0),
        MissionItem(Action.RETURN_TO_LAUNCH),
    )
    assert check(mission) == []


def test_splashdown_lands_waits_and_takes_off_at_each_pond() -> None:
    mission = build(Fleet(num_drones=1, sampling="splashdown", dwell_s=30), [1])
    pond = (-89.001, 37.001)
    assert mission.items[2:] == (
        MissionItem(Action.WAYPOINT, pond, 7.0),
        MissionItem(Action.LAND, pond, 0.0),
        MissionItem(Action.DELAY, hold_s=30.0),
        MissionItem(Action.TAKEOFF, pond, 7.0),
        MissionItem(Action.RETURN_TO_LAUNCH),
    )
    assert check(mission) == []


def test_the_plan_file_is_as_qgroundcontrol_wants_it() -> None:
    hole = square(-89.005, 37.005, 0.001)
    mission = build(
        Fleet(num_drones=1, sampling="splashdown"),
        [1],
        fences=((square(*DEPOT, 0.01), hole),),
        no_fly=((square(-89.005, 36.995, 0.001),),),
    )
    plan = json.loads(qgroundcontrol_plan(mission))
    assert (plan["fileType"], plan["version"], plan["mission"]["version"]) == ("Plan", 1, 2)
    assert plan["mission"]["firmwareType"] == 3
    assert plan["mission"]["vehicleType"] == 2
    assert plan["mission"]["plannedHomePosition"] == [37.0, -89.0, 0.0]
    items = plan["mission"]["items"]
    assert [item["doJumpId"] for item in items] == [1, 2, 3, 4, 5, 6, 7]
    assert [item["command"] for item in items] == [22, 178, 16, 21, 93, 22, 20]
    assert [item["frame"] for item in items] == [3, 2, 3, 3, 2, 3, 2]
    assert items[0]["params"] == [0, 0, 0, None, 37.0, -89.0, 7]
    assert items[1]["params"] == [1, 5, -1, 0, 0, 0, 0]
    assert items[4]["params"] == [5, -1, -1, -1, 0, 0, 0]
    polygons = plan["geoFence"]["polygons"]
    assert [polygon["inclusion"] for polygon in polygons] == [True, False, False]
    # Latitude first, and the first corner not repeated at the end.
    assert polygons[0]["polygon"] == [[36.99, -89.01], [36.99, -88.99], [37.01, -88.99], [37.01, -89.01]]


def test_holes_of_areas_are_flown_by_what_an_autopilot_can_store() -> None:
    west, home = square(-89.006, 37.0, 0.001), square(*DEPOT, 0.003)
    fleet = Fleet(num_drones=1)
    away = build(fleet, [1], no_fly=((square(-89.006, 37.0, 0.002), west),))
    assert (len(away.fences), away.no_fly) == (1, (square(-89.006, 37.0, 0.002)[:-1],))
    # Around the depot the hole alone says where to fly: nothing in the zone can be reached from there.
    within = build(fleet, [1], no_fly=((square(*DEPOT, 0.005), square(*DEPOT, 0.0001)),))
    assert within.no_fly == ()
    assert [rule.kind for rule in broken_rules(within, ARDUPILOT)] == ["outside_fence"]
    roomy = build(fleet, [1], no_fly=((square(*DEPOT, 0.005), west, home),))
    assert roomy.fences[1:] == (home[:-1],)
    assert broken_rules(roomy, ARDUPILOT) == []


def test_the_waypoints_file_has_twelve_columns_and_home_first() -> None:
    lines = waypoints(build(Fleet(num_drones=1), [1])).split("\n")
    assert lines[0] == "QGC WPL 110"
    zeros = "\t".join(["0.00000000"] * 4)
    assert lines[1] == f"0\t1\t0\t16\t{zeros}\t37.00000000\t-89.00000000\t0.00000000\t1"
    dip = "5.00000000\t0.00000000\t0.00000000\t0.00000000"
    assert lines[5] == f"4\t0\t3\t16\t{dip}\t37.00100000\t-89.00100000\t2.00000000\t1"
    assert lines[-1] == ""


@pytest.mark.parametrize("fleet", STYLES, ids=lambda fleet: fleet.sampling)
def test_every_written_file_reads_back_as_the_mission(tmp_path: Path, fleet: Fleet) -> None:
    farm = make_farm(no_fly=((square(-89.005, 36.995, 0.001),),))
    paths = write_missions(tmp_path, make_plan(farm, fleet, [[0, 1, 2], [4, 3]]))
    assert {path.name for path in paths} == {
        *(f"drone-{drone}{suffix}" for drone in (1, 2) for suffix in (".plan", ".waypoints", ".param", ".params")),
        *(f"drone-{drone}-4.7{suffix}" for drone in (1, 2) for suffix in (".param", ".params")),
        "README.txt",
    }
    assert set(tmp_path.iterdir()) == set(paths)
    for name, route in (("drone-1", [0, 1, 2]), ("drone-2", [4, 3])):
        mission = build_mission(int(name[-1]) - 1, farm, fleet, route)
        assert parse_qgroundcontrol_plan((tmp_path / f"{name}.plan").read_text(), name) == mission
        read = parse_waypoints((tmp_path / f"{name}.waypoints").read_text(), name)
        assert read == replace(mission, fences=(), no_fly=())


def test_the_readme_tells_the_crew_what_splashdown_needs(tmp_path: Path) -> None:
    write_missions(tmp_path, make_plan(make_farm(), STYLES[1], [[0, 1, 2], [4, 3]]))
    text = (tmp_path / "README.txt").read_text()
    assert "MIS_OPTIONS" in text
    assert "drone-2: 2 ponds" in text


def test_every_drone_flies_out_in_a_layer_of_its_own() -> None:
    fleet = Fleet(num_drones=3, layer_spacing_m=4.0)
    third = build_mission(2, make_farm(), fleet, [1, 0])
    pond = (-89.001, 37.001)
    assert third.items[:4] == (
        MissionItem(Action.TAKEOFF, DEPOT, 15.0),
        MissionItem(Action.CHANGE_SPEED, speed_m_s=5.0),
        MissionItem(Action.WAYPOINT, pond, 15.0),
        MissionItem(Action.WAYPOINT, pond, 7.0),
    )
    assert check(third) == []
    lowest = build_mission(0, make_farm(), fleet, [1, 0])
    assert len(lowest.items) == len(third.items) - 1


def test_drones_fly_out_in_the_layers_of_the_plan_where_all_come_home_above() -> None:
    ponds = tuple(Pond(f"P{number}", (-89.0 + 0.0004 * number, 37.001)) for number in range(-12, 13))
    farm, fleet = make_farm(ponds=ponds), Fleet(num_drones=25)
    problem = farm.to_problem(fleet, are_layers_stacked=True)
    plan = pondhop.evaluate(problem, [[pond] for pond in range(25)])
    solution = Solution(problem, plan, "by hand", seed=1, elapsed_s=0.0)
    farm_plan = FarmPlan(farm, fleet, solution, are_layers_stacked=True)
    # So many layers above each other need a smaller spacing than where they may lie between each other.
    assert farm_plan.layers.spacing_m < fleet.layers(25).spacing_m
    heights_m = [mission.items[0].height_m for mission in pondhop.missions._missions(farm_plan)]
    assert heights_m == pytest.approx([farm_plan.layers.way_out_height_m(drone) for drone in range(25)])


def parameters(path: Path) -> dict[str, float]:
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return {name: float(value) for name, _, value in (line.partition(",") for line in lines)}


RANGES = {
    "WPNAV_SPEED": (10, 2000),
    "WPNAV_SPEED_UP": (10, 1000),
    "WPNAV_SPEED_DN": (10, 500),
    "LAND_SPEED": (30, 200),
    "LAND_ALT_LOW": (100, 10_000),
    "RTL_ALT": (30, 300_000),
    "RTL_SPEED": (1, 2000),
    "RTL_LOIT_TIME": (0, 60_000),
    "FENCE_RADIUS": (30, 10_000),
    "FENCE_ALT_MAX": (10, 1000),
    "DISARM_DELAY": (0, 127),
    "WP_SPD": (0.1, 20),
    "RTL_ALT_M": (0.3, 3000),
    "RTL_SPEED_MS": (0.01, 20),
}
"""What ArduPilot's source documents; `pondhop.fleet.settings` and `pondhop.missions.autopilots` tell where."""


@pytest.mark.parametrize("end", ["least", "most"])
def test_every_setting_that_a_fleet_may_have_is_one_that_the_autopilot_takes(end: str, tmp_path: Path) -> None:
    names: tuple[str, ...] = (
        "speed_m_s",
        "climb_speed_m_s",
        "descent_speed_m_s",
        "landing_speed_m_s",
        "slow_landing_height_m",
    )
    names += ("return_speed_m_s", "return_loiter_s", "return_height_m")
    settings: dict[str, Any] = {name: getattr(NUMBERS[name], end) for name in names}
    settings |= {"transit_height_m": NUMBERS["transit_height_m"].most if end == "most" else 1.0}
    fleet = Fleet(1, sampling="splashdown", dwell_s=1.0 if end == "least" else 3600.0, **settings)
    write_missions(tmp_path, make_plan(make_farm(), fleet, [[0, 1, 2, 3, 4]]))
    written = parameters(tmp_path / "drone-1.param") | parameters(tmp_path / "drone-1-4.7.param")
    assert written.keys() >= RANGES.keys()
    for name, (least, most) in RANGES.items():
        assert least <= written[name] <= most, name


def test_drones_are_set_to_what_the_plan_counts_with(tmp_path: Path) -> None:
    fleet = Fleet(num_drones=2, speed_m_s=6.0, sampling="splashdown", dwell_s=20, layer_spacing_m=5.0)
    write_missions(tmp_path, make_plan(make_farm(), fleet, [[0, 1, 2], [4, 3]]))
    first, second = (parameters(tmp_path / f"drone-{drone}.param") for drone in (1, 2))
    assert (first["RTL_ALT"], second["RTL_ALT"]) == (1500, 2000)
    # From near home, too: no cone caps that height, no least climb lifts it.
    assert (first["RTL_CONE_SLOPE"], first["RTL_CLIMB_MIN"]) == (0, 0)
    # Heights above home, and landing there, whatever the drone was set to before.
    assert (first["RTL_ALT_TYPE"], first["RTL_ALT_FINAL"]) == (0, 0)
    assert (first["WPNAV_SPEED"], first["RTL_SPEED"]) == (600, 1000)
    assert first["MIS_OPTIONS"] == 4
    # Twice the stay and half a minute: a pause on the water begins the stay anew.
    assert first["DISARM_DELAY"] == 70
    assert (first["FENCE_TYPE"], first["FENCE_ENABLE"]) == (7, 1)
    # P0 lies 178 m west and 111 m north of home, so 210 m away; the highest flight is the way home.
    assert first["FENCE_RADIUS"] == pytest.approx(210 + 50, abs=1)
    assert (first["FENCE_ALT_MAX"], second["FENCE_ALT_MAX"]) == (30, 35)
    assert (first["BATT_FS_LOW_ACT"], first["FS_GCS_ENABLE"]) == (2, 1)
    # QGroundControl: the same values in five columns.
    rows = [line.split("\t") for line in (tmp_path / "drone-1.params").read_text().splitlines() if line[0] != "#"]
    assert {row[2]: float(row[3]) for row in rows} == first
    assert all(len(row) == 5 and row[:2] == ["1", "1"] for row in rows)
    # MAV_PARAM_TYPE as ArduPilot stores them: AP_Int8 2, AP_Int16 4, AP_Int32 6, AP_Float 9.
    assert {row[2]: int(row[4]) for row in rows} == {
        "WPNAV_SPEED": 9,
        "RTL_ALT": 6,
        "RTL_CONE_SLOPE": 9,
        "RTL_CLIMB_MIN": 4,
        "RTL_ALT_TYPE": 2,
        "RTL_ALT_FINAL": 4,
        "RTL_SPEED": 4,
        "RTL_LOIT_TIME": 6,
        "MIS_OPTIONS": 4,
        "DISARM_DELAY": 2,
        "FENCE_TYPE": 2,
        "FENCE_RADIUS": 9,
        "FENCE_ALT_MAX": 9,
        "FENCE_ENABLE": 2,
        "BATT_FS_LOW_ACT": 2,
        "FS_GCS_ENABLE": 2,
    }


def test_no_parameter_file_mixes_centimetres_and_metres(tmp_path: Path) -> None:
    # QGroundControl sets RTL_ALT where a file for 4.7 says RTL_ALT_M 15 and the drone is older: 15 cm.
    write_missions(tmp_path, two_drones())
    old, new = parameters(tmp_path / "drone-2.param"), parameters(tmp_path / "drone-2-4.7.param")
    assert (old.pop("WPNAV_SPEED"), old.pop("RTL_ALT"), old.pop("RTL_SPEED")) == (500, 1800, 1000)
    assert (new.pop("WP_SPD"), new.pop("RTL_ALT_M"), new.pop("RTL_SPEED_MS")) == (5, 18, 10)
    assert (old.pop("RTL_CLIMB_MIN"), new.pop("RTL_CLIMB_MIN_M")) == (0, 0)
    assert (old.pop("RTL_ALT_FINAL"), new.pop("RTL_ALT_FINAL_M")) == (0, 0)
    assert old == new
    assert new["RTL_CONE_SLOPE"] == 0
    rows = [line.split("\t") for line in (tmp_path / "drone-2-4.7.params").read_text().splitlines() if line[0] != "#"]
    metres = {"RTL_ALT_M", "RTL_CLIMB_MIN_M", "RTL_ALT_FINAL_M"}
    assert {row[2] for row in rows} == {*new, *metres, "WP_SPD", "RTL_SPEED_MS"}
    text = " ".join((tmp_path / "README.txt").read_text().split())
    assert "Copter from version 4.7: load drone-N-4.7.param or drone-N-4.7.params instead" in text
    assert "RTL_ALT is RTL_ALT_M x 100" in text


def test_vertical_speeds_of_the_fleet_are_set_on_the_drones(tmp_path: Path) -> None:
    fleet = Fleet(1, climb_speed_m_s=2.0, landing_speed_m_s=0.3, slow_landing_height_m=5.0)
    write_missions(tmp_path, make_plan(make_farm(), fleet, [[0, 1, 2, 3, 4]]))
    old, new = parameters(tmp_path / "drone-1.param"), parameters(tmp_path / "drone-1-4.7.param")
    assert (old["WPNAV_SPEED_UP"], old["LAND_SPEED"], old["LAND_ALT_LOW"]) == (200, 30, 500)
    assert (new["WP_SPD_UP"], new["LAND_SPD_MS"], new["LAND_ALT_LOW_M"]) == (2, 0.3, 5)
    # ArduPilot's own default stays as the crew has it.
    assert "WPNAV_SPEED_DN" not in old


def test_ground_stations_find_a_name_and_a_value_a_line(tmp_path: Path) -> None:
    write_missions(tmp_path, two_drones())
    for path in tmp_path.glob("*.param"):
        for line in path.read_text().splitlines():
            assert line.startswith("#") or re.fullmatch(r"[A-Z][A-Z0-9_]{0,15},[0-9.]+", line), line


def test_a_hover_dip_without_areas_is_told_only_what_it_needs(tmp_path: Path) -> None:
    write_missions(tmp_path, make_plan(make_farm(fences=()), Fleet(1), [[0, 1, 2, 3, 4]]))
    names = set(parameters(tmp_path / "drone-1.param"))
    assert not names & {"MIS_OPTIONS", "DISARM_DELAY", "FENCE_ENABLE"}
    assert {"WPNAV_SPEED", "RTL_ALT", "FENCE_RADIUS", "BATT_FS_LOW_ACT"} <= names


def test_the_readme_tells_what_a_crew_must_know(tmp_path: Path) -> None:
    fleet = Fleet(num_drones=2, sampling="splashdown", battery_wh=95)
    farm_plan = make_plan(make_farm(), fleet, [[0, 1, 2], [4, 3]])
    write_missions(tmp_path, farm_plan)
    text = " ".join((tmp_path / "README.txt").read_text().split())
    most_j = max(farm_plan.plan.route_energies_j)
    for words in (
        "drone-2: 2 ponds",
        "takes off at 0:10, flies out 10 m high, comes home 18 m high",
        "energy: take-off",
        f"A battery gives 71.2 Wh above its reserve of 25 %; the hungriest route takes {most_j / 3600:.1f} Wh, "
        f"{100 * most_j / (3600 * 71.25):.0f} % of it.",
        f"is back at {clock_text(10.0 + farm_plan.plan.route_durations_s[1])}",
        "Start every drone with a full battery.",
        "RTL_ALT 1500",
        "DISARM_DELAY 40",
        "nothing happens when a battery runs low",
        "Start drone 1, then each drone 10 s after",
        "AUTO_OPTIONS 3",
        "Above 5 m/s no landing on a pond ends",
        "Stand the drones at least 5 m apart",
    ):
        assert words in text, words
    write_missions(tmp_path, make_plan(make_farm(), Fleet(num_drones=2), [[0, 1, 2], [4, 3]]))
    text = " ".join((tmp_path / "README.txt").read_text().split())
    assert "Flight time is unchecked: the fleet names no battery_wh. The hungriest route takes" in text
    assert "no landing on a pond" not in text


def test_missions_of_an_earlier_plan_are_removed(tmp_path: Path) -> None:
    write_missions(tmp_path, two_drones())
    (tmp_path / "drone-2.plan.bak").write_text("the user's own")
    write_missions(tmp_path, make_plan(make_farm(), Fleet(num_drones=1), [[0, 1, 2, 3, 4]]))
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "README.txt",
        "drone-1-4.7.param",
        "drone-1-4.7.params",
        "drone-1.param",
        "drone-1.params",
        "drone-1.plan",
        "drone-1.waypoints",
        "drone-2.plan.bak",
    ]


def unflyable() -> FarmPlan:
    return make_plan(make_farm(), Fleet(num_drones=1, max_route_length_m=300), [[0, 1, 2, 3, 4]])


def test_missions_of_an_earlier_plan_are_removed_where_none_can_be_flown(tmp_path: Path) -> None:
    write_missions(tmp_path, two_drones())
    (tmp_path / "notes.txt").write_text("the user's own")
    with pytest.raises(InvalidInput, match="max_route_length_m is 300"):
        write_missions(tmp_path, unflyable())
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


@pytest.mark.parametrize("farm_plan", [two_drones(), unflyable()], ids=["flyable", "unflyable"])
@pytest.mark.parametrize("name", ["README.txt", "drone-1.param", "drone-7.plan"])
def test_files_of_the_user_are_neither_replaced_nor_removed(tmp_path: Path, name: str, farm_plan: FarmPlan) -> None:
    (tmp_path / name).write_text("Missions for the user's own eyes")
    with pytest.raises(InvalidInput, match="nothing says that it wrote the one that is there"):
        write_missions(tmp_path, farm_plan)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [
        (name, "Missions for the user's own eyes")
    ]


def test_a_mission_saved_again_by_a_ground_station_is_replaced(tmp_path: Path) -> None:
    write_missions(tmp_path, two_drones())
    expected = (tmp_path / "drone-1.plan").read_text()
    (tmp_path / "drone-1.plan").write_text("as a ground station lays it out")
    write_missions(tmp_path, two_drones())
    assert (tmp_path / "drone-1.plan").read_text() == expected


def test_a_failure_leaves_the_missions_of_the_earlier_plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_missions(tmp_path, two_drones())
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    rename = Path.rename

    def fail_at_the_readme(self: Path, target: Path) -> Path:
        if target == tmp_path / "README.txt" and self.parent.name == "new":
            raise OSError(5, "Input/output error")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", fail_at_the_readme)
    with pytest.raises(OSError, match="Input/output"):
        write_missions(tmp_path, make_plan(make_farm(), Fleet(num_drones=1), [[0, 1, 2, 3, 4]]))
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize(
    ("index", "changes", "message"),
    [
        (2, {"position": (-89.0, 137.0)}, "latitude is 137"),
        (2, {"position": (math.nan, 37.0)}, "longitude is nan"),
        (2, {"position": None}, "no position"),
        (2, {"height_m": 122.0}, "height is 122.0 m"),
        (2, {"height_m": 121.95}, "height is 121.95 m"),
        (2, {"height_m": math.inf}, "height is inf"),
        (2, {"height_m": 0.0}, "height is 0 m"),
        (4, {"hold_s": 2.5}, "hold is 2.5 s"),
        (4, {"hold_s": math.nan}, "hold is nan s"),
        (4, {"hold_s": 65_536.0}, "hold is 65536.0 s"),
        (4, {"hold_s": 0.0}, "delay is 0 s"),
        (4, {"action": Action.RETURN_TO_LAUNCH}, "items follow the return"),
        (5, {"action": Action.WAYPOINT}, "does not take off again"),
        (1, {"speed_m_s": 0.0}, "speed is 0.0"),
        (0, {"action": Action.WAYPOINT}, "does not begin with TAKEOFF"),
        (6, {"action": Action.WAYPOINT, "position": DEPOT, "height_m": 7.0}, "ends with neither"),
    ],
)
def test_each_rule_is_checked(index: int, changes: dict[str, Any], message: str) -> None:
    mission = build(Fleet(num_drones=1, sampling="splashdown"), [1])
    assert check(mission) == []
    faults = check(with_item(mission, index, **changes))
    assert any(message in fault.message for fault in faults), faults
    assert all(fault.path.startswith("drone-1") and fault.action for fault in faults)


def test_legs_stay_inside_every_fence_and_outside_no_fly_zones() -> None:
    # The zone lies between the depot and pond P0, the small fence leaves P4 out.
    mission = build(
        Fleet(num_drones=1),
        [0, 3, 4],
        fences=((square(*DEPOT, 0.01),), (square(-89.0, 37.0, 0.0015),)),
        no_fly=((square(-89.001, 37.0005, 0.0001),),),
    )
    assert [(fault.path, fault.message) for fault in check(mission)] == [
        (
            "drone-1, fence 2",
            "4 of 4 legs are not inside it (leg from home to pond P0, leg from pond P0 to pond P3, "
            "leg from pond P3 to pond P4, leg from pond P4 to home)",
        ),
        ("drone-1, no-fly zone 1", "1 of 4 legs are not outside it (leg from home to pond P0)"),
    ]
    assert [rule.kind for rule in broken_rules(mission, ARDUPILOT)] == ["outside_fence", "crosses_no_fly"]


def test_areas_are_told_as_the_farm_has_them() -> None:
    # P4 lies beyond the hole of the first zone, in the second, and in a hole of the fence.
    around_p4 = square(-88.998, 37.001, 0.0001)
    mission = build(
        Fleet(num_drones=1),
        [4],
        fences=((square(*DEPOT, 0.01), square(-89.005, 37.0, 0.0001), around_p4),),
        no_fly=((square(*DEPOT, 0.005), square(*DEPOT, 0.001)), (around_p4,)),
    )
    assert [fault.path for fault in check(mission)] == [
        "drone-1, the hole of no-fly zone 1",
        "drone-1, no-fly zone 2",
        "drone-1, hole 2 of fence 1",
    ]
    # A mission read back from a file has rings alone.
    assert [fault.path for fault in check(replace(mission, fence_names=(), no_fly_names=()))] == [
        "drone-1, fence 2",
        "drone-1, no-fly zone 1",
        "drone-1, no-fly zone 3",
    ]


def test_legs_keep_a_margin_to_fences_and_no_fly_zones() -> None:
    # From home north to P2, 111 m away; the fence ends 3 m behind the pond.
    fence = ((-89.001, 36.999), (-88.999, 36.999), (-88.999, 37.001027), (-89.001, 37.001027), (-89.001, 36.999))
    mission = build(Fleet(num_drones=1), [2], fences=((fence,),))
    assert broken_rules(mission, ARDUPILOT, margin_m=2.5) == []
    (rule,) = broken_rules(mission, ARDUPILOT, margin_m=3.5)
    assert "2 of 2 legs are not inside it by at least 3.5 m" in rule.fault.message
    zone = ((-88.99999, 37.0004), (-88.999, 37.0004), (-88.999, 37.0006), (-88.99999, 37.0006), (-88.99999, 37.0004))
    mission = build(Fleet(num_drones=1), [2], no_fly=((zone,),))
    assert broken_rules(mission, ARDUPILOT, margin_m=0.5) == []
    assert [rule.kind for rule in broken_rules(mission, ARDUPILOT, margin_m=1.5)] == ["crosses_no_fly"]


def test_a_fence_that_crosses_itself_is_refused() -> None:
    bow_tie = ((-89.01, 36.99), (-88.99, 37.01), (-88.99, 36.99), (-89.01, 37.01), (-89.01, 36.99))
    assert [fault.message for fault in check(build(Fleet(1), [0], fences=((bow_tie,),)))] == ["it is no simple polygon"]


def test_too_many_items_are_refused_for_every_drone(tmp_path: Path) -> None:
    ponds = tuple(Pond(str(number), (-89.0 + 1e-5 * number, 37.001)) for number in range(500))
    farm = Farm("large", ponds, DEPOT)
    fleet = Fleet(num_drones=2, sampling="splashdown")
    folder = tmp_path / "missions"
    with pytest.raises(InvalidInput) as error:
        write_missions(folder, make_plan(farm, fleet, [list(range(162)), list(range(162, 500))]))
    assert [(fault.path, fault.message) for fault in error.value.faults] == [
        ("drone-1", "it has 652 items with home, ArduPilot stores 650"),
        ("drone-2", "it has 1357 items with home, ArduPilot stores 650"),
    ]
    # 161 ponds a mission: 500 ponds are 4 missions.
    flights = [(fault.action.partition(", or ")[0], fault.action.partition(", or ")[2]) for fault in error.value.faults]
    assert flights == [
        ("plan for at least 4 drones", "fly its ponds in 2 flights, at most 161 in each"),
        ("plan for at least 4 drones", "fly its ponds in 3 flights, at most 161 in each"),
    ]
    assert not folder.exists()
    # One pond less fits: 3 items, 4 a pond, and home.
    assert check(build_mission(0, farm, fleet, list(range(161)))) == []
    # 1300 items: 324 ponds, home, take-off, speed, way home. Two flights of 650 items sample 161 ponds each at most.
    (rule,) = broken_rules(build_mission(0, farm, fleet, list(range(324))), ARDUPILOT)
    assert (rule.kind, rule.value, rule.limit) == ("too_many_items", 1300, 650)
    assert rule.fault.action == "fly its ponds in 3 flights, at most 161 in each"


def test_as_many_items_as_the_autopilot_stores_are_flown() -> None:
    mission = build(Fleet(1), [1])
    first, *rest = mission.items
    full = replace(mission, items=(first, *[mission.items[2]] * (649 - len(mission.items)), *rest))
    assert len(full.items) + 1 == 650
    assert check(full) == []
    over = replace(mission, items=(first, mission.items[2], *full.items[1:]))
    assert [rule.kind for rule in broken_rules(over, ARDUPILOT)] == ["too_many_items"]


def test_files_hold_what_a_mission_needs_of_a_position(tmp_path: Path) -> None:
    # 8 decimals of a degree are a millimetre; 6 are 11 cm.
    farm = Farm("fine", (Pond("A", (-89.00012345, 37.00098765)),), DEPOT)
    write_missions(tmp_path, make_plan(farm, Fleet(1), [[0]]))
    assert "\t37.00098765\t-89.00012345\t" in (tmp_path / "drone-1.waypoints").read_text()
    items = json.loads((tmp_path / "drone-1.plan").read_text())["mission"]["items"]
    assert items[2]["params"][4:6] == [37.00098765, -89.00012345]


def test_all_faults_of_all_missions_are_told_and_nothing_is_written(tmp_path: Path) -> None:
    fleet = Fleet(num_drones=2, max_route_length_m=300, max_route_duration_s=60)
    with pytest.raises(InvalidInput) as error:
        write_missions(tmp_path, make_plan(make_farm(), fleet, [[0, 1, 2], [4, 3]]))
    text = str(error.value)
    for message in ("max_route_length_m is 300", "max_route_duration_s is 1 min"):
        assert message in text
    assert {fault.path.split(",")[0] for fault in error.value.faults} == {"drone-1", "drone-2"}
    assert list(tmp_path.iterdir()) == []


def test_what_a_plan_does_not_know_of_itself_is_told_beside_what_it_knows(tmp_path: Path) -> None:
    plan = make_plan(make_farm(no_fly=((square(-89.0015, 37.001, 0.0002),),)), Fleet(1), [[0, 1, 2, 3, 4]])
    known = FarmViolation("unconfirmed", "pond P0 was guessed", "look at it")
    with pytest.raises(InvalidInput) as error:
        write_missions(tmp_path, replace(plan, obstacles=(known,)))
    assert [fault.message.partition(":")[0] for fault in error.value.faults] == ["pond P0 was guessed", "no-fly zone 1"]


def test_a_plan_without_routes_has_no_mission(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="no route"):
        write_missions(tmp_path, make_plan(make_farm(), Fleet(1), []))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"version": 1,\n "groundStation"', '"version": 3,\n "groundStation"', "1 was expected"),
        ('"doJumpId": 2', '"doJumpId": 7', "number items from 1: 2"),
        ('"command": 20', '"command": 21', "frame 2"),
        ('"frame": 2', '"frame": 3', "frame 3"),
        ('"command": 20', '"command": 19', "command 19"),
        ("7.0\n", "NaN\n", "NaN"),
        ("7.0\n", "1e999\n", "1e999"),
        ('"circles": []', '"circles": [1]', "circles"),
        ("{", "", "not JSON"),
    ],
)
def test_a_changed_plan_file_is_refused(old: str, new: str, message: str) -> None:
    text = qgroundcontrol_plan(build(Fleet(1), [1]))
    assert old in text
    with pytest.raises(InvalidInput, match=re.escape(message)):
        parse_qgroundcontrol_plan(text.replace(old, new, 1), "drone-1")


def test_a_latitude_of_137_degrees_in_a_plan_file_is_found() -> None:
    text = qgroundcontrol_plan(build(Fleet(1), [1])).replace("37.001", "137.0", 1)
    assert [fault.message for fault in check(parse_qgroundcontrol_plan(text, "drone-1"))] == ["the latitude is 137.0"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("QGC WPL 110", "QGC WPL 120", "line 1"),
        ("\t", " ", "line 2: it has 11 columns"),
        ("3\t0\t3\t16", "9\t0\t3\t16", "line 5: sequence"),
        ("0\t1\t0\t16", "0\t1\t3\t16", "line 2: it has frame 3"),
        ("37.00100000", "nan", "line 5: nan is no finite number"),
        ("37.00100000", "north", "line 5: could not convert"),
        ("\t178\t", "\t179\t", "command 179"),
    ],
)
def test_a_changed_waypoints_file_is_refused(old: str, new: str, message: str) -> None:
    text = waypoints(build(Fleet(1), [1]))
    assert old in text
    with pytest.raises(InvalidInput, match=message):
        parse_waypoints(text.replace(old, new, 1), "drone-1")


def test_an_empty_waypoints_file_is_refused() -> None:
    with pytest.raises(InvalidInput, match="line 1"):
        parse_waypoints("", "drone-1")


def test_nothing_but_yaw_is_ever_unset() -> None:
    for fleet in STYLES:
        for item in map(to_mavlink, build(fleet, [0, 1]).items):
            unset = [number for number, param in enumerate(item.params, start=1) if param is None]
            assert unset in ([], [4])
            assert unset == [] or item.command in (16, 21, 22)


def test_an_unset_hold_is_refused() -> None:
    item = MavlinkItem(16, 3, (None, 0.0, 0.0, None, 37.0, -89.0, 7.0))
    with pytest.raises(ValueError, match="none that pondhop writes"):
        from_mavlink(item)


@pytest.fixture(scope="module")
def mavsdk_mission_raw() -> Iterator[Any]:
    """MAVSDK's importer; it parses only for a system it has seen, so it is handed a heartbeat. No network is used."""
    mavsdk = pytest.importorskip("mavsdk", reason="mavsdk is not installed: only our own parsers read the missions")
    mission_raw = pytest.importorskip("mavsdk.plugins.mission_raw.mission_raw", reason="mavsdk is older than 4")
    configuration = mavsdk.Configuration.create_with_component_type(mavsdk.ComponentType.GROUND_STATION)
    with mavsdk.Mavsdk(configuration) as station:
        station.add_any_connection("raw://")
        station.pass_received_raw_bytes(heartbeat())
        system = station.first_autopilot(10.0)
        assert system is not None
        yield mission_raw.MissionRaw(system)


def heartbeat() -> bytes:
    """A MAVLink 1 HEARTBEAT of a quadcopter that runs ArduPilot."""
    payload = struct.pack("<IBBBBB", 0, 2, 3, 81, 4, 3)
    body = bytes([len(payload), 0, 1, 1, 0]) + payload
    checksum = 0xFFFF
    for byte in body + bytes([50]):
        step = (byte ^ checksum) & 0xFF
        step = (step ^ (step << 4)) & 0xFF
        checksum = ((checksum >> 8) ^ (step << 8) ^ (step << 3) ^ (step >> 4)) & 0xFFFF
    return b"\xfe" + body + struct.pack("<H", checksum)


@pytest.mark.parametrize("fleet", STYLES, ids=lambda fleet: fleet.sampling)
def test_mavsdk_imports_every_written_file(tmp_path: Path, mavsdk_mission_raw: Any, fleet: Fleet) -> None:
    farm = make_farm(no_fly=((square(-89.005, 36.995, 0.001),),))
    write_missions(tmp_path, make_plan(farm, fleet, [[0, 1, 2], [4, 3]]))
    for name, route in (("drone-1", [0, 1, 2]), ("drone-2", [4, 3])):
        expected = [to_mavlink(item) for item in build_mission(int(name[-1]) - 1, farm, fleet, route).items]
        from_plan = mavsdk_mission_raw.import_qgroundcontrol_mission(str(tmp_path / f"{name}.plan"))
        assert len(from_plan.mission_items) == len(expected) + 1  # MAVSDK puts home first
        assert len(from_plan.geofence_items) == 8
        from_text = mavsdk_mission_raw.import_mission_planner_mission(str(tmp_path / f"{name}.waypoints"))
        for imported in (from_plan.mission_items, from_text.mission_items):
            assert (imported[0].command, imported[0].x, imported[0].y) == (16, 370_000_000, -890_000_000)
            for found, item in zip(imported[-len(expected) :], expected, strict=True):
                assert_same(found, item)


def assert_same(found: Any, expected: MavlinkItem) -> None:
    assert (found.command, found.frame, found.autocontinue) == (expected.command, expected.frame, 1)
    latitude, longitude, height = (param or 0.0 for param in expected.params[4:])
    assert (found.x, found.y) == (round(latitude * 1e7), round(longitude * 1e7))
    assert found.z == height
    for param, value in zip((found.param1, found.param2, found.param3, found.param4), expected.params, strict=False):
        assert param == value or (value is None and (math.isnan(param) or param == 0))


def time_at_ponds_s(mission: Mission) -> dict[str, float]:
    """Time on station at each pond as the items of a mission say it, by the measured laws: nothing of the fleet."""
    times: dict[str, float] = dict.fromkeys((item.pond_id for item in mission.items if item.pond_id), 0.0)
    height_m = 7.0
    for item in mission.items:
        if item.pond_id is None:
            continue
        if item.action is Action.WAYPOINT and item.height_m is not None:
            change_m, height_m = item.height_m - height_m, item.height_m
            times[item.pond_id] += change_m / 2.5 if change_m > 0 else -change_m / 1.5
            times[item.pond_id] += item.hold_s + (4.54 if item.height_m == 2.0 else 0.0)
        elif item.action is Action.LAND:
            times[item.pond_id] += 7.0 / 0.5 + 3.1
        elif item.action is Action.DELAY:
            times[item.pond_id] += item.hold_s
        elif item.action is Action.TAKEOFF:
            times[item.pond_id] += 4.0 + 7.0 / 2.5
    return times


@pytest.mark.parametrize("sampling", ["hover-dip", "splashdown"])
def test_a_ponds_own_time_on_station_is_flown_as_planned(sampling: SamplingStyle, tmp_path: Path) -> None:
    own_s = (None, 25.0, 30.4, 1000.7, 60.0)
    ponds = tuple(replace(pond, service_s=own) for pond, own in zip(make_farm().ponds, own_s, strict=True))
    farm_plan = make_plan(make_farm(ponds=ponds), Fleet(1, sampling=sampling), [[0, 1, 2, 3, 4]])
    plan, mission = farm_plan.plan, build_mission(0, farm_plan.farm, farm_plan.fleet, [0, 1, 2, 3, 4])
    planned = plan.departures_s[0] - plan.arrivals_s[0]
    assert list(time_at_ponds_s(mission).values()) == pytest.approx(planned)
    for pond, planned_s in zip(ponds, planned, strict=True):
        assert pond.service_s is None or planned_s == pytest.approx(pond.service_s, abs=0.5)
    write_missions(tmp_path, farm_plan)
    text = " ".join((tmp_path / "README.txt").read_text().split())
    longest_s = farm_plan.fleet.dwell_at(1000.7)
    assert f"of these {longest_s:g} s of sampling, at: P3." in text
    if sampling == "splashdown":
        assert "DISARM_DELAY 0:" in text


def test_the_wait_before_disarming_covers_the_longest_stay(tmp_path: Path) -> None:
    ponds = (*make_farm().ponds[:-1], replace(make_farm().ponds[-1], service_s=40.0))
    fleet = Fleet(2, sampling="splashdown")
    write_missions(tmp_path, make_plan(make_farm(ponds=ponds), fleet, [[0, 1, 2], [3, 4]]))
    assert parameters(tmp_path / "drone-1.param")["DISARM_DELAY"] == 2 * 5 + 30
    assert parameters(tmp_path / "drone-2.param")["DISARM_DELAY"] == 2 * fleet.dwell_at(40.0) + 30 > 40


@pytest.mark.parametrize(("sampling", "least_s"), [("hover-dip", 9.9), ("splashdown", 24.9)])
def test_less_time_on_station_than_sampling_takes_is_a_fault(sampling: SamplingStyle, least_s: float) -> None:
    ponds = make_farm().ponds

    def plan_with(*own_s: float) -> FarmPlan:
        changed = tuple(replace(pond, service_s=own) for pond, own in zip(ponds, own_s, strict=False))
        farm = make_farm(ponds=changed + ponds[len(own_s) :])
        return make_plan(farm, Fleet(1, sampling=sampling), [[0, 1, 2, 3, 4]])

    assert plan_with(least_s).plan.is_feasible
    for own_s, place in (((least_s, least_s - 0.1), "pond P1"), ((0.0, 0.5), "ponds P0, P1")):
        with pytest.raises(InvalidInput, match=f"^{place}: service_s is .* takes {least_s:g} s at least") as caught:
            plan_with(*own_s)
        assert len(caught.value.faults) == 1


def heights_of_ways(farm_plan: FarmPlan, tmp_path: Path) -> list[tuple[float, float]]:
    """Heights of the ways out and home of each drone, as its files say them."""
    write_missions(tmp_path, farm_plan)
    return [
        (
            parse_waypoints((tmp_path / f"drone-{number}.waypoints").read_text(), f"drone-{number}").items[0].height_m
            or 0.0,
            parameters(tmp_path / f"drone-{number}.param")["RTL_ALT"] / 100,
        )
        for number in range(1, len(farm_plan.plan.routes) + 1)
    ]


STACKED = {(3, 25.0), (5, 10.0), (5, 25.0)}
"""Where times alone would not keep the drones apart."""


@pytest.mark.parametrize("takeoff_interval_s", [0.0, 10.0, 25.0, 100.0, 300.0])
@pytest.mark.parametrize("num_drones", [2, 3, 5])
def test_ways_out_and_home_keep_their_distance(num_drones: int, takeoff_interval_s: float, tmp_path: Path) -> None:
    fleet = Fleet(num_drones, takeoff_interval_s=takeoff_interval_s)
    farm_plan = pondhop_plan(make_farm(), fleet, iterations=2000)
    assert farm_plan.is_feasible
    heights_m, plan = heights_of_ways(farm_plan, tmp_path), farm_plan.plan
    for one, (out_m, one_home_m) in enumerate(heights_m):
        for other, (other_out_m, home_m) in enumerate(heights_m):
            if one == other:
                continue
            assert abs(out_m - other_out_m) >= 3.0
            assert abs(one_home_m - home_m) >= 3.0
            out_end_s = one * takeoff_interval_s + plan.arrivals_s[one][0]
            home_start_s = other * takeoff_interval_s + plan.departures_s[other][-1]
            home_end_s = other * takeoff_interval_s + plan.route_durations_s[other]
            if one * takeoff_interval_s < home_end_s and home_start_s < out_end_s:
                assert abs(out_m - home_m) >= 3.0
    text = " ".join((tmp_path / "README.txt").read_text().split())
    assert ("all ways home lie above all ways out" in text) == farm_plan.are_layers_stacked
    assert farm_plan.are_layers_stacked == ((num_drones, takeoff_interval_s) in STACKED)


def test_drones_that_would_pass_too_near_are_not_flown(tmp_path: Path) -> None:
    # Drone 5 flies out at 19 m when drone 2 comes home at 18 m.
    farm_plan = make_plan(make_farm(), Fleet(5, takeoff_interval_s=25.0), [[0], [1], [2], [3], [4]])
    assert farm_plan.near_drones is not None
    with pytest.raises(InvalidInput, match=r"flies out while drone . comes home .* m above or below it"):
        write_missions(tmp_path, farm_plan)


def test_no_parameter_is_beyond_what_ardupilot_takes(tmp_path: Path) -> None:
    """Ranges of ArduPilot's parameter reference, at the ends of ours."""
    fastest = Fleet(
        num_drones=2,
        speed_m_s=20.0,
        return_speed_m_s=20.0,
        return_loiter_s=60.0,
        climb_speed_m_s=10.0,
        descent_speed_m_s=5.0,
        landing_speed_m_s=2.0,
        slow_landing_height_m=100.0,
        return_height_m=100.0,
    )
    farm_plan = make_plan(make_farm(), fastest, [[0, 1, 2], [4, 3]])
    assert any("speed_m_s 20 and return_speed_m_s 20" in note for note in farm_plan.notes)
    write_missions(tmp_path, farm_plan)
    most = {
        "WPNAV_SPEED": 2000,
        "RTL_SPEED": 2000,
        "RTL_LOIT_TIME": 60_000,
        "WPNAV_SPEED_UP": 1000,
        "WPNAV_SPEED_DN": 500,
        "LAND_SPEED": 200,
        "LAND_ALT_LOW": 10_000,
        "FENCE_RADIUS": 10_000,
        "FENCE_ALT_MAX": 1000,
    }
    found = parameters(tmp_path / "drone-2.param")
    assert {name for name, limit in most.items() if found[name] > limit} == set()


def test_a_pond_beyond_the_largest_fence_is_not_flown() -> None:
    def violations(north_deg: float) -> list[FarmViolation]:
        ponds = (Pond("near", (-89.0, 37.001)), Pond("far", (-89.0, 37.0 + north_deg)))
        farm_plan = make_plan(make_farm(ponds=ponds, fences=()), Fleet(2), [[0], [1]])
        return list(pondhop.missions.obstacles(farm_plan))

    assert violations(9_900 / 111_000) == []
    (found,) = violations(12_000 / 111_000)
    assert (found.kind, found.drone, found.limit) == ("too_far", 2, 9950.0)


def test_home_is_no_leg() -> None:
    # Home lies outside of the fence, and so do both ways.
    fence = (square(-89.0, 37.0015, 0.0007),)
    (rule,) = broken_rules(build(Fleet(num_drones=1), [2], fences=(fence,)), ARDUPILOT)
    assert "home and 2 of 2 legs are not inside it" in rule.fault.message
    assert (rule.value, rule.limit) == (2, 2)
