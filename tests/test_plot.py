from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from hand_made import DEPOT, make_farm, make_plan, square, two_drones
from pondhop import InvalidInput, Problem, _core, evaluate, missions
from pondhop.farm import Pond, read_farm
from pondhop.fleet import Fleet
from pondhop.palette import ROUTE_COLOURS
from pondhop.units import clock_text

pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install matplotlib")

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


def test_the_legend_tells_each_routes_length_energy_and_times() -> None:
    farm_plan = two_drones()
    ax = plot_plan(farm_plan)
    plan, interval_s = farm_plan.plan, farm_plan.fleet.takeoff_interval_s
    lengths, durations, energies = plan.route_lengths, plan.route_durations_s, plan.route_energies_j
    assert set(legend_texts(ax)) == {
        f"1: 3 ponds, {lengths[0]:.0f} m, {energies[0] / 3600:.1f} Wh, starts 0:00, back {clock_text(durations[0])}",
        f"2: 2 ponds, {lengths[1]:.0f} m, {energies[1] / 3600:.1f} Wh, starts 0:{interval_s:02.0f}, "
        f"back {clock_text(interval_s + durations[1])}",
        "fence",
        "depot",
        "shaded: around the ponds of one drone",
    }
    assert ax.get_title(loc="left") == "Test farm"
    # In metres: 0.001 degrees of latitude north are 111 m.
    routes = [line for line in ax.lines if len(line.get_xdata()) == 5]  # type: ignore[arg-type]
    assert np.max(np.asarray(routes[0].get_ydata())) == pytest.approx(111, abs=0.2)


def test_the_scale_bar_is_as_long_as_it_says() -> None:
    for units, ending, metres in (("metric", "200 m", 200.0), ("us", "1000 ft", 304.8)):
        ax = plot_plan(two_drones(), units=units)  # type: ignore[arg-type]
        texts = [text.get_text() for text in ax.texts]
        assert ending in texts
        assert "N" in texts
        (bar,) = [np.asarray(line.get_xydata()) for line in ax.lines if line.get_linewidth() == 2]
        assert bar[1] - bar[0] == pytest.approx([metres, 0])


def test_ponds_are_named_where_there_is_room() -> None:
    farm_plan = two_drones()
    texts = [text.get_text() for text in plot_plan(farm_plan).texts]
    assert {"P0", "P1", "P2", "P3", "P4"} <= set(texts)
    ponds = tuple(Pond(f"Pond {i}", (-89.0 + 1e-7 * i, 37.001)) for i in range(50))
    crowded = make_plan(make_farm(ponds=(*ponds, Pond("Far", (-88.99, 37.005)))), Fleet(1), [list(range(51))])
    named = [text.get_text() for text in plot_plan(crowded).texts if text.get_text().startswith(("Pond", "Far"))]
    assert named == ["Far"]


@pytest.mark.parametrize(
    "name", ["$x^", "[bold]", "a_b $\\frac$ {", "塘 1", "บ่อ 1", "بركة", "\udcff", "🐟 \u202e1", "line\nend"]
)
def test_any_name_is_drawn_without_a_warning(tmp_path: Path, name: str) -> None:
    farm = make_farm(name=name, ponds=tuple(replace(pond, id=name + pond.id) for pond in make_farm().ponds))
    save_figure(plot_plan(make_plan(farm, Fleet(1), [[0, 1, 2, 3, 4]])), tmp_path / "plan.png")
    save_figure(plot_plan(make_plan(farm, Fleet(1), [[0, 1, 2, 3, 4]])), tmp_path / "plan.svg")


def test_unserved_ponds_and_no_fly_zones_are_drawn() -> None:
    farm = make_farm(no_fly=((square(-89.005, 36.995, 0.001),),))
    ax = plot_plan(make_plan(farm, Fleet(num_drones=1), [[0, 1, 2, 3]]), theme="dark")
    assert "not visited" in legend_texts(ax)
    assert any(collection.get_hatch() for collection in ax.collections)


def told(ax: Axes) -> str:
    return "\n".join(text.get_text() for text in ax.texts)


def test_a_plan_that_breaks_a_rule_of_the_farm_is_not_to_be_flown() -> None:
    # A zone in the way breaks no rule of the routes themselves: only the farm knows of it.
    farm = make_farm(no_fly=((square(-89.0015, 37.001, 0.0002),),))
    plan = make_plan(farm, Fleet(num_drones=1), [[0, 1, 2, 3, 4]])
    assert plan.plan.is_feasible
    assert "NOT TO BE FLOWN: 1 rule broken" in told(plot_plan(missions.judged(plan)))
    unserved = make_plan(farm, Fleet(num_drones=1), [[0, 1, 2, 3]])
    assert "NOT TO BE FLOWN: 1 rule broken" in told(plot_plan(missions.judged(unserved)))
    assert "NOT TO BE FLOWN" not in told(plot_plan(two_drones()))


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
    assert len(legend_texts(ax)) == 5


def test_importing_plot_loads_no_matplotlib() -> None:
    command = "import sys, pondhop.plot; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", command], check=False).returncode == 0


def test_holes_of_areas_are_drawn_as_they_are_flown() -> None:
    from matplotlib.collections import PolyCollection

    island = square(-89.002, 37.001, 0.0001)
    zones = ((square(*DEPOT, 0.008), square(*DEPOT, 0.004)), (square(-89.02, 37.0, 0.002), square(-89.02, 37.0, 0.001)))
    farm = make_farm(no_fly=zones, fences=((square(*DEPOT, 0.01), square(-89.005, 37.006, 0.001)),))
    first, *others = farm.ponds
    farm = replace(farm, ponds=(replace(first, outline=(*first.outline, island)), *others))
    ax = plot_plan(make_plan(farm, Fleet(num_drones=1), [[0, 1, 2, 3, 4]]))
    areas = {item.get_label(): item for item in ax.collections if isinstance(item, PolyCollection)}
    # Five corners a ring, and one more that closes it: a ring with its hole, a zone without, and the hole of the fence.
    assert [len(path) for path in areas["no-fly zone"].get_paths()] == [12, 6, 6]
    assert [len(path) for path in areas["fence"].get_paths()] == [6]
    water = next(item for item in ax.collections if isinstance(item, PolyCollection))
    assert [len(path) for path in water.get_paths()] == [12, 6, 6, 6, 6]
    corners = np.asarray(water.get_paths()[0].vertices)
    assert [float(np.linalg.det(ring[[1, 2]] - ring[0])) > 0.0 for ring in (corners[:6], corners[6:])] == [True, False]


@pytest.mark.parametrize(
    ("name", "shown"), [("x" * 61, "x" * 60 + "…"), ("鱼" * 31, "鱼" * 30 + "…"), ("x" * 60, "x" * 60)]
)
def test_a_long_name_leaves_the_picture_its_width(name: str, shown: str) -> None:
    farm_plan = two_drones()
    title = plot_plan(replace(farm_plan, farm=replace(farm_plan.farm, name=name))).get_title(loc="left")
    # Without a font for it, a letter is replaced by one.
    assert title == shown or title == f"{'?' * (len(shown) - 1)}…"
