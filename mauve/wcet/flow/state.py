"""The abstract state at a program point: registers, flags, memory, and what is known of the symbols in them.

A state stands for all machine states for which some assignment of numbers to its symbols, within their ranges, gives
the registers and memory cells their values. Refining a symbol refines every register and cell that holds it; that is
how a compare of a copy narrows the stack slot it was loaded from. `pins` remembers symbols that were replaced by
their only value.

Memory is kept in regions. The region of a symbol p holds cells at p + offset; region ABSOLUTE (0) those at fixed
addresses. Assumed: the frame is not reached through pointers that the function did not derive from sp (unless
`leaked`), and memory changes only by the analysed code; both are listed in results.
"""

from __future__ import annotations

from collections.abc import Collection
from itertools import count

from mauve.wcet.binary.microop import Condition, FlagKind
from mauve.wcet.flow import anchors, domain, flags, linear
from mauve.wcet.flow.domain import MASK, MODULUS, SIGN, TOP, Range
from mauve.wcet.flow.image import Image
from mauve.wcet.flow.linear import FIRST_FRESH, FPU, FRAME, MOST_TERMS, Value, entry_symbol

ABSOLUTE = 0
"""The region of fixed addresses."""
NARROW = 1 << 20
"""An offset that varies by less than this is one that we follow; a wider one is as good as unknown."""
FAR = 1 << 16
"""An offset from an unknown number that is no smaller is taken for an address, the unknown number for an index."""
MOST_READ = 32
"""What was read from a region outside the frame is remembered for at most this many cells."""
ENDS = 1 << 40
"""A cell at ENDS + offset tells in how many bytes from the offset on strings end (see strings.py)."""
IN_STACK, OF_FRAME = 1 << 4, 1 << 5
MASK_OF_ALL = (1 << 6) - 1
_ENTRY_MASK = dict.fromkeys(range(FIRST_FRESH), 0) | {entry_symbol(r): 1 << r for r in range(4)} | {FRAME:
OF_FRAME}

Cells = dict[int, tuple[int, Value]]
Origin = tuple[FlagKind, Value, Value]


class Symbols:
    """A source of fresh symbols. Those from `floor` on were made in the current pass through a loop: older ones stand
    in the loop's header, where their meaning counts."""

    def __init__(self) -> None:
        self._next = count(linear.FIRST_FRESH)
        self.floor = linear.FIRST_FRESH

    def fresh(self) -> int:
        """A symbol never given before."""
        return next(self._next)


class State:
    """See the module's description. `flags` is a set of possible NZCV (see flags.py), `origin` the compare they come
    from."""

    __slots__ = (
        "anchors", "flags", "held", "leaked", "memory", "origin",
        "pins", "ranges", "regs", "shared", "symbols", "taints",
    )  # fmt: skip

    def __init__(self, symbols: Symbols) -> None:
        self.symbols = symbols
        self.regs: list[Value] = [linear.of_symbol(entry_symbol(r)) for r in range(16)] + [0] * 16
        self.flags = flags.ANY
        self.origin: Origin | None = None
        self.memory: dict[int, Cells] = {}
        self.shared: set[int] = set()
        self.ranges: dict[int, Range] = {}
        self.anchors: anchors.Anchors = {}
        self.pins: dict[int, Value] = {}
        self.taints: dict[int, int] = {}
        self.held = 0
        self.leaked = False

    def copy(self) -> State:
        """A state that can be changed on its own."""
        new = State.__new__(State)
        new.symbols = self.symbols
        new.regs = self.regs[:]
        new.flags = self.flags
        new.origin = self.origin
        new.memory = self.memory.copy()
        self.shared = set(self.memory)
        new.shared = set(self.memory)
        new.ranges = self.ranges.copy()
        new.anchors = self.anchors
        new.pins = self.pins
        new.taints = self.taints.copy()
        new.held = self.held
        new.leaked = self.leaked
        return new

    # ------------------------------------------------------------------------------------------------ values
    def fresh(self, known: Range = TOP) -> Value:
        """A new unknown within a range."""
        if known.n == 0:
            return known.low
        symbol = self.symbols.fresh()
        if not known.is_top:
            self.ranges[symbol] = known
        return (0, symbol, 1)

    def mask(self, value: Value) -> int:
        """Of which addresses the value may be computed: bit r for argument register r, IN_STACK for arguments on the
        stack, OF_FRAME for the frame."""
        if type(value) is int:
            return 0
        result = 0
        taints = self.taints
        for symbol in value[1::2]:  # type: ignore[index]
            result |= _ENTRY_MASK[symbol] if symbol < FIRST_FRESH else taints.get(symbol, 0)
        return result

    def tainted(self, value: Value, mask: int) -> Value:
        """A fresh symbol, remembering what it was computed of; a number that varies little is no address."""
        if mask and type(value) is not int:
            symbol = linear.symbols(value)[0]
            if symbol not in self.ranges or self.ranges[symbol].span >= NARROW:
                self.taints[symbol] = self.taints.get(symbol, 0) | mask
        return value

    def limited(self, value: Value) -> Value:
        """The value itself, or a fresh symbol in its range where the expression has grown too long."""
        if type(value) is int or len(value) <= 2 * MOST_TERMS + 1:  # type: ignore[arg-type]
            return value
        short = self.tainted(self.fresh(self.range_of(value)), self.mask(value))
        if type(short) is not int:
            anchors.note(self, linear.symbols(short)[0], anchors.shortened(value, self))
        return short

    def range_of(self, value: Value) -> Range:
        """All numbers the value may be."""
        if type(value) is int:
            return Range(value, 0, 0)
        assert type(value) is tuple
        ranges = self.ranges
        if len(value) == 3:
            known = ranges.get(value[1], TOP)
            if value[2] != 1:
                known = domain.scale(known, value[2])
            return domain.shift(known, value[0]) if value[0] else known
        total = Range(value[0], 0, 0)
        for i in range(1, len(value), 2):
            total = domain.add(total, domain.scale(ranges.get(value[i], TOP), value[i + 1]))
        return anchors.refined(self, value, total) if self.anchors else total

    def constant_of(self, value: Value) -> int | None:
        """The number the value is, where it is only one."""
        if type(value) is int:
            return value
        known = self.range_of(value)
        return known.low if known.n == 0 else None

    # ------------------------------------------------------------------------------------------------ refinement
    def require(self, value: Value, low: int, high: int) -> bool:
        """Assume the value lies on the way from `low` up to `high` around the circle; False where that cannot be."""
        length = (high - low) & MASK
        if type(value) is int:
            return (value - low) & MASK <= length
        assert type(value) is tuple
        known = self.range_of(value)
        inside = domain.clip(known, low, high)
        if inside is None:
            return False
        if len(value) > 3 and inside.span < known.span and self._name(value, inside):
            return True
        for i in range(1, len(value), 2):
            symbol, factor = value[i], value[i + 1]
            rest = self.range_of(linear.add(value, linear.scale((0, symbol, 1), -factor)))
            if rest.span + length >= MASK:
                continue
            start = low - rest.low - rest.span
            if not self._require_term(symbol, factor, start & MASK, (start + length + rest.span) & MASK):
                return False
        return True

    def _name(self, value: tuple[int, ...], known: Range) -> bool:
        """Note a range for an expression of several symbols: it becomes a symbol of its own, and an unlimited one of
        those in it, of which nothing can be lost, is expressed by the new one. False where there is none."""
        if linear.factor_of(value, FRAME):
            return False
        for i in range(len(value) - 2, 0, -2):
            symbol, factor = value[i], value[i + 1]
            free = symbol >= self.symbols.floor and symbol not in self.memory and symbol not in self.pins
            if free and abs(factor) == 1 and self.ranges.get(symbol, TOP).is_top:
                named = self.fresh(known)
                if type(named) is not int:
                    self.taints[linear.symbols(named)[0]] = self.mask(value)
                rest = linear.sub(value, (0, symbol, factor))
                self._replace(symbol, self.limited(linear.scale(linear.sub(named, rest), factor)))
                return True
        return False

    def _require_term(self, symbol: int, factor: int, low: int, high: int) -> bool:
        known = self.ranges.get(symbol, TOP)
        if factor == 1:
            clipped = domain.clip(known, low, high)
        elif factor == -1:
            clipped = domain.clip(known, -high & MASK, -low & MASK)
        elif known.size <= domain.SMALL:
            kept = [v for v in known.members() if (v * factor - low) & MASK <= (high - low) & MASK]
            clipped = domain.of(kept) if kept else None
        elif known.span * abs(factor) < MODULUS:
            product = domain.scale(known, factor)
            part = domain.clip(product, low, high)
            if part is None:
                return False
            if product.n != known.n or (part.n and part.step != product.step):
                return True
            # A product that goes all around the circle may begin anywhere: count from where the symbol's end lies.
            origin = (known.low if factor > 0 else known.low + known.span) * factor
            skipped = ((part.low - origin) & MASK) // product.step
            if skipped + part.n > known.n:
                return True
            first = skipped if factor > 0 else known.n - skipped - part.n
            clipped = domain.progression(known.low + first * known.step, known.step, part.n)
        else:
            return True
        if clipped is None:
            return False
        if clipped is not known:
            self._set_range(symbol, clipped)
        return True

    def _set_range(self, symbol: int, known: Range) -> None:
        """Narrow a symbol; one that has a single value left is replaced by it everywhere."""
        self.ranges[symbol] = known
        if known.n == 0 and symbol != FRAME:
            self._replace(symbol, known.low)

    def _replace(self, symbol: int, number: Value) -> None:
        """Write another value for a symbol wherever it stands, and remember that they are equal."""
        self.pins = {s: linear.substitute(v, symbol, number) for s, v in self.pins.items()}
        self.pins[symbol] = number
        if type(number) is not int:
            anchors.handed_on(self, symbol, number)
        for index, value in enumerate(self.regs):
            if type(value) is not int and symbol in value:  # type: ignore[operator]
                self.regs[index] = linear.substitute(value, symbol, number)
        if self.origin is not None:
            kind, a, b = self.origin
            self.origin = (kind, linear.substitute(a, symbol, number), linear.substitute(b, symbol, number))
        for region, cells in list(self.memory.items()):
            found = [(o, c) for o, c in cells.items() if type(c[1]) is not int and symbol in c[1]]  # type: ignore[operator]
            for offset, (size, value) in found:
                self.cells(region)[offset] = (size, linear.substitute(value, symbol, number))

    def _unify(self, difference: Value) -> None:
        """Use that a sum of several symbols is 0: express the youngest one by the others."""
        if type(difference) is int or len(difference) < 5:  # type: ignore[arg-type]
            return
        symbol, factor = difference[-2], difference[-1]  # type: ignore[index]
        rest = linear.sub(difference, (0, symbol, factor))
        if linear.is_entry_symbol(symbol) or symbol in self.memory:
            return
        other = linear.divide(linear.scale(rest, -1 if factor > 0 else 1), abs(factor))
        if other is None:
            return
        mine, theirs = self.ranges.get(symbol, TOP), self.range_of(other)
        if abs(factor) > 1 and domain.join(mine, theirs).span * abs(factor) >= MODULUS:
            return
        if self.require(other, mine.low, mine.high):
            self._replace(symbol, other)

    def pinned(self, value: Value) -> Value:
        """The value with those symbols replaced that were found to be equal to others."""
        if type(value) is int or not self.pins:
            return value
        for symbol in linear.symbols(value):
            if symbol in self.pins:
                value = linear.substitute(value, symbol, self.pins[symbol])
        return value

    def exclude(self, value: Value, number: int) -> bool:
        """Assume the value is not `number`; False where that cannot be."""
        if type(value) is int:
            return value != number
        assert type(value) is tuple
        if len(value) != 3:
            known = self.range_of(value)
            if known.n == 0 and known.low == number:
                return False
            if known.is_top and value in self.regs:
                self._name(value, domain.between(number + 1, number - 1))
            elif number in (known.low, known.high):
                anchors.learn(self, value, domain.without(known, number) or known)
            return True
        offset, symbol, factor = value
        known = self.ranges.get(symbol, TOP)
        target = (number - offset) & MASK
        if abs(factor) == 1:
            rest = domain.without(known, target * factor & MASK)
        elif known.size <= domain.SMALL:
            kept = [v for v in known.members() if v * factor & MASK != target]
            rest = domain.of(kept) if kept else None
        else:
            rest = known
            for end in (known.low, known.high):
                if rest is not None and end * factor & MASK == target:
                    rest = domain.without(rest, end)
        if rest is None:
            return False
        if rest is not known:
            self._set_range(symbol, rest)
        return True

    def assume(self, condition: Condition) -> bool:
        """Assume that a condition holds; False where it cannot."""
        self.flags &= flags.HOLDS[condition.value]
        if not self.flags:
            return False
        if condition is Condition.AL or self.origin is None:
            return True
        kind, a, b = self.origin
        if kind is FlagKind.LOGIC:
            return self._assume_sign(condition, a)
        return self._assume_order(condition, a, b)

    def _assume_sign(self, condition: Condition, value: Value) -> bool:
        match condition:
            case Condition.EQ:
                return self.require(value, 0, 0)
            case Condition.NE:
                return self.exclude(value, 0)
            case Condition.MI:
                return self.require(value, SIGN, MASK)
            case Condition.PL:
                return self.require(value, 0, SIGN - 1)
            case _:
                return True

    def _assume_order(self, condition: Condition, a: Value, b: Value) -> bool:
        match condition:
            case Condition.EQ | Condition.NE | Condition.MI | Condition.PL:
                if not self._assume_sign(condition, linear.sub(a, b)):
                    return False
                if condition is not Condition.EQ:
                    return True
                self._unify(linear.sub(a, b))
                known = self.range_of(b)
                if not self.require(a, known.low, known.high):
                    return False
                known = self.range_of(a)
                return self.require(b, known.low, known.high)
            case Condition.CC:
                return self._assume_less(a, b, 1, False)
            case Condition.LS:
                return self._assume_less(a, b, 0, False)
            case Condition.CS:
                return self._assume_less(b, a, 0, False)
            case Condition.HI:
                return self._assume_less(b, a, 1, False)
            case Condition.LT:
                return self._assume_less(a, b, 1, True)
            case Condition.LE:
                return self._assume_less(a, b, 0, True)
            case Condition.GE:
                return self._assume_less(b, a, 0, True)
            case Condition.GT:
                return self._assume_less(b, a, 1, True)
            case _:
                return True

    def _assume_less(self, a: Value, b: Value, least: int, as_signed: bool) -> bool:
        """Assume a + least <= b."""
        if linear.factor_of(a, FRAME) == 1 and linear.factor_of(b, FRAME) == 1:
            return self.require(linear.sub(b, a), least, SIGN - 1)
        floor, ceiling = (-SIGN, SIGN - 1) if as_signed else (0, MASK)
        known_a, known_b = self.range_of(a), self.range_of(b)
        low_a = (known_a.signed_bounds() if as_signed else known_a.unsigned_bounds())[0]
        high_b = (known_b.signed_bounds() if as_signed else known_b.unsigned_bounds())[1]
        if low_a + least > high_b:
            return False
        possible = self.require(a, floor & MASK, (high_b - least) & MASK) and self.require(
            b, (low_a + least) & MASK, ceiling & MASK
        )
        if possible and high_b - low_a < anchors.NEAR:
            difference = linear.sub(b, a)
            known = domain.meet(self.range_of(difference), domain.between(least, high_b - low_a))
            if known is None:
                return False
            anchors.learn(self, self.pinned(difference), known)
        return possible

    # ------------------------------------------------------------------------------------------------ memory
    def place(self, address: Value) -> tuple[int | None, int, int]:
        """(region, lowest offset, highest offset) of an address; region None where nothing is known of it."""
        if type(address) is int:
            return ABSOLUTE, address, address
        assert type(address) is tuple
        if len(address) == 3 and address[2] == 1:
            known = self.ranges.get(address[1])
            if known is None:
                offset = address[0]
                return address[1], (offset - MODULUS if offset & SIGN else offset), (
                    offset - MODULUS if offset & SIGN else offset
                )
        root = FRAME if linear.factor_of(address, FRAME) == 1 else None
        for i in range(1, len(address) if root is None else 0, 2):
            if address[i + 1] == 1 and self.ranges.get(address[i], TOP).span >= NARROW:
                root = address[i]
                break
        rest = address if root is None else linear.sub(address, (0, root, 1))
        known = self.range_of(rest)
        if known.span >= NARROW:
            return (root if root == FRAME else None), -SIGN, SIGN - 1
        if root is None:
            low, high = known.unsigned_bounds()
            return (None, 0, MASK) if high - low >= NARROW else (ABSOLUTE, low, high)
        low, high = known.signed_bounds()
        return (root, low, high) if high - low < NARROW else ((root if root == FRAME else None), -SIGN, SIGN - 1)

    def cells(self, region: int) -> Cells:
        """The cells of a region, to be changed."""
        cells = self.memory.get(region)
        if cells is None:
            cells = self.memory[region] = {}
            self.shared.discard(region)
        elif region in self.shared:
            cells = self.memory[region] = cells.copy()
            self.shared.discard(region)
        return cells

    def forget_bytes(self, region: int, low: int, high: int, keeps_ends: bool = False) -> None:
        """Drop what is known of the bytes `low` to `high` of a region; constant cells keep their other bytes. Where
        strings end in the region is not known any more, either, unless `keeps_ends`."""
        if not keeps_ends:
            self._forget_ends(region)
        old = self.memory.get(region)
        if not old:
            return
        span = range(low - 3, high + 1)
        hit = [o for o in (span if len(span) < len(old) else old) if o in old and o <= high and o + old[o][0] > low]
        if not hit:
            return
        cells = self.cells(region)
        for offset in hit:
            size, value = cells.pop(offset)
            if type(value) is int and size > 1:
                for i in range(size):
                    if not low <= offset + i <= high:
                        cells[offset + i] = (1, value >> 8 * i & 0xFF)

    def _forget_ends(self, region: int) -> None:
        ends = [offset for offset in self.memory.get(region, ()) if is_end(offset)]
        for offset in ends:
            del self.cells(region)[offset]

    def store(self, address: Value, value: Value | None, size: int) -> None:
        """Write `size` bytes; `value` None: of unknown content."""
        region, low, high = self.place(address)
        if value is not None and type(value) is not int:
            mask = self.mask(value)
            if region == FRAME:
                self.held |= mask
            elif mask & OF_FRAME:
                self.leaked = True
        self.forget_aliases(region)
        if region != FRAME and self.mask(address) & OF_FRAME:
            self.forget_frame()
        if region is None:
            return
        ends_more = type(value) is int and value & (1 << 8 * size) - 1 == 0
        if low != high:
            self.forget_bytes(region, low, high + size - 1, keeps_ends=ends_more)
            return
        present = self.memory.get(region, {}).get(low)
        if present is None or present[0] != size:
            self.forget_bytes(region, low, low + size - 1, keeps_ends=ends_more)
        elif not ends_more:
            self._forget_ends(region)
        if value is None:
            if present is not None:
                self.cells(region).pop(low, None)
            return
        if size < 4:
            value = self._truncated(value, size)
        self.cells(region)[low] = (size, value)

    def _truncated(self, value: Value, size: int) -> Value:
        limit = (1 << 8 * size) - 1
        if type(value) is int:
            return value & limit
        known = self.range_of(value)
        if known.low <= known.low + known.span <= limit:
            return value
        return self.tainted(self.fresh(domain.bit_and(known, domain.constant(limit))), self.mask(value))

    def forget_aliases(self, region: int | None) -> None:
        """A store to `region` may be one to any other region, except the frame's (unless its address leaked)."""
        if region == FRAME:
            if self.leaked:
                for other in [r for r in self.memory if r not in (FRAME, FPU)]:
                    del self.memory[other]
            return
        for other in [r for r in self.memory if r not in (FRAME, FPU, region)]:
            del self.memory[other]
        if self.leaked:
            self.forget_frame()

    def forget_frame(self, low: int = -SIGN, high: int = SIGN - 1) -> None:
        """Somebody may have written the frame's bytes from `low` to `high`; saved registers are taken to be safe
        (AAPCS)."""
        old = self.memory.get(FRAME)
        if not old:
            return
        saved = {o: c for o, c in old.items() if _is_saved(c[1])}
        self.forget_bytes(FRAME, low, high)
        self.cells(FRAME).update(saved)

    def load(self, address: Value, size: int, is_signed: bool, image: Image) -> Value:
        """Read `size` bytes and extend; `image` gives read-only data, and what facts assume of the other."""
        region, low, high = self.place(address)
        value: Value | None = None
        if region is not None and low == high and is_memory(region, low, image):
            value = self._load_cell(region, low, size)
            if value is None and region == ABSOLUTE:
                value = image.constant(low, size)
                known = image.assumed(Range(low, 0, 0), size, is_signed) if value is None else None
                if known is not None:
                    value = self.fresh(known)
                    if is_signed and size < 4:
                        return value
            if value is None:
                value = self._unknown(region, high, size)
                if region == FRAME or len(self.memory.get(region, ())) < MOST_READ:
                    self.forget_bytes(region, low, low + size - 1, keeps_ends=True)
                    self.cells(region)[low] = (size, value)
        elif region == ABSOLUTE and not self._overlaps(low, high + size - 1):
            value = self._load_table(address, size, image)
            known = image.assumed(self.range_of(address), size, is_signed) if value is None else None
            if known is not None:
                return self.fresh(known)
        if value is None:
            value = self._unknown(region, high, size)
        if is_signed and size < 4:
            return self._extended(value, 8 * size)
        return value

    def _unknown(self, region: int | None, high: int, size: int) -> Value:
        """A number read from memory: from the frame it may be an address that was stored there, or an argument."""
        mask = (self.held | (IN_STACK if high + size > 0 else 0)) if region == FRAME else 0
        return self.tainted(self.fresh(_BY_SIZE[size]), mask)

    def _overlaps(self, low: int, high: int) -> bool:
        return any(low - 4 < offset <= high for offset in self.memory.get(ABSOLUTE, ()))

    def _load_table(self, address: Value, size: int, image: Image) -> Value | None:
        """A constant table read at an unknown index."""
        addresses = self.range_of(address)
        if addresses.size > 1024:
            return None
        found: set[int] = set()
        for place in addresses.members():
            entry = image.constant(place, size)
            if entry is None:
                return None
            found.add(entry)
        return self.fresh(domain.of(found))

    def _load_cell(self, region: int, offset: int, size: int) -> Value | None:
        cells = self.memory.get(region)
        if not cells:
            return None
        cell = cells.get(offset)
        if cell is not None and cell[0] == size:
            return cell[1]
        result = 0
        for i in range(size):
            byte = self._load_byte(cells, offset + i)
            if byte is None:
                return None
            result |= byte << 8 * i
        return result

    @staticmethod
    def _load_byte(cells: Cells, offset: int) -> int | None:
        for back in range(4):
            cell = cells.get(offset - back)
            if cell is not None and cell[0] > back:
                value = cell[1]
                return value >> 8 * back & 0xFF if type(value) is int else None
        return None

    def _extended(self, value: Value, bits: int) -> Value:
        if type(value) is int:
            return (value ^ (1 << (bits - 1))) - (1 << (bits - 1)) & MASK
        known = self.range_of(value)
        if known.unsigned_bounds()[1] < 1 << (bits - 1):
            return value
        return self.fresh(domain.between(-(1 << (bits - 1)), (1 << (bits - 1)) - 1))

    # ------------------------------------------------------------------------------------------------ housekeeping
    def prune(self) -> None:
        """Drop what is known of symbols that nothing holds any more, the regions that nothing points to any more, and
        what symbols were replaced by."""
        self.trim(frozenset())
        self.pins = {}

    def trim(self, held: Collection[int] | None = None) -> None:
        """Drop what is known of symbols that nothing holds any more, and the regions that nothing points to any more.
        `held` are symbols that are held elsewhere; None: those that others are anchored to."""
        live: set[int] = {ABSOLUTE}
        for value in self.regs[:16]:
            if type(value) is not int:
                live.update(value[1::2])  # type: ignore[index]
        if self.origin is not None:
            live.update(linear.symbols(self.origin[1]) + linear.symbols(self.origin[2]))
        waiting = dict(self.memory)
        while True:
            reached = [r for r in waiting if r in live or linear.is_entry_symbol(r)]
            if not reached:
                break
            for region in reached:
                for _, value in waiting.pop(region).values():
                    if type(value) is not int:
                        live.update(value[1::2])  # type: ignore[index]
        for region in waiting:
            del self.memory[region]
        if held is None:
            held = _anchored(self.anchors, live)
        live.update(held)
        self.ranges = {symbol: known for symbol, known in self.ranges.items() if symbol in live}
        self.anchors = {symbol: anchor for symbol, anchor in self.anchors.items() if symbol in live}
        self.taints = {symbol: mask for symbol, mask in self.taints.items() if symbol in live}


def _anchored(table: anchors.Anchors, live: set[int]) -> set[int]:
    """The symbols that live ones are anchored to, directly or not."""
    found: set[int] = set()
    waiting = [symbol for symbol in live if symbol in table]
    while waiting:
        for base, _ in table[waiting.pop()]:
            for symbol in linear.symbols(base):
                if symbol not in found and symbol not in live:
                    found.add(symbol)
                    if symbol in table:
                        waiting.append(symbol)
    return found


def is_end(offset: int) -> bool:
    """Whether a cell tells where strings end (see ENDS)."""
    return offset > ENDS >> 1


def is_memory(region: int, offset: int, image: Image) -> bool:
    """Whether two loads from a place give the same number. A fixed address that is not the binary's may be a device,
    also as the base of an index: what was written there is not what is read. What pointers lead to is taken for memory.
    """
    if region == FRAME or (region != ABSOLUTE and abs(offset) < FAR):
        return True
    return image.constant(offset & MASK & ~3, 0) is not None


_BY_SIZE = {1: domain.BYTE, 2: domain.HALF, 4: TOP}
_SAVED = {linear.of_symbol(entry_symbol(r)) for r in (4, 5, 6, 7, 8, 9, 10, 11, 14)}


def _is_saved(value: Value) -> bool:
    return value in _SAVED
