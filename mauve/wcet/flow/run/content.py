"""What memory holds before a run writes to it: the binary's segments, and what is given in their place."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from mauve.wcet.binary.elf import Segment
from mauve.wcet.flow.domain import BYTE, TOP, Range
from mauve.wcet.flow.run.cells import joined, simple
from mauve.wcet.flow.run.layers import Cell, Half, Part
from mauve.wcet.flow.run.words import UNKNOWN


@dataclass(frozen=True, slots=True)
class Given:
    """Memory from `start` up to but without `end` that does not start with what the binary holds: numbers of `width`
    bytes out of a range, or any bytes where `width` is 0."""

    start: int
    end: int
    width: int = 0
    values: Range = BYTE


class Content:
    """The words of a binary by address; `constants` are those that cannot be written, as far as they were read."""

    def __init__(self, segments: Sequence[Segment], given: Sequence[Given]) -> None:
        self.constants: dict[int, Cell] = {}
        self.segments = sorted(segments, key=lambda segment: segment.address)
        self._starts = [segment.address for segment in self.segments]
        self._given = tuple(sorted(given, key=lambda one: one.start))

    def word(self, key: int) -> Cell | None:
        """The word at an address; None where no byte of it is in a segment. A byte that is in none is UNKNOWN: it is a
        device's, and may be another one each time."""
        number = bisect_right(self._starts, key + 3) - 1
        if number < 0:
            return None
        segment = self.segments[number]
        if segment.address <= key and key + 4 <= segment.end:
            data = segment.data[key - segment.address : key - segment.address + 4]
            word = int.from_bytes(data.ljust(4, b"\0"), "little")
            if not any(one.start < key + 4 and key < one.end for one in self._given):
                if not segment.writable:
                    self.constants[key] = word
                return word
            return self._as_given(key, [word >> 8 * i & 0xFF for i in range(4)])
        parts = [self._byte(key + i) for i in range(4)]
        return None if all(part is UNKNOWN for part in parts) else self._as_given(key, parts)

    def around(self, key: int) -> list[Segment]:
        """The segments that hold bytes of a word."""
        number = bisect_right(self._starts, key + 3) - 1
        return [s for s in self.segments[max(0, number - 3) : number + 1] if s.end > key]

    def _byte(self, address: int) -> Part:
        """A byte of a word that does not lie in one segment."""
        number = bisect_right(self._starts, address) - 1
        if number < 0 or address >= self.segments[number].end:
            return UNKNOWN
        segment = self.segments[number]
        place = address - segment.address
        return segment.data[place] if place < len(segment.data) else 0

    def _as_given(self, key: int, parts: list[Part]) -> Cell:
        """A word that does not start, or not all of it, with what the binary holds."""
        for one in self._given:
            if not (one.start < key + 4 and key < one.end):
                continue
            if one.start <= key and key + 4 <= one.end and (key - one.start) % 4 == 0 and one.width in (0, 4):
                return simple(one.values) if one.width == 4 else TOP
            for i in range(4):
                at = key + i - one.start
                if not 0 <= at < one.end - one.start:
                    continue
                if one.values.n == 0:
                    parts[i] = one.values.low >> 8 * (at % max(one.width, 1)) & 0xFF
                elif one.width == 2 and one.start % 2 == 0:
                    before = parts[i - 1] if i else None
                    known = type(before) is Half and at % 2 == 1
                    parts[i] = Half(before.value, 1) if known and type(before) is Half else Half(simple(one.values), 0)
                else:
                    parts[i] = simple(one.values) if one.width == 1 else BYTE
        return joined(parts)


__all__ = ["Content", "Given"]
