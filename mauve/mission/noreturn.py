"""Points of no return: where success is lost though failure has not been declared."""

from __future__ import annotations

from mauve.mission.survey import Survey, backward, source_of, trace
from mauve.records import record

__all__ = ["LostSuccess", "NoReturn", "lost_success"]


@record
class NoReturn:
    """A state from which success cannot be reached, entered from one from which it can.

    events: a shortest run to it; the last one is the event of no return.
    """

    state: int
    events: tuple[str, ...]


@record
class LostSuccess:
    """states: all from which no events at all, recoveries included, lead to success, and that are not yet failure.

    points: those that are entered from a state with hope, shortest runs first; `entries` is how many there are, where
    not all are told.
    """

    states: tuple[int, ...]
    points: tuple[NoReturn, ...]
    entries: int


def lost_success(seen: Survey, limit: int = 100) -> LostSuccess:
    """All states where success is lost but not yet failure, and the `limit` shortest ways to lose it."""
    hopeful = backward(seen.sources, seen.succeeded)
    states = tuple(state for state in range(len(hopeful)) if not hopeful[state] and state not in seen.failed)
    if not hopeful[seen.graph.initial]:
        return LostSuccess(states, (NoReturn(seen.graph.initial, ()),), 1)
    # States are numbered breadth first: of the hopeful sources of one, the first has a shortest run, through hope only.
    entered = [
        (before, state)
        for state in states
        if (before := next((source for source in seen.sources[state] if hopeful[source]), -1)) >= 0
    ]
    near = sorted(entered)[:limit]
    points = [NoReturn(state, (*trace(seen, before), _edge(seen, before, state))) for before, state in near]
    return LostSuccess(states, tuple(points), len(entered))


def _edge(seen: Survey, source: int, target: int) -> str:
    """The first event that leads from one state to the other."""
    graph = seen.graph
    parent = seen.parents[target]
    if parent >= 0 and source_of(graph, parent) == source:
        return graph.net.events[graph.events[parent]].name
    return next(graph.net.events[event].name for event, reached in graph.successors(source) if reached == target)
