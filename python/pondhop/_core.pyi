from collections.abc import Callable, Sequence
from typing import Literal, Self, SupportsIndex, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

@final
class Energy:
    def __new__(
        cls,
        *,
        takeoff_j: float = 0.0,
        leg_w: float = 0.0,
        leg_stop_w: float = 0.0,
        way_home_w: float = 0.0,
        way_home_fixed_j: float = 0.0,
        usable_j: float = ...,
    ) -> Self: ...
    @property
    def takeoff_j(self) -> float: ...
    @property
    def leg_w(self) -> float: ...
    @property
    def leg_stop_w(self) -> float: ...
    @property
    def way_home_w(self) -> float: ...
    @property
    def way_home_fixed_j(self) -> float: ...
    @property
    def usable_j(self) -> float: ...
    def replace(
        self,
        *,
        takeoff_j: float = ...,
        leg_w: float = ...,
        leg_stop_w: float = ...,
        way_home_w: float = ...,
        way_home_fixed_j: float = ...,
        usable_j: float = ...,
    ) -> Energy: ...

@final
class Problem:
    def __new__(
        cls,
        depot: ArrayLike,
        ponds: ArrayLike,
        num_drones: SupportsIndex,
        *,
        service_durations_s: ArrayLike | None = None,
        speed_m_s: float = 1.0,
        leg_stop_s: float = 0.0,
        max_length_m: float = ...,
        max_duration_s: float = ...,
        takeoff_s: float = 0.0,
        way_home_speed_m_s: float | None = None,
        way_home_fixed_s: float = 0.0,
        service_energies_j: ArrayLike | None = None,
        energy: Energy | None = None,
        layers: ArrayLike | None = None,
    ) -> Self: ...
    def replace(
        self,
        *,
        depot: ArrayLike = ...,
        ponds: ArrayLike = ...,
        num_drones: SupportsIndex = ...,
        service_durations_s: ArrayLike | None = ...,
        speed_m_s: float = ...,
        leg_stop_s: float = ...,
        max_length_m: float = ...,
        max_duration_s: float = ...,
        takeoff_s: float = ...,
        way_home_speed_m_s: float | None = ...,
        way_home_fixed_s: float = ...,
        service_energies_j: ArrayLike | None = ...,
        energy: Energy | None = ...,
        layers: ArrayLike | None = ...,
    ) -> Problem: ...
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
    @property
    def takeoff_s(self) -> float: ...
    @property
    def way_home_speed_m_s(self) -> float | None: ...
    @property
    def way_home_fixed_s(self) -> float: ...
    @property
    def service_energies_j(self) -> NDArray[np.float64]: ...
    @property
    def energy(self) -> Energy: ...
    # Shape (k, 4): seconds of take-off and way home, joules of both, for route i in row i.
    @property
    def layers(self) -> NDArray[np.float64]: ...

_ViolationKind = Literal["unserved", "repeated", "too_many_routes", "too_long", "too_slow", "too_much_energy"]

@final
class Violation:
    def __new__(
        cls,
        kind: _ViolationKind,
        pond: int | None = None,
        route: int | None = None,
        value: float | None = None,
        limit: float | None = None,
    ) -> Self: ...
    @property
    def kind(self) -> _ViolationKind: ...
    @property
    def pond(self) -> int | None: ...
    @property
    def route(self) -> int | None: ...
    @property
    def value(self) -> float | None: ...
    @property
    def limit(self) -> float | None: ...

@final
class Plan:
    # One array per route; legs are one more than ponds: the first has the take-off, the last leads home.
    @property
    def routes(self) -> list[list[int]]: ...
    @property
    def route_lengths(self) -> NDArray[np.float64]: ...
    @property
    def route_durations_s(self) -> NDArray[np.float64]: ...
    @property
    def route_energies_j(self) -> NDArray[np.float64]: ...
    @property
    def leg_lengths_m(self) -> list[NDArray[np.float64]]: ...
    @property
    def leg_durations_s(self) -> list[NDArray[np.float64]]: ...
    @property
    def leg_energies_j(self) -> list[NDArray[np.float64]]: ...
    @property
    def arrivals_s(self) -> list[NDArray[np.float64]]: ...
    @property
    def departures_s(self) -> list[NDArray[np.float64]]: ...
    # Shape (routes, 4): take-off; legs; on station; last leg, with the landing.
    @property
    def phase_durations_s(self) -> NDArray[np.float64]: ...
    @property
    def phase_energies_j(self) -> NDArray[np.float64]: ...
    @property
    def max_route_length(self) -> float: ...
    @property
    def total_length(self) -> float: ...
    @property
    def makespan_s(self) -> float: ...
    @property
    def violations(self) -> list[Violation]: ...
    @property
    def unserved(self) -> list[int]: ...
    @property
    def is_feasible(self) -> bool: ...

@final
class Separation:
    def __new__(cls, overlap: float, num_crossings: int, num_depot_leg_crossings: int) -> Self: ...
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
    def to_local(self, lonlat_deg: ArrayLike) -> NDArray[np.float64]: ...
    def to_geographic(self, local_m: ArrayLike) -> NDArray[np.float64]: ...

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

# Row and column 0 are the depot, i + 1 is pond i; row 0 holds the first legs of routes, column 0 the ways home.
def leg_lengths(problem: Problem) -> NDArray[np.float64]: ...
def leg_durations(problem: Problem) -> NDArray[np.float64]: ...
def encounters(
    tracks: Sequence[tuple[int, NDArray[np.float64]]], horizontal_m: float, vertical_m: float, of: int | None = None
) -> list[tuple[int, int, float, float, float, float, float]]: ...
def least_distance(
    tracks: Sequence[tuple[int, NDArray[np.float64]]],
) -> tuple[float, int, int, float] | None: ...
def separation(problem: Problem, routes: Sequence[Sequence[int]]) -> Separation: ...
def lower_bound(problem: Problem) -> float: ...
def lower_bound_of_makespan(problem: Problem) -> float: ...
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

@final
class Round:
    def __new__(
        cls,
        problem: Problem,
        *,
        windows: Sequence[Sequence[tuple[float, float]]] | None = None,
        releases_s: ArrayLike | None = None,
        loads: ArrayLike | None = None,
        priorities: ArrayLike | None = None,
        capacity: float = ...,
        shift_s: tuple[float, float] = ...,
        takeoff_interval_s: float = 0.0,
        turnaround_s: float | None = None,
        num_pads: int | None = None,
        wind_m_s: tuple[float, float] = (0.0, 0.0),
        max_airspeed_m_s: float = ...,
        drag_power_w_per_m3_s3: float = 0.0,
        rounding: Literal["exact", "dimacs"] = "exact",
    ) -> Self: ...
    @property
    def num_visits(self) -> int: ...

@final
class Trip:
    @property
    def visits(self) -> list[int]: ...
    @property
    def departure_s(self) -> float: ...
    @property
    def arrival_s(self) -> float: ...
    @property
    def ready_s(self) -> float: ...
    @property
    def length_m(self) -> float: ...
    @property
    def energy_j(self) -> float: ...
    @property
    def times_s(self) -> NDArray[np.float64]: ...
    @property
    def legs(self) -> NDArray[np.float64]: ...
    @property
    def energies_j(self) -> NDArray[np.float64]: ...

@final
class RoundViolation:
    @property
    def kind(self) -> str: ...
    @property
    def visit(self) -> int | None: ...
    @property
    def route(self) -> int | None: ...
    @property
    def trip(self) -> int | None: ...
    @property
    def value(self) -> float | None: ...
    @property
    def limit(self) -> float | None: ...

@final
class RoundPlan:
    @property
    def trips(self) -> list[list[Trip]]: ...
    @property
    def routes(self) -> list[list[list[int]]]: ...
    @property
    def total_length(self) -> float: ...
    @property
    def total_energy_j(self) -> float: ...
    @property
    def makespan_s(self) -> float: ...
    @property
    def is_feasible(self) -> bool: ...
    @property
    def violations(self) -> list[RoundViolation]: ...

def search_round(
    problem: Round,
    *,
    seed: int = 1,
    time_limit_s: float | None = None,
    iterations: int | None = None,
    threads: int = 1,
    objective: Literal["max", "total"] = "max",
    progress: Callable[[float, int, float], object] | None = None,
) -> tuple[list[list[list[int]]], float, int, bool]: ...
def evaluate_round(
    problem: Round,
    routes: Sequence[Sequence[Sequence[int]]],
    holds_s: Sequence[Sequence[float]] | None = None,
) -> RoundPlan: ...
def round_bound(problem: Round) -> float: ...
