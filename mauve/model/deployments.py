"""From written deployments to resolved ones: what `extends` inherits, nodes, binaries, assumed times, threads."""

from __future__ import annotations

from collections.abc import Mapping

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.model.facts import BinaryFacts, binary_facts, under
from mauve.model.model import (
    Architecture,
    Assumption,
    Binary,
    Board,
    CodelId,
    Component,
    Deployment,
    Interrupt,
    Node,
)
from mauve.model.names import Scope, duplicate, unknown
from mauve.model.threads import check_placement, resolve_thread
from mauve.records import record
from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.quantities import time_of

CEILING = "immediate_ceiling"
"""The locking protocol of the analysis."""


@record
class Platform:
    """What deployments refer to, by the identity of declarations; boards by name for those given as strings; the flow
    facts of binaries that stand outside of deployments."""

    scope: Scope
    architectures: Mapping[int, Architecture]
    boards: Mapping[int, Board | None]
    standard_boards: Mapping[str, Board]
    directory: str
    facts: tuple[BinaryFacts, ...] = ()


def resolve_deployment(declaration: ast.DeploymentDecl, platform: Platform, report: Report) -> Deployment | None:
    """The deployment of a declaration with everything it inherits, or None where it has no architecture."""
    chain = _chain(declaration, platform, report)
    if chain is None:
        return None
    root = chain[-1]
    if root.architecture is None:
        help_ = Fix(f"write `deployment {root.name} of ARCHITECTURE`")
        report.add(Diagnostic("MV110", f"`{root.name}` deploys no architecture", Label(root.name.span), help=help_))
        return None
    found = platform.scope.find(root.architecture, (ast.ArchitectureDecl,))
    architecture = platform.architectures.get(id(found)) if found is not None else None
    if architecture is None:
        known = {n: d.name.span for n, d in platform.scope.of_kind((ast.ArchitectureDecl,)).items()}
        message = f"there is no architecture `{root.architecture}`"
        span = root.architecture.span
        report.add(unknown("MV110", message, platform.scope.where(), span, known, "an architecture"))
        return None
    errors = _errors(report)
    nodes = tuple(
        node
        for item in _merged_nodes(chain, report)
        if (node := _node(item, architecture, platform, report)) is not None
    )
    if not nodes and not declaration.abstract and not _has_nodes(chain):
        help_ = Fix("write `node NAME on BOARD { ... }`")
        report.add(Diagnostic("MV407", f"`{declaration.name}` has no node", Label(declaration.name.span), help=help_))
    result = Deployment(
        declaration.name.text, declaration.abstract, architecture, nodes,
        declaration.expect_unschedulable, declaration.name.span,
    )  # fmt: skip
    if not declaration.abstract and architecture.complete and _errors(report) == errors:
        check_placement(result, report)
    return result


def _errors(report: Report) -> int:
    return sum(diagnostic.severity is Severity.ERROR for diagnostic in report)


def _has_nodes(chain: tuple[ast.DeploymentDecl, ...]) -> bool:
    return any(deployment.nodes for deployment in chain)


def _chain(
    declaration: ast.DeploymentDecl, platform: Platform, report: Report
) -> tuple[ast.DeploymentDecl, ...] | None:
    """The deployment and those it extends, itself first."""
    chain = [declaration]
    while (parent := chain[-1].extends) is not None:
        found = platform.scope.find(parent, (ast.DeploymentDecl,))
        if not isinstance(found, ast.DeploymentDecl):
            known = {n: d.name.span for n, d in platform.scope.of_kind((ast.DeploymentDecl,)).items()}
            message = f"there is no deployment `{parent}`"
            report.add(unknown("MV110", message, platform.scope.where(), parent.span, known, "a deployment"))
            return None
        if found in chain:
            walk = " -> ".join(f"`{d.name}`" for d in (*chain[chain.index(found) :], found))
            message = f"the deployment `{found.name}` extends itself"
            report.add(Diagnostic("MV404", message, Label(parent.span), notes=(f"the walk is {walk}",)))
            return None
        chain.append(found)
    return tuple(chain)


class MergedNode:
    """A node after inheritance: later declarations replace processes' threads of the same name and add the rest."""

    def __init__(self, declaration: ast.NodeDecl) -> None:
        self.declaration = declaration
        self.binaries: list[ast.BinaryDecl] = []
        self.assumes: list[ast.AssumeDecl] = []
        self.interrupts: dict[str, ast.InterruptDecl] = {}
        self.schedules: list[ast.ScheduleDecl] = []
        self.exchanges: list[ast.ExchangeDecl] = []
        self.threads: dict[str, tuple[str, ast.ThreadDecl]] = {}
        self.locks: dict[str, list[ast.LockDecl]] = {}


def _merged_nodes(chain: tuple[ast.DeploymentDecl, ...], report: Report) -> list[MergedNode]:
    nodes: dict[str, MergedNode] = {}
    for deployment in reversed(chain):
        own: dict[str, Span] = {}
        taken: dict[str, dict[str, Span]] = {}
        for node in deployment.nodes:
            if node.name.text in own:
                report.add(duplicate("node", node.name, own[node.name.text]))
                continue
            own[node.name.text] = node.name.span
            merged = nodes.setdefault(node.name.text, MergedNode(node))
            _merge_node(merged, node, report)
            for process in node.processes:
                name = process.name.parts[-1].text
                _merge_process(merged, name, process, taken.setdefault(node.name.text, {}), report)
        for process in deployment.processes:
            parts = process.name.parts
            holder = nodes.get(parts[0].text)
            if len(parts) != 2 or holder is None or parts[1].text not in holder.locks:
                known = [f"{n}.{p}" for n, m in nodes.items() for p in sorted(m.locks)]
                label = "its processes are " + ", ".join(f"`{k}`" for k in known) if known else "it inherits no process"
                message = f"`{deployment.name}` has no process `{process.name}`"
                report.add(unknown("MV100", message, label, process.name.span, [], "a process"))
                continue
            _merge_process(holder, parts[1].text, process, taken.setdefault(parts[0].text, {}), report)
    return list(nodes.values())


def _merge_node(merged: MergedNode, node: ast.NodeDecl, report: Report) -> None:
    merged.declaration = node
    merged.binaries += node.binaries
    merged.assumes = [*node.assumes, *merged.assumes]
    merged.schedules += node.schedules
    own: dict[str, Span] = {}
    for interrupt in node.interrupts:
        name = interrupt.name
        if name.text in own:
            report.add(duplicate("interrupt", name, own[name.text]))
            continue
        own[name.text] = name.span
        merged.interrupts[name.text] = interrupt


def _merge_process(node: MergedNode, name: str, process: ast.ProcessDecl, own: dict[str, Span], report: Report) -> None:
    """`own` are the threads that this deployment has declared in this node: their names are unique."""
    node.locks.setdefault(name, []).extend(process.locks)
    node.binaries += process.binaries
    node.assumes = [*process.assumes, *node.assumes]
    node.schedules += process.schedules
    node.exchanges += process.exchanges
    for thread in process.threads:
        if thread.name.text in own:
            report.add(duplicate("thread", thread.name, own[thread.name.text]))
            continue
        own[thread.name.text] = thread.name.span
        node.threads[thread.name.text] = (name, thread)


def _node(item: MergedNode, architecture: Architecture, platform: Platform, report: Report) -> Node | None:
    board = _board(item.declaration, platform, report)
    components = _Components(
        {instance.component.name: instance.component for instance in architecture.instances}, architecture.complete
    )
    binaries = tuple(_binary(b, components, platform, report) for b in item.binaries)
    assumptions = tuple(a for decl in item.assumes for a in _assumptions(decl, components, report))
    resolved = (_interrupt(decl, bool(binaries), report) for decl in item.interrupts.values())
    interrupts = tuple(interrupt for interrupt in resolved if interrupt is not None)
    monotonic = _rate_monotonic(item, report)
    locked = {name for name, locks in item.locks.items() if _ceilings(locks, report)}
    threads = tuple(
        resolve_thread(thread, process, process in locked, architecture, report)
        for process, thread in item.threads.values()
    )
    exchanges = tuple(e for decl in item.exchanges if (e := _exchange(decl, architecture, report)) is not None)
    if board is None:
        return None
    name = item.declaration.name
    return Node(
        name.text, board, binaries, assumptions, interrupts, threads, exchanges, monotonic, bool(locked), name.span
    )  # fmt: skip


def _board(node: ast.NodeDecl, platform: Platform, report: Report) -> Board | None:
    name = node.board
    if isinstance(name, ast.String):
        own = platform.scope.own.get(name.value)
        if isinstance(own, ast.BoardDecl):
            return platform.boards.get(id(own))
        board = platform.standard_boards.get(name.value)
        if board is None:
            report.add(_no_such_board(name, platform))
        return board
    found = platform.scope.find(name, (ast.BoardDecl,))
    if found is None:
        known = {n: d.name.span for n, d in platform.scope.of_kind((ast.BoardDecl,)).items()}
        message = f"there is no board `{name}`"
        report.add(unknown("MV109", message, platform.scope.where(), name.span, known, "a board"))
        return None
    return platform.boards.get(id(found))


def _no_such_board(name: ast.String, platform: Platform) -> Diagnostic:
    """MV109 for a board that is named by a string."""
    message, label = f"there is no board `{name.value}`", "not one of this file nor of the standard library"
    known = ", ".join(f'`"{board}"`' for board in platform.standard_boards)
    help_ = Fix(f"describe it by `board ... {{ }}`, or name one of the standard library: {known}")
    return Diagnostic("MV109", message, Label(name.span, label), help=help_)


def _rate_monotonic(item: MergedNode, report: Report) -> bool:
    """Whether the node asks for rate-monotonic priorities; MV407 for a schedule that is not analysed."""
    known = ("fixed_priority", "rate_monotonic")
    for schedule in item.schedules:
        policy = schedule.policy
        if policy.text not in known:
            message = f"`{policy}` is no scheduling policy that is analysed"
            label = "the policies are " + ", ".join(f"`{name}`" for name in known)
            report.add(unknown("MV407", message, label, policy.span, list(known), "a policy"))
        elif not schedule.preemptive:
            message = "non-preemptive scheduling is not analysed"
            help_ = Fix(f"write `schedule {policy} preemptive`")
            report.add(Diagnostic("MV407", message, Label(schedule.span), help=help_))
    return bool(item.schedules) and item.schedules[-1].policy.text == "rate_monotonic"


def _ceilings(locks: list[ast.LockDecl], report: Report) -> bool:
    """Whether a process protects shared data by immediate ceilings; MV407 for another protocol."""
    for lock in locks:
        if lock.protocol.text != CEILING:
            message = f"the locking protocol `{lock.protocol}` is not analysed"
            report.add(unknown("MV407", message, f"`{CEILING}` is", lock.protocol.span, [CEILING], "a protocol"))
    return bool(locks)


@record
class _Components:
    """The components of an architecture by name; `complete` is False where an instance in error is missing."""

    known: Mapping[str, Component]
    complete: bool


def _codel(path: ast.Path, components: _Components, report: Report) -> CodelId | None:
    if len(path.parts) != 2:
        report.add(Diagnostic("MV107", f"`{path}` is no codel", Label(path.span, "write `Component.codel`")))
        return None
    component = components.known.get(path.parts[0].text)
    if component is None and not components.complete:
        return None  # it may be that of an instance in error, which was reported
    if component is None:
        known = {name: c.span for name, c in components.known.items()}
        message = f"the architecture has no component `{path.parts[0]}`"
        label = "its components are " + ", ".join(f"`{n}`" for n in known) if known else "it has no instances"
        report.add(unknown("MV101", message, label, path.parts[0].span, known, "a component"))
        return None
    name = path.parts[1]
    codels = {codel.name: codel.span for codel in component.codels}
    if name.text not in codels:
        message = f"`{component.name}` has no codel `{name}`"
        label = "its codels are " + ", ".join(f"`{n}`" for n in codels) if codels else "it declares no codels"
        report.add(unknown("MV107", message, label, name.span, codels, "a codel"))
        return None
    return CodelId(component.name, name.text)


def _binary(item: ast.BinaryDecl, components: _Components, platform: Platform, report: Report) -> Binary:
    symbols: list[tuple[CodelId, str, Span]] = []
    for binding in item.symbols:
        codel = _codel(binding.codel, components, report)
        if codel is None:
            continue
        first = next((span for other, _, span in symbols if other == codel), None)
        if first is not None:
            report.add(duplicate("symbol", ast.Name(str(codel), binding.codel.span), first))
            continue
        symbols.append((codel, binding.symbol.value, binding.symbol.span))
    path = under(platform.directory, item.path.value)
    own = binary_facts(item, platform.directory, report)
    stated = (own, *(facts for facts in platform.facts if facts.path == path))
    return Binary(
        path,
        tuple(symbols),
        tuple(fact for facts in stated for fact in facts.facts),
        tuple(file for facts in stated for file in facts.files),
        item.path.span,
    )


def _assumptions(item: ast.AssumeDecl, components: _Components, report: Report) -> list[Assumption]:
    wcet = time_of(item.wcet, report)
    if wcet is not None and wcet < 0:
        report.add(Diagnostic("MV401", "an execution time cannot be negative", Label(item.wcet.span)))
        wcet = None
    if wcet is None:
        return []
    if not item.targets:
        return [Assumption(None, wcet, item.span)]
    codels = [(_codel(path, components, report), path.span) for path in item.targets]
    return [Assumption(codel, wcet, span) for codel, span in codels if codel is not None]


def _interrupt(item: ast.InterruptDecl, has_binary: bool, report: Report) -> Interrupt | None:
    every = time_of(item.every, report)
    wcet = time_of(item.wcet, report) if item.wcet else None
    if every is not None and every <= 0:
        message = f"the interrupt `{item.name}` every {item.every.span.text}"
        report.add(Diagnostic("MV401", message, Label(item.every.span, "must be longer than 0")))
        return None
    if every is None or (item.wcet is not None and wcet is None):
        return None
    if wcet is not None and wcet < 0:
        report.add(Diagnostic("MV401", "an execution time cannot be negative", Label(item.span)))
        return None
    if wcet is None and (item.symbol is None or not has_binary):
        message = f"the interrupt `{item.name}` has no execution time"
        help_ = Fix('write `wcet 3us`, or `symbol "HANDLER"` beside a binary')
        report.add(Diagnostic("MV520", message, Label(item.name.span), help=help_))
        return None
    return Interrupt(item.name.text, every, wcet, item.symbol.value if item.symbol else None, item.name.span)


def _exchange(item: ast.ExchangeDecl, architecture: Architecture, report: Report) -> tuple[str, int, Span] | None:
    """The cost of a port exchange: of every instance for `ports`, of one for `instance.ports`."""
    cost = time_of(item.cost, report)
    parts = item.target.parts
    if parts[-1].text != "ports" or len(parts) > 2:
        help_ = Fix("write `exchange ports 2ms`, or `exchange instance.ports 2ms`")
        report.add(Diagnostic("MV100", f"`{item.target}` is no port exchange", Label(item.target.span), help=help_))
        return None
    if len(parts) == 2 and parts[0].text not in {i.name for i in architecture.instances}:
        if not architecture.complete:
            return None
        known = {i.name: i.span for i in architecture.instances}
        message = f"there is no instance `{parts[0]}`"
        report.add(unknown("MV106", message, "unknown", parts[0].span, known, "an instance"))
        return None
    if cost is not None and cost < 0:
        report.add(Diagnostic("MV401", "a cost cannot be negative", Label(item.cost.span)))
        return None
    return None if cost is None else (parts[0].text if len(parts) == 2 else "", cost, item.target.span)
