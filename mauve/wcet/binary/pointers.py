"""Functions whose address a binary takes: those that a pointer of which nothing else is known may lead to.

A function's address is a word of linked data or of a literal pool, or the two halves that `movw` and `movt` put
together. Addresses that are computed in other ways (from the program counter, in position-independent code) are not
found.
"""

from __future__ import annotations

import sys
from array import array
from collections.abc import Iterator, Set

from mauve.wcet.binary.elf import Binary, Content, Segment

_NEAR = 16
"""Halfwords in which `movt` follows its `movw`; words in A32."""


def taken(binary: Binary) -> tuple[int, ...]:
    """The keys of the functions whose address is taken, in order of address. The entry of the binary is left out: what
    calls it starts the program anew."""
    functions = {symbol.key for symbol in binary.functions if binary.read_code(symbol.address, 2) is not None}
    functions -= {binary.entry, binary.entry & ~1}
    found: set[int] = set()
    for segment in binary.segments:
        found |= {key for key in functions.intersection(_words(segment)) if _is_data(binary, segment, key)}
        if segment.executable:
            found |= functions.intersection(_put_together(segment, functions))
    return tuple(sorted(found))


def _words(segment: Segment) -> array[int]:
    """The aligned words of a segment."""
    start = -segment.address % 4
    words = array("I", segment.data[start : start + (len(segment.data) - start) // 4 * 4])
    if sys.byteorder == "big":
        words.byteswap()
    return words


def _is_data(binary: Binary, segment: Segment, key: int) -> bool:
    """Whether one of the words with that value is no instruction, as far as mapping symbols tell."""
    raw, at = key.to_bytes(4, "little"), -1
    while (at := segment.data.find(raw, at + 1)) >= 0:
        place = segment.address + at
        if place % 4 == 0 and binary.content_at(place) in (Content.DATA, None):
            return True
    return False


def _put_together(segment: Segment, functions: Set[int]) -> Iterator[int]:
    """The words that `movw` and a `movt` of the same register shortly behind it make, in A32 and T32 (ARM DDI 0406C,
    A8.8.102 and A8.8.106); bytes that are no such instructions may add some."""
    low = {key & 0xFFFF for key in functions}
    start = segment.address % 2
    halves = array("H", segment.data[start : start + (len(segment.data) - start) // 2 * 2])
    if sys.byteorder == "big":
        halves.byteswap()
    for at in range(len(halves) - 1):
        first = halves[at]
        if first & 0xFBF0 == 0xF240:
            register, value = _wide(first, halves[at + 1])
            if value in low:
                for other in range(at + 2, min(at + 2 + _NEAR, len(halves) - 1)):
                    if halves[other] & 0xFBF0 == 0xF2C0 and _wide(halves[other], halves[other + 1])[0] == register:
                        yield value | _wide(halves[other], halves[other + 1])[1] << 16
    for at, word in enumerate(words := _words(segment)):
        if word & 0x0FF00000 == 0x03000000 and _a32(word)[1] in low:
            register, value = _a32(word)
            for other in words[at + 1 : at + 1 + _NEAR]:
                if other & 0x0FF00000 == 0x03400000 and _a32(other)[0] == register:
                    yield value | _a32(other)[1] << 16


def _wide(first: int, second: int) -> tuple[int, int]:
    """Register and number of `movw` or `movt` in T32 (encoding T3 or T1)."""
    number = (first & 0xF) << 12 | (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF
    return second >> 8 & 0xF, number


def _a32(word: int) -> tuple[int, int]:
    """Register and number of `movw` or `movt` in A32."""
    return word >> 12 & 0xF, (word >> 16 & 0xF) << 12 | word & 0xFFF
