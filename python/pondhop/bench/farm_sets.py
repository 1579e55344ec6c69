"""Which farms a benchmark plans, and with how many routes."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal

from pondhop import instances
from pondhop.bench.best_known import BestKnown
from pondhop.errors import Fault, InvalidInput
from pondhop.instances import ResearchFarm


@dataclass(frozen=True, eq=False)
class BenchFarm:
    """A farm of a set.

    Attributes
    ----------
    set_name, index
        The set, and the place of the farm in it, from 0.
    farm
        Depot and ponds.
    """

    set_name: str
    index: int
    farm: ResearchFarm

    @cached_property
    def digest(self) -> str:
        """12 hexadecimal digits that tell farms of different positions apart, whatever they are called."""
        positions = (self.farm.depot.astype("<f8").tobytes(), self.farm.ponds.astype("<f8").tobytes())
        return hashlib.sha256(b"".join(positions)).hexdigest()[:12]


@dataclass(frozen=True)
class Task:
    """A farm and how many routes it may be given."""

    farm: BenchFarm
    num_routes: int


def read_farm_sets(paths: Iterable[Path]) -> list[BenchFarm]:
    """Read farm files; a set is named after its file, without the suffix.

    Raises
    ------
    InvalidInput
        With every fault of every file, and where two files would give sets of one name.
    """
    faults = []
    farms: list[BenchFarm] = []
    files_of_sets: dict[str, Path] = {}
    for path in paths:
        if path.stem in files_of_sets:
            message = f"the set {path.stem!r} is already that of {files_of_sets[path.stem]}"
            faults.append(Fault(str(path), message, "give files of different names"))
            continue
        files_of_sets[path.stem] = path
        try:
            farms += [BenchFarm(path.stem, index, farm) for index, farm in enumerate(instances.read(path))]
        except InvalidInput as error:
            faults += [_in_file(path, fault) for fault in error.faults]
    if faults:
        raise InvalidInput(faults)
    return farms


def generate_farm_set(
    num_ponds: int, num_farms: int, *, seed: int = 1, variant: Literal["authors", "paper"] = "authors"
) -> list[BenchFarm]:
    """Draw a set of farms; its name says how: ``authors50-seed1``.

    Raises
    ------
    InvalidInput
        As `pondhop.generate`.
    """
    drawn = instances.generate(num_ponds, num_farms, seed=seed, variant=variant)
    return [BenchFarm(f"{variant}{num_ponds}-seed{seed}", index, farm) for index, farm in enumerate(drawn)]


def tasks(farms: Sequence[BenchFarm], num_routes: Sequence[int], best_known: BestKnown) -> list[Task]:
    """Return every farm with every number of routes.

    Parameters
    ----------
    farms
        Of one or more sets.
    num_routes
        How many routes are allowed; where empty, every number for which `best_known` has a plan of the farm.
    best_known
        See `BestKnown`.

    Raises
    ------
    InvalidInput
        If nothing says how many routes a farm may be given.
    """
    faults = []
    found = []
    for farm in farms:
        numbers = num_routes or best_known.num_routes_of(farm.set_name, farm.index, farm.digest)
        if not numbers:
            where = f"farm {farm.index} of {farm.set_name}"
            message = "nothing says how many routes are allowed"
            faults.append(Fault(where, message, "give --routes, or a --best-known file that lists this farm"))
        found += [Task(farm, number) for number in numbers]
    if faults:
        raise InvalidInput(faults)
    return found


def _in_file(path: Path, fault: Fault) -> Fault:
    return fault if fault.path.startswith(str(path)) else Fault(f"{path}: {fault.path}", fault.message, fault.action)
