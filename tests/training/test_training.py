"""The trainer of the attention models. Needs PyTorch, which the main test run does not install: `make train-toy`."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs PyTorch: pip install torch, or make train-toy")

from pondhop import Problem, evaluate  # noqa: E402
from pondhop.baselines.attention import train  # noqa: E402
from pondhop.baselines.attention.model import (  # noqa: E402
    Architecture,
    AttentionModel,
    Variant,
    capacity,
    costs,
    farms_of,
    roll_out,
)

VARIANTS: tuple[Variant, ...] = ("cvrp", "minmax")
CPU = torch.device("cpu")
TOY = train.Training("minmax", num_ponds=(8, 8), num_routes=(3, 3), usual_num_routes=3, num_warmup_steps=5)


@pytest.fixture(autouse=True)
def _one_thread() -> None:
    torch.set_num_threads(1)
    torch.manual_seed(1)


def routes_of(nodes: list[int]) -> list[list[int]]:
    """Split the nodes of a rollout at the depot; pond i of a problem is node i + 1."""
    routes: list[list[int]] = [[]]
    for node in nodes:
        if node == 0:
            routes.append([])
        else:
            routes[-1].append(node - 1)
    return [route for route in routes if route]


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize(("num_ponds", "num_routes"), [(1, 1), (2, 3), (5, 5), (17, 4)])
def test_rollouts_are_plans_with_the_lengths_that_the_evaluator_finds(
    variant: Variant, num_ponds: int, num_routes: int
) -> None:
    positions = train.draw(num_ponds, 3, seed=7)
    model = AttentionModel(Architecture(variant)).eval()
    farms = farms_of(variant, positions, num_routes)
    rollouts = roll_out(model, farms, model.encode(farms), 4)
    for farm in range(3):
        depot, ponds = positions[farm, 0].numpy(), positions[farm, 1:].numpy()
        radius = np.linalg.norm(ponds - depot, axis=1).max()
        for rollout in range(4):
            routes = routes_of(rollouts.actions[farm, rollout].tolist())
            plan = evaluate(Problem(depot, ponds, num_routes if variant == "minmax" else num_ponds), routes)
            assert plan.is_feasible
            assert len(routes) == rollouts.num_routes[farm, rollout]
            if variant == "cvrp":
                assert max(map(len, routes)) <= capacity(num_ponds, num_routes)
            scale = radius if variant == "minmax" else 1.0
            assert scale * float(rollouts.max_lengths[farm, rollout]) == pytest.approx(plan.max_route_length, rel=1e-5)
            assert scale * float(rollouts.total_lengths[farm, rollout]) == pytest.approx(plan.total_length, rel=1e-5)


def test_costs_are_what_the_problems_say() -> None:
    positions = torch.tensor([[[0.0, 0.0], [0.6, 0.8], [0.3, 0.4]]], dtype=torch.float64)
    model = AttentionModel(Architecture("minmax")).eval()
    farms = farms_of("minmax", positions, 1)
    rollouts = roll_out(model, farms, model.encode(farms), 2)
    # One route out to the farther pond, at distance 1, and back.
    assert rollouts.max_lengths.tolist() == [[pytest.approx(2.0)] * 2]
    assert costs("minmax", farms, rollouts).tolist() == [[pytest.approx(2.0 + 0.1 * 2.0)] * 2]
    assert costs("cvrp", farms, rollouts).tolist() == [[pytest.approx(2.0)] * 2]


@pytest.mark.parametrize("variant", VARIANTS)
def test_one_pass_finds_the_likelihood_of_the_steps(variant: Variant) -> None:
    model = AttentionModel(Architecture(variant)).eval()
    farms = farms_of(variant, train.draw(9, 2, seed=3), 3)
    encoding = model.encode(farms)
    rollouts = roll_out(model, farms, encoding, 5, keeps_logits=True)
    assert rollouts.logits is not None
    of_steps = rollouts.logits.log_softmax(dim=3).gather(3, rollouts.actions[..., None])[..., 0]
    torch.testing.assert_close(model.log_likelihood(encoding, rollouts), of_steps.sum(dim=2))
    chosen = torch.tensor([[4, 0], [1, 2]])
    expected = of_steps.sum(dim=2).gather(1, chosen)
    torch.testing.assert_close(model.log_likelihood(encoding, rollouts.select(chosen)), expected)


def test_rollouts_are_drawn_with_their_probabilities() -> None:
    model = AttentionModel(Architecture("minmax")).eval()
    farms = farms_of("minmax", train.draw(3, 1, seed=5), 2)
    num_rollouts = 20_000
    rollouts = roll_out(model, farms, model.encode(farms), num_rollouts, keeps_logits=True)
    assert rollouts.logits is not None
    expected = rollouts.logits[0, 0, 0].softmax(dim=0)
    drawn = torch.bincount(rollouts.actions[0, :, 0], minlength=4) / num_rollouts
    # Five standard deviations of a share.
    assert (drawn - expected).abs().max() < 5 * math.sqrt(0.25 / num_rollouts)


def test_training_makes_routes_shorter() -> None:
    state = train.start(TOY, CPU)
    before = train.validate(state)["max_8"]
    train.run(state, num_steps=60, duration_s=None, report=lambda _: None)
    assert state.history[-1]["steps"] == 60
    assert state.history[-1]["max_8"] < 0.9 * before


def test_a_resumed_training_is_the_same_training(tmp_path: Path) -> None:
    straight, stopped = train.start(TOY, CPU), train.start(TOY, CPU)
    for number in range(4):
        train.step(straight, number / 4)
        straight.num_steps += 1
    for number in range(2):
        train.step(stopped, number / 4)
        stopped.num_steps += 1
    train.save(stopped, tmp_path / "toy.pt")
    resumed = train.load(tmp_path / "toy.pt", CPU)
    assert resumed.training == TOY
    for number in range(2, 4):
        train.step(resumed, number / 4)
        resumed.num_steps += 1
    for name, value in straight.model.state_dict().items():
        assert torch.equal(value, resumed.model.state_dict()[name]), name


def test_the_seed_decides_the_weights() -> None:
    first, again, other = (train.start(training, CPU) for training in (TOY, TOY, replace(TOY, seed=2)))
    costs_of = [[train.step(state, 0.0) for _ in range(2)] for state in (first, again, other)]
    assert costs_of[0] == costs_of[1] != costs_of[2]


@pytest.mark.parametrize("variant", VARIANTS)
def test_exported_weights_give_the_same_logits(variant: Variant, tmp_path: Path) -> None:
    state = train.start(replace(TOY, variant=variant), CPU)
    for _ in range(3):
        train.step(state, 0.0)
        state.num_steps += 1
    train.export(state, tmp_path / "toy.npz", dtype=np.float32)
    state.model.eval()
    farms = farms_of(variant, train.draw(11, 2, seed=9), 3)
    logits = []
    for model in (state.model, train.read_weights(tmp_path / "toy.npz")):
        torch.manual_seed(3)
        logits.append(roll_out(model, farms, model.encode(farms), 1, is_greedy=True, keeps_logits=True).logits)
    torch.testing.assert_close(logits[0], logits[1], rtol=1e-4, atol=1e-4)


def test_exported_weights_say_what_they_follow_from(tmp_path: Path) -> None:
    state = train.start(TOY, CPU)
    train.run(state, num_steps=1, duration_s=None, report=lambda _: None)
    train.export(state, tmp_path / "toy.npz")
    with np.load(tmp_path / "toy.npz", allow_pickle=False) as arrays:
        config = json.loads(str(arrays["config"]))
        assert {arrays[name].dtype for name in arrays.files if name != "config"} == {np.dtype(np.float16)}
    assert config["architecture"] == {
        "variant": "minmax",
        "width": 128,
        "num_heads": 8,
        "num_layers": 3,
        "feed_forward_width": 512,
    }
    assert config["training"]["seed"] == 1
    assert config["num_steps"] == 1


def test_symmetries_are_eight_and_keep_distances() -> None:
    products = train.SYMMETRIES @ train.SYMMETRIES.transpose(1, 2)
    assert torch.equal(products, torch.eye(2, dtype=torch.float64).expand(8, 2, 2))
    assert len({tuple(symmetry.flatten().tolist()) for symmetry in train.SYMMETRIES}) == 8


@pytest.mark.parametrize("variant", VARIANTS)
def test_the_best_symmetry_is_no_worse_than_none(variant: Variant) -> None:
    model = AttentionModel(Architecture(variant))
    positions = train.draw(10, 5, seed=2)
    plain = train.evaluate(model, positions, 3)
    best = train.evaluate(model, positions, 3, has_symmetries=True)
    if variant == "cvrp":
        assert (best[1] <= plain[1] + 1e-6).all()
    else:
        cost = [max_lengths + 0.1 * totals / 3 for max_lengths, totals, _ in (best, plain)]
        assert (cost[0] <= cost[1] + 1e-6).all()
