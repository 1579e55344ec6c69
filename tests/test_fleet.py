"""Fleet files and the time on station."""

import math
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pondhop.errors import InvalidInput
from pondhop.fleet import Fleet, read_fleet
from pondhop.fleet.model import setting_faults
from pondhop.fleet.settings import NUMBERS


def faults_of(path: Path) -> list[tuple[str, str]]:
    with pytest.raises(InvalidInput) as caught:
        read_fleet(path)
    return [(fault.path, fault.action) for fault in caught.value.faults]


def test_a_hover_dip_takes_what_was_measured() -> None:
    assert Fleet(3, dwell_s=5.0).service_s == pytest.approx(14.87, abs=0.01)


def test_a_splashdown_takes_what_was_measured() -> None:
    assert Fleet(3, sampling="splashdown", dwell_s=5.0).service_s == pytest.approx(17.1 + 5.0 + 6.8)


def test_a_metre_of_height_costs_descent_and_climb() -> None:
    # 1/1.5 s down and 1/2.5 s up for a hover dip, 1/0.5 s down for a landing.
    assert Fleet(1, transit_height_m=8.0).service_s - Fleet(1).service_s == pytest.approx(2 / 3 + 0.4)
    splashdown = Fleet(1, sampling="splashdown")
    assert replace(splashdown, transit_height_m=8.0).service_s - splashdown.service_s == pytest.approx(2.4)


def test_dipping_lower_takes_longer() -> None:
    assert Fleet(1, dip_height_m=1.0).service_s - Fleet(1).service_s == pytest.approx(2 / 3 + 0.4)
    splashdown = Fleet(1, sampling="splashdown")
    assert replace(splashdown, dip_height_m=1.0).service_s == splashdown.service_s


def test_a_dip_above_the_transit_height_is_refused() -> None:
    with pytest.raises(InvalidInput, match="dip_height_m: 7 m is not below"):
        Fleet(1, dip_height_m=7.0)
    assert Fleet(1, dip_height_m=7.0, sampling="splashdown").dip_height_m == 7.0


@given(st.floats(2.1, 121.9), st.integers(1, 600), st.sampled_from(["hover-dip", "splashdown"]))
def test_time_on_station_exceeds_the_dwell(height_m: float, dwell_s: int, sampling: str) -> None:
    fleet = Fleet(1, transit_height_m=height_m, dwell_s=dwell_s, sampling=sampling)  # type: ignore[arg-type]
    assert fleet.service_s > dwell_s


def test_what_the_file_leaves_out_is_an_assumption(tmp_path: Path) -> None:
    path = tmp_path / "fleet.toml"
    path.write_text('num_drones = 3\nspeed_m_s = 5.0\nsampling = "splashdown"\nmax_route_duration_s = 900\n')
    fleet = read_fleet(path)
    assert fleet == Fleet(3, sampling="splashdown", max_route_duration_s=900)
    assert fleet.assumptions == ("transit_height_m", "dwell_s", "dip_height_m")
    assert replace(fleet, dwell_s=9.0).assumptions == ("transit_height_m", "dip_height_m")


def test_a_fleet_made_directly_assumes_its_defaults() -> None:
    assert Fleet(3, leg_stop_s=4.0).assumptions == (
        "speed_m_s",
        "transit_height_m",
        "sampling",
        "dwell_s",
        "dip_height_m",
    )


def test_every_fault_is_named_at_once(tmp_path: Path) -> None:
    path = tmp_path / "fleet.toml"
    path.write_text('sped_m_s = 5\ndwell_s = "long"\ntransit_height_m = 400\nsampling = "bucket"\nleg_stop_s = nan\n')
    faults = dict(faults_of(path))
    assert list(faults) == ["sped_m_s", "num_drones", "dwell_s", "transit_height_m", "sampling", "leg_stop_s"]
    assert faults["sped_m_s"] == "did you mean speed_m_s?"


def test_faults_of_several_settings_are_named_with_the_others(tmp_path: Path) -> None:
    path = tmp_path / "fleet.toml"
    path.write_text(
        "num_drones = 60\ndwell_s = 0.4\nspeed_m_s=0\ndip_height_m = 9\nlayer_spacing_m = 3\nreserve_percent = -1\nx=1"
    )
    found = [place for place, _ in faults_of(path)]
    assert found == ["x", "dwell_s", "speed_m_s", "reserve_percent", "dip_height_m", "layer_spacing_m"]
    # Nothing is said of settings together of which one is wrong for itself.
    path.write_text("dwell_s = 0\nsampling = 3\ndip_height_m = 1000\nlayer_spacing_m = 50\nreturn_height_m = -1\n")
    found = [place for place, _ in faults_of(path)]
    assert found == ["num_drones", "sampling", "dip_height_m", "return_height_m"]


@pytest.mark.parametrize("value", ["0", "-1", "2.5", "true", '"three"', "[1]", "99999999"])
def test_the_number_of_drones_is_a_sensible_whole_number(tmp_path: Path, value: str) -> None:
    path = tmp_path / "fleet.toml"
    path.write_text(f"num_drones = {value}\n")
    assert [place for place, _ in faults_of(path)] == ["num_drones"]


def test_a_fleet_made_directly_is_checked_too() -> None:
    with pytest.raises(InvalidInput) as caught:
        Fleet(0, speed_m_s=-1.0)
    assert [fault.path for fault in caught.value.faults] == ["num_drones", "speed_m_s"]


def test_a_missing_file_and_a_folder_are_faults(tmp_path: Path) -> None:
    assert len(faults_of(tmp_path)) == 1
    assert len(faults_of(tmp_path / "absent.toml")) == 1


@given(content=st.binary(max_size=200))
def test_any_bytes_give_a_fleet_or_faults(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.mktemp("fleets") / "fleet.toml"
    path.write_bytes(content)
    num_faults = num_drones = 0
    try:
        num_drones = read_fleet(path).num_drones
    except InvalidInput as error:
        num_faults = len(error.faults)
    assert (num_faults > 0) != (num_drones > 0)


@pytest.mark.parametrize(
    ("settings", "path", "message"),
    [
        ({"dwell_s": 0.4}, "dwell_s", "no whole number of seconds"),
        ({"dwell_s": 0.0, "sampling": "splashdown"}, "dwell_s", "no stay"),
        ({"num_drones": 40, "layer_spacing_m": 3.0}, "layer_spacing_m", "comes home at 132 m"),
        ({"layer_spacing_m": 1.9}, "layer_spacing_m", "it is 1.9"),
        ({"battery_wh": 0.0}, "battery_wh", "it is 0.0"),
        ({"reserve_percent": 99.0}, "reserve_percent", "it is 99.0"),
    ],
)
def test_one_wrong_setting_is_one_fault(settings: dict[str, Any], path: str, message: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        Fleet(**{"num_drones": 3} | settings)
    (fault,) = caught.value.faults
    assert fault.path == path
    assert message in fault.message


def test_the_reserve_is_taken_once() -> None:
    fleet = Fleet(1, battery_wh=100.0, reserve_percent=20.0, health_percent=90.0)
    assert fleet.usable_energy_j == pytest.approx(100 * 3600 * 0.9 * 0.8)
    assert Fleet(1).usable_energy_j == math.inf


def test_drones_come_home_in_layers_of_their_own() -> None:
    layers = Fleet(4).layers(10)
    assert [layers.way_home_height_m(drone) for drone in range(4)] == [15.0, 18.0, 21.0, 24.0]
    assert [layers.way_out_height_m(drone) for drone in range(3)] == [7.0, 10.0, 13.0]
    # No autopilot descends for the way home; layers are 2 m apart at least, whatever there is room for.
    assert Fleet(2, transit_height_m=30.0).layers(2).way_home_m == 30.0
    assert Fleet(50).layers(50).way_home_height_m(49) == pytest.approx(121.9)
    assert Fleet(60).layers(20).spacing_m == 3.0
    with pytest.raises(
        InvalidInput,
        match=r"come home 2 m above each other: the highest at 123 m .fly at most 54 drones, 2 m apart, or lower",
    ):
        Fleet(10_000).layers(55)
    with pytest.raises(
        InvalidInput, match=r"the highest at 125.9 m .fly one drone, or lower .* nothing may fly above 121.9 m"
    ):
        Fleet(3, transit_height_m=121.9).layers(6)
    assert Fleet(3, transit_height_m=121.9).layers(1).way_home_m == 121.9
    # Drones that cannot fly for want of ponds need no layers.
    assert Fleet(100).layers(4) == Fleet(4).layers(4)
    assert len(Fleet(100).layer_costs(4)) == 4


def test_each_layer_costs_a_climb_and_a_descent_each_way() -> None:
    fleet = Fleet(3)
    costs = fleet.layer_costs(5)
    assert costs[0][:2] == (fleet.takeoff_s, fleet.way_home_fixed_s)
    assert costs[0][2:] == (fleet.energy.takeoff_j, fleet.energy.way_home_fixed_j)
    for drone in (1, 2):
        # 3 m more take 3 / 2.5 s up and 3 / 1.5 s down.
        assert [cost - lowest for cost, lowest in zip(costs[drone][:2], costs[0][:2], strict=True)] == pytest.approx(
            [drone * (3 / 2.5 + 3 / 1.5)] * 2
        )


def test_the_remedy_for_layers_too_high_is_one() -> None:
    for settings, remedy in (
        ({"num_drones": 40, "layer_spacing_m": 3.0}, "give at most 2.7 m: "),
        (
            {"num_drones": 60, "layer_spacing_m": 3.0},
            "fly at most 54 drones, 2 m apart, or lower (transit_height_m, return_height_m): ",
        ),
        (
            {"num_drones": 3, "layer_spacing_m": 3.0, "transit_height_m": 121.9},
            "fly one drone, or lower (transit_height_m, return_height_m): ",
        ),
    ):
        with pytest.raises(InvalidInput) as caught:
            Fleet(**settings)  # type: ignore[arg-type]
        (fault,) = caught.value.faults
        assert fault.action.startswith(remedy)


@pytest.mark.parametrize("kind", [np.int8, np.int64, np.uint16])
def test_whole_numbers_of_numpy_are_numbers(kind: type[np.integer[Any]]) -> None:
    fleet = Fleet(kind(3), speed_m_s=kind(6))  # type: ignore[arg-type]
    assert fleet == Fleet(3, speed_m_s=6)
    assert type(fleet.num_drones) is int


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64, np.longdouble])
def test_real_numbers_of_numpy_are_numbers(kind: type[np.floating[Any]]) -> None:
    assert Fleet(3, speed_m_s=kind(5.1)) == Fleet(3, speed_m_s=5.1)  # type: ignore[arg-type]
    for wrong in (kind("nan"), kind("inf")):
        with pytest.raises(InvalidInput, match="speed_m_s"):
            Fleet(3, speed_m_s=wrong)  # type: ignore[arg-type]


def test_a_truth_value_of_numpy_and_none_are_no_numbers() -> None:
    for wrong in (np.True_, None):
        with pytest.raises(InvalidInput, match="num_drones"):
            Fleet(wrong)  # type: ignore[arg-type]
    with pytest.raises(InvalidInput, match="speed_m_s"):
        Fleet(3, speed_m_s=None)  # type: ignore[arg-type]


def test_every_setting_has_a_range_and_a_source() -> None:
    names = {item.name for item in fields(Fleet)} - {"assumptions", "sampling", "start", "end"}
    assert names == set(NUMBERS)
    for name in names:
        default = getattr(Fleet(1), name)
        assert default is None or NUMBERS[name].least <= default <= NUMBERS[name].most


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [
        ("num_drones", 1, 10_000),
        ("speed_m_s", 0.1, 20.0),
        ("transit_height_m", 1.0, 121.9),
        ("return_speed_m_s", 0.1, 20.0),
        ("return_height_m", 1.0, 121.9),
        ("climb_speed_m_s", 0.1, 10.0),
        ("descent_speed_m_s", 0.1, 5.0),
        ("landing_speed_m_s", 0.3, 2.0),
        ("slow_landing_height_m", 1.0, 100.0),
        ("return_loiter_s", 0.0, 60.0),
        ("dwell_s", 0.0, 3_600.0),
        ("reserve_percent", 0.0, 95.0),
        ("health_percent", 1.0, 100.0),
    ],
)
def test_the_ranges_of_settings_end_where_they_are_said_to(name: str, least: float, most: float) -> None:
    assert setting_faults({name: least}) == setting_faults({name: most}) == []
    step = 1 if name == "num_drones" else 0.01
    for beyond in (least - step, most + step):
        assert [fault.path for fault in setting_faults({name: beyond})] == [name]
