"""Balanced routes and checked missions for drone fleets that sample aquaculture ponds."""

from importlib import import_module
from typing import TYPE_CHECKING

from pondhop._core import LocalFrame, Plan, Problem, Separation, __version__, evaluate, lower_bound, separation
from pondhop.errors import Fault, InvalidInput

if TYPE_CHECKING:
    from pondhop.farm import Farm, Pond, read_farm, write_farm
    from pondhop.farm_generator import generate_farm
    from pondhop.fleet import Fleet, read_fleet
    from pondhop.instances import ResearchFarm, generate, read_farms, write_farms
    from pondhop.missions import write_missions
    from pondhop.planfile import FarmPlan, Solution, read_plan_json, write_plan_geojson, write_plan_json
    from pondhop.planners import PLANNERS, plan, solve

_MODULE_OF = {
    "FarmPlan": "planfile",
    "Farm": "farm",
    "Fleet": "fleet",
    "PLANNERS": "planners",
    "Pond": "farm",
    "ResearchFarm": "instances",
    "Solution": "planfile",
    "generate": "instances",
    "generate_farm": "farm_generator",
    "plan": "planners",
    "read_farm": "farm",
    "read_farms": "instances",
    "read_fleet": "fleet",
    "read_plan_json": "planfile",
    "solve": "planners",
    "write_farm": "farm",
    "write_farms": "instances",
    "write_missions": "missions",
    "write_plan_geojson": "planfile",
    "write_plan_json": "planfile",
}

__all__ = [
    "PLANNERS",
    "Farm",
    "FarmPlan",
    "Fault",
    "Fleet",
    "InvalidInput",
    "LocalFrame",
    "Plan",
    "Pond",
    "Problem",
    "ResearchFarm",
    "Separation",
    "Solution",
    "__version__",
    "evaluate",
    "generate",
    "generate_farm",
    "lower_bound",
    "plan",
    "read_farm",
    "read_farms",
    "read_fleet",
    "read_plan_json",
    "separation",
    "solve",
    "write_farm",
    "write_farms",
    "write_missions",
    "write_plan_geojson",
    "write_plan_json",
]


def __getattr__(name: str) -> object:
    """Import the module of a public name when the name is first used, so that `import pondhop` stays light."""
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'pondhop' has no attribute {name!r}")
    value: object = getattr(import_module(f"pondhop.{_MODULE_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
