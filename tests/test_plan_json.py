from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hand_made import make_farm, make_plan, square, two_drones
from pondhop import InvalidInput, plan
from pondhop._core import separation
from pondhop.documents import atomic
from pondhop.documents.schemas import load_schema
from pondhop.farm.model import Farm, Pond
from pondhop.files.plan_geojson import write_plan_geojson
from pondhop.files.plan_json import ROUND_KEYS, read_plan_json, write_plan_json
from pondhop.fleet import Fleet
from pondhop.solution import FarmPlan


def written(tmp_path: Path, farm_plan: FarmPlan) -> dict[str, Any]:
    path = tmp_path / "plan.json"
    write_plan_json(path, farm_plan)
    content: dict[str, Any] = json.loads(path.read_text())
    return content


def strict_schema() -> dict[str, Any]:
    """The shipped schema, which lets later versions add properties, without that leave."""

    def closed(value: Any) -> Any:
        if isinstance(value, list):
            return [closed(item) for item in value]
        if not isinstance(value, dict):
            return value
        copy = {key: closed(item) for key, item in value.items()}
        return copy | {"additionalProperties": False} if "properties" in copy and "type" in copy else copy

    schema: dict[str, Any] = closed(load_schema("plan-2"))
    return schema


def assert_equal(found: FarmPlan, expected: FarmPlan) -> None:
    assert (found.farm, found.fleet, found.fleet.assumptions) == (
        expected.farm,
        expected.fleet,
        expected.fleet.assumptions,
    )
    for name in ("planner", "seed", "reason", "is_interrupted", "lower_bound_s", "gap_s_percent", "separation"):
        assert getattr(found.solution, name) == getattr(expected.solution, name)
    assert found.plan.routes == expected.plan.routes
    assert np.array_equal(found.plan.route_lengths, expected.plan.route_lengths)
    assert found.plan.violations == expected.plan.violations
    assert found.violations == expected.violations


def test_the_shipped_schemas_are_schemas() -> None:
    for name in ("plan-1", "plan-2", "qgroundcontrol-plan"):
        jsonschema.Draft202012Validator.check_schema(load_schema(name))


def property_names(schema: Any) -> Iterator[str]:
    if isinstance(schema, dict):
        yield from schema.get("properties", {})
        for value in schema.values():
            yield from property_names(value)


def test_the_reference_names_every_property_of_the_schema() -> None:
    text = (Path(__file__).parents[1] / "docs" / "reference" / "json.md").read_text(encoding="utf-8")
    missing = [name for name in property_names(load_schema("plan-2")) if name not in text]
    assert missing == []


def test_a_written_plan_fits_the_schema_and_says_what_was_planned(tmp_path: Path) -> None:
    farm_plan = two_drones()
    content = written(tmp_path, farm_plan)
    jsonschema.validate(content, strict_schema())
    assert content["schema"] == "pondhop-plan/2"
    plan, fleet = farm_plan.solution.plan, farm_plan.fleet
    assert content["summary"]["makespan_s"] == plan.makespan_s
    assert content["gap_percent"] == pytest.approx(plan.makespan_s - 100)  # above a bound of 100 s
    first, second = content["routes"]
    assert (first["drone"], second["drone"]) == (1, 2)
    (trip,) = second["trips"]
    assert [stop["pond"] for stop in trip["stops"]] == [4, 3]
    assert [stop["id"] for stop in trip["stops"]] == ["P4", "P3"]
    # The second drone takes off some seconds after the first, and all its times are told by one clock.
    assert trip["departure_s"] == fleet.takeoff_interval_s
    assert trip["arrival_s"] == pytest.approx(fleet.takeoff_interval_s + second["duration_s"])
    assert content["summary"]["all_back_s"] == max(route["trips"][0]["arrival_s"] for route in content["routes"])
    for route in content["routes"]:
        (trip_of_route,) = route["trips"]
        legs = [stop["leg_length_m"] for stop in trip_of_route["stops"]] + [trip_of_route["return_leg_length_m"]]
        assert sum(legs) == pytest.approx(route["length_m"])
        assert sum(route["energy_by_phase_wh"].values()) == pytest.approx(route["energy_wh"])
    # From the pond north-east of the depot to its neighbour 0.001 degrees of longitude west: 89 m at 37 degrees.
    stop = trip["stops"][1]
    assert stop["leg_length_m"] == pytest.approx(89.0, abs=0.1)
    flown_s = stop["leg_length_m"] / fleet.speed_m_s + fleet.stop_s
    assert stop["arrival_s"] == pytest.approx(trip["stops"][0]["departure_s"] + flown_s)
    assert content["fleet"]["assumptions"] == list(fleet.assumptions)
    assert "elapsed_s" not in content


def test_every_field_of_farm_and_fleet_is_in_the_file(tmp_path: Path) -> None:
    content = written(tmp_path, two_drones())
    assert {field.name for field in fields(Farm)} == set(content["farm"])
    # What only rounds of trips have stands in files of rounds alone.
    assert {field.name for field in fields(Pond)} - {"time_windows", "priority"} == set(content["farm"]["ponds"][0])
    assert {field.name for field in fields(Fleet)} - set(ROUND_KEYS) == set(content["fleet"])
    night = written(tmp_path, plan(make_farm(), Fleet(2, swap_s=240.0), iterations=50))
    assert {field.name for field in fields(Pond)} == set(night["farm"]["ponds"][0])
    assert {field.name for field in fields(Fleet)} == set(night["fleet"])


def test_energy_left_and_energy_home_are_told_at_every_stop(tmp_path: Path) -> None:
    farm_plan = make_plan(make_farm(), Fleet(num_drones=1, battery_wh=200, reserve_percent=25), [[0, 1, 2, 3, 4]])
    (route,) = written(tmp_path, farm_plan)["routes"]
    (trip,) = route["trips"]
    assert trip["usable_energy_wh"] == pytest.approx(150.0)
    left = [stop["energy_left_wh"] for stop in trip["stops"]]
    assert left == sorted(left, reverse=True)
    # What is left after the last stop is for the way home, and what then remains is what the route does not take.
    remaining = left[-1] - trip["stops"][-1]["energy_home_wh"]
    assert remaining == pytest.approx(150.0 - route["energy_wh"])


RELEASES = Path(__file__).parent / "data" / "releases"


@pytest.mark.parametrize("name", sorted(path.name for path in RELEASES.glob("plan-*.json")))
def test_a_file_of_every_released_version_stays_readable(name: str) -> None:
    content = json.loads((RELEASES / name).read_text())
    farm_plan = read_plan_json(RELEASES / name)
    assert [pond.id for pond in farm_plan.farm.ponds] == [pond["id"] for pond in content["farm"]["ponds"]]
    assert farm_plan.fleet.sampling == content["fleet"]["sampling"]
    assert farm_plan.plan.makespan_s == pytest.approx(content["summary"]["makespan_s"])
    assert farm_plan.is_feasible is content["summary"]["is_feasible"]


def test_the_file_of_0_1_0_has_its_own_times_and_a_note() -> None:
    farm_plan = read_plan_json(RELEASES / "plan-0.1.0.json")
    # Landing 7 / 0.5 + 2.4, dwell 8, climb 6.7 s; legs d / 5 + 3 s; no take-off, no way home.
    assert farm_plan.solution.problem.service_durations_s.tolist()[1] == pytest.approx(16.4 + 8 + 6.7)
    assert farm_plan.plan.makespan_s == pytest.approx(349.612, abs=1e-3)
    assert [violation.kind for violation in farm_plan.violations] == ["too_slow", "too_slow"]
    assert "version 0.1" in farm_plan.notes[-1]


def test_a_plan_with_everything_survives_the_round_trip(tmp_path: Path) -> None:
    ponds = (
        Pond("Küstenteich 1", (-89.001, 37.001), (square(-89.001, 37.001, 0.0004), square(-89.001, 37.001, 0.0001))),
        Pond("2", (-89.000123456789, 37.002), (), 61.5),
        Pond("3", (-89.0, 37.003)),
    )
    farm = make_farm(
        ponds=ponds, no_fly=((square(-89.005, 37.005, 0.001),),), stations=((-89.0, 37.0),), notes=("A note.",)
    )
    fleet = Fleet(num_drones=1, sampling="splashdown", max_route_length_m=500, max_route_duration_s=1e5)
    farm_plan = make_plan(farm, fleet, [[0], [1]])
    measured = separation(farm_plan.solution.problem, farm_plan.plan.routes)
    solution = replace(farm_plan.solution, separation=measured)
    farm_plan = replace(farm_plan, solution=solution)
    content = written(tmp_path, farm_plan)
    jsonschema.validate(content, strict_schema())
    assert [(item["pond"], item["id"]) for item in content["unserved"]] == [(2, "3")]
    assert [(item["kind"], item["message"]) for item in content["violations"]] == [
        ("unserved", "pond 3 is not visited"),
        ("too_many_routes", "there are 2 routes for 1 drone"),
    ]
    assert content["separation"] == {"overlap": 0.0, "num_crossings": 0, "num_depot_leg_crossings": 0}
    assert content["notes"] == ["A note."]
    assert_equal(read_plan_json(tmp_path / "plan.json"), farm_plan)


@st.composite
def farm_plans(draw: st.DrawFn) -> FarmPlan:
    positions = st.tuples(st.floats(-89.02, -89.0), st.floats(37.0, 37.02))
    places = draw(st.lists(positions, min_size=1, max_size=12))
    farm = Farm(draw(st.text(max_size=5)), tuple(Pond(str(i), place) for i, place in enumerate(places)), (-89.0, 37.0))
    order = draw(st.permutations(range(len(places))))
    cut = draw(st.integers(0, len(places)))
    fleet = Fleet(num_drones=2, speed_m_s=draw(st.floats(0.5, 20)), dwell_s=draw(st.integers(1, 60)))
    return make_plan(farm, fleet, [list(order[:cut]), list(order[cut:])])


@settings(max_examples=40, deadline=None)
@given(farm_plan=farm_plans())
def test_any_plan_survives_the_round_trip(farm_plan: FarmPlan, tmp_path_factory: pytest.TempPathFactory) -> None:
    tmp_path = tmp_path_factory.mktemp("plan")
    jsonschema.validate(written(tmp_path, farm_plan), strict_schema())
    assert_equal(read_plan_json(tmp_path / "plan.json"), farm_plan)


def test_a_bound_of_zero_has_no_gap(tmp_path: Path) -> None:
    farm_plan = two_drones()
    farm_plan = replace(farm_plan, solution=replace(farm_plan.solution, known_lower_bound_s=0.0))
    assert written(tmp_path, farm_plan)["gap_percent"] is None


def faults_of(tmp_path: Path, content: dict[str, Any]) -> dict[str, str]:
    path = tmp_path / "changed.json"
    path.write_text(json.dumps(content))
    with pytest.raises(InvalidInput) as error:
        read_plan_json(path)
    assert all(fault.action for fault in error.value.faults)
    return {fault.path: fault.message for fault in error.value.faults}


def test_everything_that_breaks_the_schema_is_told(tmp_path: Path) -> None:
    content = written(tmp_path, two_drones())
    content["schema"] = "pondhop-plan/9"
    content["farm"]["depot"] = [-89.0, 137.0]
    content["routes"][1]["trips"][0]["stops"][0]["arrival_s"] = "soon"
    del content["fleet"]["speed_m_s"]
    faults = faults_of(tmp_path, content)
    assert set(faults) == {"schema", "farm.depot[1]", "routes[1].trips[0].stops[0].arrival_s", "fleet"}
    assert faults["fleet"] == "'speed_m_s' is a required property"


def test_everything_that_the_evaluator_denies_is_told(tmp_path: Path) -> None:
    content = written(tmp_path, two_drones())
    content["summary"]["max_route_length_m"] -= 1
    content["routes"][1]["trips"][0]["stops"][0]["departure_s"] += 5
    content["routes"][0]["trips"][0]["stops"][2]["id"] = "P9"
    content["routes"][0]["drone"] = 2
    content["unserved"] = [{"pond": 0, "id": "P0", "reason": "", "remedies": []}]
    assert set(faults_of(tmp_path, content)) == {
        "summary.max_route_length_m",
        "routes[1].trips[0].stops[0].departure_s",
        "routes[0].trips[0].stops[2].id",
        "routes[0].drone",
        "unserved",
    }


def test_numbers_rounded_to_millimetres_are_accepted(tmp_path: Path) -> None:
    content = written(tmp_path, two_drones())
    for route in content["routes"]:
        route["length_m"] = round(route["length_m"], 3)
    (tmp_path / "rounded.json").write_text(json.dumps(content))
    assert_equal(read_plan_json(tmp_path / "rounded.json"), two_drones())


def test_a_pond_that_does_not_exist_is_told(tmp_path: Path) -> None:
    content = written(tmp_path, two_drones())
    content["routes"][0]["trips"][0]["stops"][1]["pond"] = 5
    assert faults_of(tmp_path, content) == {"routes[0].trips[0].stops[1].pond": "there is no pond 5"}


def test_a_fleet_out_of_range_is_told_with_its_place(tmp_path: Path) -> None:
    content = written(tmp_path, two_drones())
    content["fleet"]["speed_m_s"] = 1000.0
    assert set(faults_of(tmp_path, content)) == {"fleet.speed_m_s"}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "line 1, column 1"),
        (b"{]", "line 1, column 2"),
        (b'{"seed": NaN}', "NaN"),
        (b'{"seed": 1e999}', "too large"),
        (b'{"seed": ' + b"9" * 5000 + b"}", "cannot be parsed"),
        (b"\xff\xfe", "UTF-8"),
        (b"[]", "not of type 'object'"),
        (b"[" * 100_000, "cannot be parsed"),
    ],
    ids=["empty", "broken", "nan", "infinite", "long number", "binary", "list", "deep"],
)
def test_what_is_no_plan_is_refused(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "plan.json"
    path.write_bytes(content)
    with pytest.raises(InvalidInput, match=message):
        read_plan_json(path)


def test_a_plan_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "plan.json"
    path.write_text("the plan of yesterday")

    def full(*_arguments: object, **_options: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(atomic, "_write", full)
    with pytest.raises(OSError, match="disk full"):
        write_plan_json(path, two_drones())
    assert path.read_bytes() == b"the plan of yesterday"
    assert list(tmp_path.iterdir()) == [path]


def features(content: dict[str, Any], role: str) -> Iterator[dict[str, Any]]:
    return (feature for feature in content["features"] if feature["properties"]["role"] == role)


def test_the_geojson_holds_depot_routes_and_stops(tmp_path: Path) -> None:
    path = tmp_path / "plan.geojson"
    write_plan_geojson(path, two_drones())
    content = json.loads(path.read_text())
    assert content["type"] == "FeatureCollection"
    (depot,) = features(content, "depot")
    assert depot["geometry"] == {"type": "Point", "coordinates": [-89.0, 37.0]}
    first, second = features(content, "route")
    assert second["geometry"]["type"] == "LineString"
    assert second["geometry"]["coordinates"] == [
        [-89.0, 37.0],
        [-89.002 + 0.004, 37.001],
        [-89.002 + 0.003, 37.001],
        [-89.0, 37.0],
    ]
    assert first["properties"]["stroke"] != second["properties"]["stroke"]
    stops = list(features(content, "stop"))
    assert [(stop["properties"]["drone"], stop["properties"]["order"]) for stop in stops] == [
        (1, 1),
        (1, 2),
        (1, 3),
        (2, 1),
        (2, 2),
    ]
    assert stops[4]["properties"]["id"] == "P3"
    assert stops[4]["properties"]["marker-color"] == second["properties"]["stroke"]
    assert stops[4]["properties"]["arrival_s"] < stops[4]["properties"]["departure_s"]


def test_the_geojson_is_read_by_gdal(tmp_path: Path) -> None:
    pyogrio = pytest.importorskip("pyogrio", reason="pyogrio is not installed")
    path = tmp_path / "plan.geojson"
    write_plan_geojson(path, two_drones())
    assert pyogrio.read_info(path)["features"] == 8
