"""Solvers of others, or in their manner, run as planners on the same problems and judged by the same evaluator.

`ortools` and `pyvrp` put a problem into the words of those solvers and read their routes; `integers` makes the whole
numbers that both of them compute with. Each module imports the package it is named after, so it is imported only when
its planner runs (extra ``baselines``). `attention` holds the attention models: their weights and their training; the
core plans with them. By name all of them are in `pondhop.PLANNERS`.
"""
