"""The night as a picture: a row a drone, its trips, swaps and waits over the clock, and what its batteries hold."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pondhop.arguments import Arguments
from pondhop.fleet.clock import seconds_of_day
from pondhop.palette import route_colour
from pondhop.plot.canvas import write_title
from pondhop.plot.look import LOOKS, Look, Theme
from pondhop.solution import PLAN_WANTED, FarmPlan
from pondhop.trips import Trip
from pondhop.units import JOULES_PER_WATT_HOUR, counted, duration_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TICKS, _MOST_TICKS = (1, 2, 5, 10, 15, 20, 30, 60, 120, 180, 360, 720), 12
"""Minutes between two marks of the clock, and how many marks there are at most."""

_ROW = 0.82
"""Height of a drone's row, as a share of the distance between two rows: a full battery."""


def plot_night(farm_plan: FarmPlan, ax: Axes | None = None, *, theme: Theme = "light") -> Axes:
    """Draw the trips of a round over its time, a row a drone.

    The height of a trip is what is left in its battery, a full row a full one; the dashed line is the reserve, the thin
    line what the drone needs above it to be home from where it is. Where nobody knows the battery, trips are bars.

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
        Minutes after the start of the round to the right.

    Raises
    ------
    InvalidInput
        With every argument that is something else.
    """
    arguments = Arguments()
    arguments.kind("farm_plan", farm_plan, FarmPlan, PLAN_WANTED)
    arguments.one_of("theme", theme, tuple(LOOKS))
    arguments.check()
    look = LOOKS[theme]
    drones = sorted({trip.drone for trip in farm_plan.trips})
    ax = _axes(ax, len(drones), look)
    for row, drone in enumerate(drones):
        own = [trip for trip in farm_plan.trips if trip.drone == drone]
        _draw_drone(ax, farm_plan, own, -float(row), look)
    ax.set_ylim(-len(drones) + 0.9, 1.0)
    first = min((trip.departure_s for trip in farm_plan.trips), default=0.0) / 60
    last = farm_plan.all_back_s / 60
    ax.set_xlim(first, max(first + 1.0, last + 0.01 * (last - first)))
    ax.set_yticks([_ROW / 2 - row for row in range(len(drones))], [f"drone {drone + 1}" for drone in drones])
    _label_clock(ax, farm_plan, look)
    _write_key(ax, farm_plan, look)
    facts = [
        counted(len(farm_plan.trips), farm_plan.trip_word),
        counted(len(drones), "drone"),
        f"all back after {duration_text(farm_plan.span_s)}",
        farm_plan.wind.told(),
    ]
    write_title(ax, farm_plan.farm.name, [facts], look)
    return ax


def _axes(ax: Axes | None, num_rows: int, look: Look) -> Axes:
    if ax is None:
        from matplotlib.figure import Figure

        ax = Figure(figsize=(11.0, 1.6 + 0.8 * min(num_rows, 40))).add_axes((0.08, 0.16, 0.9, 0.72))
    ax.figure.set_facecolor(look.background)
    ax.set_facecolor(look.background)
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.spines["bottom"].set_color(look.faint_ink)
    ax.tick_params(colors=look.ink, left=False)
    return ax


def _draw_drone(ax: Axes, farm_plan: FarmPlan, trips: Sequence[Trip], base: float, look: Look) -> None:
    fleet, colour = farm_plan.fleet, route_colour(trips[0].drone)
    full_j = None
    if fleet.battery_wh is not None:
        full_j = fleet.battery_wh * JOULES_PER_WATT_HOUR * fleet.health_percent / 100
    for trip in trips:
        minutes, left = _battery(trip, full_j)
        ax.fill_between(minutes, base, base + _ROW * left, color=colour, alpha=0.35, linewidth=0, zorder=2)
        ax.plot(minutes, base + _ROW * left, color=colour, linewidth=1.4, zorder=3)
        middle = (trip.departure_s + trip.arrival_s) / 120
        text = f"{trip.number + 1}: {len(trip.ponds)}" if fleet.swap_s is not None else f"{len(trip.ponds)}"
        ax.text(middle, base + 0.05, text, ha="center", va="bottom", fontsize=8, color=look.ink, zorder=6)
        if full_j is not None:
            needed = fleet.reserve_percent / 100 + trip.energies_j[:, 1] / full_j
            ax.plot(trip.times_s[:, 2] / 60, base + _ROW * needed, color=look.ink, linewidth=0.8, zorder=4)
        for arrival_s, start_s, _ in trip.times_s:
            if start_s - arrival_s > 1.0:
                ax.plot([arrival_s / 60, start_s / 60], [base, base], color=look.ink, linewidth=3.0, zorder=5)
        if trip.ready_s > trip.arrival_s and fleet.swap_s is not None:
            # Before the swap a drone may wait for its place.
            ax.fill_between(
                [(trip.ready_s - fleet.swap_s) / 60, trip.ready_s / 60],
                base,
                base + 0.3 * _ROW,
                facecolor="none",
                edgecolor=look.faint_ink,
                hatch="////",
                linewidth=0.6,
                zorder=1,
            )
    for trip in trips if full_j is not None else ():
        level = base + _ROW * fleet.reserve_percent / 100
        ends = [trip.departure_s / 60, trip.arrival_s / 60]
        ax.plot(ends, [level, level], color=look.no_fly, linewidth=0.9, linestyle="--", zorder=4)


def _battery(trip: Trip, full_j: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Return when a trip takes off, leaves each pond and lands, in minutes, and the share of the battery left then."""
    minutes = np.array([trip.departure_s, *trip.times_s[:, 2], trip.arrival_s]) / 60
    if full_j is None:
        return minutes, np.ones(len(minutes))
    used_j = np.array([0.0, *trip.energies_j[:, 0], trip.energy_j])
    return minutes, np.maximum(0.0, 1.0 - used_j / full_j)


def _label_clock(ax: Axes, farm_plan: FarmPlan, look: Look) -> None:
    """Write clock times where the start is known, else the time after it."""
    from matplotlib.ticker import FixedLocator, FuncFormatter

    def told(minutes: float, _position: int) -> str:
        clock = farm_plan.clock(60 * minutes)
        return clock[:5] if farm_plan.fleet.start is not None else clock

    start = farm_plan.fleet.start
    past_midnight = 0.0 if start is None else seconds_of_day(start) / 60
    first, last = past_midnight + ax.get_xlim()[0], past_midnight + ax.get_xlim()[1]
    step = next((step for step in _TICKS if (last - first) / step <= _MOST_TICKS), _TICKS[-1])
    ticks = np.arange(math.ceil(first / step), math.floor(last / step) + 1) * step - past_midnight
    ax.xaxis.set_major_locator(FixedLocator(list(ticks)))
    ax.xaxis.set_major_formatter(FuncFormatter(told))
    ax.grid(axis="x", color=look.faint_ink, alpha=0.25, linewidth=0.6)
    ax.set_axisbelow(True)


def _write_key(ax: Axes, farm_plan: FarmPlan, look: Look) -> None:
    """Say below the picture what its lines are, in the order in which they matter."""
    parts = ["number of the trip: its ponds"] if farm_plan.fleet.swap_s is not None else ["ponds of the route"]
    if farm_plan.fleet.battery_wh is not None:
        parts += [
            "height: battery left",
            "dashed: reserve",
            "thin line: reserve and way home, which the battery must stay above",
        ]
    if farm_plan.fleet.swap_s is not None:
        parts.append("hatched: battery changed")
    if any(trip.waits_s > 1.0 for trip in farm_plan.trips):
        parts.append("thick line: waiting in the air")
    ax.annotate(
        " · ".join(parts),
        xy=(0, 0),
        xycoords="axes fraction",
        xytext=(0, -30),
        textcoords="offset points",
        ha="left",
        va="top",
        fontsize=8.5,
        color=look.faint_ink,
    )
