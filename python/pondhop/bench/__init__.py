"""Planners against each other: planners x farms x time limits x seeds, judged by `pondhop.evaluate`, as tables.

In reading order:

- `farm_sets`: which farms are planned and with how many routes; from files, drawn, or as a best-known file lists them.
- `measure`: one run of one planner on one farm, and the record of it.
- `results`: the file of finished runs; whatever stops the benchmark, a later start goes on from there.
- `execute`: the runs that are missing, in parallel processes.
- `best_known`: the best plans known, read and written.
- `summary`: averages of the runs and the Markdown table.
"""
