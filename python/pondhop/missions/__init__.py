"""One checked mission a drone: QGroundControl ``.plan`` and ``.waypoints`` files for ArduPilot Copter."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Container, Iterator
from pathlib import Path

from pondhop.documents.atomic import write_all
from pondhop.errors import Fault, InvalidInput
from pondhop.missions.mavlink import MAX_NUM_ITEMS
from pondhop.missions.mission import Mission, build_mission, check_mission
from pondhop.missions.qgroundcontrol import parse_qgroundcontrol_plan, qgroundcontrol_plan
from pondhop.missions.waypoints import parse_waypoints, waypoints
from pondhop.solution import FarmPlan

__all__ = ["write_missions"]

_MISSION_FILE = re.compile(r"drone-[1-9][0-9]*\.(plan|waypoints)")

_TOLERANCE = 1e-9
"""How far beyond a limit rounding may carry a length or duration, relative to the limit."""


def write_missions(folder: str | os.PathLike[str], farm_plan: FarmPlan) -> list[Path]:
    """Write one ``drone-N.plan`` and one ``drone-N.waypoints`` per route, and a ``README.txt`` for the flight crew.

    Every mission is checked first (see `pondhop.missions.mission.check_mission`), and every text is read back and must
    give the same mission. Missions of an earlier plan in the folder are removed, also where the new ones are refused:
    no drone is to fly one of them.

    Parameters
    ----------
    folder
        Where to; made if it is missing.
    farm_plan
        The plan. Ponds it leaves unserved are in no mission.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InvalidInput
        With every broken rule of every mission; then nothing is written.
    OSError
        If a file cannot be written.
    """
    folder, routes = Path(folder), farm_plan.solution.plan.routes
    missions = [
        build_mission(f"drone-{drone}", farm_plan.farm, farm_plan.fleet, route)
        for drone, route in enumerate(routes, start=1)
    ]
    faults = list(_limit_faults(farm_plan))
    for mission in missions:
        faults.extend(check_mission(mission, max_num_items=MAX_NUM_ITEMS))
    if faults:
        _remove_missions(folder, keep=())
        raise InvalidInput(faults)
    texts = {}
    for mission in missions:
        texts[folder / f"{mission.name}.plan"] = _plan_text(mission)
        texts[folder / f"{mission.name}.waypoints"] = _waypoints_text(mission)
    texts[folder / "README.txt"] = _readme(farm_plan)
    write_all(texts)
    _remove_missions(folder, keep=texts)
    return list(texts)


def _remove_missions(folder: Path, keep: Container[Path]) -> None:
    for path in folder.iterdir() if folder.is_dir() else ():
        if _MISSION_FILE.fullmatch(path.name) and path not in keep:
            path.unlink()


def _limit_faults(farm_plan: FarmPlan) -> Iterator[Fault]:
    plan, fleet = farm_plan.solution.plan, farm_plan.fleet
    if not plan.routes:
        yield Fault("routes", "the plan has no route", "plan at least one pond")
    limits = [
        ("long", "m", "max_route_length_m", fleet.max_route_length_m, plan.route_lengths),
        ("under way", "s", "max_route_duration_s", fleet.max_route_duration_s, plan.route_durations_s),
    ]
    for word, unit, name, limit, values in limits:
        for drone, value in enumerate(values, start=1):
            if limit is not None and value > limit * (1 + _TOLERANCE):
                message = f"it is {value:.1f} {unit} {word}, the drone's {name} is {limit:g}"
                yield Fault(f"drone-{drone}", message, "use more drones, or leave ponds out")


def _plan_text(mission: Mission) -> str:
    text = qgroundcontrol_plan(mission)
    _confirm(mission, text, parse_qgroundcontrol_plan)
    return text


def _waypoints_text(mission: Mission) -> str:
    text = waypoints(mission)
    without_areas = Mission(mission.name, mission.home, mission.speed_m_s, mission.items)
    _confirm(without_areas, text, parse_waypoints)
    return text


def _confirm(mission: Mission, text: str, parse: Callable[[str, str], Mission]) -> None:
    if parse(text, mission.name) != mission:
        raise RuntimeError(f"{mission.name} reads back as another mission than was written: a bug of pondhop")


def _readme(farm_plan: FarmPlan) -> str:
    fleet, plan = farm_plan.fleet, farm_plan.solution.plan
    rows = [
        f"  drone-{index + 1}: {len(route)} ponds, {plan.route_lengths[index]:.0f} m, "
        f"{plan.route_durations_s[index] / 60:.1f} min"
        for index, route in enumerate(plan.routes)
    ]
    notes = [
        "For ArduPilot Copter. Load the .plan files in QGroundControl, or the .waypoints files in Mission Planner: the "
        "same missions, but only .plan holds the fence and the no-fly zones.",
        f"Heights are above the depot ({fleet.transit_height_m:g} m between ponds); the ground is taken to be flat.",
        "Every drone takes off at the depot and comes back by RTL, at the height that its parameter RTL_ALT sets.",
        *farm_plan.notes,
    ]
    return "\n".join([f"Missions for {farm_plan.farm.name}, {fleet.sampling}", "", *rows, "", *notes]) + "\n"
