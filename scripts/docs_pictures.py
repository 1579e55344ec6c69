"""Draw the pictures of README and docs: `make docs`."""

from pathlib import Path

import pondhop
from pondhop import plot

ROOT = Path(__file__).resolve().parent.parent
IMAGES = ROOT / "docs" / "images"

farm = pondhop.read_farm(ROOT / "examples" / "delta_farm.geojson")
farm_plan = pondhop.plan(farm, pondhop.Fleet(num_drones=5))
plot.save_figure(plot.plot_plan(farm_plan), IMAGES / "delta_farm.png")
