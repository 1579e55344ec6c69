"""Which code ran, and on which machine."""

from __future__ import annotations

import hashlib
import inspect
import os
import platform
import subprocess
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from pondhop import _core, planners

if TYPE_CHECKING:
    from pondhop.planners import PlannerFunction

_REPOSITORY = Path(__file__).resolve().parents[3]


def build_digest(planner: str | PlannerFunction) -> str:
    """Return 12 hexadecimal digits that change with the code that plans: the core, planners, baselines and weights.

    For a planner of your own they also change with the file that it lies in.
    """
    if not callable(planner):
        return _digest(None)
    source = inspect.getsourcefile(planner if inspect.isroutine(planner) else type(planner))
    return _digest(source if source is not None and Path(source).exists() else None)


@cache
def _digest(own_file: str | None) -> str:
    baselines = (Path(planners.__file__).parent / "baselines").rglob("*")
    files = [Path(_core.__file__), Path(planners.__file__)]
    files += sorted(file for file in baselines if file.suffix in (".py", ".npz"))
    files += [Path(own_file)] if own_file is not None else []
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:12]


@cache
def commit() -> str:
    """Return the commit of the checkout that this package lies in, with ``-dirty`` if files differ from it.

    Empty where the package is installed apart from its repository, or git is not there to ask.
    """
    if not (_REPOSITORY / ".git").exists():
        return ""
    command = ["git", "-C", str(_REPOSITORY), "describe", "--always", "--dirty", "--exclude=*"]
    try:
        described = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return ""
    return described.stdout.strip() if described.returncode == 0 else ""


@cache
def machine() -> str:
    """Return processor, cores and system, as in ``Intel(R) Xeon(R) Processor, 2 cores, Linux x86_64``."""
    return f"{_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}"


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text(encoding="utf-8").splitlines() if cpuinfo.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown processor"
