"""Farm files in the shapes in which farms really come: each file of the field, and others of its kind."""

# Names and numbers in the letters of many scripts are what is tested here.
# ruff: noqa: RUF001

from __future__ import annotations

import json
import os
import shlex
import zipfile
from collections.abc import Mapping
from pathlib import Path

import pytest
import shapely

from farm_files import (
    DEPOT,
    PONDS,
    faults_of,
    geojson,
    ids,
    kml,
    kml_polygon,
    placemark,
    polygon,
    ponds,
    shape,
    square,
    table,
)
from pondhop import InvalidInput
from pondhop.farm import doubt_fault, read_farm
from pondhop.farm.archives import Room
from pondhop.farm.formats import read_source
from pondhop.farm.shapes import clearance_m

FIELD = Path(__file__).parent / "data" / "field"
SHARED_FIELD = Path(__file__).parents[1] / ".." / "shared" / "data" / "field"


def field(name: str) -> Path:
    """The file of that name, here or in the development data."""
    path = FIELD / name if (FIELD / name).exists() else SHARED_FIELD / name
    if not path.exists():
        pytest.skip("the development data ../shared/data/field is not here")
    return path


# ---------------------------------------------------------------------------------------------- the files themselves

READ: dict[str, tuple[list[str], bool, list[str]]] = {
    "a01_no_fly_zone.kml": (PONDS, False, ["taken as no_fly, because it is called 'No Fly Zone'"]),
    "a02_crossing_routes.geojson": (PONDS, False, []),
    "a03_walked_around_ponds.gpx": (PONDS[:3], False, []),
    "a04_pins.kml": (PONDS, False, ["Left out, because they are no ponds by their names: 'Office'", "'Pump house'"]),
    "a07_hemisphere_columns.csv": (["Piscina 1", "Piscina 2"], False, ["column NS", "column EW"]),
    "a08_all_ponds_one_multipolygon.geojson": ([f"Farm ponds {n}" for n in range(1, 7)], False, ["6 ponds, numbered"]),
    "a09_qgis_export.kml": ([f"Laguna {n}" for n in range(1, 7)], False, []),
    "a10_overpass.geojson": ([f"Ao {n}" for n in range(1, 7)], False, []),
    "a11_farm_boundary.geojson": (PONDS, False, ["Left out", "'Farm boundary'"]),
    "a13_near_the_bank.geojson": (["Horseshoe"], False, []),
    "a14_no_fly_wall.geojson": (PONDS, False, []),
    "a15_stations.geojson": (PONDS, False, ["1 station is in the file; plans do not use stations yet"]),
    "b01_sliver.geojson": (PONDS, False, ["'Pond 1' (features[0]): a sliver of it was left out"]),
    "b02_road.kml": (PONDS, False, ["'Main road'"]),
    "b03_untitled.kml": ([f"Untitled Polygon {n}" for n in range(1, 7)], False, ["numbered", "'Untitled Polygon 2'"]),
    "b05_qgis_id_zero.geojson": ([f"Laguna {n}" for n in range(1, 7)], False, ["column 'name', because column 'id'"]),
    "b07_linear_ring.kml": (PONDS, False, []),
    "b08_folder_in_zip.zip": (PONDS, True, []),
    "b10_spreadsheet.xlsx": (PONDS[:3], True, []),
    "b12_sep_line.csv": (PONDS[:1], True, []),
    "b13_fiji_over_180.geojson": (PONDS, False, ["wrapped around the 180th meridian", "180.0003"]),
    "b18_corner_per_line.csv": (["A", "B"], True, ["8 lines were joined to 2 outlines"]),
    "b20_arcgis.json": (PONDS, True, []),
    "b22_gbk.csv": (["塘1", "塘2"], True, ["Chinese (GBK)", "save it as UTF-8"]),
    "b23_item_limit.geojson": ([f"P{n}" for n in range(1, 241)], False, []),
    "b26_spanish_headers.csv": (["E1"], True, []),
    "b27_dms.csv": (PONDS[:1], True, []),
    "b28_utm.csv": (PONDS[:1], True, ["UTM zone 48N"]),
    "c01_bracket_in_name.geojson": (PONDS, False, []),
    "c03_dollar_in_name.geojson": (PONDS, False, []),
    "c04_thai_name.geojson": (PONDS, False, []),
}
"""File -> ids of its ponds, whether the depot is given, and what its notes must say."""

REFUSED: dict[str, tuple[bool, list[str]]] = {
    "a06_depot_in_water.geojson": (False, ["there is no depot", "or name a point Depot"]),
    "b09_lone.shp": (True, ["b09_lone.shx, .dbf, .prj are missing", "copy all files named b09_lone"]),
    "b15_network_link.kml": (True, ["only a link to the web", "without 'network link'"]),
    "b24_home_pin.kml": (False, ["or name a point Depot", "'Home' lies at 105.698500,10.099500"]),
    "b29_two_copies.gpkg": (True, ["6 ponds are there twice", "--layer 'multipolygons'"]),
}


@pytest.mark.parametrize("name", READ)
def test_a_file_of_the_field_is_read(name: str) -> None:
    expected, is_depot_given, told = READ[name]
    farm = read_farm(field(name), depot=DEPOT if is_depot_given else None)
    assert ids(farm) == expected
    for words in told:
        assert any(words in note for note in farm.notes), (words, farm.notes)


@pytest.mark.parametrize("name", REFUSED)
def test_a_file_of_the_field_is_refused_with_its_remedy(name: str) -> None:
    is_depot_given, told = REFUSED[name]
    [(_, message, action)] = faults_of(field(name), depot=DEPOT if is_depot_given else None)
    for words in told:
        assert words in f"{message} {action}"


@pytest.mark.skipif(not SHARED_FIELD.is_dir(), reason="the development data ../shared/data/field is not here")
def test_every_file_of_the_field_is_tested() -> None:
    assert sorted({*READ, *REFUSED}) == sorted(path.name for path in SHARED_FIELD.iterdir() if path.suffix != ".md")


def test_the_right_numbers_come_out() -> None:
    assert len(read_farm(field("a01_no_fly_zone.kml")).no_fly) == 1
    south_west = read_farm(field("a07_hemisphere_columns.csv"))
    assert south_west.ponds[0].sampling_point == (-79.9009, -2.3004)
    assert south_west.depot == (-79.9, -2.301)
    [pond] = read_farm(field("b27_dms.csv"), depot=DEPOT).ponds
    assert pond.sampling_point == pytest.approx((105 + 42 / 60 + 3.2 / 3600, 10 + 6 / 60 + 1.4 / 3600))
    [pond] = read_farm(field("b28_utm.csv"), depot=DEPOT).ponds
    assert pond.sampling_point == pytest.approx((105.70, 10.10), abs=0.01)
    fiji = read_farm(field("b13_fiji_over_180.geojson"))
    assert fiji.ponds[0].sampling_point == pytest.approx((179.9994, -16.99955))
    assert fiji.ponds[2].sampling_point == pytest.approx((-179.9966, -16.99955))
    [horseshoe] = read_farm(field("a13_near_the_bank.geojson")).ponds
    assert clearance_m(horseshoe.sampling_point, horseshoe.outline) > 12.0


def test_a_layer_can_be_chosen() -> None:
    path = field("b29_two_copies.gpkg")
    assert len(read_farm(path, depot=DEPOT, layers=["osm_polygons"]).ponds) == 6
    [(place, message, action)] = faults_of(path, depot=DEPOT, layers=["pond"])
    assert (place, message) == ("--layer", "there is no layer 'pond'")
    assert "'multipolygons'" in action


# ------------------------------------------------------------------------------------------- what is no pond, by name


@pytest.mark.parametrize(
    "name",
    [
        *(
            "No fly",
            "NFZ",
            "NFZ 2",
            "NoFlyZone_1",
            "no-fly area north",
            "Restricted airspace",
            "Exclusion zone",
            "KEEP OUT",
        ),
        *("Zona de exclusión", "ZONA PROHIBIDA", "Área restrita", "Vùng cấm bay", "禁飞区1", "禁飛區", "飛行禁止区域"),
        *(
            "비행금지구역",
            "เขตห้ามบิน",
            "Zona Larangan Terbang",
            "Uçuşa yasak bölge",
            "منطقة حظر الطيران",
            "Zone interdite",
        ),
        *("Flyforbud", "उड़ान निषिद्ध"),
    ],
)
def test_an_area_to_keep_out_of_is_no_pond(tmp_path: Path, name: str) -> None:
    farm = read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, name=name)), depot=DEPOT)
    assert ids(farm) == PONDS[:3]
    assert len(farm.no_fly) == 1
    assert any("taken as no_fly" in note for note in farm.notes)


@pytest.mark.parametrize(
    "name", ["Zone 3", "Sector B", "Zona 4", "区域3", "Buffer", "No fly pond", "Restricted - Pond 9"]
)
def test_what_may_be_an_area_to_keep_out_of_is_a_fault(tmp_path: Path, name: str) -> None:
    [(place, message, action)] = faults_of(geojson(tmp_path, *ponds(), polygon(5, 5, name=name)), depot=DEPOT)
    assert place == "features[3]"
    assert message.startswith("is this a pond? it is called")
    assert name in message
    assert "role" in action


@pytest.mark.parametrize(
    "name",
    [
        *(
            "Office",
            "Pump house",
            "pumphouse 2",
            "Main Gate",
            "Feed store",
            "Weather station",
            "Parking lot",
            "Oficina",
        ),
        *(
            "Casa de bombas",
            "Văn phòng",
            "Trạm bơm",
            "办公室",
            "泵房",
            "事務所",
            "사무실",
            "สำนักงาน",
            "Kantor",
            "Rumah pompa",
        ),
        *(
            "مكتب",
            "कार्यालय",
            "Farm boundary",
            "Property line",
            "Lindero",
            "Ranh giới",
            "边界",
            "敷地",
            "Sınır",
            "Batas lahan",
        ),
    ],
)
@pytest.mark.parametrize("kind", ["Polygon", "Point"])
def test_what_is_no_pond_by_its_name_is_left_out_with_a_note(tmp_path: Path, name: str, kind: str) -> None:
    thing = polygon(5, 5, name=name) if kind == "Polygon" else shape("Point", [105.71, 10.11], name=name)
    farm = read_farm(geojson(tmp_path, *ponds(), thing), depot=DEPOT)
    assert ids(farm) == PONDS[:3]
    [note] = farm.notes
    assert note.startswith("Left out")
    assert name in note


@pytest.mark.parametrize(
    "name", ["Office pond", "Road pond 2", "Estanque oficina", "Ao văn phòng", "办公室鱼塘", "Gate Lagoon"]
)
def test_a_pond_called_after_something_else_stays_a_pond(tmp_path: Path, name: str) -> None:
    assert ids(read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, name=name)), depot=DEPOT)) == [*PONDS[:3], name]


@pytest.mark.parametrize(
    "name", ["Homestead 3", "Basement", "Roadrunner", "Norte 4", "河东1号", "A7", "Fencer", "Gatewood"]
)
def test_words_count_only_whole(tmp_path: Path, name: str) -> None:
    assert ids(read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, name=name)), depot=DEPOT)) == [*PONDS[:3], name]


@pytest.mark.parametrize("name", ["Old Mill", "Zwinger 3", "Maneki", "Fazendinha", "Kennel", "ตึก", "凉亭", "منتجع"])
def test_what_is_not_called_like_all_other_ponds_is_in_doubt(tmp_path: Path, name: str) -> None:
    for others in (
        [f"Pond {number}" for number in range(1, 7)],
        [f"{number}" for number in range(1, 7)],
        [f"塘{number}号" for number in range(1, 5)],
        ["North pond", "Lily pond", "Big Lake", "Étang vert", "Ao số 5"],
    ):
        features = [polygon(index, 0, name=other) for index, other in enumerate(others)]
        path = geojson(tmp_path, *features, polygon(5, 5, name=name))
        [doubt] = read_farm(path, depot=DEPOT).doubts
        assert doubt.pond_id == name
        assert f"is {name!r} a pond? The others are called {others[0]!r}" in doubt.message
        assert "role" in doubt_fault([doubt]).action
        assert read_farm(path, depot=DEPOT, accept=[name]).doubts == ()
    sure = polygon(5, 5, name=name, role="pond")
    assert read_farm(geojson(tmp_path, *ponds(6), sure), depot=DEPOT).doubts == ()


@pytest.mark.parametrize(
    "names",
    [
        ["Alpha", "Beta", "Gamma", "Delta", "Epsilon", "Zeta", "Eta"],
        ["Pond 1", "Pond 2", "Pond 3", "Pond 4", "Pond 5", "Big Tom", "Lucy", "Old Joe"],
        [*PONDS, "Nursery 1", "Norte 4", "A7", "3b", "Tilapia 2", "Untitled Polygon"],
        [*(f"Bloc {n}" for n in range(1, 9)), *(f"Crique {n}" for n in range(1, 4))],
        ["North", "South", "Big pond", "Old pond", "Lily pond", "Frog pond", "Long pond"],
        [f"Casita {n}" for n in range(1, 7)],
        ["12-A", "12-B", "13-A", "13-B", "14-A", "R1"],
    ],
)
def test_farms_with_names_of_their_own_are_in_no_doubt(tmp_path: Path, names: list[str]) -> None:
    features = [polygon(index, 0, name=name) for index, name in enumerate(names)]
    farm = read_farm(geojson(tmp_path, *features), depot=DEPOT)
    assert (len(farm.ponds), farm.doubts) == (len(names), ())


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("N.F.Z.", 1),
        ("Runway", 1),
        ("Airstrip 2", 1),
        ("跑道", 1),
        ("Farmhouse", 0),
        ("学校", 0),
        ("Masjid", 0),
        ("ruộng lúa", 0),
    ],
)
def test_words_for_what_lies_beside_ponds(tmp_path: Path, name: str, count: int) -> None:
    farm = read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, name=name)), depot=DEPOT)
    assert (ids(farm), len(farm.no_fly)) == (PONDS[:3], count)


@pytest.mark.parametrize("name", ["Geozaun", "Clôture", "Cerca", "Hàng rào", "รั้ว", "围栏", "柵", "울타리", "Geofence"])
def test_words_for_fences(tmp_path: Path, name: str) -> None:
    around = [[[105.69, 10.09], [105.72, 10.09], [105.72, 10.12], [105.69, 10.12], [105.69, 10.09]]]
    assert len(read_farm(geojson(tmp_path, *ponds(6), shape("Polygon", around, name=name)), depot=DEPOT).fences) == 1


def test_a_role_wins_over_every_name(tmp_path: Path) -> None:
    things = [polygon(5, 5, name="No fly zone", role="pond"), polygon(6, 5, name="Pond 9", role="other")]
    assert ids(read_farm(geojson(tmp_path, *ponds(), *things), depot=DEPOT)) == [*PONDS[:3], "No fly zone"]
    farm = read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, name="x", role="zona prohibida")), depot=DEPOT)
    assert len(farm.no_fly) == 1


def test_folders_tell_what_is_in_them(tmp_path: Path) -> None:
    folders = "".join(
        f"<Folder><name>{folder}</name>{placemark(name, kml_polygon(column, 3))}</Folder>"
        for column, (folder, name) in enumerate(
            [("No fly", "A"), ("Buildings", "B"), ("Estanques", "C"), ("Restricted", "Untitled Polygon")]
        )
    )
    farm = read_farm(kml(tmp_path, placemark("Pond 1", kml_polygon(0, 0)), folders), depot=DEPOT)
    assert ids(farm) == ["Pond 1", "C"]
    assert len(farm.no_fly) == 2


def test_tags_of_openstreetmap_tell_buildings_and_roads(tmp_path: Path) -> None:
    things = [
        {**polygon(5, 5, **{"@id": "way/9", "building": "yes"}), "id": "way/9"},
        {**polygon(6, 5, **{"@id": "way/8", "landuse": "residential", "name": "Xóm 1"}), "id": "way/8"},
        {**shape("LineString", [[105.7, 10.1], [105.71, 10.1]], **{"@id": "way/7", "highway": "track"}), "id": "way/7"},
    ]
    assert ids(read_farm(geojson(tmp_path, *ponds(), *things), depot=DEPOT)) == PONDS[:3]


def test_an_outline_around_other_ponds_is_a_fault_whatever_its_name(tmp_path: Path) -> None:
    around: dict[str, object] = shape(
        "Polygon", [[[105.69, 10.09], [105.72, 10.09], [105.72, 10.12], [105.69, 10.12], [105.69, 10.09]]]
    )
    for name in ("Sunrise Aqua", "Pond area", ""):
        around["properties"] = {"name": name}
        [(place, message, _)] = faults_of(geojson(tmp_path, around, *ponds(6)), depot=DEPOT)
        assert place == "features[0]"
        assert "around 6 other ponds" in message
    around["properties"] = {"name": "Flight area"}
    assert len(read_farm(geojson(tmp_path, around, *ponds(6)), depot=DEPOT).fences) == 1
    around["properties"] = {"name": "NFZ"}
    assert "100% of the ponds lie in it" in faults_of(geojson(tmp_path, around, *ponds(6)), depot=DEPOT)[0][1]


def test_points_among_outlines_are_asked_for_at_once(tmp_path: Path) -> None:
    pins = [shape("Point", [105.71 + 0.001 * i, 10.11], name=f"X{i}") for i in range(3)]
    [(_, message, action)] = faults_of(geojson(tmp_path, *ponds(), *pins), depot=DEPOT)
    assert message.startswith("are these ponds? 3 points among 3 outlines: 'X0' (features[3]), 'X1'")
    assert "'pond'" in action
    named = [shape("Point", [105.71, 10.11], name="Pond 9"), shape("Point", [105.712, 10.11], name="z", service_s=4)]
    assert ids(read_farm(geojson(tmp_path, *ponds(), *named), depot=DEPOT)) == [*PONDS[:3], "Pond 9", "z"]


def test_points_in_ponds_are_labels_or_sampling_points(tmp_path: Path) -> None:
    pins = [shape("Point", [105.7009, 10.1004], name="Pond 1"), shape("Point", [105.7025, 10.1005], name="Sampling 2")]
    farm = read_farm(geojson(tmp_path, *ponds(), *pins), depot=DEPOT)
    assert ids(farm) == PONDS[:3]
    assert farm.ponds[1].sampling_point == (105.7025, 10.1005)
    assert any("labels: 'Pond 1'" in note for note in farm.notes)
    collection = {"type": "GeometryCollection", "geometries": [ponds()[0]["geometry"], pins[0]["geometry"]]}
    one = {"type": "Feature", "properties": {"name": "P"}, "geometry": collection}
    assert ids(read_farm(geojson(tmp_path, one), depot=DEPOT)) == ["P"]


def test_lines_among_ponds_are_left_out_unless_they_are_called_ponds(tmp_path: Path) -> None:
    line = [[105.7, 10.1], [105.71, 10.1], [105.71, 10.11]]
    farm = read_farm(geojson(tmp_path, *ponds(), shape("LineString", line, name="Karl's")), depot=DEPOT)
    assert farm.notes == ("""Left out, because a line is no pond: "Karl's" (features[3]).""",)
    [(place, message, _)] = faults_of(
        geojson(tmp_path, *ponds(), shape("LineString", line, name="Pond 4")), depot=DEPOT
    )
    assert (place, message) == ("features[3]", "'Pond 4': an open line is not a pond")


def test_overlays_and_links_among_ponds_are_left_out_with_a_note(tmp_path: Path) -> None:
    overlay = "<GroundOverlay><name>Orthophoto</name><LatLonBox><north>11</north></LatLonBox></GroundOverlay>"
    link = "<NetworkLink><name>Weather</name><Link><href>http://x</href></Link></NetworkLink>"
    farm = read_farm(kml(tmp_path, placemark("A", kml_polygon(0, 0)), overlay, link), depot=DEPOT)
    assert ids(farm) == ["A"]
    assert [note for note in farm.notes if "'Orthophoto'" in note]
    assert [note for note in farm.notes if "'Weather'" in note]


# ------------------------------------------------------------------------------------------------------ names and parts


def test_parts_of_one_size_are_ponds_and_crumbs_are_not(tmp_path: Path) -> None:
    crumb = [[[105.72, 10.12], [105.7201, 10.12], [105.7201, 10.1201], [105.72, 10.12]]]
    parts = shape("MultiPolygon", [[square(0, 0)], [square(1, 0)], crumb], name="Block")
    farm = read_farm(geojson(tmp_path, parts), depot=DEPOT)
    assert ids(farm) == ["Block 1", "Block 2"]
    assert "1 small part was left out" in farm.notes[0]
    points = shape("MultiPoint", [[105.7, 10.1], [105.71, 10.1]], name="B")
    assert ids(read_farm(geojson(tmp_path, points), depot=DEPOT)) == ["B 1", "B 2"]


def test_the_column_that_tells_ponds_apart_names_them(tmp_path: Path) -> None:
    def named(*rows: Mapping[str, object]) -> list[str]:
        features = [polygon(index, 0, **row) for index, row in enumerate(rows)]
        return ids(read_farm(geojson(tmp_path, *features), depot=DEPOT))

    assert named(*({"id": None, "estanque": f"E{n}"} for n in range(3))) == ["E0", "E1", "E2"]
    assert named(*({"name": "Tilapia", "塘号": f"T{n}"} for n in range(3))) == ["T0", "T1", "T2"]
    assert named(*({"name": "Tilapia"} for n in range(3))) == ["Tilapia 1", "Tilapia 2", "Tilapia 3"]
    assert named(*({"Name": "Pond"} for n in range(3))) == ["Pond 1", "Pond 2", "Pond 3"]
    assert named(*({"id": 1, "code_x": f"K{n}"} for n in range(3))) == ["K0", "K1", "K2"]
    assert named(*({"id": 0} for n in range(3))) == ["1", "2", "3"]


@pytest.mark.parametrize("heading", ["имя", "שם", "bezeichnung_x", "station", "xx", "Βάθρο", "nazwa"])
def test_a_column_of_any_heading_names_the_ponds_where_none_is_known(tmp_path: Path, heading: str) -> None:
    rows = [("Alpha", "10.1,105.7"), ("Beta 2", "10.101,105.702"), ("NFZ", "10.102,105.702")]
    text = f"{heading},lat,lon,depth\n" + "".join(f"{name},{place},1.{len(name)}\n" for name, place in rows[:2])
    farm = read_farm(table(tmp_path, text), depot=DEPOT)
    assert ids(farm) == ["Alpha", "Beta 2"]
    if heading not in {"имя", "שם", "nazwa"}:
        assert f"The ponds are named by column {heading!r}, because no column is known to hold names." in farm.notes
    features = [polygon(index, 0, depth=2, **{heading: name}) for index, (name, _) in enumerate(rows)]
    farm = read_farm(geojson(tmp_path, *features, shape("Point", [*DEPOT], role="depot")))
    assert (ids(farm), len(farm.no_fly)) == (["Alpha", "Beta 2"], 1)


def test_kinds_and_tags_are_no_names(tmp_path: Path) -> None:
    features = [polygon(0, 0, type="pond"), polygon(1, 0, type="shrimp pond")]
    assert ids(read_farm(geojson(tmp_path, *features), depot=DEPOT)) == ["1", "2"]


def test_equal_numbers_in_two_folders_get_the_folder(tmp_path: Path) -> None:
    folders = "".join(
        f"<Folder><name>{folder}</name>{placemark('1', kml_polygon(column, 0))}"
        f"{placemark('2', kml_polygon(column, 1))}</Folder>"
        for column, folder in enumerate(("North", "South"))
    )
    assert ids(read_farm(kml(tmp_path, folders), depot=DEPOT)) == ["North 1", "North 2", "South 1", "South 2"]


@pytest.mark.parametrize(
    "name", ["\ud800", "a\x00b", "\x1b[31mred", "‮gnp.exe", "[/b]", "$x_{", "😀", "x" * 500, "بركة ١"]
)
def test_no_name_breaks_the_reader(tmp_path: Path, name: str) -> None:
    farm = read_farm(geojson(tmp_path, polygon(0, 0, name=name), polygon(1, 0, name="B"), name=name), depot=DEPOT)
    for text in (farm.name, farm.ponds[0].id, *farm.notes):
        text.encode("utf-8")
        assert "\x1b" not in text
    assert farm.ponds[1].id == "B"


# ------------------------------------------------------------------------------------------------------ tables

EXPECTED = pytest.approx((105.7009, 10.1004), abs=1e-4)


@pytest.mark.parametrize(
    "text",
    [
        "sep=;\r\nname;lat;lon\r\nA;10,1004;105,7009\r\n",
        'sep=\t\nname\tlat\tlon\nA\t"10,1004"\t105.7009\n',
        "estanque,POINT_X,POINT_Y\nA,105.7009,10.1004\n",
        "viveiro,xcoord,ycoord\nA,105.7009,10.1004\n",
        "名称,经度,纬度\nA,105.7009,10.1004\n",
        "tên,kinh độ,vĩ độ\nA,105.7009,10.1004\n",
        "name,Lat (N),Long (E)\nA,10.1004,105.7009\n",
        "name,lat,lon\nA,10.1004N,E 105.7009\n",
        "name,lat,lon\nA,10°06'01.4\"N,105°42'03.2\"E\n",
        "name,lat,lon\nA,10 06 01.4 N,105 42 03.2 E\n",
        "name;lat;lon\nA;N10d06m01,4s;E105d42m03,2s\n",
        "name,lat,lon\nA,10° 6.0233' N,105º 42.0533′ E\n",
        "name,latitude,lat_dir,longitude,lon_dir\nA,10.1004,N,105.7009,E\n",
        "Farm of Mr. X\n\nname,lat,lon\nA,10.1004,105.7009\n",
        "name,utm_e,utm_n,zona\nA,576800,1116600,48 P\n",
        "name,x,y,zone\nA,576800.0,1116600.0,48 north\n",
        'name,easting,northing,utm zone\nA,"576,800","1,116,600",WGS84 UTM 48N\n',
        'name,coordinates\nA,"10.1004, 105.7009"\n',
        "塘号;坐标\nA;10.1004,105.7009\n",
        "name;Este;Norte;Huso\nA;576.800,5;1.116.600,2;48N\n",
        '"WKT","name"\n"POINT (105.7009 10.1004)","A"\n',
    ],
)
def test_a_table_is_read_however_it_is_written(tmp_path: Path, text: str) -> None:
    [pond] = read_farm(table(tmp_path, text), depot=DEPOT).ponds
    assert pond.id == "A"
    assert pond.sampling_point == (EXPECTED if "576" not in text else pytest.approx((105.701, 10.1), abs=0.01))


@pytest.mark.parametrize(
    "text",
    [
        "name,lat,lon\nA,−2.3004,−79.9009\n",
        "name,lat,lon\nA,2.3004 S,79.9009 W\n",
        "name,lat,lon\nA,S2°18'1.44\",W79°54'3.24\"\n",
        "name,Lat (S),Lon (W)\nA,2.3004,79.9009\n",
        "name,lat,hemisphere,lon,ew\nA,2.3004,S,79.9009,W\n",
        "name,lat,x1,lon,x2\nA,2.3004,S,79.9009,W\n",
        "nombre,latitud,lat_ref,longitud,lon_ref\nA,2.3004,Sur,79.9009,Oeste\n",
        "name,lat,NS,lon,EW\nA,-2.3004,S,-79.9009,W\n",
    ],
)
def test_south_and_west_are_negative(tmp_path: Path, text: str) -> None:
    [pond] = read_farm(table(tmp_path, text), depot=(-79.9, -2.301)).ponds
    assert pond.sampling_point == pytest.approx((-79.9009, -2.3004), abs=1e-6)


@pytest.mark.parametrize(
    ("text", "sign"),
    [
        ("Name;Breite;Länge\nTeich 1;53,1 N;9,5 O\n", 1),
        ("Name;Breitengrad;Längengrad\nA;53°06'00\"N;9°30'00\"O\n", 1),
        ("Naam;Breedte;Lengte\nA;53,1 N;9,5 O\n", 1),
        ("Naam;Breedtegraad;Lengtegraad\nA;53,1 Noord;9,5 Oost\n", 1),
        ("Name;Breite;Länge;EW\nA;53,1;9,5;O\n", 1),
        ("Name;Breite;Länge (O)\nA;53,1;9,5\n", 1),
        ("Teich;Koordinaten\nA;53.1 N, 9.5 O\n", 1),
        ("name;lat;lon\nA;53,1 N;9,5 O\nB;53,1 N;0,001 W\n", 1),
        ("name;lat;lon\nTeich 1;53,1 N;9,5 O\n", 1),
        ("nombre,latitud,longitud\nA,53.1 N,9.5 O\n", -1),
        ("nombre,Latitud (N),Longitud (O)\nA,53.1,9.5\n", -1),
        ("nom,latitude,longitude\nA,53.1 N,9.5 O\n", -1),
        ("nome,latitudine,longitudine\nA,53.1 N,9.5 O\n", -1),
        ("viveiro,latitude,longitude,ew\nA,53.1,9.5,O\n", -1),
        ("name,lat,lon\nÉtang 1,53.1 N,9.5 O\n", -1),
        ("name,lat,lon\nA,53.1 N,9.5 Ouest\n", -1),
        ("name,lat,lon\nA,53.1 N,9.5 O\nB,53.1 N,0.001 E\n", -1),
    ],
)
def test_the_letter_o_is_east_or_west_by_language(tmp_path: Path, text: str, sign: int) -> None:
    layers = read_source(table(tmp_path, text))
    assert layers.faults == []
    assert layers.features[0].geometry.points == [pytest.approx((sign * 9.5, 53.1))]


@pytest.mark.parametrize(
    "text",
    [
        "name,lat,lon\nA,3.4 S,60.9 O\nB,3.401 S,60.9 O\n",
        "name,lat,lon,ew\nA,3.4,60.9,O\n",
        "name,lat,Lon (O)\nA,3.4,60.9\n",
        "name,latitude,longitude\nTeich,3.4 S,60.9 O\nEstanque,3.401 S,60.9 O\n",
    ],
)
def test_the_letter_o_without_a_language_is_a_fault_that_asks(tmp_path: Path, text: str) -> None:
    [(_, message, action)] = faults_of(table(tmp_path, text), depot=(-60.9, -3.4))
    assert "O is east in German and Dutch, and west in Spanish" in message
    assert action == "write E or W"


UTM = "name,easting,northing,zone"


def test_zone_s_of_utm_is_a_fault_that_asks_where_it_may_be_a_band(tmp_path: Path) -> None:
    for zone, northing in (("15S", 3698000), ("15 s", 4400000), ("UTM 15S", 2500000)):
        text = f"{UTM}\nA,322000,{northing},{zone}\nB,322200,{northing},{zone}\n"
        [(place, message, action)] = faults_of(table(tmp_path, text))
        assert place == "line 2, column zone"
        assert message.endswith("is 15 north or south? S is a band of latitudes in the north, and the southern half")
        assert action == "write 15 north or 15 south"


@pytest.mark.parametrize(
    ("text", "options", "expected"),
    [
        (f"{UTM}\nA,322000,3698000,15 north\n", {"depot": (-94.91, 33.4)}, (-94.9, 33.4)),
        (f"{UTM},hemisphere\nA,322000,3698000,15S,N\n", {"depot": (-94.91, 33.4)}, (-94.9, 33.4)),
        (f"{UTM},hemisphere\nA,322000,3698000,15,N\n", {"depot": (-94.91, 33.4)}, (-94.9, 33.4)),
        (f"{UTM},hem\nA,620000,9620000,17,Sur\n", {"depot": (-79.92, -3.43)}, (-79.92, -3.43)),
        (f"{UTM}\nA,322000,3698000,EPSG:32615\n", {"depot": (-94.91, 33.4)}, (-94.9, 33.4)),
        (f"{UTM}\nA,322000,3698000,15S\n", {"depot": (-94.91, 33.4)}, (-94.9, 33.4)),
        (f"{UTM}\nA,322000,3530000,15R\nB,322200,3541000,15S\n", {"depot": (-94.9, 31.9)}, (-94.88, 31.89)),
        (f"{UTM}\nA,620000,9620000,17S\n", {"depot": (-79.92, -3.43)}, (-79.92, -3.43)),
        (f"{UTM}\nA,620000,9620000,17M\n", {"depot": (-79.92, -3.43)}, (-79.92, -3.43)),
    ],
)
def test_the_half_of_a_zone_of_utm_is_known(
    tmp_path: Path, text: str, options: dict[str, tuple[float, float]], expected: tuple[float, float]
) -> None:
    assert read_farm(table(tmp_path, text), **options).ponds[0].sampling_point == pytest.approx(expected, abs=0.02)  # type: ignore[arg-type]


def test_another_file_tells_the_half_of_a_zone(tmp_path: Path) -> None:
    place = geojson(tmp_path, shape("Point", [-94.91, 33.4], role="depot")).read_text()
    files = {"ponds.csv": f"{UTM}\nA,322000,3698000,15S\n", "depot.geojson": place}
    [pond] = read_farm(packed(tmp_path, files)).ponds
    assert pond.sampling_point == pytest.approx((-94.9, 33.4), abs=0.02)


def test_a_zone_without_its_half_is_one_fault_a_line(tmp_path: Path) -> None:
    text = f"{UTM}\nA,620000,9620000,17\nB,620200,9620100,17\n"
    faults = faults_of(table(tmp_path, text), depot=(-79.92, -3.43))
    assert [message for _, message, _ in faults] == ["'A': '17' is no zone of UTM", "'B': '17' is no zone of UTM"]
    assert "column hemisphere" in faults[0][2]


def test_contradictions_of_sign_and_letter_are_faults(tmp_path: Path) -> None:
    faults = faults_of(table(tmp_path, "name,lat,NS,lon,EW\nA,-2.3,N,79.9,Q\n"), depot=DEPOT)
    assert [path for path, _, _ in faults] == ["line 2, column lat"]
    assert "no number" in faults_of(table(tmp_path, "name,lat,lon\nA,105.7E,10.1N\n"), depot=DEPOT)[0][1]
    assert (
        "zone of UTM" in faults_of(table(tmp_path, "n,easting,northing,zone\nA,576800,1116600,48\n"), depot=DEPOT)[0][1]
    )
    [(_, message, action)] = faults_of(table(tmp_path, "name,Easting,Northing\nA,576800,1116600\n"), depot=DEPOT)
    assert "no longitude and latitude columns" in message
    assert "add a column zone" in action


@pytest.mark.parametrize(
    ("encoding", "name"),
    [
        *(
            ("gbk", "塘1"),
            ("gbk", "东南区虾塘3号"),
            ("big5", "魚塭一號"),
            ("big5", "塘1"),
            ("cp932", "養殖池1"),
            ("cp932", "エビ池"),
        ),
        *(("cp949", "양식장 1"), ("cp949", "동쪽 못"), ("cp874", "บ่อกุ้ง 1"), ("cp874", "บ่อ1"), ("cp1251", "Пруд 1")),
        *(
            ("cp1252", "Südteich"),
            ("cp1252", "Piscina Peñón"),
            ("cp1252", "São João"),
            ("cp1252", "Étang 1"),
            ("cp1256", "حوض 1"),
        ),
        *(("cp1258", "Đầm Đông 1"), ("utf-16", "塘1"), ("utf-16-le", "Pond é")),
    ],
)
def test_the_encoding_of_a_table_is_guessed(tmp_path: Path, encoding: str, name: str) -> None:
    import unicodedata

    written = unicodedata.normalize("NFD", name) if encoding == "cp1258" else name
    if encoding == "cp1258":
        written = "".join(unicodedata.normalize("NFC", part) for part in ["Đâ", "̀", "m Đông 1"])
    farm = read_farm(table(tmp_path, f"name,lat,lon\n{written},10.1004,105.7009\n", encoding), depot=DEPOT)
    assert unicodedata.normalize("NFC", farm.ponds[0].id) == name
    assert bool(farm.notes) == (not encoding.startswith("utf"))


def test_corners_a_line_are_joined_in_their_order(tmp_path: Path) -> None:
    rows = [(lon, lat) for lon, lat in square(0, 0)[:4]]
    text = "pond_id,vertex,lat,lon\n" + "".join(f"A,{n},{rows[n][1]},{rows[n][0]}\n" for n in (0, 2, 1, 3))
    farm = read_farm(table(tmp_path, text + "B,0,10.2,105.8\n"), depot=DEPOT)
    assert ids(farm) == ["A", "B"]
    assert shapely.Polygon(farm.ponds[0].outline[0]).is_valid
    twice = "pond,lat,lon\nA,10.1,105.7\nA,10.11,105.71\n"
    assert "id 'A' is already that of line 2" in faults_of(table(tmp_path, twice), depot=DEPOT)[0][1]


def test_curves_and_endless_cells_are_faults(tmp_path: Path) -> None:
    text = 'id,wkt\n1,"CIRCULARSTRING (105.7 10.1, 105.71 10.11, 105.72 10.1)"\n'
    assert "has curves" in faults_of(table(tmp_path, text), depot=DEPOT)[0][1]
    assert "no number" in faults_of(table(tmp_path, f"id,lat,lon\n1,{'9' * 5000},105\n"), depot=DEPOT)[0][1]


def test_a_service_time_of_more_than_a_day_is_a_fault(tmp_path: Path) -> None:
    [(place, message, _)] = faults_of(geojson(tmp_path, polygon(0, 0, id=1, service_s=1e308)), depot=DEPOT)
    assert place == "features[0].properties.service_s"
    assert "no time on station" in message


# --------------------------------------------------------------------------------------------- files and archives


def test_a_map_is_known_by_its_content(tmp_path: Path) -> None:
    content = kml(tmp_path, placemark("A", kml_polygon(0, 0))).read_text()
    kmz = tmp_path / "farm.kml"
    with zipfile.ZipFile(kmz, "w") as archive:
        archive.writestr("files/picture.png", b"x" * 1000)
        archive.writestr("any name.kml", content)
    assert ids(read_farm(kmz, depot=DEPOT)) == ["A"]
    (tmp_path / "farm.kmz").write_text(content)
    assert ids(read_farm(tmp_path / "farm.kmz", depot=DEPOT)) == ["A"]
    (tmp_path / "farm.txt").write_text(geojson(tmp_path, polygon(0, 0, name="A")).read_text())
    assert ids(read_farm(tmp_path / "farm.txt", depot=DEPOT)) == ["A"]


def test_archives_are_unpacked_within_limits(tmp_path: Path) -> None:
    path = tmp_path / "bomb.kmz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("doc.kml", b"<kml>" + b" " * 60_000_000)
    assert "the archive would unpack to 60 MB" in faults_of(path, depot=DEPOT)[0][1]
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("../../evil.geojson", geojson(tmp_path, polygon(0, 0, name="A")).read_text())
    assert ids(read_farm(path, depot=DEPOT)) == ["A"]
    assert not (tmp_path.parent.parent / "evil.geojson").exists()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("photo.jpg", b"x")
    assert "holds no map: 'photo.jpg'" in faults_of(path, depot=DEPOT)[0][1]


def test_files_of_an_archive_are_layers(tmp_path: Path) -> None:
    path = tmp_path / "farm.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("Farm/ponds.geojson", geojson(tmp_path, *ponds()).read_text())
        archive.writestr("Farm/no_fly.geojson", geojson(tmp_path, polygon(4, 4, name="School")).read_text())
    assert "School" in str(read_farm(path, depot=DEPOT).notes)
    assert ids(read_farm(path, depot=DEPOT, layers=["ponds"])) == PONDS[:3]


def packed(folder: Path, members: Mapping[str, str | bytes], name: str = "farm.zip") -> Path:
    path = folder / name
    with zipfile.ZipFile(path, "w") as archive:
        for member, content in members.items():
            archive.writestr(member, content)
    return path


def test_everything_in_an_archive_is_read_or_told(tmp_path: Path) -> None:
    farm = geojson(tmp_path, *ponds()).read_text()
    corners = ", ".join(f"{lon} {lat}" for lon, lat in square(5, 5))
    table_of_area = f'wkt,name\n"POLYGON (({corners}))",No fly\n'
    map_of_area = kml(tmp_path, placemark("No fly", kml_polygon(5, 5))).read_text()
    kmz = packed(tmp_path, {"doc.kml": map_of_area}, "nofly.kmz").read_bytes()
    inner = packed(tmp_path, {"deep/nofly.kmz": kmz}, "inner.zip").read_bytes()
    for name, content in (
        *(("nofly.csv", table_of_area), ("nofly.kmz", kmz), ("inner.zip", inner), ("nofly.txt", table_of_area)),
        ("nofly", map_of_area),
    ):
        read = read_farm(packed(tmp_path, {"ponds.geojson": farm, name: content}), depot=DEPOT)
        assert (ids(read), len(read.no_fly)) == (PONDS[:3], 1), name
    tables = {"ponds.geojson": farm, "depot.csv": "lat,lon\n10.0995,105.6985\n"}
    assert read_farm(packed(tmp_path, tables)).depot == DEPOT
    others: dict[str, str | bytes] = {"nofly.rar": b"Rar!", "readme.txt": "Hello", "samples.csv": "pond,oxygen\n1,4\n"}
    others |= {"lone.dbf": b"x", "photos.zip": packed(tmp_path, {"a.jpg": b"x"}, "p.zip").read_bytes(), "map.pdf": b"%"}
    [note] = read_farm(packed(tmp_path, {"ponds.geojson": farm, **others}), depot=DEPOT).notes
    assert all(repr(name) in note for name in others), note
    icon = (
        placemark("A", kml_polygon(0, 0))
        + "<Style><IconStyle><Icon><href>files/i.png</href></Icon></IconStyle></Style>"
    )
    with_icon: dict[str, str | bytes] = {
        "doc.kml": kml(tmp_path, icon).read_text(),
        "files/i.png": b"x",
        "__MACOSX/._doc.kml": b"x",
    }
    assert read_farm(packed(tmp_path, with_icon), depot=DEPOT).notes == ()
    broken = packed(tmp_path, {"ponds.geojson": farm, "nofly.kmz": b"PK\x03\x04"})
    assert faults_of(broken, depot=DEPOT)[0][0] == "nofly.kmz"


def test_archives_in_archives_share_one_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Room.__init__, "__defaults__", (50_000, 0))
    inner = packed(tmp_path, {"a.csv": "x" * 20_000}, "a.zip").read_bytes()
    members: dict[str, str | bytes] = {"1.zip": inner, "2.zip": inner}
    members["farm.geojson"] = geojson(tmp_path, *ponds()).read_text()
    assert any("would unpack to" in message for _, message, _ in faults_of(packed(tmp_path, members), depot=DEPOT))


def test_pipes_devices_and_links_to_other_files_are_not_opened(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "farm.geojson")
    assert "no regular file" in faults_of(tmp_path / "farm.geojson")[0][1]
    assert "no regular file" in faults_of(Path("/dev/zero"))[0][1]
    other = tmp_path / "secret.csv"
    other.write_text("name,lat,lon\nA,10.1,105.7\n")
    (tmp_path / "farm.vrt").write_text(
        f'<OGRVRTDataSource><OGRVRTLayer name="secret"><SrcDataSource>{other}</SrcDataSource>'
        "</OGRVRTLayer></OGRVRTDataSource>"
    )
    assert "known format" in faults_of(tmp_path / "farm.vrt")[0][1]
    with (tmp_path / "large.geojson").open("wb") as file:
        file.truncate(300_000_000)
    assert "300 MB" in faults_of(tmp_path / "large.geojson")[0][1]


def test_entities_are_refused(tmp_path: Path) -> None:
    (tmp_path / "farm.kml").write_text('<!DOCTYPE k [<!ENTITY a "b"><!ENTITY c "&a;&a;">]><kml>&c;</kml>')
    assert "entities" in faults_of(tmp_path / "farm.kml")[0][1]


def test_kml_as_map_programs_write_it(tmp_path: Path) -> None:
    track = "".join(f"<gx:coord>{lon} {lat} 0</gx:coord>" for lon, lat in square(2, 0))
    parts = [
        placemark("A", f"<MultiGeometry>{kml_polygon(0, 0)}</MultiGeometry>"),
        placemark("B", "<Point><coordinates>105.8, 10.1, 0</coordinates></Point>").replace("<name>", "<name>Pond "),
        placemark("C", f"<gx:Track>{track}</gx:Track>"),
        placemark("Depot", "<Point><coordinates>105.6985,10.0995</coordinates></Point>"),
    ]
    assert ids(read_farm(kml(tmp_path, *parts))) == ["A", "Pond B", "C"]
    declared = tmp_path / "latin.kml"
    document = f"<kml><Document>{placemark('Südteich', kml_polygon(0, 0))}</Document></kml>"
    text = f'<?xml version="1.0" encoding="ISO-8859-1"?>{document}'
    declared.write_bytes(text.encode("latin-1"))
    assert ids(read_farm(declared, depot=DEPOT)) == ["Südteich"]


def test_gpx_walks_end_near_their_start(tmp_path: Path) -> None:
    def walk(name: str, positions: list[list[float]], tag: str, point: str) -> str:
        points = "".join(f'<{point} lat="{lat}" lon="{lon}"/>' for lon, lat in positions)
        inner = f"<trkseg>{points}</trkseg>" if tag == "trk" else points
        return f"<{tag}><name>{name}</name>{inner}</{tag}>"

    nearly = [*square(0, 0)[:4], [105.70001, 10.10002]]
    passed = [*square(1, 0), [105.7021, 10.09999], [105.70212, 10.10002]]
    parts = [walk("Track 1", nearly, "trk", "trkpt"), walk("Track 2", square(2, 0), "rte", "rtept")]
    parts.append(walk("P", passed, "trk", "trkpt"))
    (tmp_path / "farm.gpx").write_text(f'<gpx xmlns="http://www.topografix.com/GPX/1/1">{"".join(parts)}</gpx>')
    farm = read_farm(tmp_path / "farm.gpx", depot=DEPOT)
    assert sorted(ids(farm)) == ["P", "Track 1", "Track 2"]
    assert any("was closed over the last" in note for note in farm.notes)


def test_arcgis_and_topojson(tmp_path: Path) -> None:
    hole = [[105.7003, 10.1003], [105.7006, 10.1003], [105.7006, 10.1006], [105.7003, 10.1006], [105.7003, 10.1003]]
    esri = {
        "features": [{"attributes": {"NAME": "A"}, "geometry": {"rings": [square(0, 0)[::-1], hole]}}],
        "spatialReference": {"wkid": 4326},
    }
    (tmp_path / "a.json").write_text(json.dumps(esri))
    [pond] = read_farm(tmp_path / "a.json", depot=DEPOT).ponds
    assert (pond.id, len(pond.outline)) == ("A", 2)
    topology = {
        "type": "Topology",
        "transform": {"scale": [0.0001, 0.0001], "translate": [105.7, 10.1]},
        "arcs": [[[0, 0], [18, 0], [0, 9]], [[18, 9], [-18, 0], [0, -9]]],
        "objects": {
            "ponds": {
                "type": "GeometryCollection",
                "geometries": [{"type": "Polygon", "arcs": [[0, 1]], "properties": {"name": "A"}}],
            }
        },
    }
    (tmp_path / "t.json").write_text(json.dumps(topology))
    [pond] = read_farm(tmp_path / "t.json", depot=DEPOT).ponds
    assert pond.sampling_point == pytest.approx((105.7009, 10.10045))


# ------------------------------------------------------------------------------------------------ depots and doubts


@pytest.mark.parametrize("lon", [180.0000001, 181.0, -181.0, 359.999])
def test_longitudes_of_a_turn_too_many_are_wrapped(tmp_path: Path, lon: float) -> None:
    farm = read_farm(
        geojson(tmp_path, shape("Point", [lon, -17.0], name="A")),
        depot=(0.0 + lon % 360 - (360 if lon % 360 > 180 else 0), -17.0),
    )
    assert abs(farm.ponds[0].sampling_point[0]) <= 180.0
    assert f"{lon:.10g}" in farm.notes[0]


def test_no_depot_is_proposed_in_a_pond(tmp_path: Path) -> None:
    for number in (1, 4, 9):
        path = geojson(tmp_path, *ponds(number))
        [(_, _, action)] = faults_of(path)
        lon, lat = map(float, action.rpartition(" around ")[2].split(","))
        farm = read_farm(path, depot=(lon, lat))
        assert all(clearance_m((lon, lat), pond.outline) < 0.0 for pond in farm.ponds)
        assert not any("lies in pond" in note for note in farm.notes)


def test_a_depot_in_a_pond_is_noted(tmp_path: Path) -> None:
    [note] = read_farm(geojson(tmp_path, *ponds()), depot=(105.7009, 10.1004)).notes
    assert note.startswith("The depot lies in Pond 1: drones would land in the water")


@pytest.mark.parametrize(
    "name", ["Home", "Launch pad", "Base", "Punto de despegue", "起飞点", "Nhà", "จุดขึ้นบิน", "Décollage"]
)
def test_a_place_that_may_be_the_depot_is_offered_and_never_sampled(tmp_path: Path, name: str) -> None:
    path = geojson(tmp_path, *ponds(), shape("Point", [105.6985, 10.0995], name=name))
    [(_, _, action)] = faults_of(path)
    assert f"{name!r} lies at 105.698500,10.099500" in action
    assert ids(read_farm(path, depot=DEPOT)) == PONDS[:3]


@pytest.mark.parametrize("width_deg", [1e-7, 1e-6, 1e-5, 1.7e-5])
def test_a_pond_without_room_for_a_drone_is_in_doubt(tmp_path: Path, width_deg: float) -> None:
    south, north = 10.103, 10.103 + width_deg
    ring = [[105.7, south], [105.701, south], [105.701, north], [105.7, north], [105.7, south]]
    sampled = [
        shape("Polygon", [ring], name="Pond 9"),
        shape("Polygon", [ring], name="P", sampling_point=[105.7, south]),
    ]
    for thin in sampled:
        farm = read_farm(geojson(tmp_path, *ponds(), thin), depot=DEPOT)
        assert [doubt.pond_id for doubt in farm.doubts] == [thin["properties"]["name"]]  # type: ignore[index]
        assert "m wide where it is widest" in farm.doubts[0].message
    wide = [[lon, lat if lat == south else south + 3e-5] for lon, lat in ring]
    assert read_farm(geojson(tmp_path, *ponds(), shape("Polygon", [wide], name="Pond 9")), depot=DEPOT).doubts == ()


CORNERS = "pond_id,lat_ul,lon_ul,lat_ur,lon_ur,lat_ll,lon_ll,lat_lr,lon_lr\n"


def test_guessed_places_are_doubts_until_they_are_accepted(tmp_path: Path) -> None:
    good = "1,10.102,105.70,10.102,105.702,10.101,105.70,10.101,105.702\n"
    off = "2,10.102,105.71,10.102,105.712,10.101,105.71,10.151,105.712\n"
    path = table(tmp_path, CORNERS + good + off)
    [doubt] = read_farm(path, depot=DEPOT).doubts
    assert doubt.pond_id == "2"
    assert "line 3: one corner lies far from the other three" in doubt.message
    assert read_farm(path, depot=DEPOT, accept=["1"]).doubts == (doubt,)
    assert read_farm(path, depot=DEPOT, accept=["2"]).doubts == ()
    assert read_farm(path, depot=DEPOT, accept=["all"]).doubts == ()


@pytest.mark.parametrize("name", ["P, north", "it's", "a,b", "1,2,3", "$(x)"])
def test_what_the_remedy_of_a_doubt_says_accepts_it(name: str, tmp_path: Path) -> None:
    overlapping = [shape("Polygon", [square(0, 0)], name=name), shape("Polygon", [square(0, 0, 0.0012)], name="a")]
    path = geojson(tmp_path, *overlapping, shape("Polygon", [square(4, 4)], name="b"))
    doubts = read_farm(path, depot=DEPOT).doubts
    assert doubts
    words = shlex.split(doubt_fault(doubts).action.partition("pass ")[2])
    assert set(words[::2]) == {"--accept"}
    assert read_farm(path, depot=DEPOT, accept=words[1::2]).doubts == ()
    assert read_farm(path, depot=DEPOT, accept=[",".join(words[1::2])]).doubts == ()
    assert read_farm(path, depot=DEPOT, accept=["b, a , " + name]).doubts == ()


def test_an_id_to_accept_that_no_pond_has_is_a_fault(tmp_path: Path) -> None:
    path = geojson(tmp_path, *(shape("Polygon", [square(i, 0)], name=f"Pond {i}") for i in (1, 3, 5)))
    with pytest.raises(InvalidInput) as caught:
        read_farm(path, depot=DEPOT, accept=["Pond 1,nosuch", "Pond 33"])
    told = [(fault.path, fault.message, fault.action) for fault in caught.value.faults]
    assert told == [
        ("accept", "there is no pond 'nosuch'", "give ids of ponds (Pond 1, Pond 3, Pond 5), or all"),
        ("accept", "there is no pond 'Pond 33'", "did you mean 'Pond 3'?"),
    ]


def test_notes_alike_are_counted(tmp_path: Path) -> None:
    slivers = [[105.72, 10.12], [105.7200001, 10.12], [105.72, 10.12]]
    parts = [shape("MultiPolygon", [[square(i % 3, i // 3)], [slivers]], name=f"Pond {i}") for i in range(60)]
    notes = read_farm(geojson(tmp_path, *parts), depot=DEPOT).notes
    assert len(notes) == 4
    assert notes[-1] == "The same 57 times more."
