"""The result of a check as tables: codels with their times, components with their responses, the load, the verdict."""

from __future__ import annotations

from collections import Counter
from itertools import groupby
from textwrap import wrap

from mauve.diagnostics.style import Role, Style
from mauve.lower.codels import CodelTime, Source
from mauve.lower.placed import PlacedTask
from mauve.records import changed
from mauve.report.flows import format_flows
from mauve.report.table import Align, Cell, Column, Row, format_table, percent
from mauve.timing.response import Analysis, Method, ResponseResult
from mauve.timing.task import Kind, Task, trace_length
from mauve.units import format_time
from mauve.verdict.result import CheckResult, DeploymentResult, NodeResult, executed
from mauve.verdict.stack import stack_use

TRACE_RUNS = 3
"""How many runs of equal elements a table shows of a trace."""

TRACE_LENGTH = 1000
"""How many elements of a trace are looked at for it."""

CODELS = (
    Column("codel", elastic=True),
    Column("cycles", Align.RIGHT),
    Column("WCET", Align.RIGHT),
    Column("origin"),
    Column("function", elastic=True),
)
COMPONENTS = (
    Column("component", elastic=True),
    Column("period", Align.RIGHT),
    Column("priority", Align.RIGHT),
    Column("deadline", Align.RIGHT),
    Column("trace e1, e2, ...", elastic=True),
    Column("load", Align.RIGHT),
    Column("WCRT", Align.RIGHT),
    Column("slack", Align.RIGHT),
    Column("verdict"),
)


LINE = 110
"""Sentences are broken into lines of about so many characters."""

NARROW = 100
"""On fewer columns the table of components goes without the slack."""


def format_check(result: CheckResult, style: Style, limit: int | None = None, details: bool = False) -> str:
    """The whole result, a section per deployment; empty where nothing was analysed. `limit` is the width to keep to,
    `details` asks for the bill of each response and the share of each task in a flow."""
    if result.model is not None and not result.model.deployments and not result.missions:
        return f"{result.path}: no deployment, so nothing to check\n"
    lines: list[str] = []
    for deployment in result.deployments:
        lines += [*_deployment(deployment, style, limit, details), ""]
    if len(result.deployments) > 1:
        lines += [*_summary(result, style), ""]
    if result.missions:
        from mauve.report.mission_summary import mission_lines

        lines += [line for mission in result.missions for line in (*mission_lines(mission, style, limit), "")]
    while lines and not lines[-1]:
        lines.pop()
    return "".join(line + "\n" for line in lines)


def _deployment(result: DeploymentResult, style: Style, limit: int | None, details: bool) -> list[str]:
    deployment = result.deployment
    boards = dict.fromkeys(f"{n.board.name} ({n.board.core} at {frequency(n.board.hertz)})" for n in deployment.nodes)
    title = f"deployment {deployment.name} of {deployment.architecture.name}"
    lines = [style.paint(Role.MESSAGE, title) + (f" on {', '.join(boards)}" if boards else ""), ""]
    if result.codels:
        lines += format_table(CODELS, [_codel(codel) for codel in result.codels], style, limit=limit)
        lines.append(_origins(result))
    for node in result.nodes:
        lines += ["", *_node(node, result, style, limit)]
    for modes in result.modes:
        from mauve.report.modes_text import mode_lines

        lines += ["", *mode_lines(modes, style, limit)]
    for node in result.nodes if details else ():
        from mauve.report.details import format_details

        lines += format_details(node, style)
    if result.sensitivity or result.proposals:
        from mauve.report.sensitivity import format_sensitivity

        lines += format_sensitivity(result, style, limit)
    lines += format_flows(result.flows, style, limit, details)
    left_out = _left_out(result)
    if left_out:
        lines.append(f"  without a response, as a codel has no time: {', '.join(left_out)}")
    if any(p.priority.default or p.deadline.default for node in result.nodes for p in node.tasks.tasks):
        lines.append("  * by default: priorities are rate monotonic, a deadline is the period")
    return [*lines, "", _verdict(result, style)]


def frequency(hertz: int) -> str:
    """A frequency in the largest unit that keeps it whole: `200 MHz`."""
    for unit, size in (("GHz", 10**9), ("MHz", 10**6), ("kHz", 10**3)):
        if hertz % size == 0:
            return f"{hertz // size} {unit}"
    return f"{hertz} Hz"


def grouped(number: int) -> str:
    """A number with its thousands apart: `12 345`."""
    return f"{number:,}".replace(",", " ")


# ---------------------------------------------------------------------------------------------------------- codels
def _codel(codel: CodelTime) -> Row:
    name = str(codel.plan.id)
    result = codel.result
    if codel.time is None or codel.source is None:
        return (name, "", Cell("none", Role.ERROR), Cell("no bound", Role.ERROR), codel.plan.symbol if result else "")
    if codel.source is not Source.DERIVED or result is None or result.cycles is None:
        return (name, "", format_time(codel.time), Cell(codel.source.value, Role.WARNING), "")
    facts = _facts(codel)
    origin = "derived" + (f", {facts} flow fact{'' if facts == 1 else 's'}" if facts else "")
    return (name, grouped(result.cycles), format_time(codel.time), origin, result.name)


def _facts(codel: CodelTime) -> int:
    """How many of the codel's loops have a bound that a person wrote."""
    from mauve.wcet.result import Origin

    loops = codel.result.loops if codel.result else ()
    return len({(loop.header, loop.function) for loop in loops if loop.origin is Origin.ANNOTATION})


def _origins(result: DeploymentResult) -> str:
    """How many codels have a time, and from where."""
    counts = Counter("without a time" if c.time is None or c.source is None else c.source.value for c in result.codels)
    order = (*(source.value for source in Source), "without a time")
    parts = ", ".join(f"{counts[word]} {word}" for word in order if counts[word])
    return f"  {len(result.codels)} codel{'' if len(result.codels) == 1 else 's'}: {parts}"


# ------------------------------------------------------------------------------------------------------ components
def _node(node: NodeResult, result: DeploymentResult, style: Style, limit: int | None) -> list[str]:
    analysis = node.analysis
    if analysis is None:
        return [f"  node {node.tasks.node.name}: nothing to analyse"]
    worst = _worst(result)
    rows = [_task(placed, analysis, result.complete, worst) for placed in node.tasks.tasks]
    rows += [_overhead(task) for task in analysis.tasks if task.kind is not Kind.TASK]
    total = sum(float(task.interferer.load) for task in analysis.tasks)
    name = node.tasks.node.name
    title = f"load of {name}" + (", all together" if worst is not None else "")
    rows.append((Cell(title, Role.MESSAGE), "", "", "", "", Cell(percent(total), Role.MESSAGE), "", "", ""))
    switch = node.tasks.node.board.context_switch
    about = f"; each activation includes two context switches of {format_time(switch)}" if switch else ""
    method = f"  response times by the {analysis.method.value} method{about}"
    columns: tuple[Column, ...] = COMPONENTS
    if limit is not None and limit < NARROW:
        # The slack is what the deadline leaves of the response: it can be spared.
        columns = (*COMPONENTS[:4], Column("trace", elastic=True), *COMPONENTS[5:7], COMPONENTS[8])
        rows = [(*row[:7], row[8]) for row in rows]
    return [*format_table(columns, rows, style, limit=limit), method, *_stacks(node, result)]


def _stacks(node: NodeResult, result: DeploymentResult) -> list[str]:
    """What the tasks need of their stacks, where binaries say so."""
    if not any(codel.result is not None and codel.result.stack is not None for codel in result.codels):
        return []
    words = []
    for placed in node.tasks.tasks:
        use = stack_use(placed, result.codels)
        size = "?" if use is None or use.size is None else f"{grouped(use.size)} B"
        words.append(f"{placed.task.name} {size}" + (f" ({use.codel})" if use is not None else ""))
    text = f"stacks, deepest codel of each task: {', '.join(words)}"
    return wrap(text, LINE, initial_indent="  ", subsequent_indent="    ", break_on_hyphens=False)


def _worst(result: DeploymentResult) -> dict[str, ResponseResult] | None:
    """The responses by task where those of a mission's modes count; None where those of all tasks together do."""
    if not result.modes:
        return None
    from mauve.verdict.modes import worst_responses

    return worst_responses(result.modes)


def _task(placed: PlacedTask, analysis: Analysis, complete: bool, worst: dict[str, ResponseResult] | None) -> Row:
    """A component. In an incomplete deployment a response is what it is at least, and only a miss is certain. `worst`
    are its responses in the modes of a mission; one that runs in none has none."""
    task = placed.task
    result = analysis.result(task.name)
    if worst is not None and task.name in worst:
        result = worst[task.name]
    elif worst is not None:
        result = changed(result, wcrt=0, reason=None)
    wcrt = "no bound" if result.wcrt is None else format_time(result.wcrt)
    slack = "" if result.slack is None else format_time(result.slack, down=True)
    if not result.schedulable:
        verdict = Cell("missed", Role.ERROR)
    elif complete:
        verdict = Cell("holds", Role.HELP)
    else:
        verdict, wcrt, slack = Cell("open", Role.WARNING), f">= {wcrt}", ""
    return (
        task.name,
        format_time(task.period),
        f"{task.priority}{'*' if placed.priority.default else ''}",
        f"{format_time(task.deadline)}{'*' if placed.deadline.default else ''}",
        _trace(executed(placed, analysis), analysis),
        percent(float(executed(placed, analysis).load)),
        wcrt,
        slack,
        verdict,
    )


def _trace(task: Task, analysis: Analysis) -> str:
    """The costs of consecutive activations, equal neighbours counted: `7ms, 6ms x2`."""
    wanted = trace_length(task, [other for other in analysis.tasks if other.kind is Kind.TASK])
    length = min(wanted, TRACE_LENGTH)
    runs = [(cost, len(list(run))) for cost, run in groupby(task.trace(length))]
    shown = [format_time(cost) + (f" x{count}" if count > 1 else "") for cost, count in runs[:TRACE_RUNS]]
    return ", ".join(shown) + (", ..." if len(runs) > TRACE_RUNS or length < wanted else "")


def _overhead(task: Task) -> Row:
    """An interrupt or the tick: it interferes and has no verdict."""
    name = f"({task.name})"
    return (name, format_time(task.period), "", "", format_time(task.demand(1)), percent(float(task.load)), "", "", "")


def _left_out(result: DeploymentResult) -> list[str]:
    """The active instances without a task."""
    there = {i.name for node in result.nodes for placed in node.tasks.tasks for i in placed.instances}
    return [i.name for i in result.deployment.architecture.instances if i.active and i.name not in there]


# --------------------------------------------------------------------------------------------------------- verdict
def _verdict(result: DeploymentResult, style: Style) -> str:
    name = result.deployment.name
    expected = result.deployment.expect_unschedulable is not None
    count = sum(len(node.tasks.tasks) for node in result.nodes)
    worst = _worst(result)
    together = [r for n in result.nodes if n.analysis for r in n.analysis.results]
    missed = sum(not r.schedulable for r in (together if worst is None else worst.values()))
    if not result.complete:
        certain = f"; {missed} of {count} deadlines missed already" if missed else ""
        return style.paint(Role.ERROR, f"{name}: incomplete, no verdict{certain}")
    late = sum(not flow.holds for flow in result.flows)
    if result.holds:
        asked = sum(flow.flow.within is not None for flow in result.flows)
        every = "the deadline holds" if count == 1 else f"all {count} deadlines hold"
        if asked:
            every = f"{count} deadline{'s' if count > 1 else ''} and {asked} flow{'s' if asked > 1 else ''} hold"
        every += " in every mode and switch" if worst is not None else ""
        text = f"{name}: {every}, {_certainty(result)}" + (", unexpectedly" if expected else "")
        return style.paint(Role.ERROR if expected else Role.HELP, text)
    overflows = len(result.overflows)
    words = [f"{missed} of {count} deadlines missed"] if missed or not (late or overflows) else []
    words += [f"{overflows} queue{'s' if overflows > 1 else ''} may overflow"] if overflows else []
    words += [f"{late} flow{'s' if late > 1 else ''} late"] if late else []
    text = f"{name}: {', '.join(words)}" + (", as expected" if expected else "")
    return style.paint(Role.NOTE if expected else Role.ERROR, text)


def _certainty(result: DeploymentResult) -> str:
    """What a deadline that holds is worth: the paper's method is not sound in general (MV603 says where)."""
    if any(node.analysis is not None and node.analysis.method is Method.PAPER for node in result.nodes):
        return "by the paper's method"
    return "always"


def _summary(result: CheckResult, style: Style) -> list[str]:
    """The last line: how many deployments have the verdict that the model asks for."""
    count = len(result.deployments)
    good = sum(deployment.as_expected for deployment in result.deployments)
    if good == count:
        return [style.paint(Role.HELP, f"{count} deployments: each as it should be")]
    bad = ", ".join(d.deployment.name for d in result.deployments if not d.as_expected)
    return [style.paint(Role.ERROR, f"{count} deployments: {count - good} not as it should be: {bad}")]
