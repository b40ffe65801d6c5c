"""From the model's board and flow facts to those of the WCET engine, and its overheads to those of the timing
analysis.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from mauve.model.model import Binary, Board, LoopFact, Node, Wait
from mauve.timing.task import Interrupt, Kind, Platform
from mauve.units import time_to_cycles

if TYPE_CHECKING:
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


def flow_facts(binary: Binary) -> tuple[facts.Fact, ...]:
    """The loop facts of a binary. One by source line counts bodies, one by address or symbol counts headers
    (semantics of record, section 5). `key` is the index of the fact in `binary.loops`."""
    return tuple(_loop_fact(fact, key) for key, fact in enumerate(binary.loops))


def _loop_fact(fact: LoopFact, key: int) -> facts.LoopFact:
    from mauve.wcet.flow import facts

    place: facts.Place
    counting = facts.Counting.HEADER
    if fact.file is not None and fact.line is not None:
        place, counting = facts.AtLine(fact.file, fact.line), facts.Counting.BODY
    elif fact.symbol is not None:
        place = facts.AtSymbol(fact.symbol, fact.address or 0)
    else:
        place = facts.AtAddress(fact.address or 0)
    return facts.LoopFact(place, fact.maximum, counting, fact.total, str(fact.span), key)


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
