"""Responses term by term: the bill of each component's worst job, and its response per state and per transition."""

from __future__ import annotations

from collections.abc import Iterator

from mauve.diagnostics.style import Role, Style
from mauve.lower.placed import PlacedTask
from mauve.report.table import Align, Column, format_table
from mauve.timing.bill import Bill, BillLine, worst_bill
from mauve.timing.psm import PsmTransition
from mauve.timing.response import Analysis
from mauve.timing.transitions import TransitionResponse, state_responses, transition_responses
from mauve.units import format_time
from mauve.verdict.deadlines import bill_text
from mauve.verdict.result import NodeResult

MODES = (
    Column("region"),
    Column("state"),
    Column("transition"),
    Column("costs", Align.RIGHT),
    Column("WCRT", Align.RIGHT),
)

SHOWN_RUN = 16
"""Transitions of a run that a JSON document spells out."""


def format_details(node: NodeResult, style: Style) -> Iterator[str]:
    """Per component of a node: the bill of its response, then what a job responds in per state and transition."""
    analysis = node.analysis
    for placed in node.tasks.tasks if analysis is not None else ():
        name = placed.task.name
        bill = worst_bill(analysis, name) if analysis is not None else None
        if analysis is None or bill is None:
            continue
        response = analysis.result(name).wcrt or 0
        head = f"{name} responds within {format_time(response)}" + _arrival(placed, bill)
        first, *rest = bill_text(bill, placed, head).split("\n")
        yield ""
        yield f"  {style.paint(Role.MESSAGE, first)}"
        yield from (f"    {line}" for line in rest)
        found = transition_responses(analysis, name)
        if found:
            yield ""
            yield from format_table(MODES, list(_rows(found)), style)


def _arrival(placed: PlacedTask, bill: Bill) -> str:
    jitter = placed.task.jitter
    words = [f"its job {bill.job} of a busy period"] if bill.job > 1 else []
    words += [f"released up to {format_time(jitter)} late"] if jitter else []
    return f" ({', '.join(words)}):" if words else ":"


def _rows(found: tuple[TransitionResponse, ...]) -> Iterator[tuple[str, ...]]:
    for mode in state_responses(found):
        yield (mode.machine, mode.state, "any", "", format_time(mode.wcrt))
        for one in found:
            if (one.machine, one.transition.source) == (mode.machine, mode.state):
                arc = one.transition
                words = f"-> {arc.target}" + (f"  {arc.label}" if arc.label else "")
                yield ("", "", words, format_time(arc.cost), format_time(one.wcrt))


def details_plain(placed: PlacedTask, analysis: Analysis) -> dict[str, object]:
    """`modes` and `transitions` of a component, each with its response; empty where it has none."""
    found = transition_responses(analysis, placed.task.name)
    return {
        "modes": [{"region": one.machine, "state": one.state, "wcrt_ps": one.wcrt} for one in state_responses(found)],
        "transitions": [{"region": one.machine, **_transition(one.transition), "wcrt_ps": one.wcrt} for one in found],
    }


def _transition(one: PsmTransition) -> dict[str, object]:
    parts = [{"label": part.label, "cost_ps": part.cost, "count": part.count} for part in one.parts]
    return {"source": one.source, "target": one.target, "label": one.label, "cost_ps": one.cost, "parts": parts}


def bill_plain(bill: Bill | None, placed: PlacedTask) -> dict[str, object] | None:
    """The work of a window, term by term: `due` is blocking, own and interference together."""
    if bill is None:
        return None
    blocker = placed.blocker if bill.blocking else None
    return {
        "job": bill.job,
        "window_ps": bill.window,
        "due_ps": bill.due,
        "blocking_ps": bill.blocking,
        "blocker": {"task": blocker.holder, "section": blocker.what, "length_ps": blocker.length} if blocker else None,
        "own": {
            **_line(bill.own),
            "costs_ps": [list(work.trace) for work in bill.own.work],
            "runs": [run for work in bill.own.work for run in _run(work.name, work.run)],
        },
        "interference": [_line(line) for line in bill.others],
    }


def _run(region: str, run: tuple[PsmTransition, ...]) -> list[dict[str, object]]:
    """The transitions that make the work of a region so dear, in order; the last one is that of the job itself."""
    return [{"region": region, **_transition(one)} for one in run[:SHOWN_RUN]]


def _line(line: BillLine) -> dict[str, object]:
    return {
        "task": line.task,
        "kind": line.kind.value,
        "jobs": line.jobs,
        "cost_ps": line.cost,
        "overhead_ps": line.overhead,
    }
