"""`pondhop bench`: what is measured, resuming, and the tables."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pondhop
from hand_made import SHARED
from pondhop import InvalidInput, Problem, instances
from pondhop.bench import execute
from pondhop.bench.best_known import BestKnown, BestPlan, read_best_known, write_best_known
from pondhop.bench.farm_sets import BenchFarm, Task, generate_farm_set, read_farm_sets, tasks
from pondhop.bench.measure import Entrant, Request, Run, TimeLimit, measure, parse_entrants, warm_up
from pondhop.bench.results import Results, read_results
from pondhop.bench.summary import Comparison, markdown
from pondhop.instances import ResearchFarm

PONDHOP = str(Path(sys.executable).parent / "pondhop")
FARM = ResearchFarm(np.array([0.0, 0.0]), np.array([[0.0, 3.0], [0.0, 6.0], [5.0, 0.0]]))
RUN = Run(
    set_name="toy",
    farm=0,
    digest="a",
    num_ponds=3,
    num_routes=2,
    planner="x",
    time_limit="1 s",
    time_limit_s=1.0,
    seed=1,
    max_route_length=12.0,
    total_length=22.0,
    lower_bound=10.0,
    overlap=0.25,
    num_crossings=1,
    num_routes_used=2,
    num_missed=0,
    num_violations=0,
    elapsed_s=0.5,
    cpu_s=0.25,
    version="0.1.0",
    commit="c0ffee",
    build="b1",
    python="3.11",
    machine="abacus",
    finished_at="2026-01-01T00:00:00+00:00",
)


def by_hand(_problem: Problem, _seed: int, _time_limit_s: float | None) -> list[list[int]]:
    return [[0, 1], [2]]


def in_turn(problem: Problem, seed: int, _time_limit_s: float | None) -> list[list[int]]:
    """Deal the ponds out, beginning with the one that the seed says."""
    ponds = [(pond + seed) % problem.num_ponds for pond in range(problem.num_ponds)]
    return [ponds[drone :: problem.num_drones] for drone in range(problem.num_drones)]


def forgetful(problem: Problem, _seed: int, _time_limit_s: float | None) -> list[list[int]]:
    return [list(range(1, problem.num_ponds))]


def deadly(problem: Problem, seed: int, _time_limit_s: float | None) -> list[list[int]]:
    """Die as a process killed for want of memory does, on the third seed."""
    if seed == 3:
        os._exit(9)
    return [list(range(problem.num_ponds))]


def bench(*arguments: object) -> dict[str, Any]:
    command = [PONDHOP, "bench", "run", *map(str, arguments), "--json"]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    assert ran.stderr == ""
    return dict(json.loads(ran.stdout))


def faults_of(*arguments: object) -> list[str]:
    command = [PONDHOP, "bench", *map(str, arguments), "--json"]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode == 2, ran.stderr
    return [fault["path"] for fault in json.loads(ran.stderr)["faults"]]


def run_all(requests: Sequence[Request], folder: Path, num_jobs: int = 1) -> list[Run]:
    results = Results(folder)
    execute.execute(requests, results, num_jobs=num_jobs, advance=lambda _request: None)
    return read_results(results.path)


def request(entrant: Entrant, seed: int = 1, time_limit: TimeLimit = TimeLimit()) -> Request:  # noqa: B008 - immutable
    return Request(Task(BenchFarm("toy", 0, FARM), 2), entrant, time_limit, seed)


def test_a_run_is_what_the_evaluator_says() -> None:
    run, routes = measure(request(Entrant("mine", by_hand), seed=7, time_limit=TimeLimit(0.5, is_per_node=True)))
    assert routes == [[0, 1], [2]]
    assert (run.set_name, run.farm, run.num_ponds, run.num_routes) == ("toy", 0, 3, 2)
    assert (run.planner, run.seed, run.time_limit, run.time_limit_s) == ("mine", 7, "0.5 s/node", 2.0)
    assert (run.max_route_length, run.total_length, run.num_routes_used) == (12.0, 22.0, 2)
    assert run.lower_bound == pytest.approx(12.0)
    assert (run.num_missed, run.num_violations, run.num_crossings, run.overlap) == (0, 0, 0, 0.0)
    assert run.elapsed_s >= 0.0
    assert run.cpu_s >= 0.0
    assert run.version == pondhop.__version__
    assert "cores" in run.machine


def test_missed_ponds_are_counted() -> None:
    run, _ = measure(request(Entrant("forgetful", forgetful)))
    assert (run.num_missed, run.num_violations, run.num_routes_used) == (1, 1, 1)


def test_the_request_knows_the_key_of_its_run() -> None:
    asked = request(Entrant("mine", by_hand), seed=7, time_limit=TimeLimit(0.5))
    assert measure(asked)[0].key == asked.key


def test_farms_are_told_apart_by_their_positions() -> None:
    moved = replace(FARM, ponds=FARM.ponds + np.array([0.0, 1e-12]))
    digests = {BenchFarm("a", 0, FARM).digest, BenchFarm("b", 5, FARM).digest, BenchFarm("a", 0, moved).digest}
    assert len(digests) == 2


def test_every_combination_is_asked_for() -> None:
    farms = generate_farm_set(20, 2, seed=3)
    asked = execute.requests(
        tasks(farms, [2, 3], BestKnown(())),
        parse_entrants("hpp, hpp:threads=2"),
        [TimeLimit(0.1), TimeLimit(1)],
        [1, 2, 3],
    )
    assert len({one.key for one in asked}) == len(asked) == 2 * 2 * 2 * 2 * 3
    assert [entrant.options for entrant in parse_entrants("hpp, hpp:threads=2")] == [{}, {"threads": 2}]
    (entrant,) = parse_entrants("auto:has_separate_airspace=True")
    assert entrant.options == {"has_separate_airspace": True}


def test_parallel_runs_give_the_results_of_serial_ones(tmp_path: Path) -> None:
    farms = generate_farm_set(30, 3, seed=2)
    entrants = [Entrant("hpp", "hpp"), Entrant("in_turn", in_turn)]
    asked = execute.requests(tasks(farms, [3], BestKnown(())), entrants, [TimeLimit()], [1, 2])
    serial = run_all(asked, tmp_path / "serial")
    parallel = run_all(asked, tmp_path / "parallel", num_jobs=3)

    def comparable(runs: list[Run]) -> list[str]:
        # As text, because a missing time limit is NaN.
        return sorted(str(replace(run, elapsed_s=0.0, cpu_s=0.0, finished_at="")) for run in runs)

    assert len(serial) == 12
    assert [run.key for run in serial] == [one.key for one in asked]
    assert comparable(parallel) == comparable(serial)


def test_results_come_back_as_they_were(tmp_path: Path) -> None:
    results = Results(tmp_path)
    runs = [RUN, replace(RUN, seed=2, machine='a "b", c', max_route_length=0.1 + 0.2)]
    for run in runs:
        results.add(run, [])
    assert read_results(results.path) == runs == Results(tmp_path).runs


def test_a_row_cut_short_is_run_again(tmp_path: Path) -> None:
    results = Results(tmp_path)
    results.add(RUN, [])
    results.add(replace(RUN, seed=2), [])
    results.path.write_bytes(results.path.read_bytes()[:-30])
    assert read_results(results.path) == [RUN]
    resumed = Results(tmp_path)
    assert resumed.finished == {RUN.key}
    resumed.add(replace(RUN, seed=3), [])
    assert [run.seed for run in read_results(results.path)] == [1, 3]


def test_a_run_whose_plan_is_wanted_and_missing_is_run_again(tmp_path: Path) -> None:
    Results(tmp_path).add(RUN, [[0]])
    keeping = Results(tmp_path, is_keeping_plans=True)
    assert keeping.finished == set()
    keeping.add(replace(RUN, elapsed_s=0.75), [[0]])
    assert Results(tmp_path, is_keeping_plans=True).finished == {RUN.key}
    assert [run.elapsed_s for run in read_results(keeping.path)] == [0.75]


def test_a_planner_that_dies_costs_only_its_own_run(tmp_path: Path) -> None:
    entrant = Entrant("deadly", deadly)
    with pytest.raises(BrokenProcessPool):
        run_all([request(entrant, seed) for seed in (1, 2, 3, 4)], tmp_path)
    assert [run.seed for run in read_results(tmp_path / "results.csv")] == [1, 2]


def begun(folder: Path, *arguments: str) -> "subprocess.Popen[str]":
    """Start a benchmark and return when some of its runs are finished."""
    command = [PONDHOP, "bench", "run", *arguments, "-o", str(folder)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not (folder / "results.csv").exists() or len(read_results(folder / "results.csv")) < 3:
        assert process.poll() is None
        time.sleep(0.01)
    return process


LONG = ("--planners", "hpp", "--generate", "700", "--farms", "80", "--routes", "5", "--jobs", "2")


def test_a_killed_benchmark_goes_on_where_it_was(tmp_path: Path) -> None:
    process = begun(tmp_path, *LONG)
    process.kill()
    # Workers hold the other ends of the pipes: this returns because they end with the process that began them.
    process.communicate()
    num_finished = len(read_results(tmp_path / "results.csv"))
    assert 3 <= num_finished < 80
    answer = bench(*LONG, "-o", tmp_path)
    assert answer["num_new_runs"] == 80 - num_finished
    assert sorted(run.farm for run in read_results(tmp_path / "results.csv")) == list(range(80))
    assert bench(*LONG, "-o", tmp_path)["num_new_runs"] == 0


def test_ctrl_c_ends_a_benchmark_without_a_traceback(tmp_path: Path) -> None:
    process = begun(tmp_path, *LONG)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 130
    assert "Traceback" not in err
    assert 3 <= len(read_results(tmp_path / "results.csv")) < 80


def test_another_build_is_run_again_and_shown_apart(tmp_path: Path) -> None:
    command = ("--planners", "hpp", "--generate", "20", "--farms", "2", "--routes", "3", "-o", tmp_path)
    (row,) = bench(*command)["sets"]
    results = tmp_path / "results.csv"
    results.write_text(results.read_text().replace(row["build"], "0123456789ab"))
    answer = bench(*command)
    assert (answer["num_new_runs"], answer["num_runs"]) == (2, 4)
    assert {row["build"] for row in answer["sets"]} == {row["build"], "0123456789ab"}
    page = (tmp_path / "results.md").read_text()
    assert "| build |" in page
    assert page.count("build 0123456789ab") == 1


def test_a_planner_of_ones_own_from_the_command_line(tmp_path: Path) -> None:
    module = tmp_path / "my_planners.py"
    module.write_text("def alone(problem, seed, time_limit_s):\n    return [list(range(problem.num_ponds))]\n")
    command = [PONDHOP, "bench", "run", "--planners", "hpp,my_planners:alone", "--generate", "20", "--farms", "2"]
    command += ["--routes", "3", "--jobs", "2", "-o", "out", "--json"]

    def answer() -> dict[str, Any]:
        ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        return dict(json.loads(ran.stdout))

    used = [(row["planner"], row["num_routes_used"]) for row in answer()["sets"]]
    assert used == [("hpp", 3.0), ("my_planners:alone", 1.0)]
    assert "| build |" not in (tmp_path / "out" / "results.md").read_text()
    # A planner that has changed is run again and shown beside its old self; the others are not run again.
    module.write_text(module.read_text().replace("[list(range(problem.num_ponds))]", "[[0], [1]]"))
    again = answer()
    assert again["num_new_runs"] == 2
    missed = sorted((row["planner"], row["num_missed"]) for row in again["sets"])
    assert missed == [("hpp", 0), ("my_planners:alone", 0), ("my_planners:alone", 36)]
    assert "| build |" in (tmp_path / "out" / "results.md").read_text()


def test_summaries_by_hand() -> None:
    runs = [
        RUN,
        replace(RUN, planner="y", max_route_length=11.0, total_length=20.0, num_crossings=0, elapsed_s=1.5),
        replace(RUN, farm=1, digest="b", max_route_length=20.0, total_length=40.0, lower_bound=20.0, overlap=0.75),
        replace(RUN, farm=1, digest="b", planner="y", max_route_length=25.0, total_length=30.0, lower_bound=20.0),
        replace(RUN, farm=1, digest="b", planner="z", max_route_length=9.0, num_missed=2, num_violations=1),
    ]
    x, y, z = Comparison(runs, BestKnown(())).sets()
    assert (x.planner, x.num_farms, x.num_runs) == ("x", 2, 2)
    assert (x.max_route_length, x.total_length) == (16.0, 31.0)
    # The best are 11 (y) on the first farm and 20 (x) on the second; z misses ponds and is the best of nothing.
    assert x.gap_percent == pytest.approx((100 / 11 + 0) / 2)
    assert x.worst_gap_percent == pytest.approx(100 / 11)
    assert x.total_gap_percent == pytest.approx((10 + 0) / 2)
    assert x.bound_gap_percent == pytest.approx((20 + 0) / 2)
    assert (x.overlap, x.num_crossings, x.num_routes_used, x.num_missed) == (0.5, 1.0, 2.0, 0)
    assert (x.elapsed_s, x.cpu_s) == (0.5, 0.25)
    assert y.gap_percent == pytest.approx((0 + 25) / 2)
    assert (y.elapsed_s, y.num_crossings) == (1.0, 0.5)
    assert (z.num_missed, z.num_violations) == (2, 1)

    overall = {row.planner: row for row in Comparison(runs, BestKnown(())).overall()}
    assert (overall["x"].num_runs, overall["x"].num_reached) == (2, 1)
    assert (overall["x"].num_open, overall["x"].num_open_reached) == (1, 0)
    assert (overall["y"].num_reached, overall["y"].num_open_reached) == (1, 1)
    assert overall["z"].num_reached == 0


def test_gaps_to_a_best_known_file() -> None:
    listed = BestKnown([BestPlan("toy", 0, 2, 12.5, 20.0), BestPlan("other", 0, 2, 1.0), BestPlan("toy", 0, 3, 1.0)])
    comparison = Comparison([RUN, replace(RUN, farm=1, digest="b", max_route_length=8.0)], listed)
    (row,) = comparison.sets()
    assert row.gap_percent == pytest.approx((-4 + 0) / 2)
    assert row.total_gap_percent == pytest.approx((10 + 0) / 2)
    page = markdown(comparison, "best.json")
    assert "that of best.json for 1 of 2 pairs" in page
    assert "| toy | 3 | 2 | x | 1 s | 2 | 2 | 10 | 22 | -2.00 | 0.00 |" in page
    assert "pondhop 0.1.0, commit c0ffee, build b1, Python 3.11; abacus; 2 runs" in page


def test_a_farm_where_everything_is_in_one_place_has_no_gap() -> None:
    run = replace(RUN, max_route_length=0.0, total_length=0.0, lower_bound=0.0)
    (row,) = Comparison([run], BestKnown(())).sets()
    assert (row.gap_percent, row.worst_gap_percent, row.bound_gap_percent) == (None, None, None)
    assert "|  |  |  |  | 25.0% |" in markdown(Comparison([run], BestKnown(())), "")


def test_best_plans_are_kept_replaced_and_added(tmp_path: Path) -> None:
    listed = [BestPlan("toy", 0, 2, 12.0, 23.0, "a"), BestPlan("toy", 1, 2, 5.0, None, "b"), BestPlan("far", 0, 2, 1.0)]
    runs = [
        RUN,
        replace(RUN, farm=1, digest="b"),
        replace(RUN, farm=2, digest="c"),
        replace(RUN, farm=3, digest="d", num_violations=1),
    ]
    found = Comparison(runs, BestKnown(listed)).best_plans()
    added = BestPlan("toy", 2, 2, 12.0, 22.0, "c")
    assert found == [BestPlan("toy", 0, 2, 12.0, 22.0, "a"), *listed[1:], added]
    write_best_known(tmp_path / "best.json", found)
    assert read_best_known(tmp_path / "best.json").plans == found


def test_of_several_best_plans_the_best_counts() -> None:
    known = BestKnown([BestPlan("toy", 0, 2, 9.0), BestPlan("toy", 0, 2, 10.0), BestPlan("x", 0, 2, 8.0, None, "a")])
    found = known.find("toy", 0, "a", 2)
    assert found is not None
    assert found.max_route_length == 8.0
    assert known.find("toy", 0, "b", 2) == BestPlan("toy", 0, 2, 9.0)
    assert known.find("toy", 0, "a", 3) is None


def test_routes_of_the_literature(tmp_path: Path) -> None:
    (tmp_path / "best.csv").write_text(
        "instance,nodes,routes,best_max_route_length,source\nmtsp_51_10,51,10,112.5,X\nmtsp_51_3,51,3,160.0,Y\n"
    )
    known = read_best_known(tmp_path / "best.csv")
    assert known.plans == [BestPlan("mtsp_51", 0, 10, 112.5), BestPlan("mtsp_51", 0, 3, 160.0)]
    farm = BenchFarm("mtsp_51", 0, FARM)
    assert [task.num_routes for task in tasks([farm], [], known)] == [3, 10]
    with pytest.raises(InvalidInput, match="--routes"):
        tasks([farm, BenchFarm("unknown", 0, FARM)], [], known)


@pytest.mark.skipif(not SHARED.exists(), reason="the data beside the repository is not there")
def test_the_published_instances_and_values_fit_together() -> None:
    known = read_best_known(SHARED / "data" / "mtsp" / "best_known.csv")
    farms = read_farm_sets(sorted((SHARED / "data" / "mtsp").glob("*.tsp")))
    pairs = tasks(farms, [], known)
    assert len(pairs) == len(known.plans) == 31
    for pair in pairs:
        best = known.find(pair.farm.set_name, pair.farm.index, pair.farm.digest, pair.num_routes)
        assert best is not None
        bound = pondhop.lower_bound(pair.farm.farm.to_problem(pair.num_routes))
        assert bound <= best.max_route_length * (1 + 1e-6)
    soft = read_best_known(SHARED / "data" / "instances" / "best_known.json")
    assert soft.find("farms200", 0, "", 5) == BestPlan("farms200", 0, 5, 1.695789, 8.451001)


@pytest.mark.parametrize(
    ("name", "text", "places"),
    [
        ("a.json", "[", [""]),
        ("a.json", "{}", [""]),
        ("a.json", "[]", [""]),
        ("a.json", '[7, {"instance": "", "index": 0.5, "routes_allowed": 0}]', ["[0]"] + 4 * ["[1]"]),
        (
            "a.json",
            '[{"instance": "a", "index": true, "routes_allowed": 9, "best_max_route_length": 1e999}]',
            ["[0]", "[0]"],
        ),
        ("a.csv", "instance,routes\na,1\n", [", line 2"]),
        ("a.csv", "instance,routes,best_max_route_length\na,x,nan\nb,1,1\nc,1,-1\n", 2 * [", line 2"] + [", line 4"]),
    ],
)
def test_broken_best_known_files_are_answered_with_every_fault(
    tmp_path: Path, name: str, text: str, places: list[str]
) -> None:
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(InvalidInput) as caught:
        read_best_known(path)
    assert [fault.path for fault in caught.value.faults] == [f"{path}{place}" for place in places]


def test_broken_results_are_answered_with_every_line(tmp_path: Path) -> None:
    results = Results(tmp_path)
    results.add(RUN, [])
    with results.path.open("a") as file:
        file.write("too,short\n")
        file.write(",".join(["x"] * 25) + "\n")
    assert faults_of("table", results.path) == [f"{results.path}, line 3", f"{results.path}, line 4"]
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    assert faults_of("table", tmp_path / "other.csv") == [f"{tmp_path / 'other.csv'}, line 1"]
    (tmp_path / "other.csv").write_bytes(b"\xff\n")
    assert faults_of("table", tmp_path / "other.csv") == [f"{tmp_path / 'other.csv'}"]
    Results(tmp_path / "none")
    assert faults_of("table", tmp_path / "none" / "results.csv") == ["runs"]


def test_all_faults_of_a_command_are_named_at_once(tmp_path: Path) -> None:
    farms = tmp_path / "farms.json"
    farms.write_text('[{"depot": [0, "x"], "ponds": []}]')
    command = ("run", farms, "--generate", "0,x,50,50", "--routes", "0", "--time-limits", "0,nan,1")
    more = ("--seeds", "-1", "--planners", "hpq,hpp:threads=0,hpp:thread=2,hpp:threads=two,hpp,hpp,nowhere:mine")
    folder = tmp_path / "out"
    files = ("--best-known", farms, "--update-best", tmp_path / "best.csv", "-o", folder)
    assert faults_of(*command, *more, *files) == [
        f"{farms}: [0].depot",
        f"{farms}: [0].ponds",
        *3 * ["--generate"],
        *4 * [f"{farms}[0]"],
        "--update-best",
        "--routes",
        *2 * ["--time-limits"],
        "--seeds",
        "planner hpq: planner",
        "planner hpp:threads=0: threads",
        "planner hpp:thread=2",
        "planner hpp:threads=two: threads",
        "planner nowhere:mine",
        "planner hpp",
    ]
    assert not folder.exists()
    assert faults_of("run", "--planners", "hpp", "-o", folder) == ["FILES, --generate"]
    assert faults_of("run", "--generate", "9", "--farms", 1, "-o", folder) == ["farm 0 of authors9-seed1"]


def test_sets_of_one_name_are_not_mixed(tmp_path: Path) -> None:
    paths = [tmp_path / "farms.json", tmp_path / "b" / "farms.json"]
    for path in paths:
        path.parent.mkdir(exist_ok=True)
        instances.write_farms(path, [FARM])
    with pytest.raises(InvalidInput, match="different names"):
        read_farm_sets(paths)


def test_the_command_writes_rows_table_plans_and_best(tmp_path: Path) -> None:
    instances.write_farms(tmp_path / "two.json", instances.generate(20, 2, seed=9))
    out, best = tmp_path / "out", tmp_path / "best.json"
    command = (
        tmp_path / "two.json",
        "--planners",
        "hpp",
        "--routes",
        "2,3",
        "--seeds",
        "1,2",
        "--time-limits",
        "0.01,0.1",
        "--keep-plans",
    )
    answer = bench(*command, "--update-best", best, "-o", out)
    assert answer["num_new_runs"] == answer["num_runs"] == 2 * 2 * 2 * 2
    assert [(row["num_routes"], row["time_limit"]) for row in answer["sets"]] == [
        (2, "0.01 s"),
        (2, "0.1 s"),
        (3, "0.01 s"),
        (3, "0.1 s"),
    ]
    runs = {run.key: run for run in read_results(out / "results.csv")}
    farms = instances.read_farms(tmp_path / "two.json")
    plans = [json.loads(line) for line in (out / "plans.jsonl").read_text().splitlines()]
    assert len(plans) == len(runs)
    for plan in plans:
        run = runs[tuple(plan["key"])]
        judged = pondhop.evaluate(farms[run.farm].to_problem(run.num_routes), plan["routes"])
        assert judged.max_route_length == run.max_route_length
    known = read_best_known(best)
    assert len(known.plans) == 4
    assert {plan.max_route_length for plan in known.plans} <= {run.max_route_length for run in runs.values()}
    page = (out / "results.md").read_text()
    printed = subprocess.run([PONDHOP, "bench", "table", str(out / "results.csv")], capture_output=True, text=True)
    assert printed.stdout == page
    again = bench(*command, "--best-known", best, "-o", out)
    assert again["num_new_runs"] == 0
    assert "that of best.json." in (out / "results.md").read_text()


@pytest.mark.parametrize("name", ["=1+1", "+cmd", "-2", "@x", "'quoted", "\tx", 'a "b", c', "plain"])
def test_no_name_becomes_a_formula_of_a_spreadsheet(tmp_path: Path, name: str) -> None:
    results = Results(tmp_path)
    run = replace(RUN, set_name=name, max_route_length=-1.5)
    results.add(run, [[0]])
    row = results.path.read_text(encoding="utf-8").splitlines()[1]
    assert not row.startswith(("=", "+", "-", "@", "\t", '"=', '"\t'))
    assert read_results(results.path) == [run]


def test_a_cell_without_end_is_told(tmp_path: Path) -> None:
    results = Results(tmp_path)
    with results.path.open("a") as file:
        file.write('"' + "x" * 200_000 + "\n")
    with pytest.raises(InvalidInput, match="this is no table"):
        read_results(results.path)


@pytest.mark.parametrize("line", ["{", "[]", '{"key": 1}', '{"key": [[]], "routes": []}', "\xff", "9" * 5000])
def test_damaged_plans_are_told_by_line(tmp_path: Path, line: str) -> None:
    results = Results(tmp_path, is_keeping_plans=True)
    results.add(RUN, [[0]])
    with results.plans_path.open("a") as file:
        file.write(line + "\n")
    with pytest.raises(InvalidInput, match=r"plans\.jsonl, line 2"):
        results.routes()


def test_a_planner_of_ones_own_that_fails_is_no_bug_of_ours() -> None:
    def broken(task: Problem, _seed: int, _time_limit_s: float | None) -> list[list[int]]:
        raise RuntimeError(f"no idea how to plan {task.num_ponds} ponds")

    with pytest.raises(InvalidInput, match=r"mine: it raises RuntimeError: no idea how to plan 2 ponds .test_bench.py"):
        warm_up(Entrant("mine", broken, {}))
