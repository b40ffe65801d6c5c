"""The memory of a run: words by address, the stack included, and what each access touched.

What was never written comes from the binary; an address outside of it may be a device: what is read there is unknown,
what is written there is gone. A store through an unknown pointer leaves nothing known of all that is writable but the
stack.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.microop import Op
from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import BYTE, HALF, SIGNED_BYTE, SIGNED_HALF, TOP, Range
from mauve.wcet.flow.run import several
from mauve.wcet.flow.run.cells import ANY, Shared, byte, byte_of, half, joined, mates_at, parts_of, simple, together
from mauve.wcet.flow.run.content import Content, Given
from mauve.wcet.flow.run.covering import merge
from mauve.wcet.flow.run.layers import Cell, Half, Layer, Part, lowest, put_where, settled
from mauve.wcet.flow.run.operations import extend_byte, extend_half
from mauve.wcet.flow.run.words import (
    MASK,
    UNKNOWN,
    WILD,
    Ranged,
    Some,
    Source,
    Stack,
    Stacks,
    Word,
    fresh,
    is_wild,
    made,
    range_of,
)

Reader = Callable[[int], Word]
"""What is read at a key."""

Reading = Callable[[Word], Word]

STACK = 1 << 40
"""The key of the word at sp as it is at the entry of the program."""

DATA_END = STACK >> 1
"""Keys from here on are the stack's."""

MOST_PLACES = 4096
"""Places that one access may touch; one that may touch more goes anywhere."""


class Lost(Exception):
    """The run cannot go on: `args` say why."""


class Memory:
    """See the module's description. `low` and `high` are the first and last byte that each site (an access of one
    instruction) touched outside the stack, `wild` the sites that also touched something else. `given` says where
    memory does not start with what the binary holds."""

    def __init__(self, binary: Binary, unaligned: bool, given: Sequence[Given] = ()) -> None:
        self.layer = Layer(None)
        self.cells = self.layer.cells
        self.low: list[int] = []
        self.high: list[int] = []
        self.wild: set[int] = set()
        self.stores = 0
        self.vague = 0
        """how often several places may have been written, or something read that the program may not have written"""
        self.leaked = False
        """whether an address in the stack was ever written outside of it"""
        self.shared = Shared()
        self.top_read = -(1 << 62)
        """the greatest offset from the first sp that was read since this was set back"""
        self.ends = tuple(end for one in binary.objects for end in (one.address, one.address + one.size) if one.size)
        """where the objects of the program begin and end"""
        self._segments = tuple(binary.segments)
        self._unaligned = unaligned
        self._ours: set[int] = set()
        """words that were found to be the program's to write"""
        self._content = Content(binary.segments, given)
        self._constants = self._content.constants

    def restart(self, given: Sequence[Given]) -> None:
        """Memory as a program starts with it."""
        self.layer = Layer(None)
        self.cells = self.layer.cells
        self._content = Content(self._segments, given)
        self._constants = self._content.constants

    def site(self) -> int:
        """A number for one more access."""
        self.low.append(1 << 33)
        self.high.append(-1)
        return len(self.low) - 1

    def enter(self, layer: Layer) -> None:
        """Go on with the memory of a path."""
        self.layer = settled(layer, DATA_END)
        self.cells = self.layer.cells

    # ------------------------------------------------------------------------------------------------ loads
    def load(self, address: Word, site: int) -> Word:
        """A word."""
        if type(address) is int:
            if address < self.low[site]:
                self.low[site] = address
            if address > self.high[site] - 3:
                self.high[site] = address + 3
            found = self.cells.get(address)
            if found is None:
                found = self._constants.get(address)
            if type(found) is int:
                return found
            return self._word_at(address)
        if type(address) is Stack:
            self.wild.add(site)
            if address.offset > self.top_read:
                self.top_read = address.offset
            return self._word_at(STACK + address.offset)
        return self._any_of(address, site, 4, self._word_at, TOP, Op.MOV)

    def load_byte(self, address: Word, site: int) -> Word:
        """A byte, extended with zeros."""
        return self._small(address, site, 1, self._byte_at, BYTE, Op.UXTB)

    def load_signed_byte(self, address: Word, site: int) -> Word:
        """A byte, extended with its sign."""
        return self._small(address, site, 1, self._signed_byte_at, SIGNED_BYTE, Op.SXTB)

    def load_half(self, address: Word, site: int) -> Word:
        """Two bytes, extended with zeros."""
        return self._small(address, site, 2, self._half_at, HALF, Op.UXTH)

    def load_signed_half(self, address: Word, site: int) -> Word:
        """Two bytes, extended with their sign."""
        return self._small(address, site, 2, self._signed_half_at, SIGNED_HALF, Op.SXTH)

    def _small(self, address: Word, site: int, size: int, read: Reader, every: Range, extend: Op) -> Word:
        if type(address) is int:
            if address < self.low[site]:
                self.low[site] = address
            if address + size - 1 > self.high[site]:
                self.high[site] = address + size - 1
            return read(address)
        if type(address) is Stack:
            self.wild.add(site)
            if address.offset > self.top_read:
                self.top_read = address.offset
            return read(STACK + address.offset)
        return self._any_of(address, site, size, read, every, extend)

    def _any_of(self, address: Word, site: int, size: int, read: Reader, every: Range, extend: Op) -> Word:
        """What is read at one of several addresses; `every` are the values that an access of its kind can give."""
        keys = self._keys(address, site, size)
        if keys is None:
            self.vague += 1
            if is_wild(address) or self.leaked:
                return WILD
            return fresh(every)
        if len(keys) == 1:
            return read(keys[0])
        if not self.leaked and any(self._elsewhere(key, size) for key in (keys[0], keys[-1])):
            self.vague += 1
            return self._from(address, fresh(every), size, extend)
        places = several.groups(keys, size)
        if places is not None:
            values = several.read(list(self._cells_at(places)), size, extend)
            if values is not None:
                return self._from(address, made(values), size, extend)
        return several.covering(map(read, keys), None if self.leaked or keys[-1] >= DATA_END else every)

    def _from(self, address: Word, word: Word, size: int, extend: Op) -> Word:
        """A word that was read at one of several addresses."""
        if isinstance(word, Ranged) and isinstance(address, Ranged):
            word.source = Source(address, size, extend, self.stores)
        return word

    def where(self, source: Source, values: Range) -> Range | None:
        """Those addresses of a source at which one of the values may be read; None where nothing can be told as memory
        was written since, or nothing less than all."""
        found, stores = source.address.range, source.stores
        keys = self._keys_of(source.address)
        if stores != self.stores or keys is None:
            return None
        first, last = 0, len(keys) - 1
        while first < last and not self._may_be(keys[first], source, values):
            first += 1
        while last > first and not self._may_be(keys[last], source, values):
            last -= 1
        if first == 0 and last == len(keys) - 1:
            return None
        low, high = (keys[end] - STACK if keys[end] >= DATA_END else keys[end] for end in (first, last))
        return domain.clip(found, low & MASK, high & MASK)

    def _may_be(self, key: int, source: Source, values: Range) -> bool:
        """Whether one of the values may be read at a place."""
        cell, shift = self.look(self.layer, key & ~3), 8 * (key & 3)
        if key % source.size:
            return True
        if isinstance(cell, list):
            parts = cell[key & 3 : (key & 3) + source.size]
            if not all(type(part) is int for part in parts):
                return True
            number = sum((part & 0xFF) << 8 * i for i, part in enumerate(parts))  # type: ignore[operator,misc]
        elif type(cell) is int:
            number = cell >> shift & ((1 << 8 * source.size) - 1)
        else:
            return True
        return domain.concrete(source.extension, number, 0) in values

    def longest(self, address: Word) -> int | None:
        """The greatest length of the string at an address, the 0 at its end included: up to the first byte that is
        certainly 0. None where there is none."""
        keys = (address,) if type(address) is int else self._keys_of(address)
        if type(address) is Stack:
            keys = (STACK + address.offset,)
        if keys is None:
            return None
        first, last = min(keys), max(keys)
        end = next((key for key in range(last, last + MOST_PLACES) if self._is_zero(key)), None)
        if end is None or last - first > MOST_PLACES:
            return None
        most = end + 1 - last
        for key in range(last - 1, first - 1, -1):
            end = key if self._is_zero(key) else end
            if key in keys:
                most = max(most, end + 1 - key)
        return most

    def _is_zero(self, key: int) -> bool:
        """Whether a byte is certainly 0."""
        cell = self.look(self.layer, key & ~3)
        part = cell[key & 3] if isinstance(cell, list) else cell >> 8 * (key & 3) if type(cell) is int else 1
        return type(part) is int and not part & 0xFF

    def _elsewhere(self, key: int, size: int) -> bool:
        """Whether an access goes to a word that is in no segment, where anything may be read."""
        return key < DATA_END and not key % size and not self._content.around(key & ~3)

    def _cells_at(self, places: Sequence[several.Group]) -> Iterator[tuple[Cell, tuple[int, ...]]]:
        """The cells of several words with the positions that count in them."""
        for bases, positions in places:
            for _, cell in self._cells_of(bases):
                yield cell, positions

    def _cells_of(self, keys: Sequence[int]) -> list[tuple[int, Cell]]:
        """Several words as they are in memory, in no order."""
        if len(keys) < 4:
            return [(key, self._cell(key)) for key in keys]
        missing = set(keys)
        constant = self._constants.keys() & missing
        found = [(key, self._constants[key]) for key in constant]
        missing -= constant
        layer: Layer | None = self.layer
        while layer is not None and missing:
            hits = layer.cells.keys() & missing
            if hits:
                cells = layer.cells
                found += [(key, cells[key]) for key in hits]
                missing -= hits
            if layer.forgets:
                break
            layer = layer.below
        bottom = lowest(self.layer).cells
        for key in missing:
            cell = self.look(self.layer, key)
            if type(cell) is int:
                bottom[key] = cell
            found.append((key, cell))
        return found

    def _keys(self, address: Word, site: int, size: int) -> Sequence[int] | None:
        """The keys of all the places of an access with several; None where they are too many, or not known."""
        keys = self._keys_of(address)
        if keys is None or type(address) is Stacks:
            self.wild.add(site)
        if keys is not None and type(address) is Stacks:
            self.top_read = DATA_END
        elif keys is not None and type(address) is Some:
            low, high = address.range.unsigned_bounds()
            self.low[site] = min(self.low[site], low)
            self.high[site] = max(self.high[site], high + size - 1)
        return keys

    def _keys_of(self, address: Word) -> Sequence[int] | None:
        if type(address) is Stacks and address.range.size <= MOST_PLACES:
            offsets = address.range
            low, high = offsets.signed_bounds()
            if offsets.values is None and low + offsets.span == high:
                return range(STACK + low, STACK + high + 1, offsets.step or 1)
            return [STACK + (offset - (1 << 32) if offset >> 31 else offset) for offset in offsets.members()]
        if type(address) is Some and address.range.size <= MOST_PLACES:
            low, high = address.range.unsigned_bounds()
            if address.range.values is None and low + address.range.span == high:
                return range(low, high + 1, address.range.step or 1)
            return list(address.range.members())
        return None

    def peek(self, address: Word) -> Word:
        """A word in the stack, where nothing is noted of the access."""
        return self._word_at(STACK + address.offset) if type(address) is Stack else UNKNOWN

    def poke(self, address: Word, value: Word) -> None:
        """Put a word into the stack that covers the one there."""
        if type(address) is Stack:
            self._put(STACK + address.offset, value)

    # ------------------------------------------------------------------------------------------------ stores
    def store(self, address: Word, value: Word, site: int) -> None:
        """Write a word."""
        keys = self._places(address, value, site, 4)
        if len(keys) == 1:
            self._put(keys[0], value)
        elif not self._put_one_of(keys, value, 4):
            for key in keys:
                self._put(key, merge(self._word_at(key), value))

    def store_byte(self, address: Word, value: Word, site: int) -> None:
        """Write the low byte of a value."""
        keys = self._places(address, value, site, 1)
        if len(keys) == 1:
            self._put_parts(keys[0], (value & 0xFF if type(value) is int else value,))
        elif not self._put_one_of(keys, value, 1):
            for key in keys:
                self._put_parts(key, (merge(self._byte_at(key), byte(value)),))

    def store_half(self, address: Word, value: Word, site: int) -> None:
        """Write the low two bytes of a value."""
        keys = self._places(address, value, site, 2)
        if len(keys) == 1:
            self._put_half(keys[0], value)
        elif not self._put_one_of(keys, value, 2):
            for key in keys:
                self._put_half(key, merge(self._half_at(key), half(value)))

    def _put_one_of(self, keys: Sequence[int], value: Word, size: int) -> bool:
        """Write to one of several places; False where each of them has to be looked at for itself."""
        values, places = range_of(value), several.groups(keys, size)
        if values is None or places is None:
            return False
        store = several.Weak(simple(values), size, self.shared)
        for bases, positions in places:
            for part in self._own(bases):
                for base, cell in self._cells_of(part):
                    after = store.after(cell, positions)
                    if after is not cell:
                        self.cells[base] = after
        return True

    def _own(self, bases: Sequence[int]) -> list[Sequence[int]]:
        """Those of several words that are the program's to write. Raises Lost for code and constants."""
        if bases[0] >= DATA_END:
            return [bases]
        if not isinstance(bases, range):
            return [[base for base in bases if self._writable(base)]]
        found: list[Sequence[int]] = []
        start, step = bases[0], bases.step
        for segment in self._content.segments:
            # Words of which any byte is in the segment; one that is in two of them may be written twice.
            first, behind = -((start + 3 - segment.address) // step), (segment.end - 1 - start) // step + 1
            part = bases[max(0, first) : max(0, behind)]
            if part and not segment.writable:
                raise Lost("code or a constant is written")
            if part:
                found.append(part)
        return found

    def _places(self, address: Word, value: Word, site: int, size: int) -> Sequence[int]:
        """The keys that a store may write; none where nothing is known of memory after it. Raises Lost."""
        self.stores += 1
        if type(address) is int:
            self.low[site] = min(self.low[site], address)
            self.high[site] = max(self.high[site], address + size - 1)
            if is_wild(value):
                self.leaked = True
            return (address,)
        if type(address) is Stack:
            self.wild.add(site)
            return (STACK + address.offset,)
        self.vague += 1
        keys = self._keys(address, site, size)
        if keys is not None:
            if is_wild(value) and keys[0] < DATA_END:
                self.leaked = True
            # Of an address that is not a multiple of 4, a core that stores words to such only takes no notice.
            aligned = type(keys) is range and not (keys[0] | keys.step) & 3
            return keys if size < 4 or self._unaligned or aligned else sorted({key & ~3 for key in keys})
        if is_wild(address) or type(address) is Stacks:
            raise Lost("a store that may go anywhere")
        if is_wild(value):
            self.leaked = True
        self._forget()
        return ()

    def _forget(self) -> None:
        """Nothing is known any more of what is writable, but for the stack."""
        for key in [key for key in self.cells if key < DATA_END]:
            del self.cells[key]
        self.layer.forgets = True
        self.layer.wild = self.layer.wild or self.leaked

    def _put(self, key: int, value: Word) -> None:
        if key & 3:
            self._put_parts(key, parts_of(value))
            return
        if not self._writable(key):
            return
        if isinstance(value, Ranged):
            value.home = (key, 4)
        self.cells[key] = value

    def _put_half(self, key: int, value: Word) -> None:
        if type(value) is int:
            self._put_parts(key, (value & 0xFF, value >> 8 & 0xFF))
            return
        if type(value) is Some and not key & 1:
            value.home = (key, 2)
        self._put_parts(key, (Half(value, 0), Half(value, 1)))

    def _put_parts(self, key: int, parts: Sequence[Part]) -> None:
        """Write bytes, which may lie in two words."""
        if (key & 3) + len(parts) > 4 and not self._unaligned:
            raise Lost("an access that is not aligned")
        if len(parts) == 1 and type(parts[0]) is Some:
            parts[0].home = (key, 1)
        position = 0
        while position < len(parts):
            base = (key + position) & ~3
            if not self._writable(base):
                return
            parts_ = list(parts_of(self._cell(base)))
            while position < len(parts) and (key + position) & ~3 == base:
                parts_[(key + position) & 3] = parts[position]
                position += 1
            self.cells[base] = joined(parts_)

    # ------------------------------------------------------------------------------------------------ cells
    def _cell(self, key: int) -> Cell:
        """A word as it is in memory; one of which nothing is known gets a value of its own."""
        found = self.cells.get(key)
        if found is None:
            found = self._constants.get(key)
        return self.look(self.layer, key) if found is None else found

    def look(self, layer: Layer, key: int) -> Cell:
        """A word as it is in the memory of a path."""
        one: Layer | None = layer
        while one is not None:
            found = one.cells.get(key)
            if found is not None:
                return found
            if one.forgets and key < DATA_END and self._changeable(key):
                unknown: Cell = WILD if one.wild else TOP
                one.cells[key] = unknown
                return unknown
            one = one.below
        return self._initial(layer, key)

    def _initial(self, layer: Layer, key: int) -> Cell:
        """A word that was not written yet."""
        if key >= DATA_END:
            lowest(layer).cells[key] = TOP
            return TOP
        cell = self._content.word(key)
        if cell is None:
            self.vague += 1
            return fresh()
        if type(cell) is not int:
            self.vague += isinstance(cell, list) and any(part is UNKNOWN for part in cell)
            lowest(layer).cells[key] = cell
        return cell

    def _changeable(self, key: int) -> bool:
        """Whether any byte of a word is in a segment that can be written."""
        return any(segment.writable for segment in self._content.around(key))

    def _writable(self, key: int) -> bool:
        """Whether a word is the program's to write; not so a device. Raises Lost for code and constants."""
        if key >= DATA_END or key in self._ours:
            return True
        found = self._content.around(key)
        if not all(segment.writable for segment in found):
            raise Lost("code or a constant is written")
        if found:
            self._ours.add(key)
        return bool(found)

    # ------------------------------------------------------------------------------------------------ reading
    def _word_at(self, key: int) -> Word:
        if key & 3:
            return self._unaligned_at(key, 4)
        found = self._cell(key)
        if type(found) is list:
            return together(found)
        if type(found) is Range:
            found = self._named(key, found)
        if isinstance(found, Ranged):
            found.home = (key, 4)
        return found  # type: ignore[return-value]

    def _named(self, key: int, values: Range) -> Word:
        """A word of a bare range in memory, as it will be read again, on other paths as well."""
        word = made(values)
        put_where(self.layer, key, word)
        return word

    def _apart(self, key: int) -> Cell:
        """A cell as four bytes if nothing or no more than its bytes are known, else as it is but never a bare range."""
        cell = self._cell(key)
        if type(cell) is Range and not cell.is_top:
            return self._named(key, cell)
        if type(cell) is Range or (type(cell) is Some and cell.range.is_top):
            cell = list(ANY)
            put_where(self.layer, key, cell)
        return cell

    def _part_at(self, base: int, parts: list[Part], position: int) -> Part:
        """A byte of a cell; a bare range becomes a word, as it will be read again."""
        part = parts[position]
        if type(part) is Range:
            changed = parts[:]
            changed[position] = part = made(part)
            put_where(self.layer, base, changed)
        return part

    def _byte_at(self, key: int) -> Word:
        base, position = key & ~3, key & 3
        cell = self._cell(base)
        if type(cell) is int:
            return cell >> 8 * position & 0xFF
        if type(cell) is not list:
            cell = self._apart(base)
        if type(cell) is not list:
            return byte(cell >> 8 * position) if not is_wild(cell) else WILD  # type: ignore[operator]
        part = self._part_at(base, cell, position)
        value = byte_of(part)
        if type(value) is Some and type(part) is not Half and part is not UNKNOWN:
            if value is not part and base in self.cells:
                # The same byte, as it will be read again.
                changed = list(self.cells[base])  # type: ignore[arg-type]
                changed[position] = value
                self.cells[base] = changed
            value.home = (key, 1)
        return value

    def _signed_byte_at(self, key: int) -> Word:
        cell = self._cell(key & ~3)
        if type(cell) is list:
            part = self._part_at(key & ~3, cell, key & 3)
            if type(part) is Some and domain.includes(domain.SIGNED_BYTE, part.range):
                part.home = (key, 1)
                return part
        return _signed(extend_byte, self._byte_at(key))

    def _half_at(self, key: int) -> Word:
        return half(self._half_of(key))

    def _signed_half_at(self, key: int) -> Word:
        return _signed(extend_half, self._half_of(key))

    def _half_of(self, key: int) -> Word:
        """A word of which the low 16 bits are those read."""
        if key & 1:
            return self._unaligned_at(key, 2)
        base, position = key & ~3, key & 2
        cell = self._cell(base)
        if type(cell) is Range:
            cell = [Half(HALF, 0), Half(HALF, 1)] * 2 if cell.is_top else self._named(base, cell)
        if type(cell) is not list:
            return WILD if is_wild(cell) else cell >> 8 * position  # type: ignore[operator]
        found = mates_at(cell, position)
        if found is None:
            return together([*cell[position : position + 2], 0, 0])
        if type(found) is Range:
            found = made(found)
            changed = list(cell)
            changed[position : position + 2] = [Half(found, 0), Half(found, 1)]
            put_where(self.layer, base, changed)
        if type(found) is Some:
            found.home = (key, 2)
        return found  # type: ignore[return-value]

    def _unaligned_at(self, key: int, size: int) -> Word:
        if not self._unaligned:
            return WILD if self.leaked or key >= DATA_END else fresh()
        return together([self._byte_at(key + i) if i < size else 0 for i in range(4)])

    # ------------------------------------------------------------------------------------------------ paths
    def narrow(self, word: Ranged, narrower: Word) -> None:
        """Put a narrower word where a word is at home, if it is still there."""
        if word.home is None:
            return
        key, size = word.home
        cell = self._cell(key & ~3)
        if size == 4:
            if cell is word:
                self._put(key, narrower)
        elif type(cell) is list:
            found = cell[key & 3]
            if size == 1 and found is word:
                self._put_parts(key, (narrower & 0xFF if type(narrower) is int else narrower,))
            elif size == 2 and mates_at(cell, key & 3) is word:
                self._put_half(key, narrower)


def _signed(extend: Reading, value: Word) -> Word:
    if is_wild(value):
        return WILD
    found = extend(value)
    if type(found) is Some and type(value) is Some and found.range == value.range:
        return value
    return found
