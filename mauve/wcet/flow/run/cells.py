"""The words that memory holds, as one value or as four bytes: their parts, and what covers two of them."""

from __future__ import annotations

from collections.abc import Sequence

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import BYTE, TOP, Range
from mauve.wcet.flow.run.layers import Cell, Half, Part, Value
from mauve.wcet.flow.run.words import MASK, WILD, Some, Word, fresh, is_wild, made, range_of

ANY: Sequence[Part] = (BYTE, BYTE, BYTE, BYTE)
"""The bytes of a word of which nothing is known."""

MOST_SHARED = 5_000
"""Ranges that are kept to be shared."""


def simple(values: Range) -> int | Range:
    """The number itself where there is only one."""
    return values.low if values.n == 0 and values.values is None else values


class Shared:
    """Makes equal ranges and equal lists of bytes one object, so that what comes of one of them comes of all."""

    def __init__(self) -> None:
        self._ranges: dict[Range, Range] = {}
        self._lists: dict[tuple[int, ...], list[Part]] = {}

    def range(self, values: int | Range) -> int | Range:
        """The range to use in the place of an equal one."""
        if type(values) is not Range:
            return values
        if len(self._ranges) > MOST_SHARED:
            self._ranges, self._lists = {}, {}
        return self._ranges.setdefault(values, values)

    def cell(self, parts: list[Part]) -> Cell:
        """The cell that four bytes make; they are not to be changed any more."""
        cell = joined(parts)
        if type(cell) is list and all(type(part) is Range or type(part) is int for part in parts):
            return self._lists.setdefault(tuple(map(id, parts)), parts)
        return cell


# ------------------------------------------------------------------------------------------------------------ bytes
def parts_of(cell: Cell) -> Sequence[Part]:
    """The four bytes of a word."""
    if isinstance(cell, list):
        return cell
    if isinstance(cell, int):
        return (cell & 0xFF, cell >> 8 & 0xFF, cell >> 16 & 0xFF, cell >> 24 & 0xFF)
    if isinstance(cell, Range):
        return ANY if cell.is_top else [byte_in(cell, i) for i in range(4)]
    if is_wild(cell):
        return (WILD, WILD, WILD, WILD)
    if isinstance(cell, Some) and not cell.range.is_top:
        return [byte(cell >> 8 * i) for i in range(4)]
    return ANY


def byte(value: Word) -> Word:
    """The low byte of a word, extended with zeros."""
    return WILD if is_wild(value) else value & 0xFF


def half(value: Word) -> Word:
    """The low half of a word, extended with zeros."""
    return WILD if is_wild(value) else value & 0xFFFF


def byte_in(values: Range, index: int) -> int | Range:
    """What byte `index` of a word out of a range can be."""
    return simple(domain.apply(Op.UXTB, domain.apply(Op.LSR, values, domain.constant(8 * index)), TOP))


def byte_of(part: Part) -> Word:
    """What is read of a byte, extended with zeros."""
    index, value = (part.index, part.value) if isinstance(part, Half) else (0, part)
    if isinstance(value, Range):
        return made_of(byte_in(value, index))
    return byte(value >> 8 * index if index else value)


def values_of(part: Part) -> int | Range | None:
    """The values of a byte, extended with zeros; None for one of an address in the stack."""
    index, value = (part.index, part.value) if isinstance(part, Half) else (0, part)
    if isinstance(value, int):
        return value >> 8 * index & 0xFF
    if isinstance(value, Range):
        values = value
    elif isinstance(value, Some):
        values = value.range
    else:
        return None if is_wild(value) else BYTE
    if not index and values.low + values.n * values.step <= 0xFF:
        return simple(values)
    return byte_in(values, index)


def word_in(cell: Cell) -> int | Range | None:
    """The values of a word; None for one that may be an address in the stack."""
    if isinstance(cell, list):
        cell = together(cell)
    if isinstance(cell, int | Range):
        return cell
    found = range_of(cell)
    return None if found is None else simple(found)


def half_in(cell: Cell, position: int) -> int | Range | None:
    """The values of a word whose low 16 bits are the half of a cell at byte 0 or 2; None for addresses in the stack."""
    if isinstance(cell, int):
        return cell >> 8 * position & 0xFFFF
    if isinstance(cell, list):
        value = mates_at(cell, position)
        return word_in(together([*cell[position : position + 2], 0, 0]) if value is None else value)
    values = cell if isinstance(cell, Range) else range_of(cell)
    if values is None or not position:
        return None if values is None else simple(values)
    return simple(domain.apply(Op.LSR, values, domain.constant(16)))


def made_of(values: int | Range) -> Word:
    """A word for what is known of it."""
    return made(values) if isinstance(values, Range) else values


# ------------------------------------------------------------------------------------------------------------ words
def together(parts: Sequence[Part]) -> Word:
    """The word that four bytes make."""
    result = 0
    known = True
    for i, part in enumerate(parts):
        if type(part) is int:
            result |= (part & 0xFF) << 8 * i
        elif is_wild(part.value if type(part) is Half else part):
            return WILD
        else:
            known = False
    if known:
        return result & 0xFFFF_FFFF
    low_half = mates_at(parts, 0)
    if low_half is not None and type(parts[2]) is type(parts[3]) is int and parts[2] == parts[3] == 0:
        return half(made_of(low_half) if isinstance(low_half, Range) else low_half)
    low = high = 0
    for i, part in enumerate(parts):
        values = values_of(part)
        least, most = values.unsigned_bounds() if isinstance(values, Range) else (values or 0, values or 0)
        low, high = low | least << 8 * i, high | most << 8 * i
    return fresh(domain.between(low, high))


def mates_at(parts: Sequence[Part], position: int) -> Value | None:
    """The word whose two bytes are at a position and behind it; None where there is none."""
    first, second = parts[position], parts[position + 1]
    if type(first) is Half and type(second) is Half and first.value is second.value:
        return first.value if first.index == 0 and second.index == 1 else None
    return None


def joined(parts: list[Part]) -> Cell:
    """A word if all four bytes are known, else the bytes."""
    a, b, c, d = parts
    if type(a) is int and type(b) is int and type(c) is int and type(d) is int:
        return (a & 0xFF | (b & 0xFF) << 8 | (c & 0xFF) << 16 | (d & 0xFF) << 24) & MASK
    return parts
