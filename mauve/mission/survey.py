"""What the checks of properties share: who leads to whom in an alternatives graph, what is lost, shortest runs."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable

from mauve.mission.graph import AlternativesGraph
from mauve.mission.net import EventKind, marking
from mauve.records import record

__all__ = ["RESOURCE_EVENTS", "Survey", "backward", "labels", "sources_of", "survey", "trace"]

RESOURCE_EVENTS = frozenset([EventKind.LOST, EventKind.RECOVERED])
"""Events of hardware, which can happen whatever the mission does."""


@record
class Survey:
    """A graph with what several checks need; make one with `survey` and give it to all of them.

    sources: per state those that lead to it, itself left out. parents: per state the edge (an index) by which a
    breadth-first search finds it first, -1 for the initial state. hardware: names, numbered as the bits of `lost`,
    which tells for each state what is out of service. succeeded, failed: the states of either outcome.
    """

    graph: AlternativesGraph
    sources: list[list[int]]
    parents: list[int]
    hardware: tuple[str, ...]
    lost: list[int]
    succeeded: frozenset[int]
    failed: frozenset[int]


def survey(graph: AlternativesGraph) -> Survey:
    """One pass over the edges. States must be numbered breadth first: the first way to a state is then a shortest."""
    hardware = tuple(dict.fromkeys(name for _, name in graph.net.meanings.lost))
    lost = labels(graph, [[place for place, name in graph.net.meanings.lost if name == one] for one in hardware])
    outcomes = [[place for place, said in graph.net.meanings.outcomes if said == one] for one in ("success", "failure")]
    ends = labels(graph, outcomes)
    sources, parents = sources_of(graph, lambda kind: True)
    succeeded = frozenset(state for state, end in enumerate(ends) if end & 1)
    return Survey(
        graph, sources, parents, hardware, lost, succeeded, frozenset(s for s, end in enumerate(ends) if end & 2)
    )


def labels(graph: AlternativesGraph, meanings: list[list[int]]) -> list[int]:
    """Per state a bit set: bit i is set where one of the places `meanings[i]` is marked."""
    relevant = marking(tuple(place for places in meanings for place in places))
    masks = [marking(tuple(places)) for places in meanings]
    known: dict[int, int] = {}  # few combinations, many states
    found = []
    for state in graph.markings:
        key = state & relevant
        label = known.get(key)
        if label is None:
            label = known[key] = sum(1 << bit for bit, mask in enumerate(masks) if key & mask)
        found.append(label)
    return found


def sources_of(graph: AlternativesGraph, wanted: Callable[[EventKind], bool]) -> tuple[list[list[int]], list[int]]:
    """Per state the sources of the wanted edges into it (not itself), and the first such edge, -1 where none is."""
    good = [wanted(event.kind) for event in graph.net.events]
    everything = all(good)
    sources: list[list[int]] = [[] for _ in graph.markings]
    parents = [-1] * len(graph.markings)
    first, events, targets = graph.first, graph.events, graph.targets
    for state in range(len(graph.markings)):
        for edge in range(first[state], first[state + 1]):
            if everything or good[events[edge]]:
                target = targets[edge]
                if target != state:
                    if not sources[target]:
                        parents[target] = edge
                    sources[target].append(state)
    parents[graph.initial] = -1
    return sources, parents


def backward(sources: list[list[int]], start: Iterable[int]) -> bytearray:
    """1 for each state from which one of `start` can be reached."""
    found = bytearray(len(sources))
    todo = list(start)
    for state in todo:
        found[state] = 1
    while todo:
        for source in sources[todo.pop()]:
            if not found[source]:
                found[source] = 1
                todo.append(source)
    return found


def trace(seen: Survey, state: int) -> tuple[str, ...]:
    """The events of a shortest run from the initial state to this one."""
    graph, names = seen.graph, list[str]()
    while state != graph.initial:
        edge = seen.parents[state]
        names.append(graph.net.events[graph.events[edge]].name)
        state = source_of(graph, edge)
    return tuple(reversed(names))


def source_of(graph: AlternativesGraph, edge: int) -> int:
    """The state that an edge leaves."""
    return bisect_right(graph.first, edge) - 1
