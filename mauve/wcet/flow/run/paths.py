"""Paths that are followed apart, and what holds where they meet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from mauve.wcet.flow.run.compile import ASKED, ASSUMED, DEPTH, TARGET
from mauve.wcet.flow.run.layers import Cell, Half, Layer, Part, common, release
from mauve.wcet.flow.run.memory import Memory, parts_of
from mauve.wcet.flow.run.words import Some, Word, covers, merge, widened

_NO_VALUES = frozenset({TARGET, DEPTH, ASKED, ASSUMED})
"""Slots of registers whose content no instruction reads."""


@dataclass(slots=True)
class Counters:
    """What an execution of a function has done so far, at most: how often each edge was passed, the executions of each
    loop's header since it was entered and the most of them, what was called on each edge."""

    counts: list[int]
    current: list[int]
    most: list[int]
    calls: dict[int, frozenset[int]]

    def copy(self) -> Counters:
        """The same, to go on with apart."""
        return Counters(self.counts.copy(), self.current.copy(), self.most.copy(), self.calls.copy())

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


class Meeting:
    """Words that cover those of two paths. What was one word on both stays one word."""

    def __init__(self, memory: Memory) -> None:
        self._memory = memory
        self._made: dict[tuple[int, int], Word] = {}

    def join(self, path: Path, other: Path) -> Path:
        """One path for both."""
        word = self.word
        registers = [a if a is b else word(a, b) for a, b in zip(path.registers, other.registers, strict=True)]
        registers[DEPTH] = min(path.registers[DEPTH], other.registers[DEPTH])
        registers[ASKED] = None
        layer = self._layers(path.layer, other.layer)
        path.counters.join(other.counters)
        return Path(path.block, registers, layer, path.counters)

    def word(self, a: Any, b: Any) -> Any:
        """A word for two."""
        kind, other = type(a), type(b)
        if a is b or (kind is int and other is int and a == b):
            return a
        if not ((kind is int or kind is Some) and (other is int or other is Some)):
            return None if a is None or b is None else merge(a, b)
        known = self._made.get((id(a), id(b)))
        if known is None:
            known = self._made[id(a), id(b)] = merge(a, b)
        return known

    def _layers(self, a: Layer, b: Layer) -> Layer:
        memory = self._memory
        base = common(a, b)
        made = Layer(base)
        for side in (a, b):
            one: Layer | None = side
            while one is not None and one is not base:
                made.forgets, made.wild = made.forgets or one.forgets, made.wild or one.wild
                one = one.below
        for key in dict.fromkeys([*memory.keys_since(a, base), *memory.keys_since(b, base)]):
            first, second = memory.look(a, key), memory.look(b, key)
            made.cells[key] = first if first is second else self._cell(key, first, second)
        release(a)
        release(b)
        return made

    def _cell(self, key: int, first: Cell, second: Cell) -> Cell:
        if type(first) is not list and type(second) is not list:
            return self._at_home(key, 4, self.word(first, second))
        parts: list[Part] = []
        for i, (a, b) in enumerate(zip(parts_of(first), parts_of(second), strict=True)):
            if a is b:
                parts.append(a)
            elif type(a) is Half or type(b) is Half:
                if type(a) is Half and type(b) is Half and a.index == b.index:
                    parts.append(Half(self.word(a.value, b.value), a.index))
                else:
                    parts.append(merge(_byte_of(a), _byte_of(b)))
            else:
                parts.append(self._at_home(key + i, 1, self.word(a, b)))
        return parts

    @staticmethod
    def _at_home(key: int, size: int, word: Any) -> Word:
        if type(word) is Some and word.home is None:
            word.home = (key, size)
        return word  # type: ignore[no-any-return]


def _byte_of(part: Part) -> Word:
    if type(part) is not Half:
        return part & 0xFF  # type: ignore[operator]
    return part.value >> 8 * part.index & 0xFF


def includes(memory: Memory, wide: Path, path: Path) -> bool:
    """Whether everything that may be so on `path` may be so on `wide`, from which it came."""
    for number, (a, b) in enumerate(zip(wide.registers, path.registers, strict=True)):
        if a is not b and number not in _NO_VALUES and not covers(a, b):
            return False
    base = common(wide.layer, path.layer)
    one: Layer | None = path.layer
    while one is not base and one is not None:
        if one.forgets:
            return False
        one = one.below
    for key in set(memory.keys_since(path.layer, base)) | set(memory.keys_since(wide.layer, base)):
        if not _cell_covers(memory.look(wide.layer, key), memory.look(path.layer, key)):
            return False
    return True


def _cell_covers(wide: Cell, cell: Cell) -> bool:
    if type(wide) is not list and type(cell) is not list:
        return covers(wide, cell)  # type: ignore[arg-type]
    return all(covers(_byte_of(a), _byte_of(b)) for a, b in zip(parts_of(wide), parts_of(cell), strict=True))


def widen(memory: Memory, before: Path, path: Path) -> Path:
    """A path that covers both, such that doing this again and again comes to an end."""
    registers = list(path.registers)
    for number, (a, b) in enumerate(zip(before.registers, path.registers, strict=True)):
        if number not in _NO_VALUES and a is not b:
            registers[number] = a if type(a) is int and type(b) is int and a == b else widened(a, b)
    base = common(before.layer, path.layer)
    layer = Layer(path.layer)
    release(path.layer)
    for key in dict.fromkeys([*memory.keys_since(path.layer, base), *memory.keys_since(before.layer, base)]):
        a, b = memory.look(before.layer, key), memory.look(path.layer, key)
        if a is b:
            continue
        if type(a) is not list and type(b) is not list:
            layer.cells[key] = widened(a, b)  # type: ignore[arg-type]
        else:
            pairs = zip(parts_of(a), parts_of(b), strict=True)
            layer.cells[key] = [widened(_byte_of(x), _byte_of(y)) & 0xFF for x, y in pairs]
    return Path(path.block, registers, layer, path.counters)


__all__ = ["Counters", "Meeting", "Path", "includes", "widen"]
