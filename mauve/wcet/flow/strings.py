"""Where strings end, as a state knows it: a byte that is 0 behind where they begin, or what was assumed of an argument.

An assumption is a cell of its region of memory at ENDS + offset: its number is that of the bytes from the offset on in
which each string that begins there ends. It does not overlap any cell with bytes; like them it is forgotten when
another region is written, and when anything but a constant 0 is written into its own (`State.store`, `effects.call`).
"""

from __future__ import annotations

from collections.abc import Sequence

from mauve.wcet.flow.domain import MASK, Range, between
from mauve.wcet.flow.image import Image
from mauve.wcet.flow.linear import Value
from mauve.wcet.flow.state import ABSOLUTE, ENDS, State, is_end, is_memory

MOST = 4096
"""How many bytes of read-only data are looked at for a 0."""


def ending(state: State, slot: int, length: int) -> None:
    """Assume of an argument (a slot from 1 in a register) that strings in `length` bytes from there on end in them. One
    that points to one of several places is taken for an unknown address, as what is assumed goes with it."""
    register = slot - 1
    region, low, high = state.place(state.regs[register])
    if region is None or low != high:
        mask = state.mask(state.regs[register])
        state.regs[register] = state.fresh()
        state.tainted(state.regs[register], mask)
        region, low, high = state.place(state.regs[register])
    assert region is not None
    known = state.memory.get(region, {}).get(ENDS + low)
    if known is None or type(known[1]) is not int or known[1] > length:
        state.cells(region)[ENDS + low] = (1, length)


def longest(state: State, value: Value, image: Image) -> int | None:
    """The greatest length of the string at an address, the 0 at its end included; None where it is not known."""
    return longest_at(state, state.place(value), image)


Place = tuple[int | None, int, int]


def longest_at(state: State, place: Place, image: Image, written: Sequence[Place] = ()) -> int | None:
    """The same for a string that begins in a place. A 0 that `written` may have changed does not count."""
    region, low, high = place
    if region is None:
        return None
    ends = []
    lost = [(first, last) for where, first, last in written if where == region]
    for offset, (size, known) in state.memory.get(region, {}).items():
        if is_end(offset):
            within = state.range_of(known).unsigned_bounds()[1]
            if offset - ENDS <= low and high < offset - ENDS + within:
                ends.append(offset - ENDS + within - low)
        elif type(known) is int:
            ends += [offset + i + 1 - low for i in range(size) if offset + i >= high and known >> 8 * i & 0xFF == 0
                     and is_memory(region, offset, image)
                     and not any(first <= offset + i <= last for first, last in lost)]  # fmt: skip
    if region == ABSOLUTE and (constant := _constant(high, image)) is not None:
        ends.append(constant - low)
    return min(ends, default=None)


def measured(state: State, image: Image) -> Range | None:
    """The result of `strlen` called in a state, where the end of its argument is known."""
    length = longest(state, state.regs[0], image)
    return None if length is None or not 0 < length <= MASK else between(0, length - 1)


def _constant(start: int, image: Image) -> int | None:
    """The address behind the first byte that is 0 in what never changes, or of which facts say so."""
    for address in range(start, min(start + MOST, MASK)):
        byte = image.constant(address, 1)
        if byte is None:
            known = image.assumed(Range(address, 0, 0), 1, False)
            byte = known.low if known is not None and known.n == 0 else None
            if byte is None and image.constant(address, 0) is None:
                return None
        if byte == 0:
            return address + 1
    return None
