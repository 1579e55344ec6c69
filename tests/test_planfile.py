from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hand_made import make_farm, make_plan, square, two_drones
from pondhop import InvalidInput
from pondhop._core import separation
from pondhop.documents.schemas import load_schema
from pondhop.farm.model import Farm, Pond
from pondhop.files.plan_geojson import write_plan_geojson
from pondhop.files.plan_json import read_plan_json, write_plan_json
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

    schema: dict[str, Any] = closed(load_schema("plan-1"))
    return schema


def assert_equal(found: FarmPlan, expected: FarmPlan) -> None:
    assert (found.farm, found.fleet, found.fleet.assumptions) == (
        expected.farm,
        expected.fleet,
        expected.fleet.assumptions,
    )
    for name in ("planner", "seed", "elapsed_s", "lower_bound", "gap_percent", "separation"):
        assert getattr(found.solution, name) == getattr(expected.solution, name)
    assert found.solution.plan.routes == expected.solution.plan.routes
    assert np.array_equal(found.solution.plan.route_lengths, expected.solution.plan.route_lengths)
    assert found.solution.plan.violations == expected.solution.plan.violations


def test_the_shipped_schemas_are_schemas() -> None:
    for name in ("plan-1", "qgroundcontrol-plan"):
        jsonschema.Draft202012Validator.check_schema(load_schema(name))


def property_names(schema: Any) -> Iterator[str]:
    if isinstance(schema, dict):
        yield from schema.get("properties", {})
        for value in schema.values():
            yield from property_names(value)


def test_the_reference_names_every_property_of_the_schema() -> None:
    text = (Path(__file__).parents[1] / "docs" / "reference" / "json.md").read_text(encoding="utf-8")
    missing = [name for name in property_names(load_schema("plan-1")) if name not in text]
    assert missing == []


def test_a_written_plan_fits_the_schema_and_says_what_was_planned(tmp_path: Path) -> None:
    farm_plan = two_drones()
    content = written(tmp_path, farm_plan)
    jsonschema.validate(content, strict_schema())
    assert content["schema"] == "pondhop-plan/1"
    plan = farm_plan.solution.plan
    assert content["summary"]["max_route_length_m"] == plan.max_route_length
    assert content["gap_percent"] == pytest.approx(plan.max_route_length - 100)  # above a bound of 100 m
    first, second = content["routes"]
    assert (first["drone"], second["drone"]) == (1, 2)
    assert [stop["pond"] for stop in second["stops"]] == [4, 3]
    assert [stop["id"] for stop in second["stops"]] == ["P4", "P3"]
    for route in content["routes"]:
        legs = [stop["leg_length_m"] for stop in route["stops"]] + [route["return_leg_length_m"]]
        assert sum(legs) == pytest.approx(route["length_m"])
    # From the pond north-east of the depot to its neighbour 0.001 degrees of longitude west: 89 m at 37 degrees.
    stop = second["stops"][1]
    assert stop["leg_length_m"] == pytest.approx(89.0, abs=0.1)
    assert stop["arrival_s"] == pytest.approx(second["stops"][0]["departure_s"] + stop["leg_length_m"] / 5 + 3)
    assert content["fleet"]["assumptions"] == list(farm_plan.fleet.assumptions)


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
    measured = separation(farm_plan.solution.problem, farm_plan.solution.plan.routes)
    solution = replace(farm_plan.solution, separation=measured)
    farm_plan = replace(farm_plan, solution=solution)
    content = written(tmp_path, farm_plan)
    jsonschema.validate(content, strict_schema())
    assert content["unserved"] == [{"pond": 2, "id": "3"}]
    assert content["violations"] == ["pond 2 is not visited", "2 routes for 1 drones"]
    assert content["separation"] == {"overlap": 0.0, "num_crossings": 0}
    assert [note[:10] for note in content["notes"]] == ["A note.", "Splashdown"]
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
    farm_plan = replace(farm_plan, solution=replace(farm_plan.solution, lower_bound=0.0))
    assert written(tmp_path, farm_plan)["gap_percent"] is None
    assert read_plan_json(tmp_path / "plan.json").solution.gap_percent is None


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
    content["routes"][1]["stops"][0]["arrival_s"] = "soon"
    del content["fleet"]["speed_m_s"]
    faults = faults_of(tmp_path, content)
    assert set(faults) == {"schema", "farm.depot[1]", "routes[1].stops[0].arrival_s", "fleet"}
    assert faults["fleet"] == "'speed_m_s' is a required property"


def test_everything_that_the_evaluator_denies_is_told(tmp_path: Path) -> None:
    content = written(tmp_path, two_drones())
    content["summary"]["max_route_length_m"] -= 1
    content["routes"][1]["stops"][0]["departure_s"] += 5
    content["routes"][0]["stops"][2]["id"] = "P9"
    content["routes"][0]["drone"] = 2
    content["unserved"] = [{"pond": 0, "id": "P0"}]
    assert set(faults_of(tmp_path, content)) == {
        "summary.max_route_length_m",
        "routes[1].stops[0].departure_s",
        "routes[0].stops[2].id",
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
    content["routes"][0]["stops"][1]["pond"] = 5
    assert faults_of(tmp_path, content) == {"routes[0].stops[1].pond": "there is no pond 5"}


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

    monkeypatch.setattr(Path, "write_text", full)
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
