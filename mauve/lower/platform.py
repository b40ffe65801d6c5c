"""From the model's board and flow facts to those of the WCET engine, and its overheads to those of the timing
analysis.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from mauve.model.model import AssumedRange, Board, CodePlace, ControlFact, LoopFact, Node, RecursionFact, Wait
from mauve.timing.task import Interrupt, Kind, Platform
from mauve.units import time_to_cycles

if TYPE_CHECKING:
    from mauve.model.facts import FlowFact
    from mauve.wcet.flow import facts
    from mauve.wcet.hardware import board as hardware


def wcet_board(board: Board) -> hardware.Board:
    """The board as the WCET engine sees it; waits in time become CPU cycles, rounded up."""
    from mauve.wcet.hardware import board as hardware

    memories = tuple(
        hardware.Memory(
            memory.name,
            memory.start,
            memory.size,
            _cycles(memory.wait, board.hertz),
            _cycles(memory.write_wait, board.hertz) if memory.write_wait else None,
        )
        for memory in board.memories
    )
    features = tuple(" ".join((feature.name, *feature.settings)) for feature in board.features)
    return hardware.Board(board.name, board.core, board.hertz, memories, features)


def _cycles(wait: Wait, hertz: int) -> int:
    return wait.amount if wait.in_cycles else time_to_cycles(wait.amount, hertz)


def flow_facts(written: Sequence[FlowFact]) -> tuple[facts.Fact, ...]:
    """Facts in the words of the WCET engine. A loop by source line counts bodies, one by address or symbol counts
    headers (semantics of record, section 5). `key` is the index of the fact among those given."""
    return tuple(_fact(fact, key) for key, fact in enumerate(written))


def _fact(fact: FlowFact, key: int) -> facts.Fact:
    from mauve.wcet.flow import facts

    place, where = _place(fact.place), str(fact.span)
    match fact:
        case LoopFact():
            counting = facts.Counting.BODY if isinstance(place, facts.AtLine) else facts.Counting.HEADER
            return facts.LoopFact(place, fact.maximum, counting, fact.total, where, key)
        case RecursionFact():
            return facts.RecursionFact(place, fact.maximum, where, key)
        case ControlFact():
            kind = facts.ControlKind.TARGETS if fact.targets else facts.ControlKind.NO_RETURN
            return facts.ControlFact(kind, place, tuple(_place(target) for target in fact.targets), where, key)
        case AssumedRange():
            at: facts.Place | facts.Argument = place
            if fact.argument is not None:
                at = facts.Argument(fact.place.symbol or "", fact.argument)
            return facts.AssumeFact(at, fact.low, fact.high, fact.width or 0, where, key, fact.ends or 0)


def _place(place: CodePlace) -> facts.Place:
    from mauve.wcet.flow import facts

    if place.file is not None and place.line is not None:
        return facts.AtLine(place.file, place.line)
    if place.symbol is not None:
        return facts.AtSymbol(place.symbol, place.address)
    return facts.AtAddress(place.address)


def timing_platform(node: Node, handlers: Mapping[str, int]) -> Platform:
    """Context switches, ticks and interrupts of a node; `handlers` gives the cost of each interrupt by name.

    An interrupt pays two context switches, one to its handler and one back. The names have a space in them, which those
    of tasks have not.
    """
    board = node.board
    interrupts = [
        Interrupt(f"interrupt {one.name}", one.every, handlers[one.name] + 2 * board.context_switch)
        for one in node.interrupts
        if one.name in handlers
    ]
    if board.tick_every is not None:
        interrupts.append(Interrupt("system tick", board.tick_every, board.tick_cost, Kind.TICK))
    return Platform(board.context_switch, tuple(interrupts))
