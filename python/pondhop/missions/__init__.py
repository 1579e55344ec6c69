"""One checked mission a trip, with the parameters it needs and what the crew must know.

`mission` builds neutral items, `check` holds the rules, `autopilots` what an autopilot stores and must be set to,
`formats` the files that ground stations load, `parameters` those they set a drone by, `readme` the text for the crew.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pondhop.arguments import Arguments
from pondhop.documents.atomic import earlier_files, replace_files
from pondhop.errors import Fault, InvalidInput
from pondhop.farm import Farm, doubt_fault
from pondhop.missions.autopilots import ARDUPILOT, MAX_FENCE_RADIUS_M, RADIUS_MARGIN_M, reach_of
from pondhop.missions.check import BrokenRule, broken_rules, max_num_ponds
from pondhop.missions.formats import FORMATS
from pondhop.missions.mission import Mission, build_mission
from pondhop.missions.parameters import (
    MISSION_PLANNER_SUFFIX,
    QGROUNDCONTROL_SUFFIX,
    mission_planner_parameters,
    qgroundcontrol_parameters,
)
from pondhop.missions.readme import BEGINNING, crew_readme
from pondhop.solution import PLAN_WANTED, FarmPlan, FarmViolation, check_written
from pondhop.units import Units, gap_text, length_text

__all__ = ["README", "earlier_missions", "judged", "mission_texts", "obstacles", "write_missions"]

README = "README.txt"

_SUFFIXES = (
    *(mission_format.suffix for mission_format in FORMATS),
    *(
        f"{generation.tag}{suffix}"
        for generation in ARDUPILOT.generations
        for suffix in (MISSION_PLANNER_SUFFIX, QGROUNDCONTROL_SUFFIX)
    ),
)
_MISSION_FILE = re.compile(rf"drone-[1-9][0-9]*(?:-trip-[1-9][0-9]*)?({'|'.join(map(re.escape, _SUFFIXES))})")


def write_missions(folder: str | os.PathLike[str], farm_plan: FarmPlan, *, units: Units = "metric") -> list[Path]:
    """Write the missions of a plan, a parameter file a drone and ground station, and a ``README.txt`` for the crew.

    Every mission is checked first (see `pondhop.missions.check.broken_rules`), and every text is read back and must
    give the same mission. Files of an earlier plan in the folder are removed, also where the new ones are refused: no
    drone is to fly one of them. The folder changes as a whole, or stays as it was.

    Parameters
    ----------
    folder
        Where to; made if it is missing.
    farm_plan
        The plan. Ponds it leaves unserved are in no mission.
    units
        Of what people read; the numbers of missions and parameters are those of the autopilot.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InvalidInput
        With everything that keeps the plan from being flown, or every file of the user's own that has the name of one
        of ours; then nothing is written.
    OSError
        If a file cannot be written.
    """
    check_written(folder, farm_plan, "folder", units)
    folder = Path(folder)
    earlier = earlier_missions(folder)
    try:
        texts = mission_texts(farm_plan, units)
    except InvalidInput:
        if earlier:
            replace_files(folder, {}, earlier, (README,))
        raise
    replace_files(folder, texts, earlier, (README,))
    return [folder / name for name in texts]


def earlier_missions(folder: Path) -> list[str]:
    """Return the names of the files that an earlier plan left in a folder of missions.

    Its ``README.txt`` tells whether they are ours. That of a single mission would not: one that the crew saved again
    with a ground station is still not to be flown after the next plan.

    Raises
    ------
    InvalidInput
        With every file of the user's own that has the name of one of ours.
    OSError
        If the folder cannot be read.
    """
    names = sorted(path.name for path in folder.iterdir()) if folder.is_dir() else []
    ours = [name for name in names if name == README or _MISSION_FILE.fullmatch(name)]
    return earlier_files(folder, ours, README, BEGINNING)


def mission_texts(farm_plan: FarmPlan, units: Units = "metric") -> dict[str, str]:
    """Return what `write_missions` writes: name of the file -> text.

    Raises
    ------
    InvalidInput
        As `write_missions`.
    """
    missions = _missions(farm_plan)
    faults = [
        Fault(_place(violation), violation.message, violation.remedy)
        for violation in _judged(farm_plan, missions, units).violations_told_in(units)
        if violation.kind != "unserved"
    ]
    if not missions:
        faults.append(Fault("routes", "the plan has no route", "plan at least one pond"))
    if faults:
        raise InvalidInput(faults)
    texts = {}
    for trip, mission in zip(farm_plan.trips, missions, strict=True):
        for mission_format in FORMATS:
            texts[f"{mission.name}{mission_format.suffix}"] = mission_format.checked_text(mission)
        for generation in ARDUPILOT.generations:
            parameters = [generation.spelled(parameter) for parameter in ARDUPILOT.parameters(farm_plan, trip, units)]
            title = f"{mission.name}: what {ARDUPILOT.name} {generation.versions} must be set to"
            stem = f"{mission.name}{generation.tag}"
            texts[f"{stem}{MISSION_PLANNER_SUFFIX}"] = mission_planner_parameters(title, parameters)
            texts[f"{stem}{QGROUNDCONTROL_SUFFIX}"] = qgroundcontrol_parameters(title, parameters)
    texts[README] = crew_readme(farm_plan, ARDUPILOT, units)
    return texts


def obstacles(farm_plan: FarmPlan) -> tuple[FarmViolation, ...]:
    """Return what keeps the routes of a plan from being flown as missions; empty if nothing does.

    Parameters
    ----------
    farm_plan
        Its own ``obstacles`` are passed over.
    """
    _check(farm_plan)
    return _obstacles(farm_plan, _missions(farm_plan), "metric")


def judged(farm_plan: FarmPlan, units: Units = "metric") -> FarmPlan:
    """Return a plan with all that keeps it from being flown, told in some units, also what its file does not tell."""
    _check(farm_plan)
    return _judged(farm_plan, _missions(farm_plan), units)


def _check(farm_plan: object) -> None:
    arguments = Arguments()
    arguments.kind("farm_plan", farm_plan, FarmPlan, PLAN_WANTED)
    arguments.check()


def _judged(farm_plan: FarmPlan, missions: Sequence[Mission], units: Units) -> FarmPlan:
    found = _obstacles(farm_plan, missions, units)
    # What is found again is told in the units asked for; the rest only the planning knew, as ponds out of reach.
    again = {(violation.kind, violation.drone, violation.trip) for violation in found}
    known = [
        violation for violation in farm_plan.obstacles if (violation.kind, violation.drone, violation.trip) not in again
    ]
    return replace(farm_plan, obstacles=(*known, *found))


def _obstacles(farm_plan: FarmPlan, missions: Sequence[Mission], units: Units) -> tuple[FarmViolation, ...]:
    broken = [
        FarmViolation(
            rule.kind,
            _message(rule.fault, mission),
            _remedy(rule, mission, farm_plan),
            trip.drone + 1,
            None,
            rule.value,
            rule.limit,
            trip.number + 1 if farm_plan.is_round else None,
        )
        for trip, mission in zip(farm_plan.trips, missions, strict=True)
        for rule in broken_rules(mission, ARDUPILOT, margin_m=farm_plan.fleet.fence_margin_m, units=units)
    ]
    return (*_doubts(farm_plan.farm), *_near_drones(farm_plan, units), *_too_far(farm_plan, units), *broken)


def _doubts(farm: Farm) -> list[FarmViolation]:
    """Ponds whose place is a guess: nobody flies there before their owner has looked at them."""
    if not farm.doubts:
        return []
    fault = doubt_fault(farm.doubts)
    return [FarmViolation("unconfirmed", fault.message, fault.action)]


def _near_drones(farm_plan: FarmPlan, units: Units) -> list[FarmViolation]:
    """Drones that would pass each other nearer than their layers promise."""
    near = farm_plan.near_drones
    if near is None:
        return []
    out, home, apart_m = near
    spacing_m = farm_plan.layers.spacing_m
    message = (
        f"drone {out + 1} flies out while drone {home + 1} comes home {gap_text(apart_m, units)} above or below it, "
        f"nearer than {gap_text(spacing_m, units)}"
    )
    remedy = "plan again, with a shorter takeoff_interval_s or fewer drones"
    return [FarmViolation("layers", message, remedy, None, None, apart_m, spacing_m)]


def _too_far(farm_plan: FarmPlan, units: Units) -> list[FarmViolation]:
    """Drones that would leave the largest circle around home that the autopilot can keep them in."""
    most_m = MAX_FENCE_RADIUS_M - RADIUS_MARGIN_M
    reaches_m = [(trip, reach_of(farm_plan, trip)) for trip in farm_plan.trips]
    return [
        FarmViolation(
            "too_far",
            f"it gets {length_text(reach_m, units)} from the depot, "
            f"the fence of {ARDUPILOT.name} holds {length_text(most_m, units)}",
            "move the depot nearer, or leave the ponds beyond it out",
            trip.drone + 1,
            None,
            reach_m,
            most_m,
            trip.number + 1 if farm_plan.is_round else None,
        )
        for trip, reach_m in reaches_m
        if reach_m > most_m
    ]


def _missions(farm_plan: FarmPlan) -> list[Mission]:
    return [
        replace(
            build_mission(trip.drone, farm_plan.farm, farm_plan.fleet, trip.ponds, farm_plan.layers), name=trip.name
        )
        for trip in farm_plan.trips
    ]


def _remedy(rule: BrokenRule, mission: Mission, farm_plan: FarmPlan) -> str:
    if rule.kind != "too_many_items":
        return rule.fault.action
    num_drones = math.ceil(len(farm_plan.farm.ponds) / max_num_ponds(mission, ARDUPILOT))
    # Ponds spread unevenly over drones: as few as there are now may be enough in sum, and yet too few.
    return f"plan for at least {max(num_drones, farm_plan.fleet.num_drones + 1)} drones, or {rule.fault.action}"


def _place(violation: FarmViolation) -> str:
    if violation.drone is None:
        return "the plan"
    return f"drone-{violation.drone}" + ("" if violation.trip is None else f"-trip-{violation.trip}")


def _message(fault: Fault, mission: Mission) -> str:
    place = fault.path.removeprefix(mission.name).removeprefix(", ")
    return f"{place}: {fault.message}" if place else fault.message
