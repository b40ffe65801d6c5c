"""Cuts: smallest sets of hardware whose loss forces failure.

*Of an elementary objective* (at one place of the mission): a set S is a cut iff the objective cannot be reached while
all of S is out of service, that is, in no reachable stable state are S out of service and its event of success
possible. What else is out of service does not matter, nor when S was lost: before the objective or during it.

*Of the mission*: S is a cut iff no run from the initial state, in which all of S is out of service from before the
start on and never recovers, leads to success. Other resources may come and go.

Both kinds are closed upwards, so the minimal ones (by inclusion) say everything. Only hardware that can fail is in a
cut. The cut of no resources at all, (), says that nothing has to be lost: there is no success anyway.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from mauve.mission.cascades import bits
from mauve.mission.graph import AlternativesGraph
from mauve.mission.net import EventKind
from mauve.mission.survey import RESOURCE_EVENTS, Survey
from mauve.records import record

__all__ = ["ObjectiveCuts", "Sets", "minimal_hitting_sets", "mission_cuts", "objective_cuts"]

Sets = tuple[tuple[str, ...], ...]
"""Sets of hardware, each in order of declaration; smaller sets first."""


@record
class ObjectiveCuts:
    """The minimal cuts of the elementary objective at a path."""

    path: str
    cuts: Sets


def objective_cuts(seen: Survey) -> tuple[ObjectiveCuts, ...]:
    """The minimal cuts of each elementary objective, in the order of the net's events."""
    graph = seen.graph
    survived: dict[int, set[int]] = {
        at: set() for at, event in enumerate(graph.net.events) if event.kind is EventKind.OK
    }
    for state in range(len(graph.markings)):
        for event in graph.events[graph.first[state] : graph.first[state + 1]]:
            if event in survived:
                survived[event].add(seen.lost[state])
    fragile = _fragile(seen)
    found: dict[str, Sets] = {}
    for event, lost in survived.items():
        cuts = minimal_hitting_sets([fragile & ~one for one in _greatest(lost)])
        found[graph.net.events[event].subject] = _sets(seen, cuts)
    return tuple(ObjectiveCuts(path, cuts) for path, cuts in found.items())


def mission_cuts(seen: Survey, limit: int = 4096) -> Sets | None:
    """The minimal cuts of the mission; None if more than `limit` sets would have to be tried.

    Each round looks for a set that hits the complements of all sets known to be survived. Where that is a cut, it is
    minimal once no member can be left out; where it is not, it grows to a survived set. (The duality of hitting sets,
    as in Reiter's diagnosis from first principles, 1987.)
    """
    fragile = _fragile(seen)
    tried: dict[int, bool] = {}
    survives = _oracle(seen, tried)
    complements: list[int] = []
    while len(tried) <= limit:
        candidates = minimal_hitting_sets(complements)
        wrong = next((one for one in candidates if survives(one)), None)
        if wrong is None:
            return _sets(seen, candidates)
        for bit in bits(fragile & ~wrong):
            if survives(wrong | 1 << bit):
                wrong |= 1 << bit
        complements.append(fragile & ~wrong)
    return None


def minimal_hitting_sets(sets: Iterable[int]) -> list[int]:
    """The smallest bit sets that share a bit with each of these, smaller ones first (Berge's multiplication)."""
    found = [0]
    for one in sets:
        hit = [known for known in found if known & one]
        grown = {known | 1 << bit for known in found if not known & one for bit in bits(one)}
        found = hit + [new for new in _least(grown) if not any(known & ~new == 0 for known in hit)]
    return sorted(found, key=lambda one: (one.bit_count(), list(bits(one))))


def _least(sets: Iterable[int]) -> list[int]:
    kept: list[int] = []
    for one in sorted(sets, key=int.bit_count):
        if not any(small & ~one == 0 for small in kept):
            kept.append(one)
    return kept


def _greatest(sets: Iterable[int]) -> list[int]:
    kept: list[int] = []
    for one in sorted(sets, key=int.bit_count, reverse=True):
        if not any(one & ~great == 0 for great in kept):
            kept.append(one)
    return kept


def _fragile(seen: Survey) -> int:
    """The hardware that can go out of service."""
    failing = {event.subject for event in seen.graph.net.events if event.kind is EventKind.LOST}
    return sum(1 << at for at, name in enumerate(seen.hardware) if name in failing)


def _sets(seen: Survey, sets: Iterable[int]) -> Sets:
    return tuple(tuple(seen.hardware[at] for at in bits(one)) for one in sets)


def _oracle(seen: Survey, tried: dict[int, bool]) -> Callable[[int], bool]:
    """Whether a set of hardware, out of service from before the start and for ever, still leaves a run to success."""
    graph = seen.graph
    kinds = [event.kind for event in graph.net.events]
    before_start = _search(graph, [graph.initial], lambda event, _: kinds[event] in RESOURCE_EVENTS, frozenset())

    def survives(gone: int) -> bool:
        if gone not in tried:
            # Most often a run in which nothing else is lost will do, and few states have exactly this set out.
            start = [state for state in before_start if seen.lost[state] & gone == gone]
            bare = [state for state in start if seen.lost[state] == gone]
            quick = _search(graph, bare, lambda _, target: seen.lost[target] == gone, seen.succeeded)
            tried[gone] = not seen.succeeded.isdisjoint(quick) or not seen.succeeded.isdisjoint(
                _search(graph, start, lambda _, target: seen.lost[target] & gone == gone, seen.succeeded)
            )
        return tried[gone]

    return survives


def _search(
    graph: AlternativesGraph, start: list[int], wanted: Callable[[int, int], bool], goal: frozenset[int]
) -> set[int]:
    """The states reached over wanted edges (event, target), up to the first of the goal."""
    found, todo = set(start), list(start)
    while todo:
        state = todo.pop()
        if state in goal:
            break
        for event, target in graph.successors(state):
            if target not in found and wanted(event, target):
                found.add(target)
                todo.append(target)
    return found
