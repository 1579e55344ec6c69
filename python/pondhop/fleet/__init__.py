"""Fleets: what a drone is, how it flies and samples, and the files that say so.

`model` holds the value, `settings` what each number may be and where its default comes from, `times` how long each
phase of a flight takes and what it draws from the battery, `clock` the times of a round, `wind` what blows, `read` the
files.
"""

from pondhop.fleet.model import Fleet, SamplingStyle
from pondhop.fleet.read import read_fleet
from pondhop.fleet.settings import MAX_HEIGHT_M
from pondhop.fleet.wind import CALM, Wind, parse_wind

__all__ = ["CALM", "MAX_HEIGHT_M", "Fleet", "SamplingStyle", "Wind", "parse_wind", "read_fleet"]
