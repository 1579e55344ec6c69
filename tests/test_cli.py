"""The command line: contracts, exit codes, and how bad input and bugs are answered."""

import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest

from hand_made import make_farm, make_plan, square, two_drones
from pondhop import Separation, cli, instances, planners, plot
from pondhop.cli import shared
from pondhop.cli.printed import print_farm_plan
from pondhop.cli.shared import EXIT_BUG, EXIT_INFEASIBLE, EXIT_INVALID_INPUT
from pondhop.documents.signals import SIGNALLED, STOPPING_SIGNALS
from pondhop.files.plan_json import write_plan_json
from pondhop.fleet import Fleet
from pondhop.solution import FarmPlan

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROOT = Path(__file__).resolve().parent.parent
FARM = ROOT / "examples" / "delta_farm.geojson"
PONDHOP = str(Path(sys.executable).parent / "pondhop")


class Ran(NamedTuple):
    code: int
    out: str
    err: str


Run = Callable[..., Ran]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Run:
    """Run a command line in this process."""

    def run_command(*arguments: object) -> Ran:
        monkeypatch.setattr(sys, "argv", ["pondhop", *map(str, arguments)])
        with pytest.raises(SystemExit) as exited:
            cli.main()
        captured = capfd.readouterr()
        code = exited.value.code
        assert isinstance(code, int)
        return Ran(code, captured.out, captured.err)

    return run_command


@pytest.fixture
def farms(tmp_path: Path) -> Path:
    path = tmp_path / "farms.json"
    instances.write_farms(path, instances.generate(30, 3, seed=5))
    return path


def faults(ran: Ran) -> list[dict[str, str]]:
    assert ran.code == 2
    document = json.loads(ran.err)
    assert document["status"] == "invalid_input"
    return list(document["faults"])


def test_solve_writes_one_object_a_farm(run: Run, farms: Path, tmp_path: Path) -> None:
    plans = tmp_path / "new" / "plans.json"
    command = ("solve", farms, "--routes", 4, "--planner", "hpp", "--time-limit", 1, "--seed", 2, "--threads", 1)
    assert run(*command, "-o", plans).code == 0
    records = json.loads(plans.read_text())
    assert [record["index"] for record in records] == [0, 1, 2]
    for record in records:
        keys = "index planner seed elapsed_s routes route_lengths max_route_length total_length lower_bound"
        assert list(record) == keys.split()
        assert (record["planner"], record["seed"]) == ("hpp", 2)
        assert 0.0 < record["elapsed_s"] < 60.0
        assert sorted(pond for route in record["routes"] for pond in route) == list(range(30))
        assert 1 <= len(record["routes"]) <= 4
        assert record["max_route_length"] == max(record["route_lengths"])
        assert record["total_length"] == pytest.approx(sum(record["route_lengths"]))
        assert 0.0 < record["lower_bound"] <= record["max_route_length"]


def test_solve_without_output_prints_the_same_json(run: Run, farms: Path, tmp_path: Path) -> None:
    def plans(text: str) -> list[dict[str, Any]]:
        return [record | {"elapsed_s": None} for record in json.loads(text)]

    printed = run("solve", farms, "--routes", 4, "--iterations", 300)
    written = run("solve", farms, "--routes", 4, "--iterations", 300, "--json", "-o", tmp_path / "plans.json")
    assert printed.code == written.code == 0
    assert printed.err == written.err == ""
    assert plans(printed.out) == plans(written.out) == plans((tmp_path / "plans.json").read_text())


def test_solve_passes_on_how_a_network_decodes(run: Run, farms: Path) -> None:
    def total(*options: object) -> float:
        ran = run("solve", farms, "--routes", 4, "--planner", "am", *options)
        assert ran.code == 0
        return sum(float(solution["total_length"]) for solution in json.loads(ran.out))

    assert total("--decoding", "symmetries") < total()
    drawn = total("--decoding", "sampling", "--iterations", 2, "--seed", 3)
    assert drawn == total("--decoding", "sampling", "--iterations", 2, "--seed", 3)
    assert drawn != total("--decoding", "sampling", "--iterations", 2, "--seed", 4)


def test_solve_reads_tsplib(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "four.tsp"
    path.write_text(
        "NAME: four\nTYPE: TSP\nDIMENSION: 4\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n"
        "1 0 0\n2 0 3\n3 4 3\n4 4 0\nEOF\n"
    )
    ran = run("solve", path, "--routes", 1)
    assert ran.code == 0
    assert json.loads(ran.out)[0]["total_length"] >= 14.0


def test_evaluate_judges_any_plans(run: Run, tmp_path: Path) -> None:
    farm = {"depot": [0, 0], "ponds": [[3, 4], [0, 5], [6, 8]]}
    (tmp_path / "farms.json").write_text(json.dumps([farm, farm]))
    (tmp_path / "plans.json").write_text(json.dumps([{"routes": [[0, 2], [1]]}, {"routes": [[0]]}]))
    command = ("evaluate", tmp_path / "plans.json", "--farms", tmp_path / "farms.json", "--routes", 2)
    first, second = json.loads(run(*command, "--json").out)
    assert (first["max_route_length"], first["total_length"], first["is_feasible"]) == (20.0, 30.0, True)
    assert first["gap_percent"] == pytest.approx(100.0 * (20.0 / first["lower_bound"] - 1.0))
    assert first["lower_bound"] >= 20.0 - 1e-9
    assert not second["is_feasible"]
    assert len(second["violations"]) == 2
    assert run(*command).code == 0
    assert run(*command, "--require-feasible").code == 3
    assert "Violation in farm 1" in run(*command).out


@pytest.mark.parametrize(
    ("plans", "path"),
    [
        ("not json", "plans.json"),
        ("{}", "plans.json"),
        ('[{"routes": [[0]]}]', "--farms"),
        ('[{"routes": [[0]]}, {"routes": [[-1]]}, {"routes": [0]}]', "plans.json[1].routes"),
        ('[{"routes": [[0]]}, {"routes": [["0"]]}, 7]', "plans.json[1].routes"),
        ('[{"routes": [[0]]}, {"routes": [[30]]}, {"routes": [[0]]}]', "routes"),
    ],
)
def test_broken_plans_are_answered_with_their_place(
    run: Run, farms: Path, tmp_path: Path, plans: str, path: str
) -> None:
    (tmp_path / "plans.json").write_text(plans)
    found = faults(run("evaluate", tmp_path / "plans.json", "--farms", farms, "--json"))
    assert path in found[0]["path"]


def test_plan_writes_everything_a_crew_needs(run: Run, tmp_path: Path) -> None:
    ran = run("plan", FARM, "--drones", 3, "--no-figure", "-o", tmp_path / "out")
    assert ran.code == 0
    assert ran.err == ""
    assert "Assumed, not measured" in ran.out
    assert "No plan is done with its longest route in less than" in ran.out
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert written == {"plan.json", "plan.geojson", "missions"}
    missions = {path.name for path in (tmp_path / "out" / "missions").iterdir()}
    kinds = (".plan", ".waypoints", ".param", ".params", "-4.7.param", "-4.7.params")
    drones = {f"drone-{drone}{kind}" for drone in (1, 2, 3) for kind in kinds}
    assert missions == drones | {"README.txt"}


@pytest.mark.parametrize(
    ("num_crossings", "on_ways", "words"),
    [
        (1, 1, "cross 1 time; 1 more crossing is on their ways out and home"),
        (2, 0, "cross 2 times; 0 more crossings are on their ways out and home"),
    ],
)
def test_crossings_are_told_as_a_person_would(
    capsys: pytest.CaptureFixture[str], num_crossings: int, on_ways: int, words: str
) -> None:
    farm_plan = two_drones()
    separation = Separation(0.25, num_crossings, on_ways)
    print_farm_plan(replace(farm_plan, solution=replace(farm_plan.solution, separation=separation)))
    assert words in " ".join(capsys.readouterr().out.split())


def test_plan_as_json_is_the_plan_file(run: Run, tmp_path: Path) -> None:
    ran = run("plan", FARM, "--drones", 3, "--no-figure", "--json", "-o", tmp_path)
    assert ran.code == 0
    assert ran.out == (tmp_path / "plan.json").read_text()


def test_a_written_plan_can_be_judged_and_drawn(run: Run, tmp_path: Path) -> None:
    assert run("plan", FARM, "--drones", 3, "--no-figure", "-o", tmp_path).code == 0
    assert run("evaluate", tmp_path / "plan.json", "--require-feasible").code == 0
    drawn = run("plot", tmp_path / "plan.json", "-o", tmp_path / "figure.svg", "--json")
    assert drawn.code == 0
    assert Path(json.loads(drawn.out)["figure"]).stat().st_size > 1000


def test_a_plan_is_judged_and_drawn_in_feet_and_miles(run: Run, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install matplotlib")
    farm_plan = make_plan(make_farm(), Fleet(num_drones=1, max_route_length_m=300.0), [[0, 1, 2, 3, 4]])
    write_plan_json(tmp_path / "plan.json", farm_plan)
    judged = run("evaluate", tmp_path / "plan.json", "--units", "us")
    assert "max_route_length_m is 984 ft" in " ".join(judged.out.split())
    assert run("plot", tmp_path / "plan.json", "--units", "us", "-o", tmp_path / "plan.svg").code == 0


def test_a_drawing_says_what_the_file_does_not(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install matplotlib")
    farm = make_farm(no_fly=((square(-89.0015, 37.001, 0.0002),),))
    write_plan_json(tmp_path / "plan.json", make_plan(farm, Fleet(num_drones=1), [[0, 1, 2, 3, 4]]))
    drawn: list[FarmPlan] = []

    def plot_plan(farm_plan: FarmPlan, **options: Any) -> "Axes":
        drawn.append(farm_plan)
        return draw(farm_plan, **options)

    draw = plot.plot_plan
    monkeypatch.setattr(plot, "plot_plan", plot_plan)
    assert run("plot", tmp_path / "plan.json", "-o", tmp_path / "figure.svg").code == 0
    assert [violation.kind for violation in drawn[0].violations] == ["crosses_no_fly"]


def test_research_plans_can_be_drawn(run: Run, farms: Path, tmp_path: Path) -> None:
    plans = tmp_path / "plans.json"
    assert run("solve", farms, "--routes", 3, "-o", plans).code == 0
    assert run("plot", plans, "--farms", farms, "--index", 2, "-o", tmp_path / "figure.png").code == 0
    assert (tmp_path / "figure.png").exists()
    assert faults(run("plot", plans, "--farms", farms, "--index", 3, "-o", tmp_path / "figure.png", "--json"))
    assert faults(run("plot", plans, "--farms", farms, "-o", tmp_path / "figure.bmp", "--json"))


def test_an_infeasible_plan_is_a_result(run: Run, tmp_path: Path) -> None:
    fleet = tmp_path / "fleet.toml"
    fleet.write_text("num_drones = 3\nmax_route_duration_s = 60.0\n")
    command = ("plan", FARM, "--fleet", fleet, "--no-figure", "-o", tmp_path / "out")
    ran = run(*command)
    assert ran.code == 3
    # Told once, with the remedy.
    assert "Violation" not in ran.out
    assert ran.err.startswith("No mission was written, because this plan cannot be flown\n  1. ")
    assert run(*command, "--require-feasible").code == 3
    judged = run("evaluate", tmp_path / "out" / "plan.json")
    assert judged.code == 0
    assert "Violation: drone 1 is under way for" in " ".join(judged.out.split())
    with_json = run(*command, "--json")
    plan = json.loads(with_json.out)
    assert not plan["summary"]["is_feasible"]
    assert {violation["kind"] for violation in plan["violations"]} == {"too_slow", "out_of_reach"}
    assert all(violation["message"] and violation["remedy"] for violation in plan["violations"])
    assert json.loads(with_json.err)["status"] == "no_missions"


def test_nothing_of_an_earlier_plan_stays_to_be_flown(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert run("plan", FARM, "--drones", 3, "-o", out).code == 0
    assert len(list(out.glob("missions/*.plan"))) == 3
    assert (out / "plan.png").exists()
    fleet = tmp_path / "fleet.toml"
    fleet.write_text("num_drones = 3\nmax_route_duration_s = 60.0\n")
    assert run("plan", FARM, "--fleet", fleet, "--no-figure", "-o", out).code == 3
    left = {path.suffix for path in out.rglob("*") if path.is_file()}
    assert left == {".json", ".geojson"}


def test_farms_are_written_into_folders_that_are_missing(run: Run, tmp_path: Path) -> None:
    for command, name, words in (
        (("generate", "--ponds", 20), "farms.json", "1 farm of 20 ponds"),
        (("generate-farm", "--ponds", 1, "--at", "-90.9,33.4"), "farm.geojson", "1 pond"),
    ):
        path = tmp_path / command[0] / "deep" / name
        assert run(*command, "-o", path).out == f"Written to {path}: {words}\n"
        assert path.exists()


def test_generate_is_seeded(run: Run, tmp_path: Path) -> None:
    printed = run("generate", "--ponds", 20, "--farms", 2, "--seed", 3)
    assert run("generate", "--ponds", 20, "--farms", 2, "--seed", 3, "-o", tmp_path / "farms.json").code == 0
    assert printed.out == (tmp_path / "farms.json").read_text()
    assert printed.out != run("generate", "--ponds", 20, "--farms", 2, "--seed", 4).out


def test_generate_farm_makes_a_farm_that_can_be_planned(run: Run, tmp_path: Path) -> None:
    farm = tmp_path / "new" / "farm.geojson"
    ran = run("generate-farm", "--ponds", 25, "--at", "-90.9,33.4", "--missing-share", 0.1, "--irregular", "-o", farm)
    assert ran.code == 0
    assert run("plan", farm, "--drones", 2, "--no-figure", "-o", tmp_path / "out").code == 0


@pytest.mark.parametrize(
    ("arguments", "path", "action"),
    [
        (["plan", FARM, "-o", "out", "--json"], "--drones", "--fleet"),
        (["plan", FARM, "--drones", 2, "--fleet", FARM, "-o", "out", "--json"], "--drones, --fleet", "one of them"),
        (["plan", FARM, "--drones", 2, "--depot", "33.4,-97.0", "-o", "out", "--json"], "--depot", "-97.0,33.4"),
        (["plan", FARM, "--drones", 2, "--depot", "here", "-o", "out", "--json"], "--depot", "longitude first"),
        (["plan", FARM, "--drones", 2, "--planner", "hp", "-o", "out", "--json"], "planner", "'hpp'"),
        (["generate-farm", "--ponds", 9, "--at", "1,nan", "-o", "farm.geojson", "--json"], "--at", "degrees"),
    ],
)
def test_bad_options_name_the_remedy(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[object], path: str, action: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (fault,) = faults(run(*arguments))
    assert fault["path"] == path
    assert action in fault["action"]
    assert list(tmp_path.iterdir()) == []


def test_an_empty_argument_is_no_path(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # As of a variable of the shell that is not set: files would land in the current folder.
    monkeypatch.chdir(tmp_path)
    ran = run("plan", FARM, "--drones", 2, "-o", "")
    assert ran.code == EXIT_INVALID_INPUT
    assert "after -o: there is an empty argument" in ran.err
    assert list(tmp_path.iterdir()) == []


def test_faults_for_people_are_a_numbered_list(run: Run, tmp_path: Path) -> None:
    broken = tmp_path / "farms.json"
    broken.write_text('[{"depot": [0, "x"], "ponds": []}]')
    ran = run("solve", broken, "--routes", 2)
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.startswith("pondhop: 2 problems in the input\n  1. [0].depot")
    assert "  2. [0].ponds" in ran.err
    assert "Traceback" not in ran.err


@pytest.mark.parametrize(
    "arguments", [["nonsense"], ["solve", "absent.json", "--routes", "5"], ["generate", "--ponds", "0"]]
)
def test_wrong_usage_exits_with_2(run: Run, arguments: list[str]) -> None:
    ran = run(*arguments)
    assert (ran.code, ran.out) == (2, "")
    assert "Traceback" not in ran.err


def test_an_output_that_cannot_be_written_is_no_bug(run: Run, farms: Path) -> None:
    (fault,) = faults(run("solve", farms, "--routes", 2, "--json", "-o", farms / "plans.json"))
    assert str(farms) in fault["path"]


def test_a_bug_asks_for_a_report(run: Run, farms: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken_solve(*_: object, **__: object) -> None:
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(planners, "solve", broken_solve)
    ran = run("solve", farms, "--routes", 2)
    assert (ran.code, ran.out) == (1, "")
    assert "ZeroDivisionError: by zero" in ran.err
    assert f"pondhop --debug solve {farms} --routes 2" in ran.err
    assert "Traceback" not in ran.err
    monkeypatch.setattr(sys, "argv", ["pondhop", "--debug", "solve", str(farms), "--routes", "2"])
    with pytest.raises(ZeroDivisionError):
        cli.main()


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_bar_shows_up_on_a_terminal_when_something_takes_long(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(shared, "SECONDS_BEFORE_PROGRESS", 0.0)
    with shared.progress("Planning", total=2) as advance:
        advance()
        while "Planning" not in terminal.getvalue():
            time.sleep(0.01)
    assert "50%" in terminal.getvalue()


def test_no_bar_shows_up_where_nothing_takes_long(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with shared.progress("Planning", total=1) as advance:
        advance()
    assert terminal.getvalue() == ""


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_ctrl_c_ends_without_a_traceback(tmp_path: Path) -> None:
    pipe = tmp_path / "farms.json"
    os.mkfifo(pipe)
    command = [PONDHOP, "solve", str(pipe), "--routes", "2"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    # Opening for writing returns once the command has opened the other end and waits for farms.
    with pipe.open("w"):
        process.send_signal(signal.SIGINT)
        _, err = process.communicate()
    assert process.returncode == 130
    assert "Traceback" not in err


STOPPING = [(signal.SIGINT, 130, "with Ctrl-C"), (signal.SIGTERM, 143, "by SIGTERM")]
if sys.platform != "win32":
    STOPPING.append((signal.SIGHUP, 129, "by SIGHUP"))

SIGNAL_AT_AN_IMPORT = """
import os, sys

module, number = sys.argv[1], int(sys.argv[2])
del sys.argv[1:3]

class SignalAt:
    def find_spec(self, name, path=None, target=None):
        if name == module:
            os.kill(os.getpid(), number)

sys.meta_path.insert(0, SignalAt())
from pondhop.__main__ import main

main()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
@pytest.mark.parametrize("module", ["pondhop.cli", "typer", "numpy", "pondhop._core", "shapely", "pondhop.outputs"])
@pytest.mark.parametrize(("number", "code", "how"), STOPPING)
def test_a_signal_while_modules_are_imported_is_told_in_a_line(
    module: str, number: int, code: int, how: str, tmp_path: Path
) -> None:
    plan = ["plan", str(FARM), "--drones", "3", "-o", str(tmp_path / "out")]
    command = [sys.executable, "-c", SIGNAL_AT_AN_IMPORT, module, str(int(number)), *plan]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stdout, ran.stderr) == (code, "", f"pondhop: stopped {how}\n")
    assert not (tmp_path / "out").exists()


def test_python_runs_the_package_as_a_command() -> None:
    ran = subprocess.run([sys.executable, "-m", "pondhop", "--version"], capture_output=True, text=True, check=True)
    assert ran.stdout.startswith("pondhop ")


@pytest.mark.skipif(not hasattr(signal, "SIGPIPE"), reason="needs SIGPIPE")
def test_a_reader_that_leaves_early_is_no_fault() -> None:
    command = f"'{PONDHOP}' generate --ponds 300 --farms 50 | head -c 1"
    ran = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert (ran.stdout, ran.stderr) == ("[", "")


def test_the_reference_is_what_help_says() -> None:
    command = [sys.executable, "-m", "typer", "pondhop.cli", "utils", "docs", "--name", "pondhop"]
    title = ["--title", "pondhop: the command line"]
    generated = subprocess.run([*command, *title], capture_output=True, text=True, check=True).stdout
    page = (ROOT / "docs" / "reference" / "cli.md").read_text()
    assert page.strip() == generated.strip(), "run: make docs"


def test_the_reference_names_every_exit_code() -> None:
    told = (ROOT / "docs" / "reference" / "cli.md").read_text().partition("Exit codes:")[2].partition("\n\n")[0]
    codes = [0, EXIT_BUG, EXIT_INVALID_INPUT, EXIT_INFEASIBLE, *(SIGNALLED + number for number in STOPPING_SIGNALS)]
    assert sorted(map(int, re.findall(r"\d+", told))) == sorted(codes)


def test_help_names_every_planner(run: Run) -> None:
    help_text = run("solve", "--help").out
    assert all(name in help_text for name in planners.PLANNERS)


@pytest.mark.parametrize("command", ["plot", "evaluate"])
def test_plans_of_research_farms_need_their_farms(run: Run, farms: Path, tmp_path: Path, command: str) -> None:
    plans = tmp_path / "plans.json"
    run("solve", farms, "--routes", 2, "-o", plans)
    ran = run(command, plans, *(["-o", tmp_path / "plan.png"] if command == "plot" else []))
    assert ran.code == 2
    assert "pass --farms with the file of farms" in ran.err
    assert len(ran.err) < 400
