"""Write the uniform instances that papers on learned min-max routing measure on.

    python scripts/uniform_farms.py NUM_POINTS NUM_FARMS SEED OUTPUT.jsonl

The points are those of `numpy.random.seed(SEED)` and `numpy.random.uniform(size=(NUM_FARMS, NUM_POINTS, 2))`; the first
of each instance is its depot, so that it has a pond less than points.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from pondhop import ResearchFarm, write_farms


def uniform_farms(num_points: int, num_farms: int, seed: int) -> list[ResearchFarm]:
    """Return farms whose points are drawn from the unit square."""
    points = np.random.RandomState(seed).uniform(size=(num_farms, num_points, 2))
    return [ResearchFarm(depot=farm[0], ponds=farm[1:]) for farm in points]


def main() -> None:
    """Write the farms that the command line asks for."""
    num_points, num_farms, seed = (int(argument) for argument in sys.argv[1:4])
    write_farms(Path(sys.argv[4]), uniform_farms(num_points, num_farms, seed))


if __name__ == "__main__":
    main()
