"""Charts of the report: rivals beside `search`, quality against time, and scaling."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import cycle
from typing import TYPE_CHECKING

from pondhop.palette import ROUTE_COLOURS
from pondhop.plot import LOOKS, Look, Theme
from pondhop.report.methods import LONG_SEARCH, SEARCH
from pondhop.report.tables import Margin, Point, Tables

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

_BLUE, _ORANGE, _GREEN, _VERMILION, _SKY, _PURPLE = ROUTE_COLOURS

LINEAR_BELOW_PERCENT = 0.1
"""Below it the axis of gaps is linear, so that 0 has a place on it."""


@dataclass(frozen=True)
class _Style:
    """How a planner looks; any one of colour with dashes or marker is enough to tell it from the others."""

    colour: str
    marker: str
    dashes: str = "-"


_STYLES = {
    "search": _Style(_BLUE, "o"),
    "territory": _Style(_GREEN, "s"),
    "hpp": _Style(_ORANGE, "D"),
    "ortools": _Style(_VERMILION, "^"),
    "ortools-gls": _Style(_VERMILION, "v", "--"),
    "pyvrp": _Style(_PURPLE, "P", "-."),
    "am": _Style(_SKY, "X"),
    "am-minmax": _Style(_SKY, "p", "--"),
}
_OWN_MARKERS = "h*<>d"


def draw_margins(tables: Tables, theme: Theme) -> Axes:
    """Draw how much longer the plans of the rivals are than those of `search`, over the number of ponds."""
    look = LOOKS[theme]
    left, right = _panels(2, look, (11.0, 4.6))
    ratios: list[tuple[Axes, str, Callable[[Margin], float]]] = [
        (left, "Longest route", lambda row: row.rival_max_route_length / row.search_max_route_length),
        (right, "Total, at equal longest route", lambda row: row.rival_total_length / row.within_total_length),
    ]
    styles = _styles(tables)
    for ax, title, ratio in ratios:
        for rival in tables.study.shown_methods():
            rows = [row for row in tables.margins if row.rival == rival.label]
            if rows:
                coordinates = [(float(row.num_ponds), ratio(row)) for row in rows]
                _draw_line(ax, coordinates, rival.label, styles[rival.name], look)
        ax.axhline(1, color=styles[SEARCH.name].colour, linewidth=2.2, label=SEARCH.label, zorder=2)
        ax.set_yscale("log")
        _pond_axis(ax, sorted(tables.study.scope.num_ponds), look)
        _write_title(ax, title, look)
    lowest, highest = min(left.get_ylim()[0], 0.96), max(left.get_ylim()[1], 1.12)
    ticks = [tick for tick in (0.6, 0.8, 1, 1.25, 1.5, 2, 3, 4, 6, 10) if lowest <= tick <= highest]
    left.set_ylim(lowest, highest)
    _set_ticks(left.yaxis, ticks, [f"{tick:g} \u00d7" for tick in ticks])
    left.set_ylabel(f"times that of {SEARCH.label}", color=look.faint_ink)
    _write_legend([left, right], look)
    return left


def draw_quality_against_time(tables: Tables, theme: Theme) -> Axes:
    """Draw the gap to the best known over the time of planning a farm, a panel a number of ponds."""
    look, scope = LOOKS[theme], tables.study.scope
    panels = _panels(len(scope.anytime_num_ponds), look, (12.0, 4.8))
    styles = _styles(tables)
    lines = {method.name for method in tables.study.anytime_methods()}
    for ax, num_ponds in zip(panels, scope.anytime_num_ponds, strict=True):
        points = [point for point in tables.quality_against_time if point.num_ponds == num_ponds]
        for method in tables.study.shown_methods():
            is_line = method.name in lines
            of_method = [
                point
                for point in points
                if (point.planner == method.name if is_line else point.method == method.label)
                and (not is_line or point.time_limit != "none")
            ]
            coordinates = [(point.seconds, point.gap_percent) for point in of_method if point.gap_percent is not None]
            if coordinates:
                label = method.name if is_line else method.label
                _draw_line(ax, sorted(coordinates), label, styles[method.name], look)
        ax.set_xscale("log")
        ax.set_xlabel("time to plan one farm", color=look.faint_ink)
        _write_title(ax, f"{num_ponds} ponds", look)
    limits = min(ax.get_xlim()[0] for ax in panels), max(ax.get_xlim()[1] for ax in panels)
    for ax in panels:
        ax.set_xlim(*limits)
        _time_axis(ax.xaxis, limits)
    _gap_axis(panels[0], look)
    _write_legend(panels, look)
    return panels[0]


def draw_scaling(tables: Tables, theme: Theme) -> Axes:
    """Draw time and gap of every method over the number of ponds, from the paper's farms to the largest."""
    look = LOOKS[theme]
    left, right = _panels(2, look, (12.0, 5.0), is_sharing_y=False)
    styles = _styles(tables)
    values: list[tuple[Axes, str, Callable[[Point], float | None]]] = [
        (left, "Time to plan one farm", lambda point: point.seconds),
        (right, "Longest route above the best known", lambda point: point.gap_percent),
    ]
    for ax, title, value in values:
        for method in tables.study.compared_methods():
            of_method = [point for point in tables.scaling if point.method == method.label]
            coordinates = [(float(point.num_ponds), y) for point in of_method if (y := value(point)) is not None]
            style = replace(styles[method.name], dashes="--") if method == LONG_SEARCH else styles[method.name]
            if coordinates:
                _draw_line(ax, coordinates, method.label, style, look)
        _pond_axis(ax, _some_sizes(list(tables.study.farms)), look)
        _write_title(ax, title, look)
    left.set_yscale("log")
    _time_axis(left.yaxis, left.get_ylim())
    _gap_axis(right, look)
    right.set_ylabel("")
    _write_legend([left, right], look)
    return left


def _styles(tables: Tables) -> dict[str, _Style]:
    """Return the style of every planner by name; planners of your own are in the colour of the ink."""
    markers = cycle(_OWN_MARKERS)
    own = [method for method in tables.study.methods if method.kind == "yours"]
    return _STYLES | {method.name: _Style("", next(markers), ":") for method in own}


def _panels(number: int, look: Look, size_in: tuple[float, float], *, is_sharing_y: bool = True) -> Sequence[Axes]:
    """Axes side by side on a figure of their own, with a light grid and nothing around them."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=size_in, facecolor=look.background, layout="constrained")
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08)  # type: ignore[union-attr, call-arg]
    panels: list[Axes] = list(figure.subplots(1, number, sharey=is_sharing_y, squeeze=False).ravel())
    for ax in panels:
        ax.set_facecolor(look.background)
        ax.spines[:].set_visible(False)
        ax.grid(visible=True, color=look.outline, alpha=0.25, linewidth=0.8)
        ax.set_axisbelow(True)
        ax.tick_params(which="both", length=0, labelsize=9.5, labelcolor=look.faint_ink)
    return panels


def _draw_line(ax: Axes, coordinates: Sequence[tuple[float, float]], label: str, style: _Style, look: Look) -> None:
    is_search = style == _STYLES["search"]
    ax.plot(
        *zip(*coordinates, strict=True),
        color=style.colour or look.ink,
        marker=style.marker,
        linestyle=style.dashes if len(coordinates) > 1 else "",
        linewidth=2.4 if is_search else 1.5,
        markersize=6.5 if is_search or len(coordinates) > 1 else 9,
        markeredgecolor=look.background,
        markeredgewidth=0.8,
        label=label,
        zorder=4 if is_search else 3,
        clip_on=False,
    )


def _pond_axis(ax: Axes, sizes: Sequence[int], look: Look) -> None:
    """A logarithmic axis of numbers of ponds, with ticks at these alone."""
    ax.set_xscale("log")
    _set_ticks(ax.xaxis, sizes, [f"{size:,}" for size in sizes])
    ax.set_xlabel("ponds", color=look.faint_ink)


def _time_axis(axis: Axis, limits: tuple[float, float]) -> None:
    """Ticks at powers of ten, in the unit that people use for them."""
    powers = range(math.ceil(math.log10(limits[0]) - 0.2), math.floor(math.log10(limits[1]) + 0.2) + 1)
    _set_ticks(axis, [10.0**power for power in powers], [_time_words(power) for power in powers])


def _time_words(power: int) -> str:
    if power < -3:
        return f"{10.0 ** (power + 3):g} ms"
    return f"{10 ** (power + 3)} ms" if power < 0 else f"{10**power} s"


def _gap_axis(ax: Axes, look: Look) -> None:
    """An axis of gaps; those below 0, of plans better than the best known of a file, have room as well."""
    ax.set_yscale("symlog", linthresh=LINEAR_BELOW_PERCENT, linscale=0.5)
    highest = 1.3 * ax.get_ylim()[1]
    least = min(float(sibling.dataLim.y0) for sibling in ax.get_shared_y_axes().get_siblings(ax))
    lowest = min(-0.02, 1.3 * least)
    ax.set_ylim(lowest, highest)
    ticks = [tick for tick in (-1, -0.1, 0, 0.1, 0.3, 1, 3, 10, 30, 100, 300, 1000) if lowest <= tick <= highest]
    _set_ticks(ax.yaxis, ticks, [f"{tick:g} %".replace("-", "\N{MINUS SIGN}") for tick in ticks])
    ax.set_ylabel("longest route above the best known", color=look.faint_ink)


def _set_ticks(axis: Axis, ticks: Sequence[float], labels: Sequence[str]) -> None:
    axis.set_ticks(ticks, labels)
    axis.set_ticks([], minor=True)


def _some_sizes(sizes: Sequence[int]) -> list[int]:
    """Return sizes that are far enough apart for labels on a logarithmic axis."""
    found: list[int] = []
    for size in sizes:
        if not found or size >= 1.9 * found[-1]:
            found.append(size)
    return found


def _write_title(ax: Axes, text: str, look: Look) -> None:
    ax.set_title(text, loc="left", fontsize=11.5, fontweight="bold", color=look.ink, pad=10)


def _write_legend(panels: Sequence[Axes], look: Look) -> None:
    """One legend below all panels, each line once."""
    lines = {label: line for ax in panels for line, label in zip(*ax.get_legend_handles_labels(), strict=True)}
    figure = panels[0].get_figure(root=True)
    if figure is not None:
        figure.legend(
            lines.values(),
            lines.keys(),
            loc="outside lower center",
            ncols=min(5, len(lines)),
            frameon=False,
            labelcolor=look.ink,
            fontsize=9.5,
            handlelength=2.6,
        )
