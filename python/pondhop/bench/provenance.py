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
    """Return 12 hexadecimal digits that change with the code that plans.

    That is the native core and the planners of this package; for a planner of your own also the file that it lies in.
    """
    files = [_core.__file__, planners.__file__]
    if callable(planner):
        code = planner if inspect.isroutine(planner) else type(planner)
        source = inspect.getsourcefile(code)
        files += [source] if source is not None and Path(source).exists() else []
    return _digest(*files)


@cache
def _digest(*files: str) -> str:
    return hashlib.sha256(b"".join(Path(file).read_bytes() for file in files)).hexdigest()[:12]


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
