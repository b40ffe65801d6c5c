"""Checks of a region's shape: states that are never entered, and sets of states that are never left again.

Each mistake is one message: of a chain of unreachable states only the first is named, of a trap its entrance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.model.model import Region, State

LISTED = 8
"""States that a message names at most."""

Graph = Mapping[str, Sequence[str]]


def check_region(region: Region, component: str, report: Report) -> None:
    """MV301 for states that no run enters, MV305 for states from which the initial one is never reached again."""
    successors = {state.name: tuple(t.target for t in state.transitions) for state in region.states}
    states = {state.name: state for state in region.states}
    reached = reachable((region.initial,), successors)
    _check_unreached(region.initial, states, reached, successors, report)
    where = f"the region `{region.name}`" if region.name else f"`{component}`"
    _check_traps(region.initial, where, states, reached, successors, report)


def _check_unreached(
    initial: str, states: Mapping[str, State], reached: tuple[str, ...], successors: Graph, report: Report
) -> None:
    """One message per set of states that would become reachable together."""
    known = set(reached)
    rest = [name for name in states if name not in known]
    before = reversed_graph({name: [t for t in successors[name] if t not in known and t != name] for name in rest})
    covered: set[str] = set()
    for name in sorted(rest, key=lambda one: bool(before.get(one))):
        if name in covered:
            continue
        covered.update(reachable((name,), successors))
        others = before.get(name, ())
        notes = [f"the states reached from `{initial}` are: {_listed(reached)}"]
        if others:
            notes.append(f"it is entered only from {_listed(others)}, not reached either")
        message = f"no run reaches state `{name}`" if others else f"no transition leads to state `{name}`"
        report.add(Diagnostic("MV301", message, Label(states[name].span), notes=tuple(notes)))


def _check_traps(
    initial: str,
    where: str,
    states: Mapping[str, State],
    reached: tuple[str, ...],
    successors: Graph,
    report: Report,
) -> None:
    """A trap is a set of states that reach each other and nothing else, and from which `initial` is not reached."""
    predecessors = reversed_graph({name: successors[name] for name in reached})
    returns = set(reachable((initial, *(name for name in reached if states[name].final)), predecessors))
    for component in components(reached, successors, predecessors):
        inside = set(component)
        if inside & returns or any(target not in inside for name in component for target in successors[name]):
            continue
        entrance, *others = (name for name in reached if name in inside)
        message = f"once in {_listed((entrance, *others))}, {where} never leaves {'them' if others else 'it'}"
        outside = [name for name in reached if name not in inside]
        notes = (f"the costs of {_listed(outside)} count only until then; the bounds hold all the same",)
        help_ = Fix(f"add a transition out of `{entrance}`, or mark it: `final state {entrance}`")
        primary = Label(states[entrance].span)
        report.add(Diagnostic("MV305", message, primary, Severity.WARNING, notes=notes, help=help_))


def reachable(starts: Sequence[str], successors: Graph) -> tuple[str, ...]:
    """The states reached from `starts`, themselves included, in the order a breadth-first walk meets them."""
    found = dict.fromkeys(starts)
    queue = list(found)
    for name in queue:
        for target in successors.get(name, ()):
            if target not in found:
                found[target] = None
                queue.append(target)
    return tuple(queue)


def components(names: Sequence[str], successors: Graph, predecessors: Graph) -> list[tuple[str, ...]]:
    """The strongly connected components of the states `names` (Kosaraju)."""
    pending = set(names)
    found = []
    for name in reversed(_finished(names, predecessors)):
        if name not in pending:
            continue
        component = [name]
        pending.remove(name)
        for member in component:
            fresh = [target for target in dict.fromkeys(successors.get(member, ())) if target in pending]
            pending.difference_update(fresh)
            component += fresh
        found.append(tuple(component))
    return found


def _finished(names: Sequence[str], successors: Graph) -> list[str]:
    """The states in the order in which depth-first walks from each of them are done with them."""
    done: list[str] = []
    seen: set[str] = set()
    for start in names:
        if start in seen:
            continue
        seen.add(start)
        work = [(start, iter(successors.get(start, ())))]
        while work:
            name, targets = work[-1]
            target = next((one for one in targets if one not in seen), None)
            if target is None:
                work.pop()
                done.append(name)
            else:
                seen.add(target)
                work.append((target, iter(successors.get(target, ()))))
    return done


def reversed_graph(successors: Graph) -> dict[str, list[str]]:
    """What leads to each state."""
    before: dict[str, list[str]] = {}
    for name, targets in successors.items():
        for target in targets:
            before.setdefault(target, []).append(name)
    return before


def _listed(names: Sequence[str]) -> str:
    shown = ", ".join(f"`{name}`" for name in dict.fromkeys(names[:LISTED]))
    return f"{shown} and {len(names) - LISTED} more" if len(names) > LISTED else shown
