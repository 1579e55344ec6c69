"""The attention models: trained weights, which the core plans with, and their training.

Source: Kool, van Hoof and Welling, Attention, Learn to Solve Routing Problems!, ICLR 2019. Two models are here:

- ``am50``: the paper's AM50, trained on a capacitated problem for the least total length. Nothing limits its routes.
- ``am_minmax``: ours, trained for the shortest longest route; never more routes than drones.

`model` and `train` need PyTorch and are for training only.
"""

from __future__ import annotations

import json
import zipfile
import zlib
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from pondhop._core import AttentionModel, Problem
from pondhop.errors import Fault, InvalidInput

ModelName = Literal["am50", "am_minmax"]
Decoding = Literal["greedy", "symmetries", "sampling"]
"""See `pondhop.planners.Decoding`."""

NUM_SAMPLES = 128
"""Plans that ``sampling`` draws if nobody says how many."""

_SIZES = ("width", "num_heads", "num_layers", "feed_forward_width")
_REMEDY = "give a file that 'pondhop train-am' wrote"


def plan(
    problem: Problem,
    name: ModelName,
    *,
    decoding: Decoding = "greedy",
    num_samples: int | None = None,
    seed: int = 1,
) -> tuple[list[list[int]], float]:
    """Plan with a model of this package.

    Parameters
    ----------
    problem
        What is to be planned. A model looks at places only: no limit, service duration or speed changes its plan.
    name
        Which model.
    decoding
        See `Decoding`.
    num_samples
        Plans that ``sampling`` draws; `NUM_SAMPLES` if not given.
    seed
        Draws them. Other decodings always give the same plan.

    Returns
    -------
    tuple of list of list of int and float
        Pond indices per route in flying order, every pond once; and the seconds from coordinates to finished routes.
        The time to read the weights, once in a process, is not in them.
    """
    drawn = NUM_SAMPLES if num_samples is None else num_samples
    return load_model(name).plan(problem, decoding=decoding, num_samples=drawn, seed=seed)


@cache
def load_model(name: ModelName) -> AttentionModel:
    """Return a model of this package; its weights are read once in a process."""
    return read_model(Path(__file__).with_name(f"{name}.npz"))


def read_model(path: Path) -> AttentionModel:
    """Read a model: an .npz file with the weights by name, and as JSON under ``config`` the architecture.

    Raises
    ------
    InvalidInput
        With everything that is wrong with the file.
    OSError
        If it cannot be read.
    """
    try:
        arrays = _arrays(path)
    except (ValueError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise InvalidInput([Fault(str(path), f"this is no .npz file of arrays: {error}", _REMEDY)]) from error
    try:
        architecture = json.loads(str(arrays.pop("config", "")))["architecture"]
    except (json.JSONDecodeError, KeyError, TypeError) as error:
        message = "it has no 'config' that is JSON with an 'architecture'"
        raise InvalidInput([Fault(str(path), message, _REMEDY)]) from error
    faults = _architecture_faults(path, architecture)
    if faults:
        raise InvalidInput(faults)
    try:
        return AttentionModel(
            {name: _single(array) for name, array in arrays.items()},
            variant=architecture["variant"],
            **{name: architecture[name] for name in _SIZES},
        )
    except InvalidInput as error:
        faults = [Fault(f"{path}: {fault.path}", fault.message, fault.action) for fault in error.faults]
        raise InvalidInput(faults) from error


def _arrays(path: Path) -> dict[str, NDArray[Any]]:
    with path.open("rb") as file:
        archive = np.load(file, allow_pickle=False)
        if not isinstance(archive, np.lib.npyio.NpzFile):
            raise ValueError("it holds a single array")
        return {name: archive[name] for name in archive.files}


def _single(array: NDArray[Any]) -> NDArray[Any]:
    """Return an array in single precision; one that holds no such numbers as it is, for the model to name it."""
    return array.astype(np.float32) if np.issubdtype(array.dtype, np.floating) else array


def _architecture_faults(path: Path, architecture: object) -> list[Fault]:
    if not isinstance(architecture, dict):
        return [Fault(f"{path}: config.architecture", "an object was expected", _REMEDY)]
    faults = []
    variants = get_args(Literal["cvrp", "minmax"])
    variant = architecture.get("variant")
    if variant not in variants:
        message = f"variant is {json.dumps(variant)}, none of {', '.join(variants)}"
        faults.append(Fault(f"{path}: config.architecture", message, _REMEDY))
    for name in _SIZES:
        value = architecture.get(name)
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            message = f"{name} is {json.dumps(value)}, no whole number above 0"
            faults.append(Fault(f"{path}: config.architecture", message, _REMEDY))
    return faults
