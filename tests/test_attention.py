"""The attention models: their files, their parity with PyTorch, and planning with them."""

import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from numpy.typing import NDArray

import pondhop
from pondhop import InvalidInput, Problem, _core
from pondhop.baselines import attention
from pondhop.baselines.attention import Decoding, ModelName

DATA = Path(__file__).parent / "data"
PACKAGE = Path(attention.__file__).parent
PARITY = 1e-3
"""Between single precision in another order and PyTorch's; a wrong term shows in the first digit."""


def routes_of_nodes(nodes: list[int]) -> list[list[int]]:
    """Return routes of the choices of a network, where 0 is the depot."""
    routes: list[list[int]] = [[]]
    for node in nodes:
        if node == 0:
            routes.append([])
        else:
            routes[-1].append(node - 1)
    return routes


@pytest.mark.parametrize("name", get_args(ModelName))
def test_logits_of_shipped_weights_are_those_of_pytorch(name: ModelName) -> None:
    """The fixtures are made by scripts/attention_fixtures.py."""
    model = attention.load_model(name)
    for case in json.loads((DATA / f"{name}_logits.json").read_text()):
        problem = Problem(case["depot"], np.array(case["ponds"]), case["num_routes"])
        routes = routes_of_nodes(case["nodes"])
        closed = [[value is None for value in step] for step in case["logits"]]
        expected = np.array([[-np.inf if value is None else value for value in step] for step in case["logits"]])
        logits = model.logits(problem, routes)
        assert (np.isneginf(logits) == closed).all()
        np.testing.assert_allclose(np.where(closed, 0, logits), np.where(closed, 0, expected), rtol=0, atol=PARITY)
        assert model.plan(problem)[0] == routes


@pytest.mark.parametrize("planner", ["am", "am-minmax"])
@pytest.mark.parametrize("decoding", get_args(Decoding))
def test_every_pond_once_and_the_same_again(planner: str, decoding: Decoding) -> None:
    for num_ponds, num_routes in ((1, 3), (2, 5), (50, 5), (120, 3)):
        problem = pondhop.generate(num_ponds, seed=4)[0].to_problem(num_routes)
        solution = pondhop.solve(problem, planner=planner, decoding=decoding, iterations=4, seed=2)
        visits = sorted(pond for route in solution.plan.routes for pond in route)
        assert visits == list(range(num_ponds))
        if planner == "am-minmax":
            assert solution.plan.is_feasible
        again = pondhop.solve(problem, planner=planner, decoding=decoding, iterations=4, seed=2)
        assert again.plan.routes == solution.plan.routes


def test_more_symmetries_and_samples_help_on_average() -> None:
    problems = [farm.to_problem(5) for farm in pondhop.generate(50, 10, seed=6)]

    def mean_max(**options: Any) -> float:
        plans = [pondhop.solve(problem, planner="am-minmax", **options).plan for problem in problems]
        return float(np.mean([plan.max_route_length for plan in plans]))

    greedy = mean_max()
    assert mean_max(decoding="symmetries") < greedy
    assert mean_max(decoding="sampling", iterations=64) < greedy


def test_a_route_too_many_is_a_result() -> None:
    problems = [farm.to_problem(5) for farm in pondhop.generate(50, 20, seed=6)]
    plans = [pondhop.solve(problem, planner="am").plan for problem in problems]
    for plan in plans:
        assert plan.is_feasible == (len(plan.routes) <= 5)
        assert max(len(route) for route in plan.routes) <= 50 // 5 + 1


def test_sampling_draws_its_usual_number_where_nobody_says() -> None:
    problem = pondhop.generate(20, seed=6)[0].to_problem(3)
    drawn = attention.plan(problem, "am_minmax", decoding="sampling")[0]
    assert drawn == attention.plan(problem, "am_minmax", decoding="sampling", num_samples=attention.NUM_SAMPLES)[0]


def test_a_wrong_decoding_is_named_with_its_remedy() -> None:
    problem = pondhop.generate(5, seed=6)[0].to_problem(3)
    with pytest.raises(InvalidInput) as caught:
        pondhop.solve(problem, planner="am-minmax", decoding="beam")  # type: ignore[arg-type]
    (fault,) = caught.value.faults
    assert (fault.path, fault.action) == ("decoding", "choose one of: greedy, symmetries, sampling")
    with pytest.raises(ValueError, match="greedy"):
        attention.load_model("am50").plan(problem, decoding="beam")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="num_samples"):
        attention.load_model("am50").plan(problem, decoding="sampling", num_samples=0)


def test_decodings_are_those_of_the_planners() -> None:
    assert get_args(Decoding) == get_args(pondhop.planners.Decoding)


@pytest.mark.parametrize("name", get_args(ModelName))
def test_shipped_weights_say_where_they_come_from(name: ModelName) -> None:
    with np.load(PACKAGE / f"{name}.npz", allow_pickle=False) as arrays:
        config = json.loads(str(arrays["config"]))
    assert {"architecture", "training", "num_steps", "date"} <= config.keys()
    assert "seed" in config["training"]
    assert (PACKAGE / f"{name}.npz").stat().st_size < 3_000_000


def test_a_model_shows_what_it_is() -> None:
    expected = "AttentionModel(variant='minmax', width=128, num_heads=8, num_layers=3, feed_forward_width=512)"
    assert repr(attention.load_model("am_minmax")) == expected


def test_routes_that_a_model_cannot_build_have_no_logits() -> None:
    problem = pondhop.generate(5, seed=6)[0].to_problem(1)
    with pytest.raises(InvalidInput) as caught:
        attention.load_model("am_minmax").logits(problem, [[0, 1], [2]])
    assert caught.value.faults[0].path == "routes[1]"


@pytest.fixture
def broken(tmp_path: Path) -> Callable[..., tuple[str, ...]]:
    """Change the arrays of shipped weights; return what reading them complains about."""

    def read(change: Callable[[dict[str, NDArray[Any]]], object]) -> tuple[str, ...]:
        with np.load(PACKAGE / "am_minmax.npz", allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        change(arrays)
        path = tmp_path / "broken.npz"
        with path.open("wb") as file:
            np.savez(file, **arrays)
        with pytest.raises(InvalidInput) as caught:
            attention.read_model(path)
        assert all(fault.path.startswith(str(path)) and fault.action for fault in caught.value.faults)
        return tuple(fault.path.removeprefix(f"{path}: ") + ": " + fault.message for fault in caught.value.faults)

    return read


def test_every_broken_tensor_is_named_at_once(broken: Callable[..., tuple[str, ...]]) -> None:
    def change(arrays: dict[str, NDArray[Any]]) -> None:
        del arrays["fixed.weight"]
        arrays["surplus"] = np.zeros(3, np.float32)
        arrays["depot.bias"] = np.zeros((4, 4), np.float32)
        arrays["pond.bias"] = np.full(128, np.nan)

    assert broken(change) == (
        'tensors["depot.bias"]: the shape is [4, 4], not [128]',
        'tensors["pond.bias"]: 128 of 128 values are not finite',
        'tensors["fixed.weight"]: the tensor is missing',
        'tensors["surplus"]: the model has no such part',
    )


def test_arrays_that_hold_no_numbers_are_named_with_the_others(broken: Callable[..., tuple[str, ...]]) -> None:
    def change(arrays: dict[str, NDArray[Any]]) -> None:
        del arrays["fixed.weight"]
        arrays["pond.bias"] = np.full(128, "x")

    assert broken(change) == (
        'tensors["pond.bias"]: this is no array of float32',
        'tensors["fixed.weight"]: the tensor is missing',
    )


@pytest.mark.parametrize(
    ("config", "complaints"),
    [
        ("{", ["it has no 'config' that is JSON with an 'architecture'"]),
        ("[]", ["it has no 'config' that is JSON with an 'architecture'"]),
        ('{"architecture": 3}', ["an object was expected"]),
        (
            '{"architecture": {"variant": "vrp", "width": 128, "num_heads": true, "num_layers": 3.5}}',
            ["variant is", "num_heads is true", "num_layers is 3.5", "feed_forward_width is null"],
        ),
        (
            json.dumps(
                {
                    "architecture": {
                        "variant": "cvrp",
                        "width": 128,
                        "num_heads": 7,
                        "num_layers": 9**9,
                        "feed_forward_width": 512,
                    }
                }
            ),
            ["not within 1 and 100", "7 heads cannot share"],
        ),
    ],
)
def test_a_broken_config_is_explained(
    broken: Callable[..., tuple[str, ...]], config: str, complaints: list[str]
) -> None:
    messages = broken(lambda arrays: arrays.update(config=np.array(config)))
    assert len(messages) == len(complaints)
    for message, complaint in zip(messages, complaints, strict=True):
        assert complaint in message


def test_a_file_without_config_is_explained(broken: Callable[..., tuple[str, ...]]) -> None:
    (message,) = broken(lambda arrays: arrays.pop("config"))
    assert "'config'" in message


@pytest.mark.parametrize("content", ["", "garbage", "array", "cut off", "object"])
def test_a_file_of_no_arrays_is_explained(content: str, tmp_path: Path) -> None:
    path = tmp_path / "weights.npz"
    shipped = (PACKAGE / "am50.npz").read_bytes()
    array = io.BytesIO()
    np.save(array, np.zeros(3))
    objects = io.BytesIO()
    np.savez(objects, config=np.array({"a": 1}))
    of_content = {"": b"", "garbage": b"weights", "array": array.getvalue(), "cut off": shipped[: len(shipped) // 2]}
    path.write_bytes(of_content.get(content, objects.getvalue()))
    with pytest.raises(InvalidInput, match=r"is no \.npz file"):
        attention.read_model(path)


def test_a_missing_file_is_an_operating_system_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        attention.read_model(tmp_path / "none.npz")


def test_the_core_takes_arrays_of_single_precision_only() -> None:
    with pytest.raises(InvalidInput) as caught:
        _core.AttentionModel(
            {"depot.bias": np.zeros(8)},  # type: ignore[dict-item]
            variant="cvrp",
            width=8,
            num_heads=1,
            num_layers=1,
            feed_forward_width=8,
        )
    assert caught.value.faults[0].path == 'tensors["depot.bias"]'
    assert len({fault.path for fault in caught.value.faults}) == len(caught.value.faults) == 20
    with pytest.raises(ValueError, match="minmax"):
        _core.AttentionModel({}, variant="vrp", width=8, num_heads=1, num_layers=1, feed_forward_width=8)  # type: ignore[arg-type]
