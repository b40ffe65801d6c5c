"""CSV to a task set: a header with name, T, C and any of D, prio, J, B; a line for each task."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from fractions import Fraction

from mauve.diagnostics.diagnostic import Report
from mauve.diagnostics.suggest import closest
from mauve.source import SourceFile, Span
from mauve.tasksets.faults import Faults, not_negative, positive, too_many, unique
from mauve.tasksets.json_input import GREATEST_PRIORITY, LEAST_PRIORITY
from mauve.tasksets.numbers import read_number
from mauve.tasksets.taskset import UNREADABLE, Document, Entry, KnownSpans, Path, Scheduler, TaskSet, Work

COLUMNS = ("name", "T", "D", "C", "prio", "J", "B")
NEEDED = ("name", "T", "C")

_CELL = re.compile(r'\s*("(?:[^"]|"")*"|[^,\n]*)')


def read_csv(file: SourceFile, report: Report) -> Document:
    """The one set of a file; what is wrong is reported (MV621 to MV624). Lines that are empty or begin with
    `#` are left out."""
    known: dict[Path, Span] = {}
    spans = KnownSpans(file, known)
    faults = Faults(spans, report)
    rows = _rows(file, known)
    if not rows:
        faults.add("MV621", (), f"there is no header `{','.join(COLUMNS)}`")
        return UNREADABLE
    header = _header(rows[0], faults)
    if header is None or too_many(len(rows) - 1, (), faults):
        return UNREADABLE
    entries = [_entry(row, index, header, faults) for index, row in enumerate(rows[1:], 1)]
    found = tuple(entry for entry in entries if entry is not None)
    if len(rows) == 1:
        faults.add("MV622", (0,), "there is no task below the header")
    unique([(entry.name, (*entry.path, "name")) for entry in found], "tasks", faults)
    faults.close()
    return UNREADABLE if faults.errors else Document((TaskSet("", Scheduler.PREEMPTIVE, "", found, spans),))


def _rows(file: SourceFile, known: dict[Path, Span]) -> list[list[str]]:
    """The cells of each line that holds a task, or the header, and where they stand."""
    rows: list[list[str]] = []
    for number, start in enumerate(file.line_starts, 1):
        line = file.line(number)
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        index = len(rows)
        known[(index,)] = Span(file, start, start + len(line))
        cells = next(csv.reader([line], skipinitialspace=True))
        at = 0
        for column in range(len(cells)):
            match = _CELL.match(line, at)
            if match is None:
                break
            known[index, column] = Span(file, start + match.start(1), start + len(line[: match.end(1)].rstrip()))
            at = match.end() + 1
        rows.append([cell.strip() for cell in cells])
    return rows


def _header(cells: list[str], faults: Faults) -> Mapping[str, int] | None:
    columns: dict[str, int] = {}
    for index, cell in enumerate(cells):
        name = next((column for column in COLUMNS if column.lower() == cell.lower()), "")
        if not name:
            near = closest(cell, COLUMNS)
            help_ = f"did you mean `{near[0]}`?" if near else f"the columns are {', '.join(COLUMNS)}"
            faults.add("MV622", (0, index), f"there is no column `{cell}`", help_)
        elif name in columns:
            faults.add("MV622", (0, index), f"the column `{name}` is there twice")
        else:
            columns[name] = index
    for name in NEEDED:
        if name not in columns and not faults.errors:
            faults.add("MV622", (0,), f"the column `{name}` is missing")
    return None if faults.errors else columns


def _entry(cells: list[str], row: int, header: Mapping[str, int], faults: Faults) -> Entry | None:
    if len(cells) > len(header):
        faults.add("MV621", (row, len(header)), f"the line has {len(cells)} cells, the header {len(header)}")
        return None
    texts = {name: cells[at] for name, at in header.items() if at < len(cells) and cells[at]}
    said = f"of `{texts['name']}`" if "name" in texts else "of the task"

    def time(column: str, what: str, zero: bool = True) -> Fraction | None:
        if column not in texts:
            if column in NEEDED:
                faults.add("MV622", (row,), f"{what} {said} is missing")
            return None
        path = (row, header[column])
        value = read_number(texts[column])
        if isinstance(value, str):
            faults.add("MV623", path, f"{what} {said}: {value}")
            return None
        check = not_negative if zero else positive
        return value if check(value, f"{what} {said}", path, faults) else None

    period, cost = time("T", "the period", zero=False), time("C", "the cost")
    deadline, jitter, blocking = time("D", "the deadline", zero=False), time("J", "the jitter"), time("B", "blocking")
    priority = _priority(texts, row, header, faults)
    if "name" not in texts:
        faults.add("MV622", (row,), "the task has no name")
    if period is None or cost is None or "name" not in texts:
        return None
    none = Fraction(0)
    return Entry(texts["name"], period, Work(cost), (row,), deadline, priority, jitter or none, blocking or none)


def _priority(texts: Mapping[str, str], row: int, header: Mapping[str, int], faults: Faults) -> int | None:
    if "prio" not in texts:
        return None
    value = read_number(texts["prio"])
    if isinstance(value, str) or value.denominator != 1 or not LEAST_PRIORITY <= value <= GREATEST_PRIORITY:
        message = f"a priority is a whole number from {LEAST_PRIORITY} to {GREATEST_PRIORITY}"
        faults.add("MV623", (row, header["prio"]), message)
        return None
    return int(value)
