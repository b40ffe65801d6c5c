"""How much may change before a deadline is missed, and which priorities hold: per node of a deployment.

Costs, periods, the frequency of the processor, ranges of priorities: each alone, all else unchanged. Where tasks wake
or wait for each other, costs are judged with the jitters and waits that follow from them; periods, the frequency and
ranges, for which nothing does that, are withheld. So is the period of a task that reads or fills a queue: how many
messages its handlers meet depends on it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label, Report, Severity
from mauve.lower.activation import is_settled, settle, settled_again
from mauve.lower.machines import WAIT_SWITCHES
from mauve.lower.placed import NodeTasks, PlacedTask
from mauve.model.model import Deployment, Node
from mauve.records import changed, record
from mauve.timing.priorities import Assignment, Policy, PriorityRange, assign, optimal, priority_ranges, with_priorities
from mauve.timing.response import Analysis, Method, analyse
from mauve.timing.sensitivity import CostSlack, PeriodSlack, Speed, cost_slacks, lowest_speed, period_slacks
from mauve.timing.shrink import What
from mauve.timing.task import Kind, Platform, Task, on_platform
from mauve.units import format_time

COUPLED = "tasks wake or wait for each other"
QUEUED = "its period decides how many messages wait"


@record
class NodeSensitivity:
    """One node. `codels` and `overheads` have what each may cost; `hertz` is the lowest frequency that holds, if all
    times scale with it; `withheld` says per task, or for the node (""), why something is not told."""

    node: str
    codels: tuple[CostSlack, ...]
    overheads: tuple[CostSlack, ...]
    periods: tuple[PeriodSlack, ...]
    ranges: tuple[PriorityRange, ...]
    speed: Speed | None
    hertz: int | None
    withheld: Mapping[str, str]


@record
class Proposal:
    """Priorities by a policy for the tasks of a node, with the responses they give; `priorities` is None where none is
    found, `stuck` then names tasks of which none can be the least urgent."""

    node: str
    policy: Policy
    priorities: Mapping[str, int] | None
    responses: Mapping[str, int | None]
    holds: bool
    stuck: tuple[str, ...]


def base_tasks(node: NodeTasks, platform: Platform) -> list[Task]:
    """The tasks of a node as they run on it, with the jitters that they have of their own."""
    return list(on_platform([placed.task for placed in node.tasks], platform))


def node_sensitivity(
    deployment: Deployment, nodes: Sequence[NodeTasks], platforms: Sequence[Platform], place: int
) -> NodeSensitivity:
    """The sensitivity of one node; `nodes` have their tasks before jitters and waits are settled."""
    tasks = base_tasks(nodes[place], platforms[place])
    node = nodes[place].node
    free = is_settled(deployment, nodes)
    costs = cost_slacks(tasks, settle=None if free else settled_again(deployment, nodes, platforms, place))
    codels = tuple(one for one in costs if one.what is What.CODEL and one.name != WAIT_SWITCHES)
    overheads = tuple(one for one in costs if one.what is What.OVERHEAD or one.name == WAIT_SWITCHES)
    if not free:
        withheld = {"": COUPLED}
        return NodeSensitivity(node.name, codels, overheads, (), (), None, None, withheld)
    queued = _queued(deployment, nodes[place])
    periods = tuple(one for one in period_slacks(tasks) if one.task not in queued)
    speed = lowest_speed(tasks)
    hertz = None if speed.factor is None else ceil(speed.factor * node.board.hertz)
    ranges = priority_ranges(tasks)
    return NodeSensitivity(node.name, codels, overheads, periods, ranges, speed, hertz, dict.fromkeys(queued, QUEUED))


def _queued(deployment: Deployment, node: NodeTasks) -> tuple[str, ...]:
    """The tasks at the ends of queues."""
    ends = {
        end.instance
        for connection in deployment.architecture.data
        if connection.size is not None
        for end in (connection.source, connection.target)
    }
    return tuple(one.task.name for one in node.tasks if any(i.name in ends for i in one.instances))


# ------------------------------------------------------------------------------------------------------- priorities
def propose(
    deployment: Deployment,
    nodes: Sequence[NodeTasks],
    platforms: Sequence[Platform],
    place: int,
    policy: Policy,
) -> Proposal:
    """Priorities for one node by a policy, and the responses that they give, jitters and waits settled again."""
    node, platform = nodes[place], platforms[place]
    tasks = base_tasks(node, platform)
    assignment = assign(_with_settled_jitters(deployment, nodes, platforms, place, tasks, policy), policy)
    if assignment.priorities is None:
        return Proposal(node.node.name, policy, None, {}, False, assignment.stuck)
    given = dict(assignment.priorities)
    placed = tuple(changed(one, task=changed(one.task, priority=given[one.task.name])) for one in node.tasks)
    others = [changed(each, tasks=placed) if at == place else each for at, each in enumerate(nodes)]
    result = settle(deployment, others, platforms, Method.TRACE).results[place]
    responses = {one.task: one.wcrt for one in result.results} if result is not None else {}
    holds = result is not None and result.schedulable
    return Proposal(node.node.name, policy, given, responses, holds, ())


def _with_settled_jitters(
    deployment: Deployment,
    nodes: Sequence[NodeTasks],
    platforms: Sequence[Platform],
    place: int,
    tasks: Sequence[Task],
    policy: Policy,
) -> Sequence[Task]:
    """What Audsley's assignment looks at: the tasks with the jitters and waits of the priorities that they have."""
    if policy is not Policy.OPTIMAL or is_settled(deployment, nodes):
        return tasks
    return settled_again(deployment, nodes, platforms, place)(tasks) or tasks


def report_proposal(deployment: Deployment, node: NodeTasks, proposal: Proposal, report: Report) -> None:
    """MV607: the priorities by the policy as a fix, the lines to write in its notes."""
    name = proposal.policy.value
    if proposal.policy is Policy.GIVEN:
        return
    if proposal.priorities is None:
        message = f"no priorities make all deadlines of node `{node.node.name}` hold (deployment `{deployment.name}`)"
        stuck = ", ".join(f"`{task}`" for task in proposal.stuck)
        notes = (f"whichever of {stuck} is the least urgent misses its deadline",)
        report.add(Diagnostic("MV607", message, Label(node.node.span), Severity.NOTE, notes=notes))
        return
    word = "hold" if proposal.holds else "do not all hold"
    message = f"with the {WORDS[proposal.policy]} priorities, the deadlines of node `{node.node.name}` {word}"
    changes = [one for one in node.tasks if proposal.priorities[one.task.name] != one.task.priority]
    lines = [_line(one, proposal) for one in sorted(node.tasks, key=lambda one: -_priority(one, proposal))]
    notes = ("\n".join([f"{name}, most urgent first:", *lines]),)
    help_ = None
    if proposal.holds and changes:
        spans = [(one.priority.span, f"priority {_priority(one, proposal)}") for one in changes]
        edits = tuple(Edit(span, text) for span, text in spans if span is not None)
        whole = len(edits) == len(changes) and len({(e.span.file.name, e.span.start) for e in edits}) == len(edits)
        help_ = Fix("write these priorities", edits if whole else (), Applicability.MAYBE)
    primary = Label(node.node.span, f"in deployment `{deployment.name}`")
    report.add(Diagnostic("MV607", message, primary, Severity.NOTE, notes=notes, help=help_))


WORDS = {
    Policy.OPTIMAL: "optimal",
    Policy.RATE_MONOTONIC: "rate monotonic",
    Policy.DEADLINE_MONOTONIC: "deadline monotonic",
    Policy.GIVEN: "given",
}


def _priority(one: PlacedTask, proposal: Proposal) -> int:
    return proposal.priorities[one.task.name] if proposal.priorities is not None else one.task.priority


def _line(one: PlacedTask, proposal: Proposal) -> str:
    priority = _priority(one, proposal)
    now = "" if priority == one.task.priority else f" (now {one.task.priority})"
    response = proposal.responses.get(one.task.name)
    told = "no bound" if response is None else f"responds within {format_time(response)}"
    return f"{one.task.name}: priority {priority}{now}, {told} of {format_time(one.task.deadline)}"


def optimal_order(node: NodeTasks, analysis: Analysis) -> tuple[str, ...]:
    """The tasks of a node, most urgent first, in an order in which all deadlines hold; empty where none is found. For
    tasks that neither wake nor wait for each other."""
    handlers = [task for task in analysis.tasks if task.kind is not Kind.TASK]
    tasks = [
        *handlers, *(changed(one.task, overhead=analysis.task(one.task.name).overhead) for one in node.tasks)
    ]  # fmt: skip
    found: Assignment = optimal(tasks)
    if found.priorities is None or not analyse(with_priorities(tasks, found)).schedulable:
        return ()
    return tuple(name for name, _ in sorted(found.priorities, key=lambda one: -one[1]))


def lowest(node: Node, speed: Speed) -> str:
    """The lowest frequency in words."""
    if speed.factor is None:
        return "no frequency is enough"
    return f"{float(speed.factor * node.board.hertz / 10**6):.1f} MHz ({100 * float(speed.factor):.1f} % of its own)"
