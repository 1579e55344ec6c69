"""Numbers in words: hand-computed."""

import pytest

from pondhop.units import clock_text, counted, duration_text, energy_text, height_text, length_text, speed_text


@pytest.mark.parametrize(
    ("length_m", "metric", "us"),
    [(0.0, "0 m", "0 ft"), (850.4, "850 m", "0.53 mi"), (999.4, "999 m", "0.62 mi"), (1434.0, "1.43 km", "0.89 mi")],
)
def test_lengths(length_m: float, metric: str, us: str) -> None:
    assert length_text(length_m) == metric
    assert length_text(length_m, "us") == us


def test_heights_and_speeds() -> None:
    assert (height_text(7.0), height_text(7.0, "us")) == ("7 m", "23 ft")
    assert (speed_text(5.0), speed_text(5.0, "us")) == ("5 m/s", "11.2 mph")


@pytest.mark.parametrize(
    ("duration_s", "words", "clock"),
    [
        (0.0, "0 min 00 s", "0:00"),
        (59.6, "1 min 00 s", "1:00"),
        (350.0, "5 min 50 s", "5:50"),
        (3599.6, "1 h 00 min", "1:00:00"),
        (3950.0, "1 h 06 min", "1:05:50"),
    ],
)
def test_durations(duration_s: float, words: str, clock: str) -> None:
    assert duration_text(duration_s) == words
    assert clock_text(duration_s) == clock


def test_energies_and_numbers_of_things() -> None:
    assert energy_text(88_200.0) == "24.5 Wh"
    assert energy_text(442_440.0) == "123 Wh"
    assert [counted(1, "route"), counted(2, "route"), counted(0, "pond"), counted(1200, "pond")] == [
        "1 route",
        "2 routes",
        "0 ponds",
        "1,200 ponds",
    ]
