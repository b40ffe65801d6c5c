"""Upper bounds of states: the join of two, and the header of a loop as a template that each iteration must fit.

The join keeps linear relations: all values that differ by a constant between the two states share one indicator
symbol, 0 in the first state and 1 in the second. At a loop header the indicator becomes the number of the iteration
(kappa), so that a value with a constant step is `initial + step * kappa` and every header state carries the closed
form of its counters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from mauve.wcet.flow import domain, flags, linear
from mauve.wcet.flow.domain import TOP, Range
from mauve.wcet.flow.linear import FRAME, MOST_TERMS, Value
from mauve.wcet.flow.state import NARROW, State

Place = tuple[int, int]
"""(-1, register) or (region, offset)."""


def join(a: State, b: State) -> State:
    """A state that holds both."""
    new = State.__new__(State)
    new.symbols = a.symbols
    new.flags = a.flags | b.flags
    new.leaked = a.leaked or b.leaked
    new.pins = a.pins if a.pins is b.pins else {s: v for s, v in a.pins.items() if b.pins.get(s) == v}
    other = b.ranges
    new.ranges = {}
    for symbol, known in a.ranges.items():
        second = other.get(symbol)
        if second is not None:
            joined = known if known is second else domain.join(known, second)
            if not joined.is_top:
                new.ranges[symbol] = joined
    new.held = a.held | b.held
    new.taints = dict(a.taints)
    for symbol, mask in b.taints.items():
        new.taints[symbol] = new.taints.get(symbol, 0) | mask
    pairs = _Pairs(a, b, new)
    new.regs = [x if x == y else pairs.value(x, y) for x, y in zip(a.regs[:16], b.regs[:16], strict=True)] + [0] * 16
    new.memory = {}
    new.shared = set()
    for region, cells in a.memory.items():
        theirs = b.memory.get(region)
        if theirs is None:
            continue
        if theirs is cells:
            new.memory[region] = cells
            for state in (a, b, new):
                state.shared.add(region)
            continue
        merged = {}
        for offset, cell in cells.items():
            their = theirs.get(offset)
            if their is cell or their == cell:
                merged[offset] = cell
            elif their is not None and their[0] == cell[0]:
                merged[offset] = (cell[0], pairs.value(cell[1], their[1]))
        new.memory[region] = merged
    new.origin = None
    if a.origin is not None and b.origin is not None and a.origin[0] is b.origin[0]:
        new.origin = (
            a.origin[0],
            pairs.value(a.origin[1], b.origin[1]),
            pairs.value(a.origin[2], b.origin[2]),
        )
    return new


class _Pairs:
    """Common values of pairs of values, the same for the same pair."""

    __slots__ = ("a", "b", "indicator", "known", "new")

    def __init__(self, a: State, b: State, new: State) -> None:
        self.a, self.b, self.new = a, b, new
        self.indicator: int | None = None
        self.known: dict[tuple[Value, Value], Value | None] = {}

    def value(self, x: Value, y: Value) -> Value:
        if x == y or self.b.pinned(x) == y:
            return x
        if self.a.pinned(y) == x:
            return y
        step = linear.sub(y, x)
        if type(step) is int and (type(x) is int or len(x) <= 2 * MOST_TERMS - 1):  # type: ignore[arg-type]
            if self.indicator is None:
                self.indicator = self.new.symbols.fresh()
                self.new.ranges[self.indicator] = domain.BIT
            return linear.add(x, linear.scale((0, self.indicator, 1), domain.signed(step)))
        offset = _common(x, y)
        key = (linear.sub(x, offset), linear.sub(y, offset))
        found = self.known.get(key)
        if found is None:
            found = self.known[key] = self._named(*key)
        if found is None:
            found = self.new.fresh(domain.join(self.a.range_of(key[0]), self.b.range_of(key[1])))
            found = self.new.tainted(found, self.a.mask(key[0]) | self.b.mask(key[1]))
            self.known[key] = found
        return linear.add(found, offset)


    def _named(self, x: Value, y: Value) -> Value | None:
        """The symbol that both states have come to express by others, and that is x in one and y in the other."""
        mine, theirs = self.a.pins, self.b.pins
        for symbol in mine.keys() & theirs.keys() if type(x) is not int and type(y) is not int else ():
            distance = linear.sub(x, mine[symbol])
            if type(distance) is int and distance == linear.sub(y, theirs[symbol]):
                return linear.add((0, symbol, 1), distance)
        return None


def _common(x: Value, y: Value) -> Value:
    """What is taken out of two values before their rest becomes one symbol: the first one's constant, and the
    frame's address."""
    offset: Value = x if type(x) is int else x[0]  # type: ignore[index]
    if linear.factor_of(x, FRAME) == 1 and linear.factor_of(y, FRAME) == 1:
        offset = linear.add(offset, (0, FRAME, 1))
    return offset


def join_all(states: Sequence[State]) -> State:
    """A state that holds all of a non-empty sequence."""
    result = states[0]
    for state in states[1:]:
        result = join(result, state)
    return result


@dataclass(slots=True)
class Header:
    """A loop header: `state` holds every visit; `kappa` is the symbol of the iteration number; `free` maps symbols
    of values without a constant step to (their value on entry, their value one iteration later in terms of this
    state or None)."""

    entry: State
    state: State
    kappa: int
    free: dict[int, tuple[Value, Value | None]] = field(default_factory=dict)
    steps: dict[int, Range] = field(default_factory=dict)
    """how far a free symbol moves from one iteration to the next"""

    def limit(self, most: int | None) -> None:
        """Consider the first `most` visits only (None: all)."""
        if most is None:
            self.state.ranges.pop(self.kappa, None)
            return
        self.state.ranges[self.kappa] = domain.between(0, most - 1) if most > 1 else domain.constant(0)

    def _give_up(self, place: Place, base: Value, entry_value: Value, known: Range, mask: int) -> None:
        symbol = self.state.symbols.fresh()
        if not known.is_top:
            self.state.ranges[symbol] = known
        self.free[symbol] = (entry_value, None)
        self.state.tainted((0, symbol, 1), mask)
        _put(self.state, place, linear.add(base, (0, symbol, 1)))


def _places(state: State) -> Iterator[tuple[Place, Value]]:
    for register in range(15):
        yield (-1, register), state.regs[register]
    for region, cells in list(state.memory.items()):
        for offset, (_, value) in list(cells.items()):
            yield (region, offset), value


def _get(state: State, place: Place, size: int) -> Value | None:
    if place[0] < 0:
        return state.regs[place[1]]
    cell = state.memory.get(place[0], {}).get(place[1])
    return cell[1] if cell is not None and cell[0] == size else None


def _put(state: State, place: Place, value: Value) -> None:
    if place[0] < 0:
        state.regs[place[1]] = value
    else:
        cells = state.cells(place[0])
        cells[place[1]] = (cells[place[1]][0], value)


def _size(state: State, place: Place) -> int:
    return 4 if place[0] < 0 else state.memory[place[0]][place[1]][0]


def generalise(entry: State, back: State, thresholds: Sequence[int]) -> Header:
    """The template of a header from the state on entry and the state after one iteration."""
    state = entry.copy()
    state.flags, state.origin = flags.ANY, None
    state.leaked, state.held = entry.leaked or back.leaked, entry.held | back.held
    kappa = state.symbols.fresh()
    header = Header(entry, state, kappa)
    for symbol, known in entry.ranges.items():
        other = back.ranges.get(symbol)
        if other is None:
            del state.ranges[symbol]
        elif other is not known:
            state.ranges[symbol] = domain.join(known, other)
    shared: dict[tuple[Value, Value], int] = {}
    for place, value in _places(entry):
        later = _get(back, place, _size(entry, place))
        if later is None:
            if place[0] >= 0:
                state.cells(place[0]).pop(place[1])
            continue
        if later in (value, back.pinned(value)):
            continue
        step = linear.sub(later, back.pinned(value))
        if type(step) is int and (type(value) is int or len(value) <= 2 * MOST_TERMS - 1):  # type: ignore[arg-type]
            _put(state, place, linear.add(value, linear.scale((0, kappa, 1), domain.signed(step))))
            continue
        offset = _common(value, later)
        key = (linear.sub(value, offset), linear.sub(later, offset))
        symbol = shared.get(key, 0)
        if not symbol:
            known = domain.widen(entry.range_of(key[0]), back.range_of(key[1]), thresholds)
            symbol = shared[key] = state.symbols.fresh()
            if not known.is_top:
                state.ranges[symbol] = known
            header.free[symbol] = (key[0], None)
            state.tainted((0, symbol, 1), entry.mask(key[0]) | back.mask(key[1]))
        _put(state, place, linear.add(offset, (0, symbol, 1)))
    return header


def fit(header: Header, back: State, thresholds: Sequence[int]) -> bool:
    """Check that one more iteration leads from the header back into it, and weaken the header where not; whether it
    did fit.

    Afterwards `free` holds the next value of each free symbol.
    """
    state, fits = header.state, True
    header.steps = {}
    next_kappa: Value = (1, header.kappa, 1)
    later_of: dict[int, Value] = {}
    if (back.leaked and not state.leaked) or back.held & ~state.held:
        state.leaked, state.held, fits = back.leaked or state.leaked, back.held | state.held, False
    for place, value in _places(state):
        if type(value) is int and _get(back, place, _size(state, place)) == value:
            continue
        later = _get(back, place, _size(state, place))
        if later is None:
            state.cells(place[0]).pop(place[1])
            fits = False
            continue
        expected = linear.substitute(value, header.kappa, next_kappa)
        mine = next((s for s in linear.symbols(value) if s in header.free), None)
        if mine is None:
            if later in (expected, back.pinned(expected)):
                continue
        else:
            moved = linear.sub(later, back.pinned(linear.sub(expected, (0, mine, 1))))
            if later_of.setdefault(mine, moved) == moved:
                continue
        fits = False
        at_entry = _get(header.entry, place, _size(state, place))
        assert at_entry is not None
        base = _common(at_entry, later)
        at_entry, rest = linear.sub(at_entry, base), linear.sub(later, base)
        known = domain.join(header.entry.range_of(at_entry), back.range_of(rest))
        known = domain.join(known, state.range_of(linear.sub(value, base)))
        header._give_up(place, base, at_entry, known, header.entry.mask(at_entry) | back.mask(rest))
    return _fit_ranges(header, back, later_of, thresholds) and fits


def _fit_ranges(header: Header, back: State, later_of: dict[int, Value], thresholds: Sequence[int]) -> bool:
    fits, state = True, header.state
    for symbol, (at_entry, _) in list(header.free.items()):
        later = later_of.get(symbol)
        header.free[symbol] = (at_entry, later)
        if later is not None:
            header.steps[symbol] = back.range_of(linear.sub(later, back.pinned((0, symbol, 1))))
        known = state.ranges.get(symbol, TOP)
        if later is not None and back.mask(later) & ~state.taints.get(symbol, 0) and known.span >= NARROW:
            fits = False
            state.tainted((0, symbol, 1), back.mask(later))
        if later is None or known.is_top:
            continue
        reached = back.range_of(later)
        if not domain.includes(known, reached):
            fits = False
            wider = domain.widen(known, reached, thresholds)
            if wider.is_top:
                del state.ranges[symbol]
            else:
                state.ranges[symbol] = wider
    for symbol in [s for s in state.ranges if s not in header.free and s != header.kappa]:
        other, known = back.ranges.get(symbol), state.ranges[symbol]
        if other is not None and not domain.includes(known, other):
            fits = False
            state.ranges[symbol] = domain.widen(known, other, thresholds)
    return fits


def narrow(header: Header, back: State) -> None:
    """Tighten the ranges of a header that fits, by one descending step: entry joined with what an iteration gives."""
    state = header.state
    for symbol, (at_entry, later) in header.free.items():
        if later is None:
            continue
        tight = domain.join(header.entry.range_of(at_entry), back.range_of(later))
        known = domain.meet(tight, state.ranges.get(symbol, TOP))
        if known is not None and not known.is_top:
            state.ranges[symbol] = known


def restrict(states: list[State], most: int) -> list[State]:
    """The same set of machine states in at most `most` abstract ones."""
    if len(states) <= most:
        return states
    return [*states[: most - 1], join_all(states[most - 1 :])]


__all__ = ["Header", "Range", "fit", "generalise", "join", "join_all", "narrow", "restrict"]
