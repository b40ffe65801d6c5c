"""The alternatives graph made directly: no interleaving of transient markings is ever enumerated.

From a stable marking an event sets off a cascade (`cascades`). What it does depends only on the places that it looks
at, so one that was run before is recognised by their values: a rule. Rules are few however many states there are, and
they are the controller. That the order of firing does not matter is shown apart, in `confluence`.
"""

from __future__ import annotations

from array import array
from typing import TypeAlias

from mauve.mission.cascades import Runs, Unsound, masks
from mauve.mission.graph import AlternativesGraph, BudgetExceeded, Rule
from mauve.mission.net import Level, Net, marking

BUDGET = 1_000_000
"""Stable states, where nobody says otherwise."""

Step: TypeAlias = tuple[int, int, int]
"""What a cascade keeps (a mask), what it fills, and its rule."""


class Known:
    """The cascades of one transition of level 0 that were run: found again by the values of the places they look at.

    Most look at some places in common; by the values of these (`common`) they are sorted into buckets, each a table of
    places that were looked at, and their values.
    """

    def __init__(self) -> None:
        self.common = -1
        self.buckets: dict[int, dict[int, dict[int, Step]]] = {}

    def add(self, depends: int, value: int, step: Step) -> None:
        """Another cascade: the places it depends on, their values, and what it does."""
        common = self.common & depends
        if common != self.common:
            tables = [table for bucket in self.buckets.values() for table in bucket.items()]
            self.common, self.buckets = common, {}
            for mask, by_value in tables:
                for known, made in by_value.items():
                    self.buckets.setdefault(known & common, {}).setdefault(mask, {})[known] = made
        self.buckets.setdefault(value & common, {}).setdefault(depends, {})[value] = step


class Controller:
    """The rules found so far, and the cascades that none of them covers yet."""

    def __init__(self, net: Net) -> None:
        self.net = net
        self.table = masks(net)
        self.runs = Runs(self.table)
        self.number = {event.name: index for index, event in enumerate(net.events)}
        self.rules: list[Rule] = []
        self.numbers: dict[tuple[int, int, int, int, int], int] = {}
        self.units = [marking(unit) for unit in net.units]
        self.starts: dict[int, list[tuple[int, int, int, Known]]] = {}
        for index, one in enumerate(net.transitions):
            if one.level is Level.EVENT and one.event:
                row = (self.number[one.event], index, self.table.before[index], Known())
                self.starts.setdefault(1 << one.before[0], []).append(row)

    def learn(self, event: int, start: int, state: int, known: Known) -> Step:
        """Runs a cascade; what it keeps and fills in any marking that looks the same to it, and its rule.

        Of places of which always one is marked, all count as looked at where one was: that tells as much, and makes
        cascades look at the same places, which are then found faster.
        """
        done = self.runs.cascade(state, start)
        cleared, filled = state & ~done.result, done.result & ~state
        rule = (event, done.tested, state & done.tested, cleared, filled)
        index = self.numbers.setdefault(rule, len(self.rules))
        if index == len(self.rules):
            self.rules.append(Rule(*rule))
        depends = done.tested | done.spared
        lasting = depends & ~self.table.transient
        for unit in self.units:
            if unit & lasting:
                depends |= unit
        step = (~cleared, filled, index)
        known.add(depends, state & depends, step)
        return step


def initial_marking(net: Net) -> int:
    """The marking from which a mission starts."""
    return marking(net.initial)


def alternatives_graph(net: Net, budget: int = BUDGET) -> AlternativesGraph | BudgetExceeded:
    """All stable states that events can lead to, and the edges between them; at most `budget` states.

    The initial marking must be stable. Raises Unsafe and EndlessCascade, with a shortest run to it.
    """
    controller = Controller(net)
    starts = controller.starts
    first_marking = initial_marking(net)
    index = {first_marking: 0}
    states = [first_marking]
    first, events, targets, used = array("Q", [0]), array("H"), array("I"), array("I")
    add_event, add_target, add_rule = events.append, targets.append, used.append
    triggers = sum(starts)
    nothing: dict[int, dict[int, Step]] = {}
    for state in states:
        present = state & triggers
        while present:
            low = present & -present
            present ^= low
            for event, start, needed, known in starts[low]:
                if state & needed != needed:
                    continue
                step = None
                for mask, by_value in known.buckets.get(state & known.common, nothing).items():
                    step = by_value.get(state & mask)
                    if step is not None:
                        break
                if step is None:
                    try:
                        step = controller.learn(event, start, state, known)
                    except Unsound as error:
                        run = (*_run(net, len(first) - 1, first, events, targets), net.events[event].name)
                        raise type(error)(error.transition, run) from None
                kept, filled, rule = step
                after = state & kept | filled
                target = index.get(after)
                if target is None:
                    target = index[after] = len(states)
                    if target >= budget:
                        return BudgetExceeded(budget, multipliers(net, states))
                    states.append(after)
                add_event(event)
                add_target(target)
                add_rule(rule)
        first.append(len(events))
    return AlternativesGraph(net, tuple(states), first, events, targets, used, tuple(controller.rules))


def _run(net: Net, state: int, first: array[int], events: array[int], targets: array[int]) -> tuple[str, ...]:
    """The events by which the states of a graph in the making led to one of them first."""
    came: dict[int, tuple[int, int]] = {}
    for source in range(len(first) - 1):
        for edge in range(first[source], first[source + 1]):
            came.setdefault(targets[edge], (source, events[edge]))
    run = []
    while state:
        state, event = came[state]
        run.append(net.events[event].name)
    return tuple(reversed(run))


def multipliers(net: Net, states: list[int], sample: int = 100_000) -> tuple[tuple[str, int], ...]:
    """Each group of the net that may be lost, with how often it multiplies these states, in thousandths."""
    seen = states[:sample]
    factors = []
    for name in dict.fromkeys(name for _, name in net.meanings.lost):
        others = ~sum(1 << place for place, group in enumerate(net.groups) if group == name)
        factors.append((name, 1000 * len(seen) // len({state & others for state in seen})))
    return tuple(sorted(factors, key=lambda one: (-one[1], one[0])))
