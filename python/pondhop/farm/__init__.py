"""Farms: values, the files they come from, and made-up ones.

`model` holds the values, `read` makes them of files (`formats`, `tables` and `features` say what a file holds, `checks`
whether its shapes can be ponds), `write` writes them, and `made_up` draws farms that look like real ones.
"""

from pondhop.farm.made_up import generate_farm
from pondhop.farm.model import Farm, Pond
from pondhop.farm.read import read_farm
from pondhop.farm.write import write_farm

__all__ = ["Farm", "Pond", "generate_farm", "read_farm", "write_farm"]
