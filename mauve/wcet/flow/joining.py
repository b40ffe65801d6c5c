"""Upper bounds of states: the join of two, and the header of a loop as a template that each iteration must fit.

The join keeps linear relations: all values that differ by a constant between the two states share one indicator
symbol, 0 in the first state and 1 in the second. At a loop header the indicator becomes the number of the iteration
(kappa), so that a value with a constant step is `initial + step * kappa` and every header state carries the closed
form of its counters.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from math import gcd

from mauve.wcet.flow import anchors, domain, flags, linear
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
    new.anchors = anchors.joined(a, b)
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
            if type(found) is not int:
                near = anchors.between(self.a, key[0], self.b, key[1])
                anchors.note(self.new, linear.symbols(found)[0], near)
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
    state or None).

    Two things are claimed of a free symbol, each shown to hold one iteration later if both hold now: that it lies in
    its range of `within`, and that it moves by one of `claims` (None: nothing is). After k iterations of such steps it
    is k of them away from its first value; where it only moves one way and cannot go around, no more than its range is
    wide."""

    entry: State
    state: State
    kappa: int
    free: dict[int, tuple[Value, Value | None]] = field(default_factory=dict)
    steps: dict[int, Range] = field(default_factory=dict)
    """how far a free symbol moves from one iteration to the next"""
    within: dict[int, Range] = field(default_factory=dict)
    claims: dict[int, Range | None] = field(default_factory=dict)
    broken: dict[int, int] = field(default_factory=dict)
    """how often a claim about steps had to be weakened"""
    facts: list[tuple[Value, Range]] = field(default_factory=list)
    """expressions in kappa and older symbols, and what they are on every visit"""
    apart: dict[int, dict[Value, Range]] = field(default_factory=dict)
    """how far a free symbol is from values that the loop does not change and compares with"""

    def limit(self, most: int | None) -> None:
        """Consider the first `most` visits only (None: all)."""
        for symbol, (at_entry, _) in self.free.items():
            self._confine(symbol, at_entry, most)
        for value, known in self.facts:
            anchors.learn(self.state, value, known)
        if most is None:
            self.state.ranges.pop(self.kappa, None)
            return
        self.state.ranges[self.kappa] = domain.between(0, most - 1) if most > 1 else domain.constant(0)

    def _confine(self, symbol: int, at_entry: Value, most: int | None) -> None:
        """Give a free symbol the range that follows from what is claimed of it in the first `most` visits."""
        state, known, claim = self.state, self.within.get(symbol, TOP), self.claims.get(symbol)
        apart = self.apart.get(symbol, {})
        room = min((known, *apart.values()), key=lambda one: one.span)
        distance = None if claim is None else _moved(claim, most, room)
        state.anchors = {s: anchor for s, anchor in state.anchors.items() if s != symbol}
        if distance is not None:
            known = domain.meet(domain.add(self.entry.range_of(at_entry), distance), known) or known
            anchors.note(state, symbol, [(at_entry, distance)])
        anchors.note(state, symbol, apart.items())
        if known.is_top:
            state.ranges.pop(symbol, None)
        else:
            state.ranges[symbol] = known

    def claim(self, symbol: int, step: Range) -> bool:
        """Hold a step against what is claimed; whether that agrees. A claim that fails often is given up."""
        before = self.claims.get(symbol, step)
        if before is None:
            return True
        if symbol not in self.claims:
            self.claims[symbol] = step if step.span < MOST_STEP else None
            return True
        if domain.includes(before, step):
            return True
        wider = domain.join(before, step)
        self.broken[symbol] = self.broken.get(symbol, 0) + 1
        self.claims[symbol] = wider if wider.span < MOST_STEP and self.broken[symbol] <= MOST_BROKEN else None
        return False

    def keep_apart(self, symbol: int, later: Value, back: State) -> bool:
        """Hold the next value of a free symbol against what is claimed of its distances; whether that agrees."""
        table, agrees = self.apart.get(symbol, {}), True
        for base, known in list(table.items()):
            reached = back.range_of(linear.sub(later, base))
            if not domain.includes(known, reached):
                agrees = False
                wider = domain.widen(known, reached, _AROUND_ZERO)
                if wider.span < anchors.NEAR:
                    table[base] = wider
                else:
                    del table[base]
        return agrees

    def _give_up(self, place: Place, base: Value, entry_value: Value, known: Range, mask: int) -> None:
        symbol = self.state.symbols.fresh()
        if not known.is_top:
            self.state.ranges[symbol] = self.within[symbol] = known
        self.free[symbol] = (entry_value, None)
        self.state.tainted((0, symbol, 1), mask)
        _put(self.state, place, linear.add(base, (0, symbol, 1)))


MOST_STEP, MOST_BROKEN = 1 << 16, 3
MOST_BASES = 3
_AROUND_ZERO = sorted(
    number & domain.MASK
    for number in {0, 1, 2, -1, -2, domain.SIGN} | {sign * (1 << k) for k in range(2, 20) for sign in (1, -1)}
)


def _moved(step: Range, most: int | None, known: Range) -> Range | None:
    """How far repeated steps lead from the first value: in the first `most` visits, or without leaving `known` on a way
    that never turns back and is too short to go around the circle."""
    low, high = step.signed_bounds()
    stride = gcd(low, high, step.step)
    if not stride:
        return domain.constant(0)
    found = None
    if most is not None and (high - low) * most < domain.SIGN and max(-low, high) * most < domain.SIGN:
        first, last = min(low, 0) * (most - 1), max(high, 0) * (most - 1)
        found = domain.progression(first, stride, (last - first) // stride)
    if known.span + max(high, -low) < domain.MODULUS and (low >= 0 or high <= 0):
        span = known.span // stride
        way = domain.progression(0 if low >= 0 else -span * stride, stride, span)
        found = way if found is None or way.span < found.span else found
    return found


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


def forget(state: State, place: Place, mask: int) -> None:
    """Make a place unknown; `mask` says of which addresses it may be computed (State.mask)."""
    if place[0] >= 0:
        if place[1] in state.memory.get(place[0], {}):
            state.cells(place[0]).pop(place[1])
        return
    state.regs[place[1]] = (0, state.symbols.fresh(), 1)
    state.tainted(state.regs[place[1]], mask)


def unmoved(state: State, back: State, moving: dict[Place, int]) -> bool:
    """Whether one iteration from a header leaves every place as it was, but for those in `moving`, which the header
    does not know. Else they join `moving` with their masks, and the header forgets them."""
    agrees = True
    if (back.leaked and not state.leaked) or back.held & ~state.held:
        state.leaked, state.held, agrees = back.leaked or state.leaked, back.held | state.held, False
    for place, value in _places(state):
        later = _get(back, place, _size(state, place))
        if later is not None and later in (value, back.pinned(value)):
            continue
        before = moving.get(place, 0)
        mask = before | state.mask(value) | (0 if later is None else back.mask(later))
        if place in moving and mask == before:
            continue
        if linear.is_entry_symbol(place[0]):  # others mean something else the next time
            moving[place] = mask
        forget(state, place, mask)
        agrees = False
    return agrees


def generalise(entry: State, back: State, thresholds: Sequence[int], limits: Sequence[Value] = ()) -> Header:
    """The template of a header from the state on entry and the state after one iteration. `limits` are values that stay
    as they are and that the loop compares with."""
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
                state.ranges[symbol] = header.within[symbol] = known
            header.free[symbol] = (key[0], None)
            header.claim(symbol, back.range_of(step))
            header.apart[symbol] = {
                base: known
                for base in limits[:MOST_BASES]
                if not linear.factor_of(base, symbol)
                and (known := _apart(entry, key[0], back, key[1], base)).span < anchors.NEAR
            }
            state.tainted((0, symbol, 1), entry.mask(key[0]) | back.mask(key[1]))
        _put(state, place, linear.add(offset, (0, symbol, 1)))
    return header


def _apart(entry: State, first: Value, back: State, later: Value, base: Value) -> Range:
    """How far a value is from `base`, on entry and one iteration later."""
    known = entry.range_of(linear.sub(first, base))
    if known.span >= anchors.NEAR:
        return TOP
    return domain.widen(known, back.range_of(linear.sub(later, base)), _AROUND_ZERO)


def fit(header: Header, back: State, thresholds: Callable[[int], Sequence[int]]) -> bool:
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


def _fit_ranges(
    header: Header, back: State, later_of: dict[int, Value], thresholds: Callable[[int], Sequence[int]]
) -> bool:
    fits, state = True, header.state
    for symbol, (at_entry, _) in list(header.free.items()):
        later = later_of.get(symbol)
        header.free[symbol] = (at_entry, later)
        if later is None:
            continue
        step = header.steps[symbol] = back.range_of(linear.sub(later, back.pinned((0, symbol, 1))))
        fits = header.claim(symbol, step) and fits
        fits = header.keep_apart(symbol, later, back) and fits
        known = state.ranges.get(symbol, TOP)
        if back.mask(later) & ~state.taints.get(symbol, 0) and known.span >= NARROW:
            fits = False
            state.tainted((0, symbol, 1), back.mask(later))
        known = header.within.get(symbol, TOP)
        reached = back.range_of(later)
        if not domain.includes(known, reached):
            fits = False
            header.within[symbol] = domain.widen(known, reached, thresholds(symbol))
    for symbol in [s for s in state.ranges if s not in header.free and s != header.kappa]:
        other, known = back.ranges.get(symbol), state.ranges[symbol]
        if other is not None and not domain.includes(known, other):
            fits = False
            state.ranges[symbol] = domain.widen(known, other, thresholds(symbol))
    return fits


def narrow(header: Header, back: State) -> None:
    """Tighten what is claimed of the free symbols of a header that fits, by one descending step: what holds on every
    visit holds on entry or after one more iteration."""
    for symbol, (at_entry, later) in header.free.items():
        if later is None:
            continue
        step = header.steps[symbol] = back.range_of(linear.sub(later, back.pinned((0, symbol, 1))))
        if step.span < MOST_STEP:
            header.claims[symbol] = step
        tight = domain.join(header.entry.range_of(at_entry), back.range_of(later))
        known = header.within.get(symbol, TOP)
        header.within[symbol] = domain.meet(tight, known) or known
        table = header.apart.get(symbol, {})
        for base, distance in list(table.items()):
            first = header.entry.range_of(linear.sub(at_entry, base))
            tight = domain.join(first, back.range_of(linear.sub(later, base)))
            table[base] = domain.meet(tight, distance) or distance


def one_way(header: Header, symbol: int) -> int | None:
    """How often a header that fits is visited at most, by a free symbol that moves one way in a range that is too short
    to go around the circle, or that keeps such a distance to a value that stays."""
    claim, (at_entry, later) = header.claims.get(symbol), header.free[symbol]
    low, high = (0, 0) if claim is None else claim.signed_bounds()
    if later is None or low <= 0 <= high:
        return None
    bounds = []
    distances = [(0, header.within.get(symbol, TOP)), *header.apart.get(symbol, {}).items()]
    for base, known in distances:
        first = header.entry.range_of(linear.sub(at_entry, base))
        if known.span + max(high, -low) >= domain.MODULUS or not domain.includes(_whole(known), _whole(first)):
            continue
        start = (first.low - known.low) & domain.MASK
        left = known.span - start if low > 0 else start + first.span
        bounds.append(left // (low if low > 0 else -high) + 1)
    return min(bounds, default=None)


def _whole(known: Range) -> Range:
    return domain.between(known.low, known.low + known.span)


def restrict(states: list[State], most: int) -> list[State]:
    """The same set of machine states in at most `most` abstract ones."""
    if len(states) <= most:
        return states
    return [*states[: most - 1], join_all(states[most - 1 :])]


__all__ = ["Header", "Range", "fit", "generalise", "join", "join_all", "narrow", "one_way", "restrict"]
