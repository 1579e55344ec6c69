"""Plan every file of a folder as `pondhop plan FILE --drones 2 -o out` does, and print what came of each.

The folder is ../shared/data/field unless another one is named; its README.md says what is right. Files whose line there
says `+depot` get the depot of that page, and those with a line of their own its options.

    python scripts/field_table.py [FOLDER]
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from pondhop.units import counted

AREAS = {"no_fly": "no-fly zone", "fences": "fence", "stations": "station"}

FIELD = Path(__file__).resolve().parents[2] / "shared" / "data" / "field"


def options_of(folder: Path) -> dict[str, list[str]]:
    """The options that the README of a folder gives for each of its files."""
    readme = folder / "README.md"
    text = readme.read_text(encoding="utf-8") if readme.is_file() else ""
    depot = re.search(r"`\+depot` adds `(--depot [^`]+)`", text)
    options: dict[str, list[str]] = {}
    for line in text.splitlines():
        match = re.match(r"\| (\S+\.\w+)(.*?)\|", line)
        if match:
            named = re.findall(r"`([^`]+)`", match[2])
            options[match[1]] = " ".join(named).split()
            if "+depot" in match[2] and depot:
                options[match[1]] += depot[1].split()
    return options


def outcome(path: Path, options: list[str]) -> tuple[int, str]:
    """The exit status of planning a file, and a line about its ponds and notes or its faults."""
    drones = [] if "--drones" in options else ["--drones", "2"]
    with tempfile.TemporaryDirectory() as folder:
        command = [
            sys.executable,
            "-c",
            "from pondhop.cli import main; main()",
            "plan",
            str(path),
            *drones,
            *options,
            "--no-figure",
            "-o",
            folder,
        ]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
        plan_file = Path(folder) / "plan.json"
        told: list[str] = []
        if plan_file.exists():
            farm = json.loads(plan_file.read_text(encoding="utf-8"))["farm"]
            ids = [pond["id"] for pond in farm["ponds"]]
            areas = ", ".join(counted(len(farm[key]), noun) for key, noun in AREAS.items() if farm.get(key))
            missions = counted(len(list((Path(folder) / "missions").glob("*.plan"))), "mission")
            names = f"{', '.join(ids[:3])}{', ...' if len(ids) > 3 else ''}"
            told.append(f"{counted(len(ids), 'pond')} ({names}), {missions}")
            told += [areas] if areas else []
            told += farm["notes"]
    lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    return done.returncode, " / ".join([*told, *lines])


def main() -> None:
    """Print the table."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FIELD
    options = options_of(folder)
    print("| file | exit | outcome |\n|---|---|---|")
    for path in sorted(folder.iterdir()):
        if path.suffix != ".md":
            status, told = outcome(path, options.get(path.name, []))
            print(f"| {path.name} | {status} | {told.replace('|', '/')} |", flush=True)


if __name__ == "__main__":
    main()
