"""Made-up farms."""

from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from pondhop import InvalidInput, LocalFrame
from pondhop.farm import Farm, read_farm, write_farm
from pondhop.farm.made_up import generate_farm

DELTA = (-90.6, 33.4)


def outlines_m(farm: Farm) -> list[shapely.Polygon]:
    frame = LocalFrame(*farm.depot)
    return [shapely.Polygon(frame.to_local(np.array(pond.outline[0]))) for pond in farm.ponds]


@settings(max_examples=30, deadline=None)
@given(
    num_ponds=st.integers(1, 150),
    lon=st.floats(-180, 180),
    lat=st.floats(-70, 70),
    seed=st.integers(0, 2**32),
    missing_share=st.floats(0, 0.5),
    irregular=st.booleans(),
)
def test_ponds_are_separate_and_of_4_to_8_hectares(
    num_ponds: int, lon: float, lat: float, seed: int, missing_share: float, irregular: bool
) -> None:
    farm = generate_farm(num_ponds, at=(lon, lat), seed=seed, missing_share=missing_share, irregular=irregular)
    assert [pond.id for pond in farm.ponds] == [str(number) for number in range(1, num_ponds + 1)]
    outlines = outlines_m(farm)
    assert all(40_000.0 <= outline.area <= 80_000.0 for outline in outlines)
    near = shapely.STRtree(outlines).query(outlines, predicate="dwithin", distance=8.0)
    assert near.shape == (2, num_ponds), "no pond within 8 m of another"
    assert min(outline.distance(shapely.Point(0, 0)) for outline in outlines) > 50.0, "the yard is on land"


def test_the_same_seed_makes_the_same_farm() -> None:
    assert generate_farm(40, at=DELTA, seed=7) == generate_farm(40, at=DELTA, seed=7)
    assert generate_farm(40, at=DELTA, seed=7).ponds != generate_farm(40, at=DELTA, seed=8).ponds


def test_the_largest_farm_holds_all_its_ponds_around_the_yard() -> None:
    farm = generate_farm(5_000, at=DELTA, missing_share=0.1, irregular=True)
    assert len(farm.ponds) == 5_000
    local_m = LocalFrame(*DELTA).to_local(np.array([pond.sampling_point for pond in farm.ponds]))
    assert np.abs(local_m.mean(axis=0)).max() < 1_500.0
    assert np.abs(local_m).max() < 20_000.0


def test_a_generated_farm_is_read_back_without_a_note(tmp_path: Path) -> None:
    farm = generate_farm(60, at=DELTA, irregular=True)
    write_farm(tmp_path / "farm.geojson", farm)
    assert read_farm(tmp_path / "farm.geojson") == farm


def test_the_shipped_example_is_a_farm_of_120_ponds() -> None:
    path = Path(__file__).parents[1] / "examples" / "delta_farm.geojson"
    farm = read_farm(path)
    assert farm.ponds == generate_farm(120, at=DELTA, seed=4, missing_share=0.06, irregular=True).ponds
    assert farm.notes == ()


def test_every_bad_parameter_is_named() -> None:
    with pytest.raises(InvalidInput) as caught:
        generate_farm(0, at=(33.4, -90.6), missing_share=float("nan"))
    assert [fault.path for fault in caught.value.faults] == ["num_ponds", "at", "missing_share"]
