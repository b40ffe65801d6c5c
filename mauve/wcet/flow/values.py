"""What the value analysis knows, in the words of the ranking arguments (locations.py)."""

from __future__ import annotations

from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import Loop
from mauve.wcet.binary.microop import Store, StoreUnknown
from mauve.wcet.flow import linear
from mauve.wcet.flow.domain import MASK, MODULUS, SIGN, Range
from mauve.wcet.flow.image import Image
from mauve.wcet.flow.linear import FRAME, Value
from mauve.wcet.flow.locations import ANY, ENTRY_SP, Base, Cell, Interval, Location, Region, Sum, whole
from mauve.wcet.flow.record import Record
from mauve.wcet.flow.state import ABSOLUTE, NARROW, State
from mauve.wcet.flow.strings import longest_at


def interval(known: Range) -> Interval:
    """The hull of a range as an interval."""
    if known.is_top:
        return ANY
    low = known.low
    if low & SIGN and low + known.span >= MODULUS:
        low -= MODULUS
    return Interval(low, low + known.span, known.step or 1)


class LoopValues:
    """EntryValues of one loop, from the header that a pass found for it."""

    def __init__(self, record: Record, loop: int, image: Image) -> None:
        header = record.headers.get(loop)
        self._entry = None if header is None else header.entry
        self._any = None if header is None else header.state
        self._record, self._image = record, image

    def on_entry(self, location: Location) -> Interval:
        """The value when control comes to the header from outside the loop."""
        return _value(self._entry, location)

    def invariant(self, location: Location) -> Interval:
        """The value at the start of the header, in any iteration."""
        return _value(self._any, location)

    def sp_offset(self, block: int) -> int | None:
        """Not kept per block."""
        return None

    def access(self, address: int, index: int) -> Region | None:
        """The bytes touched by a micro-operation."""
        place = self._record.accesses.get((address, index))
        if place is None or place[0] not in (FRAME, ABSOLUTE):
            return None
        return Region(Base.SP if place[0] == FRAME else Base.ABSOLUTE, place[1], place[2])

    def tracked(self, cell: Cell) -> bool:
        """Memory of the binary changes only by its own code (a listed assumption); other addresses may be devices."""
        return cell.base is Base.ABSOLUTE and self._image.constant(cell.offset, 0) is not None

    def constant(self, cell: Cell) -> int | None:
        """Read-only data."""
        return self._image.constant(cell.offset, cell.size) if cell.base is Base.ABSOLUTE else None


    def string(self, parts: Sum, offset: int, stores: tuple[tuple[int, int], ...]) -> int | None:
        """As far as the state at the header knows: what it holds is so in every iteration, and in between as well where
        no store of the loop could put back what another took away."""
        if self._entry is None or self._any is None:
            return None
        address: Value = offset & MASK
        for location, factor in parts:
            value = _symbolic(self._entry, location)
            if value is None:
                return None
            address = linear.add(address, linear.scale(value, factor))
        place = self._entry.place(address)
        written = [found for at in stores if (found := self._record.accesses.get(at)) is not None]
        return longest_at(self._any, place, self._image, written)


class Hoped(LoopValues):
    """The same where no store goes to a place that is not known, and memory is in every iteration as it was on entry:
    for bounds that are guessed, and proven only with what follows from them."""

    def access(self, address: int, index: int) -> Region | None:
        """What is known, or nothing at all."""
        return super().access(address, index) or Region(Base.ABSOLUTE, 1, 0)

    def string(self, parts: Sum, offset: int, stores: tuple[tuple[int, int], ...]) -> int | None:
        """As far as the state on entry knows."""
        self._any = self._entry
        return super().string(parts, offset, ())


def writes_anywhere(cfg: Cfg, loop: Loop, record: Record) -> bool:
    """Whether a loop has a store whose place is not known as long as its bound is not."""
    for block in loop.blocks:
        for instruction in cfg.blocks[block].instructions:
            for index, op in enumerate(instruction.ops):
                place = record.accesses.get((instruction.address, index), NOWHERE)
                if isinstance(op, Store | StoreUnknown) and (place[0] is None or place[2] - place[1] > NARROW):
                    return True
    return False


NOWHERE = (ABSOLUTE, 0, -1)


def _symbolic(state: State, location: Location) -> Value | None:
    if isinstance(location, int):
        return linear.of_symbol(FRAME) if location == ENTRY_SP else state.regs[location]
    cell = state.memory.get(FRAME if location.base is Base.SP else ABSOLUTE, {}).get(location.offset)
    return cell[1] if cell is not None and cell[0] == location.size else None


def _value(state: State | None, location: Location) -> Interval:
    if state is None:
        return whole(location)
    if isinstance(location, int):
        return interval(state.range_of(state.regs[location]))
    region = FRAME if location.base is Base.SP else ABSOLUTE
    cell = state.memory.get(region, {}).get(location.offset)
    if cell is None or cell[0] != location.size:
        return whole(location)
    return interval(state.range_of(cell[1]))
