"""A simulation for people: what was seen of each task beside what is proven of it, and a timeline in characters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from mauve.diagnostics.display import width
from mauve.diagnostics.style import Role, Style
from mauve.report.simulation_views import NOT_A_BOUND, Wait, describe, reach_note, show_mean, show_time, waits
from mauve.report.table import Align, Cell, Column, format_table
from mauve.timing.simulation.outcome import Activity, Measures, Outcome, Simulated
from mauve.timing.task import Kind

COLUMNS = (
    Column("task", elastic=True),
    Column("priority", Align.RIGHT),
    Column("period", Align.RIGHT),
    Column("jobs", Align.RIGHT),
    Column("least", Align.RIGHT),
    Column("mean", Align.RIGHT),
    Column("greatest", Align.RIGHT),
    Column("of job", Align.RIGHT),
    Column("bound", Align.RIGHT),
    Column("deadline", Align.RIGHT),
    Column("missed", Align.RIGHT),
    Column("preempted", Align.RIGHT),
    Column("blocked", Align.RIGHT),
    Column("load", Align.RIGHT),
)

TIMELINE = 100
"""Characters of the timeline, at most."""

LEGEND = "# runs  = in a section  - waits  ~ waits for less urgent work  ! misses a deadline"


def format_simulation(runs: Sequence[Simulated], style: Style, limit: int | None) -> str:
    """The tables and timelines of simulations. With a `limit` no line is wider, as far as numbers allow."""
    lines: list[str] = []
    for run in runs:
        for outcome, bounds in zip(run.outcomes, run.bounds, strict=True):
            lines += [*_processor(run, outcome, bounds, style, limit), ""]
    return "\n".join(lines[:-1]) + ("\n" if lines else "")


def _processor(
    run: Simulated, outcome: Outcome, bounds: Mapping[str, int | None], style: Style, limit: int | None
) -> Iterator[str]:
    def show(time: int) -> str:
        return show_time(time, run.unit)

    yield f"simulation of {run.name} on {outcome.processor.name}, {show(0)} to {show(outcome.end)} ({NOT_A_BOUND})"
    yield "  " + ", ".join(f"{name} {value}" for name, value in describe(outcome.settings))
    note = reach_note(run)
    if note:
        yield f"  {note}"
    yield ""
    rows = [
        _row(one, bounds.get(one.task), outcome, run.unit)
        for one in sorted(outcome.tasks, key=lambda one: -one.priority)
    ]
    yield from format_table(COLUMNS, rows, style, limit=limit)
    share = f"{100 * outcome.busy / outcome.end:.1f} %" if outcome.end else "none"
    yield f"  busy {share} of the time, idle {show(outcome.idle)}; context switches: {outcome.switches}, " + (
        f"preemptions: {outcome.preemptions}, deadlines missed: {outcome.misses}"
    )
    yield ""
    yield from _timeline(run, outcome, limit)


def _row(one: Measures, bound: int | None, outcome: Outcome, unit: str) -> list[Cell | str]:
    def show(time: int | None) -> str:
        return "" if time is None else show_time(time, unit)

    mean = "" if one.mean is None else show_mean(one.mean, unit)
    task = one.kind is Kind.TASK
    job = "" if one.worst_job is None else str(one.worst_job)
    return [
        one.task if task else f"({one.task})",
        str(one.priority) if task else "",
        show(one.period),
        str(one.finished) if one.finished == one.released else f"{one.finished} of {one.released}",
        show(one.least),
        mean,
        show(one.greatest),
        job,
        show(bound),
        show(one.deadline) if task else "",
        Cell(str(one.misses), Role.ERROR if one.misses else Role.PLAIN) if task else "",
        str(one.preemptions) if task else "",
        show(one.blocked) if one.blocked else "",
        f"{100 * one.busy / outcome.end:.1f} %" if outcome.end else "",
    ]


def _timeline(run: Simulated, outcome: Outcome, limit: int | None) -> Iterator[str]:
    """A row per task; each character stands for a part of the window, the most telling of what happens in it."""
    start, end = _telling(outcome)
    names = [one.task for one in sorted(outcome.tasks, key=lambda one: -one.priority)]
    if end <= start or not names:
        return
    indent = max(width_of(name) for name in names) + 4
    cells = min(TIMELINE, max(20, (limit or TIMELINE + indent) - indent), end - start)
    rows = {name: ["."] * cells for name in names}

    def mark(task: str, first: int, last: int, sign: str) -> None:
        low = (max(first, start) - start) * cells // (end - start)
        high = -(-(min(last, end) - start) * cells // (end - start))
        for cell in range(max(0, low), min(cells, max(high, low + 1))):
            if SIGNS.index(sign) > SIGNS.index(rows[task][cell]):
                rows[task][cell] = sign

    for wait in waits(outcome):
        mark(wait.task, wait.start, wait.end, "~" if wait.wait is Wait.BLOCKED else "-")
    for segment in outcome.segments:
        mark(segment.task, segment.start, segment.end, "=" if segment.activity is Activity.SECTION else "#")
    for job in outcome.jobs:
        if job.missed(outcome.end) and start <= job.deadline < end:
            mark(job.task, job.deadline, job.deadline + 1, "!")
    left, right = show_time(start, run.unit), show_time(end, run.unit)
    yield " " * indent + left + right.rjust(cells - len(left))
    for name in names:
        yield "  " + name + " " * (indent - 2 - width_of(name)) + "".join(rows[name])
    yield " " * indent + LEGEND


def _telling(outcome: Outcome) -> tuple[int, int]:
    """The window; of a whole long simulation two of the longest periods, where more would be a blur."""
    start, end = outcome.window
    longest = max((one.period for one in outcome.tasks), default=0)
    return (0, 2 * longest) if (start, end) == (0, outcome.end) and end > 4 * longest else (start, end)


SIGNS = ".-#=~!"
"""What a character of the timeline can be, the most telling last."""


def width_of(text: str) -> int:
    """The cells that a text takes on a terminal."""
    return sum(width(character) for character in text)
