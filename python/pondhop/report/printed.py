"""What the paper prints: tables 1 and 2, for 5 routes and averages of 100 farms.

Source: Davis, Mukherjee, Wills and Ouyang, *Path planning algorithms for robotic aquaculture monitoring*. GLOP is its
name for Google OR-Tools.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Column = Literal["HPP", "AM50", "AM100", "GLOP"]
COLUMNS: tuple[Column, ...] = ("HPP", "AM50", "AM100", "GLOP")


@dataclass(frozen=True)
class Printed:
    """A method's numbers for one number of ponds.

    Attributes
    ----------
    total_length, max_route_length
        Average total distance and average maximum route length, in the unit square.
    seconds
        Run time for 100 farms.
    """

    total_length: float
    max_route_length: float
    seconds: float


TABLE_1: dict[Column, dict[int, Printed]] = {
    "HPP": {
        50: Printed(7.62, 2.01, 1.38e-3),
        100: Printed(9.94, 2.53, 2.99e-3),
        200: Printed(12.66, 3.14, 4.76e-3),
        300: Printed(15.37, 3.79, 9.51e-3),
        500: Printed(19.02, 4.58, 1.07e-2),
        700: Printed(21.72, 5.28, 1.55e-2),
    },
    "AM50": {
        50: Printed(7.19, 1.75, 0.11),
        100: Printed(9.45, 2.27, 0.35),
        200: Printed(13.06, 2.73, 0.90),
        300: Printed(17.22, 4.02, 2.15),
        500: Printed(25.46, 5.57, 5.97),
        700: Printed(35.35, 12.77, 17.97),
    },
    "AM100": {
        50: Printed(7.60, 1.82, 0.12),
        100: Printed(9.85, 2.39, 0.31),
        200: Printed(12.95, 3.27, 1.07),
        300: Printed(16.47, 3.89, 2.39),
        500: Printed(22.79, 6.32, 6.49),
        700: Printed(29.74, 7.66, 18.51),
    },
    "GLOP": {
        50: Printed(6.37, 1.47, 73.50),
        100: Printed(7.72, 1.65, 658.15),
        200: Printed(9.12, 1.90, 5435.26),
    },
}

TABLE_2: dict[Column, tuple[str, str, str]] = {
    "HPP": ("Medium", "High", "High"),
    "AM50": ("Medium", "Medium", "Medium"),
    "AM100": ("Medium", "Medium", "Medium"),
    "GLOP": ("High", "Low", "Medium"),
}
"""Optimality, scalability, practicality; the paper has one row for AM."""
