"""A plan's folder changes as a whole, whatever goes wrong on the way."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import IO

import pytest

from hand_made import make_farm, make_plan, square, two_drones
from pondhop import cli, instances, outputs, planners
from pondhop.documents import atomic
from pondhop.documents.signals import signals_held_back
from pondhop.errors import InvalidInput
from pondhop.fleet import Fleet
from pondhop.solution import FarmPlan

PONDHOP = str(Path(sys.executable).parent / "pondhop")


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def one_drone() -> FarmPlan:
    return make_plan(make_farm(), Fleet(num_drones=1), [[0, 1, 2, 3, 4]])


def unflyable() -> FarmPlan:
    return make_plan(make_farm(no_fly=((square(-89.0015, 37.001, 0.0002),),)), Fleet(num_drones=1), [[0, 1, 2, 3, 4]])


def test_a_plan_takes_the_place_of_an_earlier_one(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install matplotlib")
    outputs.write_outputs(tmp_path / "fresh", one_drone(), has_figure=False)
    outputs.write_outputs(tmp_path / "used", two_drones(), has_figure=True)
    (tmp_path / "used" / "missions" / "notes.txt").write_text("the user's own")
    (tmp_path / "used" / "photo.png").write_text("the user's own")
    outputs.write_outputs(tmp_path / "used", one_drone(), has_figure=False)
    used = contents(tmp_path / "used")
    assert used.pop("photo.png") == used.pop("missions/notes.txt") == b"the user's own"
    assert used == contents(tmp_path / "fresh")


@pytest.mark.parametrize("farm_plan", [one_drone(), unflyable()], ids=["flyable", "unflyable"])
@pytest.mark.parametrize(
    "name", ["plan.json", "plan.geojson", "plan.png", "missions/README.txt", "missions/drone-7.param"]
)
def test_files_of_the_user_are_neither_replaced_nor_removed(tmp_path: Path, name: str, farm_plan: FarmPlan) -> None:
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("the user's own")
    with pytest.raises(InvalidInput, match="nothing says that it wrote the one that is there") as error:
        outputs.write_outputs(tmp_path, farm_plan, has_figure=False)
    assert [fault.path for fault in error.value.faults] == [str(tmp_path / name)]
    assert contents(tmp_path) == {name: b"the user's own"}


def test_a_plan_laid_out_by_another_program_is_still_ours(tmp_path: Path) -> None:
    outputs.write_outputs(tmp_path, two_drones(), has_figure=False)
    before = contents(tmp_path)
    plan = tmp_path / "plan.json"
    plan.write_text(json.dumps(json.loads(plan.read_text())))
    outputs.write_outputs(tmp_path, two_drones(), has_figure=False)
    assert contents(tmp_path) == before


def test_nothing_is_left_of_missions_where_none_can_be_flown(tmp_path: Path) -> None:
    outputs.write_outputs(tmp_path, two_drones(), has_figure=False)
    written = outputs.write_outputs(tmp_path, unflyable(), has_figure=False)
    assert written.faults
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plan.geojson", "plan.json"]


class Breaks:
    """Stands in for a function that works some times and then fails."""

    def __init__(self, function: Callable[..., object], after: int, error: BaseException) -> None:
        self._function, self._left, self._error = function, after, error

    def __call__(self, *arguments: object) -> object:
        if self._left == 0:
            raise self._error
        self._left -= 1
        return self._function(*arguments)


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()], ids=["full", "ctrl-c"])
@pytest.mark.parametrize("after", [0, 1, 2, 5, 8])
def test_a_failure_while_writing_leaves_the_old_plan(
    after: int, error: BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "out"
    outputs.write_outputs(folder, two_drones(), has_figure=False)
    before = contents(folder)
    monkeypatch.setattr(atomic, "_write", Breaks(atomic._write, after, error))
    # A plan of one drone has nine files: itself, README.txt, two missions and parameters for two ground stations.
    with pytest.raises(type(error)):
        outputs.write_outputs(folder, one_drone(), has_figure=False)
    assert contents(folder) == before
    assert left_behind(folder) == []


@pytest.mark.parametrize("after", [0, 1, 7, 14, 15, 16, 20, 23])
def test_a_failure_while_swapping_leaves_the_old_plan(
    after: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "out"
    outputs.write_outputs(folder, two_drones(), has_figure=False)
    before = contents(folder)
    rename, left = Path.rename, [after]

    def fail_once(self: Path, target: Path) -> Path:
        left[0] -= 1
        if left[0] == -1:
            raise OSError(5, "Input/output error")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", fail_once)
    # Fifteen old files go out, nine new ones come in.
    with pytest.raises(OSError, match="Input/output"):
        outputs.write_outputs(folder, one_drone(), has_figure=False)
    monkeypatch.undo()
    assert contents(folder) == before


def left_behind(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir() if path.name.startswith(atomic.STAGING_PREFIX)]


SIGNAL_AT_A_STEP = """
import os, shutil, signal, sys
from pathlib import Path

from hand_made import two_drones
from pondhop import outputs
from pondhop.documents.signals import STOPS

folder, step, left, number = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
owner = {"rename": Path, "unlink": os, "rmtree": shutil}[step]
function = getattr(owner, step)

def signalled(*arguments, **options):
    global left
    left -= 1
    if left == -1:
        os.kill(os.getpid(), number)
    return function(*arguments, **options)

setattr(owner, step, signalled)
with STOPS.raised():
    outputs.write_outputs(folder, two_drones(), has_figure=False)
"""


def signalled_write(folder: Path, step: str, after: int, number: int) -> int:
    command = [sys.executable, "-c", SIGNAL_AT_A_STEP, str(folder), step, str(after), str(int(number))]
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parent)}
    return subprocess.run(command, env=environment, stderr=subprocess.DEVNULL, check=False).returncode


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(
    ("step", "after"), [("rename", 0), ("rename", 9), ("rename", 17), ("unlink", 0), ("unlink", 5), ("rmtree", 0)]
)
def test_nothing_is_left_of_a_write_that_a_signal_stops(step: str, after: int, number: int, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    outputs.write_outputs(folder, one_drone(), has_figure=False)
    assert signalled_write(folder, step, after, number) != 0
    outputs.write_outputs(tmp_path / "fresh", two_drones(), has_figure=False)
    assert left_behind(folder) == []
    # The swap is not torn: the new plan is there before anybody hears of the signal.
    assert contents(folder) == contents(tmp_path / "fresh")


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
@pytest.mark.parametrize("after", [0, 1, 4, 7, 8, 9, 10, 15, 20, 23])
def test_what_a_killed_write_left_goes_with_the_next_plan(
    after: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "out"
    outputs.write_outputs(folder, one_drone(), has_figure=False)
    # Nine old files go out, fifteen new ones come in.
    assert signalled_write(folder, "rename", after, signal.SIGKILL) == -signal.SIGKILL
    assert len(left_behind(folder)) == 1
    before = contents(folder)
    with monkeypatch.context() as patched:
        patched.setattr(atomic, "_write", Breaks(atomic._write, 3, OSError(28, "No space left on device")))
        with pytest.raises(OSError, match="No space left"):
            outputs.write_outputs(folder, two_drones(), has_figure=False)
    assert contents(folder) == before
    outputs.write_outputs(folder, two_drones(), has_figure=False)
    outputs.write_outputs(tmp_path / "fresh", two_drones(), has_figure=False)
    assert contents(folder) == contents(tmp_path / "fresh")
    assert left_behind(folder) == []


@pytest.mark.skipif(sys.platform == "win32", reason="there are no locks to tell by")
def test_only_what_is_surely_ours_is_removed(tmp_path: Path) -> None:
    mark = atomic._mark_text()
    kept: dict[str, dict[str, bytes]] = {
        ".pondhop-mine": {"pondhop.txt": mark},
        ".pondhop-abcdefgh": {"notes.txt": b"the user's own"},
        ".pondhop-bcdefghi": {"pondhop.txt": mark, "notes.txt": b"the user's own"},
        ".pondhop-cdefghij": {"pondhop.txt": b"made on another machine"},
        ".pondhop-defghijk": {},
    }
    for name, files in {**kept, ".pondhop-efghijkl": {"pondhop.txt": mark, "new/plan.json": b""}}.items():
        (tmp_path / name).mkdir()
        for path, content in files.items():
            (tmp_path / name / path).parent.mkdir(exist_ok=True)
            (tmp_path / name / path).write_bytes(content)
    (tmp_path / ".pondhop-fghijklm").symlink_to(tmp_path / ".pondhop-mine")
    with atomic._temporary_folder(tmp_path) as in_use:
        outputs.write_outputs(tmp_path, two_drones(), has_figure=False)
        assert sorted(left_behind(tmp_path)) == sorted([*kept, ".pondhop-fghijklm", in_use.name])
    assert not in_use.exists()


@pytest.mark.skipif(sys.platform == "win32", reason="there are no locks to tell by")
def test_a_folder_that_cannot_be_locked_is_taken_for_nobodys_leftover(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lock = atomic._lock
    monkeypatch.setattr(atomic, "_lock", lambda _file: False)
    with atomic._temporary_folder(tmp_path) as in_use:
        monkeypatch.setattr(atomic, "_lock", lock)
        atomic.write_all({tmp_path / "plan.json": "{}"})
        assert left_behind(tmp_path) == [in_use.name]


@pytest.mark.skipif(sys.platform == "win32", reason="there are no locks to tell by")
def test_files_are_locked_for_which_locks_on_a_network_ask(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import fcntl

    def flock_of_nfs(file: IO[bytes], operation: int) -> None:
        if not file.writable():
            raise OSError(9, "Bad file descriptor")
        flock(file, operation)

    flock = fcntl.flock
    monkeypatch.setattr(fcntl, "flock", flock_of_nfs)
    (tmp_path / ".pondhop-abcdefgh").mkdir()
    (tmp_path / ".pondhop-abcdefgh" / "pondhop.txt").write_bytes(atomic._mark_text())
    atomic.write_all({tmp_path / "plan.json": "{}"})
    assert left_behind(tmp_path) == []


@pytest.mark.parametrize("name", ["plan.json", "plan.svg", "missions/README.txt", "missions"])
def test_a_folder_that_will_be_refused_is_told_before_planning(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def plan(*_: object, **__: object) -> None:
        raise AssertionError("planned all the same")

    monkeypatch.setattr(planners, "plan", plan)
    (tmp_path / "out" / name).parent.mkdir(parents=True)
    (tmp_path / "out" / name).write_text("the user's own")
    farm = Path(__file__).resolve().parents[1] / "examples" / "delta_farm.geojson"
    monkeypatch.setattr(sys, "argv", ["pondhop", "plan", str(farm), "--drones", "3", "-o", str(tmp_path / "out")])
    with pytest.raises(SystemExit) as exited:
        cli.main()
    assert exited.value.code == 2
    assert f"{tmp_path / 'out' / name}: " in capsys.readouterr().err


def test_a_file_in_the_place_of_the_folder_is_told(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("the user's own")
    with pytest.raises(InvalidInput, match="there is something else"):
        outputs.write_outputs(tmp_path / "out", two_drones(), has_figure=False)


@pytest.mark.parametrize(
    "title",
    [
        "Missions for Test farm, hover-dip",
        "Missions for Test farm, splashdown, for ArduPilot Copter",
        "Missions for Delta farm of 120 ponds (made up, seed 1), hover-dip, for ArduPilot\n  Copter",
    ],
)
def test_missions_of_an_earlier_version_are_ours(title: str, tmp_path: Path) -> None:
    outputs.write_outputs(tmp_path, two_drones(), has_figure=False)
    (tmp_path / "missions" / "README.txt").write_text(f"{title}\n\nDRONES\n")
    outputs.write_outputs(tmp_path, one_drone(), has_figure=False)
    assert (tmp_path / "missions" / "README.txt").read_text().startswith("Pondhop missions for Test farm")
    assert not (tmp_path / "missions" / "drone-2.plan").exists()


@pytest.mark.parametrize(
    "text", ["Missions for Monday\n\nCall Bob.\n", "Missions for Monday, or\n\nnever, hover-dip\n"]
)
def test_what_people_write_of_missions_is_their_own(text: str, tmp_path: Path) -> None:
    (tmp_path / "missions").mkdir()
    (tmp_path / "missions" / "README.txt").write_text(text)
    with pytest.raises(InvalidInput, match="nothing says that it wrote"):
        outputs.write_outputs(tmp_path, two_drones(), has_figure=False)


def test_a_folder_in_the_way_is_told(tmp_path: Path) -> None:
    (tmp_path / "plan.json").mkdir()
    with pytest.raises(InvalidInput, match="this is a folder, not a file"):
        outputs.write_outputs(tmp_path, two_drones(), has_figure=False)
    assert [path.name for path in tmp_path.iterdir()] == ["plan.json"]


def started_solve(tmp_path: Path) -> tuple[subprocess.Popen[str], Path]:
    """A command that plans farms one after the other, of which some are done."""
    farms, plans = tmp_path / "farms.json", tmp_path / "plans.json"
    instances.write_farms(farms, instances.generate(40, 500, seed=5))
    command = [PONDHOP, "solve", farms, "--routes", 3, "--iterations", 30_000, "-o", plans]
    process = subprocess.Popen(list(map(str, command)), stderr=subprocess.PIPE, text=True)
    partial = tmp_path / "plans.json.partial"
    while process.poll() is None and not (partial.exists() and partial.read_text().count("\n") > 3):
        time.sleep(0.02)
    return process, plans


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_plans_are_kept_when_the_program_is_stopped(number: int, code: int, tmp_path: Path) -> None:
    process, plans = started_solve(tmp_path)
    process.send_signal(number)
    _, told = process.communicate()
    assert process.returncode == code
    found = json.loads(plans.read_text())
    assert 3 <= len(found) < 500
    assert f"stopped; {len(found)} of 500 farms are planned" in told


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
def test_signals_held_back_are_each_delivered_once() -> None:
    heard: list[int] = []
    numbers = (signal.SIGHUP, signal.SIGTERM)
    handlers = [signal.signal(number, lambda number, _frame: heard.append(number)) for number in numbers]
    try:
        with signals_held_back():
            for number in (signal.SIGHUP, signal.SIGTERM, signal.SIGHUP):
                signal.raise_signal(number)
            assert heard == []
        assert heard == [signal.SIGHUP, signal.SIGTERM]
    finally:
        for number, handler in zip(numbers, handlers, strict=True):
            signal.signal(number, handler)


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
def test_plans_survive_a_kill(tmp_path: Path) -> None:
    process, plans = started_solve(tmp_path)
    process.kill()
    process.communicate()
    assert not plans.exists()
    lines = (tmp_path / "plans.json.partial").read_text().splitlines()
    assert [json.loads(line.rstrip(","))["index"] for line in lines[1:4]] == [0, 1, 2]


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
@pytest.mark.parametrize(
    ("number", "code", "how"), [(signal.SIGINT, 130, "with Ctrl-C"), (signal.SIGTERM, 143, "by SIGTERM")]
)
def test_a_stopped_search_is_a_plan_that_says_so(number: int, code: int, how: str, tmp_path: Path) -> None:
    farm = Path(__file__).resolve().parents[1] / "examples" / "delta_farm.geojson"
    command = [PONDHOP, "plan", farm, "--drones", 5, "--no-figure", "--time-limit", 600, "-o", tmp_path / "out"]
    process = subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    # The search has begun once the process has used a second of its own; until then a signal just ends it.
    while process.poll() is None and processor_time_s(process.pid) < 3.0:
        time.sleep(0.05)
    process.send_signal(number)
    _, told = process.communicate()
    assert process.returncode == code, told
    assert told == f"pondhop: stopped {how}; this is the best plan until then, and plan.json says so\n"
    document = json.loads((tmp_path / "out" / "plan.json").read_text())
    assert document["is_interrupted"] is True
    # Whoever reads the plan later need not know which signal it was, and must not be told the wrong one.
    assert "The planning was stopped: this is the best plan until then." in document["notes"]


def processor_time_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / 100


def test_the_same_plan_gives_the_same_folder(tmp_path: Path) -> None:
    farm = Path(__file__).resolve().parents[1] / "examples" / "delta_farm.geojson"
    for name in ("first", "second"):
        command = [PONDHOP, "plan", farm, "--drones", 3, "--iterations", 3000, "-o", tmp_path / name]
        subprocess.run(list(map(str, command)), check=True, capture_output=True)
    assert contents(tmp_path / "first") == contents(tmp_path / "second")


def test_letters_that_no_font_has_are_noted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from pondhop.plot import fonts

    # A machine with nothing but the font that matplotlib brings along, which has no Thai.
    files = {fonts.DEFAULT_FAMILY: fonts._font_files()[fonts.DEFAULT_FAMILY]}
    monkeypatch.setattr(fonts, "_font_files", lambda: files)
    farm = make_farm(name="\u0e1f\u0e32\u0e23\u0e4c\u0e21")
    farm_plan = make_plan(farm, Fleet(1), [[0, 1, 2, 3, 4]])
    written = outputs.write_outputs(tmp_path, farm_plan, has_figure=True)
    (note,) = (note for note in written.farm_plan.notes if note.startswith("No font of this machine"))
    assert farm.name in note
    assert note in json.loads(written.plan_json)["notes"]
    crew = " ".join((tmp_path / "missions" / "README.txt").read_text("utf-8").split())
    assert "the picture shows ? for those that are missing" in crew
    assert outputs.write_outputs(tmp_path, farm_plan, has_figure=False).farm_plan.notes == farm_plan.notes
