"""Formats of mission files: what every one in the list must do, and what a new one needs."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from hand_made import make_farm, square, two_drones
from pondhop import missions
from pondhop.fleet import Fleet
from pondhop.missions import formats
from pondhop.missions.formats import FORMATS, MissionFormat
from pondhop.missions.mission import Action, Mission, MissionItem, build_mission

FLEETS = [
    Fleet(num_drones=3),
    Fleet(num_drones=3, sampling="splashdown", dwell_s=30),
    Fleet(3, transit_height_m=33.333333333),
]


@pytest.mark.parametrize("mission_format", FORMATS, ids=lambda found: found.suffix)
@pytest.mark.parametrize("fleet", FLEETS, ids=lambda fleet: fleet.sampling)
def test_what_is_written_reads_back_as_the_same_mission(mission_format: MissionFormat, fleet: Fleet) -> None:
    farm = make_farm(no_fly=((square(-89.005, 36.995, 0.001),),))
    for drone in range(3):
        mission = build_mission(drone, farm, fleet, [0, 3, 1])
        text = mission_format.checked_text(mission)
        read = mission_format.parse(text, mission.name)
        assert read == (mission if mission_format.has_areas else replace(mission, fences=(), no_fly=()))


def test_formats_have_names_and_suffixes_of_their_own() -> None:
    assert len({found.suffix for found in FORMATS}) == len({found.name for found in FORMATS}) == len(FORMATS)
    assert all(found.suffix.startswith(".") for found in FORMATS)


def toy_text(mission: Mission) -> str:
    items = [asdict(item) | {"action": item.action.value, "pond_id": None} for item in mission.items]
    return json.dumps({"home": mission.home, "speed_m_s": mission.speed_m_s, "items": items})


def parse_toy(text: str, name: str) -> Mission:
    content = json.loads(text)
    items = []
    for item in content["items"]:
        position = None if item["position"] is None else tuple(item["position"])
        items.append(MissionItem(**item | {"action": Action(item["action"]), "position": position}))
    return Mission(name, tuple(content["home"]), content["speed_m_s"], tuple(items))


def test_a_new_format_is_a_module_and_a_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    toy = MissionFormat("Toy", ".toy", toy_text, parse_toy, has_areas=False)
    monkeypatch.setattr(missions, "FORMATS", (*formats.FORMATS, toy))
    missions.write_missions(tmp_path, two_drones())
    assert (tmp_path / "drone-1.toy").exists()


def test_a_format_that_loses_something_is_found_out() -> None:
    forgetful = MissionFormat(
        "Forgetful", ".f", lambda mission: toy_text(replace(mission, items=mission.items[1:])), parse_toy, False
    )
    with pytest.raises(RuntimeError, match="another mission"):
        forgetful.checked_text(build_mission(0, make_farm(), Fleet(1), [0]))
