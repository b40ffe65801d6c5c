"""What memory holds where paths meet, and whether that of one path covers that of another."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import TOP, Range
from mauve.wcet.flow.run.cells import Shared, byte_of, half_in, made_of, mates_at, parts_of, together, values_of
from mauve.wcet.flow.run.covering import covers, merge
from mauve.wcet.flow.run.layers import (
    Cell,
    Half,
    Layer,
    Part,
    Value,
    chain,
    common,
    forgotten,
    lowest,
    release,
    written,
)
from mauve.wcet.flow.run.memory import DATA_END, Memory
from mauve.wcet.flow.run.words import WILD, Ranged, Some, Word, range_of

Join = Callable[[Word, Word], Word]
"""One word for two: what was one word on both paths is one word afterwards."""


class Cells:
    """Cells for two. What comes of the same two objects is the same object."""

    def __init__(self, word: Join, shared: Shared) -> None:
        self._word, self._shared = word, shared
        self._made: dict[tuple[int, int], tuple[object, object, Value]] = {}
        self._lists: dict[tuple[int, int], tuple[object, object, Cell]] = {}

    def join(self, key: int, first: Cell, second: Cell) -> Cell:
        """A cell that covers both."""
        if not isinstance(first, list) and not isinstance(second, list):
            return self._one(first, second, (key, 4))
        # Bytes that no register ever held are the same wherever they are.
        known = self._lists.get((id(first), id(second)))
        if known is not None:
            return known[2]
        parts: list[Part] = []
        halves = self._halves(first, second)
        for i, (a, b) in enumerate(zip(parts_of(first), parts_of(second), strict=True)):
            if a is b:
                parts.append(a)
            elif i in halves:
                parts.append(halves[i])
            elif isinstance(a, Half) or isinstance(b, Half):
                parts.append(merge(byte_of(a), byte_of(b)))
            else:
                parts.append(self._one(a, b, (key + i, 1)))
        if any(type(part) is Some or type(part) is Half for part in parts):
            return parts
        cell = self._shared.cell(parts)
        self._lists[id(first), id(second)] = first, second, cell
        return cell

    def _halves(self, first: Cell, second: Cell) -> dict[int, Half]:
        """The halves that are such in both cells, by the positions of their bytes."""
        found: dict[int, Half] = {}
        if type(first) is list and type(second) is list:
            for position in (0, 2):
                one, other = mates_at(first, position), mates_at(second, position)
                if one is not None and other is not None:
                    value = self._one(one, other, None)
                    found[position], found[position + 1] = Half(value, 0), Half(value, 1)
        return found

    def _one(self, a: Value, b: Value, home: tuple[int, int] | None) -> Value:
        """A word for two; one that no register holds if one of them is such."""
        if a is b:
            return a
        if not isinstance(a, Range) and not isinstance(b, Range):
            found = self._word(a, b)
            if isinstance(found, Ranged) and found.home is None:
                found.home = home
            return found
        known = self._made.get((id(a), id(b)))
        if known is None:
            # Both are kept as well: another object could have the identity of one that is gone.
            known = self._made[id(a), id(b)] = a, b, self._joined(a, b)
        return known[2]

    def _joined(self, a: Value, b: Value) -> Value:
        """A word that covers both, one of which is a bare range."""
        one = a if type(a) is Range else range_of(a)
        two = b if type(b) is Range else range_of(b)
        if one is None or two is None:
            return WILD
        return self._shared.range(domain.join(one, two))


def join_layers(memory: Memory, a: Layer, b: Layer, word: Join) -> Layer:
    """A layer for both paths, which end."""
    base, cells = common(a, b), Cells(word, memory.shared)
    made = Layer(base)
    found = made.cells
    for key, first, second in pairs_since(memory, a, b, base):
        found[key] = first if first is second else cells.join(key, first, second)
    for side in (a, b):
        forgets, wild = forgotten(side, base)
        made.forgets, made.wild = made.forgets or forgets, made.wild or wild
    release(a)
    release(b)
    return made


def pairs_since(memory: Memory, a: Layer, b: Layer, base: Layer) -> Iterator[tuple[int, Cell, Cell]]:
    """The cells that were written since two paths parted, as they are on both."""
    mine, other = written(a, base, DATA_END), written(b, base, DATA_END)
    if mine is other:
        return
    for key, first in mine.items():
        second = other.get(key)
        yield key, first, memory.look(b, key) if second is None else second
    for key, second in other.items():
        if key not in mine:
            yield key, memory.look(a, key), second


def pairs_apart(memory: Memory, wide: Layer, layer: Layer) -> list[tuple[int, Cell, Cell]] | None:
    """The cells in which the memory of a path may differ from that of another one, which came from it, as they are on
    both; None where it forgot more than the first had forgotten."""
    base = common(wide, layer)
    forgets, wild = forgotten(layer, base)
    pairs = list(pairs_since(memory, wide, layer, base))
    if not forgets:
        return pairs
    last = lowest(wide)
    if not last.forgets or (wild and not last.wild):
        return None
    # Of all but these, the first knew nothing either.
    met = {key for key, _, _ in pairs}
    known = dict.fromkeys(key for one in chain(wide, last) for key in one.cells if key < DATA_END and key not in met)
    return pairs + [(key, memory.look(wide, key), memory.look(layer, key)) for key in known]


def includes(memory: Memory, wide: Layer, layer: Layer) -> bool:
    """Whether the memory of a path covers that of another one, which came from it."""
    pairs = pairs_apart(memory, wide, layer)
    return pairs is not None and all(covers_cell(first, second) for _, first, second in pairs)


def covers_cell(wide: Cell, cell: Cell) -> bool:
    """Whether a cell covers another one."""
    if wide is cell:
        return True
    if not isinstance(wide, list):
        return covers(_word(wide), together(cell) if isinstance(cell, list) else _word(cell))
    parts = parts_of(cell)
    for position in (0, 2):
        pair = mates_at(wide, position)
        if pair is not None:
            if mates_at(parts, position) is not pair and not _holds(pair, half_in(cell, position), Op.UXTH, Op.SXTH):
                return False
            continue
        for i in (position, position + 1):
            one = wide[i]
            value = byte_of(one) if isinstance(one, Half) else one
            if one is not parts[i] and not _holds(value, values_of(parts[i]), Op.UXTB, Op.SXTB):
                return False
    return True


def _holds(wide: Value, values: int | Range | None, *extensions: Op) -> bool:
    """Whether all that the low bits of a word can be, of which any extension may be read, is in a wide one. Only what
    is in the wide one as a whole counts: that its low bits may be the same says nothing of how it is read."""
    if wide is WILD or values is None:
        return wide is WILD
    one = wide if type(wide) is Range else range_of(wide)
    two = values if isinstance(values, Range) else domain.constant(values)
    return one is not None and any(
        domain.includes(one, narrow) for narrow in (two, *(domain.apply(op, two, TOP) for op in extensions))
    )


def _word(cell: Value) -> Word:
    return made_of(cell) if isinstance(cell, Range) else cell


def widen_layer(memory: Memory, before: Layer, layer: Layer, widened: Join) -> Layer:
    """A layer above the second, which ends, that covers both, such that doing this again and again comes to an end if
    that is so of `widened`."""
    base, made = common(before, layer), Layer(layer)
    release(layer)
    for key, a, b in pairs_since(memory, before, layer, base):
        if a is b:
            continue
        if not isinstance(a, list) and not isinstance(b, list):
            made.cells[key] = widened(_word(a), _word(b))
        else:
            pairs = zip(parts_of(a), parts_of(b), strict=True)
            made.cells[key] = [byte_of(widened(byte_of(x), byte_of(y))) for x, y in pairs]
    return made
