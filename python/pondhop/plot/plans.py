"""Whole pictures, one function each: a plan of a real farm, of a research farm, and what HPP did."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, get_args

import numpy as np

from pondhop._core import LocalFrame, Problem, evaluate
from pondhop.arguments import Arguments
from pondhop.palette import ROUTE_COLOURS, route_colour
from pondhop.plot.canvas import (
    Points,
    draw_areas,
    draw_areas_with_holes,
    draw_scale_bar,
    draw_wind,
    prepared_axes,
    write_legend,
    write_title,
)
from pondhop.plot.look import LOOKS, Look, Theme
from pondhop.plot.names import draw_names
from pondhop.plot.routes import (
    LINE_STYLES,
    MARKERS,
    DrawnRoute,
    draw_depot,
    draw_routes,
    draw_shading_key,
    marker_size,
    numbered_ponds,
    routes_of,
)
from pondhop.solution import PLAN_WANTED, FarmPlan
from pondhop.units import Units, counted, duration_text, energy_text, length_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from pondhop.places import Ring

Cluster = tuple[Sequence[int], Sequence[int], Points]
"""Ponds, hull and path of one cluster of HPP."""


def plot_plan(farm_plan: FarmPlan, ax: Axes | None = None, *, theme: Theme = "light", units: Units = "metric") -> Axes:
    """Draw a plan of a real farm: ponds with their names, depot, areas, routes, when each drone starts and is back.

    Parameters
    ----------
    farm_plan
        What to draw.
    ax
        Where to; a new figure if `None`.
    theme
        ``dark`` for reading at night.
    units
        Of lengths: ``metric`` or ``us``.

    Returns
    -------
    Axes
        In metres east and north of the depot.

    Raises
    ------
    InvalidInput
        With every argument that is something else.
    """
    return drawn_plan(farm_plan, ax, theme=theme, units=units)[0]


def drawn_plan(
    farm_plan: FarmPlan, ax: Axes | None = None, *, theme: Theme = "light", units: Units = "metric"
) -> tuple[Axes, frozenset[str]]:
    """Draw as `plot_plan`; return the axes, and the letters of names that no font of the machine has."""
    arguments = Arguments()
    arguments.kind("farm_plan", farm_plan, FarmPlan, PLAN_WANTED)
    _check_look(arguments, ax, theme, units)
    farm, solution = farm_plan.farm, farm_plan.solution
    frame = LocalFrame(*farm.depot)
    look = LOOKS[theme]
    are_numbered = farm_plan.fleet.swap_s is not None
    water = [[_local(frame, ring) for ring in pond.outline] for pond in farm.ponds if pond.outline]
    fences = [_local(frame, rings[0]) for rings in farm.fences]
    # As missions hold them, not as they were drawn: a crew sees what its drones are kept out of.
    zones = [[_local(frame, ring) for ring in rings] for rings in farm.kept_out]
    outer_rings = [rings[0] for rings in (*water, *zones)]
    extent = np.vstack([solution.problem.depot[None], solution.problem.ponds, *fences, *outer_rings])
    ax = prepared_axes(ax, extent, look)
    draw_areas_with_holes(ax, water, facecolor=look.water, edgecolor=look.shore, linewidth=0.6, zorder=1)
    draw_areas(
        ax, fences, facecolor="none", edgecolor=look.outline, linewidth=1.0, linestyle="--", zorder=1, label="fence"
    )
    draw_areas_with_holes(
        ax, zones, facecolor="none", edgecolor=look.no_fly, linewidth=1.0, hatch="////", zorder=1, label="no-fly zone"
    )
    routes = [
        DrawnRoute(trip.drone, f"{trip.drone + 1}" + (f".{trip.number + 1}" if are_numbered else ""), trip.ponds)
        for trip in farm_plan.trips
    ]
    labels = {trip.drone: _drone_label(farm_plan, trip.drone, units) for trip in farm_plan.trips}
    draw_routes(ax, solution.problem, routes, labels, look, farm_plan.left_out)
    draw_wind(ax, farm_plan.wind, look, units)
    draw_shading_key(ax, look, "trip" if are_numbered else "drone")
    draw_scale_bar(ax, look, units)
    numbered = numbered_ponds(solution.problem, routes)
    unwritten = draw_names(ax, solution.problem.ponds, [pond.id for pond in farm.ponds], look, numbered=numbered)
    write_legend(ax, look)
    return ax, unwritten | write_title(ax, farm.name, _facts(farm_plan, units), look)


def _drone_label(farm_plan: FarmPlan, drone: int, units: Units) -> str:
    """What the legend says of a route: ponds, length, energy, and when the drone starts and is back."""
    trips = [trip for trip in farm_plan.trips if trip.drone == drone]
    start, back = farm_plan.clock(trips[0].departure_s), farm_plan.clock(trips[-1].arrival_s)
    return ", ".join(
        [
            counted(sum(len(trip.ponds) for trip in trips), "pond"),
            *([counted(len(trips), "trip")] if farm_plan.fleet.swap_s is not None else []),
            length_text(sum(trip.length_m for trip in trips), units),
            energy_text(sum(trip.energy_j for trip in trips)),
            f"starts {start}, back {back}",
        ]
    )


def _facts(farm_plan: FarmPlan, units: Units) -> list[list[str]]:
    solution, trips = farm_plan.solution, farm_plan.trips
    lengths_m = [trip.length_m for trip in trips]
    lines = [
        [
            counted(len(farm_plan.farm.ponds), "pond"),
            counted(farm_plan.num_drones_flying, "drone"),
            f"all back after {duration_text(farm_plan.span_s)}",
            f"longest {farm_plan.trip_word} {length_text(max(lengths_m, default=0.0), units)}",
            f"total {length_text(sum(lengths_m), units)}",
        ]
    ]
    if solution.separation is not None:
        crossings = counted(solution.separation.num_crossings, "crossing")
        on_ways = solution.separation.num_depot_leg_crossings
        lines.append([f"{crossings} of routes between ponds, {on_ways} more on the ways out and home"])
    broken = [violation for violation in farm_plan.violations if violation.kind != "unserved"]
    if broken:
        lines.append([f"NOT TO BE FLOWN: {counted(len(broken), 'rule')} broken"])
    if farm_plan.left_out:
        lines.append([f"{counted(len(farm_plan.left_out), 'pond')} not sampled"])
    return lines


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
        With every argument that is something else; if a route names a pond that does not exist.
    """
    arguments = Arguments()
    outline = _checked_boundary(arguments, boundary)
    _check_look(arguments, ax, theme)
    plan = evaluate(problem, routes)
    look = LOOKS[theme]
    ax = _research_axes(problem, outline, (), ax, look)
    labels = [
        f"{length:.3f}, {counted(len(route), 'pond')}"
        for route, length in zip(plan.routes, plan.route_lengths, strict=True)
    ]
    draw_routes(ax, problem, routes_of(plan), dict(enumerate(labels)), look, plan.unserved)
    parts = [f"longest route {plan.max_route_length:.3f}", f"total {plan.total_length:.3f}"]
    write_legend(ax, look)
    title = f"{counted(problem.num_ponds, 'pond')}, {counted(len(plan.routes), 'route')}"
    write_title(ax, title, [parts], look)
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

    Raises
    ------
    InvalidInput
        With every argument that is something else.
    """
    arguments = Arguments()
    arguments.kind("problem", problem, Problem, "give a pondhop.Problem")
    outline = _checked_boundary(arguments, boundary)
    if not arguments.faults:
        _check_clusters(arguments, problem, clusters)
    _check_look(arguments, ax, theme)
    look = LOOKS[theme]
    ax = _research_axes(problem, outline, [path for _, _, path in clusters], ax, look)
    for index, (ponds, hull, path) in enumerate(clusters):
        colour, cycle = route_colour(index), index // len(ROUTE_COLOURS)
        corners = problem.ponds[hull]
        draw_areas(ax, [corners], facecolor=(colour, 0.10), edgecolor=(colour, 0.6), linewidth=1.0, zorder=2)
        ax.plot(*path.T, color=colour, linewidth=1.4, linestyle=LINE_STYLES[cycle % 4], zorder=3)
        ax.plot(
            *problem.ponds[ponds].T,
            color=colour,
            linestyle="",
            marker=MARKERS[cycle % 4],
            markersize=marker_size(problem),
            label=f"{index + 1}: {counted(len(ponds), 'pond')}",
            zorder=4,
        )
    draw_depot(ax, problem, look)
    write_legend(ax, look)
    title = f"{counted(problem.num_ponds, 'pond')}, {counted(len(clusters), 'cluster')}"
    write_title(ax, title, [["convex hulls", "back-and-forth paths"]], look)
    return ax


def _check_look(arguments: Arguments, ax: object, theme: object, units: object = "metric") -> None:
    """Raise what is wrong with the arguments so far, and with those that all pictures share."""
    if ax is not None:
        from matplotlib.axes import Axes

        arguments.kind("ax", ax, Axes, "give axes of matplotlib, or leave them out")
    arguments.one_of("theme", theme, get_args(Theme))
    arguments.one_of("units", units, get_args(Units))
    arguments.check()


def _checked_boundary(arguments: Arguments, boundary: object) -> list[Points]:
    """Return the outline of a research farm, or none."""
    is_none = boundary is None or not arguments.positions("boundary", boundary)
    return [] if is_none else [np.asarray(boundary, dtype=np.float64)]


def _check_clusters(arguments: Arguments, problem: Problem, clusters: object) -> None:
    action = "give ponds, hull and path of each cluster, as pondhop._core.hpp_clusters returns them"
    kind: type[tuple[object, ...]] = tuple
    for index, cluster in enumerate(arguments.all_kind("clusters", clusters, kind, action)):
        if len(cluster) != 3:
            arguments.refuse(f"clusters[{index}]", cluster, action)
            continue
        for name, ponds in (("ponds", cluster[0]), ("hull", cluster[1])):
            arguments.indices(f"clusters[{index}], {name}", ponds, problem.num_ponds)
        arguments.positions(f"clusters[{index}], path", cluster[2])


def _research_axes(
    problem: Problem, outline: Sequence[Points], paths: Sequence[Points], ax: Axes | None, look: Look
) -> Axes:
    """Return axes with room for a research farm and paths over it; its outline is drawn."""
    ax = prepared_axes(ax, np.vstack([problem.depot[None], problem.ponds, *paths, *outline]), look)
    draw_areas(ax, outline, facecolor="none", edgecolor=look.outline, linewidth=1.2, zorder=1)
    return ax


def _local(frame: LocalFrame, ring: Ring) -> Points:
    return frame.to_local(np.array(ring, dtype=np.float64))
