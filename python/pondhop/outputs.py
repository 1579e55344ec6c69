"""What a plan of a farm becomes in a folder: plan.json, plan.geojson, missions and a picture."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path

from pondhop.arguments import checked_path
from pondhop.documents.atomic import Content, check_is_file_or_absent, earlier_files, replace_files
from pondhop.errors import Fault, InvalidInput
from pondhop.farm.features import listed
from pondhop.files.plan_geojson import plan_geojson
from pondhop.files.plan_json import BEGINNING, plan_json
from pondhop.missions import README, earlier_missions, mission_texts
from pondhop.solution import FarmPlan, check_written
from pondhop.units import Units

PLAN_JSON, PLAN_GEOJSON, MISSIONS = "plan.json", "plan.geojson", "missions"
FIGURES = ("plan.png", "plan.svg")
NIGHT_FIGURES = ("night.png", "night.svg")
"""Of rounds: trips, swaps and batteries over the clock."""


@dataclass(frozen=True)
class Outputs:
    """What was written of a plan.

    Attributes
    ----------
    names
        Of the files and folders written, within the folder of the plan.
    plan_json
        The text of ``plan.json``.
    faults
        What keeps the plan from being flown; then there are no missions.
    farm_plan
        The plan with what was noted while writing.
    """

    names: tuple[str, ...]
    plan_json: str
    faults: tuple[Fault, ...]
    farm_plan: FarmPlan


def write_outputs(
    folder: str | os.PathLike[str], farm_plan: FarmPlan, *, has_figure: bool, units: Units = "metric"
) -> Outputs:
    """Write all that a plan becomes, in place of an earlier plan in the folder, as a whole.

    The folder holds all of the new plan or all of the old one, also after a full disk or a signal on the way; files of
    the user stay.

    Parameters
    ----------
    folder
        Where to; made if it is missing.
    farm_plan
        The plan.
    has_figure
        Whether to draw it, which needs matplotlib.
    units
        What picture, missions and faults tell lengths in; plan.json and plan.geojson are in metres.

    Returns
    -------
    Outputs
        That no mission could be written is a result, like every broken rule of a plan.

    Raises
    ------
    InvalidInput
        If a folder, a file of the user's own or the like has the name of one of the files.
    OSError
        If a file cannot be written; then the folder is as it was.
    """
    check_written(folder, farm_plan, "folder", units)
    folder = Path(folder)
    check_folder(folder)
    pictures: dict[str, Content] = {}
    if has_figure:
        from pondhop import plot

        axes, unwritten = plot.drawn_plan(farm_plan, units=units)
        pictures = {name: plot.figure_bytes(axes, name.rpartition(".")[2]) for name in FIGURES}
        if farm_plan.is_round and farm_plan.trips:
            night = plot.plot_night(farm_plan)
            pictures |= {name: plot.figure_bytes(night, name.rpartition(".")[2]) for name in NIGHT_FIGURES}
        farm_plan = _with_note_of_letters(farm_plan, unwritten)
    text = plan_json(farm_plan)
    files: dict[str, Content] = {PLAN_JSON: text, PLAN_GEOJSON: plan_geojson(farm_plan)}
    faults: tuple[Fault, ...] = ()
    try:
        files |= {f"{MISSIONS}/{name}": text for name, text in mission_texts(farm_plan, units).items()}
    except InvalidInput as error:
        faults = error.faults
    files |= pictures
    replace_files(folder, files, _earlier(folder), (PLAN_JSON, f"{MISSIONS}/{README}"))
    names = [PLAN_JSON, PLAN_GEOJSON, *(() if faults else [f"{MISSIONS}/"]), *pictures]
    return Outputs(tuple(names), text, faults, farm_plan)


def check_folder(folder: str | os.PathLike[str]) -> None:
    """Refuse a folder that `write_outputs` would refuse, before anybody has waited for a plan.

    Raises
    ------
    InvalidInput
        If it is no folder, or a folder, a file of the user's own or the like has the name of one of the files.
    OSError
        If the folder cannot be read.
    """
    folder = checked_path("folder", folder)
    for path in (folder, folder / MISSIONS):
        if os.path.lexists(path) and not path.is_dir():
            message = "pondhop writes a folder of this name, and there is something else"
            raise InvalidInput([Fault(str(path), message, "move it away, or choose another folder")])
    for name in _earlier(folder):
        check_is_file_or_absent(folder / name)


def _with_note_of_letters(farm_plan: FarmPlan, missing: frozenset[str]) -> FarmPlan:
    """Return the plan with a note of the names that the picture cannot show, if letters are missing."""
    if not missing:
        return farm_plan
    from pondhop.plot.fonts import REPLACEMENT

    farm = farm_plan.farm
    names = dict.fromkeys([farm.name, *(pond.id for pond in farm.ponds)])
    unwritten = listed(name for name in names if missing & set(name))
    note = (
        f"No font of this machine has all letters of {unwritten}: the picture shows {REPLACEMENT} for those that are "
        "missing. Install a font of that script, as Noto Sans, to see them."
    )
    return replace(farm_plan, farm=replace(farm, notes=(*farm.notes, note)))


def _earlier(folder: Path) -> list[str]:
    """Files of an earlier plan in the folder; those of the user are none."""
    plans = earlier_files(folder, (PLAN_JSON, PLAN_GEOJSON, *FIGURES, *NIGHT_FIGURES), PLAN_JSON, BEGINNING)
    return [*plans, *(f"{MISSIONS}/{name}" for name in earlier_missions(folder / MISSIONS))]
