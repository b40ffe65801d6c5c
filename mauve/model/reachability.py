"""Checks of a region's shape: states that are never entered, and sets of states that are never left again."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.model.model import Region


def check_region(region: Region, component: str, report: Report) -> None:
    """MV301 for each state that no run enters, MV305 for states from which the rest is never reached again."""
    successors = {state.name: [t.target for t in state.transitions] for state in region.states}
    reached = reachable(region.initial, successors)
    where = f"the region `{region.name}`" if region.name else f"`{component}`"
    for state in region.states:
        if state.name not in reached:
            entered_from = [other.name for other in region.states for t in other.transitions if t.target == state.name]
            others = [name for name in dict.fromkeys(entered_from) if name != state.name]
            notes = [f"the states reached from `{region.initial}` are: " + ", ".join(f"`{name}`" for name in reached)]
            if others:
                notes.append(
                    "it is entered only from " + ", ".join(f"`{name}`" for name in others) + ", not reached either"
                )
            message = f"no transition leads to state `{state.name}`"
            if others:
                message = f"no run reaches state `{state.name}`"
            report.add(Diagnostic("MV301", message, Label(state.span), notes=tuple(notes)))
    _check_traps(region, where, reached, successors, report)


def _check_traps(
    region: Region, where: str, reached: tuple[str, ...], successors: dict[str, list[str]], report: Report
) -> None:
    reported: set[str] = set()
    for name in reached:
        closed = reachable(name, successors)
        if name in reported or region.initial in closed or any(region.state(other).final for other in closed):
            continue
        if any(name not in reachable(other, successors) for other in closed):
            continue  # a passage into a trap; the trap itself is reported
        reported.update(closed)
        inside = ", ".join(f"`{other}`" for other in closed)
        message = f"once in {inside}, {where} never leaves {'it' if len(closed) == 1 else 'them'}"
        outside = ", ".join(f"`{other}`" for other in reached if other not in closed)
        notes = (f"the costs of {outside} count only until then; the bounds hold all the same",)
        help_ = Fix(f"add a transition out of `{name}`, or mark it: `final state {name}`")
        report.add(Diagnostic("MV305", message, Label(region.state(name).span), Severity.WARNING, (), "", notes, help_))


def reachable(start: str, successors: dict[str, list[str]]) -> tuple[str, ...]:
    """The states reached from `start`, itself included, in the order a breadth-first walk meets them."""
    found = {start: None}
    queue = [start]
    for name in queue:
        for target in successors.get(name, ()):
            if target not in found:
                found[target] = None
                queue.append(target)
    return tuple(found)
