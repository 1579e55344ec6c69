"""What single formats hold: encodings of shapefiles, ponds drawn twice, totals, walked outlines, maps of ArcGIS."""

from __future__ import annotations

import itertools
import json
import struct
import zipfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyogrio
import pytest
import shapely

from farm_files import DEPOT, faults_of, geojson, ids, kml, kml_polygon, placemark, polygon, square, table, workbook
from pondhop.farm import read_farm


def shapefile(folder: Path, names: Sequence[str], codec: str, width: int, says: str | None = None) -> Path:
    """A shapefile whose names are cut at so many bytes, as programs write them that count bytes."""
    path = folder / "ponds.shp"
    shapes = shapely.to_wkb([shapely.Polygon(square(at % 3, at // 3)) for at in range(len(names))])
    filler = np.array(["x"] * len(names), dtype=object)
    pyogrio.raw.write(path, shapes, [filler], ["name"], geometry_type="Polygon", crs="EPSG:4326")
    records = [b" " + name.encode(codec)[:width].ljust(width) for name in names]
    header = struct.pack("<BBBBIHH20x", 3, 124, 1, 1, len(records), 65, 1 + width)
    field = b"name".ljust(11, b"\0") + b"C\0\0\0\0" + bytes([width, 0]) + b"\0" * 14
    path.with_suffix(".dbf").write_bytes(header + field + b"\r" + b"".join(records) + b"\x1a")
    path.with_suffix(".cpg").unlink(missing_ok=True)
    if says is not None:
        path.with_suffix(".cpg").write_text(says)
    return path


CHINESE = ("鱼塘一号", "鱼塘二号", "虾塘三号")
THAI = ("บ่อกุ้ง 1", "บ่อกุ้ง 2", "บ่อปลา 3")


@pytest.mark.parametrize(
    ("names", "codec", "width", "says", "expected"),
    [
        (CHINESE, "gbk", 80, None, CHINESE),
        (CHINESE, "gbk", 7, None, ("鱼塘一", "鱼塘二", "虾塘三")),
        (CHINESE, "utf-8", 11, None, ("鱼塘一", "鱼塘二", "虾塘三")),
        (CHINESE, "utf-8", 80, "ISO-8859-1", CHINESE),
        (CHINESE, "gbk", 80, "936", CHINESE),
        (THAI, "cp874", 20, None, THAI),
        (("Étang 1", "Étang 2", "Étang à 3"), "cp1252", 14, None, ("Étang 1", "Étang 2", "Étang à 3")),
        (("Étang 1", "Étang 2"), "cp1252", 14, "1252", ("Étang 1", "Étang 2")),
        (("Пруд 1", "Пруд 2", "Пруд 3"), "cp1251", 14, None, ("Пруд 1", "Пруд 2", "Пруд 3")),
        (("A1", "A2"), "ascii", 5, None, ("A1", "A2")),
        # A letter that ends a name is no letter that was cut, unless the field is full.
        (("A塘", "B塘", "C塘"), "gbk", 20, None, ("A塘", "B塘", "C塘")),
        (("A塘", "B塘", "C塘"), "gbk", 3, None, ("A塘", "B塘", "C塘")),
        (("Café", "Bonté"), "cp1252", 20, None, ("Café", "Bonté")),
        (("Pond é", "Pond à"), "cp1252", 6, None, ("Pond é", "Pond à")),
        (("P1 塘", "P2 塘"), "gbk", 20, None, ("P1 塘", "P2 塘")),
        (("東塘一", "東塘二"), "big5", 20, None, ("東塘一", "東塘二")),
    ],
)
def test_shapefiles_in_the_encodings_of_producers(
    tmp_path: Path, names: Sequence[str], codec: str, width: int, says: str | None, expected: Sequence[str]
) -> None:
    path = shapefile(tmp_path, names, codec, width, says)
    assert ids(read_farm(path, depot=DEPOT)) == list(expected)
    packed = tmp_path / "farm.zip"
    with zipfile.ZipFile(packed, "w") as archive:
        for part in tmp_path.glob("ponds.*"):
            archive.write(part, part.name)
    assert ids(read_farm(packed, depot=DEPOT)) == list(expected)


def test_a_guessed_encoding_is_told(tmp_path: Path) -> None:
    farm = read_farm(shapefile(tmp_path, CHINESE, "gbk", 80), depot=DEPOT)
    assert any("read as Chinese (GBK)" in note for note in farm.notes)


HEADINGS = ("name", "lat", "lon")


def sheet(prefix: str, north_deg: float = 0.0) -> list[Sequence[object]]:
    return [HEADINGS, *((f"{prefix}{at}", 10.1 + 0.001 * at + north_deg, 105.7) for at in range(4))]


@pytest.mark.parametrize(("prefix", "moved_deg"), [("P", 0.0), ("P", 0.0001), ("Pond ", 0.0), ("X", 0.000002)])
def test_sheets_with_the_same_ponds_are_asked_about(tmp_path: Path, prefix: str, moved_deg: float) -> None:
    faults = faults_of(workbook(tmp_path, Old=sheet("P"), New=sheet(prefix, moved_deg)), depot=DEPOT)
    assert [message for _, message, _ in faults] == ["4 ponds are there twice, in layers 'Old', 'New'"]
    assert "--layer 'Old'" in faults[0][2]
    assert len(read_farm(workbook(tmp_path, Old=sheet("P"), New=sheet(prefix)), depot=DEPOT, layers=["New"]).ponds) == 4


def test_layers_with_the_same_outlines_are_asked_about(tmp_path: Path) -> None:
    drawn = "".join(placemark("", kml_polygon(at, 0)) for at in range(3))
    folders = [f"<Folder><name>{name}</name>{drawn}</Folder>" for name in ("Draft", "Final")]
    assert faults_of(kml(tmp_path, *folders), depot=DEPOT)[0][1].startswith("3 ponds are there twice")


def test_layers_of_two_sites_are_not(tmp_path: Path) -> None:
    farm = read_farm(workbook(tmp_path, North=sheet(""), South=sheet("", 0.01)), depot=DEPOT)
    assert ids(farm)[:1] == ["North 0"]


@pytest.mark.parametrize("total", ["Total,,,5", "Tổng cộng,,,5", "合计,20.2,211.4,5", "Count: 2,,,", "TOTAL :,,,5"])
def test_the_line_of_totals_is_left_out(tmp_path: Path, total: str) -> None:
    farm = read_farm(table(tmp_path, f"name,lat,lon,area\nA,10.1,105.7,2\nB,10.101,105.7,3\n{total}\n"), depot=DEPOT)
    assert ids(farm) == ["A", "B"]
    assert any("sums up the table: line 4" in note for note in farm.notes)


def test_a_word_elsewhere_in_the_last_line_sums_up_nothing(tmp_path: Path) -> None:
    farm = read_farm(table(tmp_path, "name,lat,lon,size\nA,10.1,105.7,big\nB,10.101,105.7,average\n"), depot=DEPOT)
    assert ids(farm) == ["A", "B"]


def walked(column: int, *cuts: int) -> str:
    """Segments of a walk around a square, paused at some of its 24 steps."""
    ring = square(column, 0)
    steps = [
        (a[0] + (b[0] - a[0]) * part / 6, a[1] + (b[1] - a[1]) * part / 6)
        for a, b in itertools.pairwise(ring)
        for part in range(6)
    ]
    steps.append((ring[0][0], ring[0][1]))
    ends = [0, *cuts, len(steps)]
    return "".join(
        "<trkseg>" + "".join(f'<trkpt lat="{lat}" lon="{lon}"/>' for lon, lat in steps[begin:end]) + "</trkseg>"
        for begin, end in itertools.pairwise(ends)
    )


def gpx(folder: Path, **tracks: str) -> Path:
    path = folder / "farm.gpx"
    lines = "".join(f"<trk><name>{name}</name>{segments}</trk>" for name, segments in tracks.items())
    path.write_text(f'<gpx xmlns="http://www.topografix.com/GPX/1/1" version="1.1">{lines}</gpx>')
    return path


def test_a_paused_walk_is_one_outline(tmp_path: Path) -> None:
    farm = read_farm(gpx(tmp_path, P1=walked(0, 7, 15), P2=walked(2)), depot=DEPOT)
    assert ids(farm) == ["P1", "P2"]
    assert [len(pond.outline or ()) for pond in farm.ponds] == [1, 1]


def test_segments_that_are_walks_of_their_own_are_ponds_of_their_own(tmp_path: Path) -> None:
    farm = read_farm(gpx(tmp_path, P=walked(0) + walked(3)), depot=DEPOT)
    assert len(farm.ponds) == 2
    assert any("2 parts are 2 ponds" in note for note in farm.notes)


def test_half_a_walk_is_a_fault(tmp_path: Path) -> None:
    assert "open line" in faults_of(gpx(tmp_path, P1=walked(0, 12).partition("</trkseg>")[0] + "</trkseg>"))[0][1]


FEATURE_SET = {
    "geometryType": "esriGeometryPolygon",
    "features": [
        {
            "attributes": {"name": f"P{at}"},
            "geometry": {"rings": [square(at, 0)], "spatialReference": {"wkid": 4326}},
        }
        for at in range(2)
    ],
}


def arcgis(folder: Path, document: object) -> Path:
    path = folder / "map.json"
    path.write_text(json.dumps(document))
    return path


def test_the_layers_of_an_arcgis_map_are_read(tmp_path: Path) -> None:
    layer = {"layerDefinition": {"name": "Ponds"}, "featureSet": FEATURE_SET}
    for document in (layer, {"layers": [layer]}, {"operationalLayers": [{"featureCollection": {"layers": [layer]}}]}):
        assert ids(read_farm(arcgis(tmp_path, document), depot=DEPOT)) == ["P0", "P1"]


def test_a_map_in_web_mercator_is_brought_to_degrees(tmp_path: Path) -> None:
    ring = [[11766000.0 + x, 1130000.0 + y] for x, y in ((0, 0), (0, 90), (90, 90), (90, 0), (0, 0))]
    feature = {"attributes": {"name": "P"}, "geometry": {"rings": [ring], "spatialReference": {"wkid": 102100}}}
    layer = {"featureSet": {"geometryType": "esriGeometryPolygon", "features": [feature]}}
    [pond] = read_farm(arcgis(tmp_path, {"layers": [layer]}), depot=(105.69, 10.1)).ponds
    assert [round(degrees, 1) for degrees in pond.sampling_point] == [105.7, 10.1]


def test_a_map_of_links_is_refused_with_what_to_do(tmp_path: Path) -> None:
    path = arcgis(tmp_path, {"operationalLayers": [{"title": "Ponds {1}", "url": "services/FeatureServer/0"}]})
    [(_, message, action)] = faults_of(path, depot=DEPOT)
    assert "only links to its layers on a server ('Ponds {1}')" in message
    assert "export it" in action


def test_one_pond_drawn_twice_in_one_layer_is_in_doubt(tmp_path: Path) -> None:
    farm = read_farm(geojson(tmp_path, polygon(0, 0, name="Pond 1"), polygon(0, 0, name="Pond 2")), depot=DEPOT)
    assert len(farm.doubts) == 2
