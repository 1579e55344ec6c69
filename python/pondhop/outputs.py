"""What a plan of a farm becomes in a folder: plan.json, plan.geojson, missions and a picture."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pondhop.errors import Fault, InvalidInput
from pondhop.files.plan_geojson import write_plan_geojson
from pondhop.files.plan_json import write_plan_json
from pondhop.missions import write_missions
from pondhop.solution import FarmPlan
from pondhop.units import Units

PLAN_JSON, PLAN_GEOJSON, MISSIONS = "plan.json", "plan.geojson", "missions"
FIGURES = ("plan.png", "plan.svg")


@dataclass(frozen=True)
class Outputs:
    """What was written of a plan.

    Attributes
    ----------
    names
        Of the files and folders written, within the folder of the plan.
    faults
        What keeps the plan from being flown; then there are no missions.
    """

    names: tuple[str, ...]
    faults: tuple[Fault, ...]


def write_outputs(folder: Path, farm_plan: FarmPlan, *, has_figure: bool, units: Units = "metric") -> Outputs:
    """Write all that a plan becomes; pictures of an earlier plan are removed where none is drawn.

    Parameters
    ----------
    folder
        Where to; made if it is missing.
    farm_plan
        The plan.
    has_figure
        Whether to draw it, which needs matplotlib.
    units
        What the picture tells lengths in.

    Returns
    -------
    Outputs
        That no mission could be written is a result, like every broken rule of a plan.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_plan_json(folder / PLAN_JSON, farm_plan)
    write_plan_geojson(folder / PLAN_GEOJSON, farm_plan)
    faults: tuple[Fault, ...] = ()
    try:
        write_missions(folder / MISSIONS, farm_plan)
    except InvalidInput as error:
        faults = error.faults
    if has_figure:
        from pondhop import plot

        axes = plot.plot_plan(farm_plan, units=units)
        for name in FIGURES:
            plot.save_figure(axes, folder / name)
    else:
        for name in FIGURES:
            (folder / name).unlink(missing_ok=True)
    names = [PLAN_JSON, PLAN_GEOJSON, *(() if faults else [f"{MISSIONS}/"]), *(FIGURES if has_figure else ())]
    return Outputs(tuple(names), faults)
