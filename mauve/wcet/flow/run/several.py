"""Accesses to one of several places: what may be read at any of them, and what they may hold after a store to one.

Cells of which the same is known are the same object where nothing else tells them apart (see layers), so that what
comes of one holds for all of them, and a store that tells nothing new changes nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import TOP, Range
from mauve.wcet.flow.run.cells import Shared, half_in, mates_at, parts_of, simple, values_of, word_in
from mauve.wcet.flow.run.covering import merge
from mauve.wcet.flow.run.layers import Cell, Half, Part, Value
from mauve.wcet.flow.run.words import WILD, Some, Word, made

Group = tuple[Sequence[int], tuple[int, ...]]
"""Words by their keys, and the positions in each of them that an access may go to."""


def groups(keys: Sequence[int], size: int) -> list[Group] | None:
    """The places of an access of `size` bytes by words; None where it would lie in two of them."""
    if type(keys) is range and keys.step % 4 == 0:
        position = keys[0] & 3
        return None if position % size else [(range(keys[0] - position, keys[-1] + 1, keys.step), (position,))]
    if type(keys) is range and size <= keys.step <= 2 and not keys[0] % size:
        return _stretch(keys)
    found: dict[int, list[int]] = {}
    for key in keys:
        found.setdefault(key & 3, []).append(key & ~3)
    if any(position % size for position in found):
        return None
    return [(bases, (position,)) for position, bases in found.items()]


def _stretch(keys: range) -> list[Group]:
    """Keys that follow each other in every word: those of whole words, and of the first and the last word."""
    step, first, last = keys.step, keys[0], keys[-1]
    low, high = first & ~3, last & ~3
    if low == high:
        return [([low], tuple(key & 3 for key in keys))]
    offset = first & (step - 1)
    before, after = tuple(range(first & 3, 4, step)), tuple(range(offset, (last & 3) + 1, step))
    inside = range(low + 4, high, 4)
    found: list[Group] = [([low], before), ([high], after)]
    if inside:
        found.append((inside, tuple(range(offset, 4, step))))
    return found


# ------------------------------------------------------------------------------------------------------------ loads
def read(cells: Sequence[tuple[Cell, tuple[int, ...]]], size: int, extend: Op) -> Range | None:
    """What may be read at the positions of cells, extended; None for what may be an address in the stack."""
    numbers: set[int] = set()
    ranges: dict[int, Range] = {}
    seen: set[tuple[int, tuple[int, ...]]] = set()
    for cell, positions in cells:
        if type(cell) is int:
            if size == 4:
                numbers.add(cell)
            elif size == 1:
                numbers.update([cell >> 8 * position & 0xFF for position in positions])
            else:
                numbers.update([cell >> 8 * position & 0xFFFF for position in positions])
            continue
        if (id(cell), positions) in seen:
            continue
        seen.add((id(cell), positions))
        for found in _bytes_at(cell, positions) if size == 1 else _words_at(cell, positions, size):
            if type(found) is Range:
                ranges[id(found)] = found
            elif type(found) is int:
                numbers.add(found)
            else:
                return None
    result: Range | None = None
    if numbers:
        signs = extend is Op.SXTB or extend is Op.SXTH
        result = domain.of({domain.concrete(extend, number, 0) for number in numbers} if signs else numbers)
    for whole in dict.fromkeys(ranges.values()):
        values = whole if extend is Op.MOV else domain.apply(extend, whole, TOP)
        result = values if result is None else domain.join(result, values)
    return result


def covering(words: Iterable[Word], every: Range | None = None) -> Word:
    """A word that covers all of several; `every` are the values that any of them can have, if none is made from an
    address in the stack."""
    numbers: set[int] = set()
    ranges: dict[Range, None] = {}
    others: list[Word] = []
    for word in words:
        if type(word) is int:
            numbers.add(word)
        elif type(word) is Some:
            ranges[word.range] = None
            if word.range == every:
                return made(every)
        else:
            others.append(word)
    if numbers:
        ranges[domain.of(numbers)] = None
    return reduce(merge, [*others, *map(made, ranges)])


def _words_at(cell: Cell, positions: tuple[int, ...], size: int) -> Iterable[int | Range | None]:
    """The values of words, or of words whose low halves are those of a cell."""
    return [word_in(cell) if size == 4 else half_in(cell, position) for position in positions]


def _bytes_at(cell: Cell, positions: tuple[int, ...]) -> Iterable[int | Range | None]:
    """The values of words whose low bytes are those of a cell."""
    parts = parts_of(cell)
    for position in positions:
        part = parts[position]
        if type(part) is Range:
            yield part
        elif type(part) is Some:
            # A byte with a sign is kept as it was read.
            yield simple(part.range)
        else:
            yield values_of(part)


# ------------------------------------------------------------------------------------------------------------ stores
class Weak:
    """A store of `value` to one of several places: what the cells are afterwards."""

    def __init__(self, value: int | Range, size: int, shared: Shared) -> None:
        if size < 4 and type(value) is Range:
            value = simple(domain.apply(Op.UXTB if size == 1 else Op.UXTH, value, TOP))
        elif size < 4:
            value &= 0xFF if size == 1 else 0xFFFF  # type: ignore[operator]
        self._size, self._shared = size, shared
        self._value = value if isinstance(value, Range) else domain.constant(value)
        self._cells: dict[tuple[int, tuple[int, ...]], tuple[Cell, Cell]] = {}
        self._numbers: dict[tuple[int, tuple[int, ...]], Cell] = {}
        self._joined: dict[int, tuple[object, int | Range]] = {}

    def after(self, cell: Cell, positions: tuple[int, ...]) -> Cell:
        """What a cell is afterwards: the same object where it could be all of that before."""
        if type(cell) is int:
            number = self._numbers.get((cell, positions))
            if number is None:
                number = self._numbers[cell, positions] = self._changed(cell, positions)
            return number
        known = self._cells.get((id(cell), positions))
        if known is None:
            # The cell is kept as well, as another object could have its identity when it is gone.
            known = self._cells[id(cell), positions] = cell, self._changed(cell, positions)
        return known[1]

    def _changed(self, cell: Cell, positions: tuple[int, ...]) -> Cell:
        if type(cell) is Range and cell.is_top:
            return cell
        if self._size == 4:
            return self._with(word_in(cell))
        parts: list[Part] = list(parts_of(cell))
        same = type(cell) is list
        for position in positions:
            if self._size == 1:
                part = parts[position]
                parts[position] = new = self._with(values_of(part))
                same = same and new is part
            else:
                same = self._half(cell, parts, position) and same
        return cell if same else self._shared.cell(parts)

    def _half(self, cell: Cell, parts: list[Part], position: int) -> bool:
        """Change the two bytes of a half in `parts`: whether they are the same as before."""
        before = half_in(cell, position)
        if type(before) is Range:
            before = simple(domain.apply(Op.UXTH, before, TOP))
        mates = mates_at(parts, position)
        new = self._with(before)
        if new is mates:
            return True
        if type(new) is int:
            parts[position : position + 2] = [new & 0xFF, new >> 8 & 0xFF]
        else:
            parts[position : position + 2] = [Half(new, 0), Half(new, 1)]
        return False

    def _with(self, values: int | Range | None) -> Value:
        """What covers the values of a part, and the value stored."""
        if values is None:
            return WILD
        known = self._joined.get(id(values))
        if known is None:
            one = values if isinstance(values, Range) else domain.constant(values)
            known = self._joined[id(values)] = values, self._shared.range(simple(domain.join(one, self._value)))
        return known[1]
