"""Bounds of loops that a run follows for all values at once: a word, or the difference of two that are compared, that
every iteration moves one way within a range that covers all iterations.

The range is what is known at the loop's header once nothing new comes of further iterations. How far an iteration moves
a word is the difference between what is at its place in the end and the word that was there when it began. These are
linear ranking functions, as flow/ranking finds them without a run.
"""

from __future__ import annotations

from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import MODULUS, Range
from mauve.wcet.flow.run.compared import Where
from mauve.wcet.flow.run.compile import RELATED
from mauve.wcet.flow.run.frames import Function
from mauve.wcet.flow.run.memory import Memory
from mauve.wcet.flow.run.paths import Path, word_at
from mauve.wcet.flow.run.related import difference
from mauve.wcet.flow.run.repeats import Kept
from mauve.wcet.flow.run.states import few_states
from mauve.wcet.flow.run.words import Ranged, Some, Word

MOST_SPAN = 1 << 24
"""A word that may move farther says nothing of a loop but how wide a register is."""


def iterations(memory: Memory, kept: Kept, path: Path, function: Function, loop: int, apart: int) -> int | None:
    """How many more times the header of a loop is executed, at most, after the path that was kept came to it. Of that
    path every later one is a special case, such as `path`, which came `apart` iterations later. None where no word
    tells."""
    found: list[int] = []
    for place, start in kept.starts:
        step = _step(memory, place, kept.path, path)
        if step is not None:
            found += _most(start.range, step)
        found += _shrinking(start, word_at(memory, place, path))
    for a, b in function.compared.pairs:
        first, second = word_at(memory, a, kept.path), word_at(memory, b, kept.path)
        if first is None or second is None or not (isinstance(first, Ranged) and isinstance(second, Ranged)):
            continue
        values = difference(first, second, kept.path.registers[RELATED])
        one, other = _step(memory, a, kept.path, path), _step(memory, b, kept.path, path)
        if values is not None and one is not None and other is not None:
            found += _most(values, domain.sub(one, other))
    states = few_states(memory, kept, path, function, loop)
    if states is not None:
        found.append(states - 1)
    return (min(found) + 1) * apart - 1 if found else None


def _shrinking(start: Ranged, after: Word | None) -> list[int]:
    """How often a word can become a part of itself before it is zero, which it is in no further iteration."""
    if type(after) is not Some or type(start) is not Some or after.part is None or 0 in after.range:
        return []
    whole, a, b = after.part
    if whole.base is not start.base or whole.offset != start.offset or 2 * a > b:
        return []
    most, times = start.range.unsigned_bounds()[1], 0
    while most:
        most, times = most * a // b, times + 1
    return [times]


def _step(memory: Memory, place: Where, before: Path, path: Path) -> Range | None:
    """How far the word at a place was moved from one path to a later one."""
    first, second = word_at(memory, place, before), word_at(memory, place, path)
    return None if first is None or second is None else difference(second, first, path.registers[RELATED])


def _most(values: Range, step: Range) -> list[int]:
    """How often a word can make a step without leaving its range: it moves one way, and not around the circle."""
    low, high = step.signed_bounds()
    least, most = (low, high) if low > 0 else (-high, -low)
    if least <= 0 or values.span > MOST_SPAN or values.span + most >= MODULUS:
        return []
    return [values.span // least]
