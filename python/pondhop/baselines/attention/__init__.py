"""The attention model: a network that builds routes node by node, trained by reinforcement."""
