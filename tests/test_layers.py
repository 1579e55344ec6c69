"""The rules about what may use what, checked on the sources themselves (import-linter checks the Python layers)."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
CORE = ROOT / "crates" / "core" / "src"


def listed_modules(path: Path) -> list[str]:
    """Names in the reading order at the top of a file."""
    return re.findall(r"^//! +\d+\. \[?`(\w+)`", path.read_text(), flags=re.MULTILINE)


def declared_modules(path: Path) -> list[str]:
    """Names of the modules that a file declares, but for those of tests."""
    source = re.sub(r"#\[cfg\(test\)\]\s*mod \w+;", "", path.read_text())
    return re.findall(r"^(?:pub )?mod (\w+);", source, flags=re.MULTILINE)


READING_ORDER = listed_modules(CORE / "lib.rs")
SEARCH = CORE / "search"
PLAIN = SEARCH / "plain"
TIMED = SEARCH / "timed"
ROUNDS = CORE / "rounds"


def sources_of(module: str) -> list[Path]:
    return [CORE / f"{module}.rs"] if (CORE / f"{module}.rs").exists() else sorted((CORE / module).rglob("*.rs"))


def used_modules(source: str, parent: str = "crate") -> set[str]:
    """Names after `crate::`, or after the path of another parent, in the part of a file that is no test."""
    code, _, _ = source.partition("#[cfg(test)]")
    code = re.sub(r"//.*", "", code)
    named = set(re.findall(rf"\b{parent}::(\w+)", code))
    for group in re.findall(rf"\b{parent}::\{{(.*?)\}};", code, flags=re.DOTALL):
        while "{" in group:
            group = re.sub(r"\{[^{}]*\}", "", group)
        named.update(re.findall(r"(?:^|,)\s*(\w+)", group))
    return named


def test_the_parser_sees_every_form_of_use() -> None:
    source = (
        "use crate::plan::Plan;\nuse crate::{error::{Fault, X}, travel};\nlet x = crate::problem::f(); // crate::hpp\n"
    )
    assert used_modules(source) == {"plan", "error", "travel", "problem"}
    source = "use super::state::{A, State};\nuse super::{moves, order::{a, b}};\n// super::run\n#[cfg(test)] super::x"
    assert used_modules(source, "super") == {"state", "moves", "order"}


def test_every_core_module_has_a_place_in_the_reading_order() -> None:
    assert sorted(READING_ORDER) == sorted(declared_modules(CORE / "lib.rs"))


@pytest.mark.parametrize("folder", [SEARCH, PLAIN, TIMED, ROUNDS], ids=lambda folder: folder.name)
def test_every_module_of_the_search_has_a_place_in_the_reading_order(folder: Path) -> None:
    assert sorted(listed_modules(folder / "mod.rs")) == sorted(declared_modules(folder / "mod.rs"))


@pytest.mark.parametrize(
    ("folder", "module"),
    [(folder, module) for folder in (PLAIN, TIMED) for module in listed_modules(folder / "mod.rs")],
)
def test_modules_of_an_engine_use_only_those_before_them(folder: Path, module: str) -> None:
    order = listed_modules(folder / "mod.rs")
    source = (folder / f"{module}.rs").read_text()
    upward = used_modules(source, "super") - set(order[: order.index(module)])
    assert not upward, f"{module}.rs uses {sorted(upward)}, which come after it in {folder.name}/mod.rs"
    shared = used_modules(source, "crate::search")
    assert shared <= {"options", "objective"}, f"{module}.rs goes through the door of the search: {sorted(shared)}"


@pytest.mark.parametrize("module", ["options", "objective"])
def test_what_engines_share_knows_no_engine(module: str) -> None:
    source = (SEARCH / f"{module}.rs").read_text()
    order = listed_modules(SEARCH / "mod.rs")
    assert used_modules(source, "super") | used_modules(source, "crate::search") <= set(order[: order.index(module)])


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


def test_modules_are_reachable_without_an_import_of_their_own() -> None:
    code = "import pondhop; pondhop._core.hpp_clusters, pondhop.errors.Fault, pondhop.plot.plot_plan"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_planning_command_loads_no_drawing() -> None:
    modules = "pondhop.cli, pondhop.planners, pondhop.outputs, pondhop.cli.printed"
    code = f"import json, sys, {modules}; print(json.dumps(sorted(sys.modules)))"
    loaded = json.loads(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout)
    assert not {"matplotlib", "pyogrio"} & set(loaded)
    assert not [name for name in loaded if name.startswith(("pondhop.bench", "pondhop.report"))]
