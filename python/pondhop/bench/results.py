"""The file of finished runs: results.csv, a row a run.

A row is appended when its run is finished and never changed, so whatever stops a benchmark costs at most the runs under
way. A last row without its line end was being written just then: it is cut off before the next one is appended. Plans,
if they are kept, lie beside it in plans.jsonl, each written before its row.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import astuple, fields
from pathlib import Path
from typing import Any, get_type_hints

from pondhop.bench.measure import Run
from pondhop.documents.atomic import write_all
from pondhop.errors import Fault, InvalidInput

RESULTS_NAME = "results.csv"
PLANS_NAME = "plans.jsonl"
_TYPES: dict[str, Callable[[str], object]] = get_type_hints(Run)
_COLUMNS = [column.name for column in fields(Run)]
_FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r", "'")
"""What makes a spreadsheet take a cell for a formula; a mark is marked, too, so that every text comes back."""

_ACTION = "give a results.csv of 'pondhop bench', or another folder"


class Results:
    """The runs in a folder.

    Parameters
    ----------
    folder
        Made if it is missing.
    is_keeping_plans
        Whether the routes of each run are kept too.

    Raises
    ------
    InvalidInput
        If there is a file of another kind in the folder.
    OSError
        If the folder cannot be made.
    """

    def __init__(self, folder: Path, *, is_keeping_plans: bool = False) -> None:
        self.path = folder / RESULTS_NAME
        self.plans_path = folder / PLANS_NAME
        self._is_keeping_plans = is_keeping_plans
        folder.mkdir(parents=True, exist_ok=True)
        if not self.path.exists():
            write_all({self.path: _csv_line(_COLUMNS)})
        self.runs = read_results(self.path)
        for path in (self.path, self.plans_path):
            _cut_unfinished_line(path)

    @property
    def finished(self) -> set[tuple[object, ...]]:
        """Keys of the runs that need not be done again; where plans are kept, of those whose plan is there."""
        keys = {run.key for run in self.runs}
        return keys & set(self.routes()) if self._is_keeping_plans else keys

    def routes(self) -> dict[tuple[object, ...], list[list[int]]]:
        """Return the routes that were kept, by the key of their run."""
        if not self.plans_path.exists():
            return {}
        faults, plans = [], {}
        with self.plans_path.open(encoding="utf-8", errors="replace") as lines:
            for number, line in enumerate(lines, start=1):
                try:
                    plan = json.loads(line)
                    plans[tuple(plan["key"])] = plan["routes"]
                except (ValueError, TypeError, KeyError, RecursionError):
                    place = f"{self.plans_path}, line {number}"
                    faults.append(Fault(place, "this is no plan of a run", "delete the line"))
        if faults:
            raise InvalidInput(faults)
        return plans

    def add(self, run: Run, routes: list[list[int]]) -> None:
        """Append a run."""
        if self._is_keeping_plans:
            _append(self.plans_path, json.dumps({"key": run.key, "routes": routes}, separators=(",", ":")) + "\n")
        _append(self.path, _csv_line(map(_cell, astuple(run))))
        self.runs.append(run)


def read_results(path: Path) -> list[Run]:
    """Read finished runs; of several of the same key, the last.

    Raises
    ------
    InvalidInput
        With every row that is none.
    OSError
        If the file cannot be read.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InvalidInput([Fault(str(path), "this is not a text file", _ACTION)]) from error
    lines = text.splitlines(keepends=True)
    if lines and not lines[-1].endswith("\n"):
        lines.pop()
    rows = csv.reader(lines)
    if next(rows, None) != _COLUMNS:
        raise InvalidInput([Fault(f"{path}, line 1", "these are not the columns of a benchmark's results", _ACTION)])
    faults = []
    runs = {}
    for row in _rows(path, rows):
        try:
            values: dict[str, Any] = {
                name: _TYPES[name](_value(cell)) for name, cell in zip(_COLUMNS, row, strict=True)
            }
        except ValueError as error:
            faults.append(Fault(f"{path}, line {rows.line_num}", f"this is not a run: {error}", "delete the line"))
        else:
            run = Run(**values)
            runs[run.key] = run
    if faults:
        raise InvalidInput(faults)
    return list(runs.values())


def _cell(value: object) -> str:
    """A value as a spreadsheet must take it: text that looks like a formula is marked as text."""
    text = str(value)
    return f"'{text}" if isinstance(value, str) and text.startswith(_FORMULA_STARTS) else text


def _value(cell: str) -> str:
    """What `_cell` was given, as text."""
    return cell[1:] if cell.startswith(tuple(f"'{start}" for start in _FORMULA_STARTS)) else cell


def _rows(path: Path, rows: Iterator[list[str]]) -> Iterator[list[str]]:
    """The rows of a table, of which a broken one may be as long as the file."""
    try:
        yield from rows
    except csv.Error as error:
        raise InvalidInput([Fault(str(path), f"this is no table: {error}", _ACTION)]) from error


def _csv_line(values: Iterable[str]) -> str:
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(values)
    return line.getvalue()


def _append(path: Path, text: str) -> None:
    with path.open("ab") as file:
        file.write(text.encode())


def _cut_unfinished_line(path: Path) -> None:
    if not path.exists():
        return
    with path.open("rb+") as file:
        content = file.read()
        file.truncate(content.rfind(b"\n") + 1)
