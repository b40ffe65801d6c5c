"""The controller of a mission, ready to be written as C or Python: tables, and how much work one event can be.

Two forms, one interface. Where the alternatives graph is known, an event is answered by the first rule whose condition
holds: one comparison of a few words per rule, and no cascade is ever run. Where the graph is out of reach (dozens of
resources), the controller keeps the whole net and runs the cascade itself, in the canonical order: most urgent level
first, then the transition declared first. Both forms take the same decisions in every state the mission can reach.

A state is a sequence of bits. The rules need only the places that differ between stable states; the net needs all.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from mauve.mission.cascades import Runs, masks
from mauve.mission.graph import AlternativesGraph
from mauve.mission.net import Event, Level, Net, marking
from mauve.records import record

__all__ = [
    "Cascades",
    "Controller",
    "Names",
    "Observer",
    "Rules",
    "identifiers",
    "longest_cascade",
    "longest_of_parts",
    "net_controller",
    "rule_controller",
]

WORD = 64


@record
class Rules:
    """Per event its rules: where `state & tested == value`, the next state is `state & ~cleared | filled`."""

    by_event: tuple[tuple[tuple[int, int, int, int], ...], ...]

    @property
    def most(self) -> int:
        """The greatest number of rules that one event has, hence of comparisons in one step."""
        return max((len(rules) for rules in self.by_event), default=0)


@record
class Cascades:
    """Transitions as (needed, taken, filled), most urgent first; per event those that start a cascade.

    levels: per level above the events, most urgent first, where its transitions begin; and where the last ends.
    waiting: per place the transitions above the events that need it. A cascade of more than `longest` firings, that of
    the event included, is refused as a whole, and the state kept: no cascade of a sound mission is that long.
    """

    transitions: tuple[tuple[int, int, int], ...]
    levels: tuple[int, ...]
    starts: tuple[tuple[int, ...], ...]
    waiting: tuple[tuple[int, ...], ...]
    longest: int


@record
class Observer:
    """Something to see of a state: it is so where `state & places` is not zero."""

    names: tuple[str, ...]
    places: int


@record
class Controller:
    """A controller. `bits` is the size of a state; `initial` that before the start of the mission.

    places: which place of the net each bit of the state is; objectives (path), alternatives (activity, alternative),
    failed (activity) and resources (out of service): what can be told of a state; success and failure: places.
    """

    name: str
    bits: int
    initial: int
    places: tuple[int, ...]
    events: tuple[Event, ...]
    reaction: Rules | Cascades
    objectives: tuple[Observer, ...]
    alternatives: tuple[Observer, ...]
    failed: tuple[Observer, ...]
    resources: tuple[Observer, ...]
    success: int
    failure: int

    @property
    def words(self) -> int:
        """The size of a state in words of 64 bits."""
        return max(1, -(-self.bits // WORD))


def rule_controller(graph: AlternativesGraph) -> Controller:
    """The controller of a mission whose alternatives graph is known."""
    start = graph.markings[graph.initial]
    varying = 0
    for one in graph.markings:
        varying |= one ^ start
    places = tuple(place for place in range(len(graph.net.places)) if varying >> place & 1)
    pack = _packing(places)
    by_event: list[list[tuple[int, int, int, int]]] = [[] for _ in graph.net.events]
    for rule in graph.rules:
        packed = (pack(rule.tested), pack(rule.value), pack(rule.cleared), pack(rule.filled))
        if packed not in by_event[rule.event]:
            by_event[rule.event].append(packed)
    return _controller(graph.net, places, start, Rules(tuple(map(tuple, by_event))))


def net_controller(net: Net, longest: int | None = None) -> Controller:
    """The controller that runs the cascades of a net itself.

    `longest`: how many transitions a cascade may fire, that of the event included: `longest_of_parts` where local
    graphs are known; else sixteen times as many as there are above the events, far more than any mission that we saw.
    """
    inner = [index for index, one in enumerate(net.transitions) if one.level is not Level.EVENT]
    inner.sort(key=lambda index: -net.transitions[index].level)
    levels = sorted(Level, reverse=True)[:-1]
    begins = [sum(net.transitions[index].level > level for index in inner) for level in levels]
    starting = {
        event.name: [i for i, one in enumerate(net.transitions) if one.level is Level.EVENT and one.event == event.name]
        for event in net.events
    }
    order = [*inner, *(index for indices in starting.values() for index in indices)]
    number = {index: at for at, index in enumerate(order)}
    waiting: list[list[int]] = [[] for _ in net.places]
    for index in inner:
        for place in sorted(set(net.transitions[index].before)):
            waiting[place].append(number[index])
    reaction = Cascades(
        tuple(_arrow(net, index) for index in order),
        (*begins, len(inner)),
        tuple(tuple(number[index] for index in indices) for indices in starting.values()),
        tuple(map(tuple, waiting)),
        16 * len(inner) + 16 if longest is None else longest,
    )
    return _controller(net, tuple(range(len(net.places))), marking(net.initial), reaction)


def longest_cascade(graph: AlternativesGraph) -> int:
    """How many transitions the longest cascade of the graph fires, that of the event included."""
    net, table = graph.net, masks(graph.net)
    runs = Runs(table)
    longest, seen = 1, set[int]()
    for state, where in enumerate(graph.markings):
        for edge in range(graph.first[state], graph.first[state + 1]):
            if graph.rules_used[edge] not in seen:
                seen.add(graph.rules_used[edge])
                event = net.events[graph.events[edge]].name
                start = next(
                    at
                    for at, one in enumerate(net.transitions)
                    if one.level is Level.EVENT and one.event == event and not table.before[at] & ~where
                )
                longest = max(longest, len(runs.cascade(where, start).fired))
    return longest


def longest_of_parts(net: Net, parts: Iterable[AlternativesGraph]) -> int:
    """A bound on the cascades of a whole net from the graphs of its objectives (`local_graphs`).

    One event ends each objective at most once and starts each at most once, as every objective waits for an event of
    its own; the rest are transitions of the mission's structure and the news of a recovery, which fire once.
    """
    structure = sum(one.level is Level.MISSION for one in net.transitions)
    return 2 * sum(longest_cascade(one) for one in parts) + structure + 1


def _arrow(net: Net, index: int) -> tuple[int, int, int]:
    before, after = marking(net.transitions[index].before), marking(net.transitions[index].after)
    return before, before & ~after, after & ~before


def _controller(net: Net, places: tuple[int, ...], start: int, reaction: Rules | Cascades) -> Controller:
    pack, meanings = _packing(places), net.meanings

    def observers(said: Iterable[tuple[int, tuple[str, ...]]]) -> tuple[Observer, ...]:
        seen: dict[tuple[str, ...], int] = {}
        for place, names in said:
            seen[names] = seen.get(names, 0) | pack(1 << place)
        return tuple(Observer(names, where) for names, where in seen.items())

    def outcome(wanted: str) -> int:
        return sum(pack(1 << place) for place, name in meanings.outcomes if name == wanted)

    return Controller(
        net.name,
        len(places),
        pack(start),
        places,
        net.events,
        reaction,
        observers((place, (path,)) for place, path in meanings.objectives),
        observers((place, (activity, one)) for place, activity, one in meanings.running),
        observers((place, (name,)) for place, name in meanings.failed),
        observers((place, (name,)) for place, name in meanings.lost),
        outcome("success"),
        outcome("failure"),
    )


def _packing(places: tuple[int, ...]) -> Packing:
    return Packing({place: bit for bit, place in enumerate(places)})


class Packing:
    """From markings of the net to states of the controller: only the chosen places are kept."""

    def __init__(self, bits: dict[int, int]) -> None:
        self.bits = bits

    def __call__(self, full: int) -> int:
        """The bits of the kept places."""
        packed = 0
        while full:
            low = full & -full
            full ^= low
            bit = self.bits.get(low.bit_length() - 1)
            if bit is not None:
                packed |= 1 << bit
        return packed


@record
class Names:
    """Identifiers for the things of a controller, in their order, all distinct and in capitals."""

    events: tuple[str, ...]
    objectives: tuple[str, ...]
    alternatives: tuple[str, ...]
    failed: tuple[str, ...]
    resources: tuple[str, ...]


def identifiers(controller: Controller) -> Names:
    """Names that C and Python accept, made from those of the mission."""

    def of(kind: str, names: Iterable[tuple[str, ...]]) -> tuple[str, ...]:
        taken: dict[str, None] = {}
        for parts in names:
            word = kind + "_".join(re.sub(r"[^A-Za-z0-9]", "_", part) for part in parts).upper()
            number = 2
            distinct = word
            while distinct in taken:
                distinct, number = f"{word}_{number}", number + 1
            taken[distinct] = None
        return tuple(taken)

    return Names(
        of("", ((event.name,) for event in controller.events)),
        of("OBJECTIVE_", (one.names for one in controller.objectives)),
        of("RUN_", (one.names for one in controller.alternatives)),
        of("FAILED_", (one.names for one in controller.failed)),
        of("RESOURCE_", (one.names for one in controller.resources)),
    )
