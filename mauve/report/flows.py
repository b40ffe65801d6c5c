"""Flows in the result of a check: rows of a table, the shares of each task, and plain values for JSON."""

from __future__ import annotations

from collections.abc import Sequence

from mauve.diagnostics.style import Role, Style
from mauve.model.model import Latency
from mauve.report.table import Align, Cell, Column, Row, format_table
from mauve.timing import chains
from mauve.units import format_time
from mauve.verdict.flows import FlowResult, share_text

FLOWS = (
    Column("flow", elastic=True),
    Column("over", elastic=True),
    Column("reaction", Align.RIGHT),
    Column("data age", Align.RIGHT),
    Column("within", Align.RIGHT),
    Column("verdict"),
)


def format_flows(flows: Sequence[FlowResult], style: Style, limit: int | None, details: bool) -> list[str]:
    """The flows of a deployment as a table; with `details` the share of each task."""
    if not flows:
        return []
    lines = format_table(FLOWS, [_row(flow) for flow in flows], style, limit=limit)
    for flow in flows if details else ():
        for words, latency in _latencies(flow):
            if latency.total is not None:
                text = share_text(words, latency).split("\n")
                lines += ["", f"  {flow.flow.name}, {text[0]}", *(f"    {line}" for line in text[1:])]
    return ["", *lines]


def _latencies(flow: FlowResult) -> list[tuple[str, chains.Latency]]:
    found = flow.latencies
    return [] if found is None else [("reaction", found.reaction), ("data age", found.age)]


def _row(flow: FlowResult) -> Row:
    times = {words: one.total for words, one in _latencies(flow)}
    bounds = [times.get(words) for words in ("reaction", "data age")]
    reaction, age = ("no bound" if bound is None else format_time(bound) for bound in bounds)
    within = flow.flow.within
    verdict: str | Cell = ""
    limit = ""
    if within is not None:
        verdict = Cell("holds", Role.HELP) if flow.holds else Cell("late", Role.ERROR)
        which = "" if flow.flow.latency is Latency.BOTH else f" {flow.flow.latency.value}"
        limit = f"{format_time(within.value)}{which}"
    return (flow.flow.name, " -> ".join(flow.tasks), reaction, age, limit, verdict)


def flow_plain(flow: FlowResult) -> dict[str, object]:
    """A flow with its latencies and the share of each task, in picoseconds."""
    found = flow.latencies
    return {
        "name": flow.flow.name,
        "tasks": list(flow.tasks),
        "within_ps": flow.flow.within.value if flow.flow.within is not None else None,
        "bounds": flow.flow.latency.value,
        "holds": flow.holds,
        "reason": flow.reason or None,
        "reaction_ps": found.reaction.total if found else None,
        "age_ps": found.age.total if found else None,
        "reaction": [_share(share) for share in found.reaction.shares] if found else [],
        "age": [_share(share) for share in found.age.shares] if found else [],
    }


def _share(share: chains.Share) -> dict[str, object]:
    return {"task": share.hop, "wait_ps": share.wait, "work_ps": share.work}
