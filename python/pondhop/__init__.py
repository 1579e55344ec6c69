"""Balanced routes and checked missions for drone fleets that sample aquaculture ponds."""

from pondhop._core import LocalFrame, Plan, Problem, __version__, evaluate
from pondhop.errors import Fault, InvalidInput

__all__ = ["Fault", "InvalidInput", "LocalFrame", "Plan", "Problem", "__version__", "evaluate"]
