"""Whether the mission can succeed: at all, and whatever few resources are lost on the way."""

from __future__ import annotations

from mauve.mission.formula import SuccessReachable, Verdict
from mauve.mission.graph import AlternativesGraph
from mauve.mission.net import EventKind
from mauve.mission.survey import RESOURCE_EVENTS, Survey, backward, sources_of, trace

__all__ = ["check_success"]


def check_success(seen: Survey, wanted: SuccessReachable) -> Verdict:
    """Without `lost`: some run reaches success; the witness is a shortest one.

    With `lost`: whichever resources of `among` (all hardware, if it names none) go out of service, at most `lost` of
    them, whenever they do and though none comes back, success can still be reached. Looked at is each state that comes
    about by such losses, by the start and by objectives reached; an objective fails only where it has no choice (its
    success is no longer possible). From there on no more is lost. The witness is a shortest run to a state from which
    there is no success, or to success where the property holds.
    """
    shortest = min(seen.succeeded, default=None)
    run = () if shortest is None else trace(seen, shortest)
    if wanted.lost is None:
        return Verdict("success_reachable", shortest is not None, run)
    name = f"success_reachable_with_{wanted.lost}_lost" + (f"_of_{'_'.join(wanted.among)}" if wanted.among else "")
    calm, _ = sources_of(seen.graph, lambda kind: kind not in RESOURCE_EVENTS)
    ruin = _first_ruin(seen, wanted, backward(calm, seen.succeeded))
    return Verdict(name, True, run) if ruin is None else Verdict(name, False, ruin, "from here there is no success")


def _first_ruin(seen: Survey, wanted: SuccessReachable, hopeful: bytearray) -> tuple[str, ...] | None:
    """The events of a shortest run with few losses to a state that is not hopeful."""
    graph = seen.graph
    allowed = sum(1 << at for at, one in enumerate(seen.hardware) if not wanted.among or one in wanted.among)
    came: dict[int, tuple[int, int] | None] = {graph.initial: None}
    todo = [graph.initial]
    for state in todo:
        if not hopeful[state]:
            return _run(graph, came, state)
        for event, target in _steps(graph, state):
            gone = seen.lost[target]
            if target not in came and gone & ~allowed == 0 and gone.bit_count() <= (wanted.lost or 0):
                came[target] = (state, event)
                todo.append(target)
    return None


def _steps(graph: AlternativesGraph, state: int) -> list[tuple[int, int]]:
    """The edges of a state but recoveries, and but failures of objectives that could still be reached from it."""
    here = list(graph.successors(state))
    events = graph.net.events
    within_reach = {events[event].subject for event, _ in here if events[event].kind is EventKind.OK}
    kept = []
    for event, target in here:
        kind = events[event].kind
        avoidable = kind in (EventKind.FAIL, EventKind.TIMEOUT) and events[event].subject in within_reach
        if kind is not EventKind.RECOVERED and not avoidable:
            kept.append((event, target))
    return kept


def _run(graph: AlternativesGraph, came: dict[int, tuple[int, int] | None], state: int) -> tuple[str, ...]:
    names = []
    while (step := came[state]) is not None:
        state = step[0]
        names.append(graph.net.events[step[1]].name)
    return tuple(reversed(names))
