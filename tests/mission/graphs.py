"""Small random alternatives graphs, made without a net: any graph will do for what is asked of graphs."""

from __future__ import annotations

from array import array
from random import Random

from mauve.mission.graph import AlternativesGraph
from mauve.mission.net import Event, EventKind, Meanings, Net

HARDWARE = ("R", "S", "T")
OBJECTIVES = ("A", "B.C")
EVENTS = (
    Event("MISSION_EV_START", EventKind.START),
    *(Event(f"{path}_EV_OK", EventKind.OK, path) for path in OBJECTIVES),
    *(Event(f"{path}_EV_FAIL", EventKind.FAIL, path) for path in OBJECTIVES),
    *(Event(f"{name}_EV_OOS", EventKind.LOST, name) for name in HARDWARE),
    *(Event(f"{name}_EV_RD", EventKind.RECOVERED, name) for name in HARDWARE),
)
MEANINGS = Meanings(
    objectives=((0, "A"), (1, "B.C")),
    running=((2, "drive", "fast"), (3, "drive", "slow")),
    lost=((4, "R"), (5, "S"), (6, "T")),
    outcomes=((7, "success"), (8, "failure")),
)
"""The meaning of the first nine places; the others number the states, so that no two markings are equal."""


def random_graph(random: Random) -> AlternativesGraph:
    """Some states and edges, numbered breadth first; a hardware event changes what is lost as it says."""
    count = random.randrange(1, 9)
    names = [f"place{at}" for at in range(9 + 4)]
    cores = [_core(random) for _ in range(count)]
    ways: list[dict[int, int]] = [{} for _ in range(count)]
    for state in range(count):
        for _ in range(random.randrange(4)):
            target = random.randrange(count)
            event = _event(random, cores[state], cores[target])
            if event is not None:
                ways[state][event] = target
    order, number = [0], {0: 0}
    for state in order:
        for _, target in sorted(ways[state].items()):
            if target not in number:
                number[target] = len(order)
                order.append(target)
    first, events, targets = array("Q", [0]), array("H"), array("I")
    for state in order:
        for event, target in sorted(ways[state].items()):
            events.append(event)
            targets.append(number[target])
        first.append(len(events))
    markings = tuple(cores[state] | state << 9 for state in order)
    net = Net("random", tuple(names), (), (), EVENTS, MEANINGS, ("",) * len(names))
    return AlternativesGraph(net, markings, first, events, targets, array("I", [0] * len(events)), ())


def _core(random: Random) -> int:
    end = random.choice([0, 0, 0, 0, 1 << 7, 1 << 8])
    return random.getrandbits(4) | random.getrandbits(3) << 4 & random.getrandbits(3) << 4 | end


def _event(random: Random, source: int, target: int) -> int | None:
    lost, before = target >> 4 & 7, source >> 4 & 7
    for bit in range(3):
        if lost == before | 1 << bit and lost != before:
            return 5 + bit
        if before == lost | 1 << bit and lost != before:
            return 8 + bit
    return random.randrange(5) if lost == before else None
