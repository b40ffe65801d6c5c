"""The codels that a deployment executes, the symbol of each in its binary, and the time that counts for it.

Times come in this order (semantics of record, section 4): derived from the binary, assumed, declared. A codel with
none of the three is an error, never 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from enum import Enum
from typing import TYPE_CHECKING

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.lower.calls import Use, services, uses
from mauve.model.model import Assumption, Binary, Codel, CodelId, Deployment, Node, RegionId
from mauve.model.threads import placement
from mauve.records import record
from mauve.source import Span
from mauve.units import format_time

if TYPE_CHECKING:
    from mauve.wcet.result import WcetResult


class Source(Enum):
    """Where a codel's time comes from."""

    DERIVED = "derived"
    ASSUMED = "assumed"
    DECLARED = "declared"


@record
class CodelPlan:
    """A codel that some task executes: every place of use, its symbol and, where somebody wrote that name, the place;
    `nodes` are those whose processors execute it."""

    id: CodelId
    codel: Codel
    uses: tuple[Use, ...]
    symbol: str
    symbol_span: Span | None
    nodes: frozenset[str]


@record
class CodelTime:
    """The time that counts for a codel, in picoseconds, and where it comes from. `time` is None where there is none;
    `result` is what the analysis of the binary said."""

    plan: CodelPlan
    time: int | None
    source: Source | None
    result: WcetResult | None = None
    binary: str = ""


def plan_codels(deployment: Deployment) -> tuple[CodelPlan, ...]:
    """The codels that the active instances execute, operations they call included, in the order of first use."""
    architecture = deployment.architecture
    connected = services(architecture)
    found: dict[CodelId, list[Use]] = {}
    for instance in architecture.instances:
        if instance.active:
            for use in uses(instance, connected):
                found.setdefault(use.codel, []).append(use)
    codels = {
        CodelId(component.name, codel.name): codel
        for component in {i.component.name: i.component for i in architecture.instances}.values()
        for codel in component.codels
    }
    seats = _seats(deployment)
    return tuple(_plan(id_, codels[id_], tuple(places), seats, deployment) for id_, places in found.items())


def _seats(deployment: Deployment) -> Mapping[RegionId, str]:
    """The node that executes each region; none where a deployment of one node has no threads."""
    nodes = {id(thread): node.name for node in deployment.nodes for thread in node.threads}
    return {region: nodes[id(thread)] for region, thread in placement(deployment).items()}


def _plan(
    id_: CodelId, codel: Codel, places: tuple[Use, ...], seats: Mapping[RegionId, str], deployment: Deployment
) -> CodelPlan:
    every = frozenset(node.name for node in deployment.nodes)
    nodes = frozenset(seats[use.region] for use in places if use.region in seats) or every
    for node in deployment.nodes:
        for binary in node.binaries if node.name in nodes else ():
            for bound, symbol, span in binary.symbols:
                if bound == id_:
                    return CodelPlan(id_, codel, places, symbol, span, nodes)
    if codel.symbol is not None:
        return CodelPlan(id_, codel, places, codel.symbol, codel.span, nodes)
    return CodelPlan(id_, codel, places, f"{id_.component}_{id_.codel}", None, nodes)


def choose_times(
    plans: tuple[CodelPlan, ...],
    deployment: Deployment,
    derived: Mapping[CodelId, tuple[WcetResult, Binary]],
    report: Report,
) -> tuple[CodelTime, ...]:
    """The time of each codel; MV521 where a derived and an assumed one meet, MV520 where there is none at all."""
    result: list[CodelTime] = []
    for plan in plans:
        wcet, binary = derived.get(plan.id, (None, None))
        assumption = _assumption(plan, deployment.nodes)
        path = binary.path if binary is not None else ""
        if wcet is not None and wcet.time is not None:
            if assumption is not None and assumption.codel is not None:
                report.add(_given_twice(plan, assumption, wcet.time, deployment))
            result.append(CodelTime(plan, wcet.time, Source.DERIVED, wcet, path))
        elif assumption is not None:
            result.append(CodelTime(plan, assumption.wcet, Source.ASSUMED, wcet, path))
        elif plan.codel.wcet is not None:
            result.append(CodelTime(plan, plan.codel.wcet, Source.DECLARED, wcet, path))
        else:
            result.append(CodelTime(plan, None, None, wcet, path))
            if wcet is None:
                report.add(_no_time(plan, deployment))
    return tuple(result)


def _assumption(plan: CodelPlan, nodes: tuple[Node, ...]) -> Assumption | None:
    """The assumption that names the codel, else the one for all others, else None. A declared time goes before
    `others`.
    """
    every = [assumption for node in nodes if node.name in plan.nodes for assumption in node.assumptions]
    named = next((a for a in every if a.codel == plan.id), None)
    if named is not None or plan.codel.wcet is not None:
        return named
    return next((a for a in every if a.codel is None), None)


def has_fallback(plan: CodelPlan, deployment: Deployment) -> bool:
    """Whether a time is left for the codel when its binary gives none."""
    return plan.codel.wcet is not None or _assumption(plan, deployment.nodes) is not None


def _given_twice(plan: CodelPlan, assumption: Assumption, derived: int, deployment: Deployment) -> Diagnostic:
    message = f"the time assumed for `{plan.id}` is not used: {format_time(derived)} follow from the binary"
    relation = "less than" if assumption.wcet < derived else "not less than"
    notes = (f"{format_time(assumption.wcet)} are assumed, {relation} what the binary needs in `{deployment.name}`",)
    help_ = Fix("remove the assumption, or the binary's claim to this codel")
    return Diagnostic("MV521", message, Label(assumption.span), Severity.WARNING, notes=notes, help=help_)


def _no_time(plan: CodelPlan, deployment: Deployment) -> Diagnostic:
    use = plan.uses[0]
    place = f"{use.span.file.name}:{use.span.first.line}"
    where = "not in a binary, not assumed, not declared"
    return Diagnostic(
        "MV520",
        f"codel `{plan.id}` has no execution time in deployment `{deployment.name}`",
        Label(plan.codel.span),
        notes=(f"{where}; it is used {use.when} ({place})",),
        help=Fix(f"add `assume {plan.id} wcet ...`"),
    )


def derivable(deployment: Deployment) -> Iterator[tuple[Node, Binary]]:
    """The binaries of a deployment with the node each runs on."""
    for node in deployment.nodes:
        for binary in node.binaries:
            yield node, binary
