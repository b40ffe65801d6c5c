"""Wait states: how much longer than a cycle an access to the board's memories takes.

Waits count per access, whatever its size: a memory narrower than the access states the wait of the whole access.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from mauve.wcet.hardware.board import Board, Memory


class Bytes(Protocol):
    """A range of addresses, both ends included."""

    @property
    def low(self) -> int:
        """The first byte."""

    @property
    def high(self) -> int:
        """The last byte."""


@dataclass(frozen=True, slots=True)
class MemoryMap:
    """The waits of a board's memories. Without memories every access has zero waits, as a board without them says."""

    memories: tuple[Memory, ...]
    slowest_read: int
    slowest_write: int

    def holds(self, low: int, high: int) -> bool:
        """Whether the bytes from low to high lie in memories of the board (in one or in adjacent ones)."""
        return not self.memories or all(
            any(memory.start <= end < memory.end for memory in self.memories) for end in (low, high)
        )

    def holds_together(self, low: int, high: int) -> bool:
        """Whether the bytes from low to high lie in one memory of the board."""
        return not self.memories or any(memory.start <= low and high < memory.end for memory in self.memories)

    def reaches(self, place: Bytes | None) -> bool:
        """Whether an access can touch some memory; an unknown address can."""
        return not self.memories or place is None or any(_touches(memory, place) for memory in self.memories)

    def code_wait(self, low: int, high: int) -> int:
        """The worst wait of an instruction fetch from low to high (bytes outside the memories have none)."""
        return max((memory.wait for memory in self.memories if memory.start <= high and low < memory.end), default=0)

    def data_wait(self, place: Bytes | None, store: bool) -> int:
        """The worst wait of a data access: of the slowest memory that it may touch, of all when its address is
        unknown."""
        if place is None or not self.reaches(place):
            return self.slowest_write if store else self.slowest_read
        return max((_wait(memory, store) for memory in self.memories if _touches(memory, place)), default=0)


def memory_map(board: Board) -> MemoryMap:
    """The memory map of a board."""
    return MemoryMap(
        board.memories,
        max((memory.wait for memory in board.memories), default=0),
        max((_wait(memory, store=True) for memory in board.memories), default=0),
    )


def _wait(memory: Memory, store: bool) -> int:
    return memory.write_wait if store and memory.write_wait is not None else memory.wait


def _touches(memory: Memory, place: Bytes) -> bool:
    return memory.start <= place.high and place.low < memory.end
