"""Values that nobody means: each is answered with a place and a remedy, none is called a bug."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from pondhop import instances

ROOT = Path(__file__).resolve().parents[1]
FARM = ROOT / "examples" / "delta_farm.geojson"
PONDHOP = str(Path(sys.executable).parent / "pondhop")


def run(*arguments: object, environment: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    command = [PONDHOP, *map(str, arguments)]
    return subprocess.run(command, check=False, capture_output=True, text=True, errors="replace", env=environment)


def assert_told(ran: subprocess.CompletedProcess[str], *codes: int) -> None:
    assert "this is a bug" not in ran.stderr, ran.stderr
    assert "Traceback" not in ran.stderr, ran.stderr
    assert ran.returncode in (codes or (2,)), (ran.returncode, ran.stderr)
    if ran.returncode == 2:
        assert ran.stderr.strip()


@pytest.fixture
def farms(tmp_path: Path) -> Path:
    path = tmp_path / "farms.json"
    instances.write_farms(path, instances.generate(5, 2, seed=5))
    return path


@pytest.mark.parametrize(
    "option",
    [
        ("--threads", "100000"),
        ("--threads", str(2**64)),
        ("--iterations", str(2**64)),
        ("--iterations", "9" * 400),
        ("--iterations", "9" * 5000),
        ("--seed", "9" * 400),
        ("--seed", "9" * 5000),
        ("--time-limit", "inf"),
        ("--time-limit", "nan"),
        ("--time-limit", "-1"),
        ("--time-limit", "1e999"),
        ("--slack", "nan"),
        ("--slack", "inf"),
        ("--planner", "\udcff"),
    ],
    ids=lambda option: f"{option[0]}={ascii(option[1])[:24]}",
)
@pytest.mark.parametrize("command", ["plan", "solve"])
def test_options_out_of_range_are_told(command: str, option: tuple[str, str], farms: Path, tmp_path: Path) -> None:
    if command == "plan":
        ran = run("plan", FARM, "--drones", 3, *option, "-o", tmp_path / "out")
    else:
        ran = run("solve", farms, "--routes", 3, *option, "-o", tmp_path / "plans.json")
    assert_told(ran)
    assert not (tmp_path / "out").exists()
    assert not list(tmp_path.glob("plans*"))


@pytest.mark.parametrize("routes", [str(2**64), "9" * 400, "1000000000"])
def test_more_routes_than_anybody_has(farms: Path, routes: str) -> None:
    assert_told(run("solve", farms, "--routes", routes, "--iterations", 10), 0, 2)


@pytest.mark.parametrize("drones", [str(2**64), "9" * 400, "10001"])
def test_more_drones_than_anybody_has(tmp_path: Path, drones: str) -> None:
    assert_told(run("plan", FARM, "--drones", drones, "-o", tmp_path / "out"))


PLANS = {
    "brackets": "[" * 100_000,
    "digits": "[" + "9" * 5000 + "]",
    "huge pond": f'[{{"routes": [[{2**70}]]}}]',
    "truth": '[{"routes": [[true]]}]',
    "not a list": "{}",
    "empty": "",
}


@pytest.mark.parametrize("text", PLANS.values(), ids=PLANS)
@pytest.mark.parametrize("command", ["evaluate", "plot", "solve"])
def test_plans_that_are_none(command: str, text: str, farms: Path, tmp_path: Path) -> None:
    plans = tmp_path / "plans.json"
    plans.write_text(text)
    commands: dict[str, tuple[object, ...]] = {
        "evaluate": ("evaluate", plans, "--farms", farms),
        "plot": ("plot", plans, "--farms", farms, "-o", tmp_path / "plan.svg"),
        "solve": ("solve", farms, "--routes", 2, "--start", plans),
    }
    assert_told(run(*commands[command]))


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp("plan")
    assert run("plan", FARM, "--drones", 3, "--no-figure", "--iterations", 500, "-o", folder).returncode == 0
    content: dict[str, Any] = json.loads((folder / "plan.json").read_text())
    return content


@pytest.mark.parametrize(
    ("change", "codes"),
    [
        (lambda plan: plan["routes"][0]["trips"][0]["stops"][0].update(pond=0.5), (2,)),
        (lambda plan: plan["farm"].update(no_fly=[[]]), (2,)),
        (lambda plan: plan["farm"].update(name="[/bold] $x^ \udcff"), (0, 2)),
        (lambda plan: plan["farm"]["ponds"][0].update(id="[red]"), (2,)),
        (lambda plan: plan.update(seed=-1), (2,)),
        (lambda plan: plan["farm"]["ponds"][0].update(service_s=1e308), (2,)),
        (lambda plan: plan["fleet"].update(speed_m_s=True), (2,)),
        (lambda plan: plan["summary"].update(is_feasible=1), (2,)),
        (lambda plan: plan["summary"].update(num_unserved=5), (2,)),
        (lambda plan: plan["routes"].pop(), (2,)),
        (lambda plan: plan.pop("violations"), (2,)),
    ],
)
@pytest.mark.parametrize("command", ["evaluate", "plot"])
def test_plan_files_changed_by_hand(
    command: str, change: Any, codes: tuple[int, ...], plan: dict[str, Any], tmp_path: Path
) -> None:
    content = json.loads(json.dumps(plan))
    change(content)
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(content))
    assert_told(run(command, path, *(("-o", tmp_path / "plan.png") if command == "plot" else ())), *codes)


def test_a_pond_written_as_a_decimal_is_a_pond(plan: dict[str, Any], tmp_path: Path) -> None:
    content = json.loads(json.dumps(plan))
    stop = content["routes"][0]["trips"][0]["stops"][0]
    stop["pond"] = float(stop["pond"])
    (tmp_path / "plan.json").write_text(json.dumps(content))
    assert_told(run("evaluate", tmp_path / "plan.json"), 0)


def test_an_ascii_terminal_is_enough(tmp_path: Path) -> None:
    environment = os.environ | {"LC_ALL": "C", "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    ran = run(
        "plan", FARM, "--drones", 3, "--no-figure", "--iterations", 500, "-o", tmp_path / "out", environment=environment
    )
    assert_told(ran, 0)
    assert "Drone" in ran.stdout


@pytest.mark.parametrize("command", ["plan", "solve", "plot", "generate", "generate-farm"])
def test_outputs_that_cannot_be_written_are_told(
    command: str, farms: Path, tmp_path: Path, plan: dict[str, Any]
) -> None:
    (tmp_path / "file").write_text("in the way")
    (tmp_path / "folder").mkdir()
    plan_path = tmp_path / "plan.json"
    plan_path.write_text(json.dumps(plan))
    commands: dict[str, tuple[object, ...]] = {
        "plan": ("plan", FARM, "--drones", 3, "--no-figure", "--iterations", 500),
        "solve": ("solve", farms, "--routes", 2, "--iterations", 10),
        "plot": ("plot", plan_path),
        "generate": ("generate", "--ponds", 5),
        "generate-farm": ("generate-farm", "--ponds", 5, "--at", "-90,33"),
    }
    below = tmp_path / "file" / ("plan.png" if command == "plot" else "out")
    assert_told(run(*commands[command], "-o", below))
    if command != "plan":
        assert_told(run(*commands[command], "-o", tmp_path / "folder"))
    assert (tmp_path / "file").read_text() == "in the way"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no full device")
@pytest.mark.parametrize(
    "arguments", [("generate", "--ponds", 5), ("evaluate", "tests/data/releases/plan-0.1.0.json"), ("--version",)]
)
def test_a_full_disk_behind_the_output_is_told(arguments: tuple[object, ...]) -> None:
    with Path("/dev/full").open("w") as full:
        ran = subprocess.run(
            [PONDHOP, *map(str, arguments)], check=False, stdout=full, stderr=subprocess.PIPE, text=True, cwd=ROOT
        )
    assert "this is a bug" not in ran.stderr
    assert ran.returncode != 0
