"""Which planners take part in the report, and what a farm is expected to cost them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from pondhop.bench.measure import Entrant, TimeLimit, parse_entrants
from pondhop.errors import Fault, InvalidInput
from pondhop.planners import ORTOOLS, PYVRP
from pondhop.report.printed import Column

Kind = Literal["ours", "baseline", "yours"]


@dataclass(frozen=True)
class Method:
    """A planner with its options and time limit.

    Attributes
    ----------
    label
        What tables and figures call it.
    planner
        As in ``--planners``: a name with options, or ``module:function``.
    kind
        Of this package's family, one of the baselines, or a planner of your own.
    time_limit
        For a farm; none for planners that end by themselves.
    seconds_at_100, growth
        The seconds it is expected to take for n ponds are ``seconds_at_100 * (n / 100) ** growth``: measured once on
        one core of 2.5 GHz, to choose how many farms it gets. Tables show what was measured this time.
    most_ponds
        Of the farms it is tried on; larger ones would need more memory than time.
    needs
        What to install beside pondhop; empty if nothing.
    printed
        The paper's column of the same method, `None` if it has none.
    """

    label: str
    planner: str
    kind: Kind
    time_limit: TimeLimit = field(default_factory=TimeLimit)
    seconds_at_100: float = 0.0
    growth: float = 0.0
    most_ponds: int = 10_000
    needs: str = ""
    printed: Column | None = None

    @cached_property
    def entrant(self) -> Entrant:
        """The planner, ready to run.

        Raises
        ------
        InvalidInput
            As `parse_entrants`: where a package is missing, with what to install.
        """
        (entrant,) = parse_entrants(self.planner)
        return entrant

    def require(self) -> None:
        """Load the planner and plan two ponds with it, so that nothing is under way when it turns out to be missing.

        Raises
        ------
        InvalidInput
            As `entrant`.
        """
        _ = self.entrant

    @property
    def name(self) -> str:
        """The planner alone, without options and time limit."""
        return self.planner if self.kind == "yours" else self.planner.partition(":")[0]

    def seconds(self, num_ponds: int) -> float:
        """Return the seconds that a farm is expected to take."""
        own: float = self.seconds_at_100 * (num_ponds / 100) ** self.growth
        return own + (self.time_limit.seconds or 0.0)


def _limited(planner: str, kind: Kind, seconds: float, *, most_ponds: int = 10_000, needs: str = "") -> Method:
    words = f"{1e3 * seconds:g} ms" if seconds < 1 else f"{seconds:g} s"
    return Method(f"{planner}, {words}", planner, kind, TimeLimit(seconds), most_ponds=most_ponds, needs=needs)


INSTALL_ORTOOLS, INSTALL_PYVRP = f"pip install '{ORTOOLS}'", f"pip install '{PYVRP}'"

SEARCH = _limited("search", "ours", 0.01)
"""The planner that the rivals are compared with, and how long it may take."""

LONG_SEARCH = _limited("search", "ours", 1.0)
"""What the same planner makes of more time."""

WITHIN_LIMITS_S = (0.01, 0.1, 1.0)
"""What `search` is given in turn, until its total is no longer than a rival's at an equal longest route."""

METHODS: tuple[Method, ...] = (
    _limited("search", "ours", 0.001),
    SEARCH,
    _limited("search", "ours", 0.1),
    LONG_SEARCH,
    Method("territory", "territory", "ours", seconds_at_100=0.012, growth=0.9),
    Method("hpp", "hpp", "ours", seconds_at_100=0.0002, growth=0.7, printed="HPP"),
    Method(
        "ortools",
        "ortools",
        "baseline",
        seconds_at_100=10.0,
        growth=2.5,
        needs=INSTALL_ORTOOLS,
        printed="GLOP",
    ),
    _limited("ortools-gls", "baseline", 10.0, most_ponds=1000, needs=INSTALL_ORTOOLS),
    _limited("pyvrp", "baseline", 10.0, most_ponds=1000, needs=INSTALL_PYVRP),
    Method("am", "am", "baseline", seconds_at_100=0.005, growth=1.7, most_ponds=2000, printed="AM50"),
    Method(
        "am, 8 symmetries",
        "am:decoding=symmetries",
        "baseline",
        seconds_at_100=0.04,
        growth=1.7,
        most_ponds=2000,
    ),
    Method("am-minmax", "am-minmax", "baseline", seconds_at_100=0.005, growth=1.7, most_ponds=2000),
    Method(
        "am-minmax, 8 symmetries",
        "am-minmax:decoding=symmetries",
        "baseline",
        seconds_at_100=0.04,
        growth=1.7,
        most_ponds=2000,
    ),
)
"""All methods of the report in the order of its tables."""

ANYTIME = ("search", "territory", "ortools-gls", "pyvrp")
"""Planners that get better with more time: lines in the plot of quality against time, the others are points."""


@dataclass(frozen=True)
class LeftOut:
    """A method that cannot run here.

    Attributes
    ----------
    label
        Of the method.
    reason, action
        Why, and how to have it the next time.
    """

    label: str
    reason: str
    action: str


def own_methods(planners: Iterable[str], most_ponds: int) -> list[Method]:
    """Return planners of your own as methods: they take no time limit and are not known to be slow.

    Parameters
    ----------
    planners
        As in ``--planners``.
    most_ponds
        Larger farms they are not tried on.

    Raises
    ------
    InvalidInput
        With everything that is wrong with them, or if one is there already.
    """
    methods = []
    faults: list[Fault] = []
    taken = {method.label for method in METHODS}
    for planner in planners:
        method = Method(planner, planner, "yours", most_ponds=most_ponds)
        if planner in taken:
            faults.append(Fault(f"planner {planner}", "the report has this planner already", "give each planner once"))
            continue
        taken.add(planner)
        try:
            method.require()
        except InvalidInput as error:
            faults += error.faults
        methods.append(method)
    if faults:
        raise InvalidInput(faults)
    return methods


def installed(methods: Sequence[Method]) -> tuple[list[Method], list[LeftOut]]:
    """Return the methods that can run here, and why the other ones cannot.

    Only baselines may be missing: they need packages that pondhop does not bring.

    Raises
    ------
    InvalidInput
        If a planner that needs nothing else cannot run.
    """
    present, left_out = [], []
    for method in methods:
        try:
            method.require()
        except InvalidInput as error:
            if method.kind != "baseline":
                raise
            reasons, actions = zip(*((fault.message, fault.action) for fault in error.faults), strict=True)
            left_out.append(LeftOut(method.label, "; ".join(reasons), "; ".join(dict.fromkeys(actions))))
        else:
            present.append(method)
    return present, left_out
