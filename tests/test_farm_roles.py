"""What a feature is by the words of columns, folders, map tags, remarks and numbered series."""

from __future__ import annotations

from pathlib import Path

import pytest

from farm_files import DEPOT, faults_of, geojson, ids, kml, kml_polygon, placemark, polygon
from pondhop.farm import Farm, read_farm
from pondhop.farm.words import Meaning, is_out_of_use, keeps_drones_out, meanings


def farm_with_column(folder: Path, heading: str, *values: str) -> Path:
    features = [polygon(at % 3, at // 3, id=str(at + 1), **{heading: value}) for at, value in enumerate(values)]
    return geojson(folder, *features)


def doubted(path: Path) -> list[str]:
    return [message for _, message, _ in faults_of(path, depot=DEPOT) if "is this a pond?" in message]


@pytest.mark.parametrize(
    ("heading", "values"),
    [
        ("Layer", ("pond", "road", "building")),
        ("OBJ_TYPE", ("POND", "ROAD", "OFFICE")),
        ("group", ("Ponds", "Buildings", "Roads")),
        ("what", ("pond", "house", "dike")),
        ("类别", ("鱼塘", "房屋", "道路")),
        ("Loại đất", ("ao", "nhà", "đường")),
        ("uso", ("estanque", "casa", "vía")),
        ("objekt", ("kolam", "jalan", "kantor")),
        ("fclass", ("water", "residential", "riverbank")),
        ("landuse", ("aquaculture", "road")),
    ],
)
def test_a_column_whose_values_are_words_of_roles_tells(tmp_path: Path, heading: str, values: tuple[str, ...]) -> None:
    pond, *others = values
    farm = read_farm(farm_with_column(tmp_path, heading, pond, pond, pond, *others), depot=DEPOT)
    assert ids(farm) == ["1", "2", "3"]
    assert any(heading in note for note in farm.notes)


@pytest.mark.parametrize(
    ("heading", "values"),
    [
        ("usage", ("culture", "office")),
        ("用途", ("养殖", "办公室")),
        ("land_cover", ("clear", "forest")),
        ("next to", ("pond", "road")),
    ],
)
def test_a_column_that_may_say_what_a_thing_is_is_asked_about(
    tmp_path: Path, heading: str, values: tuple[str, str]
) -> None:
    culture, other = values
    told = doubted(farm_with_column(tmp_path, heading, culture, culture, culture, other))
    assert len(told) == 1
    assert other in told[0]


def test_columns_about_ponds_lose_none(tmp_path: Path) -> None:
    supply = read_farm(farm_with_column(tmp_path, "supply", "canal", "canal", "well", "river"), depot=DEPOT)
    assert len(supply.ponds) == 4
    mixed = read_farm(farm_with_column(tmp_path, "water from", "pond 3", "canal", "rain"), depot=DEPOT)
    assert len(mixed.ponds) == 3


def test_a_no_fly_zone_of_a_layer_is_kept_out_of(tmp_path: Path) -> None:
    farm = read_farm(farm_with_column(tmp_path, "Layer", "pond", "pond", "no-fly"), depot=DEPOT)
    assert (len(farm.ponds), len(farm.no_fly)) == (2, 1)


@pytest.mark.parametrize(
    "tags",
    [
        {"natural": "water", "water": "river"},
        {"natural": "water", "water": "canal"},
        {"natural": "water", "water": "moat"},
        {"natural": "water", "water": "wastewater"},
        {"waterway": "riverbank"},
        {"waterway": "dock", "natural": "water"},
    ],
)
def test_rivers_and_canals_of_openstreetmap_are_no_ponds(tmp_path: Path, tags: dict[str, str]) -> None:
    ponds = [polygon(at, 0, **{"@id": f"way/{at}", "natural": "water", "water": "pond"}) for at in range(2)]
    farm = read_farm(geojson(tmp_path, *ponds, polygon(2, 0, **{"@id": "way/9", **tags})), depot=DEPOT)
    assert len(farm.ponds) == 2
    assert any("no pond" in note for note in farm.notes)


@pytest.mark.parametrize("tags", [{"natural": "water"}, {"natural": "water", "water": "lake"}, {"landuse": "basin"}])
def test_still_waters_of_openstreetmap_are_ponds(tmp_path: Path, tags: dict[str, str]) -> None:
    assert len(read_farm(geojson(tmp_path, polygon(0, 0, **{"@id": "way/9", **tags})), depot=DEPOT).ponds) == 1


@pytest.mark.parametrize(
    "remark",
    [
        "Không bay",
        "उड़ान निषेध",
        "não sobrevoar",
        "jangan terbang",
        "do not fly",
        "请勿飞",
        "ne pas survoler",
        "nicht überfliegen",
    ],
)
def test_a_remark_that_nobody_flies_there_is_asked_about(tmp_path: Path, remark: str) -> None:
    assert keeps_drones_out(remark)
    features = (polygon(0, 0, name="P1", remarks=""), polygon(1, 0, name="P2", remarks=remark))
    assert len(doubted(geojson(tmp_path, *features))) == 1


@pytest.mark.parametrize(
    "remark",
    [
        "drained",
        "Drained 12.5.",
        "dry since May",
        "khô",
        "seco",
        "sem água",
        "kering",
        "干塘",
        "已排干",
        "empty; clean it",
    ],
)
def test_a_remark_that_a_pond_is_out_of_use_is_asked_about(tmp_path: Path, remark: str) -> None:
    features = (polygon(0, 0, name="P1", status="in use"), polygon(1, 0, name="P2", status=remark))
    assert len(doubted(geojson(tmp_path, *features))) == 1


@pytest.mark.parametrize("remark", ["dry feed 20 kg", "Dry Creek side", "never dry", "empty bags here", "active", "12"])
def test_other_remarks_say_nothing_of_use(remark: str) -> None:
    assert not is_out_of_use(remark)


def folder(name: str, *parts: str) -> str:
    return f"<Folder><name>{name}</name>{''.join(parts)}</Folder>"


def pond_folder(number: int = 3) -> str:
    return folder("Ponds", *(placemark(f"P{at}", kml_polygon(at, 0)) for at in range(number)))


@pytest.mark.parametrize(
    ("called", "name"), [("厨房", "1"), ("Nhà công nhân", "A"), ("Cozinha", "x"), ("इमारत", "1"), ("مستودع", "1")]
)
def test_folders_of_buildings_are_left_out_in_many_languages(tmp_path: Path, called: str, name: str) -> None:
    farm = read_farm(kml(tmp_path, pond_folder(), folder(called, placemark(name, kml_polygon(0, 3)))), depot=DEPOT)
    assert ids(farm) == ["P0", "P1", "P2"]


def test_beside_a_folder_of_ponds_other_folders_are_asked_about(tmp_path: Path) -> None:
    path = kml(tmp_path, pond_folder(), folder("Phase two", placemark("Omega", kml_polygon(0, 3))))
    assert doubted(path) == ["'Omega': is this a pond? it lies in 'Phase two', and ponds in 'Ponds'"]


def test_what_is_called_like_the_ponds_is_one_in_any_folder(tmp_path: Path) -> None:
    farm = read_farm(kml(tmp_path, pond_folder(), folder("Phase two", placemark("P7", kml_polygon(0, 3)))), depot=DEPOT)
    assert ids(farm) == ["P0", "P1", "P2", "P7"]


def numbered(folder_path: Path, word: str, number: int) -> Path:
    ponds = [polygon(at, 0, name=f"P{at}") for at in range(6)]
    return geojson(folder_path, *ponds, *(polygon(at, 3, name=f"{word} {at + 1}") for at in range(number)))


@pytest.mark.parametrize("word", ["House", "Lab", "Hatchery", "Greenhouse", "Galpón", "Nhà", "CTR"])
def test_numbered_houses_and_codes_beside_ponds_are_asked_about(tmp_path: Path, word: str) -> None:
    assert len(doubted(numbered(tmp_path, word, 3))) == 3


def test_one_house_and_numbered_roads_are_left_out(tmp_path: Path) -> None:
    def left(farm: Farm) -> int:
        return len(farm.ponds)

    assert left(read_farm(numbered(tmp_path, "House", 1), depot=DEPOT)) == 6
    assert left(read_farm(numbered(tmp_path, "Road", 4), depot=DEPOT)) == 6
    assert left(read_farm(numbered(tmp_path, "No fly", 3), depot=DEPOT)) == 6


@pytest.mark.parametrize(
    "name", ["塘埂", "คันบ่อ", "kho lạnh", "bengkel", "portaria", "দেয়াল", "दीवार", "مختبر", "restroom"]
)
def test_everyday_words_of_farms_are_no_ponds(name: str) -> None:
    assert Meaning.OTHER in meanings(name)
    assert Meaning.POND not in meanings(name)
