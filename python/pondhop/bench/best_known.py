"""The best plans known: what a gap is measured from.

Two formats, told apart by the suffix:

- ``.json``: a list of objects with ``instance`` (name of the set), ``index`` (of the farm in it), ``routes_allowed``,
  ``best_max_route_length``, and where known ``total_length_at_best`` and ``digest`` (of the positions: it finds the
  farm under any other name). `write_best_known` writes these.
- ``.csv``: columns ``instance``, ``routes`` and ``best_max_route_length``, a farm of its own in each row, as lists of
  min-max results for TSPLIB files have them; ``instance`` is the name of the file, an underscore and the routes.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from pondhop.documents.atomic import write_all
from pondhop.errors import Fault, InvalidInput


@dataclass(frozen=True)
class BestPlan:
    """The best plan known of one farm with one number of routes.

    Attributes
    ----------
    set_name, index
        The set of the farm, and its place there.
    num_routes
        How many routes were allowed.
    max_route_length
        The shortest longest route known.
    total_length
        Of that plan, `None` where nobody says.
    digest
        Of the farm, `None` where nobody says.
    """

    set_name: str
    index: int
    num_routes: int
    max_route_length: float
    total_length: float | None = None
    digest: str | None = None

    @property
    def quality(self) -> tuple[float, float]:
        """Smaller is better: the longest route, then the total."""
        return self.max_route_length, math.inf if self.total_length is None else self.total_length


class BestKnown:
    """Best plans by farm and number of routes; of several, the best.

    An entry with a digest is for the farm of these positions under any name, others go by the name alone.
    """

    def __init__(self, plans: Iterable[BestPlan]) -> None:
        self._by_farm: dict[tuple[str, int], dict[int, BestPlan]] = {}
        for plan in plans:
            farm = (plan.set_name, plan.index) if plan.digest is None else (plan.digest, 0)
            of_farm = self._by_farm.setdefault(farm, {})
            known = of_farm.get(plan.num_routes)
            if known is None or plan.quality < known.quality:
                of_farm[plan.num_routes] = plan

    @property
    def plans(self) -> list[BestPlan]:
        """All of them."""
        return [plan for of_farm in self._by_farm.values() for plan in of_farm.values()]

    def num_routes_of(self, set_name: str, index: int, digest: str) -> list[int]:
        """Return for which numbers of routes a plan of the farm is known, ascending."""
        return sorted({number for of_farm in self._of_farm(set_name, index, digest) for number in of_farm})

    def find(self, set_name: str, index: int, digest: str, num_routes: int) -> BestPlan | None:
        """Return the best plan known, `None` if there is none."""
        plans = (of_farm.get(num_routes) for of_farm in self._of_farm(set_name, index, digest))
        return min((plan for plan in plans if plan is not None), key=lambda plan: plan.quality, default=None)

    def _of_farm(self, set_name: str, index: int, digest: str) -> tuple[dict[int, BestPlan], ...]:
        return self._by_farm.get((digest, 0), {}), self._by_farm.get((set_name, index), {})


NO_BEST_KNOWN = BestKnown(())


def read_best_known(path: Path) -> BestKnown:
    """Read a file of best plans in either format.

    Raises
    ------
    InvalidInput
        With every fault, each with its place.
    OSError
        If the file cannot be read.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InvalidInput([Fault(str(path), "this is not a text file", "give a file in UTF-8")]) from error
    if path.suffix.lower() == ".csv":
        rows = csv.DictReader(text.splitlines())
        records: list[tuple[str, object]] = [(f"{path}, line {rows.line_num}", row) for row in rows]
        read: Callable[[_Record], BestPlan] = _from_csv
    else:
        records = [(f"{path}[{index}]", value) for index, value in enumerate(_json_list(path, text))]
        read = _from_json
    if not records:
        raise InvalidInput([Fault(str(path), "there is no plan in this file", "give a list of best-known plans")])
    faults: list[Fault] = []
    plans = [read(_Record(place, value, faults)) for place, value in records]
    if faults:
        raise InvalidInput(faults)
    return BestKnown(plans)


def write_best_known(path: Path, plans: Iterable[BestPlan]) -> None:
    """Write best plans as JSON, one a line; the file is replaced as a whole.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    lines = []
    for plan in plans:
        record = {
            "instance": plan.set_name,
            "index": plan.index,
            "digest": plan.digest,
            "routes_allowed": plan.num_routes,
            "best_max_route_length": plan.max_route_length,
            "total_length_at_best": plan.total_length,
        }
        lines.append(json.dumps({key: value for key, value in record.items() if value is not None}))
    write_all({path: "[\n" + ",\n".join(lines) + "\n]\n"})


def _json_list(path: Path, text: str) -> list[object]:
    try:
        document = json.loads(text)
    except (json.JSONDecodeError, RecursionError) as error:
        action = "give a list of best-known plans"
        raise InvalidInput([Fault(str(path), f"this is not JSON: {error}", action)]) from error
    if not isinstance(document, list):
        message = f"a list was expected, not {type(document).__name__}"
        raise InvalidInput([Fault(str(path), message, "give a list of best-known plans")])
    return document


class _Record:
    """Reads the fields of one entry and collects what is wrong with them."""

    def __init__(self, place: str, value: object, faults: list[Fault]) -> None:
        self._place = place
        self._faults = faults
        self._fields = value if isinstance(value, dict) else {}
        if not isinstance(value, dict):
            faults.append(Fault(place, "an object was expected", 'give {"instance": ..., "index": ..., ...}'))

    def text(self, key: str) -> str:
        value = self._fields.get(key)
        if not isinstance(value, str) or not value:
            self._add(key, value, "give a name")
            return ""
        return value

    def optional_text(self, key: str) -> str | None:
        return self.text(key) if key in self._fields else None

    def whole_number(self, key: str, minimum: int) -> int:
        value = self._number(key)
        if value is None or value < minimum or value != int(value):
            self._add(key, self._fields.get(key), f"give a whole number of at least {minimum}")
            return minimum
        return int(value)

    def length(self, key: str) -> float:
        value = self._number(key)
        if value is None or value < 0:
            self._add(key, self._fields.get(key), "give a length")
            return 0.0
        return value

    def optional_length(self, key: str) -> float | None:
        return self.length(key) if key in self._fields else None

    def _number(self, key: str) -> float | None:
        value = self._fields.get(key)
        if isinstance(value, bool) or not isinstance(value, (int, float, str)):
            return None
        try:
            number = float(value)
        except (ValueError, OverflowError):
            return None
        return number if math.isfinite(number) else None

    def _add(self, key: str, value: object, action: str) -> None:
        if self._fields:
            message = f"{key} is {json.dumps(value)[:60]}" if key in self._fields else f"{key} is missing"
            self._faults.append(Fault(self._place, message, action))


def _from_json(record: _Record) -> BestPlan:
    return BestPlan(
        set_name=record.text("instance"),
        index=record.whole_number("index", 0),
        num_routes=record.whole_number("routes_allowed", 1),
        max_route_length=record.length("best_max_route_length"),
        total_length=record.optional_length("total_length_at_best"),
        digest=record.optional_text("digest"),
    )


def _from_csv(record: _Record) -> BestPlan:
    num_routes = record.whole_number("routes", 1)
    return BestPlan(
        set_name=record.text("instance").removesuffix(f"_{num_routes}"),
        index=0,
        num_routes=num_routes,
        max_route_length=record.length("best_max_route_length"),
    )
