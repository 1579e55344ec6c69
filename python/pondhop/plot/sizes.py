"""How many drones a round needs, as a curve."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from pondhop.fleet import Fleet
from pondhop.nights import Size
from pondhop.palette import route_colour
from pondhop.plot.canvas import write_title
from pondhop.plot.look import LOOKS, Theme

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_MOST_MINUTES_S = 7200.0
"""Longer rounds are told in hours."""


def plot_sizes(
    sizes: Sequence[Size], fleet: Fleet, name: str, ax: Axes | None = None, *, theme: Theme = "light"
) -> Axes:
    """Draw when the last drone is back by the number of drones; hollow points leave ponds out.

    Parameters
    ----------
    sizes
        As `pondhop.nights.sizes` found them.
    fleet
        Whose end is drawn as a line.
    name
        Of the farm, for the title.
    ax
        Where to; a new figure if `None`.
    theme
        ``dark`` for reading at night.

    Returns
    -------
    Axes
        Drones to the right, minutes or hours up.
    """
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    look = LOOKS[theme]
    if ax is None:
        ax = Figure(figsize=(8.0, 4.5)).add_axes((0.1, 0.14, 0.87, 0.72))
    ax.figure.set_facecolor(look.background)
    ax.set_facecolor(look.background)
    colour = route_colour(0)
    most_s = max((size.all_back_s for size in sizes), default=0.0)
    unit_s, unit = (3600.0, "hours") if most_s > _MOST_MINUTES_S else (60.0, "minutes")
    enough = [size for size in sizes if size.is_enough]
    short = [size for size in sizes if not size.is_enough]
    ax.plot(
        [size.num_drones for size in enough],
        [size.all_back_s / unit_s for size in enough],
        "o-",
        color=colour,
        label="all ponds sampled",
    )
    if short:
        ax.plot(
            [size.num_drones for size in short],
            [size.all_back_s / unit_s for size in short],
            "o",
            markerfacecolor="none",
            color=look.no_fly,
            label="ponds left out",
        )
    for size in short:
        told = f"{size.num_unserved} left out" + (", proven" if size.is_proven_too_few else "")
        ax.annotate(
            told,
            (size.num_drones, size.all_back_s / unit_s),
            xytext=(0, -14),
            textcoords="offset points",
            ha="center",
            fontsize=8,
            color=look.faint_ink,
        )
    if math.isfinite(fleet.span_s):
        ax.axhline(fleet.span_s / unit_s, color=look.no_fly, linestyle="--", linewidth=1.0, label=f"end {fleet.end}")
    ax.margins(x=0.12, y=0.15)
    ax.set_ylim(0.0, None)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set_xlabel("drones", color=look.ink)
    ax.set_ylabel(f"{unit} until the last is back", color=look.ink)
    ax.tick_params(colors=look.ink)
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines[["left", "bottom"]].set_color(look.faint_ink)
    ax.grid(color=look.faint_ink, alpha=0.25, linewidth=0.6)
    legend = ax.legend(frameon=False, fontsize=9)
    for text in legend.get_texts():
        text.set_color(look.ink)
    write_title(ax, name, [["how many drones the round needs"]], look)
    return ax
