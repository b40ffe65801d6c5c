"""Whether the mission can be stuck: a state, not final, in which nothing but the coming and going of hardware happens.

That some event is always possible says nothing here: hardware can break and recover in success and failure, too. So a
state is dead if it is not final, and no event of the mission itself is possible in it or after any recoveries.
"""

from __future__ import annotations

from mauve.mission.formula import Verdict
from mauve.mission.net import EventKind
from mauve.mission.survey import RESOURCE_EVENTS, Survey, backward, sources_of, trace

__all__ = ["check_live", "dead_states"]


def dead_states(seen: Survey) -> tuple[int, ...]:
    """The dead states, in the order of the graph: those nearest to the start come first."""
    graph = seen.graph
    moving = {at for at, event in enumerate(graph.net.events) if event.kind not in RESOURCE_EVENTS}
    first, events, final = graph.first, graph.events, seen.succeeded | seen.failed
    still = [
        state
        for state in range(len(graph.markings))
        if state not in final and moving.isdisjoint(events[first[state] : first[state + 1]])
    ]
    if not still:
        return ()
    fine = set(range(len(graph.markings))).difference(still)
    recovering, _ = sources_of(graph, lambda kind: kind is EventKind.RECOVERED)
    alive = backward(recovering, fine)
    return tuple(state for state in range(len(alive)) if not alive[state])


def check_live(seen: Survey) -> Verdict:
    """`live`: no state is dead. The witness is a shortest run to a dead one."""
    dead = dead_states(seen)
    if not dead:
        return Verdict("live", True)
    return Verdict("live", False, trace(seen, dead[0]), f"{len(dead)} states are neither final nor can they go on")
