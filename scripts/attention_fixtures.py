"""Write what the tests of the core's inference compare with: logits of PyTorch at every step of greedy routes.

    attention_fixtures.py WEIGHTS.npz FIXTURES.json

The weights are read as inference reads them, so the logits are those of the shipped numbers.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import torch

from pondhop.baselines.attention import train
from pondhop.baselines.attention.model import farms_of, roll_out

FARMS = ((12, 3, 1), (12, 5, 2), (17, 5, 3), (20, 4, 4))
"""Ponds, routes and seed."""


def main(weights: Path, fixtures: Path) -> None:
    """Write the fixtures of the weights."""
    model = train.read_weights(weights)
    cases = []
    for num_ponds, num_routes, seed in FARMS:
        positions = train.draw(num_ponds, 1, seed)
        farms = farms_of(model.architecture.variant, positions, num_routes)
        with torch.no_grad():
            rollouts = roll_out(model, farms, model.encode(farms), 1, is_greedy=True, keeps_logits=True)
        assert rollouts.logits is not None
        logits = [
            [round(value, 5) if value > -torch.inf else None for value in step]
            for step in rollouts.logits[0, 0].tolist()
        ]
        cases.append(
            {
                "depot": positions[0, 0].tolist(),
                "ponds": positions[0, 1:].tolist(),
                "num_routes": num_routes,
                "nodes": rollouts.actions[0, 0].tolist(),
                "logits": logits,
            }
        )
    fixtures.write_text("[\n" + ",\n".join(json.dumps(case, separators=(",", ":")) for case in cases) + "\n]\n")


if __name__ == "__main__":
    torch.set_num_threads(1)
    main(Path(sys.argv[1]), Path(sys.argv[2]))
