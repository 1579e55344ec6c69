"""Columns of tables that say together where a pond is: hemispheres, angles in parts, zones of UTM."""

from __future__ import annotations

from pathlib import Path

import pytest

from farm_files import DEPOT, faults_of, ids, table
from pondhop.farm import read_farm

SOUTH_WEST = (-60.7, -10.1)


def first_place(folder: Path, text: str, depot: tuple[float, float] = DEPOT) -> tuple[float, float]:
    lon, lat = read_farm(table(folder, text), depot=depot).ponds[0].sampling_point
    return round(lon, 5), round(lat, 5)


@pytest.mark.parametrize(
    ("heading", "cells"),
    [
        ("lat,lon,hemisphere", ("10.1,60.7,SW", "10.101,60.701,SW")),
        ("lat,lon,quadrant", ("10.1,60.7,S/W", "10.101,60.701,S/W")),
        ("lat,lon,hemisferio", ("10.1,60.7,Sur Oeste", "10.101,60.701,Sur Oeste")),
        ("lat,dir,lon,dir", ("10.1,S,60.7,W", "10.101,S,60.701,W")),
        ("lat,lon,lat_dir,lon_dir", ("10.1,60.7,S,W", "10.101,60.701,S,W")),
        ("lat,lon,hemi_lat,hemi_lon", ("10.1,60.7,South,West", "10.101,60.701,South,West")),
        ("lat,lon,lat_sign,lon_sign", ("10.1,60.7,-,-", "10.101,60.701,-,-")),
        ("lat,lon,sign_lat,sign_lon", ("10.1,60.7,-1,-1", "10.101,60.701,-1,-1")),
        ("a,lat,b,lon", ("S,10.1,W,60.7", "S,10.101,W,60.701")),
    ],
)
def test_columns_of_hemispheres_are_obeyed(tmp_path: Path, heading: str, cells: tuple[str, str]) -> None:
    text = f"pond,{heading}\nP1,{cells[0]}\nP2,{cells[1]}\n"
    assert first_place(tmp_path, text, SOUTH_WEST) == (-60.7, -10.1)


@pytest.mark.parametrize(
    ("heading", "cells"), [("block", "SW"), ("depth,a,b", "2,S,W"), ("part,depth", "S/W,2"), ("a,depth,b", "W,2,S")]
)
def test_letters_that_may_be_hemispheres_are_asked_about(tmp_path: Path, heading: str, cells: str) -> None:
    faults = faults_of(table(tmp_path, f"pond,lat,lon,depth_m,{heading}\nP1,10.1,60.7,1,{cells}\n"))
    if "/" in cells:
        # Longer than letters, so that it is a text like any other.
        assert not any("hemisphere" in message for _, message, _ in faults)
    else:
        assert "tell the hemisphere" in faults[0][1]
        assert "hemisphere if it does" in faults[0][2]


@pytest.mark.parametrize(
    ("heading", "cells"),
    [("aerated", ("no", "no")), ("size", ("S", "L")), ("size", ("S", "S")), ("corner", ("NE", "SW"))],
)
def test_other_letters_are_no_hemispheres(tmp_path: Path, heading: str, cells: tuple[str, str]) -> None:
    text = f"pond,lat,lon,depth_m,{heading}\nP1,10.1,105.7,1,{cells[0]}\nP2,10.101,105.701,1,{cells[1]}\n"
    assert first_place(tmp_path, text) == (105.7, 10.1)


@pytest.mark.parametrize(
    ("heading", "cells", "expected"),
    [
        ("lat_deg,lat_min,lat_sec,lon_deg,lon_min,lon_sec", "10,6,1.4,105,42,0", (105.7, 10.10039)),
        ("latD,latM,latS,lonD,lonM,lonS", "10,6,1.4,105,42,0", (105.7, 10.10039)),
        ("Latitude,Min,Sec,Longitude,Min,Sec", "10,6,1.4,105,42,0", (105.7, 10.10039)),
        ("Lat °,Lat ',Lat sec,Lon °,Lon ',Lon sec", "10,6,1.4,105,42,0", (105.7, 10.10039)),
        ("lat grados,lat minutos,lon grados,lon minutos", "10.0,6.0,105.0,42.0", (105.7, 10.1)),
        ("lat_deg,lat_min,lon_deg,lon_min", "10,6.03,105,42.06", (105.701, 10.1005)),
        ("lat_deg,lat_min,lat_sec,lon_deg,lon_min,lon_sec", "10°,6',,105°,42',", (105.7, 10.1)),
        ("Lat Deg,Lat Min,Lat Sec,N/S,Lon Deg,Lon Min,Lon Sec,E/W", "10,6,1.4,N,105,42,0,E", (105.7, 10.10039)),
    ],
)
def test_angles_in_parts_are_joined(tmp_path: Path, heading: str, cells: str, expected: tuple[float, float]) -> None:
    text = f"pond,{heading}\nP1,{cells}\n"
    assert first_place(tmp_path, text) == expected
    farm = read_farm(table(tmp_path, f"My farm\n{text}"), depot=DEPOT)
    assert ids(farm) == ["P1"]
    assert any("in columns of their own" in note for note in farm.notes)


def test_parts_below_zero_keep_their_sign(tmp_path: Path) -> None:
    heading = "pond,lat_deg,lat_min,lon_deg,lon_min\n"
    assert first_place(tmp_path, f"{heading}P1,-0,30,-0,6\n", (-0.1, -0.5)) == (-0.1, -0.5)
    assert first_place(tmp_path, f"{heading}P1,-10,30,-60,6\n", (-60.1, -10.5)) == (-60.1, -10.5)


def test_a_typing_error_in_one_part_is_a_fault(tmp_path: Path) -> None:
    good = "".join(f"P{row},10,{row},105,{row}\n" for row in range(5))
    for bad, message in (
        ("10,66,105,1", "has 66 minutes"),
        ("10.5,6,105,1", "is no number"),
        ("10,x,105,1", "is no number"),
        (",6,105,1", "is empty"),
    ):
        faults = faults_of(table(tmp_path, f"pond,lat_deg,lat_min,lon_deg,lon_min\n{good}P9,{bad}\n"))
        assert message in faults[0][1]
        assert faults[0][0] == "line 7, column lat_deg"


def test_extents_are_no_angles_in_parts(tmp_path: Path) -> None:
    text = "pond,x,xmin,y,ymin\nP1,30.9,30.8,31.1,31.0\nP2,30.901,30.8,31.101,31.0\n"
    assert first_place(tmp_path, text, (30.9, 31.1)) == (30.9, 31.1)


@pytest.mark.parametrize(
    ("heading", "cells"),
    [
        ("UTM_E,UTM_N,UTM_zone,hemisphere", "576800,1116600,48,N"),
        ("zone,letter,E,N", "48,P,576800,1116600"),
        ("UTM,band,X,Y", "48,N,576800,1116600"),
        ("X (m),Y (m),UTM Zone", "576800,1116600,48 N"),
        ("Easting (m),Northing (m),Zone", "576800,1116600,48P"),
        ("x,y,zone_number,zone_letter", "576800,1116600,48,P"),
    ],
)
def test_utm_in_the_columns_of_many_programs(tmp_path: Path, heading: str, cells: str) -> None:
    assert first_place(tmp_path, f"pond,{heading}\nP1,{cells}\n") == (105.70096, 10.10044)


def test_band_s_in_a_column_of_its_own_is_asked_about(tmp_path: Path) -> None:
    faults = faults_of(table(tmp_path, "pond,zone,letter,E,N\nP1,48,S,576800,1116600\n"))
    assert "north or south" in faults[0][1]


def test_a_column_without_heading_tells_ponds_apart_or_nothing(tmp_path: Path) -> None:
    named = read_farm(table(tmp_path, "lat,lon,\n10.1,105.7,A\n10.101,105.701,B\n"), depot=DEPOT)
    assert ids(named) == ["A", "B"]
    numbered = read_farm(table(tmp_path, "lat,lon,,\n10.1,105.7,big,\n10.101,105.701,big,\n"), depot=DEPOT)
    assert len(set(ids(numbered))) == 2
