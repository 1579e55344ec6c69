"""Pictures of plans, in the style of the paper's figures 2 and 3: one function per figure.

Every function draws on the axes it is given or on a figure of its own, returns the axes and shows nothing.
`save_figure` writes them.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from pondhop._core import LocalFrame, Plan, Problem, evaluate
from pondhop.palette import ROUTE_COLOURS, route_colour
from pondhop.solution import FarmPlan

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from pondhop.places import Ring

Theme = Literal["light", "dark"]
Points = NDArray[np.float64]
Cluster = tuple[Sequence[int], Sequence[int], Points]
"""Ponds, hull and path of one cluster of HPP."""

_LINE_STYLES = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (6, 1.5, 1.2, 1.5)))
_MARKERS = ("o", "s", "^", "D")
"""Line and marker change when the colours come again: 24 routes look different."""

_ARROW_EVERY = 0.09
"""Flown length between direction arrows, as a share of the diagonal of the picture."""


_MAP_SIZE_IN, _MAX_SIDE_IN = 6.5, 10.0
"""Side of a square map, and the longest side of any, in inches."""


@dataclass(frozen=True)
class Look:
    """Colours of everything but the routes."""

    background: str
    ink: str
    faint_ink: str
    water: str
    shore: str
    outline: str
    no_fly: str


LOOKS: dict[Theme, Look] = {
    "light": Look("#FFFFFF", "#1F2933", "#5F6C7B", "#DCEBF5", "#A9C4D8", "#8494A5", "#C0392B"),
    "dark": Look("#14191F", "#E8EDF2", "#9AA8B7", "#1F3342", "#3C5A70", "#71808F", "#FF6B5E"),
}
"""By theme; pages that show pictures use the same background."""


def plot_plan(farm_plan: FarmPlan, ax: Axes | None = None, *, theme: Theme = "light") -> Axes:
    """Draw a plan of a real farm: ponds, depot, areas, each drone's territory and route, with a scale bar.

    Parameters
    ----------
    farm_plan
        What to draw.
    ax
        Where to; a new figure if `None`.
    theme
        ``dark`` for reading at night.

    Returns
    -------
    Axes
        In metres east and north of the depot.
    """
    farm, solution = farm_plan.farm, farm_plan.solution
    plan = solution.plan
    frame = LocalFrame(*farm.depot)
    look = LOOKS[theme]
    outlines = [_local(frame, ring) for pond in farm.ponds for ring in pond.outline[:1]]
    fences = [_local(frame, rings[0]) for rings in farm.fences]
    zones = [_local(frame, rings[0]) for rings in farm.no_fly]
    extent = np.vstack([solution.problem.depot[None], solution.problem.ponds, *outlines, *fences, *zones])
    ax = prepared_axes(ax, extent, look)
    draw_areas(ax, outlines, facecolor=look.water, edgecolor=look.shore, linewidth=0.6, zorder=1)
    draw_areas(ax, fences, facecolor="none", edgecolor=look.outline, linewidth=1.0, linestyle="--", zorder=1)
    draw_areas(ax, zones, facecolor="none", edgecolor=look.no_fly, linewidth=1.0, hatch="////", zorder=1)
    labels = [
        f"{length:,.0f} m, {len(route)} ponds, {duration / 60:,.0f} min"
        for route, length, duration in zip(plan.routes, plan.route_lengths, plan.route_durations_s, strict=True)
    ]
    _draw_routes(ax, solution.problem, plan, labels, look)
    _draw_scale_bar(ax, look)
    parts = [
        f"{len(farm.ponds)} ponds",
        f"planner {solution.planner}",
        f"longest route {plan.max_route_length:,.0f} m",
        f"total {plan.total_length:,.0f} m",
        f"done in {plan.makespan_s / 60:,.0f} min",
    ]
    _write_title(ax, farm.name, parts, look)
    return ax


def plot_solution(
    problem: Problem,
    routes: Sequence[Sequence[int]],
    boundary: Points | None = None,
    ax: Axes | None = None,
    *,
    theme: Theme = "light",
) -> Axes:
    """Draw routes over a research farm, lengths in its own units.

    Parameters
    ----------
    problem
        Depot and ponds.
    routes
        Pond indices per route in flying order, the depot implied at both ends.
    boundary
        The farm's outline, shape (k, 2), or `None`.
    ax
        Where to; a new figure if `None`.
    theme
        ``dark`` for reading at night.

    Returns
    -------
    Axes
        In the units of the farm.

    Raises
    ------
    InvalidInput
        If a route names a pond that does not exist.
    """
    plan = evaluate(problem, routes)
    look = LOOKS[theme]
    outline = [] if boundary is None else [np.asarray(boundary, dtype=np.float64)]
    ax = prepared_axes(ax, np.vstack([problem.depot[None], problem.ponds, *outline]), look)
    draw_areas(ax, outline, facecolor="none", edgecolor=look.outline, linewidth=1.2, zorder=1)
    labels = [
        f"{length:.3f}, {len(route)} ponds" for route, length in zip(plan.routes, plan.route_lengths, strict=True)
    ]
    _draw_routes(ax, problem, plan, labels, look)
    parts = [f"longest route {plan.max_route_length:.3f}", f"total {plan.total_length:.3f}"]
    _write_title(ax, f"{problem.num_ponds} ponds, {len(plan.routes)} routes", parts, look)
    return ax


def plot_clusters(
    problem: Problem,
    clusters: Sequence[Cluster],
    boundary: Points | None = None,
    ax: Axes | None = None,
    *,
    theme: Theme = "light",
) -> Axes:
    """Draw what HPP did, as the paper's figure 2: ponds by cluster, their convex hulls and the back-and-forth paths.

    Parameters
    ----------
    problem
        Depot and ponds.
    clusters
        Per cluster the pond indices, those at the corners of the hull, and the corners of the path, shape (k, 2), as
        `pondhop._core.hpp_clusters` returns them.
    boundary
        The farm's outline, shape (k, 2), or `None`.
    ax
        Where to; a new figure if `None`.
    theme
        ``dark`` for reading at night.

    Returns
    -------
    Axes
        In the units of the farm.
    """
    look = LOOKS[theme]
    outline = [] if boundary is None else [np.asarray(boundary, dtype=np.float64)]
    paths = [path for _, _, path in clusters]
    ax = prepared_axes(ax, np.vstack([problem.depot[None], problem.ponds, *paths, *outline]), look)
    draw_areas(ax, outline, facecolor="none", edgecolor=look.outline, linewidth=1.2, zorder=1)
    for index, (ponds, hull, path) in enumerate(clusters):
        colour, cycle = route_colour(index), index // len(ROUTE_COLOURS)
        corners = problem.ponds[hull]
        draw_areas(ax, [corners], facecolor=(colour, 0.10), edgecolor=(colour, 0.6), linewidth=1.0, zorder=2)
        ax.plot(*path.T, color=colour, linewidth=1.4, linestyle=_LINE_STYLES[cycle % 4], zorder=3)
        ax.plot(
            *problem.ponds[ponds].T,
            color=colour,
            linestyle="",
            marker=_MARKERS[cycle % 4],
            markersize=_marker_size(problem),
            label=f"{index + 1}: {len(ponds)} ponds",
            zorder=4,
        )
    draw_depot(ax, problem, look)
    _write_legend(ax, look)
    _write_title(
        ax, f"{problem.num_ponds} ponds, {len(clusters)} clusters", ["convex hulls", "back-and-forth paths"], look
    )
    return ax


def save_figure(ax: Axes, path: str | os.PathLike[str]) -> None:
    """Write the figure of some axes; the same figure gives the same bytes.

    Parameters
    ----------
    ax
        As a function of this module returned them.
    path
        The file, ``.png`` or ``.svg``; missing folders are made.

    Raises
    ------
    ValueError
        If matplotlib knows no such format, or the axes belong to no figure.
    OSError
        If the file cannot be written.
    """
    import matplotlib as mpl

    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    metadata = {"Date": None} if path.suffix.lower() == ".svg" else None
    figure = ax.get_figure(root=True)
    if figure is None:
        raise ValueError("the axes belong to no figure")
    with mpl.rc_context({"svg.hashsalt": "pondhop"}):
        figure.savefig(path, dpi=160, metadata=metadata, bbox_inches="tight", pad_inches=0.2)


def prepared_axes(ax: Axes | None, extent: Points, look: Look) -> Axes:
    """Return axes of equal aspect around ``extent``, shape (n, 2); a figure of their own gets a shape that suits it."""
    (west, south), (east, north) = extent.min(axis=0), extent.max(axis=0)
    margin = 0.04 * max(east - west, north - south) or 1.0
    width, height = east - west + 2 * margin, north - south + 2 * margin
    if ax is None:
        ax = _figure_axes(width / height)
    ax.figure.set_facecolor(look.background)
    ax.set_facecolor(look.background)
    ax.set_aspect("equal", anchor="NW")
    ax.set_xlim(west - margin, east + margin)
    ax.set_ylim(south - margin, north + margin)
    ax.set_xticks([])
    ax.set_yticks([])
    ax.spines[:].set_visible(False)
    return ax


def _figure_axes(aspect: float) -> Axes:
    from matplotlib.figure import Figure

    # Legend and title stand outside; `save_figure` makes room for them.
    width, height = _MAP_SIZE_IN * np.sqrt(aspect), _MAP_SIZE_IN / np.sqrt(aspect)
    scale = min(1.0, _MAX_SIDE_IN / max(width, height))
    return Figure(figsize=(scale * width, scale * height)).add_axes((0, 0, 1, 1))


def _local(frame: LocalFrame, ring: Ring) -> Points:
    return frame.to_local(np.array(ring, dtype=np.float64))


def draw_areas(ax: Axes, rings: Sequence[Points], **style: object) -> None:
    """Fill polygons, each of shape (k, 2)."""
    from matplotlib.collections import PolyCollection

    if rings:
        ax.add_collection(PolyCollection(list(rings), **style), autolim=False)  # type: ignore[arg-type]


def _draw_routes(ax: Axes, problem: Problem, plan: Plan, labels: Sequence[str], look: Look) -> None:
    """Each route with the hull of its ponds, its number in the hull's middle, and a line in the legend."""
    diagonal = float(np.hypot(np.diff(ax.get_xlim()), np.diff(ax.get_ylim()))[0])
    marker_size = _marker_size(problem)
    for index, route in enumerate(plan.routes):
        colour, cycle = route_colour(index), index // len(ROUTE_COLOURS)
        ponds = problem.ponds[route]
        path = np.vstack([problem.depot, ponds, problem.depot])
        _draw_hull(ax, ponds, colour)
        ax.plot(*path.T, color=colour, linewidth=1.4, linestyle=_LINE_STYLES[cycle % 4], zorder=3)
        ax.plot(*ponds.T, color=colour, linestyle="", marker=_MARKERS[cycle % 4], markersize=marker_size, zorder=4)
        ax.plot(
            [],
            [],
            color=colour,
            linewidth=1.8,
            linestyle=_LINE_STYLES[cycle % 4],
            marker=_MARKERS[cycle % 4],
            markersize=5,
            label=f"{index + 1}: {labels[index]}",
        )
        _draw_arrows(ax, path, colour, _ARROW_EVERY * diagonal)
    _draw_numbers(ax, problem, plan, look)
    unserved = problem.ponds[plan.unserved]
    if len(unserved):
        ax.plot(*unserved.T, "x", color=look.no_fly, markersize=6, markeredgewidth=1.6, zorder=5, label="not visited")
    draw_depot(ax, problem, look)
    _write_legend(ax, look)


def _marker_size(problem: Problem) -> float:
    return float(np.clip(60 / np.sqrt(problem.num_ponds), 1.8, 5.0))


def draw_depot(ax: Axes, problem: Problem, look: Look) -> None:
    """Mark where drones start."""
    ax.plot(
        *problem.depot,
        color=look.ink,
        linestyle="",
        marker="s",
        markeredgecolor=look.background,
        markersize=9,
        zorder=7,
        label="depot",
    )


def _write_legend(ax: Axes, look: Look) -> None:
    ax.legend(
        loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0, frameon=False, labelcolor=look.ink, fontsize=9
    )


def _draw_hull(ax: Axes, ponds: Points, colour: str) -> None:
    import shapely

    hull = shapely.MultiPoint(ponds).convex_hull
    if isinstance(hull, shapely.Polygon):
        draw_areas(ax, [np.array(hull.exterior.coords)], facecolor=(colour, 0.10), edgecolor=(colour, 0.45), zorder=2)


def _draw_arrows(ax: Axes, path: Points, colour: str, distance: float) -> None:
    """Arrow heads on the middle of legs, at least ``distance`` of flight apart and on no leg too short for one."""
    flown = distance
    for start, end in pairwise(path):
        length = float(np.hypot(*(end - start)))
        flown += length
        if flown >= distance and length > distance / 4:
            middle = (start + end) / 2
            ahead = middle + (end - start) * 1e-3
            ax.annotate(
                "",
                xy=tuple(ahead),
                xytext=tuple(middle),
                arrowprops={"arrowstyle": "-|>", "color": colour, "mutation_scale": 9, "shrinkA": 0, "shrinkB": 0},
                zorder=5,
                annotation_clip=False,
            )
            flown = 0.0


def _draw_numbers(ax: Axes, problem: Problem, plan: Plan, look: Look) -> None:
    """Write the number of each route at the pond of it that is farthest from the depot."""
    for index, route in enumerate(plan.routes):
        ponds = problem.ponds[route]
        farthest = ponds[np.argmax(np.hypot(*(ponds - problem.depot).T))]
        ax.annotate(
            str(index + 1),
            xy=tuple(farthest),
            ha="center",
            va="center",
            fontsize=8,
            fontweight="bold",
            color=look.ink,
            bbox={"boxstyle": "circle,pad=0.25", "facecolor": look.background, "edgecolor": route_colour(index)},
            zorder=6,
        )


def _draw_scale_bar(ax: Axes, look: Look) -> None:
    """A bar of a round number of metres below the map, about a fifth of its width."""
    west, east = ax.get_xlim()
    south, north = ax.get_ylim()
    wanted_m = (east - west) / 5
    power = 10.0 ** np.floor(np.log10(wanted_m))
    length_m = max(step * power for step in (1, 2, 5) if step * power <= wanted_m)
    room = 0.07 * (north - south)
    ax.set_ylim(south - room, north)
    bar_y = south - 0.35 * room
    ax.plot([west, west + length_m], [bar_y, bar_y], color=look.ink, linewidth=2.0, solid_capstyle="butt", zorder=6)
    text = f"{length_m / 1000:g} km" if length_m >= 1000 else f"{length_m:g} m"
    gap = 0.01 * (east - west)
    ax.text(west + length_m + gap, bar_y, text, ha="left", va="center", fontsize=9, color=look.ink)


def _write_title(ax: Axes, name: str, parts: Sequence[str], look: Look) -> None:
    ax.set_title(name, loc="left", fontsize=13, fontweight="bold", color=look.ink, pad=22)
    ax.annotate(
        " · ".join(parts),
        xy=(0, 1),
        xycoords="axes fraction",
        xytext=(0, 8),
        textcoords="offset points",
        ha="left",
        va="bottom",
        fontsize=9.5,
        color=look.faint_ink,
    )
