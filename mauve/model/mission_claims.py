"""What a mission is checked for, and its controller: names in claims and formulas bound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.execution import execution_settings
from mauve.model.mission_activities import Home
from mauve.model.missions import (
    Activity,
    Atom,
    Before,
    Between,
    Block,
    Claim,
    Controller,
    Elementary,
    Formula,
    Hardware,
    Holds,
    Ltl,
    Parallel,
    Recover,
    Ref,
    Step,
)
from mauve.model.names import duplicate, unknown
from mauve.records import record
from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.ast import missions as written
from mauve.syntax.quantities import time_of


@record
class Known:
    """What the checks of a mission may name: the activities and hardware that it uses, and its blocks."""

    activities: Mapping[str, Activity]
    hardware: Mapping[str, Hardware]
    blocks: Mapping[str, Span]


def block_names(block: Block) -> dict[str, Span]:
    """The names of a block and of all in it."""
    found = {block.name: block.span}
    steps: Sequence[Step] = ()
    match block:
        case Elementary():
            return found
        case Parallel(_, children):
            steps = [child.step for child in children]
        case _:
            steps = block.steps
    for step in steps:
        found |= block_names(step.block)
        if isinstance(step.on_failure, Recover):
            for inner in step.on_failure.block.steps:
                found |= block_names(inner.block)
    return found


def resolve_claims(decl: written.MissionDecl, known: Known, report: Report) -> tuple[Claim, ...]:
    """The claims whose names are known."""
    claims = []
    for claim in decl.claims:
        lost: int | None = None
        among: tuple[str, ...] = ()
        if claim.loss is not None:
            most = claim.loss.most
            if not most.is_integer or most.integer < 0:
                message = f"`{most.text}` is no number of devices"
                report.add(Diagnostic("MV007", message, Label(most.span, "a whole number is expected")))
                continue
            lost = min(most.integer, 1_000)
            among = tuple(ref.name for ref in _devices(claim.loss.among, known, report))
            if claim.loss.among and not among:
                continue
        claims.append(Claim(claim.kind, lost, tuple(dict.fromkeys(among)), claim.span))
    return tuple(claims)


def resolve_accepts(decl: written.MissionDecl, known: Known, report: Report) -> tuple[Ref, ...]:
    """The devices whose single failure the mission accepts."""
    return tuple(ref for each in decl.accepts for ref in _devices(each.resources, known, report))


def _devices(names: Sequence[ast.Name], known: Known, report: Report) -> list[Ref]:
    found = []
    for name in names:
        device = known.hardware.get(name.text)
        if device is None:
            report.add(_no_hardware(name, known))
        elif not device.may_fail:
            message = f"`{name}` never fails"
            help_ = Fix(f"declare it with `may fail`, or leave it out here: `hardware {name}: ... may fail`")
            labels = (Label(device.span, "declared without `may fail`"),)
            report.add(Diagnostic("MV702", message, Label(name.span), labels=labels, help=help_))
        else:
            found.append(Ref(name.text, name.span))
    return found


def _no_hardware(name: ast.Name, known: Known) -> Diagnostic:
    spans = {n: h.span for n, h in known.hardware.items()}
    message = f"the mission depends on no hardware `{name}`"
    return unknown("MV702", message, "no hardware of the mission", name.span, spans, "hardware")


# ------------------------------------------------------------------------------------------------ formulas
def resolve_formulas(decl: written.MissionDecl, known: Known, report: Report) -> tuple[Ltl, ...]:
    """The formulas whose names are known."""
    seen: dict[str, Span] = {}
    found = []
    for each in decl.formulas:
        if each.name.text in seen:
            report.add(duplicate("check", each.name, seen[each.name.text]))
            continue
        seen[each.name.text] = each.name.span
        formula = _formula(each.formula, known, report) if each.formula is not None else None
        if formula is not None:
            found.append(Ltl(each.name.text, formula, each.span))
    return tuple(found)


def _formula(formula: written.FormulaDecl, known: Known, report: Report) -> Formula | None:
    """A formula with its names bound; it nests no deeper than the parser allows."""
    match formula:
        case written.FormulaAtom():
            return _atom(formula, known, report)
        case written.FormulaPrefix(operator, inner):
            operand = _formula(inner, known, report)
            return Before(operator, operand) if operand is not None else None
        case written.FormulaInfix(between, first, second):
            left, right = _formula(first, known, report), _formula(second, known, report)
            return Between(left, between, right) if left is not None and right is not None else None


def _atom(atom: written.FormulaAtom, known: Known, report: Report) -> Formula | None:
    kind = Atom(atom.kind.value)
    if atom.path is None:
        return Holds(kind)
    first, *rest = atom.path.parts
    if rest and (kind is not Atom.RUNNING or len(rest) > 1):
        message = f"`{atom.path}` names nothing that `{kind.value}` could ask for"
        report.add(Diagnostic("MV100", message, Label(atom.path.span, "a single name is expected")))
        return None
    match kind:
        case Atom.OUT_OF_SERVICE if first.text not in known.hardware:
            report.add(_no_hardware(first, known))
            return None
        case Atom.ACTIVE if first.text not in known.blocks:
            message = f"the mission has no objective `{first}`"
            report.add(unknown("MV100", message, "not in this mission", first.span, known.blocks, "an objective"))
            return None
        case Atom.RUNNING:
            return _running(first, rest[0] if rest else None, known, report)
    return Holds(kind, first.text)


def _running(name: ast.Name, alternative: ast.Name | None, known: Known, report: Report) -> Formula | None:
    activity = known.activities.get(name.text)
    if activity is None:
        spans = {n: a.span for n, a in known.activities.items()}
        message = f"the mission uses no activity `{name}`"
        report.add(unknown("MV100", message, "not in this mission", name.span, spans, "an activity"))
        return None
    spans = {one.name: one.span for one in activity.alternatives if one.name}
    if alternative is not None and alternative.text not in spans:
        message = f"`{name}` has no alternative `{alternative}`"
        report.add(unknown("MV100", message, "unknown", alternative.span, spans, "an alternative"))
        return None
    return Holds(Atom.RUNNING, name.text, alternative.text if alternative else "")


# ------------------------------------------------------------------------------------------------ controller
def resolve_controller(decl: written.MissionDecl, home: Home, report: Report) -> Controller | None:
    """The controller's task: an instance of an architecture, or a task of its own (MV401, MV106)."""
    written_ = decl.controller
    if written_ is None:
        return None
    instance: Ref | None = None
    if written_.runs is not None:
        known = {i.name: i.span for architecture in home.architectures for i in architecture.instances if i.active}
        text = str(written_.runs)
        if text in known:
            instance = Ref(text, written_.runs.span)
        elif home.tied:
            message = f"there is no active instance `{text}` to run the controller"
            report.add(unknown("MV106", message, "unknown", written_.runs.span, known, "an instance"))
    settings = execution_settings(written_.attributes, report)
    wcet = time_of(written_.wcet, report) if written_.wcet else None
    if wcet is not None and wcet < 0 and written_.wcet is not None:
        report.add(Diagnostic("MV401", "an execution time cannot be negative", Label(written_.wcet.span)))
        wcet = None
    sporadic = settings.get(ast.Execution.SPORADIC)
    period = settings.get(ast.Execution.PERIOD) or sporadic
    own = bool(written_.attributes) or written_.wcet is not None
    priority, deadline = settings.get(ast.Execution.PRIORITY), settings.get(ast.Execution.DEADLINE)
    lacking = [
        word
        for word, given in (
            ("a `period` or a `sporadic` separation", period),
            ("a `priority`", priority),
            ("a `wcet`", written_.wcet),
        )
        if given is None
    ]
    if own and (lacking or written_.runs is not None):
        message = f"the task of the controller has not {' nor '.join(lacking)}"
        if written_.runs is not None:
            message = "the controller has either an instance or a task of its own"
        help_ = Fix("write `generate controller { period 10ms  priority 40  wcet 200us }`")
        report.add(Diagnostic("MV401", message, Label(written_.span), help=help_))
    return Controller(instance, period, sporadic is not None, priority, deadline, wcet, written_.span)
