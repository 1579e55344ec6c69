"""``pondhop train-am``: train the weights of the attention model anew."""

from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from pondhop.cli.shared import Json
from pondhop.errors import Fault, InvalidInput

if TYPE_CHECKING:
    from pondhop.baselines.attention.train import TrainingState

MAX_PONDS = 1000


def train_am(
    output: Annotated[Path, typer.Option("--output", "-o", help="File for the weights, .npz; checkpoints go beside.")],
    variant: Annotated[
        Literal["cvrp", "minmax"], typer.Option(help="cvrp: total length, capacity n/5 + 1. minmax: longest route.")
    ] = "minmax",
    ponds: Annotated[str | None, typer.Option(metavar="N[,N]", help="Ponds of the farms, or fewest and most.")] = None,
    minutes: Annotated[float | None, typer.Option(min=0, help="How long to train, resumed runs together.")] = None,
    steps: Annotated[int | None, typer.Option(min=1, help="How many steps to train, resumed runs together.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of weights, farms and routes drawn.")] = 1,
    device: Annotated[Literal["auto", "cpu", "cuda"], typer.Option(help="auto: the GPU if there is one.")] = "auto",
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on from the checkpoint, with the variant, ponds and seed it has.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Train an attention model on farms drawn as the paper's authors draw them, and write its weights.

    - `pondhop train-am --variant minmax --minutes 100 -o am_minmax.npz`
    - `pondhop train-am --variant cvrp --ponds 50 --minutes 30 -o am50.npz`
    - `pondhop train-am --variant cvrp --minutes 60 --resume -o am50.npz`

    Every two minutes a line shows the greedy routes on farms that are not trained on, and the checkpoint, the output
    with the ending .pt, is renewed. Learning rate and sizes of farms follow the share of training that is done, so a
    run that is resumed for longer starts to decay its learning rate again. Needs PyTorch: `pip install
    torch`.
    """
    checkpoint = output.with_suffix(".pt")
    num_ponds = _num_ponds(ponds, variant)
    faults = [] if isinstance(num_ponds, tuple) else [num_ponds]
    if minutes is None and steps is None:
        faults.append(Fault("--minutes, --steps", "nothing says how long to train", "give one of them"))
    if output.suffix != ".npz":
        faults.append(Fault("--output", f"{output} does not end in .npz", "let the name end in .npz"))
    if resume and not checkpoint.exists():
        faults.append(Fault("--resume", f"there is no {checkpoint}", "start without --resume"))
    if not resume and checkpoint.exists():
        action = "go on with --resume, or give another --output"
        faults.append(Fault("--output", f"{checkpoint} would be overwritten", action))
    if find_spec("torch") is None:
        action = "install it with: pip install torch"
        faults.append(Fault("train-am", "training needs PyTorch, which is not installed", action))
    if faults or not isinstance(num_ponds, tuple):
        raise InvalidInput(faults)

    from pondhop.baselines.attention import train

    chosen = train.find_device(device)
    if resume:
        state = train.load(checkpoint, chosen)
    else:
        num_routes = (5, 5) if variant == "cvrp" else (3, 8)
        state = train.start(train.Training(variant, num_ponds, num_routes, seed=seed), chosen)
    output.parent.mkdir(parents=True, exist_ok=True)

    def report(state: TrainingState) -> None:
        typer.echo(_line(state), err=True)
        train.save(state, checkpoint)

    train.run(state, num_steps=steps, duration_s=None if minutes is None else 60 * minutes, report=report)
    train.export(state, output)
    result = {"weights": str(output), "num_steps": state.num_steps, "history": state.history}
    typer.echo(json.dumps(result) if as_json else f"Written: {output}")


def _num_ponds(text: str | None, variant: str) -> tuple[int, int] | Fault:
    if text is None:
        return (50, 50) if variant == "cvrp" else (20, 200)
    parts = text.split(",")
    if len(parts) <= 2 and all(part.isascii() and part.isdigit() for part in parts):
        smallest, largest = int(parts[0]), int(parts[-1])
        if 2 <= smallest <= largest <= MAX_PONDS:
            return smallest, largest
    return Fault(
        "--ponds", f"{text!r} is no number of ponds", f"write one as in 50, or two as in 20,150; 2 to {MAX_PONDS}"
    )


def _line(state: TrainingState) -> str:
    figures = state.history[-1]
    rest = "  ".join(f"{name} {value:.4g}" for name, value in figures.items() if name not in ("steps", "minutes"))
    return f"{figures['minutes']:8.1f} min  {figures['steps']:7.0f} steps  {rest}"
