from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from hand_made import make_farm, make_plan, square, two_drones
from pondhop import InvalidInput, Problem, _core, evaluate
from pondhop.farm import read_farm
from pondhop.fleet import Fleet
from pondhop.palette import ROUTE_COLOURS

pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install pondhop[plot]")

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pondhop.plot import plot_clusters, plot_plan, plot_solution, save_figure

FARMS = Path(__file__).parents[1] / ".." / "shared" / "data" / "farms"


def legend_texts(ax: Axes) -> list[str]:
    legend = ax.get_legend()
    assert legend is not None
    return [text.get_text() for text in legend.get_texts()]


def sectors(problem: Problem, num_routes: int) -> list[list[int]]:
    """Ponds in the order of their bearing from the depot, cut into equal parts."""
    bearings = np.arctan2(*(problem.ponds - problem.depot).T)
    return [part.tolist() for part in np.array_split(np.argsort(bearings, kind="stable"), num_routes)]


def grid(num_ponds_per_side: int) -> Problem:
    side = np.arange(num_ponds_per_side, dtype=np.float64)
    return Problem((0.0, 0.0), np.array([(x, y) for x in side for y in side]), 24)


def test_the_legend_tells_each_routes_length_and_time() -> None:
    farm_plan = two_drones()
    ax = plot_plan(farm_plan)
    lengths, durations = farm_plan.solution.plan.route_lengths, farm_plan.solution.plan.route_durations_s
    assert legend_texts(ax) == [
        f"1: {lengths[0]:,.0f} m, 3 ponds, {durations[0] / 60:.0f} min",
        f"2: {lengths[1]:,.0f} m, 2 ponds, {durations[1] / 60:.0f} min",
        "depot",
    ]
    assert ax.get_title(loc="left") == "Test farm"
    # In metres: 0.001 degrees of latitude north are 111 m.
    routes = [line for line in ax.lines if len(line.get_xdata()) == 5]  # type: ignore[arg-type]
    assert np.max(np.asarray(routes[0].get_ydata())) == pytest.approx(111, abs=0.2)


def test_the_scale_bar_is_as_long_as_it_says() -> None:
    ax = plot_plan(two_drones())
    (text,) = [text for text in ax.texts if text.get_text().endswith((" m", " km"))]
    assert text.get_text() == "200 m"
    (bar,) = [np.asarray(line.get_xydata()) for line in ax.lines if line.get_linewidth() == 2]
    assert bar[1] - bar[0] == pytest.approx([200, 0])


def test_unserved_ponds_and_no_fly_zones_are_drawn() -> None:
    farm = make_farm(no_fly=((square(-89.005, 36.995, 0.001),),))
    ax = plot_plan(make_plan(farm, Fleet(num_drones=1), [[0, 1, 2, 3]]), theme="dark")
    assert "not visited" in legend_texts(ax)
    assert any(collection.get_hatch() for collection in ax.collections)


def test_twenty_four_routes_look_different() -> None:
    problem = grid(10)
    ax = plot_solution(problem, sectors(problem, 24))
    legend = ax.get_legend()
    assert legend is not None
    lines = [line for line in legend.legend_handles if isinstance(line, Line2D)][:24]
    looks = {(line.get_color(), str(line.get_linestyle()), str(line.get_marker())) for line in lines}
    assert len({(colour, marker) for colour, _style, marker in looks}) == 24
    assert {line.get_color() for line in lines} == set(ROUTE_COLOURS)


def test_a_figure_is_drawn_on_the_axes_given() -> None:
    ax = Figure().add_subplot()
    problem = grid(3)
    boundary = np.array([(-1.0, -1.0), (3.0, -1.0), (3.0, 3.0), (-1.0, 3.0)])
    assert plot_solution(problem, sectors(problem, 2), boundary, ax) is ax
    assert ax.get_aspect() == 1.0
    plan = evaluate(problem, sectors(problem, 2))
    assert legend_texts(ax)[0] == f"1: {plan.route_lengths[0]:.3f}, 5 ponds"


def test_clusters_are_drawn_with_hulls_and_paths() -> None:
    depot, ponds, boundary, _ = _core.generate(100, 1)
    problem = Problem(depot, ponds, 5)
    clusters = _core.hpp_clusters(problem)
    ax = plot_clusters(problem, clusters, boundary)
    assert legend_texts(ax) == [f"{n}: {len(route)} ponds" for n, (route, _, _) in enumerate(clusters, 1)] + ["depot"]
    # Each path is a line of its own, and with the outline there is an area for each hull.
    drawn = [np.asarray(line.get_xydata()) for line in ax.lines]
    for route, _, path in clusters:
        assert any(np.array_equal(path, line) for line in drawn)
        assert any(np.array_equal(ponds[route], line) for line in drawn)
    assert len(ax.collections) == 1 + len(clusters)


@pytest.mark.parametrize("positions", [[(0.0, 0.0)], [(0.0, 0.0)] * 3, [(1.0, 0.0), (2.0, 0.0), (900.0, 0.0)]])
def test_degenerate_farms_are_drawn(tmp_path: Path, positions: list[tuple[float, float]]) -> None:
    problem = Problem((0.0, 0.0), np.array(positions), 2)
    save_figure(plot_solution(problem, [list(range(len(positions)))]), tmp_path / "plan.png")
    assert (tmp_path / "plan.png").read_bytes().startswith(b"\x89PNG")


def test_a_route_to_nowhere_is_refused() -> None:
    with pytest.raises(InvalidInput):
        plot_solution(grid(2), [[4]])


def test_the_same_plan_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("first", "second"):
        for suffix in ("svg", "png"):
            save_figure(plot_plan(two_drones()), tmp_path / name / f"plan.{suffix}")
    for suffix in ("svg", "png"):
        first, second = (tmp_path / name / f"plan.{suffix}" for name in ("first", "second"))
        assert first.read_bytes() == second.read_bytes()
    root = ET.parse(tmp_path / "first" / "plan.svg").getroot()
    assert root.tag.endswith("svg")
    assert not root.findall(".//{http://purl.org/dc/elements/1.1/}date")


def test_nothing_is_cut_off(tmp_path: Path) -> None:
    """The legend of long lines lies wholly inside the picture: its last columns are background."""
    from matplotlib.image import imread

    save_figure(plot_plan(two_drones()), tmp_path / "plan.png")
    image = imread(tmp_path / "plan.png")
    for edge in (image[0], image[-1], image[:, 0], image[:, -1]):
        assert np.all(edge[:, :3] == 1)


def test_a_real_farm_is_drawn(tmp_path: Path) -> None:
    path = FARMS / "lh_farm_illinois.geojson"
    if not path.exists():
        pytest.skip(f"there is no {path}: the shared data is not part of the repository")
    farm = read_farm(path, depot=(-89.463, 37.7055))
    fleet = Fleet(num_drones=3)
    ax = plot_plan(make_plan(farm, fleet, sectors(farm.to_problem(fleet), 3)))
    save_figure(ax, tmp_path / "plan.svg")
    assert len(legend_texts(ax)) == 4


def test_importing_plot_loads_no_matplotlib() -> None:
    command = "import sys, pondhop.plot; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", command], check=False).returncode == 0
