"""Pictures of plans, in the style of the paper's figures 2 and 3: one function per figure.

Every function draws on the axes it is given or on a figure of its own, returns the axes and shows nothing.
`save_figure` writes them.
"""

from pondhop.plot.canvas import draw_areas, figure_bytes, prepared_axes, save_figure
from pondhop.plot.look import LOOKS, Look, Theme
from pondhop.plot.nights import plot_night
from pondhop.plot.plans import drawn_plan, plot_clusters, plot_plan, plot_solution
from pondhop.plot.routes import draw_depot
from pondhop.plot.sizes import plot_sizes

__all__ = [
    "LOOKS",
    "Look",
    "Theme",
    "draw_areas",
    "draw_depot",
    "drawn_plan",
    "figure_bytes",
    "plot_clusters",
    "plot_night",
    "plot_plan",
    "plot_sizes",
    "plot_solution",
    "prepared_axes",
    "save_figure",
]
