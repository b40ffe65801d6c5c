"""The result of a check as tables: codels with their times, components with their responses, the load, the verdict."""

from __future__ import annotations

from mauve.diagnostics.style import Role, Style
from mauve.lower.codels import CodelTime, Source
from mauve.lower.tasks import PlacedTask
from mauve.pipeline import CheckResult, DeploymentResult, NodeResult
from mauve.report.table import Align, Cell, Column, Row, format_table
from mauve.timing.task import Kind, trace_length
from mauve.units import format_time

TRACE_SHOWN = 6
"""Elements of a trace that fit into a table."""


def format_check(result: CheckResult, style: Style) -> str:
    """The whole result, a section per deployment; empty where nothing was analysed."""
    return "\n".join(line for deployment in result.deployments for line in [*_deployment(deployment, style), ""])


def _deployment(result: DeploymentResult, style: Style) -> list[str]:
    deployment = result.deployment
    boards = dict.fromkeys(f"{n.board.name} ({n.board.core} at {_frequency(n.board.hertz)})" for n in deployment.nodes)
    title = f"deployment {deployment.name} of {deployment.architecture.name}"
    lines = [style.paint(Role.MESSAGE, title) + (f" on {', '.join(boards)}" if boards else ""), ""]
    lines += _codels(result, style)
    for node in result.nodes:
        lines += ["", *_node(node, result, style)]
    return [*lines, "", _verdict(result, style)]


def _frequency(hertz: int) -> str:
    for unit, size in (("GHz", 10**9), ("MHz", 10**6), ("kHz", 10**3)):
        if hertz % size == 0:
            return f"{hertz // size} {unit}"
    return f"{hertz} Hz"


def _codels(result: DeploymentResult, style: Style) -> list[str]:
    columns = (
        Column("codel"),
        Column("cycles", Align.RIGHT),
        Column("WCET", Align.RIGHT),
        Column("origin"),
        Column("function"),
    )
    return format_table(columns, [_codel(codel) for codel in result.codels], style)


def _codel(codel: CodelTime) -> Row:
    name = str(codel.plan.id)
    if codel.time is None or codel.source is None:
        return (name, "-", Cell("none", Role.ERROR), Cell("no bound", Role.ERROR), "")
    cycles = codel.result.cycles if codel.result and codel.source is Source.DERIVED else None
    origin = codel.source.value
    function = ""
    if codel.source is Source.DERIVED and codel.result is not None:
        annotated = any(loop.origin is not None and loop.origin.value == "annotation" for loop in codel.result.loops)
        origin += " with flow facts" if annotated else ""
        function = codel.result.name
    role = Role.PLAIN if codel.source is Source.DERIVED else Role.WARNING
    return (name, _grouped(cycles) if cycles is not None else "", format_time(codel.time), Cell(origin, role), function)


def _grouped(number: int) -> str:
    return f"{number:,}".replace(",", " ")


def _node(node: NodeResult, result: DeploymentResult, style: Style) -> list[str]:
    columns = (
        Column("component"),
        Column("period", Align.RIGHT),
        Column("priority", Align.RIGHT),
        Column("trace e1, e2, ..."),
        Column("load", Align.RIGHT),
        Column("WCRT", Align.RIGHT),
        Column("deadline", Align.RIGHT),
        Column("slack", Align.RIGHT),
        Column("verdict"),
    )
    rows = [_task(placed, node) for placed in node.tasks.tasks]
    rows += [(name, "", "", "", "", "", "", "", Cell("incomplete", Role.ERROR)) for name in _left_out(node, result)]
    lines = format_table(columns, rows, style)
    if node.analysis is None:
        return lines
    others = [task for task in node.analysis.tasks if task.kind is not Kind.TASK]
    lines += [
        f"  {task.name} every {format_time(task.period)}: {format_time(task.demand(1))} "
        f"({100 * float(task.load):.2f} % of the processor)"
        for task in others
    ]
    total = sum(float(task.load) for task in node.analysis.tasks)
    switch = node.tasks.node.board.context_switch
    about = f", two context switches of {format_time(switch)} per activation included" if switch else ""
    lines.append(f"  load of {node.tasks.node.name}: {total:.3f} ({node.analysis.method.value} method{about})")
    return lines


def _left_out(node: NodeResult, result: DeploymentResult) -> list[str]:
    """The components of this node without a task, because a codel has no time."""
    if node.tasks.complete or len(result.nodes) > 1:
        return []
    there = {instance.name for placed in node.tasks.tasks for instance in placed.instances}
    return [i.name for i in result.deployment.architecture.instances if i.active and i.name not in there]


def _task(placed: PlacedTask, node: NodeResult) -> Row:
    task = placed.task
    priority = f"{task.priority}{'*' if placed.priority.default else ''}"
    deadline = f"{format_time(task.deadline)}{'*' if placed.deadline.default else ''}"
    if node.analysis is None:
        return (task.name, format_time(task.period), priority, "", "", "", deadline, "", "incomplete")
    result = node.analysis.result(task.name)
    analysed = node.analysis.task(task.name)
    length = min(TRACE_SHOWN, trace_length(task, [t for t in node.analysis.tasks if t.kind is Kind.TASK]))
    trace = ", ".join(format_time(e) for e in analysed.trace(length))
    load = f"{float(analysed.load):.3f}"
    verdict = Cell("holds", Role.HELP) if result.schedulable else Cell("missed", Role.ERROR)
    if result.wcrt is None or result.slack is None:
        return (task.name, format_time(task.period), priority, trace, load, "none", deadline, "", verdict)
    response = format_time(result.wcrt)
    slack = format_time(result.slack, down=True)
    return (task.name, format_time(task.period), priority, trace, load, response, deadline, slack, verdict)


def _verdict(result: DeploymentResult, style: Style) -> str:
    name = result.deployment.name
    expected = result.deployment.expect_unschedulable is not None
    defaults = any(p.priority.default or p.deadline.default for node in result.nodes for p in node.tasks.tasks)
    mark = "  (* by default)" if defaults else ""
    if not result.complete:
        return style.paint(Role.ERROR, f"{name}: incomplete, no verdict") + mark
    count = sum(len(node.tasks.tasks) for node in result.nodes)
    missed = sum(not r.schedulable for n in result.nodes if n.analysis for r in n.analysis.results)
    if result.holds:
        text = f"{name}: all {count} deadlines hold, always" + (", unexpectedly" if expected else "")
        return style.paint(Role.ERROR if expected else Role.HELP, text) + mark
    text = f"{name}: {missed} of {count} deadlines missed" + (", as expected" if expected else "")
    return style.paint(Role.NOTE if expected else Role.ERROR, text) + mark
