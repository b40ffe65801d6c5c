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

    points: those of them that are entered from a state with hope, shortest runs first.
    """

    states: tuple[int, ...]
    points: tuple[NoReturn, ...]


def lost_success(seen: Survey) -> LostSuccess:
    """All states where success is lost but not yet failure, and how it gets lost."""
    hopeful = backward(seen.sources, seen.succeeded)
    states = tuple(state for state in range(len(hopeful)) if not hopeful[state] and state not in seen.failed)
    points = [NoReturn(0, ())] if not hopeful[seen.graph.initial] else []
    for state in states:
        # States are numbered breadth first: the first hopeful source has a shortest run to it, through hope only.
        before = next((source for source in seen.sources[state] if hopeful[source]), None)
        if before is not None:
            edge = _edge(seen, before, state)
            points.append(NoReturn(state, (*trace(seen, before), edge)))
    return LostSuccess(states, tuple(sorted(points, key=lambda one: (len(one.events), one.state))))


def _edge(seen: Survey, source: int, target: int) -> str:
    """The first event that leads from one state to the other."""
    graph = seen.graph
    parent = seen.parents[target]
    if parent >= 0 and source_of(graph, parent) == source:
        return graph.net.events[graph.events[parent]].name
    return next(graph.net.events[event].name for event, reached in graph.successors(source) if reached == target)
