"""Which code ran, and on which machine."""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
from functools import cache
from pathlib import Path

from pondhop import _core, planners

_REPOSITORY = Path(__file__).resolve().parents[3]


@cache
def build_digest() -> str:
    """Return 12 hexadecimal digits that change with the code that plans: the native core and the planners."""
    files = (_core.__file__, planners.__file__)
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
