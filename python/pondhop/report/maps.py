"""Pictures of farms and routes: the paper's figures 1b, 2 and 3."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pondhop import _core
from pondhop.palette import ROUTE_COLOURS, route_colour
from pondhop.plot import LOOKS, Look, Theme, draw_areas, draw_depot, plot_clusters, prepared_axes
from pondhop.report.scope import NUM_ROUTES, PLANNER_SEED
from pondhop.report.tables import Tables

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from pondhop.instances import ResearchFarm

_NUM_COLUMNS = 4
_PANEL_IN = 3.1
_POND_SHARE = 0.62
"""Side of a pond in the picture, as a share of the pitch: ponds have no size in the data."""


def draw_farm(tables: Tables, theme: Theme) -> Axes:
    """Draw a farm without routes: the paper's figure 1b."""
    farm = _farm(tables, tables.study.scope.figure_num_ponds[0])
    look = LOOKS[theme]
    ax = prepared_axes(None, _extent(farm), look)
    _draw_outline(ax, farm, look)
    corners = 0.5 * _POND_SHARE * (farm.spacing or 0.0) * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    squares = [pond + corners for pond in farm.ponds]
    draw_areas(ax, squares, facecolor=look.water, edgecolor=ROUTE_COLOURS[0], linewidth=0.8, zorder=2)
    draw_depot(ax, farm.to_problem(NUM_ROUTES), look)
    return ax


def draw_clusters(tables: Tables, theme: Theme) -> Axes:
    """Draw clusters, hulls and sweeps of HPP on the same farm: the paper's figure 2."""
    farm = _farm(tables, tables.study.scope.figure_num_ponds[0])
    problem = farm.to_problem(NUM_ROUTES)
    return plot_clusters(problem, _core.hpp_clusters(problem, seed=PLANNER_SEED), farm.boundary, theme=theme)


def draw_routes(tables: Tables, theme: Theme) -> Axes:
    """Draw the routes of every method on one farm side by side: the paper's figure 3."""
    from matplotlib.figure import Figure

    look = LOOKS[theme]
    num_ponds = tables.study.scope.figure_num_ponds[1]
    farm = _farm(tables, num_ponds)
    shown = [
        (method, tables.measurements.routes(request))
        for method in tables.study.shown_methods()
        for request in tables.study.pictured(method)
    ]
    num_columns = min(_NUM_COLUMNS, len(shown))
    num_rows = -(-len(shown) // num_columns)
    extent = np.ptp(_extent(farm), axis=0)
    height_in = np.clip(_PANEL_IN * extent[1] / extent[0], 1.5, 4.5) + 0.75
    figure = Figure(figsize=(num_columns * _PANEL_IN, num_rows * height_in), layout="constrained")
    panels = figure.subplots(num_rows, num_columns, squeeze=False).ravel()
    for ax in panels:
        ax.set_axis_off()
    for ax, (method, routes) in zip(panels, shown, strict=False):
        _draw_small_routes(ax, farm, routes, look)
        ax.set_title(method.label, loc="left", fontsize=11, fontweight="bold", color=look.ink, pad=18)
    first: Axes = panels[0]
    return first


def _draw_small_routes(ax: Axes, farm: ResearchFarm, routes: Sequence[Sequence[int]], look: Look) -> None:
    """Routes as coloured lines, the longest one thick, and their lengths below the title."""
    problem = farm.to_problem(NUM_ROUTES)
    plan = _core.evaluate(problem, routes)
    prepared_axes(ax, _extent(farm), look)
    _draw_outline(ax, farm, look)
    for index, route in enumerate(plan.routes):
        path = np.vstack([farm.depot, farm.ponds[route], farm.depot])
        is_longest = index == int(np.argmax(plan.route_lengths))
        ax.plot(*path.T, color=route_colour(index), linewidth=2.6 if is_longest else 1.2, zorder=3)
    ax.plot(*farm.ponds.T, color=look.ink, linestyle="", marker="o", markersize=1.8, zorder=4)
    draw_depot(ax, problem, look)
    words = f"longest {plan.max_route_length:.3f} · total {plan.total_length:.2f}"
    if len(plan.routes) != NUM_ROUTES:
        words += f" · {len(plan.routes)} route{'s' if len(plan.routes) != 1 else ''}"
    ax.annotate(
        words,
        xy=(0, 1),
        xycoords="axes fraction",
        xytext=(0, 5),
        textcoords="offset points",
        fontsize=9,
        color=look.faint_ink,
    )


def _farm(tables: Tables, num_ponds: int) -> ResearchFarm:
    return tables.study.farms[num_ponds][tables.study.scope.figure_farm].farm


def _extent(farm: ResearchFarm) -> NDArray[np.float64]:
    outline = [] if farm.boundary is None else [farm.boundary]
    return np.vstack([farm.depot[None], farm.ponds, *outline])


def _draw_outline(ax: Axes, farm: ResearchFarm, look: Look) -> None:
    if farm.boundary is not None:
        draw_areas(ax, [farm.boundary], facecolor="none", edgecolor=look.outline, linewidth=1.0, zorder=1)
