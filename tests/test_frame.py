"""The metric frame of a farm through the binding."""

import numpy as np
import pytest

from pondhop import InvalidInput, LocalFrame


@pytest.mark.parametrize("origin_deg", [179.999, -179.999, 180.0, -180.0])
def test_a_farm_across_the_180th_meridian_is_one_farm(origin_deg: float) -> None:
    frame = LocalFrame(origin_deg, -17.0)
    places_deg = [[179.99, -17.0], [-179.99, -17.0], [179.999, -17.01]]
    local_m = frame.to_local(places_deg)
    # A degree of longitude is 106.5 km there.
    assert local_m[1, 0] - local_m[0, 0] == pytest.approx(0.02 * 106_487, rel=1e-4)
    assert np.abs(local_m).max() < 2500
    assert frame.to_geographic(local_m) == pytest.approx(np.array(places_deg), abs=1e-9)


def test_positions_of_any_real_type() -> None:
    frame = LocalFrame(10, 50)
    expected = frame.to_local(np.array([[10.0, 50.0], [10.0, 51.0]]))
    for places in ([[10, 50], [10, 51]], np.array([[10, 50], [10, 51]], dtype=np.float32), ((10, 50), (10, 51))):
        assert (frame.to_local(places) == expected).all()
    assert frame.to_local(np.zeros((0, 2))).shape == (0, 2)
    assert frame.to_geographic([]).shape == (0, 2)


def test_other_shapes_and_types_are_faults() -> None:
    frame = LocalFrame(10, 50)
    for wrong in ([1, 2], [[1, 2, 3]], "here", [["a", "b"]], None):
        with pytest.raises(InvalidInput, match="lonlat_deg"):
            frame.to_local(wrong)  # type: ignore[arg-type]
        with pytest.raises(InvalidInput, match="local_m"):
            frame.to_geographic(wrong)  # type: ignore[arg-type]
