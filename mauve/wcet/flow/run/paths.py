"""Paths that are followed apart, and what holds where they meet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from mauve.wcet.flow.run.compile import ASKED, ASSUMED, DEPTH, TARGET
from mauve.wcet.flow.run.joining import includes as memory_includes
from mauve.wcet.flow.run.joining import join_layers, widen_layer
from mauve.wcet.flow.run.layers import Layer
from mauve.wcet.flow.run.memory import Memory
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
        self._made: dict[tuple[int, int], tuple[Any, Any, Word]] = {}

    def join(self, path: Path, other: Path) -> Path:
        """One path for both."""
        word = self.word
        registers = [a if a is b else word(a, b) for a, b in zip(path.registers, other.registers, strict=True)]
        registers[DEPTH] = min(path.registers[DEPTH], other.registers[DEPTH])
        registers[ASKED] = None
        layer = join_layers(self._memory, path.layer, other.layer, word)
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
            # Both are kept as well: another object could have the identity of one that is gone.
            known = self._made[id(a), id(b)] = a, b, merge(a, b)
        return known[2]


def includes(memory: Memory, wide: Path, path: Path) -> bool:
    """Whether everything that may be so on `path` may be so on `wide`, from which it came."""
    for number, (a, b) in enumerate(zip(wide.registers, path.registers, strict=True)):
        if a is not b and number not in _NO_VALUES and not covers(a, b):
            return False
    return memory_includes(memory, wide.layer, path.layer)


def widen(memory: Memory, before: Path, path: Path) -> Path:
    """A path that covers both, such that doing this again and again comes to an end."""
    registers = list(path.registers)
    for number, (a, b) in enumerate(zip(before.registers, path.registers, strict=True)):
        if number not in _NO_VALUES and a is not b:
            registers[number] = a if type(a) is int and type(b) is int and a == b else widened(a, b)
    layer = widen_layer(memory, before.layer, path.layer)
    return Path(path.block, registers, layer, path.counters)


__all__ = ["Counters", "Meeting", "Path", "includes", "widen"]
