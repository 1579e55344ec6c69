"""The rules about what may use what, checked on the sources themselves (import-linter checks the Python layers)."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
CORE = ROOT / "crates" / "core" / "src"
READING_ORDER = re.findall(r"^//! +\d+\. \[`(\w+)`\]", (CORE / "lib.rs").read_text(), flags=re.MULTILINE)


def sources_of(module: str) -> list[Path]:
    return [CORE / f"{module}.rs"] if (CORE / f"{module}.rs").exists() else sorted((CORE / module).rglob("*.rs"))


def used_modules(source: str) -> set[str]:
    """Names after `crate::` in the part of a file that is no test."""
    code, _, _ = source.partition("#[cfg(test)]")
    code = re.sub(r"//.*", "", code)
    named = set(re.findall(r"\bcrate::(\w+)", code))
    for group in re.findall(r"\bcrate::\{(.*?)\};", code, flags=re.DOTALL):
        while "{" in group:
            group = re.sub(r"\{[^{}]*\}", "", group)
        named.update(re.findall(r"(?:^|,)\s*(\w+)", group))
    return named


def test_the_parser_sees_every_form_of_use() -> None:
    source = (
        "use crate::plan::Plan;\nuse crate::{error::{Fault, X}, travel};\nlet x = crate::problem::f(); // crate::hpp\n"
    )
    assert used_modules(source) == {"plan", "error", "travel", "problem"}


def test_every_core_module_has_a_place_in_the_reading_order() -> None:
    declared = re.findall(r"^(?:pub )?mod (\w+);", (CORE / "lib.rs").read_text(), flags=re.MULTILINE)
    assert sorted(READING_ORDER) == sorted(declared)


@pytest.mark.parametrize("module", READING_ORDER)
def test_core_modules_use_only_those_before_them(module: str) -> None:
    before = READING_ORDER[: READING_ORDER.index(module)]
    for path in sources_of(module):
        upward = used_modules(path.read_text()) - set(before) - {module}
        assert not upward, f"{path.relative_to(ROOT)} uses {sorted(upward)}, which come after {module} in lib.rs"


@pytest.mark.parametrize("module", ["pondhop", "pondhop.cli"])
def test_imports_stay_light(module: str) -> None:
    code = f"import json, sys, {module}; print(json.dumps(sorted(sys.modules)))"
    loaded = json.loads(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout)
    assert module in loaded
    assert not {"matplotlib", "pyogrio", "shapely", "pyproj", "torch", "ortools"} & set(loaded)


def test_the_planning_command_loads_no_drawing() -> None:
    modules = "pondhop.cli, pondhop.planners, pondhop.outputs, pondhop.cli.printed"
    code = f"import json, sys, {modules}; print(json.dumps(sorted(sys.modules)))"
    loaded = json.loads(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout)
    assert not {"matplotlib", "pyogrio"} & set(loaded)
    assert not [name for name in loaded if name.startswith(("pondhop.bench", "pondhop.report"))]
