"""What a feature is, told by columns, folders, tags and remarks of strangers' files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

from farm_files import DEPOT, faults_of, geojson, ids, kml, kml_polygon, placemark, polygon, shape
from pondhop.farm import Farm, read_farm


def codes(folder: Path, properties: Sequence[Mapping[str, object]], *, prefix: str = "P") -> Path:
    """Outlines with codes for names, which say nothing of what they are."""
    features = [
        polygon(index % 3, index // 3, **{"name": f"{prefix}{index + 1}", **given})
        for index, given in enumerate(properties)
    ]
    return geojson(folder, *features)


def of_kinds(folder: Path, column: str, *kinds: str | None) -> Path:
    return codes(folder, [{column: kind} for kind in kinds])


def read(path: Path) -> Farm:
    return read_farm(path, depot=DEPOT)


# ---------------------------------------------------------------------------------------------- columns of kinds


@pytest.mark.parametrize(
    "column",
    [
        *("Layer", "LAYER", "fclass", "landuse", "land_cover", "usage", "use", "group", "OBJ_TYPE", "what", "category"),
        *("用途", "类别", "Loại đất", "tipo", "uso", "ประเภท", "उपयोग", "الاستخدام", "xyz", "field_7"),
    ],
)
@pytest.mark.parametrize(
    ("pond", "others", "num_no_fly"),
    [
        ("pond", ("road", "building", "boundary", "no-fly", "office"), 1),
        ("鱼塘", ("道路", "房屋", "禁飞区"), 1),
        ("Ao nuôi", ("Đường", "Nhà kho", "Vùng cấm bay"), 1),
        ("Estanque", ("Camino", "Oficina", "Lindero"), 0),
        ("viveiro", ("estrada", "escritório"), 0),
        ("Kolam", ("Jalan", "Kantor"), 0),
        ("Aquaculture", ("Road", "Warehouse"), 0),
    ],
)
def test_a_column_of_kinds_tells_ponds_from_other_things(
    tmp_path: Path, column: str, pond: str, others: tuple[str, ...], num_no_fly: int
) -> None:
    farm = read(of_kinds(tmp_path, column, *[pond] * 4, *others))
    assert ids(farm) == ["P1", "P2", "P3", "P4"]
    assert len(farm.no_fly) == num_no_fly
    assert all(any(f"its {column} is {other!r}" in note for note in farm.notes) for other in others)


@pytest.mark.parametrize(
    ("pond", "other"), [("Water", "Built-up"), ("水域", "建设用地"), ("aqua", "other"), ("water", "river")]
)
def test_kinds_of_land_are_understood(tmp_path: Path, pond: str, other: str) -> None:
    assert ids(read(of_kinds(tmp_path, "Layer", *[pond] * 4, other))) == ["P1", "P2", "P3", "P4"]


def test_a_kind_without_a_word_is_asked_for_beside_ponds(tmp_path: Path) -> None:
    [(place, message, action)] = faults_of(of_kinds(tmp_path, "Layer", *["pond"] * 4, "Krempel"), depot=DEPOT)
    assert place == "features[4]"
    assert message == "'P5': is this a pond? its Layer is 'Krempel', and that of others is 'pond'"
    assert "role" in action
    features = [{"Layer": "pond", "role": None}] * 4 + [{"Layer": "Krempel", "role": "pond"}]
    assert len(read(codes(tmp_path, features)).ponds) == 5


@pytest.mark.parametrize("kind", ["RD", "0", "B", "BLDG", "TEXT_LABELS"])
def test_a_code_beside_kinds_of_ponds_is_asked_for(tmp_path: Path, kind: str) -> None:
    [(_, message, _)] = faults_of(of_kinds(tmp_path, "LAYER", *["PONDS"] * 4, kind), depot=DEPOT)
    assert f"its LAYER is {kind!r}, and that of others is 'PONDS'" in message


def test_headings_without_their_accents_are_known(tmp_path: Path) -> None:
    [(_, message, _)] = faults_of(of_kinds(tmp_path, "loai_dat", "ao", "ao", "duong"), depot=DEPOT)
    assert "its loai_dat is 'duong', and that of others is 'ao'" in message


def test_a_fault_names_the_id_where_there_is_no_name(tmp_path: Path) -> None:
    features = [polygon(at, 0, id=f"A{at}", Layer=kind) for at, kind in enumerate(["pond", "pond", "Krempel"])]
    [(_, message, _)] = faults_of(geojson(tmp_path, *features), depot=DEPOT)
    assert message.startswith("'A2': is this a pond? its Layer is 'Krempel'")


def test_a_fault_names_both_name_and_id(tmp_path: Path) -> None:
    features = [{"id": 70 + at, "Layer": kind} for at, kind in enumerate(["pond", "pond", "Krempel"])]
    [(_, message, _)] = faults_of(codes(tmp_path, features), depot=DEPOT)
    assert message.startswith("'P3' (id 72): is this a pond? its Layer is 'Krempel'")


def test_words_for_other_things_under_any_heading_are_asked_for(tmp_path: Path) -> None:
    faults = faults_of(of_kinds(tmp_path, "xyz", *[None] * 4, "road", "building"), depot=DEPOT)
    assert [place for place, _, _ in faults] == ["features[4]", "features[5]"]
    assert ids(read(of_kinds(tmp_path, "Layer", *[None] * 4, "road", "building"))) == ["P1", "P2", "P3", "P4"]


@pytest.mark.parametrize(
    ("column", "values"),
    [
        ("water_source", ["canal", "river", "canal", "well"]),
        ("Near", ["road", "office", "road", "office"]),
        ("Aerator", ["paddle wheel", "blower", "paddle wheel", "blower"]),
        ("species", ["tilapia", "shrimp", "tilapia", "shrimp"]),
        ("type", ["nursery", "grow-out", "nursery", "Broodstock"]),
        ("type", ["earthen", "fish pond", "lined", "concrete"]),
        ("Layer", ["A", "B", "A", "B"]),
        ("type", ["MultiPolygon", "pond", "MultiPolygon", "pond"]),
        ("Farm", ["Finca Norte", "Finca Sur", "Finca Sur", "Finca Norte"]),
        ("block", ["Zone A", "Zone B", "Zone A", "Zone B"]),
    ],
)
def test_what_a_column_says_of_ponds_makes_no_doubt(tmp_path: Path, column: str, values: list[str]) -> None:
    farm = read(of_kinds(tmp_path, column, *values))
    assert ids(farm) == ["P1", "P2", "P3", "P4"]
    assert not farm.doubts


@pytest.mark.parametrize(
    ("name", "kind", "reason"),
    [
        ("Tank 5", "building", "it is called 'Tank 5', but its Layer is 'building'"),
        ("House 5", "pond", "it is called 'House 5', but its Layer is 'pond'"),
    ],
)
def test_a_name_and_a_kind_that_contradict_each_other_are_asked_for(
    tmp_path: Path, name: str, kind: str, reason: str
) -> None:
    features = [{"Layer": "pond"}] * 4 + [{"Layer": kind, "name": name}]
    [(_, message, _)] = faults_of(codes(tmp_path, features), depot=DEPOT)
    assert reason in message


# ------------------------------------------------------------------------------------------------------- folders


def in_folder(name: str, *names: str, row: int = 0) -> str:
    inside = "".join(placemark(own, kml_polygon(column, row)) for column, own in enumerate(names))
    return f"<Folder><name>{name}</name>{inside}</Folder>"


@pytest.mark.parametrize("folder", ["Ponds", "鱼塘", "Ao nuôi", "Estanques"])
def test_what_lies_in_a_folder_beside_that_of_the_ponds_is_asked_for(tmp_path: Path, folder: str) -> None:
    ponds = in_folder(folder, "A1", "A2", "A3")
    [(_, message, _)] = faults_of(kml(tmp_path, ponds, in_folder("Krempel", "K7", row=1)), depot=DEPOT)
    assert message == f"'K7': is this a pond? it lies in 'Krempel', and ponds lie in {folder!r}"
    [(_, message, _)] = faults_of(kml(tmp_path, ponds, placemark("K7", kml_polygon(0, 1))), depot=DEPOT)
    assert message == f"'K7': is this a pond? it lies in no folder, and ponds lie in {folder!r}"


def test_a_folder_that_holds_the_whole_file_says_nothing(tmp_path: Path) -> None:
    inner = in_folder("Norte", "A1", "A2") + in_folder("Krempel", "K1", row=1)
    whole = f"<Folder><name>Pond survey</name>{inner}</Folder>"
    assert ids(read(kml(tmp_path, whole))) == ["A1", "A2", "K1"]


@pytest.mark.parametrize("folder", ["Nursery", "Block B", "B", "2024", "North"])
def test_folders_called_as_parts_of_farms_are_beside_those_of_ponds(tmp_path: Path, folder: str) -> None:
    path = kml(tmp_path, in_folder("Ponds", "A1", "A2"), in_folder(folder, "B1", row=1))
    assert ids(read(path)) == ["A1", "A2", "B1"]


def test_labels_and_lines_lie_in_folders_of_their_own(tmp_path: Path) -> None:
    label = placemark("A1", "<Point><coordinates>105.7005,10.1002</coordinates></Point>")
    line = placemark("x", "<LineString><coordinates>105.7,10.11 105.71,10.11</coordinates></LineString>")
    path = kml(tmp_path, in_folder("Ponds", "A1", "A2"), f"<Folder><name>Krempel</name>{label}{line}</Folder>")
    assert ids(read(path)) == ["A1", "A2"]


def test_names_say_what_folders_do_not(tmp_path: Path) -> None:
    path = kml(tmp_path, in_folder("Ponds", "A1", "A2"), in_folder("Krempel", "Pond 7", "Office", row=1))
    assert ids(read(path)) == ["A1", "A2", "Pond 7"]


# ---------------------------------------------------------------------------------------------------- tags of maps

WATER = {"natural": "water"}
TAGGED = [{"natural": "water", "water": "pond"}, {"landuse": "aquaculture"}, {"water": "basin"}, {"natural": "water"}]


@pytest.mark.parametrize("value", ["river", "canal", "ditch", "stream", "moat", "wastewater", "lock", "drain"])
@pytest.mark.parametrize("general", [WATER, {**WATER, "landuse": "basin"}, {"osm_id": "7"}, {}])
def test_rivers_and_canals_drawn_as_areas_are_no_ponds(tmp_path: Path, value: str, general: Mapping[str, str]) -> None:
    path = codes(tmp_path, [*TAGGED, {**general, "water": value}])
    if general:
        farm = read(path)
        assert ids(farm) == ["P1", "P2", "P3", "P4"]
        assert any(f"it has water={value}" in note for note in farm.notes)
    else:
        # A table may say in such a column where the water comes from.
        [(_, message, _)] = faults_of(path, depot=DEPOT)
        assert f"'P5': is this a pond? it has water={value}" in message


@pytest.mark.parametrize("value", ["riverbank", "dock", "canal", "boatyard", "lock_gate"])
def test_waterways_are_no_ponds(tmp_path: Path, value: str) -> None:
    assert len(read(codes(tmp_path, [*TAGGED, {**WATER, "waterway": value}])).ponds) == 4


@pytest.mark.parametrize(
    "packed",
    ['"water"=>"river"', '"intermittent"=>"no","water"=>"canal"', '"waterway"=>"riverbank"', {"water": "moat"}],
)
def test_tags_in_one_column_are_read(tmp_path: Path, packed: object) -> None:
    river = {"osm_id": "5", "natural": "water", "other_tags": packed}
    assert ids(read(codes(tmp_path, [*TAGGED, river]))) == ["P1", "P2", "P3", "P4"]


@pytest.mark.parametrize(
    "tags",
    [
        {**WATER, "water": "lake"},
        {**WATER, "water": "reservoir"},
        {"landuse": "reservoir"},
        {"landuse": "basin", "basin": "detention"},
        {**WATER, "water": "blub"},
    ],
)
def test_other_water_is_asked_for_beside_what_is_tagged_as_a_pond(tmp_path: Path, tags: Mapping[str, str]) -> None:
    [(_, message, _)] = faults_of(codes(tmp_path, [*TAGGED, tags]), depot=DEPOT)
    assert message.startswith("'P5': is this a pond? it has ")
    assert len(read(codes(tmp_path, [*TAGGED, {**tags, "name": "Pond 5"}])).ponds) == 5


@pytest.mark.parametrize(
    "tags", [{"landuse": "reservoir"}, {**WATER, "water": "lake"}, {**WATER, "barrier": "fence"}, WATER]
)
def test_water_is_a_pond_where_nothing_else_is(tmp_path: Path, tags: Mapping[str, str]) -> None:
    assert len(read(codes(tmp_path, [tags, tags, {"building": "yes", "osm_id": "3"}])).ponds) == 2


def test_a_column_about_water_is_no_tag(tmp_path: Path) -> None:
    assert len(read(codes(tmp_path, [{"water": "brackish"}, {"water": "fresh"}, {"water": "clear"}])).ponds) == 3


# --------------------------------------------------------------------------------------------------------- remarks

AGAINST = [
    *("Không bay", "không được bay qua", "Cấm bay", "no volar", "No sobrevolar!", "não sobrevoar", "NAO VOAR", "禁飞"),
    *("请勿飞行", "jangan terbang", "Dilarang terbang di sini", "ne pas survoler", "ห้ามบิน", "飛行しないでください"),
    *("उड़ान निषिद्ध", "لا تطير", "do not fly near the house", "stay away", "No fly - eagle nest", "out of service"),
    *("do not sample", "Do not sample until May", "drained", "Drained for repair", "pond is dry", "Currently empty"),
    *("Closed", "not in use", "Fuera de servicio", "Vacío", "fora de uso", "seca", "hors service", "à sec"),
    *("ngừng sử dụng", "Ao cạn nước", "Khô", "tidak dipakai", "kosong", "停用", "已排干", "空", "干塘", "사용 안함"),
    *("ไม่มีน้ำ", "खाली", "خارج الخدمة", "не используется", "terk edilmiş"),
]


@pytest.mark.parametrize("remark", AGAINST)
@pytest.mark.parametrize("column", ["remarks", "Ghi chú", "备注", "status", "Tình trạng"])
def test_a_remark_against_sampling_is_asked_for(tmp_path: Path, remark: str, column: str) -> None:
    for name in ("P5", "Pond 5"):
        [(place, message, action)] = faults_of(
            codes(tmp_path, [{}] * 4 + [{"name": name, column: remark}]), depot=DEPOT
        )
        assert (place, f"'{name}': is this a pond? its {column} is {remark!r}" in message) == ("features[4]", True)
        assert "role" in action


@pytest.mark.parametrize(
    "remark",
    [
        *("not drained", "no water quality issues", "dry season depth 1 m", "aerator out of order", "stocked 2020"),
        *("abandoned house nearby", "Active", "in use", "do not use antibiotics", "empty shells on the bank"),
        *("đang hoạt động", "en uso", "使用中", "未使用抗生素", "cerca de zona prohibida"),
        "closed to traffic in the north",
    ],
)
def test_other_remarks_are_no_reason_to_ask(tmp_path: Path, remark: str) -> None:
    assert len(read(codes(tmp_path, [{}, {}, {"remarks": remark}])).ponds) == 3


@pytest.mark.parametrize("column", ["xyz", "Anweisung für Piloten", "f_12"])
def test_orders_under_any_heading_are_heard(tmp_path: Path, column: str) -> None:
    assert faults_of(codes(tmp_path, [{}, {}, {column: "Do not fly here"}]), depot=DEPOT)
    assert len(read(codes(tmp_path, [{}, {}, {column: "dry"}])).ponds) == 3


@pytest.mark.parametrize(
    ("column", "against", "in_favour"),
    [
        ("active", False, True),
        ("sample", "no", "yes"),
        ("In use", "N", "Y"),
        ("Có nước", "không", "có"),
        ("启用", "否", "是"),
        ("fly", 0, 1),
        ("drained", True, False),
        ("out_of_service", "yes", "no"),
    ],
)
def test_an_answer_against_sampling_is_asked_for(
    tmp_path: Path, column: str, against: object, in_favour: object
) -> None:
    [(_, message, _)] = faults_of(codes(tmp_path, [{}, {}, {column: against}]), depot=DEPOT)
    assert f"'P3': is this a pond? its {column} is " in message
    assert len(read(codes(tmp_path, [{}, {}, {column: in_favour}])).ponds) == 3


@pytest.mark.parametrize("name", ["Pond 5 (out of service)", "P5 - drained", "Ao 5, không lấy mẫu", "5号塘 停用"])
def test_a_name_that_speaks_against_sampling_is_asked_for(tmp_path: Path, name: str) -> None:
    [(_, message, _)] = faults_of(codes(tmp_path, [{}] * 4 + [{"name": name}]), depot=DEPOT)
    assert "is this a pond? it is called" in message


# ---------------------------------------------------------------------------------------------------------- series


def named(folder: Path, *names: str) -> Path:
    return codes(folder, [{"name": name} for name in names])


def numbered(word: str, number: int) -> list[str]:
    return [f"{word}{at}" for at in range(1, number + 1)]


@pytest.mark.parametrize(
    ("others", "word", "number"),
    [
        *(([], "CTR", 6), (["P1", "P2"], "CTR", 4), (["P1", "P2"], "Ctr ", 2), (["P1", "P2"], "TFR-", 3)),
        *((numbered("P", 4), "LAB", 2), (numbered("P", 4), "EV", 3), (numbered("Pond ", 3), "HQ", 3)),
        *((numbered("P", 4), "House ", 4), (numbered("P", 9), "Hatchery ", 3), (["P1", "P2"], "House ", 2)),
        *((numbered("P", 4), "温室", 3), (numbered("P", 4), "Nhà ", 4), (numbered("P", 4), "Galpón ", 3)),
        *((numbered("A", 3), "Greenhouses #", 3), (numbered("Pond ", 4), "Hatchery ", 4)),
    ],
)
def test_a_series_that_may_be_ponds_is_one_question(tmp_path: Path, others: list[str], word: str, number: int) -> None:
    series = numbered(word, number)
    [(place, message, action)] = faults_of(named(tmp_path, *others, *series), depot=DEPOT)
    assert place == f"features[{len(others)}]"
    assert f"are these ponds? {number} features with the word {word.strip(' #-').casefold()!r}" in message
    assert all(repr(name) in message for name in series)
    assert "role" in action
    answered = [{"name": name} for name in others] + [{"name": name, "role": "pond"} for name in series]
    assert ids(read(codes(tmp_path, answered))) == [*others, *series]


@pytest.mark.parametrize("series", [["CTR-A", "CTR-B"], ["1 House", "2 House", "3 House"], ["Lab A", "Lab B", "Lab C"]])
def test_series_are_numbered_in_many_ways(tmp_path: Path, series: list[str]) -> None:
    [(_, message, _)] = faults_of(named(tmp_path, *numbered("P", 5), *series), depot=DEPOT)
    assert f"are these ponds? {len(series)} features" in message


def test_ids_that_are_codes_are_ponds_where_a_column_says_so(tmp_path: Path) -> None:
    features = [polygon(at, 0, pond_id=f"CTR{at}") for at in range(3)]
    assert ids(read(geojson(tmp_path, *features))) == ["CTR0", "CTR1", "CTR2"]


@pytest.mark.parametrize(
    ("series", "num_no_fly"),
    [
        (numbered("NFZ", 4), 4),
        (numbered("No fly ", 3), 3),
        (["CTR"], 1),
        (["CTR1"], 1),
        (numbered("House ", 2), 0),
        (numbered("Gate ", 4), 0),
        (numbered("Warehouse ", 3), 0),
        (["Lab 1", "Lab 2"], 0),
    ],
)
def test_a_series_that_says_what_it_is_is_not_asked_for(tmp_path: Path, series: list[str], num_no_fly: int) -> None:
    farm = read(named(tmp_path, *numbered("P", 6), *series))
    assert (ids(farm), len(farm.no_fly)) == (numbered("P", 6), num_no_fly)
    assert any(series[0] in note for note in farm.notes)


def test_folders_tell_what_a_series_is(tmp_path: Path) -> None:
    houses = in_folder("Buildings", *numbered("House ", 4), row=1)
    assert ids(read(kml(tmp_path, in_folder("Ponds", "A1", "A2"), houses))) == ["A1", "A2"]
    ponds = in_folder("Ponds", *numbered("CTR", 4), row=1)
    assert ids(read(kml(tmp_path, ponds, in_folder("Buildings", "B1")))) == numbered("CTR", 4)


def test_houses_that_are_points_among_outlines_are_houses(tmp_path: Path) -> None:
    outlines = [polygon(column, 0, name=f"P{column}") for column in range(3)]
    houses = [shape("Point", [105.72, 10.11 + 0.001 * at], name=f"House {at}") for at in range(1, 5)]
    assert len(read(geojson(tmp_path, *outlines, *houses)).ponds) == 3


# ------------------------------------------------------------------------------------------- words of many languages

THINGS = {
    "Chinese": """
        房屋, 员工宿舍, 饲料间, 孵化室, 泵房, 发电机房, 化验室, 大门, 停车场, 村道, 塘埂, 大坝, 水渠, 排水沟,
        高压线, 看塘房, 车间, 温室
    """,
    "Chinese (traditional)": """
        飼料室, 孵化場, 抽水機房, 發電機房, 檢驗室, 警衛室, 停車場, 產業道路, 魚塭堤, 渠道, 高壓線, 辦公樓,
        工寮, 民宅
    """,
    "Vietnamese": """
        nhà kho, kho cám, trại giống, trạm bơm, phòng thí nghiệm, ký túc xá, bãi đỗ xe, bờ ao, đê bao, mương,
        cột điện, chòi canh
    """,
    "Hindi": """
        गोदाम, हैचरी, पंप घर, जनरेटर, प्रयोगशाला, छात्रावास, मुख्य द्वार, पार्किंग, सड़क, तटबंध, नहर, नाली,
        बिजली लाइन, तालाब की मेड़
    """,
    "Arabic": """
        مستودع, مفرخة, محطة ضخ, مولد كهرباء, مختبر, سكن العمال, بوابة, موقف سيارات, طريق, سد, قناة, خندق,
        خط كهرباء, مبنى
    """,
    "Portuguese": """
        armazém, larvicultura, casa de bombas, gerador, alojamento, portão, estacionamento, estrada, talude,
        vala, linha de energia
    """,
    "Spanish": """
        bodega de alimento, caseta, generador, dormitorio, garita, parqueadero, camino, terraplén, acequia,
        línea eléctrica, cocina
    """,
    "Indonesian": """
        gudang pakan, pembenihan, rumah pompa, genset, asrama, gerbang, tempat parkir, jalan tani, pematang,
        selokan, tiang listrik
    """,
    "Thai": """
        โกดัง, โรงเพาะฟัก, โรงสูบน้ำ, เครื่องปั่นไฟ, ห้องแล็บ, หอพัก, ที่จอดรถ, ถนน, คันบ่อ, คูน้ำ, สายไฟ,
        ป้อมยาม, โรงเรือน
    """,
    "Bengali": """
        গুদাম, হ্যাচারি, পাম্প ঘর, জেনারেটর, পরীক্ষাগার, ছাত্রাবাস, গেট, পার্কিং, সড়ক, বেড়িবাঁধ,
        পুকুর পাড়, নালা, বিদ্যুৎ লাইন
    """,
    "Japanese": "餌小屋, 孵化場, 発電機室, 実験室, 宿舎, 駐車場, 農道, 堤防, 排水路, 送電線, 管理棟, 温室",
    "Korean": "사료창고, 부화장, 발전실, 실험실, 기숙사, 주차장, 제방, 배수로, 송전선, 경비실",
    "French": """
        entrepôt, écloserie, groupe électrogène, laboratoire, dortoir, parking, chemin, digue, fossé,
        ligne électrique
    """,
    "Turkish": "yem deposu, kuluçkahane, jeneratör, laboratuvar, otopark, yol, hendek, mutfak, ofis",
    "English": """
        feed mill, pond dike, transmission line, driveway, machine room, dormitory, oxygen tank, riverbank,
        container
    """,
}


def things(language: str) -> list[str]:
    return [word.strip() for word in THINGS[language].split(",")]


@pytest.mark.parametrize("language", THINGS)
def test_things_beside_ponds_are_known_by_their_names(tmp_path: Path, language: str) -> None:
    words = things(language)
    farm = read(named(tmp_path, *numbered("P", len(words)), *words))
    assert ids(farm) == numbered("P", len(words))


@pytest.mark.parametrize("language", THINGS)
def test_things_beside_ponds_are_known_by_their_kinds_and_folders(tmp_path: Path, language: str) -> None:
    words = things(language)
    assert ids(read(of_kinds(tmp_path, "xyz", "pond", "pond", *words))) == ["P1", "P2"]
    folders = [in_folder(word, f"K{row}", row=row) for row, word in enumerate(words, start=1)]
    assert ids(read(kml(tmp_path, in_folder("Ponds", "A1", "A2"), *folders))) == ["A1", "A2"]
