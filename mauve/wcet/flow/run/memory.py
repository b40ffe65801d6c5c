"""The memory of a run: words by address, the stack included, and what each access touched.

A word is a value, or a list of four bytes where they do not make up one value. What was never written comes from the
binary; an address outside of it may be a device: what is read there is unknown, what is written there is gone. While
paths are followed apart, `journal` keeps the words that one of them replaced.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from mauve.wcet.binary.elf import Binary
from mauve.wcet.flow.run.words import MASK, UNKNOWN, Stack, Word, merge

STACK = 1 << 40
"""The key of the word at sp as it is at the entry of the program."""

Cell = Word | list[Word]


class Lost(Exception):
    """The run cannot go on: `args` say why."""


class Memory:
    """See the module's description. `low` and `high` are the first and last byte that each site (an access of one
    instruction) touched outside the stack, `wild` the sites that also touched something else. `unknown` are stretches
    of addresses (from the first up to but without the second) that do not start with what the binary holds."""

    def __init__(self, binary: Binary, unaligned: bool, unknown: Sequence[tuple[int, int]] = ()) -> None:
        self.cells: dict[int, Cell | None] = {}
        self.journal: dict[int, Cell | None] | None = None
        self.low: list[int] = []
        self.high: list[int] = []
        self.wild: set[int] = set()
        self._segments = sorted(binary.segments, key=lambda segment: segment.address)
        self._starts = [segment.address for segment in self._segments]
        self._unaligned = unaligned
        self._unknown = tuple(unknown)

    def site(self) -> int:
        """A number for one more access."""
        self.low.append(1 << 33)
        self.high.append(-1)
        return len(self.low) - 1

    # ------------------------------------------------------------------------------------------------ words
    def load(self, address: Word, site: int) -> Word:
        """A word."""
        if type(address) is int:
            if address < self.low[site]:
                self.low[site] = address
            if address > self.high[site] - 3:
                self.high[site] = address + 3
            key = address
        elif type(address) is Stack:
            key = STACK + address.offset
            self.wild.add(site)
        else:
            self.wild.add(site)
            return UNKNOWN
        if key & 3:
            return self._together(key, 4)
        found = self.cells.get(key)
        if found is None:
            found = self._initial(key)
        return _word(found) if type(found) is list else found  # type: ignore[return-value]

    def store(self, address: Word, value: Word, site: int) -> None:
        """Write a word."""
        key = self._place(address, site, 3)
        if key is None:
            return
        if key & 3:
            self._apart(key, value, 4)
            return
        if key not in self.cells and not self._writable(key):
            return
        if self.journal is not None and key not in self.journal:
            self.journal[key] = self.cells.get(key)
        self.cells[key] = value

    # ------------------------------------------------------------------------------------------------ parts of words
    def load_byte(self, address: Word, site: int) -> Word:
        """A byte, extended with zeros."""
        if type(address) is int:
            if address < self.low[site]:
                self.low[site] = address
            if address > self.high[site]:
                self.high[site] = address
            key = address
        elif type(address) is Stack:
            key = STACK + address.offset
            self.wild.add(site)
        else:
            self.wild.add(site)
            return UNKNOWN
        word = self.cells.get(key & ~3)
        if word is None:
            word = self._initial(key & ~3)
        if type(word) is int:
            return word >> 8 * (key & 3) & 0xFF
        return word[key & 3] if type(word) is list else UNKNOWN

    def load_half(self, address: Word, site: int) -> Word:
        """Two bytes, extended with zeros."""
        key = self._place(address, site, 1)
        if key is None:
            return UNKNOWN
        word = self.cells.get(key & ~3)
        if word is None:
            word = self._initial(key & ~3)
        if type(word) is int and not key & 1:
            return word >> 8 * (key & 2) & 0xFFFF
        return self._together(key, 2)

    def store_byte(self, address: Word, value: Word, site: int) -> None:
        """Write the low byte of a value."""
        key = self._place(address, site, 0)
        if key is not None:
            self._apart(key, value, 1)

    def store_half(self, address: Word, value: Word, site: int) -> None:
        """Write the low two bytes of a value."""
        key = self._place(address, site, 1)
        if key is not None:
            self._apart(key, value, 2)

    # ------------------------------------------------------------------------------------------------ helpers
    def _place(self, address: Word, site: int, last: int) -> int | None:
        """The key of an address; None for a device. Raises Lost for a store that may go anywhere."""
        if type(address) is int:
            self.low[site] = min(self.low[site], address)
            self.high[site] = max(self.high[site], address + last)
            return address
        self.wild.add(site)
        if type(address) is Stack:
            return STACK + address.offset
        raise Lost("an access to an unknown address")

    def _initial(self, key: int) -> Cell:
        """A word that was not written yet."""
        if key >= STACK >> 1:
            return UNKNOWN
        number = bisect_right(self._starts, key + 3) - 1
        if number < 0:
            return UNKNOWN
        segment = self._segments[number]
        if key < segment.address or key + 4 > segment.end:
            parts = [self._initial_byte(key + i) for i in range(4)]
            if all(part is UNKNOWN for part in parts):
                return UNKNOWN
            return parts if any(part is UNKNOWN for part in parts) else _word(parts)
        data = segment.data[key - segment.address : key - segment.address + 4]
        word = int.from_bytes(data.ljust(4, b"\0"), "little")
        if any(start < key + 4 and key < end for start, end in self._unknown):
            known = bytes_of(word)
            return [
                UNKNOWN if any(start <= key + i < end for start, end in self._unknown) else known[i] for i in range(4)
            ]
        return word

    def _initial_byte(self, address: int) -> Word:
        """A byte that was not written yet, of a word that does not lie in one segment."""
        number = bisect_right(self._starts, address) - 1
        if number < 0 or address >= self._segments[number].end:
            return UNKNOWN
        if any(start <= address < end for start, end in self._unknown):
            return UNKNOWN
        segment = self._segments[number]
        place = address - segment.address
        return segment.data[place] if place < len(segment.data) else 0

    def _writable(self, key: int) -> bool:
        """Whether a word is the program's to write; not so a device. Raises Lost for code and constants."""
        if key >= STACK >> 1:
            return True
        number = bisect_right(self._starts, key + 3) - 1
        found = [s for s in self._segments[max(0, number - 3) : number + 1] if s.end > key]
        if not all(segment.writable for segment in found):
            raise Lost("code or a constant is written")
        return bool(found)

    def _byte(self, key: int) -> Word:
        word = self.cells.get(key & ~3)
        if word is None:
            word = self._initial(key & ~3)
        if type(word) is int:
            return word >> 8 * (key & 3) & 0xFF
        return word[key & 3] if type(word) is list else UNKNOWN

    def _together(self, key: int, size: int) -> Word:
        if not self._unaligned:
            return UNKNOWN
        result = 0
        for i in range(size):
            byte = self._byte(key + i)
            if type(byte) is not int:
                return UNKNOWN
            result |= byte << 8 * i
        return result

    def _apart(self, key: int, value: Word, size: int) -> None:
        if (key & 3) + size > 4 and not self._unaligned:
            raise Lost("an access that is not aligned")
        parts: list[Word] = [value >> 8 * i & 0xFF for i in range(size)] if type(value) is int else [UNKNOWN] * size
        position = 0
        while position < size:
            base = (key + position) & ~3
            old = self.cells.get(base)
            if old is None and not self._writable(base):
                return
            if self.journal is not None and base not in self.journal:
                self.journal[base] = old
            if old is None:
                old = self._initial(base)
            fresh = bytes_of(old)
            while position < size and (key + position) & ~3 == base:
                fresh[(key + position) & 3] = parts[position]
                position += 1
            whole = _word(fresh)
            self.cells[base] = whole if type(whole) is int else fresh

    def join(self, journals: list[dict[int, Cell | None]], after: list[dict[int, Cell | None]]) -> None:
        """Make the memory cover all paths: `journals` hold what each of them replaced, `after` what it left there."""
        for key in {key: None for journal in journals for key in journal}:
            before = self.cells.get(key)
            values: list[Cell] = []
            for journal, left in zip(journals, after, strict=True):
                value = left[key] if key in journal else before
                values.append(self._initial(key) if value is None else value)
            if self.journal is not None and key not in self.journal:
                self.journal[key] = before
            self.cells[key] = _merged(values)


def bytes_of(cell: Cell) -> list[Word]:
    """The four bytes of a word."""
    if type(cell) is list:
        return cell.copy()
    if type(cell) is int:
        return [cell >> 8 * i & 0xFF for i in range(4)]
    return [UNKNOWN] * 4


def _word(cells: list[Word]) -> Word:
    result = 0
    for i, byte in enumerate(cells):
        if type(byte) is not int:
            return UNKNOWN
        result |= byte << 8 * i
    return result & MASK


def _merged(values: list[Cell]) -> Cell:
    first = values[0]
    if all(value is first for value in values[1:]):
        return first
    if not any(type(value) is list for value in values):
        merged: Word = values[0]  # type: ignore[assignment]
        for value in values[1:]:
            merged = merge(merged, value)  # type: ignore[arg-type]
        if type(merged) is int or type(merged) is Stack:
            return merged
    bytes_ = [bytes_of(value) for value in values]
    result = bytes_[0]
    for other in bytes_[1:]:
        result = [merge(a, b) for a, b in zip(result, other, strict=True)]
    return result if any(type(byte) is int for byte in result) else UNKNOWN
