"""Sensitivity and proposed priorities in the result of a check: tables, and plain values for JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mauve.diagnostics.style import Role, Style
from mauve.report.table import Align, Cell, Column, format_table
from mauve.timing.priorities import PriorityRange
from mauve.timing.sensitivity import CostSlack
from mauve.units import format_time
from mauve.verdict.result import DeploymentResult, NodeResult
from mauve.verdict.sensitivity import NodeSensitivity, Proposal, lowest

CODELS = (
    Column("codel", elastic=True),
    Column("takes", Align.RIGHT),
    Column("may take", Align.RIGHT),
    Column("room", Align.RIGHT),
)
TASKS = (
    Column("component", elastic=True),
    Column("period", Align.RIGHT),
    Column("at least", Align.RIGHT),
    Column("priority", Align.RIGHT),
    Column("may be"),
)
PRIORITIES = (
    Column("component", elastic=True),
    Column("priority", Align.RIGHT),
    Column("now", Align.RIGHT),
    Column("deadline", Align.RIGHT),
    Column("WCRT", Align.RIGHT),
    Column("verdict"),
)


def format_sensitivity(result: DeploymentResult, style: Style, limit: int | None) -> Iterator[str]:
    """What may change in each node, a table each for codels and for components; then the priorities proposed."""
    for node, found in zip(result.nodes, result.sensitivity, strict=False):
        yield from _node(node, found, style, limit)
    for node, proposal in zip(result.nodes, result.proposals, strict=False):
        yield from _proposal(node, proposal, style, limit)


def _node(node: NodeResult, found: NodeSensitivity, style: Style, limit: int | None) -> Iterator[str]:
    yield ""
    rows = [_cost(one) for one in (*found.codels, *found.overheads)]
    yield from format_table(CODELS, rows, style, limit=limit)
    periods = {one.task: one.at_least for one in found.periods}
    ranges = {one.task: one for one in found.ranges}
    if ranges:
        yield ""
        tasks = []
        for placed in node.tasks.tasks:
            name, period = placed.task.name, "-"
            if name in periods:
                least = periods[name]
                period = "none holds" if least is None else format_time(least)
            row = (name, format_time(placed.task.period), period, str(placed.task.priority), ranges_text(ranges[name]))
            tasks.append(row)
        yield from format_table(TASKS, tasks, style, limit=limit)
    for name, reason in found.withheld.items():
        which = f"the period of {name} is" if name else "periods, frequency and priorities are"
        yield f"  {which} not varied: {reason}"
    if found.speed is not None:
        yield f"  lowest frequency, if all times scale with it: {lowest(node.tasks.node, found.speed)}"


def _cost(one: CostSlack) -> tuple[str | Cell, ...]:
    if one.at_most is None:
        return one.name, format_time(one.now), Cell("nothing", Role.ERROR), ""
    most, room = format_time(one.at_most, down=True), format_time(one.growth or 0, down=True)
    role = None if one.at_most >= one.now else Role.ERROR
    return one.name, format_time(one.now), Cell(most, role) if role else most, Cell(room, role) if role else room


def ranges_text(found: PriorityRange) -> str:
    """`2 or less, 5 to 7, 9 or more`."""
    return ", ".join(_range(low, high) for low, high in found.ranges) or "none holds"


def _range(low: int | None, high: int | None) -> str:
    if low is None and high is None:
        return "any"
    if low is None:
        return f"{high} or less"
    if high is None:
        return f"{low} or more"
    return str(low) if low == high else f"{low} to {high}"


def _proposal(node: NodeResult, proposal: Proposal, style: Style, limit: int | None) -> Iterator[str]:
    yield ""
    if proposal.priorities is None:
        stuck = ", ".join(proposal.stuck)
        text = f"  no priorities make all deadlines hold: none of {stuck} can be the least urgent"
        yield style.paint(Role.ERROR, text)
        return
    rows: list[tuple[str | Cell, ...]] = []
    for placed in sorted(node.tasks.tasks, key=lambda one: -(proposal.priorities or {})[one.task.name]):
        name = placed.task.name
        response = proposal.responses.get(name)
        good = response is not None and response <= placed.task.deadline
        told = "no bound" if response is None else format_time(response)
        verdict = Cell("holds", Role.HELP) if good else Cell("missed", Role.ERROR)
        now, then = str(placed.task.priority), str(proposal.priorities[name])
        rows.append((name, then, now, format_time(placed.task.deadline), told, verdict))
    yield from format_table(PRIORITIES, rows, style, limit=limit)
    yield f"  priorities: {proposal.policy.value}"


def sensitivity_plain(found: Sequence[NodeSensitivity]) -> list[dict[str, object]]:
    """Per node what may change, in picoseconds and hertz."""
    return [
        {
            "node": one.node,
            "codels": [_cost_plain(cost, "codel") for cost in one.codels],
            "overheads": [_cost_plain(cost, "name") for cost in one.overheads],
            "periods": [
                {"component": each.task, "period_ps": each.now, "at_least_ps": each.at_least} for each in one.periods
            ],
            "priorities": [
                {"component": each.task, "priority": each.now, "ranges": [list(pair) for pair in each.ranges]}
                for each in one.ranges
            ],
            "frequency_hz_at_least": one.hertz,
            "speed_factor": float(one.speed.factor) if one.speed and one.speed.factor is not None else None,
            "withheld": [{"component": name or None, "reason": reason} for name, reason in one.withheld.items()],
        }
        for one in found
    ]


def _cost_plain(one: CostSlack, key: str) -> dict[str, object]:
    return {key: one.name, "now_ps": one.now, "at_most_ps": one.at_most, "slack_ps": one.growth}


def proposals_plain(found: Sequence[Proposal]) -> list[dict[str, object]]:
    """Per node the priorities proposed; null where none are found."""
    return [
        {
            "node": one.node,
            "policy": one.policy.value,
            "holds": one.holds,
            "priorities": None
            if one.priorities is None
            else [
                {"component": name, "priority": priority, "wcrt_ps": one.responses.get(name)}
                for name, priority in one.priorities.items()
            ],
            "stuck": list(one.stuck),
        }
        for one in found
    ]
