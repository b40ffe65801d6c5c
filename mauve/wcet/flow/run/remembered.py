"""Calls that need not be followed again: of functions whose result depends on their arguments alone.

A function is closed when it and what it calls touch no memory but their own frames and constants. What came of such a
call holds for every later one with arguments that the earlier one covered.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.microop import SP, Compute, IndirectCall, Load, Op, Operand, Store, StoreUnknown
from mauve.wcet.flow.domain import Range
from mauve.wcet.flow.effects import quotients
from mauve.wcet.flow.locations import Helper
from mauve.wcet.flow.run.covering import covers
from mauve.wcet.flow.run.words import Some, Word, is_wild, range_of

ARGUMENTS = (0, 1, 2, 3)
RESULTS = (0, 1, 2, 3, 12)
SAVED = (4, 5, 6, 7, 8, 9, 10, 11, SP)

MOST_APART = 6
"""Calls of a closed function that are followed for what their arguments are; the next is followed for any."""


@dataclass(frozen=True, slots=True)
class Call:
    """A call that was followed: its arguments and results by register, the behaviour, and the bytes of stack."""

    arguments: tuple[Word, ...]
    results: tuple[Range, ...]
    behaviour: int
    used: int

    def holds_for(self, registers: list[Any]) -> bool:
        """Whether it covers a call with these registers."""
        return all(covers(mine, registers[number]) for number, mine in zip(ARGUMENTS, self.arguments, strict=True))


def closed(key: int, graphs: Mapping[int, Cfg]) -> bool:
    """Whether a function (a key) and all that it calls reach memory through sp and constants alone."""
    seen, work = {key}, [key]
    while work:
        cfg = graphs.get(work.pop())
        if cfg is None or cfg.unresolved or not all(_keeps_to_itself(block.instructions) for block in cfg.blocks):
            return False
        for edge in cfg.edges:
            work += [callee for callee in edge.callees if callee not in seen]
            seen.update(edge.callees)
    return True


def _keeps_to_itself(instructions: tuple[Any, ...]) -> bool:
    for instruction in instructions:
        if isinstance(instruction.flow, IndirectCall):
            return False
        derived = {SP}
        for op in instruction.ops:
            match op:
                case Compute(Op.ADD | Op.SUB, dst, a, b) if dst > SP:
                    if _through(a, derived) and not (isinstance(b, int) and b in derived):
                        derived.add(dst)
                    else:
                        derived.discard(dst)
                case Compute(Op.MOV, dst, a) if dst > SP and isinstance(a, int) and a in derived:
                    derived.add(dst)
                case Compute(_, dst):
                    if dst != SP:
                        derived.discard(dst)
                case Load(dst, address):
                    if isinstance(address, int) and address not in derived:
                        return False
                    derived.discard(dst)
                case Store(address) | StoreUnknown(address):
                    if not _through(address, derived):
                        return False
    return True


def _through(operand: Operand, derived: set[int]) -> bool:
    return isinstance(operand, int) and operand in derived


def result_of(before: list[Any], after: list[Any], behaviour: int, used: int) -> Call | None:
    """What to remember of a call, given the registers before and after it; None when it did more than it should."""
    if any(after[number] is not before[number] and not _same(after[number], before[number]) for number in SAVED):
        return None
    results = [None if is_wild(after[number]) else range_of(after[number]) for number in RESULTS]
    if any(is_wild(before[number]) for number in ARGUMENTS):
        return None
    known = tuple(values for values in results if values is not None)
    if len(known) < len(results):
        return None
    return Call(tuple(before[number] for number in ARGUMENTS), known, behaviour, used)


def _same(a: Any, b: Any) -> bool:
    if type(a) is int and type(b) is int:
        return a == b
    return type(a) is type(b) and hasattr(a, "offset") and not isinstance(a, Some) and a.offset == b.offset


def computed(helper: Helper, dividend: Word, divisor: Word) -> tuple[Range | None, Range | None]:
    """What r0 and r1 are after a division of words; None: anything."""
    x, y = range_of(dividend), range_of(divisor)
    found = {} if x is None or y is None else dict(quotients(helper, x, y))
    return found.get(0), found.get(1)
