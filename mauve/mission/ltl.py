"""Linear temporal logic over the runs of a mission, decided on the alternatives graph.

A run is an infinite sequence of stable states: the first is the one before the start of the mission, `next` is the one
after the next event, of whatever kind. A state without events stands still: it is repeated for ever. No fairness is
assumed: hardware may break and recover for ever while the mission waits, and an objective may never be reached. So
`eventually success` seldom holds, `failure unless ..` and `always ..` are what the logic is good for.

The graph is multiplied with the automaton of the negated formula, breadth first and as far as is needed. A
counterexample is a run to a state after which the automaton takes anything (any continuation violates the formula),
or a run into a cycle in a strongly connected component that fulfils all of its promises (Tarjan, 1972).
"""

from __future__ import annotations

from array import array
from functools import reduce
from operator import or_

from mauve.mission.buchi import Automaton, TooLarge, accepts_all, automaton, negated
from mauve.mission.formula import Active, Failure, Formula, Ltl, OutOfService, Running, Success, Verdict
from mauve.mission.graph import AlternativesGraph
from mauve.mission.net import Meanings
from mauve.mission.survey import labels
from mauve.records import record

__all__ = ["Counterexample", "check_ltl", "counterexample"]

STILL = "(no event)"
"""Stands for the step of a state that has no events."""


@record
class Counterexample:
    """A run that violates a formula: the events of the prefix, then those of the cycle for ever.

    An empty cycle: whatever follows the prefix. `states` are those of the graph that prefix and cycle lead through,
    beginning with the initial one.
    """

    prefix: tuple[str, ...]
    cycle: tuple[str, ...]
    states: tuple[int, ...]


def check_ltl(graph: AlternativesGraph, wanted: Ltl, budget: int = 4_000_000) -> Verdict:
    """Whether all runs satisfy the formula. Unknown (None) if formula or product exceed the budget.

    The witness of a violation is the prefix followed by one turn of the cycle; the note says where the cycle begins.
    """
    try:
        found = counterexample(graph, wanted.formula, budget)
    except TooLarge as reason:
        return Verdict(wanted.name, None, (), str(reason))
    if found is None:
        return Verdict(wanted.name, True)
    if not found.cycle:
        return Verdict(wanted.name, False, found.prefix, "whatever follows")
    return Verdict(wanted.name, False, (*found.prefix, *found.cycle), f"then for ever: {', '.join(found.cycle)}")


def counterexample(graph: AlternativesGraph, formula: Formula, budget: int = 4_000_000) -> Counterexample | None:
    """A run that violates the formula with a short prefix, if any does. TooLarge past `budget` steps of the product."""
    machine = automaton(negated(formula))
    product = _product(graph, machine, budget)
    if product.end is not None:
        prefix, states = _run(graph, product, product.end)
        return Counterexample(prefix, (), states)
    core = _accepting_component(product, machine.acceptance)
    if not core:
        return None
    start = min(core)
    prefix, states = _run(graph, product, start)
    cycle, round_states = _cycle(graph, product, machine.acceptance, start, core)
    return Counterexample(prefix, cycle, (*states, *round_states))


# --------------------------------------------------------------------------------------------------------- the product
@record
class _Product:
    """Pairs (state of the graph, state of the automaton), numbered breadth first.

    steps: per pair (event or -1, what is fulfilled, next pair), where a cycle can be accepting. parents: per pair (pair
    before, event).
    end: the first pair such that every run through it is accepted.
    """

    pairs: list[tuple[int, int]]
    steps: list[list[tuple[int, int, int]]]
    parents: list[tuple[int, int]]
    end: int | None


def _product(graph: AlternativesGraph, machine: Automaton, budget: int) -> _Product:
    letters = labels(graph, [_places(graph.net.meanings, atom) for atom in machine.atoms])
    width = len(machine.arrows)
    final = [accepts_all(machine, at) for at in range(width)]
    hot = _hot(machine)
    pairs, parents, steps = [(graph.initial, 0)], [(-1, -1)], list[list[tuple[int, int, int]]]()
    numbers = array("l", [-1]) * (len(letters) * width)
    numbers[graph.initial * width] = 0
    spent = 0
    for number, (state, at) in enumerate(pairs):  # grows while it is read
        letter = letters[state]
        successors = list(graph.successors(state)) or [(-1, state)]
        here: list[tuple[int, int, int]] = []
        for arrow in machine.arrows[at]:
            if arrow.true & ~letter or arrow.false & letter:
                continue
            if final[arrow.target]:
                return _Product(pairs, steps, parents, number)
            inner = hot[at] and hot[arrow.target]
            for event, target in successors:
                code = target * width + arrow.target
                known = numbers[code]
                if known < 0:
                    known = numbers[code] = len(pairs)
                    pairs.append((target, arrow.target))
                    parents.append((number, event))
                if inner:
                    here.append((event, arrow.fulfils, known))
            spent += len(successors)
        steps.append(here)
        if spent > budget:
            raise TooLarge(f"the product of graph and automaton has more than {budget} steps")
    return _Product(pairs, steps, parents, None)


def _hot(machine: Automaton) -> list[bool]:
    """The states of the automaton that lie in a component with an accepting cycle: only there cycles are looked for."""
    steps = [[(0, arrow.fulfils, arrow.target) for arrow in arrows] for arrows in machine.arrows]
    hot = [False] * len(steps)
    for members in _components(steps):
        if _fulfilled(steps, set(members)) == machine.acceptance:
            for state in members:
                hot[state] = True
    return hot


def _places(meanings: Meanings, atom: Formula) -> list[int]:
    """The places one of which is marked where the atom holds."""
    match atom:
        case Running(activity, alternative):
            return [place for place, a, b in meanings.running if a == activity and alternative in (None, b)]
        case OutOfService(resource):
            return [place for place, name in meanings.lost if name == resource]
        case Active(objective):
            return [place for place, path in meanings.objectives if _within(path, objective)]
        case Success():
            return [place for place, name in meanings.outcomes if name == "success"]
        case Failure():
            return [place for place, name in meanings.outcomes if name == "failure"]
    raise ValueError(f"not an atom: {atom}")


def _within(path: str, objective: str) -> bool:
    """Whether the objective at a path is this one, or inside one of this name (or path)."""
    names = [part.partition("#")[0] for part in path.split(".")]
    return objective in names or path == objective or path.startswith(objective + ".")


# ------------------------------------------------------------------------------------------------------------- cycles
def _accepting_component(product: _Product, acceptance: int) -> set[int]:
    """Of the strongly connected components whose steps fulfil everything, the one entered first; empty if none does."""
    best: set[int] = set()
    for component in _components(product.steps):
        members = set(component)
        if _fulfilled(product.steps, members) == acceptance and (not best or min(members) < min(best)):
            best = members
    return best


def _fulfilled(steps: list[list[tuple[int, int, int]]], members: set[int]) -> int:
    """All that the steps inside a component fulfil; -1 where there are no such steps."""
    inside = [fulfils for member in members for _, fulfils, target in steps[member] if target in members]
    return reduce(or_, inside) if inside else -1


def _components(steps: list[list[tuple[int, int, int]]]) -> list[list[int]]:
    """The strongly connected components, by Tarjan's algorithm without recursion."""
    count = len(steps)
    index, low, stacked = [-1] * count, [0] * count, bytearray(count)
    stack: list[int] = []
    found: list[list[int]] = []
    clock = 0
    for root in range(count):
        if index[root] >= 0:
            continue
        path = [(root, iter(steps[root]))]
        index[root] = low[root] = clock
        clock += 1
        stack.append(root)
        stacked[root] = 1
        while path:
            pair, rest = path[-1]
            for _, _, target in rest:
                if index[target] < 0:
                    index[target] = low[target] = clock
                    clock += 1
                    stack.append(target)
                    stacked[target] = 1
                    path.append((target, iter(steps[target])))
                    break
                if stacked[target] and index[target] < low[pair]:
                    low[pair] = index[target]
            else:
                path.pop()
                if path and low[pair] < low[path[-1][0]]:
                    low[path[-1][0]] = low[pair]
                if low[pair] == index[pair]:
                    found.append([])
                    while not found[-1] or found[-1][-1] != pair:
                        found[-1].append(stack.pop())
                        stacked[found[-1][-1]] = 0
    return found


def _run(graph: AlternativesGraph, product: _Product, pair: int) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """The events and the states of a shortest run to a pair."""
    events, states = list[str](), [product.pairs[pair][0]]
    while product.parents[pair][0] >= 0:
        pair, event = product.parents[pair]
        events.append(_name(graph, event))
        states.append(product.pairs[pair][0])
    return tuple(reversed(events)), tuple(reversed(states))


def _cycle(
    graph: AlternativesGraph, product: _Product, acceptance: int, start: int, core: set[int]
) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """A closed walk from `start` through its component that fulfils everything, and the states it leads through."""
    walk: list[tuple[int, int, int]] = []
    at, missing = start, acceptance
    while missing or at != start or not walk:
        leg = _leg(product, core, at, missing, start)
        walk += leg
        at = leg[-1][2]
        for _, fulfils, _ in leg:
            missing &= ~fulfils
    return tuple(_name(graph, event) for event, _, _ in walk), tuple(product.pairs[step[2]][0] for step in walk)


def _leg(product: _Product, core: set[int], start: int, missing: int, goal: int) -> list[tuple[int, int, int]]:
    """A shortest walk in the component to a step that fulfils something missing; to the goal, if nothing is missing."""
    came: dict[int, tuple[int, tuple[int, int, int]]] = {}
    todo = [start]
    for pair in todo:
        for step in product.steps[pair]:
            if step[2] not in core:
                continue
            if step[1] & missing or (not missing and step[2] == goal):
                walk = [step]
                while pair != start:
                    pair, before = came[pair]
                    walk.append(before)
                return walk[::-1]
            if step[2] != start and step[2] not in came:
                came[step[2]] = (pair, step)
                todo.append(step[2])
    raise ValueError("the component has no such step")


def _name(graph: AlternativesGraph, event: int) -> str:
    return STILL if event < 0 else graph.net.events[event].name
