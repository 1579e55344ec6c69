"""Fleet files: TOML whose keys are the settings of a fleet."""

from __future__ import annotations

import difflib
import tomllib
from dataclasses import fields
from pathlib import Path
from typing import Any

from pondhop.arguments import checked_path
from pondhop.errors import Fault, InvalidInput
from pondhop.fleet.model import Fleet, fleet_faults
from pondhop.fleet.settings import DECISIVE


def read_fleet(path: str | Path) -> Fleet:
    """Read a fleet from a TOML file whose keys are the fields of `Fleet`; only ``num_drones`` has no default.

    Raises
    ------
    InvalidInput
        With every fault of the file: unknown keys, missing and wrong values.
    """
    path = checked_path("path", path)
    try:
        settings = tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        action = "name a TOML file with a line num_drones = 3"
        raise InvalidInput([Fault(str(path), f"cannot be read: {error.strerror}", action)]) from error
    except UnicodeDecodeError as error:
        raise InvalidInput([Fault(str(path), "this is no text", "save the file as UTF-8 text")]) from error
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InvalidInput([Fault(str(path), f"this is no TOML: {error}", "write lines key = value")]) from error
    names = [item.name for item in fields(Fleet) if item.name != "assumptions"]
    faults = []
    for key in settings.keys() - set(names):
        close = difflib.get_close_matches(key, names, n=1)
        action = f"did you mean {close[0]}?" if close else f"use {', '.join(names)}"
        faults.append(Fault(key, "unknown setting", action))
    faults.sort(key=lambda fault: list(settings).index(fault.path))
    known = {key: value for key, value in settings.items() if key in names}
    if "num_drones" not in known:
        faults.append(Fault("num_drones", "the number of drones is missing", "add a line num_drones = 3"))
    faults.extend(fleet_faults(known))
    if faults:
        raise InvalidInput(faults)
    values: dict[str, Any] = dict(known)
    return Fleet(**values, assumptions=tuple(name for name in DECISIVE if name not in known))
