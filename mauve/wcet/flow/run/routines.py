"""Library routines in a run: how often their loops can repeat follows from what they are called with.

The table of known routines (flow/library) gives bounds as formulas of arguments and of the lengths of strings; a run
knows both where it comes to a call.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import MASK, Range
from mauve.wcet.flow.library import STRING, KnownFunction, KnownLoop, Recognised, known_bound
from mauve.wcet.flow.run.memory import Memory
from mauve.wcet.flow.run.words import Word, is_wild, range_of

Formulas = tuple[tuple[int, KnownFunction, KnownLoop], ...]
"""Loops of a known routine by number, with what the table says of them."""


def formulas(cfg: Cfg, nest: LoopNest, recognised: Sequence[Recognised]) -> Formulas:
    """The loops of a function whose bounds follow from its arguments."""
    return tuple(
        (loop.id, part.known, known)
        for part in recognised
        for loop in nest.loops
        for known in (part.known.loops if part.whole and loop.header in part.blocks else ())
        if known.offset == cfg.blocks[loop.header].address - part.address and known.total.registers()
    )


def limits(loops: Formulas, registers: Sequence[Any], memory: Memory) -> dict[int, int]:
    """The bounds of such loops where the routine is entered, as far as the arguments are known."""
    greatest: dict[int, int] = {}

    def of(register: int) -> int:
        if register not in greatest:
            greatest[register] = _greatest(register, registers, memory)
        return greatest[register]

    found: dict[int, int] = {}
    for loop, known, entry in loops:
        bound = known_bound(known, entry, of, True)
        if bound is not None:
            found[loop] = min(bound.bound, found.get(loop, bound.bound))
    return found


def _greatest(register: int, registers: Sequence[Any], memory: Memory) -> int:
    """The greatest number that an argument can be, or length of a string that it points to with the 0 at its end."""
    if register >= STRING:
        length = memory.longest(registers[register - STRING])
        return MASK if length is None else length
    word: Word = registers[register]
    values = None if is_wild(word) else range_of(word)
    return MASK if values is None else values.unsigned_bounds()[1]


def measures(names: Sequence[str]) -> bool:
    """Whether a routine returns the length of a string."""
    return "strlen" in names


def length_at(argument: Word, memory: Memory) -> Range | None:
    """What such a routine can return."""
    length = memory.longest(argument)
    return None if length is None else domain.between(0, length - 1)


__all__ = ["Formulas", "formulas", "length_at", "limits", "measures"]
