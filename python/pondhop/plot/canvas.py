"""The sheet that a plan is drawn on: axes of equal aspect, areas, scale, north, title and legend; and its file."""

from __future__ import annotations

import io
import os
import unicodedata
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pondhop.arguments import Arguments, checked_path
from pondhop.documents.atomic import write_all
from pondhop.errors import Fault, InvalidInput
from pondhop.fleet import Wind
from pondhop.plot.fonts import lettering
from pondhop.plot.look import Look
from pondhop.units import METRES_PER_FOOT, METRES_PER_MILE, Units, speed_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Points = NDArray[np.float64]
"""Positions, shape (n, 2)."""

_MAP_SIZE_IN, _MAX_SIDE_IN = 6.5, 10.0
"""Side of a square map, and the longest side of any, in inches."""

MAX_TITLE_WIDTH = 60
"""Latin letters of a title that are about as wide as a square map."""


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
    InvalidInput
        If `ax` is something else or belongs to no figure, or matplotlib knows no such format.
    OSError
        If the file cannot be written.
    """
    path = checked_path("path", path)
    write_all({path: figure_bytes(ax, path.suffix.lower().removeprefix("."))})


def figure_bytes(ax: Axes, kind: str) -> bytes:
    """Return the picture of some axes as the content of a file; the same figure gives the same bytes.

    Parameters
    ----------
    ax
        As a function of this package returned them.
    kind
        ``png`` or ``svg``.

    Raises
    ------
    InvalidInput
        If `ax` is something else or belongs to no figure, or matplotlib knows no such format.
    """
    import matplotlib as mpl
    from matplotlib.axes import Axes

    arguments = Arguments()
    figure = None
    if arguments.kind("ax", ax, Axes, "give axes as a function of pondhop.plot returned them"):
        figure = ax.get_figure(root=True)
        if figure is None:
            arguments.faults.append(Fault("ax", "the axes belong to no figure", "give axes of a figure"))
        else:
            arguments.one_of("kind", kind, tuple(figure.canvas.get_supported_filetypes()))
    if figure is None or arguments.faults:
        raise InvalidInput(arguments.faults)
    metadata = {"Date": None} if kind == "svg" else None
    content = io.BytesIO()
    with mpl.rc_context({"svg.hashsalt": "pondhop"}):
        figure.savefig(content, format=kind, dpi=160, metadata=metadata, bbox_inches="tight", pad_inches=0.2)
    return content.getvalue()


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


def draw_areas(ax: Axes, rings: Sequence[Points], **style: object) -> None:
    """Fill polygons, each of shape (k, 2)."""
    draw_areas_with_holes(ax, [[ring] for ring in rings], **style)


def draw_areas_with_holes(ax: Axes, areas: Sequence[Sequence[Points]], **style: object) -> None:
    """Fill polygons, each of rings of shape (k, 2): the outer one, then holes, which stay blank."""
    from matplotlib.collections import PolyCollection
    from matplotlib.path import Path

    if not areas:
        return
    corners, codes = [], []
    for rings in areas:
        # Holes stay blank where they run the other way round.
        turned = [ring if _runs_anticlockwise(ring) == (index == 0) else ring[::-1] for index, ring in enumerate(rings)]
        paths = [Path(np.vstack([ring, ring[:1]]), closed=True) for ring in turned]
        corners.append(np.concatenate([path.vertices for path in paths]))
        codes.append(np.concatenate([path.codes for path in paths]))
    collection = PolyCollection([], **style)  # type: ignore[arg-type]
    # Codes are a list for each polygon, whatever the types of matplotlib say.
    collection.set_verts_and_codes(corners, codes)  # type: ignore[arg-type]
    ax.add_collection(collection, autolim=False)


def _runs_anticlockwise(ring: Points) -> bool:
    """Whether a ring runs anticlockwise: then its area by the corners is positive."""
    x, y = (ring - ring[0]).T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) > 0.0


def write_legend(ax: Axes, look: Look) -> None:
    """Write the legend right of the map."""
    ax.legend(
        loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0, frameon=False, labelcolor=look.ink, fontsize=9
    )


def draw_scale_bar(ax: Axes, look: Look, units: Units) -> None:
    """Draw a bar of a round length below the map, about a fifth of its width, and an arrow to the north beside it."""
    west, east = ax.get_xlim()
    south, north = ax.get_ylim()
    wanted_m = (east - west) / 5
    unit_m, unit = 1.0, "m"
    if units == "us":
        unit_m, unit = (METRES_PER_MILE, "mi") if wanted_m > METRES_PER_MILE else (METRES_PER_FOOT, "ft")
    power = 10.0 ** np.floor(np.log10(wanted_m / unit_m))
    length = max(step * power for step in (1, 2, 5) if step * power * unit_m <= wanted_m)
    length_m = length * unit_m
    room = 0.07 * (north - south)
    ax.set_ylim(south - room, north)
    bar_y = south - 0.35 * room
    ax.plot([west, west + length_m], [bar_y, bar_y], color=look.ink, linewidth=2.0, solid_capstyle="butt", zorder=6)
    text = f"{length / 1000:g} km" if unit == "m" and length >= 1000 else f"{length:g} {unit}"
    gap = 0.01 * (east - west)
    ax.text(west + length_m + gap, bar_y, text, ha="left", va="center", fontsize=9, color=look.ink)
    ax.text(0.985, 1.0, "N", transform=ax.transAxes, ha="center", va="top", fontsize=9, color=look.ink, zorder=6)
    ax.annotate(
        "",
        xy=(0.985, 0.965),
        xytext=(0.985, 0.88),
        xycoords="axes fraction",
        arrowprops={"arrowstyle": "-|>", "color": look.ink, "shrinkA": 0, "shrinkB": 0},
        zorder=6,
    )


def draw_wind(ax: Axes, wind: Wind, look: Look, units: Units) -> None:
    """Draw an arrow the way the wind blows beside the scale, and how strong it is; nothing in calm air.

    `draw_scale_bar` made room for it below the map.
    """
    if not wind.speed_m_s:
        return
    west, east = ax.get_xlim()
    south, north = ax.get_ylim()
    room = 0.07 * (north - south) / 1.07
    centre_x, centre_y, half = west + 0.5 * (east - west), south + 0.65 * room, 0.45 * room / wind.speed_m_s
    east_m_s, north_m_s = wind.velocity_m_s
    ax.annotate(
        "",
        xy=(centre_x + half * east_m_s, centre_y + half * north_m_s),
        xytext=(centre_x - half * east_m_s, centre_y - half * north_m_s),
        arrowprops={"arrowstyle": "-|>", "color": look.ink, "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0},
        zorder=6,
    )
    text = f"wind {speed_text(wind.speed_m_s, units)} from {wind.from_deg:g}\N{DEGREE SIGN}"
    x = centre_x + 0.6 * room
    ax.text(x, centre_y, text, ha="left", va="center", fontsize=9, color=look.ink, zorder=6)


def write_title(ax: Axes, name: str, lines: Sequence[Sequence[str]], look: Look) -> frozenset[str]:
    """Write a name and below it lines of facts; return the letters of the name that no font has, and are replaced.

    A name of more than `MAX_TITLE_WIDTH` is cut: the picture would grow with it, and the map be lost in white.
    """
    name = _cut(name, MAX_TITLE_WIDTH)
    letters = lettering([name])
    ax.set_title(
        letters.written(name),
        loc="left",
        fontsize=13,
        fontweight="bold",
        fontfamily=list(letters.families),
        parse_math=False,
        color=look.ink,
        pad=8 + 14 * len(lines),
    )
    ax.annotate(
        "\n".join(" · ".join(parts) for parts in lines),
        xy=(0, 1),
        xycoords="axes fraction",
        xytext=(0, 8),
        textcoords="offset points",
        ha="left",
        va="bottom",
        fontsize=9.5,
        color=look.faint_ink,
    )
    return letters.missing


def _cut(text: str, max_width: int) -> str:
    """Cut a text that is wider than so many Latin letters; those of China, Japan and Korea are twice as wide."""
    width = 0
    for place, letter in enumerate(text):
        width += 2 if unicodedata.east_asian_width(letter) in "WF" else 1
        if width > max_width:
            return f"{text[:place].rstrip()}\N{HORIZONTAL ELLIPSIS}"
    return text
