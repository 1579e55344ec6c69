"""Balanced routes and checked missions for drone fleets that sample aquaculture ponds."""

from importlib import import_module

TYPE_CHECKING = False
"""As `typing.TYPE_CHECKING`, without the time that importing it takes: the command line begins here."""

if TYPE_CHECKING:
    from pondhop import plot
    from pondhop._core import (
        Energy,
        LocalFrame,
        Plan,
        Problem,
        Separation,
        Violation,
        __version__,
        evaluate,
        lower_bound,
        lower_bound_of_makespan,
        separation,
    )
    from pondhop.errors import Fault, InvalidInput
    from pondhop.farm import Farm, Pond, generate_farm, read_farm, write_farm
    from pondhop.files.plan_geojson import write_plan_geojson
    from pondhop.files.plan_json import read_plan_json, write_plan_json
    from pondhop.fleet import Fleet, Wind, read_fleet
    from pondhop.instances import ResearchFarm, generate, read_farms, write_farms
    from pondhop.missions import write_missions
    from pondhop.planners import PLANNERS, plan, solve
    from pondhop.solution import FarmPlan, RoundSolution, Solution
    from pondhop.trips import Trip

_MODULE_OF = {
    "Energy": "_core",
    "Farm": "farm",
    "FarmPlan": "solution",
    "Fault": "errors",
    "Fleet": "fleet",
    "InvalidInput": "errors",
    "LocalFrame": "_core",
    "PLANNERS": "planners",
    "Plan": "_core",
    "Pond": "farm",
    "Problem": "_core",
    "ResearchFarm": "instances",
    "RoundSolution": "solution",
    "Separation": "_core",
    "Solution": "solution",
    "Trip": "trips",
    "Violation": "_core",
    "Wind": "fleet",
    "__version__": "_core",
    "evaluate": "_core",
    "generate": "instances",
    "generate_farm": "farm",
    "lower_bound": "_core",
    "lower_bound_of_makespan": "_core",
    "plan": "planners",
    "read_farm": "farm",
    "read_farms": "instances",
    "read_fleet": "fleet",
    "read_plan_json": "files.plan_json",
    "separation": "_core",
    "solve": "planners",
    "write_farm": "farm",
    "write_farms": "instances",
    "write_missions": "missions",
    "write_plan_geojson": "files.plan_geojson",
    "write_plan_json": "files.plan_json",
}

_MODULES = ("_core", "errors", "plot")
"""Modules that `import pondhop` alone makes reachable."""

__all__ = [
    "PLANNERS",
    "Energy",
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
    "RoundSolution",
    "Separation",
    "Solution",
    "Trip",
    "Violation",
    "Wind",
    "__version__",
    "evaluate",
    "generate",
    "generate_farm",
    "lower_bound",
    "lower_bound_of_makespan",
    "plan",
    "plot",
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
    if name in _MODULES:
        return import_module(f"pondhop.{name}")
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'pondhop' has no attribute {name!r}")
    value: object = getattr(import_module(f"pondhop.{_MODULE_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
