"""Farm files of every format, whole and broken."""

from __future__ import annotations

import json
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from pondhop import Fault, InvalidInput, LocalFrame
from pondhop.farm import Farm, Pond, read_farm, write_farm
from pondhop.farm.features import clean_text
from pondhop.fleet import Fleet

ROOT = Path(__file__).parents[1]
BROKEN = Path(__file__).parent / "data" / "broken"
SHARED_FARMS = ROOT.parent / "shared" / "data" / "farms"
DEPOT = (-89.46, 37.705)

needs_shared_farms = pytest.mark.skipif(
    not SHARED_FARMS.is_dir(), reason="the development data ../shared/data/farms is not here"
)


def faults_of(path: Path, depot: tuple[float, float] | None = None) -> list[tuple[str, str, str]]:
    with pytest.raises(InvalidInput) as caught:
        read_farm(path, depot=depot)
    return [(fault.path, fault.message, fault.action) for fault in caught.value.faults]


def square(lon: float, lat: float, side_deg: float = 0.001) -> list[list[float]]:
    east, north = lon + side_deg, lat + side_deg
    return [[lon, lat], [east, lat], [east, north], [lon, north], [lon, lat]]


def feature(kind: str, coordinates: object, **properties: object) -> dict[str, object]:
    return {"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": coordinates}}


def write_geojson(path: Path, *features: dict[str, object], **members: object) -> Path:
    path.write_text(json.dumps({"type": "FeatureCollection", **members, "features": list(features)}))
    return path


DEPOT_FEATURE = feature("Point", list(DEPOT), role="depot")

# ------------------------------------------------------------------------------------------------ broken files

BROKEN_FILES = {
    "bad_sampling_point.geojson": [("features[0].properties.sampling_point", "no position")],
    "bad_wkt.csv": [("line 2, column wkt", "no WKT"), ("line 3, column wkt", "no WKT")],
    "crossing.geojson": [("features[1]", "crosses or touches itself at -89.459500, 37.701500")],
    "cut_off.kml": [("cut_off.kml", "unclosed token")],
    "duplicate_ids.geojson": [("features[1]", "id 'a' is already that of features[0]")],
    "empty.geojson": [("empty.geojson", "empty")],
    "exchanged.csv": [("all 2 features", "exchanged"), ("file", "no depot")],
    "exchanged.geojson": [("all 3 features", "exchanged")],
    "exchanged_one.geojson": [("features[1]", "exchanged")],
    "far_depot.geojson": [("depot", "1483 km")],
    "far_pond.geojson": [("features[2]", "304 km")],
    "far_sampling_point.geojson": [("features[0].properties.sampling_point", "11.0 km outside")],
    "features_no_list.geojson": [("features", "missing")],
    "garbage.csv": [("garbage.csv", "no text")],
    "garbage.fgb": [("garbage.fgb", "known format")],
    "garbage.geojson": [("garbage.geojson", "no text")],
    "garbage.gpkg": [("garbage.gpkg", "known format")],
    "garbage.kml": [("garbage.kml", "known format")],
    "garbage.kmz": [("garbage.kmz", "known format")],
    "garbage.shp": [("garbage.shp", "known format")],
    "garbage.zip": [("garbage.zip", "known format")],
    "latitude_137.geojson": [("features[1]", "latitude 137")],
    "list.geojson": [("file", "a JSON list is no GeoJSON")],
    "many_faults.geojson": [
        ("features[0]", "latitude 137"),
        ("features[1].properties.service_s", "'long'"),
        ("features[3]", "id 'c'"),
        ("file", "no depot"),
    ],
    "metres.geojson": [("features[0]", "metres")],
    "no_area.geojson": [("features[1]", "no area")],
    "no_columns.csv": [("line 1", "columns pond, east, north")],
    "no_depot.geojson": [("file", "no depot")],
    "no_features.geojson": [("file", "no feature")],
    "no_geometry.geojson": [("features[1]", "no geometry")],
    "no_header.csv": [("line 1", "numbers")],
    "no_placemark.kml": [("file", "no feature")],
    "not_a_number.geojson": [("features[1].geometry.coordinates[0][1][0]", "NaN")],
    "not_json.geojson": [("line 1, column 1", "no JSON")],
    "only_depot.geojson": [("file", "no pond")],
    "only_header.csv": [("file", "no line but the first")],
    "open_line.geojson": [("features[1]", "open line")],
    "open_quote.csv": [("file", "no table")],
    "text.csv": [
        ("line 3, column lon", "'west'"),
        ("line 3, column lat", "empty"),
        ("line 4", "4 values for 3 columns"),
        ("file", "no depot"),
    ],
    "text_for_number.geojson": [
        ("features[1].geometry.coordinates[0][0][0]", "west"),
        ("features[1].geometry.coordinates[0][3][0]", "west"),
    ],
    "text_service.geojson": [("features[0].properties.service_s", "'long'")],
    "three_corners.csv": [("line 1", "lon of corner lr, lat of corner lr")],
    "truncated.geojson": [("line 3, column 67", "ends too early")],
    "two_corners.geojson": [("features[1]", "2 different corners")],
    "two_depots.geojson": [("features[3]", "second depot")],
    "two_latitudes.csv": [("line 1", "'lat' and 'latitude'")],
    "unknown_crs.geojson": [("crs", "EPSG:99999999")],
    "unknown_geometry.geojson": [("features[1].geometry", "Circle")],
    "unknown_role.geojson": [("features[1].properties.role", "'depott'"), ("file", "no depot")],
    "wide_pond.geojson": [("features[1]", "111 km across")],
    "wrong_type.geojson": [("file", "'Topology'")],
}


def test_every_broken_file_is_tested() -> None:
    assert sorted(BROKEN_FILES) == sorted(path.name for path in BROKEN.iterdir())


@pytest.mark.parametrize("name", BROKEN_FILES)
def test_a_broken_file_is_answered_with_all_its_faults(name: str) -> None:
    faults = faults_of(BROKEN / name)
    assert len(faults) == len(BROKEN_FILES[name])
    for (path, message, action), (expected_path, expected_message) in zip(faults, BROKEN_FILES[name], strict=True):
        assert path.removeprefix(f"{BROKEN}/") == expected_path
        assert expected_message in message
        assert action


def test_a_missing_depot_is_remedied_on_the_command_line() -> None:
    [(_, _, action)] = faults_of(BROKEN / "no_depot.geojson")
    assert action == "pass --depot LON,LAT, or name a point Depot: 2 ponds lie around -89.459500,37.702500"
    assert read_farm(BROKEN / "no_depot.geojson", depot=DEPOT).depot == DEPOT


def test_a_missing_file_and_a_folder_are_faults(tmp_path: Path) -> None:
    assert "no such file" in faults_of(tmp_path / "absent.kml")[0][1]
    assert "folder" in faults_of(tmp_path)[0][1]


def test_a_depot_with_exchanged_coordinates_gets_a_hint() -> None:
    assert "exchanged" in faults_of(BROKEN / "no_depot.geojson", depot=(37.705, -89.46))[0][1]


def test_an_exchanged_depot_that_is_a_place_on_earth_gets_a_hint(tmp_path: Path) -> None:
    path = write_geojson(tmp_path / "farm.geojson", feature("Point", [10.0, 60.0]))
    [(place, _, action)] = faults_of(path, depot=(60.0, 10.0))
    assert place == "depot"
    assert "exchanged" in action


def test_deeply_nested_json_and_endless_numbers_are_faults(tmp_path: Path) -> None:
    (tmp_path / "deep.json").write_text("[" * 100_000)
    (tmp_path / "long.json").write_text("1" * 10_000)
    assert "nested too deeply" in faults_of(tmp_path / "deep.json")[0][1]
    assert "thousands of digits" in faults_of(tmp_path / "long.json")[0][1]


def test_a_file_of_50_megabytes_is_read(tmp_path: Path) -> None:
    path = tmp_path / "large.geojson"
    line = ",\n".join(
        json.dumps(feature("Point", [round(-89.6 + 1e-7 * i, 7), 37.7], id=str(i), remark="x" * 180))
        for i in range(180_000)
    )
    path.write_text(f'{{"type":"FeatureCollection","features":[{json.dumps(DEPOT_FEATURE)},{line}]}}')
    assert path.stat().st_size > 50_000_000
    assert len(read_farm(path).ponds) == 180_000


def test_faults_alike_are_told_once_with_their_number_and_some_names(tmp_path: Path) -> None:
    bad = [feature("Point", [100, 95], name=f"Pond {i}") for i in range(5_000)]
    [(path, message, _)] = faults_of(write_geojson(tmp_path / "farm.geojson", DEPOT_FEATURE, *bad))
    assert path == "features[1]"
    assert message.startswith("'Pond 0': latitude 95 is outside -90..90; 4999 more alike: features[2] 'Pond 1', ")
    assert message.endswith(" and 4996 more")


@settings(max_examples=150, deadline=None)
@given(
    content=st.binary(max_size=300) | st.text(max_size=300).map(lambda text: text.encode("utf-8", "replace")),
    suffix=st.sampled_from([".geojson", ".csv", ".kml", ".kmz", ".gpkg", ".shp", ".zip", ""]),
)
def test_any_bytes_give_a_farm_or_faults(tmp_path_factory: pytest.TempPathFactory, content: bytes, suffix: str) -> None:
    path = tmp_path_factory.mktemp("farms") / f"farm{suffix}"
    path.write_bytes(content)
    assert_farm_or_faults(path)


json_values = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5) | st.sampled_from([-89.46, 37.7]),
    lambda children: st.lists(children, max_size=4) | st.dictionaries(st.text(max_size=4), children, max_size=3),
    max_leaves=12,
)


@settings(max_examples=300, deadline=None)
@given(
    st.lists(
        st.fixed_dictionaries(
            {
                "type": st.just("Feature") | json_values,
                "properties": st.dictionaries(
                    st.sampled_from(["id", "role", "name", "service_s", "sampling_point"]), json_values, max_size=3
                )
                | json_values,
                "geometry": st.fixed_dictionaries(
                    {
                        "type": st.sampled_from(
                            ["Point", "Polygon", "MultiPolygon", "LineString", "MultiPoint", "GeometryCollection"]
                        ),
                        "coordinates": json_values,
                        "geometries": json_values,
                    }
                )
                | json_values,
            }
        ),
        max_size=4,
    ),
    json_values,
)
def test_any_json_of_the_right_shape_gives_a_farm_or_faults(
    tmp_path_factory: pytest.TempPathFactory, features: list[dict[str, object]], crs: object
) -> None:
    path = write_geojson(tmp_path_factory.mktemp("farms") / "farm.geojson", DEPOT_FEATURE, *features, crs=crs)
    assert_farm_or_faults(path)


def assert_farm_or_faults(path: Path) -> None:
    faults: tuple[Fault, ...] = ()
    ponds: tuple[Pond, ...] = ()
    try:
        ponds = read_farm(path, depot=DEPOT).ponds
    except InvalidInput as error:
        faults = error.faults
    assert bool(ponds) != bool(faults)


# -------------------------------------------------------------------------------------------------- round trip

degrees_about = st.floats(-0.05, 0.05)
names = (
    st.text(st.characters(codec="utf-8", exclude_categories=["Cc"]), min_size=1, max_size=8)
    .map(clean_text)
    .filter(lambda name: name.strip() and "role" not in name)
)


@st.composite
def farms(draw: st.DrawFn) -> Farm:
    lon0, lat0 = draw(st.floats(-179.8, 179.8)), draw(st.floats(-70.0, 70.0))

    def place() -> tuple[float, float]:
        return (round(lon0 + draw(degrees_about), 7), round(lat0 + draw(degrees_about), 7))

    def rectangle() -> tuple[tuple[tuple[float, float], ...], ...]:
        (lon, lat), width, height = place(), draw(st.floats(1e-4, 1e-2)), draw(st.floats(1e-4, 1e-2))
        east, north = round(lon + width, 7), round(lat + height, 7)
        return (((lon, lat), (east, lat), (east, north), (lon, north), (lon, lat)),)

    ids = draw(st.lists(names, min_size=1, max_size=6, unique=True))
    ponds = []
    for pond_id in ids:
        outline = draw(st.sampled_from([True, False])) and rectangle()
        corner = outline[0][0] if outline else place()
        ponds.append(Pond(pond_id, corner, outline or (), draw(st.none() | st.floats(0.0, 1e4))))
    return Farm(
        draw(names),
        tuple(ponds),
        place(),
        tuple(place() for _ in range(draw(st.integers(0, 2)))),
        tuple(rectangle() for _ in range(draw(st.integers(0, 2)))),
        tuple(rectangle() for _ in range(draw(st.integers(0, 1)))),
    )


@settings(max_examples=150, deadline=None)
@given(farm=farms())
def test_a_written_farm_is_read_back_equal(tmp_path_factory: pytest.TempPathFactory, farm: Farm) -> None:
    path = tmp_path_factory.mktemp("farms") / "farm.geojson"
    write_farm(path, farm)
    read = read_farm(path)
    assert read == Farm(
        farm.name, farm.ponds, farm.depot, farm.stations, farm.no_fly, farm.fences, read.notes, read.doubts
    )


# ---------------------------------------------------------------------------------------- GeoJSON as people write it


def test_roles_ids_and_times_are_read(tmp_path: Path) -> None:
    path = write_geojson(
        tmp_path / "north_farm.geojson",
        feature("Polygon", [square(-89.461, 37.701)], Name="North", service_s=30),
        {**feature("Point", [-89.462, 37.702, 110.5]), "id": 7},
        feature("Polygon", [square(-89.463, 37.703)], role="no-fly"),
        feature("Polygon", [square(-89.5, 37.68, 0.1)], role="Fence"),
        feature("Point", [-89.461, 37.7], role="station"),
        DEPOT_FEATURE,
    )
    farm = read_farm(path)
    assert farm.name == "north_farm"
    assert [(pond.id, pond.service_s) for pond in farm.ponds] == [("North", 30.0), ("7", None)]
    assert farm.ponds[0].sampling_point == pytest.approx((-89.4605, 37.7015))
    assert farm.ponds[1] == Pond("7", (-89.462, 37.702))
    assert (len(farm.no_fly), len(farm.fences), farm.stations) == (1, 1, ((-89.461, 37.7),))
    assert farm.depot == DEPOT
    assert farm.notes == ("1 station is in the file; plans do not use stations yet: features[4].",)


@pytest.mark.parametrize(
    "ring",
    [
        [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [4, 3], [4, 4], [0, 4]],
        [[0, 0], [9, 0], [9, 1], [1, 1], [1, 9], [0, 9]],
    ],
    ids=["C", "L"],
)
def test_a_pond_around_its_centroid_is_sampled_well_inside(tmp_path: Path, ring: list[list[float]]) -> None:
    outline = [[-89.46 + 0.001 * x, 37.7 + 0.001 * y] for x, y in ring]
    path = write_geojson(tmp_path / "farm.geojson", feature("Polygon", [outline]), DEPOT_FEATURE)
    [pond] = read_farm(path).ponds
    polygon = shapely.Polygon(outline)
    assert not polygon.contains(polygon.centroid)
    assert pond.outline[0][0] == pond.outline[0][-1], "the open ring was closed"
    assert polygon.exterior.distance(shapely.Point(pond.sampling_point)) > 0.0003
    assert polygon.contains(shapely.Point(pond.sampling_point))


def test_a_pond_with_an_island_in_the_middle_is_sampled_in_the_water(tmp_path: Path) -> None:
    rings = [square(-89.461, 37.7, 0.003), square(-89.4605, 37.7005, 0.002)]
    path = write_geojson(tmp_path / "farm.geojson", feature("Polygon", rings), DEPOT_FEATURE)
    [pond] = read_farm(path).ponds
    assert len(pond.outline) == 2
    assert shapely.Polygon(rings[0], rings[1:]).contains(shapely.Point(pond.sampling_point))


def test_a_pond_of_several_parts_is_sampled_in_the_largest_where_it_dwarfs_the_rest(tmp_path: Path) -> None:
    parts = [[square(-89.461, 37.701, 0.0004)], [square(-89.465, 37.701, 0.002)]]
    path = write_geojson(tmp_path / "farm.geojson", feature("MultiPolygon", parts, id=1), DEPOT_FEATURE)
    farm = read_farm(path)
    assert [pond.id for pond in farm.ponds] == ["1"]
    assert farm.ponds[0].sampling_point == pytest.approx((-89.464, 37.702))
    assert farm.notes == ("features[0]: the pond has 2 parts; the largest is sampled.",)


def test_a_sampling_point_in_another_pond_is_noted(tmp_path: Path) -> None:
    path = write_geojson(
        tmp_path / "farm.geojson",
        feature("Polygon", [square(-89.461, 37.701)], id="a", sampling_point=[-89.4595, 37.7015]),
        feature("Polygon", [square(-89.46, 37.701)], id="b"),
        DEPOT_FEATURE,
    )
    notes = read_farm(path).notes
    assert any("1 sampling point lies outside" in note and "44." in note for note in notes)
    assert any("sampling point of pond a lies in pond b" in note for note in notes)


def test_ponds_without_ids_are_numbered_around_those_with(tmp_path: Path) -> None:
    points = [feature("Point", [-89.46 + 0.001 * i, 37.7], **({"id": "2"} if i == 0 else {})) for i in range(3)]
    farm = read_farm(write_geojson(tmp_path / "farm.geojson", *points, DEPOT_FEATURE))
    assert [pond.id for pond in farm.ponds] == ["2", "5", "3"]
    assert farm.notes == ("2 ponds without an id were numbered in the order of the file.",)


def test_an_old_crs_member_is_obeyed(tmp_path: Path) -> None:
    members = {"crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32616"}}}
    # Easting 500 km is the central meridian of zone 16, 87 degrees west.
    points = [feature("Point", [500_000, 4_170_000]), feature("Point", [500_000, 4_170_100], role="depot")]
    farm = read_farm(write_geojson(tmp_path / "farm.geojson", *points, **members))
    assert farm.ponds[0].sampling_point[0] == pytest.approx(-87.0)
    assert "converted from WGS 84 / UTM zone 16N" in farm.notes[0]
    length_m = np.hypot(*LocalFrame(*farm.depot).to_local(np.array([farm.ponds[0].sampling_point]))[0])
    assert length_m == pytest.approx(100.0 / 0.9996, rel=1e-5)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_encodings_of_names(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "farm.geojson"
    document = {"type": "FeatureCollection", "features": [feature("Point", [-89.46, 37.7], id="Südteich")]}
    path.write_bytes(json.dumps(document, ensure_ascii=False).encode(encoding))
    farm = read_farm(path, depot=DEPOT)
    assert farm.ponds[0].id == "Südteich"
    assert bool(farm.notes) == (encoding == "cp1252")


def test_a_given_depot_replaces_that_of_the_file(tmp_path: Path) -> None:
    path = write_geojson(tmp_path / "farm.geojson", feature("Point", [-89.46, 37.7], id=1), DEPOT_FEATURE)
    farm = read_farm(path, depot=(-89.461, 37.7))
    assert farm.depot == (-89.461, 37.7)
    assert farm.notes == ("The depot of the file was replaced by the one that was given.",)


def test_the_depot_tells_two_farms_of_a_file_apart(tmp_path: Path) -> None:
    here = [feature("Point", [-89.46 + 0.001 * i, 37.7], id=f"here{i}") for i in range(2)]
    there = [feature("Point", [-80.46 + 0.001 * i, 27.7], id=f"there{i}") for i in range(3)]
    path = write_geojson(tmp_path / "farms.geojson", *here, *there)
    [(_, _, action)] = faults_of(path)
    # A little north of the middle: a place in the middle of points may be one of them.
    assert "3 ponds lie around -80.459000,27.700487; 2 ponds lie around -89.459500,37.700162" in action
    farm = read_farm(path, depot=DEPOT)
    assert [pond.id for pond in farm.ponds] == ["here0", "here1"]
    assert farm.notes[0].startswith("3 ponds (there0, there1, there2) lie 13")


def test_a_farm_across_the_180th_meridian_is_one_farm(tmp_path: Path) -> None:
    points = [feature("Point", [lon, -17.0], id=lon) for lon in (179.999, -179.999)]
    farm = read_farm(write_geojson(tmp_path / "farm.geojson", *points), depot=(180.0, -17.0))
    assert len(farm.ponds) == 2


# -------------------------------------------------------------------------------------------------------- tables


@pytest.mark.parametrize(
    "header",
    [
        "pond,lon,lat",
        "Pond ID,Longitude,Latitude",
        "name,LONGITUDE (deg),LATITUDE (deg)",
        "id,X,Y",
        "fid,gps_lon,gps_lat",
        "pond_id,lng,lat",
        "Name, Long , Lat ",
    ],
)
def test_spellings_of_columns(tmp_path: Path, header: str) -> None:
    path = tmp_path / "ponds.csv"
    path.write_text(f"{header}\n12,-89.46,37.7\n\n13,-89.461,37.7\n")
    farm = read_farm(path, depot=DEPOT)
    assert farm.ponds == (Pond("12", (-89.46, 37.7)), Pond("13", (-89.461, 37.7)))


def test_semicolons_with_decimal_commas(tmp_path: Path) -> None:
    path = tmp_path / "teiche.csv"
    path.write_bytes("\ufeffpond;lat;lon;service_s;role\r\nA;37,7;-89,46;30;\r\n;37,705;-89,46;;depot\r\n".encode())
    farm = read_farm(path)
    assert farm.ponds == (Pond("A", (-89.46, 37.7), (), 30.0),)
    assert farm.depot == DEPOT


def test_outlines_in_wkt(tmp_path: Path) -> None:
    path = tmp_path / "ponds.csv"
    path.write_text(
        'WKT,id\n"POLYGON ((-89.46 37.7,-89.459 37.7,-89.459 37.701,-89.46 37.7))",1\nPOINT (-89.461 37.7),2\n'
    )
    ponds = read_farm(path, depot=DEPOT).ponds
    assert len(ponds[0].outline[0]) == 4
    assert ponds[1].sampling_point == (-89.461, 37.7)


CORNER_HEADER = "pond_id,lat_ul,lon_ul,lat_ur,lon_ur,lat_ll,lon_ll,lat_lr,lon_lr\n"


def test_four_corners_make_an_outline(tmp_path: Path) -> None:
    path = tmp_path / "corners.csv"
    path.write_text(CORNER_HEADER + "1,37.702,-89.46,37.702,-89.458,37.701,-89.46,37.701,-89.458\n")
    [pond] = read_farm(path, depot=DEPOT).ponds
    assert pond.outline[0][:4] == ((-89.46, 37.702), (-89.46, 37.701), (-89.458, 37.701), (-89.458, 37.702))
    assert pond.sampling_point == pytest.approx((-89.459, 37.7015))


@pytest.mark.parametrize("wrong", range(8))
def test_one_mistyped_corner_is_placed_from_the_others(tmp_path: Path, wrong: int) -> None:
    cells = [37.702, -89.46, 37.702, -89.458, 37.701, -89.46, 37.701, -89.458]
    cells[wrong] += 0.01
    path = tmp_path / "corners.csv"
    path.write_text(CORNER_HEADER + "1," + ",".join(f"{cell:.6f}" for cell in cells) + "\n")
    farm = read_farm(path, depot=DEPOT)
    assert farm.ponds[0].sampling_point == pytest.approx((-89.459, 37.7015), abs=1e-9)
    [note] = farm.notes
    assert note.startswith("line 2: one corner lies far from the other three")
    assert CORNER_HEADER.strip().split(",")[wrong + 1] in note


def test_corners_out_of_order_are_joined_around_the_pond(tmp_path: Path) -> None:
    path = tmp_path / "corners.csv"
    path.write_text("id,x1,y1,x2,y2,x3,y3,x4,y4\n1,-89.46,37.702,-89.458,37.701,-89.46,37.701,-89.458,37.702\n")
    farm = read_farm(path, depot=DEPOT)
    assert farm.ponds[0].sampling_point == pytest.approx((-89.459, 37.7015))
    assert "joined by angle" in farm.notes[0]


# ------------------------------------------------------------------------------------------------------ GIS formats

KML = """<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2"><Document><name>Farm</name>
<Placemark><name>Depot</name><Point><coordinates>-89.46,37.705,0</coordinates></Point></Placemark>
<Folder><name>West</name>
<Placemark><name>W1</name><Polygon><outerBoundaryIs><LinearRing><coordinates>
-89.461,37.701,0 -89.46,37.701,0 -89.46,37.702,0 -89.461,37.702,0 -89.461,37.701,0
</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></Folder>
<Folder><name>East</name>
<Placemark><name>E1</name><ExtendedData><Data name="service_s"><value>45</value></Data></ExtendedData>
<Point><coordinates>-89.455,37.701,0</coordinates></Point></Placemark></Folder>
</Document></kml>
"""


@pytest.mark.parametrize("suffix", [".kml", ".kmz"])
def test_kml_with_folders(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"farm{suffix}"
    if suffix == ".kmz":
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("doc.kml", KML)
    else:
        path.write_text(KML)
    farm = read_farm(path)
    assert farm.depot == pytest.approx(DEPOT)
    ponds = {pond.id: pond for pond in farm.ponds}
    assert ponds["W1"].sampling_point == pytest.approx((-89.4605, 37.7015))
    assert ponds["E1"].service_s == 45.0
    assert any("taken as depot, because it is called 'Depot'" in note for note in farm.notes)


def write_gis(path: Path, crs: str | None, transform: Callable[[np.ndarray], np.ndarray], encoding: str | None) -> None:
    import pyogrio

    polygon = shapely.transform(shapely.Polygon(square(-89.461, 37.701)), transform)
    pyogrio.raw.write(
        path,
        np.array([shapely.to_wkb(polygon)]),
        [np.array(["Südteich"], dtype=object)],
        fields=["name"],
        geometry_type="Polygon",
        crs=crs,
        encoding=encoding,
    )


@pytest.mark.filterwarnings("ignore:'crs' was not provided:UserWarning")
@pytest.mark.parametrize("crs", ["EPSG:4326", "EPSG:32616", "EPSG:3857", None])
@pytest.mark.parametrize("suffix", [".shp", ".gpkg", ".fgb"])
def test_gis_formats_and_their_coordinate_systems(tmp_path: Path, suffix: str, crs: str | None) -> None:
    import pyproj

    transformer = pyproj.Transformer.from_crs("EPSG:4326", crs or "EPSG:4326", always_xy=True)
    path = tmp_path / f"farm{suffix}"
    write_gis(path, crs, lambda xy: np.column_stack(transformer.transform(xy[:, 0], xy[:, 1])), None)
    farm = read_farm(path, depot=DEPOT)
    assert farm.ponds[0].id == "Südteich"
    assert farm.ponds[0].sampling_point == pytest.approx((-89.4605, 37.7015), abs=1e-7)
    said = " ".join(farm.notes)
    assert ("converted from" in said) == (crs in {"EPSG:32616", "EPSG:3857"})
    assert ("WGS84 (EPSG:4326) is assumed" in said) == (crs is None)


def test_a_shapefile_in_latin_letters(tmp_path: Path) -> None:
    write_gis(tmp_path / "farm.shp", "EPSG:4326", lambda xy: xy, "ISO-8859-1")
    (tmp_path / "farm.cpg").write_text("UTF-8")
    assert read_farm(tmp_path / "farm.shp", depot=DEPOT).ponds[0].id == "Südteich"


def test_a_shapefile_without_its_index_is_read_or_refused(tmp_path: Path) -> None:
    write_gis(tmp_path / "farm.shp", "EPSG:4326", lambda xy: xy, None)
    (tmp_path / "farm.shx").unlink()
    (tmp_path / "farm.dbf").unlink()
    assert_farm_or_faults(tmp_path / "farm.shp")


# ------------------------------------------------------------------------------------------------------- the rest


def test_the_problem_is_in_metres_around_the_depot() -> None:
    farm = Farm("two", (Pond("a", (0.0, 0.01)), Pond("b", (0.01, 0.0), (), 60.0)), (0.0, 0.0))
    problem = farm.to_problem(Fleet(2))
    assert (problem.num_ponds, problem.num_drones) == (2, 2)
    # A degree is 110574 m of meridian and 111320 m of equator at their crossing.
    assert problem.ponds == pytest.approx(np.array([[0.0, 1105.74], [1113.20, 0.0]]), abs=0.01)
    assert list(problem.depot) == [0.0, 0.0]


def test_importing_pondhop_loads_no_heavy_package() -> None:
    code = (
        "import sys, pondhop.farm; print(*{'pyogrio', 'pyproj', 'shapely', 'matplotlib', 'torch'} & sys.modules.keys())"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""


@needs_shared_farms
def test_the_commercial_farm_is_read() -> None:
    farm = read_farm(SHARED_FARMS / "lh_farm_illinois.geojson", depot=DEPOT)
    assert len(farm.ponds) == 60
    assert len(read_farm(SHARED_FARMS / "lh_farm_sampling_points.csv", depot=DEPOT).ponds) == 52


@needs_shared_farms
def test_the_corner_table_is_read_with_its_typing_errors_told() -> None:
    depot = (-89.174, 37.635)
    farm = read_farm(SHARED_FARMS / "siu_pond_lut_raw.csv", depot=depot)
    repaired = read_farm(SHARED_FARMS / "siu_aquaculture_research_center.geojson", depot=depot)
    assert [pond.id for pond in farm.ponds] == [pond.id for pond in repaired.ponds]
    off_m = np.linalg.norm(
        LocalFrame(*depot).to_local(np.array([pond.sampling_point for pond in farm.ponds]))
        - LocalFrame(*depot).to_local(np.array([pond.sampling_point for pond in repaired.ponds])),
        axis=1,
    )
    # Three of the four corners of pond 14 were typed like those of pond 15: it cannot be told where it lies.
    assert {farm.ponds[index].id for index in np.flatnonzero(off_m > 2.0)} == {"14"}
    for told in ("line 7:", "lat_ul has 37.624646", "line 15:", "line 24:", "lat_lr has 37.644548", "AQUA_NORTH"):
        assert any(told in note for note in farm.notes)
