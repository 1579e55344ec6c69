"""Research instances: what is drawn, read and written, and how broken files are answered."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import MultiPoint, Point, Polygon, contains_xy

from pondhop import InvalidInput, instances
from pondhop.instances import ResearchFarm

SHARED = Path(__file__).parents[1].parent / "shared" / "data"
needs_shared = pytest.mark.skipif(not SHARED.is_dir(), reason=f"the development data is not at {SHARED}")


def assert_equal(one: ResearchFarm, other: ResearchFarm) -> None:
    assert np.array_equal(one.depot, other.depot)
    assert np.array_equal(one.ponds, other.ponds)
    assert (one.boundary is None) == (other.boundary is None)
    if one.boundary is not None and other.boundary is not None:
        assert np.array_equal(one.boundary, other.boundary)
    assert one.spacing == other.spacing


def places(error: InvalidInput) -> list[str]:
    return [fault.path for fault in error.faults]


def test_the_farms_of_a_seed_are_fixed() -> None:
    farm = instances.generate(3, 2, seed=7)[1]
    assert farm.depot.tolist() == [0.799454452770849, 0.1892050187500421]
    assert farm.ponds.tolist() == [
        [0.49381049734067367, 0.7407157460110105],
        [0.7407157460110105, 0.24690524867033684],
        [0.7407157460110105, 0.49381049734067367],
    ]


@given(num_ponds=st.integers(1, 200), seed=st.integers(0, 2**32 - 1), variant=st.sampled_from(["authors", "paper"]))
def test_ponds_lie_inside_the_outline_and_the_depot_in_its_box(num_ponds: int, seed: int, variant: str) -> None:
    farm = instances.generate(num_ponds, seed=seed, variant=variant)[0]  # type: ignore[arg-type]
    outline = Polygon(farm.boundary)
    assert outline.is_valid
    assert outline.exterior.is_ccw
    assert outline.buffer(1e-9).covers(MultiPoint(farm.ponds))
    assert outline.envelope.covers(Point(farm.depot))
    assert len({tuple(pond) for pond in farm.ponds.tolist()}) == num_ponds
    if variant == "paper":
        assert outline.convex_hull.area == pytest.approx(outline.area)


def test_the_depot_is_outside_the_outline_in_about_55_percent_of_farms() -> None:
    farms = instances.generate(100, 1000)
    share = np.mean([not Polygon(farm.boundary).covers(Point(farm.depot)) for farm in farms])
    assert share == pytest.approx(0.55, abs=3 * (0.25 / 1000) ** 0.5)


@pytest.mark.parametrize(("variant", "share"), [("authors", 0.36), ("paper", 0.20)])
def test_how_much_of_the_grid_is_deleted(variant: str, share: float) -> None:
    deleted = []
    for farm in instances.generate(400, 100, variant=variant):  # type: ignore[arg-type]
        assert farm.spacing is not None
        lines = np.arange(0, 1, farm.spacing)
        grid = np.array(np.meshgrid(lines, lines)).reshape(2, -1)
        num_inside = contains_xy(Polygon(farm.boundary), *grid).sum()
        deleted.append(1 - len(farm.ponds) / num_inside)
    # Not the mean: where the farm has a hole, its outline holds more of the grid than the farm.
    assert np.median(deleted) == pytest.approx(share, abs=0.01)


def test_lists_of_different_lengths_begin_alike_and_seeds_differ() -> None:
    three, five = instances.generate(20, 3), instances.generate(20, 5)
    for one, other in zip(three, five, strict=False):
        assert_equal(one, other)
    depots = [farm.depot.tolist() for seed in range(3) for farm in instances.generate(20, 5, seed=seed)]
    assert len({tuple(depot) for depot in depots}) == 15


def test_every_argument_out_of_range_is_named() -> None:
    with pytest.raises(InvalidInput) as raised:
        instances.generate(0, 0, seed=-1, variant="autors")  # type: ignore[arg-type]
    assert places(raised.value) == ["num_ponds", "num_farms", "seed", "variant"]


def test_farms_come_back_from_a_file_to_the_last_bit(tmp_path: Path) -> None:
    farms = [*instances.generate(30, 2), ResearchFarm(np.array([0.1, 0.2]), np.array([[1 / 3, 2e-17]]))]
    instances.write_farms(tmp_path / "farms.json", farms)
    read = instances.read_farms(tmp_path / "farms.json")
    assert len(read) == 3
    for one, other in zip(farms, read, strict=True):
        assert_equal(one, other)


def test_a_farm_becomes_a_problem() -> None:
    problem = instances.generate(30)[0].to_problem(5)
    assert (problem.num_ponds, problem.num_drones) == (30, 5)


BROKEN_FARMS = {
    "empty file": ("", [", line 1, column 1"]),
    "cut off": ('[{"depot": [0, 0], "ponds": [[1,', [", line 1, column 33"]),
    "nested too deep": ("[" * 100_000, [""]),
    "no list": ('{"depot": [0, 0], "ponds": [[1, 1]]}', [""]),
    "no farm": ("[]", [""]),
    "farm is a number": ('[3, {"depot": [0, 0], "ponds": [[1, 1]]}]', ["[0]"]),
    "nothing in it": ("[{}]", ["[0].depot", "[0].ponds"]),
    "no pond": ('[{"depot": [0, 0], "ponds": []}]', ["[0].ponds"]),
    "many faults": (
        '[{"depot": [0, 0], "ponds": [[1, 1]]}, {"depot": [0], "ponds": [[1, NaN], [1, 2], ["1", 2], [true, 1], "ab"],'
        ' "boundary": [[0, 0]], "spacing": -1}]',
        ["[1].depot", "[1].ponds[0]", "[1].ponds[2]", "[1].ponds[3]", "[1].ponds[4]", "[1].boundary", "[1].spacing"],
    ),
    "too far": ('[{"depot": [1e400, 0], "ponds": [[1' + 400 * "0" + ", 1]]}]", ["[0].depot", "[0].ponds[0]"]),
}


@pytest.mark.parametrize(("text", "expected"), BROKEN_FARMS.values(), ids=BROKEN_FARMS.keys())
def test_every_fault_of_a_broken_file_is_named(tmp_path: Path, text: str, expected: list[str]) -> None:
    path = tmp_path / "farms.json"
    path.write_text(text)
    with pytest.raises(InvalidInput) as raised:
        instances.read_farms(path)
    assert [place.removeprefix(str(path)) for place in places(raised.value)] == expected


@given(content=st.binary(max_size=200))
def test_any_bytes_are_farms_or_a_clean_error(content: bytes, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("bytes") / "file"
    path.write_bytes(content)
    for read in (instances.read_farms, instances.read_tsplib):
        with pytest.raises(InvalidInput):
            read(path)


def test_a_missing_file_is_a_clean_error(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="cannot be read"):
        instances.read_farms(tmp_path / "nowhere.json")


HEADER = "NAME : tiny\nTYPE : TSP\nDIMENSION : 3\nEDGE_WEIGHT_TYPE : EUC_2D\nNODE_COORD_SECTION\n"


def test_a_tsplib_file(tmp_path: Path) -> None:
    path = tmp_path / "tiny.tsp"
    path.write_text(HEADER + "1 0.5 0\n 3 3e0 4\n2 1.0e+01 0\nEOF\nrest")
    farm = instances.read_tsplib(path)
    assert farm.depot.tolist() == [0.5, 0]
    assert farm.ponds.tolist() == [[10, 0], [3, 4]]


BROKEN_TSPLIB = {
    "not planar": (HEADER.replace("EUC_2D", "GEO") + "1 0 0\n2 1 0\n3 1 1\n", ["line 4"]),
    "too few nodes": (HEADER + "1 0 0\n2 1 0\n", ["line 3"]),
    "a gap": (HEADER + "1 0 0\n2 1 0\n4 1 1\n", [""]),
    "broken lines": (HEADER + "1 0 0\n1 1 0\n3 x 1\n4 1\n5 inf 0\n", ["line 7", "line 8", "line 9", "line 10"]),
    "capacities": (HEADER + "1 0 0\n2 1 0\n3 1 1\nDEMAND_SECTION\n1 2\n", ["line 9"]),
    "no keyword": ("hello\n", ["line 1", "", ""]),
}


@pytest.mark.parametrize(("text", "expected"), BROKEN_TSPLIB.values(), ids=BROKEN_TSPLIB.keys())
def test_every_fault_of_a_broken_tsplib_file_is_named(tmp_path: Path, text: str, expected: list[str]) -> None:
    path = tmp_path / "broken.tsp"
    path.write_text(text)
    with pytest.raises(InvalidInput) as raised:
        instances.read_tsplib(path)
    assert [place.removeprefix(str(path)) for place in places(raised.value)] == expected


@needs_shared
def test_the_authors_farms_can_be_read() -> None:
    farms = instances.read_farms(SHARED / "instances" / "authors50.json")
    assert len(farms) == 100
    assert all(farm.ponds.shape == (50, 2) for farm in farms)


@needs_shared
@pytest.mark.parametrize(("name", "num_ponds"), [("mtsp51", 50), ("kroa200", 199), ("fl1400", 1399), ("pcb3038", 3037)])
def test_the_published_instances_can_be_read(name: str, num_ponds: int) -> None:
    farm = instances.read_tsplib(SHARED / "mtsp" / f"{name}.tsp")
    assert farm.ponds.shape == (num_ponds, 2)


@pytest.mark.parametrize(
    ("weights", "words"),
    [("ATT", "write EUC_2D to plan its places"), ("EXPLICIT", "a matrix of distances"), ("GEO", "on the globe")],
)
def test_other_distances_are_refused_by_name(tmp_path: Path, weights: str, words: str) -> None:
    path = tmp_path / "other.tsp"
    section = "EDGE_WEIGHT_SECTION\n0 1 2\n1 0 3\n2 3 0\n" if weights == "EXPLICIT" else "1 0 0\n2 1 0\n3 1 1\n"
    header = HEADER.replace("EUC_2D", weights)
    path.write_text((header.replace("NODE_COORD_SECTION\n", "") if weights == "EXPLICIT" else header) + section)
    with pytest.raises(InvalidInput) as caught:
        instances.read_tsplib(path)
    (fault,) = caught.value.faults
    assert fault.message == f"EDGE_WEIGHT_TYPE is {weights}"
    assert words in fault.action
