"""Training of the attention models by reinforcement, on a CPU or a GPU.

REINFORCE (Williams 1992) as in Kool, van Hoof and Welling, with two changes that make an hour on one core enough: the
baseline is the mean of 16 rollouts of the same farm (Kool, van Hoof and Welling, Buy 4 REINFORCE Samples, Get a
Baseline for Free!, 2019), which share one encoding; and rollouts are drawn without gradients, which one pass over all
of their steps adds afterwards. Every step draws new farms of one size from the paper's generator; sizes vary from step
to step, from small to large as training goes on.

Batch normalisation uses the statistics of the batch at first. Batches of different sizes differ in them, and inference
has only their running mean, so the last part of training, at low learning rates, runs with that mean as well
(`Training.frozen_from`).
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from pondhop import instances
from pondhop.baselines.attention.model import Architecture, AttentionModel, Variant, costs, farms_of, roll_out
from pondhop.errors import Fault, InvalidInput

NODES_PER_STEP = 1600
"""Ponds of all farms of a step together: small farms come in larger batches, so that steps take alike."""
VALIDATION_SEED = 4_000_000_000
NUM_VALIDATION_FARMS = 64
SYMMETRIES = torch.tensor(
    [[[x, 0.0], [0.0, y]] for x in (1, -1) for y in (1, -1)] + [[[0.0, x], [y, 0.0]] for x in (1, -1) for y in (1, -1)],
    dtype=torch.float64,
)
"""Matrices that map the square onto itself, the identity first."""


@dataclass(frozen=True)
class Training:
    """What the weights follow from, beside the machine and how long it trained.

    Attributes
    ----------
    variant
        Problem to train on.
    num_ponds, num_routes
        Smallest and largest, both drawn for every step.
    usual_num_routes
        Drawn for a half of the steps, whatever `num_routes` says.
    seed
        Of weights, farms and rollouts.
    num_rollouts
        A farm.
    num_learned_rollouts
        Of these the ones farthest from their mean, which alone give the gradient: half the work, most of the signal.
    learning_rate
        Highest; reached after `num_warmup_steps`, held, and decayed over the second half of training.
    max_gradient_norm
        Longer gradients are shortened to it.
    grown_at
        Share of training after which farms are drawn up to the largest number of ponds.
    frozen_from
        Share of training after which batch normalisation uses its running statistics.
    """

    variant: Variant
    num_ponds: tuple[int, int]
    num_routes: tuple[int, int]
    usual_num_routes: int = 5
    seed: int = 1
    num_rollouts: int = 16
    num_learned_rollouts: int = 8
    learning_rate: float = 3e-4
    num_warmup_steps: int = 100
    max_gradient_norm: float = 1.0
    grown_at: float = 0.5
    frozen_from: float = 0.85


@dataclass
class TrainingState:
    """A training under way."""

    training: Training
    model: AttentionModel
    optimizer: torch.optim.Adam
    num_steps: int = 0
    elapsed_s: float = 0.0
    history: list[dict[str, float]] = field(default_factory=list)


def find_device(name: Literal["auto", "cpu", "cuda"]) -> torch.device:
    """Return the device to train on.

    Raises
    ------
    InvalidInput
        If a GPU is asked for and PyTorch finds none.
    """
    has_gpu = torch.cuda.is_available()
    if name == "cuda" and not has_gpu:
        raise InvalidInput([Fault("--device", "PyTorch finds no GPU", "train on the CPU, or check the driver")])
    return torch.device("cuda" if has_gpu and name != "cpu" else "cpu")


def start(training: Training, device: torch.device) -> TrainingState:
    """Return a training before its first step."""
    torch.manual_seed(training.seed)
    model = AttentionModel(Architecture(training.variant)).to(device)
    for module in model.modules():
        if isinstance(module, nn.BatchNorm1d):
            module.momentum = 0.02
    return TrainingState(training, model, torch.optim.Adam(model.parameters(), lr=training.learning_rate))


def run(
    state: TrainingState,
    *,
    num_steps: int | None,
    duration_s: float | None,
    report: Callable[[TrainingState], None],
    report_interval_s: float = 120.0,
) -> None:
    """Train until either limit, counted over all runs of this training.

    `report` is called about every `report_interval_s` and at the end, to show progress and save it.
    """
    reported_s = state.elapsed_s
    progress = _progress(state, num_steps, duration_s)
    while progress < 1:
        begin = time.monotonic()
        step(state, progress)
        state.num_steps += 1
        state.elapsed_s += time.monotonic() - begin
        progress = _progress(state, num_steps, duration_s)
        if state.elapsed_s - reported_s > report_interval_s or progress >= 1:
            reported_s = state.elapsed_s
            state.history.append(
                {"steps": state.num_steps, "minutes": round(state.elapsed_s / 60, 2), **validate(state)}
            )
            report(state)


def _progress(state: TrainingState, num_steps: int | None, duration_s: float | None) -> float:
    return max(
        state.num_steps / num_steps if num_steps is not None else 0.0,
        state.elapsed_s / duration_s if duration_s is not None else 0.0,
    )


def step(state: TrainingState, progress: float) -> float:
    """Draw farms, roll out, follow the gradient; return the mean cost of the rollouts."""
    training, model = state.training, state.model
    device = next(model.parameters()).device
    farms_seed, rollouts_seed = np.random.SeedSequence((training.seed, state.num_steps)).generate_state(2).tolist()
    torch.manual_seed(rollouts_seed)
    num_ponds, num_routes = _draw_size(training, progress, np.random.default_rng(farms_seed))
    num_farms = min(max(NODES_PER_STEP // num_ponds, 8), 64)
    positions = draw(num_ponds, num_farms, farms_seed).to(device)
    farms = farms_of(training.variant, positions, num_routes)

    model.train()
    if progress >= training.frozen_from:
        for module in model.modules():
            if isinstance(module, nn.BatchNorm1d):
                module.eval()
    for group in state.optimizer.param_groups:
        group["lr"] = _learning_rate(training, state.num_steps, progress)
    with torch.autocast(device.type, torch.bfloat16, enabled=device.type == "cuda"):
        encoding = model.encode(farms)
        rollouts = roll_out(model, farms, encoding, training.num_rollouts)
        cost = costs(training.variant, farms, rollouts)
        advantage = cost - cost.mean(dim=1, keepdim=True)
        learned = advantage.abs().topk(training.num_learned_rollouts, dim=1).indices
        weight = advantage.gather(1, learned) / (advantage.std() + 1e-8)
        loss = (weight * model.log_likelihood(encoding, rollouts.select(learned))).mean()
    state.optimizer.zero_grad()
    loss.backward()
    nn.utils.clip_grad_norm_(model.parameters(), training.max_gradient_norm)
    state.optimizer.step()
    return float(cost.mean())


def _draw_size(training: Training, progress: float, random: np.random.Generator) -> tuple[int, int]:
    smallest, largest = training.num_ponds
    share = min(1.0, 0.25 + 0.75 * progress / training.grown_at)
    # The square: small farms teach most of it at a fraction of the time.
    num_ponds = smallest + round(share * (largest - smallest) * random.random() ** 2)
    num_routes = training.usual_num_routes
    if random.random() < 0.5:
        num_routes = int(random.integers(*training.num_routes, endpoint=True))
    return num_ponds, num_routes


def _learning_rate(training: Training, num_steps: int, progress: float) -> float:
    warmup = min(1.0, (num_steps + 1) / training.num_warmup_steps)
    decay = 1.0 if progress < 0.5 else 0.02 + 0.98 * 0.5 * (1 + math.cos(math.pi * (2 * progress - 1)))
    return training.learning_rate * warmup * decay


def draw(num_ponds: int, num_farms: int, seed: int) -> Tensor:
    """Return positions of depot and ponds of farms as the paper's authors draw them, shape (farms, n + 1, 2)."""
    farms = instances.generate(num_ponds, num_farms, seed=seed)
    return torch.from_numpy(np.stack([np.vstack((farm.depot[None], farm.ponds)) for farm in farms]))


def validate(state: TrainingState) -> dict[str, float]:
    """Return mean longest route and total of greedy decoding on farms that training does not see."""
    figures: dict[str, float] = {}
    sizes = (50, 100) if state.training.num_ponds[0] < state.training.num_ponds[1] else state.training.num_ponds[:1]
    for num_ponds in sizes:
        positions = draw(num_ponds, NUM_VALIDATION_FARMS, seed=VALIDATION_SEED)
        max_lengths, total_lengths, _ = evaluate(state.model, positions, state.training.usual_num_routes)
        figures[f"max_{num_ponds}"] = round(float(max_lengths.mean()), 4)
        figures[f"total_{num_ponds}"] = round(float(total_lengths.mean()), 4)
    return figures


@torch.no_grad()
def evaluate(
    model: AttentionModel, positions: Tensor, num_routes: int, *, has_symmetries: bool = False
) -> tuple[Tensor, Tensor, Tensor]:
    """Return longest route, total and number of routes by greedy decoding, each of shape (farms,).

    With `has_symmetries`, those of the best of eight: each farm mirrored and turned.
    """
    device = next(model.parameters()).device
    variant = model.architecture.variant
    model.eval()
    results = []
    for symmetry in SYMMETRIES if has_symmetries else SYMMETRIES[:1]:
        turned = (positions - 0.5) @ symmetry + 0.5
        farms = farms_of(variant, turned.to(device), num_routes)
        rollouts = roll_out(model, farms, model.encode(farms), 1, is_greedy=True)
        scale = torch.ones(len(positions), dtype=positions.dtype)
        if variant == "minmax":
            scale = (positions - positions[:, :1]).norm(dim=2).amax(dim=1)
        figures = (costs(variant, farms, rollouts), rollouts.max_lengths, rollouts.total_lengths)
        results.append(
            torch.stack([*(scale * figure[:, 0].cpu() for figure in figures), rollouts.num_routes[:, 0].cpu()])
        )
    stacked = torch.stack(results)
    best = stacked[:, 0].argmin(dim=0)
    chosen = stacked[best, :, torch.arange(len(positions))]
    return chosen[:, 1], chosen[:, 2], chosen[:, 3]


def save(state: TrainingState, path: Path) -> None:
    """Write all that `load` needs to go on."""
    temporary = path.with_name(path.name + ".part")
    torch.save(
        {
            "training": asdict(state.training),
            "model": state.model.state_dict(),
            "optimizer": state.optimizer.state_dict(),
            "num_steps": state.num_steps,
            "elapsed_s": state.elapsed_s,
            "history": state.history,
        },
        temporary,
    )
    temporary.replace(path)


def load(path: Path, device: torch.device) -> TrainingState:
    """Read a training that `save` wrote."""
    saved: dict[str, Any] = torch.load(path, map_location=device, weights_only=True)
    state = start(Training(**saved["training"]), device)
    state.model.load_state_dict(saved["model"])
    state.optimizer.load_state_dict(saved["optimizer"])
    state.num_steps, state.elapsed_s, state.history = saved["num_steps"], saved["elapsed_s"], saved["history"]
    return state


def tensors(model: AttentionModel) -> dict[str, NDArray[np.float32]]:
    """Return the weights by the names under which inference reads them.

    Matrices are (outputs, inputs): y = W x + b. Batch normalisation becomes the map that its running statistics make
    of it, ``scale * x + shift``; the weight of the distance is what multiplies log(1 + distance / spacing).
    """
    weights: dict[str, Tensor] = {}
    for name, module in model.named_modules():
        if isinstance(module, nn.BatchNorm1d):
            assert module.running_mean is not None
            assert module.running_var is not None
            scale = module.weight / torch.sqrt(module.running_var + module.eps)
            weights[f"{name}.scale"] = scale
            weights[f"{name}.shift"] = module.bias - module.running_mean * scale
        elif isinstance(module, nn.Linear):
            weights[f"{name}.weight"] = module.weight
            if module.bias is not None:
                weights[f"{name}.bias"] = module.bias
    if model.architecture.variant == "minmax":
        weights["distance_weight"] = nn.functional.softplus(model.distance)
    return {name: weight.detach().float().cpu().numpy() for name, weight in weights.items()}


def read_weights(path: Path) -> AttentionModel:
    """Return the model whose weights `export` wrote, ready for inference."""
    with np.load(path, allow_pickle=False) as arrays:
        architecture = Architecture(**json.loads(str(arrays["config"]))["architecture"])
        weights = {name: torch.from_numpy(arrays[name].astype(np.float64)) for name in arrays.files if name != "config"}
    model = AttentionModel(architecture)
    values: dict[str, Tensor] = {}
    for name, module in model.named_modules():
        if isinstance(module, nn.BatchNorm1d):
            module.eps = 0.0
            values[f"{name}.weight"], values[f"{name}.bias"] = (
                weights.pop(f"{name}.scale"),
                weights.pop(f"{name}.shift"),
            )
            values[f"{name}.running_mean"] = torch.zeros(architecture.width)
            values[f"{name}.running_var"] = torch.ones(architecture.width)
            values[f"{name}.num_batches_tracked"] = torch.tensor(0)
    if architecture.variant == "minmax":
        values["distance"] = torch.log(torch.expm1(weights.pop("distance_weight")))
    model.load_state_dict(values | weights)
    model.eval()
    return model


def export(state: TrainingState, path: Path, *, dtype: type[np.floating[Any]] = np.float16) -> None:
    """Write weights for inference: the arrays of `tensors`, and as JSON under ``config`` what they follow from."""
    config = {
        "architecture": asdict(state.model.architecture),
        "training": asdict(state.training),
        "num_steps": state.num_steps,
        "elapsed_s": round(state.elapsed_s),
        "date": time.strftime("%Y-%m-%d", time.gmtime()),
        "history": state.history,
    }
    arrays = {name: array.astype(dtype) for name, array in tensors(state.model).items()}
    np.savez_compressed(path, allow_pickle=False, config=np.array(json.dumps(config)), **arrays)
