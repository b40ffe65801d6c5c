"""The alternatives graph made directly: no interleaving of transient markings is ever enumerated.

From a stable marking an event fires, and then always the first enabled transition of the highest level, until none
above the events is enabled: a cascade. What a cascade does depends only on the places that it looks at, so one that
was run before is recognised by their values: a rule. Rules are few however many states there are, and they are the
controller. That the order of firing does not matter is shown apart, in `confluence`.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator

from mauve.mission.graph import AlternativesGraph, BudgetExceeded, Rule
from mauve.mission.net import Level, Net, marking
from mauve.records import record

BUDGET = 1_000_000
"""Stable states, where nobody says otherwise."""

LONGEST = 1_000_000
"""Transitions in one cascade; a net of the templates has none that is longer than a few hundred."""


class Unsafe(Exception):
    """A transition would fill a place that holds its token: the net is not 1-safe. A bug of a template."""


class EndlessCascade(Exception):
    """The transitions after an event never come to an end. A bug of a template."""


@record
class Masks:
    """A net for firing: per transition the places it needs, takes and fills as bits; per place who may wait for it.

    by_level[place][level] has a bit for each transition of that level that needs the place.
    """

    before: tuple[int, ...]
    taken: tuple[int, ...]
    filled: tuple[int, ...]
    levels: tuple[int, ...]
    by_level: tuple[tuple[tuple[int, int], ...], ...]


def masks(net: Net) -> Masks:
    """The masks of a net."""
    before = tuple(marking(one.before) for one in net.transitions)
    after = tuple(marking(one.after) for one in net.transitions)
    waiting: list[dict[int, int]] = [{} for _ in net.places]
    for index, one in enumerate(net.transitions):
        if one.level is not Level.EVENT:
            for place in set(one.before):
                waiting[place][one.level] = waiting[place].get(one.level, 0) | 1 << index
    return Masks(
        before,
        tuple(x & ~y for x, y in zip(before, after, strict=True)),
        tuple(y & ~x for x, y in zip(before, after, strict=True)),
        tuple(int(one.level) for one in net.transitions),
        tuple(tuple(sorted(one.items())) for one in waiting),
    )


def bits(mask: int) -> Iterator[int]:
    """The positions of the ones, lowest first."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


@record
class Cascade:
    """What came of an event: the marking after it, the places it depended on, and the transitions in order.

    Whether a place was free to be filled is apart, in `spared`: a sound net answers that by its shape.
    """

    result: int
    tested: int
    spared: int
    fired: tuple[int, ...]


def cascade(table: Masks, state: int, event: int) -> Cascade:
    """Runs the cascade that a transition of level 0 starts in a stable marking, in the canonical order.

    Raises Unsafe and EndlessCascade.
    """
    before, taken, filled, by_level = table.before, table.taken, table.filled, table.by_level
    now = state
    written = tested = spared = 0
    ready = [0] * (len(Level) + 1)
    fired = []
    chosen = event
    tested = before[event]
    while True:
        if now & filled[chosen]:
            raise Unsafe(chosen)
        spared |= filled[chosen] & ~written
        now = now & ~taken[chosen] | filled[chosen]
        written |= taken[chosen] | filled[chosen]
        fired.append(chosen)
        if len(fired) > LONGEST:
            raise EndlessCascade(chosen)
        new = filled[chosen]
        while new:
            low = new & -new
            new ^= low
            for level, waiting in by_level[low.bit_length() - 1]:
                ready[level] |= waiting
        level = len(ready) - 1
        while level:
            candidates = ready[level]
            if not candidates:
                level -= 1
                continue
            low = candidates & -candidates
            chosen = low.bit_length() - 1
            missing = before[chosen] & ~now
            if not missing:
                tested |= before[chosen] & ~written
                break
            ready[level] = candidates ^ low
            if not missing & (written | tested):
                tested |= missing & -missing
        if not level:
            return Cascade(now, tested, spared, tuple(fired))


class Controller:
    """The rules found so far, and the cascades that none of them covers yet."""

    def __init__(self, net: Net) -> None:
        self.net = net
        self.table = masks(net)
        self.number = {event.name: index for index, event in enumerate(net.events)}
        self.rules: list[Rule] = []
        self.known: dict[tuple[int, int, int, int, int], int] = {}
        ordered = sorted(
            (self.number[one.event], index)
            for index, one in enumerate(net.transitions)
            if one.level is Level.EVENT and one.event
        )
        self.starts = [(event, index, self.table.before[index]) for event, index in ordered]
        self.memo: list[dict[int, dict[int, tuple[int, int, int]]]] = [{} for _ in net.transitions]

    def learn(self, event: int, start: int, state: int) -> tuple[int, int, int]:
        """Runs a cascade; what it keeps and fills in any marking that looks the same to it, and its rule."""
        done = cascade(self.table, state, start)
        cleared, filled = state & ~done.result, done.result & ~state
        rule = (event, done.tested, state & done.tested, cleared, filled)
        index = self.known.setdefault(rule, len(self.rules))
        if index == len(self.rules):
            self.rules.append(Rule(*rule))
        depends = done.tested | done.spared
        step = (~cleared, filled, index)
        self.memo[start].setdefault(depends, {})[state & depends] = step
        return step


def initial_marking(net: Net) -> int:
    """The marking from which a mission starts."""
    return marking(net.initial)


def alternatives_graph(net: Net, budget: int = BUDGET) -> AlternativesGraph | BudgetExceeded:
    """All stable states that events can lead to, and the edges between them; at most `budget` states.

    The initial marking must be stable. Raises Unsafe and EndlessCascade.
    """
    controller = Controller(net)
    starts = controller.starts
    memo = controller.memo
    first_marking = initial_marking(net)
    index = {first_marking: 0}
    states = [first_marking]
    first, events, targets, used = array("Q", [0]), array("H"), array("I"), array("I")
    add_event, add_target, add_rule = events.append, targets.append, used.append
    for state in states:
        for event, start, needed in starts:
            if state & needed != needed:
                continue
            for mask, by_value in memo[start].items():
                step = by_value.get(state & mask)
                if step is not None:
                    break
            else:
                step = controller.learn(event, start, state)
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


def multipliers(net: Net, states: list[int], sample: int = 100_000) -> tuple[tuple[str, int], ...]:
    """Each group of the net that may be lost, with how often it multiplies these states, in thousandths."""
    seen = states[:sample]
    factors = []
    for name in dict.fromkeys(name for _, name in net.meanings.lost):
        others = ~sum(1 << place for place, group in enumerate(net.groups) if group == name)
        factors.append((name, 1000 * len(seen) // len({state & others for state in seen})))
    return tuple(sorted(factors, key=lambda one: (-one[1], one[0])))
