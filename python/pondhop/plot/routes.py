"""Routes on a map: lines, hulls, arrows, numbers, names of ponds and the legend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from pondhop._core import Plan, Problem
from pondhop.palette import ROUTE_COLOURS, route_colour
from pondhop.plot.canvas import Points, draw_areas
from pondhop.plot.look import Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LINE_STYLES = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (6, 1.5, 1.2, 1.5)))
MARKERS = ("o", "s", "^", "D")
"""Line and marker change when the colours come again: 24 routes look different."""

_ARROW_EVERY = 0.09
"""Flown length between direction arrows, as a share of the diagonal of the picture."""


@dataclass(frozen=True)
class DrawnRoute:
    """What one drone flies without a stop at the depot.

    Attributes
    ----------
    drone
        Whose it is, from 0; it says the colour.
    number
        What stands at its farthest pond.
    ponds
        Indices in flying order.
    """

    drone: int
    number: str
    ponds: Sequence[int]


def routes_of(plan: Plan) -> list[DrawnRoute]:
    """Return the routes of a plan, one a drone."""
    return [DrawnRoute(index, str(index + 1), route) for index, route in enumerate(plan.routes)]


def draw_routes(
    ax: Axes,
    problem: Problem,
    routes: Sequence[DrawnRoute],
    labels: Mapping[int, str],
    look: Look,
    unserved: Sequence[int] = (),
) -> None:
    """Draw each route with the hull of its ponds, its number at its farthest pond, and a line a drone in the legend."""
    diagonal = float(np.hypot(np.diff(ax.get_xlim()), np.diff(ax.get_ylim()))[0])
    size = marker_size(problem)
    told = set[int]()
    for route in routes:
        colour, cycle = route_colour(route.drone), route.drone // len(ROUTE_COLOURS)
        style, marker = LINE_STYLES[cycle % 4], MARKERS[cycle % 4]
        ponds = problem.ponds[list(route.ponds)]
        path = np.vstack([problem.depot, ponds, problem.depot])
        _draw_hull(ax, ponds, colour)
        ax.plot(*path.T, color=colour, linewidth=1.4, linestyle=style, zorder=3)
        ax.plot(*ponds.T, color=colour, linestyle="", marker=marker, markersize=size, zorder=4)
        if route.drone not in told:
            told.add(route.drone)
            label = f"{route.drone + 1}: {labels[route.drone]}"
            ax.plot([], [], color=colour, linewidth=1.8, linestyle=style, marker=marker, markersize=5, label=label)
        _draw_arrows(ax, path, colour, _ARROW_EVERY * diagonal)
    _draw_numbers(ax, problem, routes, look)
    if len(unserved):
        ax.plot(
            *problem.ponds[list(unserved)].T,
            "x",
            color=look.no_fly,
            markersize=6,
            markeredgewidth=1.6,
            zorder=5,
            label="not visited",
        )
    draw_depot(ax, problem, look)


def numbered_ponds(problem: Problem, routes: Sequence[DrawnRoute]) -> list[int]:
    """Return the pond of each route that is farthest from the depot: its number stands there."""
    distances = np.hypot(*(problem.ponds - problem.depot).T)
    return [max(route.ponds, key=lambda pond: float(distances[pond])) for route in routes]


def draw_shading_key(ax: Axes, look: Look, whose: str) -> None:
    """Say in the legend what the shaded areas are."""
    label = f"shaded: around the ponds of one {whose}"
    ax.fill([], [], facecolor=(look.faint_ink, 0.15), edgecolor=(look.faint_ink, 0.5), label=label)


def marker_size(problem: Problem) -> float:
    """Return the size of a pond's marker in points, smaller where there are more ponds."""
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


def _draw_numbers(ax: Axes, problem: Problem, routes: Sequence[DrawnRoute], look: Look) -> None:
    """Write the number of each route at the pond of it that is farthest from the depot."""
    for route, pond in zip(routes, numbered_ponds(problem, routes), strict=True):
        ax.annotate(
            route.number,
            xy=tuple(problem.ponds[pond]),
            ha="center",
            va="center",
            fontsize=8,
            fontweight="bold",
            color=look.ink,
            bbox={"boxstyle": "circle,pad=0.25", "facecolor": look.background, "edgecolor": route_colour(route.drone)},
            zorder=6,
        )
