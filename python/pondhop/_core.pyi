from collections.abc import Callable, Sequence
from typing import Literal, final

import numpy as np
from numpy.typing import NDArray

__version__: str

@final
class Problem:
    def __init__(
        self,
        depot: Sequence[float] | NDArray[np.float64],
        ponds: NDArray[np.float64],
        num_drones: int,
        *,
        service_durations_s: NDArray[np.float64] | None = None,
        speed_m_s: float = 1.0,
        leg_stop_s: float = 0.0,
        max_length_m: float = ...,
        max_duration_s: float = ...,
    ) -> None: ...
    @property
    def depot(self) -> NDArray[np.float64]: ...
    @property
    def ponds(self) -> NDArray[np.float64]: ...
    @property
    def num_ponds(self) -> int: ...
    @property
    def num_drones(self) -> int: ...
    @property
    def service_durations_s(self) -> NDArray[np.float64]: ...
    @property
    def speed_m_s(self) -> float: ...
    @property
    def leg_stop_s(self) -> float: ...
    @property
    def max_length_m(self) -> float: ...
    @property
    def max_duration_s(self) -> float: ...

@final
class Plan:
    @property
    def routes(self) -> list[list[int]]: ...
    @property
    def route_lengths(self) -> NDArray[np.float64]: ...
    @property
    def route_durations_s(self) -> NDArray[np.float64]: ...
    @property
    def arrivals_s(self) -> list[NDArray[np.float64]]: ...
    @property
    def departures_s(self) -> list[NDArray[np.float64]]: ...
    @property
    def max_route_length(self) -> float: ...
    @property
    def total_length(self) -> float: ...
    @property
    def makespan_s(self) -> float: ...
    @property
    def violations(self) -> list[str]: ...
    @property
    def unserved(self) -> list[int]: ...
    @property
    def is_feasible(self) -> bool: ...

@final
class Separation:
    @property
    def overlap(self) -> float: ...
    @property
    def num_crossings(self) -> int: ...
    @property
    def num_depot_leg_crossings(self) -> int: ...

@final
class LocalFrame:
    def __init__(self, longitude_deg: float, latitude_deg: float) -> None: ...
    @property
    def origin_deg(self) -> tuple[float, float]: ...
    def to_local(self, lonlat_deg: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def to_geographic(self, local_m: NDArray[np.float64]) -> NDArray[np.float64]: ...

@final
class AttentionModel:
    def __init__(
        self,
        tensors: dict[str, NDArray[np.float32]],
        *,
        variant: Literal["cvrp", "minmax"],
        width: int,
        num_heads: int,
        num_layers: int,
        feed_forward_width: int,
    ) -> None: ...
    def plan(
        self,
        problem: Problem,
        *,
        decoding: Literal["greedy", "symmetries", "sampling"] = "greedy",
        num_samples: int = 1,
        seed: int = 1,
    ) -> tuple[list[list[int]], float]: ...
    def logits(self, problem: Problem, routes: Sequence[Sequence[int]]) -> NDArray[np.float32]: ...

def evaluate(problem: Problem, routes: Sequence[Sequence[int]]) -> Plan: ...
def generate(
    num_ponds: int, seed: int, variant: Literal["authors", "paper"] = "authors"
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], float]: ...
def separation(problem: Problem, routes: Sequence[Sequence[int]]) -> Separation: ...
def lower_bound(problem: Problem) -> float: ...
def lower_bound_of_total(problem: Problem) -> float: ...
def hpp(problem: Problem, *, seed: int = 1) -> tuple[list[list[int]], float]: ...
def hpp_clusters(problem: Problem, *, seed: int = 1) -> list[tuple[list[int], list[int], NDArray[np.float64]]]: ...
def search(
    problem: Problem,
    *,
    seed: int = 1,
    time_limit_s: float | None = None,
    iterations: int | None = None,
    threads: int = 1,
    slack: float = 0.0,
    objective: Literal["max", "total"] = "max",
    start: Sequence[Sequence[int]] | None = None,
    progress: Callable[[float, int, float], object] | None = None,
) -> tuple[list[list[int]], float, int, bool]: ...
def territory(
    problem: Problem,
    *,
    seed: int = 1,
    time_limit_s: float | None = None,
    iterations: int | None = None,
    progress: Callable[[float, int, float], object] | None = None,
) -> tuple[list[list[int]], float, bool]: ...
