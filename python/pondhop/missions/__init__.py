"""One checked mission a drone: QGroundControl ``.plan`` and ``.waypoints`` files for ArduPilot Copter."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Container
from pathlib import Path

from pondhop.documents.atomic import write_all
from pondhop.errors import Fault, InvalidInput
from pondhop.missions.mavlink import MAX_NUM_ITEMS
from pondhop.missions.mission import Mission, build_mission, check_mission
from pondhop.missions.qgroundcontrol import parse_qgroundcontrol_plan, qgroundcontrol_plan
from pondhop.missions.waypoints import parse_waypoints, waypoints
from pondhop.solution import FarmPlan, FarmViolation

__all__ = ["obstacles", "write_missions"]

_MISSION_FILE = re.compile(r"drone-[1-9][0-9]*\.(plan|waypoints)")


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
    folder = Path(folder)
    missions = _missions(farm_plan)
    faults = [
        Fault(_place(violation), violation.message, violation.remedy)
        for violation in (*farm_plan.violations, *(obstacles(farm_plan) if not farm_plan.obstacles else ()))
        if violation.kind != "unserved"
    ]
    if not missions:
        faults.append(Fault("routes", "the plan has no route", "plan at least one pond"))
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


def obstacles(farm_plan: FarmPlan) -> tuple[FarmViolation, ...]:
    """Return what keeps the routes of a plan from being flown as missions; empty if nothing does.

    Parameters
    ----------
    farm_plan
        Its own ``obstacles`` are passed over.
    """
    return tuple(
        FarmViolation("mission", _message(fault, mission), fault.action, drone=drone)
        for drone, mission in enumerate(_missions(farm_plan), start=1)
        for fault in check_mission(mission, max_num_items=MAX_NUM_ITEMS)
    )


def _message(fault: Fault, mission: Mission) -> str:
    place = fault.path.removeprefix(mission.name).removeprefix(", ")
    return f"{place}: {fault.message}" if place else fault.message


def _missions(farm_plan: FarmPlan) -> list[Mission]:
    return [
        build_mission(f"drone-{drone}", farm_plan.farm, farm_plan.fleet, route)
        for drone, route in enumerate(farm_plan.solution.plan.routes, start=1)
    ]


def _place(violation: FarmViolation) -> str:
    return "the plan" if violation.drone is None else f"drone-{violation.drone}"


def _remove_missions(folder: Path, keep: Container[Path]) -> None:
    for path in folder.iterdir() if folder.is_dir() else ():
        if _MISSION_FILE.fullmatch(path.name) and path not in keep:
            path.unlink()


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
    needs = [
        "Splashdown: set bit 2 of the ArduPilot parameter MIS_OPTIONS (add 4) on every drone, or it disarms on the "
        "first pond and stays there."
    ]
    notes = [
        "For ArduPilot Copter. Load the .plan files in QGroundControl, or the .waypoints files in Mission Planner: the "
        "same missions, but only .plan holds the fence and the no-fly zones.",
        f"Heights are above the depot ({fleet.transit_height_m:g} m between ponds); the ground is taken to be flat.",
        "Every drone takes off at the depot and comes back by RTL, at the height that its parameter RTL_ALT sets.",
        *(needs if fleet.sampling == "splashdown" else ()),
        *farm_plan.notes,
    ]
    return "\n".join([f"Missions for {farm_plan.farm.name}, {fleet.sampling}", "", *rows, "", *notes]) + "\n"
