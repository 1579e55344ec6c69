"""What strangers' farm files brought up, each kind with a few files of its own."""

from __future__ import annotations

from math import cos, radians
from pathlib import Path
from unicodedata import lookup

import pytest

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
    workbook,
)
from pondhop.farm import Farm, read_farm
from pondhop.farm.shapes import METRES_PER_DEGREE, area_m2, clearance_m, places_together
from pondhop.farm.words import pond_called
from pondhop.places import wrapped_longitude


def points(folder: Path, *names: str, heading: str = "name") -> Path:
    """A table with a point a line."""
    lines = (f"{name},{10.1 + 0.001 * row:.4f},105.7" for row, name in enumerate(names))
    return table(folder, "\n".join((f"{heading},lat,lon", *lines)))


def told(farm: Farm, words: str) -> bool:
    return any(words in note for note in farm.notes)


# ------------------------------------------------------------------------------- stations that are sampling points


@pytest.mark.parametrize(
    "names",
    [
        [f"Station {number}" for number in range(1, 9)],
        ["Waypoint 1", "Waypoint 2", "Waypoint 3"],
        ["WP 1", "WP 2", "WP 3"],
        ["Dock 1", "Dock 2"],
        ["Sampling station 3", "Sampling station 4"],
        ["Station A", "Station B", "Station C"],
        ["Station North", "Station South"],
        ["Estación 1", "Estación 2"],
        ["Trạm 1", "Trạm 2"],
        ["Stasiun 01", "Stasiun 02"],
        ["STATION_7", "STATION_8", "STATION_9"],
        ["Station 1 upstream", "Station 2 by Smith's", "Station 3"],
    ],
)
def test_numbered_points_of_one_word_are_the_ponds_where_nothing_else_is(tmp_path: Path, names: list[str]) -> None:
    assert ids(read_farm(points(tmp_path, *names), depot=DEPOT)) == names
    with_others = read_farm(points(tmp_path, *names, "Office", "Depot", "Weather station"))
    assert ids(with_others) == names
    waypoints = "".join(
        f'<wpt lat="10.{n + 100}" lon="105.7"><name>{name}</name></wpt>' for n, name in enumerate(names)
    )
    (tmp_path / "farm.gpx").write_text(f"<gpx>{waypoints}</gpx>", "utf-8")
    assert ids(read_farm(tmp_path / "farm.gpx", depot=DEPOT)) == names


def test_a_note_says_that_stations_are_taken_as_ponds(tmp_path: Path) -> None:
    farm = read_farm(points(tmp_path, "Station 1", "Station 2", "Station 3"), depot=DEPOT)
    [note] = farm.notes
    assert note.startswith(
        "3 points with the word 'station' are taken as ponds, because no other feature is one: 'Stat"
    )
    assert farm.stations == ()


def test_stations_of_drones_stay_what_they_are(tmp_path: Path) -> None:
    docks = [shape("Point", [105.71, 10.11 + 0.001 * n], name=f"Dock {n}") for n in range(1, 4)]
    farm = read_farm(geojson(tmp_path, *ponds(), *docks), depot=DEPOT)
    assert (len(farm.ponds), len(farm.stations)) == (3, 3)
    assert told(farm, "3 stations are in the file; plans do not use stations yet: 'Dock 1' (features[3])")
    assert told(farm, "To sample there, give them the role pond.")
    codes = read_farm(points(tmp_path, "A1", "A2", "A3", "Dock 1", "Dock 2"), depot=DEPOT)
    assert (ids(codes), len(codes.stations)) == (["A1", "A2", "A3"], 2)
    lone = read_farm(points(tmp_path, "Station 1", "Station 2", "Station 3", "Dock"), depot=DEPOT)
    assert (len(lone.ponds), len(lone.stations)) == (3, 1)


@pytest.mark.parametrize(
    ("others", "names", "word"),
    [
        (["A1", "B2", "C3"], ["Dock 1", "Dock 2", "Dock 3", "Dock 4"], "dock"),
        (["1", "2", "3"], ["Sensor 1", "Sensor 2", "Sensor 3", "Sensor 4"], "sensor"),
        (["1", "2", "3"], ["Sensor 1", "Sensor 2"], "sensor"),
        (["Berta", "Anna", "Carl"], [f"Waypoint {number}" for number in range(1, 5)], "waypoint"),
        (["Anna"], ["Dock 1", "Dock 2"], "dock"),
        (["Anna", "Berta"], ["Station 1", "Station 2"], "station"),
    ],
)
def test_numbered_points_beside_others_are_one_question(
    tmp_path: Path, others: list[str], names: list[str], word: str
) -> None:
    [(place, message, action)] = faults_of(points(tmp_path, *others, *names, "Depot"))
    assert place == f"line {2 + len(others)}"
    assert f"are these ponds? {len(names)} points with the word {word!r}" in message
    assert all(repr(name) in message for name in names)
    assert "role" in action
    text = points(tmp_path, *others, *names).read_text("utf-8").replace("\n", ",pond\n").replace(",pond", ",role", 1)
    answered = read_farm(table(tmp_path, f"{text},pond\n"), depot=DEPOT)
    assert ids(answered) == [*others, *names]


def test_two_series_are_in_doubt_whichever_comes_first(tmp_path: Path) -> None:
    docks, stations = [f"Dock {number}" for number in (1, 2)], [f"Station {number}" for number in (1, 2, 3)]
    for names in ([*docks, *stations], [*stations, *docks], [*docks, *stations[:2]]):
        faults = faults_of(points(tmp_path, *names), depot=DEPOT)
        assert sorted(message.split("the word ")[1].split()[0] for _, message, _ in faults) == ["'dock'", "'station'"]


@pytest.mark.parametrize("others", [["Pond 1"], ["Sampling point 1"], ["Laguna Norte"]])
def test_no_number_of_stations_beside_a_pond_is_asked_for(tmp_path: Path, others: list[str]) -> None:
    farm = read_farm(points(tmp_path, *others, "Dock 1", "Dock 2", "Dock 3"), depot=DEPOT)
    assert (ids(farm), len(farm.stations)) == (others, 3)


@pytest.mark.parametrize(
    ("names", "what", "word"),
    [
        (["Charging station 1", "Charging station 2"], "a station of the drones", "charging station"),
        (["Weather station 1", "Weather station 2"], "something beside ponds", "weather station"),
        (["Gate 1", "Gate 2", "Gate 3"], "something beside ponds", "gate"),
        (["Station 1"], "a station of the drones", "station"),
    ],
)
def test_a_file_without_a_pond_says_what_each_thing_was_taken_for(
    tmp_path: Path, names: list[str], what: str, word: str
) -> None:
    [(place, message, action)] = faults_of(points(tmp_path, *names), depot=DEPOT)
    assert place == "file"
    are = "1 feature" if len(names) == 1 else f"{len(names)} features"
    assert message.startswith(f"there is no pond in this file: {are} taken for {what} by the word {word!r}: ")
    assert all(repr(name) in message for name in names)
    assert "the role pond" in action


def test_a_file_without_a_pond_tells_ids_and_roles(tmp_path: Path) -> None:
    things = [
        polygon(0, 0, id="7", name="Office"),
        shape("Point", [105.7, 10.1], role="station", name="S"),
        shape("Point", [105.7, 10.1], name="Depot"),
    ]
    [(_, message, _)] = faults_of(geojson(tmp_path, *things))
    assert "1 feature taken for something beside ponds by the word 'office': 'Office' (id 7, features[0])" in message
    assert "1 feature taken for a station of the drones by its role: 'S' (features[1])" in message
    assert "1 feature taken for the depot by the word 'depot': 'Depot' (features[2])" in message


def test_folders_and_kinds_called_stations_hold_ponds_where_nothing_else_is(tmp_path: Path) -> None:
    inside = "".join(
        placemark(f"{n}", f"<Point><coordinates>105.7,10.10{n}</coordinates></Point>") for n in range(1, 5)
    )
    other = placemark("Depot", "<Point><coordinates>105.6985,10.0995</coordinates></Point>")
    for name in ("Stations", "station_samples", "Waypoints"):
        path = kml(tmp_path, f"<Folder><name>{name}</name>{inside}</Folder>", f"<Folder>{other}</Folder>")
        assert ids(read_farm(path)) == ["1", "2", "3", "4"]
    kinds = "name,type,lat,lon\n" + "".join(f"S{n},station,10.10{n},105.7\n" for n in range(1, 5))
    assert ids(read_farm(table(tmp_path, kinds), depot=DEPOT)) == ["S1", "S2", "S3", "S4"]
    explicit = kinds.replace("type", "role")
    assert "a station of the drones by its role" in faults_of(table(tmp_path, explicit), depot=DEPOT)[0][1]


def test_a_station_with_what_only_ponds_have_is_a_pond(tmp_path: Path) -> None:
    text = "name,service_s,lat,lon\nPond 1,,10.1,105.7\nStation 2,40,10.101,105.7\n"
    assert ids(read_farm(table(tmp_path, text), depot=DEPOT)) == ["Pond 1", "Station 2"]


# ------------------------------------------------------------------------------------------- cut at the 180th meridian


def box(west: float, south: float, east: float, north: float) -> list[list[float]]:
    return [[west, south], [east, south], [east, north], [west, north], [west, south]]


@pytest.mark.parametrize("edge", [180.0, 179.999995])
def test_a_pond_cut_at_the_180th_meridian_is_one(tmp_path: Path, edge: float) -> None:
    parts = [[box(179.999, -17.001, edge, -17.0)], [box(-edge, -17.001, -179.9995, -17.0)]]
    farm = read_farm(geojson(tmp_path, shape("MultiPolygon", parts, name="A")), depot=(179.998, -17.0))
    [pond] = farm.ponds
    assert pond.id == "A"
    assert pond.sampling_point == pytest.approx((179.99975, -17.0005), abs=1e-6)
    assert area_m2(pond.outline) == pytest.approx(1.5e-3 * 1e-3 * METRES_PER_DEGREE**2 * cos(radians(17.0)), rel=0.01)
    assert told(farm, "'A' (features[0]): 2 parts that meet on the 180th meridian were put together")


def test_an_island_cut_at_the_meridian_is_whole_again(tmp_path: Path) -> None:
    west = [[179.999, -17.001], [180, -17.001], [180, -17.0007], [179.9998, -17.0007], [179.9998, -17.0003]]
    west += [[180, -17.0003], [180, -17], [179.999, -17], [179.999, -17.001]]
    east = [[-lon, lat] for lon, lat in west]
    farm = read_farm(geojson(tmp_path, shape("MultiPolygon", [[west], [east]], name="A")), depot=(179.998, -17.0))
    [pond] = farm.ponds
    assert [len(set(ring)) for ring in pond.outline] == [6, 6]
    assert clearance_m((180.0, -17.0005), pond.outline) < 0.0


def test_ponds_that_only_lie_near_the_meridian_stay_apart(tmp_path: Path) -> None:
    apart = [[box(179.999, -17.001, 180, -17.0)], [box(-180, -16.999, -179.999, -16.998)]]
    near = [[box(179.999, -17.001, 179.9999, -17.0)], [box(-179.9999, -17.001, -179.999, -17.0)]]
    touching = [[box(105.7, 10.1, 105.701, 10.101)], [box(105.701, 10.1, 105.702, 10.101)]]
    for parts, depot in ((apart, (179.998, -17.0)), (near, (179.998, -17.0)), (touching, DEPOT)):
        assert len(read_farm(geojson(tmp_path, shape("MultiPolygon", parts, name="A")), depot=depot).ponds) == 2
    three = [*apart, [box(-180, -17.001, -179.9995, -17.0)]]
    assert ids(read_farm(geojson(tmp_path, shape("MultiPolygon", three, name="A")), depot=(179.998, -17.0))) == [
        "A 1",
        "A 2",
    ]


def test_the_note_of_parts_put_together_counts_them_right(tmp_path: Path) -> None:
    first = [[box(179.999, -17.001, 180, -17.0)], [box(-180, -17.001, -179.999, -17.0)]]
    second = [[box(179.999, -17.004, 180, -17.003)], [box(-180, -17.004, -179.999, -17.003)]]
    apart = [[box(179.99, -17.004, 179.991, -17.003)]]
    for parts, counts in (([*first, *second], (4, 2)), ([*first, *second, *apart], (5, 3)), ([*first, *apart], (3, 2))):
        farm = read_farm(geojson(tmp_path, shape("MultiPolygon", parts, name="A")), depot=(179.998, -17.0))
        assert len(farm.ponds) == counts[1]
        sentence = "of its {} parts, those that meet on the 180th meridian were put together, to {}.".format(*counts)
        assert told(farm, sentence)


def test_areas_and_lines_cut_at_the_meridian_are_one(tmp_path: Path) -> None:
    pond = shape("Point", [-179.9998, -17.0005], id="P")
    fence = [[box(179.99, -17.01, 180, -16.99)], [box(-180, -17.01, -179.99, -16.99)]]
    zone = [[box(179.995, -17.001, 180, -17.0)], [box(-180, -17.001, -179.9999, -17.0)]]
    walk = [[[180, -17.002], [179.999, -17.002], [179.999, -17.003], [180, -17.003]]]
    walk += [[[-180, -17.002], [-179.999, -17.002], [-179.999, -17.003], [-180, -17.003]]]
    areas = [shape("MultiPolygon", fence, role="fence"), shape("MultiPolygon", zone, role="no_fly")]
    path = geojson(tmp_path, pond, *areas, shape("MultiLineString", walk, name="Pond W"))
    farm = read_farm(path, depot=(179.998, -17.003))
    assert (ids(farm), len(farm.fences), len(farm.no_fly)) == (["P", "Pond W"], 1, 1)
    assert farm.ponds[1].sampling_point == pytest.approx((180.0, -17.0025))


# ------------------------------------------------------------------------------------------------- holes of areas


def around(lon: float, lat: float, half_width: float) -> list[list[float]]:
    return box(lon - half_width, lat - half_width, lon + half_width, lat + half_width)


def test_what_becomes_of_the_holes_of_areas_is_noted(tmp_path: Path) -> None:
    away = [around(105.73, 10.1, 0.01), around(105.725, 10.1, 0.001), around(105.735, 10.1, 0.001)]
    fence = [around(105.7, 10.1, 0.05), around(105.67, 10.1, 0.001)]
    areas = [shape("Polygon", away, name="No fly"), shape("Polygon", fence, name="Geofence")]
    farm = read_farm(geojson(tmp_path, *ponds(), *areas), depot=DEPOT)
    assert told(farm, "'No fly' (features[3]): its 2 holes are kept out of too, because autopilots store no-fly zones")
    assert told(farm, "'Geofence' (features[4]): its hole is kept out of, as a no-fly zone.")
    assert [len(area) for area in farm.kept_out] == [1, 1]


def test_a_farm_in_the_hole_of_a_zone_may_be_flown(tmp_path: Path) -> None:
    ring = [around(105.7, 10.1, 0.1), around(105.7, 10.1, 0.02)]
    farm = read_farm(geojson(tmp_path, *ponds(), shape("Polygon", ring, name="No fly")), depot=DEPOT)
    assert (len(farm.ponds), len(farm.no_fly)) == (3, 1)
    assert told(farm, "the depot lies in a hole of it, and drones stay inside that hole")
    assert [len(area) for area in farm.kept_out] == [2]


def test_ponds_in_the_hole_of_a_fence_are_outside_of_it(tmp_path: Path) -> None:
    ring = [around(105.7, 10.1, 0.1), around(105.7, 10.1, 0.02)]
    path = geojson(tmp_path, *ponds(), shape("Polygon", ring, name="Geofence"))
    assert "but 0% of the ponds lie in it" in faults_of(path, depot=DEPOT)[0][1]


# ------------------------------------------------------------------------------------------ ponds in and upon others


def pond_of(*rings: list[list[float]], **properties: object) -> dict[str, object]:
    return shape("Polygon", rings, **properties)


def test_a_pond_on_an_island_of_another_is_in_no_doubt(tmp_path: Path) -> None:
    outer = pond_of(around(105.7, 10.1, 0.002), around(105.7, 10.1, 0.001), name="Pond 1")
    for inner in (
        [pond_of(around(105.7, 10.1, 0.0005), name="Pond 2")],
        [pond_of(around(105.7, 10.1, 0.001), name="Pond 2")],
        [pond_of(around(105.7 + dx, 10.1, 0.0002), name=f"Pond {n}") for n, dx in ((2, -0.0005), (3, 0), (4, 0.0005))],
        [shape("Point", [105.7, 10.1], name="Pond 2")],
    ):
        farm = read_farm(geojson(tmp_path, outer, *inner), depot=(105.69, 10.0995))
        assert (len(farm.ponds), farm.doubts, farm.notes) == (1 + len(inner), (), ())


def test_a_pond_in_the_water_of_another_is_a_doubt(tmp_path: Path) -> None:
    for outer in (
        pond_of(around(105.7, 10.1, 0.002), name="Pond 1"),
        pond_of(around(105.7, 10.1, 0.002), around(105.7015, 10.1, 0.0001), name="Pond 1"),
    ):
        inner = pond_of(around(105.7005, 10.1005, 0.0003), name="Pond 2")
        [doubt] = read_farm(geojson(tmp_path, outer, inner), depot=(105.69, 10.0995)).doubts
        assert doubt.pond_id == "Pond 2"
        assert "the sampling point of Pond 2 lies in Pond 1" in doubt.message


def test_land_with_its_ponds_cut_out_is_no_pond(tmp_path: Path) -> None:
    holes = [square(0, 0), square(1, 0), square(2, 0)]
    land = pond_of(around(105.703, 10.1, 0.01), *holes, name="Crique")
    [(place, message, _)] = faults_of(geojson(tmp_path, *ponds(), land), depot=DEPOT)
    assert (place, "lies around 3 other ponds" in message) == ("features[3]", True)


def test_a_label_on_an_island_is_no_pond_and_no_place_to_sample(tmp_path: Path) -> None:
    outer = pond_of(around(105.7, 10.1, 0.002), around(105.7, 10.1, 0.001), name="Pond 1")
    for name in ("Pond 1", "Sampling point"):
        farm = read_farm(geojson(tmp_path, outer, shape("Point", [105.7, 10.1], name=name)), depot=DEPOT)
        assert ids(farm) == ["Pond 1"]
        assert clearance_m(farm.ponds[0].sampling_point, farm.ponds[0].outline) > 0.0
        assert told(farm, "are labels")


@pytest.mark.parametrize("lon", ["105.7", "105.700004"])
def test_two_points_at_one_place_are_a_doubt_that_names_both(tmp_path: Path, lon: str) -> None:
    text = f"pond,lat,lon\nA,10.1,105.7\nB,10.101,105.7\nC,10.1,{lon}\nD,10.1,105.70003\n"
    farm = read_farm(table(tmp_path, text), depot=DEPOT)
    [doubt] = farm.doubts
    assert (doubt.pond_id, doubt.message) == ("C", "line 4: pond C lies where pond A lies (line 2)")
    assert told(farm, "line 4: pond C lies where pond A lies (line 2); correct one of the two.")
    assert read_farm(table(tmp_path, text), depot=DEPOT, accept=["C"]).doubts == ()


@pytest.mark.parametrize(("lon", "lat"), [(174.0, -41.0), (-90.9, 33.4), (179.999999, -17.0), (25.0, 64.0)])
@pytest.mark.parametrize(
    ("east", "north"), [(0.6, 0.8), (-0.6, 0.8), (0.8, -0.6), (-0.8, -0.6), (1.0, 0.0), (0.0, 1.0)]
)
def test_places_are_together_by_their_distance_on_the_ground(lon: float, lat: float, east: float, north: float) -> None:
    def away(distance_m: float) -> tuple[float, float]:
        east_deg = distance_m * east / METRES_PER_DEGREE / cos(radians(lat))
        return (wrapped_longitude(lon + east_deg), lat + distance_m * north / METRES_PER_DEGREE)

    assert places_together([(lon, lat), away(0.99)], 1.0) == [(0, 1)]
    assert places_together([(lon, lat), away(1.01)], 1.0) == []
    # Another farm elsewhere changes nothing.
    assert places_together([(105.7, 10.1), (lon, lat), away(1.01), away(0.99)], 1.0) == [(1, 3)]


@pytest.mark.parametrize(("west_m", "is_doubt"), [(4.9, False), (5.2, True), (44.4, True)])
def test_a_sampling_point_outside_its_own_pond_is_a_doubt(tmp_path: Path, west_m: float, is_doubt: bool) -> None:
    lon = 105.7 - west_m / METRES_PER_DEGREE / cos(radians(10.1))
    pond = polygon(0, 0, name="P", sampling_point=[lon, 10.1002])
    path = geojson(tmp_path, pond, polygon(2, 0, name="Q", sampling_point=[105.705, 10.1002]))
    farm = read_farm(path, depot=DEPOT)
    assert told(farm, f"1 sampling point lies outside the outline of its pond, by {west_m} m (features[0])")
    message = f"features[0]: the sampling point of pond P lies {west_m:.0f} m outside it"
    assert [(doubt.pond_id, doubt.message) for doubt in farm.doubts] == [("P", message)] * is_doubt
    assert read_farm(path, depot=DEPOT, accept=["P"]).doubts == ()


# --------------------------------------------------------------------------------------- what is left out by its kind


def test_what_was_never_drawn_is_left_out_by_name_and_count(tmp_path: Path) -> None:
    def feature(geometry: object, **properties: object) -> dict[str, object]:
        return {"type": "Feature", "properties": properties, "geometry": geometry}

    nothing = {"type": "GeometryCollection", "geometries": []}
    one = read_farm(geojson(tmp_path, *ponds(), feature(nothing, name="Norte")), depot=DEPOT)
    assert (ids(one), one.notes) == (
        ["Pond 1", "Pond 2", "Pond 3"],
        ("Left out, because nothing of it was drawn: 'Norte' (features[3]).",),
    )
    blank = [feature(nothing, name="Norte"), feature(None, name="Sur"), feature({"type": "Point", "coordinates": []})]
    [note] = read_farm(geojson(tmp_path, *ponds(), *blank), depot=DEPOT).notes
    names = "'Norte' (features[3]), 'Sur' (features[4]), features[5]"
    assert note == f"Left out, because nothing of them was drawn: {names}: 3 features in all."
    for named in ({"name": "Pond 9"}, {"id": 9}, {"pond_id": "9", "name": "Norte"}):
        [(place, message, _)] = faults_of(geojson(tmp_path, *ponds(), feature(nothing, **named)), depot=DEPOT)
        assert (place, "has no geometry" in message) == ("features[3]", True)


def test_a_line_drawn_with_a_pond_is_left_out(tmp_path: Path) -> None:
    ditch = {"type": "LineString", "coordinates": [[105.7, 10.2], [105.71, 10.21]]}
    for own in ({"type": "Polygon", "coordinates": [square(5, 5)]}, {"type": "Point", "coordinates": [105.71, 10.1]}):
        geometry = {"type": "GeometryCollection", "geometries": [own, ditch, ditch]}
        thing = {"type": "Feature", "properties": {"name": "Pond 8"}, "geometry": geometry}
        farm = read_farm(geojson(tmp_path, *ponds(), thing), depot=DEPOT)
        assert ids(farm)[3:] == ["Pond 8"]
        assert told(farm, "'Pond 8' (features[3]): 2 open lines drawn with it were left out.")


def test_lines_and_things_beside_ponds_are_counted(tmp_path: Path) -> None:
    lines = [shape("LineString", [[105.7, 10.2], [105.71, 10.21]], name=f"Row {n}") for n in range(7)]
    offices = [polygon(5, n, name="Office") for n in range(2)]
    first, second = read_farm(geojson(tmp_path, *ponds(), *lines, *offices), depot=DEPOT).notes
    assert first.startswith("Left out, because they are no ponds by their names: 'Office' (features[10])")
    assert first.endswith(": 2 features in all.")
    assert second.startswith("Left out, because lines are no ponds: 'Row 0' (features[3])")
    assert second.endswith(" and 2 more: 7 features in all.")


def test_plurals_are_right(tmp_path: Path) -> None:
    pictures = ["<GroundOverlay><name>A</name></GroundOverlay>", "<ScreenOverlay><name>B</name></ScreenOverlay>"]
    for count, words in ((1, "no pond: overlay 'A'."), (2, "no pond: 2 overlays 'A', 'B'.")):
        assert told(read_farm(kml(tmp_path, pond_mark(1), *pictures[:count]), depot=DEPOT), words)
    out = shape("Polygon", [square(0, 0)], name="Pond 1", sampling_point=[105.6999, 10.1])
    assert told(read_farm(geojson(tmp_path, out), depot=DEPOT), "1 sampling point lies outside the outline of its pond")
    beside = shape("Point", [105.71, 10.11], name="Norte")
    assert "a point among 1 outline" in faults_of(geojson(tmp_path, *ponds(1), beside), depot=DEPOT)[0][1]
    parts = shape("MultiPolygon", [[square(0, 0)], [square(2, 0)], [square(4, 0, 0.0002)]], name="A")
    assert told(read_farm(geojson(tmp_path, parts), depot=DEPOT), "its 2 parts are 2 ponds, numbered; 1 small part was")
    same = shape("Polygon", [[[105.7, 10.1]] * 4], name="A")
    assert "has 1 different corner" in faults_of(geojson(tmp_path, same), depot=DEPOT)[0][1]
    corners = "pond,lat,lon\nA,10.1,105.7\nA,10.1,105.701\nA,10.101,105.7\nB,10.2,105.7\n"
    assert told(read_farm(table(tmp_path, corners), depot=DEPOT), "3 lines were joined to 1 outline, a corner a line")


def test_a_note_tells_by_what_a_thing_was_left_out(tmp_path: Path) -> None:
    inside = [
        f"<Folder><name>{name}</name>{marks}</Folder>"
        for name, marks in (
            ("Ponds", pond_mark(1)),
            ("Houses", placemark("C", kml_polygon(3, 0)) + placemark("D", kml_polygon(4, 0))),
            ("Farm boundary", placemark("E", kml_polygon(5, 0))),
        )
    ]
    farm = read_farm(kml(tmp_path, *inside), depot=DEPOT)
    assert told(farm, "because they lie in 'Houses', so they are no ponds: 'C' (placemark 2), 'D' (placemark 3)")
    assert told(farm, "because it lies in 'Farm boundary', so it bounds land, not water: 'E' (placemark 4). To keep")
    things = [
        polygon(5, 5, name="C", building="yes"),
        polygon(6, 5, name="D", type="house"),
        polygon(7, 5, name="Gate"),
    ]
    notes = read_farm(geojson(tmp_path, *ponds(), *things), depot=DEPOT).notes
    assert notes == (
        "Left out, because it has building=yes, so it is no pond: 'C' (features[3]).",
        "Left out, because its type is 'house', so it is no pond: 'D' (features[4]).",
        "Left out, because it is no pond by its name: 'Gate' (features[5]).",
    )
    buildings = [polygon(n, 5, name=f"{n}", building="yes") for n in range(5)]
    assert ids(read_farm(geojson(tmp_path, *ponds(), *buildings), depot=DEPOT)) == PONDS[:3]


# ------------------------------------------------------------------------------------------ hidden in the map program

HIDDEN = "<visibility>0</visibility>"


def pond_mark(number: int, *, inside: str = "", name: str = "Pond") -> str:
    return placemark(f"{name} {number}", f"{inside}{kml_polygon(number, 0)}")


def test_a_hidden_pond_is_left_out_with_a_note(tmp_path: Path) -> None:
    seen = "".join(pond_mark(n, inside="<visibility>1</visibility>") for n in (1, 2))
    farm = read_farm(kml(tmp_path, seen, pond_mark(3, inside=HIDDEN)), depot=DEPOT)
    assert ids(farm) == ["Pond 1", "Pond 2"]
    [note] = farm.notes
    assert note.startswith("Left out, because it is hidden in the map program (to sample it, tick it there and save")
    assert note.endswith("'Pond 3' (placemark 3).")


@pytest.mark.parametrize("value", ["0", "false", " 0 "])
def test_what_lies_in_a_hidden_folder_is_hidden(tmp_path: Path, value: str) -> None:
    inner = f"<Folder><name>Old</name>{pond_mark(3)}{pond_mark(4)}</Folder>"
    outer = f"<Folder><name>Drained</name><visibility>{value}</visibility>{inner}{pond_mark(5)}</Folder>"
    farm = read_farm(kml(tmp_path, pond_mark(1), outer), depot=DEPOT)
    assert ids(farm) == ["Pond 1"]
    assert told(farm, "'Pond 3' (placemark 2), 'Pond 4' (placemark 3), 'Pond 5' (placemark 4): 3 features in all.")


def test_a_map_that_is_hidden_as_a_whole_is_read_with_a_note(tmp_path: Path) -> None:
    for parts in ((HIDDEN, pond_mark(1), pond_mark(2)), tuple(pond_mark(n, inside=HIDDEN) for n in (1, 2))):
        farm = read_farm(kml(tmp_path, *parts), depot=DEPOT)
        assert ids(farm) == ["Pond 1", "Pond 2"]
        assert farm.notes == (
            "In the map program all 2 ponds are hidden; taken all the same, because the file has no other pond.",
        )


def pin(name: str, row: int, inside: str = "") -> str:
    return placemark(name, f"{inside}<Point><coordinates>105.7,10.1{row:02}</coordinates></Point>")


def test_hidden_ponds_make_no_ponds_of_stations(tmp_path: Path) -> None:
    hidden = "".join(pond_mark(n, inside=HIDDEN) for n in (1, 2, 3))
    farm = read_farm(kml(tmp_path, hidden, pin("Station 1", 1), pin("Station 2", 2)), depot=DEPOT)
    assert (ids(farm), len(farm.stations)) == (["Pond 1", "Pond 2", "Pond 3"], 2)
    pins = [pin("Anna", 3, HIDDEN), pin("Berta", 4, HIDDEN), pin("Station 1", 1), pin("Station 2", 2)]
    assert "are these ponds? 2 points" in faults_of(kml(tmp_path, *pins), depot=DEPOT)[0][1]


def test_hidden_members_of_a_series_of_ponds_are_left_out(tmp_path: Path) -> None:
    pins = [pin(f"Station {n}", n) for n in (1, 2, 3)]
    farm = read_farm(kml(tmp_path, *pins, pin("Station 4", 4, HIDDEN)), depot=DEPOT)
    assert (ids(farm), farm.stations) == (["Station 1", "Station 2", "Station 3"], ())
    assert told(farm, "3 points with the word 'station' are taken as ponds")
    assert told(farm, "hidden in the map program (to sample it, tick it there and save the map again): 'Station 4'")
    docks = read_farm(kml(tmp_path, *pins, pin("Dock 1", 5, HIDDEN), pin("Dock 2", 6, HIDDEN)), depot=DEPOT)
    assert (ids(docks), len(docks.stations)) == (["Station 1", "Station 2", "Station 3"], 2)
    everything = [pin(f"Station {n}", n, HIDDEN) for n in (1, 2)]
    assert ids(read_farm(kml(tmp_path, *everything, pin("Office", 7)), depot=DEPOT)) == ["Station 1", "Station 2"]


def test_hidden_areas_keep_drones_out_and_hidden_depots_give_way(tmp_path: Path) -> None:
    zone = placemark("No fly", f"{HIDDEN}{kml_polygon(5, 5)}")
    depots = [
        placemark("Depot", f"{inside}<Point><coordinates>105.69{n},10.0995</coordinates></Point>")
        for n, inside in ((5, HIDDEN), (8, ""))
    ]
    farm = read_farm(kml(tmp_path, pond_mark(1), zone, *depots))
    assert (len(farm.no_fly), farm.depot) == (1, (105.698, 10.0995))
    assert told(farm, "kept all the same, because drones must know of them: 'No fly' (placemark 2).")
    assert told(farm, "another depot is the one that can be seen in the map program: 'Depot' (placemark 3).")
    alone = read_farm(kml(tmp_path, pond_mark(1), depots[0]))
    assert alone.depot == (105.695, 10.0995)


# -------------------------------------------------------------------------------------- numbers as they are written


@pytest.mark.parametrize(
    ("cell", "wrong"),
    [
        ("10 66 01", "'10 66 01' has 66 minutes, and each must be under 60"),
        ("10°06'61\"N", "has 61 seconds, and each must be under 60"),
        ("10 66 71 N", "'10 66 71 N' has 66 minutes and 71 seconds, and each must be under 60"),
        ("ten", "'ten' is no number"),
    ],
)
def test_an_angle_with_too_many_minutes_is_told_as_such(tmp_path: Path, cell: str, wrong: str) -> None:
    [(place, message, _)] = faults_of(table(tmp_path, f"pond;lat;lon\nA;{cell};105.7\n"), depot=DEPOT)
    assert (place, wrong in message) == ("line 2, column lat", True)
    [(_, message, _)] = faults_of(workbook(tmp_path, Ponds=[["pond", "gps"], ["A", f"{cell}, 105.7"]]), depot=DEPOT)
    assert wrong.partition(" has ")[2] in message


SCRIPTS = ("ARABIC-INDIC", "EXTENDED ARABIC-INDIC", "BENGALI", "DEVANAGARI", "FULLWIDTH", "THAI")


@pytest.mark.parametrize("script", SCRIPTS)
@pytest.mark.parametrize("separator", [".", ",", "\N{ARABIC DECIMAL SEPARATOR}", "\N{FULLWIDTH FULL STOP}"])
def test_digits_of_any_script_are_read(tmp_path: Path, script: str, separator: str) -> None:
    zero = ord(lookup(f"{script} DIGIT ZERO"))

    def written(text: str) -> str:
        return text.translate({ord("0") + digit: zero + digit for digit in range(10)}).replace(".", separator)

    row = f"A;{written('10.101')};{written('105.7')};{written('30.5')}"
    [pond] = read_farm(table(tmp_path, f"pond;lat;lon;service_s\n{row}\n"), depot=DEPOT).ponds
    assert (pond.sampling_point, pond.service_s) == ((105.7, 10.101), 30.5)
    angle = f"A;{written('10 06 03.6 N')};{written('E 105 42')}"
    [pond] = read_farm(table(tmp_path, f"pond;lat;lon\n{angle}\n"), depot=DEPOT).ponds
    assert pond.sampling_point == pytest.approx((105.7, 10.101))


def test_a_time_on_station_may_have_a_decimal_comma_but_no_thousands(tmp_path: Path) -> None:
    def path(service: str) -> Path:
        return geojson(tmp_path, polygon(0, 0, name="A", service_s=service, sampling_point="105,7005; 10,1002"))

    [pond] = read_farm(path("30,5"), depot=DEPOT).ponds
    assert (pond.service_s, pond.sampling_point) == (30.5, (105.7005, 10.1002))
    assert "'1,200' is no time on station" in faults_of(path("1,200"), depot=DEPOT)[0][1]


# ------------------------------------------------------------------------------- degrees and minutes in one number


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("pond,lat,lon\nA,1006.060 N,10542.000 E\nB,N1006.6,E10542.6\n", (105.7, 10.101)),
        ("pond,lat,NS,lon,EW\nA,1006.060,N,10542.000,E\nB,1006.600,N,10542.600,E\n", (105.7, 10.101)),
        ("pond;lat;NS;lon;EW\nA;0218,024;S;07954,054;W\nB;0218,6;S;07954,6;W\n", (-79.9009, -2.3004)),
        ('pond,coordinates\nA,"1006.060 N, 10542.000 E"\nB,"1006.6 N, 10542.6 E"\n', (105.7, 10.101)),
        ("pond,Lat (S),Lon (W)\nA,218.024,7954.054\nB,218.6,7954.6\n", (-79.9009, -2.3004)),
    ],
)
def test_joined_degrees_and_minutes_with_letters_are_read(
    tmp_path: Path, text: str, place: tuple[float, float]
) -> None:
    farm = read_farm(table(tmp_path, text), depot=(round(place[0], 1), round(place[1], 1)))
    assert farm.ponds[0].sampling_point == pytest.approx(place, abs=1e-7)
    assert told(farm, "read as degrees and minutes in one number, as GPS receivers write them: ")


def test_joined_degrees_and_minutes_without_letters_are_a_fault_that_says_so(tmp_path: Path) -> None:
    text = "pond,lat,lon\nA,1006.060,10542.000\nB,1006.600,10542.600\n"
    faults = faults_of(table(tmp_path, text), depot=DEPOT)
    for (place, message, action), line in zip(faults, (2, 3), strict=True):
        assert place == f"line {line}"
        assert "look like degrees and minutes in one number: longitude 10542" in message
        assert "letters N, S, E and W beside the numbers will do" in action
    assert "latitude 1006.06 is 10 degrees 6.06 minutes" in faults[0][1]
    point = shape("Point", [-7954.054, -218.024], name="A")
    assert "longitude -7954.054 is 79 degrees 54.054 minutes" in faults_of(geojson(tmp_path, point), depot=DEPOT)[0][1]


@pytest.mark.parametrize(
    "cells", [("576800,1116600", "576900,1116700"), ("1006,5542", "1306,5842"), ("1006,5560", "1007,5561")]
)
def test_metres_are_no_joined_degrees_and_minutes(tmp_path: Path, cells: tuple[str, str]) -> None:
    rows = "".join(f"{name},{cell}\n" for name, cell in zip("AB", cells, strict=True))
    faults = faults_of(table(tmp_path, f"pond,lon,lat\n{rows}"), depot=DEPOT)
    assert all("metres of a map projection" in message for _, message, _ in faults)


# ------------------------------------------------------------------------------------------ headings and names of ponds


@pytest.mark.parametrize(
    ("text", "names", "heading"),
    [
        ("Stn Code,lat,lon\n101,10.1,105.7\n102,10.101,105.7\n", ["101", "102"], "Stn Code"),
        ("station,lat,lon\n7,10.1,105.7\n9,10.101,105.7\n", ["7", "9"], "station"),
        ("xyz,lat,lon\nNorte,10.1,105.7\nSur,10.101,105.7\n", ["Norte", "Sur"], "xyz"),
        (
            "name,Grid Ref,lat,lon\nPond,B1,10.1,105.7\nPond,B2,10.101,105.7\nPond,B3,10.102,105.7\n",
            ["B1", "B2", "B3"],
            "Grid Ref",
        ),
        (
            "Name,Field Code,lat,lon\nA,B-1,10.1,105.7\nA,B-2,10.101,105.7\nC,B-3,10.102,105.7\n",
            ["B-1", "B-2", "B-3"],
            "Field Code",
        ),
    ],
)
def test_the_heading_that_gives_the_names_is_told_as_it_is_spelled(
    tmp_path: Path, text: str, names: list[str], heading: str
) -> None:
    farm = read_farm(table(tmp_path, text), depot=DEPOT)
    assert ids(farm) == names
    assert told(farm, f"named by column {heading!r}")


def test_numbers_under_any_heading_are_no_names(tmp_path: Path) -> None:
    farm = read_farm(table(tmp_path, "depth,lat,lon\n3,10.1,105.7\n4,10.101,105.7\n"), depot=DEPOT)
    assert ids(farm) == ["1", "2"]


def test_numbers_in_columns_of_codes_are_read_from_maps_too(tmp_path: Path) -> None:
    features = [shape("Point", [105.7, 10.1 + 0.001 * n], SiteNo=n, depth=2 * n) for n in (4, 7)]
    assert ids(read_farm(geojson(tmp_path, *features), depot=DEPOT)) == ["4", "7"]


@pytest.mark.parametrize(
    ("heading", "values"),
    [
        ("field pH", ["7.1", "7.2"]),
        ("point depth", ["2", "3"]),
        ("unit area", ["12", "13"]),
        ("number of fish", ["100", "200"]),
        ("fish per tank", ["100", "200"]),
        ("cell count", ["7", "8"]),
        ("sample no", ["1.5", "1.6"]),
        ("número de peces", ["100", "200"]),
        ("number of ponds", ["4", "5"]),
    ],
)
def test_what_was_measured_is_no_name(tmp_path: Path, heading: str, values: list[str]) -> None:
    farm = read_farm(points(tmp_path, *values, heading=heading), depot=DEPOT)
    assert ids(farm) == ["1", "2"]
    assert told(farm, "2 ponds without an id were numbered")


@pytest.mark.parametrize(
    "heading", ["Site Code", "SiteNo", "sample_no", "Fish tank", "Código estanque", "nº de piscina", "numéro du bassin"]
)
def test_what_ponds_are_called_by_a_number_is_their_name(tmp_path: Path, heading: str) -> None:
    farm = read_farm(points(tmp_path, "12", "13", heading=heading), depot=DEPOT)
    assert ids(farm) == ["12", "13"]
    assert told(farm, f"The ponds are named by column {heading!r}, because no column is known to hold names.")


@pytest.mark.parametrize("values", [["12", "13", "17"], ["Norte", "Sur", "Este"]])
def test_the_name_of_a_depot_hides_no_names_of_ponds(tmp_path: Path, values: list[str]) -> None:
    features = [shape("Point", [105.7, 10.1 + 0.001 * n], Site=value) for n, value in enumerate(values)]
    for depot in ({"name": "Depot"}, {"role": "depot", "name": "Base"}, {"role": "depot"}, {"type": "depot"}):
        farm = read_farm(geojson(tmp_path, *features, shape("Point", list(DEPOT), **depot)))
        assert ids(farm) == values
        assert told(farm, "The ponds are named by column 'Site', because no column is known to hold names.")
    zone = polygon(5, 5, Site="No fly zone")
    farm = read_farm(geojson(tmp_path, *features, zone, shape("Point", list(DEPOT), name="Depot")))
    assert (ids(farm), len(farm.no_fly)) == (values, 1)


BESIDE = ("Office", "Pump house", "No fly", "Gate", "Road")


@pytest.mark.parametrize(
    "names",
    [
        [f"{word} {number}" for number in range(1, 7)]
        for word in (
            *(
                "Pool",
                "Cell",
                "Paddy",
                "Tank",
                "Bassin",
                "Estanque",
                "Viveiro",
                "Kolam",
                "Ao",
                "Cage",
                "Raceway",
                "Petak",
            ),
            *(
                "Tambak",
                "Viivi",
                "Gher",
                "Vuông",
                "Bè",
                "网箱",
                "가두리",
                "いけす",
                "กระชัง",
                "Садок",
                "قفص",
                "Compartment",
            ),
        )
    ],
    ids=lambda names: names[0],
)
def test_ponds_by_any_name_among_things_that_are_none(tmp_path: Path, names: list[str]) -> None:
    things: list[dict[str, object]] = [polygon(8, row, name=name) for row, name in enumerate(BESIDE[:3])]
    things += [shape("Point", [105.72, 10.11], name="Gate")]
    things += [shape("LineString", [[105.72, 10.11], [105.72, 10.12]], name="Road")]
    outlines = [polygon(column, 0, name=name) for column, name in enumerate(names)]
    points = [shape("Point", [105.7, 10.1 + 0.001 * row], name=name) for row, name in enumerate(names)]
    mixed = [*(polygon(column, 0, name=f"Pond {column}") for column in range(6)), polygon(7, 0, name=names[1])]
    for ponds_drawn in (outlines, points, mixed):
        farm = read_farm(geojson(tmp_path, *ponds_drawn, *things), depot=DEPOT)
        assert (len(farm.ponds), len(farm.no_fly), farm.doubts) == (len(ponds_drawn), 1, ())


@pytest.mark.parametrize("name", ["Basin", "Lagoon", "Petak", "Tambak", "Tank B", "Pool", "Talab", "Lồng"])
def test_a_word_for_ponds_alone_is_a_pond(tmp_path: Path, name: str) -> None:
    farm = read_farm(geojson(tmp_path, *ponds(6), polygon(5, 5, name=name), polygon(8, 8, name="Office")), depot=DEPOT)
    assert (ids(farm)[6:], farm.doubts) == ([name], ())


@pytest.mark.parametrize("name", ["Swimming pool", "Kolam renang", "Bak air", "Hồ bơi", "Water tank"])
def test_water_that_nobody_farms_is_no_pond(tmp_path: Path, name: str) -> None:
    assert ids(read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, name=name)), depot=DEPOT)) == PONDS[:3]


# ------------------------------------------------------------------------------------- things named for the ponds


@pytest.mark.parametrize(
    "name",
    [
        "Pond 3 pump house",
        "Pond road",
        "Access road to ponds",
        "Pond levee",
        "Pond boundary",
        "Pond office",
        "Fish pond house",
        "Main office near pond 2",
        "Pond under repair - do not sample",
        "Old pond (filled in)",
        "A7 (abandoned)",
    ],
)
def test_what_is_named_for_a_pond_or_out_of_use_is_asked_for(tmp_path: Path, name: str) -> None:
    [fault] = faults_of(geojson(tmp_path, *ponds(), polygon(5, 5, name=name)), depot=DEPOT)
    place, problem, remedy = fault
    assert (place, name in problem, "role" in remedy) == ("features[3]", True, True)


@pytest.mark.parametrize("name", ["No pond", "not a pond", "Former pond"])
def test_what_says_that_it_is_no_pond_is_left_out(tmp_path: Path, name: str) -> None:
    farm = read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, name=name)), depot=DEPOT)
    assert ids(farm) == PONDS[:3]
    assert told(farm, name)


@pytest.mark.parametrize(
    "name",
    [
        "Office pond",
        "Road pond 2",
        "Pond by the office",
        "Pond 3 (near pump house)",
        "Estanque oficina",
        "Gate Lagoon",
        "Pond 5 North side",
        "River pond east",
        "Tank Farm 3",
    ],
)
def test_ponds_named_for_things_beside_them_are_ponds(tmp_path: Path, name: str) -> None:
    farm = read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, name=name)), depot=DEPOT)
    assert (ids(farm), farm.doubts) == ([*PONDS[:3], name], ())


@pytest.mark.parametrize(
    ("tag", "value"),
    [("landuse", "military"), ("aeroway", "aerodrome"), ("military", "danger_area"), ("aeroway", "runway")],
)
def test_tags_of_maps_keep_drones_out(tmp_path: Path, tag: str, value: str) -> None:
    farm = read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, **{tag: value})), depot=DEPOT)
    assert (ids(farm), len(farm.no_fly)) == (PONDS[:3], 1)
    assert told(farm, f"{tag}={value}")


@pytest.mark.parametrize(
    ("tag", "value"),
    [
        ("highway", "service"),
        ("power", "substation"),
        ("amenity", "school"),
        ("place", "island"),
        ("landuse", "landfill"),
        ("category", "Facility"),
        ("category", "Woods"),
    ],
)
def test_tags_of_maps_tell_what_is_no_pond(tmp_path: Path, tag: str, value: str) -> None:
    farm = read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, **{tag: value})), depot=DEPOT)
    assert (ids(farm), len(farm.no_fly)) == (PONDS[:3], 0)


def test_a_column_that_is_called_like_a_tag_says_nothing(tmp_path: Path) -> None:
    assert len(read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, power="3 kW")), depot=DEPOT).ponds) == 4


# ------------------------------------------------------------------------------------------------- remarks on ponds

KEPT_OUT = (
    "no fly zone, military",
    "No-Fly Zone",
    "Military no fly zone around the radar",
    "Pond 4; do not fly",
    "no fly: yes",
    "NFZ",
    "Restricted",
    "zona de exclusión aérea",
    "Vùng cấm bay",
    "禁飞区",
    "<table><tr><td>no fly zone</td></tr><tr><td>of the airport</td></tr></table>",
)


@pytest.mark.parametrize("remark", KEPT_OUT)
@pytest.mark.parametrize("column", ["description", "Status", "备注"])
def test_a_remark_that_keeps_drones_out_is_asked_for(tmp_path: Path, remark: str, column: str) -> None:
    for name in ("M4", "Pond 4"):
        path = geojson(tmp_path, *ponds(), polygon(5, 5, name=name, **{column: remark}))
        [(place, message, action)] = faults_of(path, depot=DEPOT)
        assert (place, f"is this a pond? its {column} is " in message, "no_fly" in action) == (
            "features[3]",
            True,
            True,
        )
    zone = read_farm(
        geojson(tmp_path, *ponds(), polygon(5, 5, name="M4", role="pond", **{column: remark})), depot=DEPOT
    )
    assert ids(zone) == [*PONDS[:3], "M4"]
    office = polygon(5, 5, name="Office", **{column: remark})
    assert ids(read_farm(geojson(tmp_path, *ponds(), office), depot=DEPOT)) == PONDS[:3]


@pytest.mark.parametrize(
    "remark",
    [
        "Pond 4, no-fly zone to the north",
        "near the no fly zone",
        "no fly zone 200 m east",
        "not in a no-fly zone",
        "No fly zone: none",
        "no fly: no",
        "restricted feeding",
        "avoid noon",
        "airport road",
        "drone could not fly on Monday",
        "danger of birds",
        "cerca de la zona de exclusión aérea",
        "北侧为禁飞区",
        "<tr><td>no fly</td><td>no</td></tr>",
    ],
)
def test_a_remark_on_another_place_is_no_reason_to_ask(tmp_path: Path, remark: str) -> None:
    farm = read_farm(geojson(tmp_path, *ponds(), polygon(5, 5, name="Pond 4", description=remark)), depot=DEPOT)
    assert (ids(farm), farm.doubts) == (PONDS[:4], ())


def test_descriptions_of_placemarks_are_remarks(tmp_path: Path) -> None:
    body = f"<description><![CDATA[No fly zone<br>since 2020]]></description>{kml_polygon(5, 0)}"
    [(place, message, _)] = faults_of(kml(tmp_path, pond_mark(1), placemark("M4", body)), depot=DEPOT)
    assert (place, "its description is 'No fly zone since 2020'" in message) == ("placemark 2", True)
    point = '<wpt lat="10.1" lon="105.7"><name>A</name></wpt><wpt lat="10.101" lon="105.7"><desc>no fly</desc></wpt>'
    (tmp_path / "farm.gpx").write_text(f"<gpx>{point}</gpx>", "utf-8")
    assert "its desc is 'no fly'" in faults_of(tmp_path / "farm.gpx", depot=DEPOT)[0][1]


# ------------------------------------------------------------------------------------------------------- workbooks

Rows = list[list[object]]
HEADINGS: list[object] = ["Pond", "Lat", "Lon"]


def test_every_sheet_of_a_workbook_is_read(tmp_path: Path) -> None:
    north: Rows = [HEADINGS, ["A1", 10.101, 105.701], ["A2", 10.102, 105.702]]
    south: Rows = [HEADINGS, ["B1", 10.111, 105.701], ["B2", 10.112, 105.702]]
    farm = read_farm(workbook(tmp_path, North=north, South=south), depot=DEPOT)
    assert ids(farm) == ["A1", "A2", "B1", "B2"]
    assert not farm.notes


def test_the_depot_may_stand_on_a_sheet_of_its_own(tmp_path: Path) -> None:
    ponds: Rows = [HEADINGS, ["1", 10.101, 105.701], ["2", 10.102, 105.702]]
    farm = read_farm(workbook(tmp_path, Ponds=ponds, Depot=[["Name", "Lat", "Lon"], ["Depot", 10.1, 105.7]]))
    assert ids(farm) == ["1", "2"]
    assert farm.depot == (105.7, 10.1)


@pytest.mark.parametrize("notes", [[["x"]], [["This is my farm"], ["made by me"]], [["ask Tran", "07:30"]], [HEADINGS]])
def test_a_sheet_without_places_is_left_out_wherever_it_stands(tmp_path: Path, notes: list[list[str]]) -> None:
    ponds: Rows = [HEADINGS, ["A1", 10.101, 105.701], ["A2", 10.102, 105.702]]
    for sheets in ({"Notes": notes, "Ponds": ponds}, {"Ponds": ponds, "Notes": notes}, {"Empty": [], "Ponds": ponds}):
        farm = read_farm(workbook(tmp_path, **sheets), depot=DEPOT)
        assert ids(farm) == ["A1", "A2"]
        assert told(farm, "sheets 'Notes'") == ("Notes" in sheets)


def test_ponds_of_one_number_on_two_sheets_are_told_apart(tmp_path: Path) -> None:
    north: Rows = [HEADINGS, ["1", 10.101, 105.701], ["2", 10.102, 105.702]]
    south: Rows = [HEADINGS, ["1", 10.111, 105.701], ["2", 10.112, 105.702]]
    farm = read_farm(workbook(tmp_path, North=north, South=south), depot=DEPOT)
    assert ids(farm) == ["North 1", "North 2", "South 1", "South 2"]


@pytest.mark.parametrize(
    ("pond_id", "told"), [("7", "pond 7"), ("A7", "pond A7"), ("Pond 7", "Pond 7"), ("Laguna 2", "Laguna 2")]
)
def test_a_pond_is_called_a_pond_once(pond_id: str, told: str) -> None:
    assert pond_called(pond_id) == told
