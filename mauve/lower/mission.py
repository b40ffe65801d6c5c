"""From a resolved mission to the plan its net is built from."""

from __future__ import annotations

from mauve.mission import formula as f
from mauve.mission import plan as p
from mauve.model import missions as m

_UNARY = {prefix: f.Unary(prefix.value) for prefix in m.Prefix}
_BINARY = {infix: f.Binary(infix.value) for infix in m.Infix}

ONLY = "only"
"""The name of the alternative of an activity that is written without any."""


def plan(mission: m.Mission) -> p.Mission:
    """The plan of a mission without errors."""
    return p.Mission(
        mission.name,
        _sequence(mission.root),
        tuple(_activity(activity) for activity in mission.activities),
        tuple(p.Software(each.name, each.shared) for each in mission.software),
        tuple(p.Hardware(each.name, each.may_fail, each.may_recover) for each in mission.hardware),
    )


def _activity(activity: m.Activity) -> p.Activity:
    alternatives = tuple(
        p.Alternative(
            one.name or ONLY,
            tuple(ref.name for ref in one.consumes),
            tuple(ref.name for ref in one.produces),
        )
        for one in activity.alternatives
    )
    recovery = p.OnRecovery.UPGRADE if activity.upgrade else p.OnRecovery.KEEP
    return p.Activity(activity.name, alternatives, recovery)


# ------------------------------------------------------------------------------------------------ objectives
def _sequence(block: m.Sequence) -> p.Sequence:
    return p.Sequence(block.name, tuple(_step(step) for step in block.steps))


def _step(step: m.Step) -> p.Step:
    return p.Step(_block(step.block), _on_failure(step.on_failure))


def _block(block: m.Block) -> p.Block:
    match block:
        case m.Elementary():
            return p.Elementary(block.name, tuple(ref.name for ref in block.activities), block.timeout)
        case m.Parallel():
            children = tuple(p.Child(_step(child.step), child.mandatory) for child in block.children)
            return p.Parallel(block.name, children)
        case m.Sequence():
            return _sequence(block)


def _on_failure(reaction: m.OnFailure) -> p.OnFailure:
    match reaction:
        case m.Abort():
            return p.Abort()
        case m.Continue():
            return p.Continue()
        case m.Retry(times):
            return p.Retry(times)
        case m.Recover(block, resume):
            return p.Recover(_sequence(block), resume)


# ------------------------------------------------------------------------------------------------ what is asked
def properties(mission: m.Mission) -> tuple[tuple[f.Property, m.Claim | m.Ltl], ...]:
    """What a mission is checked for, each with the place where it is written."""
    asked: list[tuple[f.Property, m.Claim | m.Ltl]] = []
    for claim in mission.claims:
        match claim.kind:
            case m.ClaimKind.BOUNDED:
                asked.append((f.Bounded(), claim))
            case m.ClaimKind.DETERMINISTIC:
                asked.append((f.Deterministic(), claim))
            case m.ClaimKind.LIVE:
                asked.append((f.Live(), claim))
            case m.ClaimKind.SUCCESS_REACHABLE:
                asked.append((f.SuccessReachable(claim.lost, claim.among), claim))
    asked += [(f.Ltl(ltl.name, formula(ltl.formula)), ltl) for ltl in mission.formulas]
    return tuple(asked)


def formula(written: m.Formula) -> f.Formula:
    """A formula over stable states."""
    match written:
        case m.Before(prefix, operand):
            return f.Prefix(_UNARY[prefix], formula(operand))
        case m.Between(left, infix, right):
            return f.Infix(formula(left), _BINARY[infix], formula(right))
        case m.Holds():
            return _atom(written)


def _atom(atom: m.Holds) -> f.Formula:
    match atom.atom:
        case m.Atom.RUNNING:
            return f.Running(atom.name, atom.alternative or None)
        case m.Atom.OUT_OF_SERVICE:
            return f.OutOfService(atom.name)
        case m.Atom.ACTIVE:
            return f.Active(atom.name)
        case m.Atom.SUCCESS:
            return f.Success()
        case m.Atom.FAILURE:
            return f.Failure()
        case m.Atom.TRUE | m.Atom.FALSE:
            return f.Truth(atom.atom is m.Atom.TRUE)
