"""Research instances: the paper's data set and TSPLIB files. Unitless planar coordinates."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from pondhop import _core
from pondhop.arguments import Arguments, checked_path, shortened
from pondhop.documents.atomic import write_all
from pondhop.errors import Fault, InvalidInput

Variant = Literal["authors", "paper"]

MAX_COORDINATE = 1e9
"""Largest coordinate that the core accepts."""


@dataclass(frozen=True, eq=False)
class ResearchFarm:
    """A farm of the plane, without units.

    Attributes
    ----------
    depot
        Where every route starts and ends, shape (2,).
    ponds
        Positions of the ponds, shape (n, 2), n >= 1.
    boundary
        Closed outline for figures, shape (k, 2), or ``None`` if there is none.
    spacing
        Pitch of the grid that the ponds lie on, or ``None`` if there is none.
    """

    depot: NDArray[np.float64]
    ponds: NDArray[np.float64]
    boundary: NDArray[np.float64] | None = None
    spacing: float | None = None

    def __post_init__(self) -> None:
        arguments = Arguments()
        arguments.array("depot", self.depot, "give its two coordinates as an array of shape (2,)")
        arguments.array("ponds", self.ponds, "give positions as an array of shape (n, 2)")
        if self.boundary is not None:
            arguments.array("boundary", self.boundary, "give corners as an array of shape (k, 2), or leave it out")
        if self.spacing is not None:
            arguments.real("spacing", self.spacing, 0.0, math.inf, "give a positive number, or leave it out")
        arguments.check()

    def to_problem(self, num_routes: int) -> _core.Problem:
        """Return the task of visiting every pond with at most `num_routes` routes.

        Raises
        ------
        InvalidInput
            If `num_routes` is 0 or a coordinate cannot be planned with.
        """
        return _core.Problem(self.depot, self.ponds, num_routes)


def generate(num_ponds: int, num_farms: int = 1, *, seed: int = 1, variant: Variant = "authors") -> list[ResearchFarm]:
    """Draw random farms of the unit square as the paper's data set has them.

    Ponds lie on a grid inside a random outline, from which grid points are deleted at random; the depot is uniform in
    the bounding box of the outline. The same arguments give the same farms on every machine, farm i is the same in
    lists of every length, and lists of different seeds share no farm.

    Parameters
    ----------
    num_ponds
        Ponds of each farm, 1 to 10 million.
    num_farms
        How many farms, at least 1.
    seed
        0 to 2**32 - 1.
    variant
        ``"authors"``: the outline is the union of three random triangles and 36 % of the grid is deleted, as in the
        code and the instances of the paper's authors. ``"paper"``: the outline is convex and 20 % is deleted, as the
        text says.

    Raises
    ------
    InvalidInput
        With every argument that is out of range.

    References
    ----------
    Davis, Mukherjee, Wills, Ouyang. Path Planning Algorithms for Robotic Aquaculture Monitoring, section 3.
    """
    arguments = Arguments()
    arguments.whole("num_ponds", num_ponds, 1, 10_000_000, "ask for 1 to 10000000 ponds")
    arguments.whole("num_farms", num_farms, 1, 2**32, "ask for at least one farm")
    arguments.whole("seed", seed, 0, 2**32 - 1, "give a seed of 0 to 4294967295")
    arguments.one_of("variant", variant, get_args(Variant))
    arguments.check()
    return [ResearchFarm(*_core.generate(num_ponds, (int(seed) << 32) + index, variant)) for index in range(num_farms)]


def read(path: str | Path) -> list[ResearchFarm]:
    """Read research farms of either format: a TSPLIB file if the name ends in ``.tsp``, else JSON.

    Raises
    ------
    InvalidInput
        As `read_tsplib` and `read_farms`.
    """
    return [read_tsplib(path)] if checked_path("path", path).suffix.lower() == ".tsp" else read_farms(path)


def read_farms(path: str | Path) -> list[ResearchFarm]:
    """Read a JSON list of ``{"depot": [x, y], "ponds": [[x, y], ...], "boundary": [[x, y], ...], "spacing": s}``.

    Boundary and spacing are optional; other keys are ignored.

    Raises
    ------
    InvalidInput
        With every fault of the file, each with its place (``[3].ponds[17]``).
    """
    text = read_text(checked_path("path", path))
    try:
        farms = json.loads(text)
    except json.JSONDecodeError as error:
        place = f"{path}, line {error.lineno}, column {error.colno}"
        action = "give a JSON list of farms"
        if "DIMENSION" in text[:2000]:
            action = "TSPLIB is read if the name of the file ends in .tsp; files of vehicle routing are not"
        raise InvalidInput([Fault(place, f"this is not JSON: {error.msg}", action)]) from error
    except RecursionError as error:
        raise InvalidInput([Fault(str(path), "brackets are nested too deep", "give a JSON list of farms")]) from error
    except ValueError as error:
        message = "it holds a number of thousands of digits"
        raise InvalidInput([Fault(str(path), message, "give coordinates of at most 1e9")]) from error
    if not isinstance(farms, list) or not farms:
        message = "the list of farms is empty" if farms == [] else "this is not a list of farms"
        raise InvalidInput([Fault(str(path), message, 'give a JSON list of {"depot": [x, y], "ponds": [[x, y], ...]}')])
    checks = _FarmChecks()
    read = [checks.farm(f"[{index}]", farm) for index, farm in enumerate(farms)]
    if checks.faults:
        raise InvalidInput(checks.faults)
    return [farm for farm in read if farm is not None]


def write_farms(path: str | Path, farms: Iterable[ResearchFarm]) -> None:
    """Write farms as `read_farms` reads them; every coordinate comes back to the last bit.

    Raises
    ------
    InvalidInput
        With what is no name of a file and what is no research farm.
    OSError
        If the file cannot be written.
    """
    arguments, farms = Arguments(), list(farms) if isinstance(farms, (Iterator, Sequence)) else farms
    arguments.path("path", path)
    arguments.all_kind("farms", farms, ResearchFarm, "give research farms, as pondhop.generate returns them")
    arguments.check()
    write_all({Path(path): farms_json(farms)})


def farms_json(farms: Iterable[ResearchFarm]) -> str:
    """Return the JSON list that `read_farms` reads, a farm a line."""
    lines = []
    for farm in farms:
        values: dict[str, object] = {"depot": farm.depot.tolist(), "ponds": farm.ponds.tolist()}
        if farm.boundary is not None:
            values["boundary"] = farm.boundary.tolist()
        if farm.spacing is not None:
            values["spacing"] = farm.spacing
        lines.append(json.dumps(values, separators=(",", ":")))
    return "[\n" + ",\n".join(lines) + "\n]\n"


def read_tsplib(path: str | Path) -> ResearchFarm:
    """Read a TSPLIB file of planar nodes (``EDGE_WEIGHT_TYPE: EUC_2D``); node 1 becomes the depot.

    The literature on the min-max multiple travelling salesman problem uses these files with distances that are not
    rounded (He and Hao 2022), and so do we; TSPLIB itself rounds them.

    Returns
    -------
    ResearchFarm
        Pond i is node i + 2.

    Raises
    ------
    InvalidInput
        With every fault of the file, each with its line.

    References
    ----------
    Reinelt. TSPLIB 95, sections 1 and 2.
    """
    header, nodes, faults = _parse_tsplib(read_text(checked_path("path", path)))
    place, kind = header.get("TYPE", (str(path), "missing"))
    if kind != "TSP":
        faults.append(Fault(place, f"TYPE is {kind}", "give a file of TYPE: TSP"))
    place, weights = header.get("EDGE_WEIGHT_TYPE", (str(path), "missing"))
    if weights in _OTHER_WEIGHTS:
        # What else is wrong with the file follows from it.
        raise InvalidInput([Fault(place, f"EDGE_WEIGHT_TYPE is {weights}", _OTHER_WEIGHTS[weights])])
    if weights != "EUC_2D":
        faults.append(Fault(place, f"EDGE_WEIGHT_TYPE is {weights}", "give a file of EDGE_WEIGHT_TYPE: EUC_2D"))
    place, dimension = header.get("DIMENSION", (str(path), "missing"))
    if dimension != str(len(nodes)) and not faults:
        message = f"DIMENSION is {dimension}, but there are {len(nodes)} nodes"
        faults.append(Fault(place, message, "correct the number or add the missing nodes"))
    if len(nodes) < 2 and not faults:
        faults.append(Fault(str(path), f"there are {len(nodes)} nodes", "give a depot and at least one pond"))
    if not faults and sorted(nodes) != list(range(1, len(nodes) + 1)):
        missing = min(set(range(1, len(nodes) + 1)) - set(nodes))
        faults.append(Fault(str(path), f"node {missing} is missing", "number the nodes from 1 without gaps"))
    if faults:
        raise InvalidInput(faults)
    positions = np.array([nodes[number] for number in range(1, len(nodes) + 1)])
    return ResearchFarm(positions[0], positions[1:])


def read_text(path: Path) -> str:
    """Return what a text file holds.

    Raises
    ------
    InvalidInput
        If it cannot be read, or is no text.
    """
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        message = f"this file cannot be read: {error.strerror}"
        raise InvalidInput([Fault(str(path), message, "check the name and the permissions")]) from error
    except UnicodeDecodeError as error:
        raise InvalidInput([Fault(str(path), "this is not a text file", "give a file in UTF-8")]) from error


class _FarmChecks:
    """Reads farms out of JSON values and collects what is wrong with them in `faults`."""

    def __init__(self) -> None:
        self.faults: list[Fault] = []

    def farm(self, path: str, value: object) -> ResearchFarm | None:
        if not isinstance(value, dict):
            self._add(path, "this is not a farm", 'give {"depot": [x, y], "ponds": [[x, y], ...]}')
            return None
        depot = self._positions(f"{path}.depot", [value.get("depot")], are_one=True)
        ponds = self._positions(f"{path}.ponds", value.get("ponds"), minimum=1)
        boundary = None
        if value.get("boundary") is not None:
            boundary = self._positions(f"{path}.boundary", value["boundary"], minimum=3)
        spacing = value.get("spacing")
        if spacing is not None and not (_is_coordinate(spacing) and spacing > 0):
            self._add(
                f"{path}.spacing",
                f"the spacing is {shortened(json.dumps(spacing))}",
                "give a positive number or leave it out",
            )
            spacing = None
        if depot is None or ponds is None:
            return None
        return ResearchFarm(depot[0], ponds, boundary, spacing)

    def _positions(
        self, path: str, values: object, *, minimum: int = 1, are_one: bool = False
    ) -> NDArray[np.float64] | None:
        if not isinstance(values, list) or len(values) < minimum:
            message = f"there are {len(values)} positions" if isinstance(values, list) else "this is not a list"
            self._add(path, message, f"give a list [[x, y], ...] of {minimum} or more")
            return None
        num_faults = len(self.faults)
        for index, value in enumerate(values):
            if not (isinstance(value, Sequence) and len(value) == 2 and all(map(_is_coordinate, value))):
                place = path if are_one else f"{path}[{index}]"
                self._add(
                    place,
                    f"this is not a position: {shortened(json.dumps(value))}",
                    "give [x, y], two numbers of at most 1e9",
                )
        return np.array(values, dtype=np.float64) if len(self.faults) == num_faults else None

    def _add(self, path: str, message: str, action: str) -> None:
        self.faults.append(Fault(path, message, action))


def _is_coordinate(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= MAX_COORDINATE


_OTHER_WEIGHTS = {
    "ATT": "its distances are those of the plane over the root of 10, rounded up: write EUC_2D to plan its places",
    "CEIL_2D": "its distances are those of the plane, rounded up: write EUC_2D to plan its places",
    "EXPLICIT": "it has a matrix of distances in place of places, which no planner here takes: give a file of places",
    "GEO": "its places are degrees and minutes on the globe: give a file of planar places (EUC_2D)",
}
"""What to do about a TSPLIB file of another kind of distances."""

_Header = dict[str, tuple[str, str]]


def _parse_tsplib(text: str) -> tuple[_Header, dict[int, tuple[float, float]], list[Fault]]:
    """Return place and value of each keyword, the nodes by number, and the lines that are neither."""
    header: _Header = {}
    nodes: dict[int, tuple[float, float]] = {}
    faults: list[Fault] = []
    is_in_nodes = False
    for number, line in enumerate(text.splitlines(), start=1):
        place, words = f"line {number}", line.split()
        if not words:
            continue
        if words == ["EOF"]:
            break
        keyword, colon, value = line.partition(":")
        if colon:
            header[keyword.strip()] = (place, value.strip())
            is_in_nodes = False
        elif line.strip().endswith("_SECTION"):
            is_in_nodes = words == ["NODE_COORD_SECTION"]
            if not is_in_nodes:
                faults.append(Fault(place, f"{line.strip()} is not supported", "give a file of planar nodes only"))
        elif is_in_nodes:
            node = _parse_node(words)
            if node is None:
                faults.append(Fault(place, f"this is not a node: {line.strip()[:60]}", "give 'number x y'"))
            elif node[0] in nodes:
                faults.append(Fault(place, f"node {node[0]} appears twice", "number the nodes from 1 without gaps"))
            else:
                nodes[node[0]] = node[1]
        elif not faults:
            faults.append(Fault(place, f"this is not 'KEYWORD: value': {line.strip()[:60]}", "give a TSPLIB file"))
    return header, nodes, faults


def _parse_node(words: Sequence[str]) -> tuple[int, tuple[float, float]] | None:
    try:
        number, x, y = int(words[0]), float(words[1]), float(words[2])
    except (ValueError, IndexError):
        return None
    if len(words) != 3 or not (_is_coordinate(x) and _is_coordinate(y)):
        return None
    return number, (x, y)
