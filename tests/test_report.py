"""`pondhop bench paper`: what it measures, that its tables say what the runs say, resuming, and the pages."""

import csv
import json
import math
from collections.abc import Sequence
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from statistics import fmean
from typing import NamedTuple

import pytest
from typer.testing import CliRunner

pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install matplotlib jinja2 markdown-it-py")
pytest.importorskip("jinja2", reason="jinja2 is not installed: pip install matplotlib jinja2 markdown-it-py")

import pondhop
from pondhop import InvalidInput, Problem
from pondhop.bench.best_known import BestKnown, BestPlan
from pondhop.bench.measure import Run, TimeLimit
from pondhop.bench.results import read_results
from pondhop.cli import app
from pondhop.report import methods, page, scope
from pondhop.report.methods import LONG_SEARCH, METHODS, SEARCH, Method, installed, own_methods
from pondhop.report.printed import TABLE_1
from pondhop.report.scope import FULL, QUICK, Scope
from pondhop.report.study import Measurements, SearchWithin, Study, execute_study, seconds_missing
from pondhop.report.tables import Tables, csv_files

TINY = Scope(
    options=" --quick",
    num_ponds=(20, 50),
    num_farms=3,
    farm_budget_s=2.0,
    set_budget_s=1.0,
    anytime_num_ponds=(20,),
    anytime_num_farms=1,
    anytime_limits_s=(0.0001, 0.01),
    scaling_num_ponds=(80,),
    scaling_num_farms=1,
    num_repeats=2,
    figure_farm=1,
    figure_num_ponds=(50, 20),
)
HPP = next(method for method in METHODS if method.planner == "hpp")
SLOW = Method("slow, mine", "test_report:in_turn", "yours", seconds_at_100=0.8, growth=0.5)
SIX = Method("six", "test_report:one_route_more", "yours", most_ponds=50)
GHOST = Method("ghost", "ghost", "baseline", needs="pip install 'ghost'")
TINY_METHODS = (SEARCH, HPP, SLOW, SIX, GHOST)


def in_turn(problem: Problem, _seed: int, _time_limit_s: float | None) -> list[list[int]]:
    """Deal the ponds out."""
    return [list(range(drone, problem.num_ponds, problem.num_drones)) for drone in range(problem.num_drones)]


def one_route_more(problem: Problem, _seed: int, _time_limit_s: float | None) -> list[list[int]]:
    """Deal the ponds out to more drones than there are."""
    num_routes = problem.num_drones + 1
    return [list(range(drone, problem.num_ponds, num_routes)) for drone in range(num_routes)]


not_a_planner = 7


class Report(NamedTuple):
    folder: Path
    measurements: Measurements
    tables: Tables


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Report:
    """A report of few and small farms, written once for all tests."""
    folder = tmp_path_factory.mktemp("report")
    study = Study(TINY, *installed(TINY_METHODS))
    measurements, _ = execute_study(study, folder, num_jobs=2, advance=lambda _seconds: None)
    tables = Tables(measurements)
    page.write_report(tables, folder)
    return Report(folder, measurements, tables)


def runs_by_hand(report: Report, label: str, set_name: str, time_limit: str = "none") -> list[Run]:
    runs = read_results(report.folder / "results.csv")
    of_set = [run for run in runs if (run.planner, run.set_name, run.time_limit) == (label, set_name, time_limit)]
    return sorted(of_set, key=lambda run: run.farm)


def csv_rows(report: Report, name: str) -> list[dict[str, str]]:
    with (report.folder / name).open(newline="") as lines:
        return list(csv.DictReader(lines))


def table_after(text: str, heading: str) -> list[list[str]]:
    """Return the cells of the first Markdown table after a heading."""
    lines = text[text.index(heading) :].splitlines()
    begin = next(index for index, line in enumerate(lines) if line.startswith("| "))
    rows = []
    for line in lines[begin:]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return rows


def test_the_numbers_printed_are_those_of_the_paper() -> None:
    # The sums of the columns, added by hand from Table 1.
    assert sum(row.total_length for row in TABLE_1["HPP"].values()) == pytest.approx(86.33)
    assert sum(row.max_route_length for row in TABLE_1["AM50"].values()) == pytest.approx(29.11)
    assert sum(row.total_length for row in TABLE_1["AM100"].values()) == pytest.approx(99.40)
    assert sum(row.seconds for row in TABLE_1["GLOP"].values()) == pytest.approx(6166.91)
    assert sum(row.seconds for row in TABLE_1["HPP"].values()) == pytest.approx(0.04484)


def test_slow_methods_get_fewer_farms() -> None:
    ortools = next(method for method in METHODS if method.planner == "ortools")
    assert ortools.seconds(100) == 10.0
    # 10 s at 100 ponds, growing with the power of 2.5: 1.77 s at 50, 56.6 s at 200, 156 s at 300.
    assert [FULL.num_farms_of(ortools, size) for size in FULL.num_ponds] == [100, 40, 10, 0, 0, 0]
    assert [QUICK.num_farms_of(ortools, size) for size in QUICK.num_ponds] == [10, 2, 0, 0, 0, 0]
    assert TINY.num_farms_of(SLOW, 100) == 1
    assert TINY.num_farms_of(SLOW, 700) == 0
    assert TINY.num_farms_of(SIX, 50) == 3
    assert TINY.num_scaling_farms_of(SIX, 80) == 0


def test_a_budget_decides_how_many_farms_slow_methods_get() -> None:
    ortools = next(method for method in METHODS if method.planner == "ortools")
    scope = FULL.with_budget(60.0)
    # 60 s at 1.77 s a farm of 50 ponds are 33 farms, at 10 s 6 of 100, at 56.6 s one of 200; but 10 is the least.
    assert [scope.num_farms_of(ortools, size) for size in scope.num_ponds] == [33, 10, 10, 0, 0, 0]
    pyvrp = next(method for method in METHODS if method.planner == "pyvrp")
    assert [FULL.with_budget(25.0).num_farms_of(pyvrp, size) for size in FULL.num_ponds] == [10, 10, 10, 2, 2, 2]
    assert max(scope.anytime_limits_s) == 10.0
    assert scope.options == " --budget 60"
    assert FULL.with_budget(400.0).anytime_limits_s == FULL.anytime_limits_s
    assert QUICK.with_budget(25.0).anytime_limits_s == QUICK.anytime_limits_s


@pytest.mark.parametrize(("of_scope", "most_s"), [(FULL, 3.0 * 3600), (QUICK, 14.0 * 60)])
def test_the_budget_of_a_scope_is_counted(of_scope: Scope, most_s: float) -> None:
    """All methods of the package on one core, by what they are expected to take."""
    expected_s = 0.0
    for method in METHODS:
        expected_s += sum(of_scope.num_farms_of(method, size) * method.seconds(size) for size in of_scope.num_ponds)
        sizes = of_scope.scaling_num_ponds
        expected_s += sum(of_scope.num_scaling_farms_of(method, size) * method.seconds(size) for size in sizes)
        expected_s += of_scope.num_repeats * method.seconds(50)
    num_anytime = len(of_scope.anytime_num_ponds) * of_scope.anytime_num_farms
    for planner in methods.ANYTIME:
        method = next(method for method in METHODS if method.name == planner)
        expected_s += num_anytime * sum(of_scope.anytime_limits_of(method))
    assert expected_s <= most_s


def test_every_number_of_table_1_is_a_mean_of_the_runs(report: Report) -> None:
    rows = csv_rows(report, "table1.csv")
    assert [(row["method"], row["num_ponds"], row["num_farms"]) for row in rows] == [
        ("search, 10 ms", "20", "3"),
        ("hpp", "20", "3"),
        ("slow, mine", "20", "2"),
        ("six", "20", "3"),
        ("search, 10 ms", "50", "3"),
        ("hpp", "50", "3"),
        ("slow, mine", "50", "1"),
        ("six", "50", "3"),
    ]
    labels = {method.label: (method.planner, str(method.time_limit)) for method in TINY_METHODS}
    for row in rows:
        planner, time_limit = labels[row["method"]]
        runs = runs_by_hand(report, planner, f"authors{row['num_ponds']}-seed1", time_limit)
        assert len(runs) == int(row["num_farms"])
        columns: dict[str, list[float]] = {
            "max_route_length": [run.max_route_length for run in runs],
            "total_length": [run.total_length for run in runs],
            "wall_s": [100 * run.elapsed_s for run in runs],
            "cpu_s": [100 * run.cpu_s for run in runs],
            "num_routes_used": [run.num_routes_used for run in runs],
            "overlap": [run.overlap for run in runs],
            "num_crossings": [run.num_crossings for run in runs],
        }
        for column, values in columns.items():
            assert float(row[column]) == pytest.approx(fmean(values))
        assert int(row["num_missed"]) == sum(run.num_missed for run in runs) == 0
        assert int(row["num_too_many_routes"]) == (len(runs) if row["method"] == "six" else 0)


def test_the_page_shows_the_numbers_of_the_csv(report: Report) -> None:
    text = (report.folder / "report.md").read_text()
    rows = {(row["method"], row["num_ponds"]): row for row in csv_rows(report, "table1.csv")}
    for heading, column in (
        ("### Average total distance", "total_length"),
        ("### Average maximum route length", "max_route_length"),
    ):
        names, _, *body = table_after(text.replace("\u00a0", " "), heading)
        assert names == [
            "ponds",
            "HPP, paper",
            "hpp",
            "AM50, paper",
            "AM100, paper",
            "GLOP, paper",
            "slow, mine",
            "six",
            "search, 10 ms",
        ]
        for size, *cells in body:
            for name, cell in zip(names[1:], cells, strict=True):
                if name.endswith(", paper"):
                    printed = TABLE_1[name.removesuffix(", paper")].get(int(size))  # type: ignore[index]
                    assert cell == (f"{getattr(printed, column):.2f}" if printed else "—")
                else:
                    row = rows[name, size]
                    sample = "" if row["num_farms"] == "3" else f" ({row['num_farms']})"
                    assert cell.replace("**", "") == f"{float(row[column]):.2f}{sample}"
            values = {name: float(rows[name, size][column]) for name in ("hpp", "six", "search, 10 ms")}
            (bold,) = [name for name, cell in zip(names[1:], cells, strict=True) if "**" in cell]
            assert bold == min(values, key=lambda name: values[name])


def test_margins_by_hand(report: Report) -> None:
    rows = {(row["rival"], row["num_ponds"]): row for row in csv_rows(report, "margins.csv")}
    assert set(rows) == {(rival, size) for rival in ("hpp", "slow, mine", "six") for size in ("20", "50")}
    for (rival, size), row in rows.items():
        planner = {"slow, mine": SLOW.planner, "six": SIX.planner}.get(rival, rival)
        name = f"authors{size}-seed1"
        theirs = runs_by_hand(report, planner, name)
        ours = runs_by_hand(report, "search", name, "0.01 s")[: len(theirs)]
        within = runs_by_hand(report, f"search within {rival}", name, "0.01 s")
        assert [run.farm for run in within] == [run.farm for run in theirs]
        assert float(row["search_max_route_length"]) == pytest.approx(fmean(run.max_route_length for run in ours))
        assert float(row["rival_max_route_length"]) == pytest.approx(fmean(run.max_route_length for run in theirs))
        assert float(row["within_total_length"]) == pytest.approx(fmean(run.total_length for run in within))
        shorter = sum(mine.max_route_length < other.max_route_length for mine, other in zip(ours, theirs, strict=True))
        assert int(row["num_shorter_max"]) == shorter
        dominated = sum(
            mine.max_route_length <= other.max_route_length * (1 + 1e-6) and mine.total_length < other.total_length
            for mine, other in zip(within, theirs, strict=True)
        )
        assert int(row["num_dominated"]) == dominated
        assert int(row["num_too_many_routes"]) == (3 if rival == "six" else 0)


def test_the_search_keeps_to_the_longest_route_of_a_rival() -> None:
    problem = pondhop.generate(50, seed=3)[0].to_problem(5)
    rival = pondhop.solve(problem, planner="hpp").plan
    routes = SearchWithin(rival.max_route_length)(problem, 1, 0.2)
    plan = pondhop.evaluate(problem, routes)
    assert plan.is_feasible
    assert plan.max_route_length <= rival.max_route_length * (1 + 1e-9)
    assert plan.total_length < rival.total_length


def test_table_2_says_what_was_measured(report: Report) -> None:
    rows = {row["method"]: row for row in csv_rows(report, "table2.csv")}
    assert list(rows) == ["search, 10 ms", "hpp", "slow, mine", "six"]
    assert {label: row["most_ponds"] for label, row in rows.items()} == {
        "search, 10 ms": "80",
        "hpp": "80",
        "slow, mine": "80",
        "six": "50",
    }
    assert rows["search, 10 ms"]["growth"] == ""
    assert (rows["six"]["num_within_rules"], rows["six"]["num_plans"]) == ("0", "6")
    assert (rows["hpp"]["num_same_again"], rows["hpp"]["num_again"]) == ("2", "2")
    hpp = [runs_by_hand(report, "hpp", f"authors{size}-seed1") for size in (20, 50, 80)]
    slope = _least_squares([(math.log(runs[0].num_ponds), math.log(fmean(r.elapsed_s for r in runs))) for runs in hpp])
    assert float(rows["hpp"]["growth"]) == pytest.approx(slope)
    text = (report.folder / "report.md").read_text()
    for part, adjective in (("Optimality", "Medium"), ("Scalability", "High"), ("Practicality", "High")):
        names, _, *body = table_after(text, f"### {part}")
        cells = {row[0]: dict(zip(names, row, strict=True)) for row in body}
        assert list(cells) == list(rows)
        assert cells["hpp"]["paper"] == adjective
        assert cells["six"]["paper"] == ""
    assert cells["six"]["plans within the rules"] == "0 of 6"


def _least_squares(points: Sequence[tuple[float, float]]) -> float:
    mean_x, mean_y = fmean(x for x, _ in points), fmean(y for _, y in points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)


def test_gaps_are_to_the_best_plan_that_breaks_no_rule(report: Report) -> None:
    runs = read_results(report.folder / "results.csv")
    for row in csv_rows(report, "table1.csv"):
        planner = {method.label: method.planner for method in TINY_METHODS}[row["method"]]
        limit = "0.01 s" if planner == "search" else "none"
        gaps = []
        for run in runs_by_hand(report, planner, f"authors{row['num_ponds']}-seed1", limit):
            of_farm = [other for other in runs if other.digest == run.digest and not other.num_violations]
            best = min(other.max_route_length for other in of_farm)
            gaps.append(100 * (run.max_route_length - best) / best)
        assert float(row["gap_percent"]) == pytest.approx(fmean(gaps), abs=1e-9)


def test_points_of_the_plots(report: Report) -> None:
    points = csv_rows(report, "quality_against_time.csv")
    assert [(point["method"], point["time_limit"]) for point in points] == [
        ("search, 10 ms", "0.0001 s"),
        ("search, 10 ms", "0.01 s"),
        ("hpp", "none"),
        ("slow, mine", "none"),
        ("six", "none"),
    ]
    scaling = csv_rows(report, "scaling.csv")
    assert {(row["method"], row["num_ponds"]) for row in scaling if row["num_ponds"] == "80"} == {
        (label, "80") for label in ("search, 10 ms", "hpp", "slow, mine")
    }


def test_what_is_sampled_or_left_out_is_said(report: Report) -> None:
    text = (report.folder / "report.md").read_text()
    assert "- `slow, mine`: the first 2 of 3 farms with 20 ponds; the first 1 of 3 farms with 50 ponds\n" in text
    assert "- `ghost`: there is no planner 'ghost' (" in text
    assert "`six` in 3 of 3 at 20, 3 of 3 at 50 ponds" in text
    assert "ghost" in (report.folder / "report.html").read_text()
    text = page.markdown(Tables(_with_farm_budget(report, 0.3)))
    assert "- `slow, mine`: no farm with 20 and 50 ponds (expected to take 358 ms and more)\n" in text


def test_gaps_can_be_measured_from_plans_of_longer_runs(report: Report) -> None:
    run = runs_by_hand(report, "hpp", "authors20-seed1")[0]
    half = BestPlan(run.set_name, run.farm, run.num_routes, run.max_route_length / 2, digest=run.digest)
    tables = Tables(report.measurements, BestKnown([half]))
    assert tables.comparison.gap_percent(run) == pytest.approx(100.0)
    text = page.markdown(tables)
    assert "Gaps are to best known plans from a file, not from these runs; for" in text
    num_left = tables.comparison.num_farms - 1
    assert f"for {num_left} farms that it does not name" in text
    others = {
        other.digest: other for other in read_results(report.folder / "results.csv") if other.digest != run.digest
    }
    all_but_one = [BestPlan(o.set_name, o.farm, o.num_routes, 1.0, digest=o.digest) for o in others.values()]
    assert "for 1 farm that it does not name" in page.markdown(Tables(report.measurements, BestKnown(all_but_one)))
    assert "Gaps are to the best plan that any of these runs has for a farm." in page.markdown(report.tables)


def test_the_command_that_repeats_a_report_names_the_file_as_it_was_given() -> None:
    named = scope.FULL.with_best_known(Path("my plans") / "best.csv")
    assert named.options == " --best-known 'my plans/best.csv'"


def _with_farm_budget(report: Report, farm_budget_s: float) -> Measurements:
    """The same report, where the slow method is too slow for every farm."""
    study = report.measurements.study
    narrow = replace(study, scope=replace(study.scope, farm_budget_s=farm_budget_s))
    return execute_study(narrow, report.folder, advance=lambda _seconds: None)[0]


def test_a_finished_study_runs_nothing_and_a_cut_one_only_what_is_missing(report: Report, tmp_path: Path) -> None:
    for name in ("results.csv", "plans.jsonl"):
        (tmp_path / name).write_bytes((report.folder / name).read_bytes())
    study = report.measurements.study
    measurements, num_new = execute_study(study, tmp_path, advance=lambda _seconds: None)
    assert num_new == 0
    assert page.markdown(Tables(measurements)) == (report.folder / "report.md").read_text()
    lines = (tmp_path / "results.csv").read_text().splitlines(keepends=True)
    kept = [line for line in lines if not line.startswith("authors50-seed1,") or ",hpp," not in line]
    (tmp_path / "results.csv").write_text("".join(kept))
    measurements, num_new = execute_study(study, tmp_path, advance=lambda _seconds: None)
    assert num_new == len(lines) - len(kept) == 3
    assert Tables(measurements).scores[1].total_length == report.tables.scores[1].total_length


def test_the_expected_seconds_are_those_of_what_is_missing(report: Report, tmp_path: Path) -> None:
    study = report.measurements.study
    assert seconds_missing(study, report.folder) == 0.0
    expected_s = seconds_missing(study, tmp_path)
    told: list[float] = []
    execute_study(study, tmp_path, num_jobs=2, advance=told.append)
    runs = read_results(tmp_path / "results.csv")
    assert sum(told) == pytest.approx(
        expected_s + sum(run.time_limit_s for run in runs if run.planner.startswith("search within"))
    )
    assert len(told) == len(runs)


def test_the_time_that_search_needs(report: Report) -> None:
    rows = {(row["rival"], row["num_ponds"]): row for row in csv_rows(report, "margins.csv")}
    assert rows["slow, mine", "50"]["seconds_for_max"] == "0.01"
    assert rows["slow, mine", "50"]["seconds_for_total"] == "0.01"
    text = (report.folder / "report.md").read_text()
    _, _, *body = table_after(text, "What `search` needs")
    assert ["slow, mine", "10 ms, 10 ms", "10 ms, 10 ms"] in body


def test_search_gets_more_time_until_it_is_no_worse(tmp_path: Path) -> None:
    """Against a rival that nothing beats: `search` itself, with a hundred times the time."""
    farms = replace(TINY, num_ponds=(200,), num_farms=2, anytime_num_ponds=(), scaling_num_ponds=(), num_repeats=0)
    study = Study(replace(farms, figure_num_ponds=(200, 200)), [SEARCH, replace(LONG_SEARCH, kind="baseline")])
    measurements, _ = execute_study(study, tmp_path, num_jobs=2, advance=lambda _seconds: None)
    runs = [run for run in measurements.all_runs if run.planner == "search within search, 1 s"]
    needed = measurements.seconds_for_total(study.rivals[0], 200)
    limits = {run.time_limit_s for run in runs}
    assert limits == {limit_s for limit_s in (0.01, 0.1, 1.0) if limit_s <= (needed or 1.0)}
    (margin,) = Tables(measurements).margins
    assert margin.seconds_for_total == needed
    assert margin.seconds_for_max in (0.01, 1.0)


class _Resources(HTMLParser):
    """Collects what a page refers to."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self.tags: set[str] = set()
        self.ids: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        for name, value in attrs:
            if name in ("src", "srcset", "href", "data", "poster"):
                self.found.append(value or "")
            if name == "id":
                self.ids.add(value or "")


def test_the_html_page_needs_no_other_file(report: Report) -> None:
    text = (report.folder / "report.html").read_text()
    resources = _Resources()
    resources.feed(text)
    links = {found for found in resources.found if found.startswith("#")}
    pictures = [found for found in resources.found if not found.startswith("#")]
    assert {link.removeprefix("#") for link in links} <= resources.ids
    assert len(pictures) == 2 * len(page.PICTURES)
    assert all(picture.startswith("data:image/svg+xml;base64,") for picture in pictures)
    assert not {"script", "link", "iframe", "object"} & resources.tags
    for outside in ("http:", "https:", "url(", "@import"):
        assert outside not in text
    assert "prefers-color-scheme: dark" in text


def test_every_file_of_the_report_is_there(report: Report) -> None:
    for name in page.PICTURES:
        for tail in ("", "-dark"):
            png, svg = (report.folder / "figures" / f"{name}{tail}{suffix}" for suffix in (".png", ".svg"))
            assert png.read_bytes().startswith(b"\x89PNG")
            assert b"<svg" in svg.read_bytes()
        assert f"(figures/{name}.png)" in (report.folder / "report.md").read_text()
    for path, text in csv_files(report.tables, report.folder).items():
        assert path.read_text() == text


def test_only_baselines_may_be_missing() -> None:
    present, left_out = installed(TINY_METHODS)
    assert [method.label for method in present] == ["search, 10 ms", "hpp", "slow, mine", "six"]
    assert [method.label for method in left_out] == ["ghost"]
    with pytest.raises(InvalidInput, match="no planner 'ghost'"):
        installed([Method("ghost", "ghost", "ours")])


def test_planners_of_your_own_are_checked_before_anything_runs() -> None:
    (method,) = own_methods(["test_report:in_turn"], 700)
    assert (method.label, method.kind, method.most_ponds) == ("test_report:in_turn", "yours", 700)
    assert method.time_limit == TimeLimit()
    wrong = ["nowhere:planner", "test_report:nothing", "test_report:not_a_planner", "hpp", "a/b.py:planner"]
    with pytest.raises(InvalidInput) as caught:
        own_methods(["test_report:in_turn", "test_report:in_turn", *wrong], 700)
    assert [fault.path for fault in caught.value.faults] == [
        "planner test_report:in_turn",
        *(f"planner {name}" for name in wrong),
    ]


def test_a_missing_package_is_named_before_anything_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page, "find_spec", lambda name: None if name == "jinja2" else object())
    with pytest.raises(InvalidInput) as caught:
        page.require_packages()
    (fault,) = caught.value.faults
    assert "jinja2" in fault.message
    assert "pip install jinja2" in fault.action


def test_the_command_measures_writes_and_resumes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(scope, "QUICK", TINY)
    monkeypatch.setattr(methods, "METHODS", (SEARCH, HPP, GHOST))
    monkeypatch.setattr(page, "PICTURES", dict.fromkeys(page.PICTURES, page.PICTURES["farm"]))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine_for_the_report.py").write_text(
        "def alone(problem, seed, time_limit_s):\n    return [list(range(problem.num_ponds))]\n"
    )
    command = ["bench", "paper", "-o", "out", "--quick", "--planner", "mine_for_the_report:alone"]
    first = CliRunner().invoke(app, [*command, "--json"], catch_exceptions=False)
    answer = json.loads(first.stdout)
    assert answer["num_new_runs"] > 20
    assert [method["label"] for method in answer["left_out"]] == ["ghost"]
    assert "| mine_for_the_report:alone |" in Path("out/report.md").read_text().replace("\n| ", "| ")
    again = CliRunner().invoke(app, command, catch_exceptions=False)
    assert "0 new runs" in again.stdout
    assert "Left out: ghost" in again.stderr
    with pytest.raises(InvalidInput):
        CliRunner().invoke(app, [*command, "--planner", "no.such:planner"], catch_exceptions=False)
