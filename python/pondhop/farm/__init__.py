"""Farms: values, the files they come from, and made-up ones.

`model` holds the values, `write` writes them, and `made_up` draws farms that look like real ones. `read` makes them of
files, in this order:

1. `formats` looks at what a file is and hands it to its reader: `geojson` (with `esri_json` and `topojson`), `tables`
   (`columns`, `degrees`, `corners`), `kml`, `gpx`, `gis` for what GDAL reads, `archives`. Each makes `features`.
2. `coordinates` checks that they lie on the globe, and `roles` what they are, by the `words` of their names.
3. `ponds` makes ponds of them, with `shapes` for outlines, and `names` gives each an id.
4. `depot` finds where drones start, and `distances` which ponds lie around it.
5. `faults` tells what is wrong.
"""

from pondhop.farm.made_up import generate_farm
from pondhop.farm.model import Doubt, Farm, Pond
from pondhop.farm.read import doubt_fault, read_farm
from pondhop.farm.write import write_farm

__all__ = ["Doubt", "Farm", "Pond", "doubt_fault", "generate_farm", "read_farm", "write_farm"]
