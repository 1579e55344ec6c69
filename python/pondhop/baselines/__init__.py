"""The paper's rivals, run as our planners are: a problem in, routes out, the same evaluator.

`attention` holds the attention models: weights and their training; the core plans with them.
"""
