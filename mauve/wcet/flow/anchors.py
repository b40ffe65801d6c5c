"""How far symbols are from each other: what intervals of single symbols lose where loops and joins name new ones.

An anchor of a symbol s is a pair (base, distance): s - base is one of `distance`, with `base` an expression of older
symbols. A text pointer behind a loop is then still "its value before, and so many bytes further", and "so many bytes
before the end", besides the interval it lies in. Anchors are never changed in place: a state that learns one gets a new
table.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from mauve.wcet.flow import domain, linear
from mauve.wcet.flow.domain import TOP, Range
from mauve.wcet.flow.linear import Value

if TYPE_CHECKING:
    from mauve.wcet.flow.state import State

Anchor = tuple[Value, Range]
Anchors = dict[int, tuple[Anchor, ...]]

NEAR = 1 << 20
"""A distance that varies by more is not worth remembering."""
MOST = 3
"""Anchors of one symbol."""
MOST_TRIED = 6
"""Symbols that two values are compared through."""
DEEPEST = 6
"""Anchors followed one after the other."""


def note(state: State, symbol: int, found: Iterable[Anchor]) -> None:
    """Remember anchors of a symbol, besides those known; of the same base both hold."""
    mine = dict(state.anchors.get(symbol, ()))
    before = dict(mine)
    for base, distance in found:
        if type(base) is tuple and base[0]:
            base, distance = (0, *base[1:]), domain.shift(distance, base[0])
        if distance.span >= NEAR or any(other >= symbol for other in linear.symbols(base)):
            continue
        known = mine.get(base)
        if known is not None:
            mine[base] = domain.meet(known, distance) or known
        elif len(mine) < MOST:
            mine[base] = distance
    if mine != before:
        state.anchors = {**state.anchors, symbol: tuple(mine.items())}


def learn(state: State, value: Value, known: Range) -> None:
    """A sum of several symbols is one of `known`: an anchor of the youngest."""
    if type(value) is int or len(value) < 5 or known.span >= NEAR:  # type: ignore[arg-type]
        return
    symbol, factor = value[-2], value[-1]  # type: ignore[index]
    if abs(factor) == 1 and not linear.is_entry_symbol(symbol):
        rest = linear.sub(value, (0, symbol, factor))
        note(state, symbol, [(linear.scale(rest, -factor), domain.scale(known, factor))])


def refined(state: State, value: Value, known: Range) -> Range:
    """The range of a sum of several symbols, whose own ranges add up to `known`, with anchored symbols written as
    what they are anchored to, the youngest first."""
    anchors, apart = state.anchors, domain.constant(0)
    for _ in range(DEEPEST):
        if type(value) is int:
            break
        assert type(value) is tuple
        found = next((i for i in range(len(value) - 2, 0, -2) if value[i] in anchors), 0)
        if not found:
            break
        symbol, factor = value[found], value[found + 1]
        rest = linear.sub(value, (0, symbol, factor))
        others = set(linear.symbols(rest))
        best: tuple[Range, Value, Range] | None = None
        for base, distance in anchors[symbol]:
            if best is not None and others.isdisjoint(linear.symbols(base)):
                continue
            there = linear.add(rest, linear.scale(base, factor))
            moved = domain.add(apart, domain.scale(distance, factor))
            total = domain.add(_plain(state, there), moved)
            if best is None or total.span < best[0].span:
                best = total, there, moved
        assert best is not None
        total, value, apart = best
        if total.span < known.span:
            known = total
    return known


def _plain(state: State, value: Value) -> Range:
    if type(value) is int:
        return domain.constant(value)
    assert type(value) is tuple
    total = domain.constant(value[0])
    for i in range(1, len(value), 2):
        total = domain.add(total, domain.scale(state.ranges.get(value[i], TOP), value[i + 1]))
    return total


def between(a: State, x: Value, b: State, y: Value) -> list[Anchor]:
    """Anchors for a symbol that is x in one state and y in another: the youngest symbols that both are near."""
    first, second = reached(a, x), reached(b, y)
    common = first | second if type(x) is int or type(y) is int else first & second
    found: list[Anchor] = []
    for symbol in sorted(common, reverse=True)[:MOST_TRIED]:
        base = linear.of_symbol(symbol)
        distance = a.range_of(linear.sub(x, base))
        if distance.span >= NEAR:
            continue
        distance = domain.join(distance, b.range_of(linear.sub(y, base)))
        if distance.span < NEAR:
            found.append((base, distance))
    return found[:MOST]


def reached(state: State, value: Value) -> set[int]:
    """The symbols in a value, and those that they are anchored to."""
    found = set(linear.symbols(value))
    if not state.anchors:
        return found
    waiting = list(found)
    while waiting and len(found) < 4 * MOST_TRIED:
        for base, _ in state.anchors.get(waiting.pop(), ()):
            for symbol in linear.symbols(base):
                if symbol not in found:
                    found.add(symbol)
                    waiting.append(symbol)
    return found


def joined(a: State, b: State) -> Anchors:
    """The anchors that hold in both states."""
    mine, theirs = a.anchors, b.anchors
    if mine is theirs:
        return mine
    found: Anchors = {}
    for symbol, anchors in mine.items():
        others = theirs.get(symbol)
        if others is anchors:
            found[symbol] = anchors
            continue
        table = dict(others or ())
        kept = []
        for base, distance in anchors:
            other = table.pop(base, None)
            kept += _both(base, distance, b.range_of(linear.sub((0, symbol, 1), base)) if other is None else other)
        for base, distance in table.items():
            kept += _both(base, distance, a.range_of(linear.sub((0, symbol, 1), base)))
        if kept:
            found[symbol] = tuple(kept[:MOST])
    for symbol in theirs.keys() - mine.keys():
        kept = []
        for base, distance in theirs[symbol]:
            kept += _both(base, distance, a.range_of(linear.sub((0, symbol, 1), base)))
        if kept:
            found[symbol] = tuple(kept)
    return found


def _both(base: Value, first: Range, second: Range) -> list[Anchor]:
    if second.span >= NEAR:
        return []
    distance = domain.join(first, second)
    return [(base, distance)] if distance.span < NEAR else []


def handed_on(state: State, symbol: int, value: Value) -> None:
    """`symbol` is written as `value` from now on: where that is one symbol and a constant, it inherits the anchors."""
    anchors = state.anchors.get(symbol)
    if anchors is None or type(value) is int or len(value) != 3 or value[2] != 1:  # type: ignore[arg-type, index]
        return
    heir, offset = value[1], value[0]  # type: ignore[index]
    if not linear.is_entry_symbol(heir):
        note(state, heir, [(linear.sub(base, offset), distance) for base, distance in anchors])


def shortened(value: Value, state: State) -> list[Anchor]:
    """Anchors for a sum that has grown too long: its symbols, as far as the rest is near them."""
    assert type(value) is tuple
    found = []
    for i in range(len(value) - 2, 0, -2):
        if value[i + 1] == 1:
            base = linear.of_symbol(value[i])
            found.append((base, state.range_of(linear.sub(value, base))))
    return [anchor for anchor in found if anchor[1].span < NEAR][:MOST]
