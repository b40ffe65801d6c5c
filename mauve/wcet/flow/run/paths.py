"""Paths that are followed apart, and what holds where they meet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import Range
from mauve.wcet.flow.run.compared import Pairs, Register, Where
from mauve.wcet.flow.run.compile import ASKED, DEPTH, RELATED
from mauve.wcet.flow.run.covering import merge
from mauve.wcet.flow.run.joining import join_layers
from mauve.wcet.flow.run.layers import Half, Layer
from mauve.wcet.flow.run.memory import STACK, Memory
from mauve.wcet.flow.run.related import Triple, base_of, together
from mauve.wcet.flow.run.words import MASK, Ranged, Some, Stack, Stacks, Word


@dataclass(slots=True)
class Counters:
    """What an execution of a function has done so far, at most: how often each edge was passed, the executions of each
    loop's header since it was entered and the most of them, what was called on each edge; the `trail` is a way through
    a loop that is followed apart from others."""

    counts: list[int]
    current: list[int]
    most: list[int]
    calls: dict[int, frozenset[int]]
    trail: int = 0

    def copy(self) -> Counters:
        """The same, to go on with apart."""
        return Counters(self.counts.copy(), self.current.copy(), self.most.copy(), self.calls.copy(), self.trail)

    def join(self, other: Counters) -> None:
        """Cover another path as well."""
        self.counts = list(map(max, self.counts, other.counts))
        self.current = list(map(max, self.current, other.current))
        self.most = list(map(max, self.most, other.most))
        for edge, callees in other.calls.items():
            known = self.calls.get(edge)
            self.calls[edge] = callees if known is None else known | callees


@dataclass(slots=True)
class Path:
    """One path that waits to go on at a block."""

    block: int
    registers: list[Any]
    layer: Layer
    counters: Counters


Starts: TypeAlias = Sequence[tuple[Where, Ranged]]
"""Places and the words that were there when an iteration began."""

_NUMBERS, _IN_STACK = (int, Some), (Stack, Stacks)


class Meeting:
    """Words that cover those of two paths. What was one word on both stays one word, and words that lie equally far
    apart on both do so where they have met."""

    def __init__(self, memory: Memory) -> None:
        self._memory = memory
        self._made: dict[tuple[int, int], Triple] = {}
        self._apart: dict[tuple[bool, int, int, int], tuple[int, Ranged]] = {}

    def join(self, path: Path, other: Path, compared: Pairs = (), starts: Starts = ()) -> Path:
        """One path for both; it is kept how words lie to each other that are `compared`, and how they lie to those
        that were there before, the `starts`."""
        word = self.word
        before, after = path.registers, other.registers
        registers = [a if a is b else word(a, b) for a, b in zip(before, after, strict=True)]
        registers[DEPTH] = min(before[DEPTH], after[DEPTH])
        registers[ASKED] = None
        places = {*(place for pair in compared for place in pair), *(place for place, _ in starts)}
        words = {place: words_at(self._memory, place, path, other, registers, word) for place in places}
        layer = join_layers(self._memory, path.layer, other.layer, word)
        pairs = [(one, two) for a, b in compared if (one := words[a]) is not None and (two := words[b]) is not None]
        pairs += [(one, (start, start, start)) for place, start in starts if (one := words[place]) is not None]
        begun = {id(start.base) for _, start in starts}
        alive = {id(word.base) for word in registers[:15] if isinstance(word, Ranged)}
        registers[RELATED] = together(before[RELATED], after[RELATED], self._made.values(), pairs, alive, begun)
        path.counters.join(other.counters)
        return Path(path.block, registers, layer, path.counters)

    def word(self, a: Any, b: Any) -> Any:
        """A word for two."""
        if a is b or (type(a) is int and type(b) is int and a == b):
            return a
        if a is None or b is None:
            return None
        known = self._made.get((id(a), id(b)))
        if known is None:
            known = self._made[id(a), id(b)] = a, b, self._merged(a, b)
        return known[2]

    def _merged(self, a: Word, b: Word) -> Word:
        in_stack = type(a) in _IN_STACK
        if not in_stack and not (type(a) in _NUMBERS and type(b) in _NUMBERS):
            return merge(a, b)
        if in_stack and type(b) not in _IN_STACK:
            return merge(a, b)
        merged = merge(a, b)
        if not isinstance(merged, Ranged):
            return merged
        (from_a, at_a), (from_b, at_b) = base_of(a), base_of(b)
        kind = type(merged)
        if from_a is from_b and from_a is not None and at_a == at_b:
            return kind(merged.range, from_a, at_a)
        key = in_stack, id(from_a), id(from_b), (at_b - at_a) & MASK
        first = self._apart.get(key)
        if first is None:
            self._apart[key] = at_a, merged
            return merged
        ahead = at_a - first[0]
        values = domain.meet(merged.range, domain.shift(first[1].range, ahead))
        return kind(values or merged.range, first[1].base, (first[1].offset + ahead) & MASK)


def words_at(
    memory: Memory, place: Where, path: Path, other: Path, registers: list[Any], word: Callable[[Any, Any], Any]
) -> Triple | None:
    """The words at a place on two paths, and where they meet; None where numbers tell as much."""
    first, second = word_at(memory, place, path), word_at(memory, place, other)
    if first is None or second is None:
        return None
    met = registers[place.number] if isinstance(place, Register) else word(first, second)
    return (first, second, met) if isinstance(met, Ranged) else None


def word_at(memory: Memory, place: Where, path: Path) -> Word | None:
    """The word at a place on a path; None where it is not in one piece there."""
    if isinstance(place, Register):
        return path.registers[place.number]  # type: ignore[no-any-return]
    at = path.registers[place.register]
    if type(at) is int:
        key = at + place.offset
    elif type(at) is Stack:
        key = STACK + at.offset + place.offset
    else:
        return None
    if key % place.size:
        return None
    cell = memory.look(path.layer, key & ~3)
    if isinstance(cell, list):
        part = cell[key & 3]
        if isinstance(part, Half):
            found = part.value if place.size == 2 and part.index == 0 else None
        else:
            found = part if place.size == 1 else None
    elif place.size == 4:
        found = cell
    else:
        mask = 0xFF if place.size == 1 else 0xFFFF
        found = cell >> 8 * (key & 3) & mask if type(cell) is int else None
    return None if isinstance(found, Range) else found


__all__ = ["Counters", "Meeting", "Path", "Starts", "word_at", "words_at"]
