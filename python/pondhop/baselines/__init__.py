"""Planners of others, to compare ours with: the paper's rivals and today's solvers."""
