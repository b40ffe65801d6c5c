"""Loop bounds in closed form, from the conditions under which a loop goes on.

At a branch that every iteration passes, both sides of the compare are linear in the number of the iteration (kappa)
and in symbols that stay the same or move by a known step. Solved as in the affine method of data-flow loop analysis,
with wrap-around excluded explicitly; an equality is solved by divisibility.
"""

from __future__ import annotations

from dataclasses import dataclass

from mauve.wcet.binary.microop import Condition, FlagKind
from mauve.wcet.flow import domain, linear
from mauve.wcet.flow.domain import MASK, MODULUS, SIGN, Range
from mauve.wcet.flow.joining import Header
from mauve.wcet.flow.linear import Value
from mauve.wcet.flow.state import State

MOST = 1 << 20
"""A bound above this only reflects the range of a type: it counts as none (semantics, section 5)."""


@dataclass(frozen=True, slots=True)
class Stay:
    """The loop goes on from this branch only if `condition` of the compare (kind, a, b) holds in `state`."""

    condition: Condition
    kind: FlagKind
    a: Value
    b: Value
    state: State


def visits(header: Header, stays: list[Stay]) -> int | None:
    """The most executions of the header per entry that some branch passed in every iteration allows."""
    bounds = [bound for stay in stays if (bound := _visits(header, stay)) is not None and bound <= MOST]
    return min(bounds, default=None)


def distances(header: Header, stays: list[Stay]) -> list[tuple[Value, Range]]:
    """Differences that count down to the visit in which they are zero, and what they may be on every visit."""
    found = []
    for stay in stays:
        difference = linear.sub(stay.a, stay.b)
        step = linear.factor_of(difference, header.kappa)
        if stay.condition is Condition.NE and _until_equal(header, stay.state, difference) is not None:
            if step > 0:
                difference, step = linear.scale(difference, -1), -step
            first = stay.state.range_of(linear.substitute(difference, header.kappa, 0))
            found.append((difference, domain.progression(0, -step, (first.low + first.span) // -step)))
    return found


def _visits(header: Header, stay: Stay) -> int | None:
    a, b, condition = stay.a, stay.b, stay.condition
    if condition in (Condition.MI, Condition.PL) or stay.kind is FlagKind.LOGIC:
        a, b = linear.sub(a, b), 0
        match condition:
            case Condition.MI:
                condition = Condition.LT
            case Condition.PL:
                condition = Condition.GE
            case Condition.EQ | Condition.NE:
                pass
            case _:
                return None
    match condition:
        case Condition.NE:
            return _until_equal(header, stay.state, linear.sub(a, b))
        case Condition.EQ:
            return _while_equal(header, linear.sub(a, b))
        case Condition.LT | Condition.CC:
            return _ordered(header, stay, a, b, 1, condition is Condition.LT)
        case Condition.LE | Condition.LS:
            return _ordered(header, stay, a, b, 0, condition is Condition.LE)
        case Condition.GT | Condition.HI:
            return _ordered(header, stay, b, a, 1, condition is Condition.GT)
        case Condition.GE | Condition.CS:
            return _ordered(header, stay, b, a, 0, condition is Condition.GE)
        case _:
            return None


def _steady(header: Header, value: Value) -> bool:
    """Whether the value depends on kappa and on what is the same in all iterations only: symbols older than kappa."""
    return all(symbol <= header.kappa for symbol in linear.symbols(value))


def _until_equal(header: Header, state: State, difference: Value) -> int | None:
    """Goes on while initial + step * kappa != 0: ends where kappa is -initial / step, if that is always a whole
    number."""
    step = linear.factor_of(difference, header.kappa)
    if step == 0 or not _steady(header, difference):
        return None
    initial = linear.substitute(difference, header.kappa, 0)
    if step > 0:
        initial = linear.scale(initial, -1)
    distance = state.range_of(initial)
    step = abs(step)
    if distance.low + distance.span >= MODULUS:
        return None
    if distance.low % step or (distance.n and distance.step % step):
        return None
    return (distance.low + distance.span) // step + 1


def _while_equal(header: Header, difference: Value) -> int | None:
    """Goes on while initial + step * kappa == 0: never twice in a row."""
    step = linear.factor_of(difference, header.kappa)
    return 2 if step and _steady(header, difference) else None


@dataclass(frozen=True, slots=True)
class _Side:
    """One side of an order as a sequence of integers: where it starts, how far it moves per iteration."""

    low: int
    high: int
    slowest: int
    fastest: int


def _side(header: Header, state: State, value: Value, as_signed: bool) -> _Side:
    """The side as it moves; where that is not known, as a number somewhere in its range in every iteration."""
    moving = _moving(header, state, value)
    start, slowest, fastest = (state.range_of(value), 0, 0) if moving is None else moving
    low, high = start.signed_bounds() if as_signed else start.unsigned_bounds()
    return _Side(low, high, slowest, fastest)


def _moving(header: Header, state: State, value: Value) -> tuple[Range, int, int] | None:
    """(values in the first iteration, least and greatest step) of a value that moves by known steps.

    Besides kappa it may hold one free symbol of the header, as it is in this iteration or as it will be in the next.
    """
    found = _free_part(header, value)
    if found is None:
        return None
    rest, start, step = found
    rate = linear.factor_of(rest, header.kappa)
    initial = domain.add(state.range_of(linear.substitute(rest, header.kappa, 0)), start)
    low, high = step.signed_bounds()
    return (initial, rate + low, rate + high) if high - low < MOST else None


_NOTHING = domain.constant(0)


def _free_part(header: Header, value: Value) -> tuple[Value, Range, Range] | None:
    """(the steady part, the first values of the rest, its steps) of a value."""
    if _steady(header, value):
        return value, _NOTHING, _NOTHING
    for symbol, (at_entry, later) in header.free.items():
        step = header.steps.get(symbol)
        if later is None or step is None:
            continue
        first = header.entry.range_of(at_entry)
        rest = linear.sub(value, later)
        if _steady(header, rest):
            return rest, domain.add(first, step), step
        factor = linear.factor_of(value, symbol)
        rest = linear.substitute(value, symbol, 0)
        if factor and _steady(header, rest):
            return rest, domain.scale(first, factor), domain.scale(step, factor)
    return None


def _ordered(header: Header, stay: Stay, a: Value, b: Value, strict: int, as_signed: bool) -> int | None:
    """Goes on while a + strict <= b. Also, where strict, ends if a and b meet exactly."""
    bounds = [_until_equal(header, stay.state, linear.sub(a, b)) if strict else None]
    lower, upper = _side(header, stay.state, a, as_signed), _side(header, stay.state, b, as_signed)
    bounds.append(_closing(lower, upper, strict, as_signed))
    return min((bound for bound in bounds if bound is not None), default=None)


def _closing(lower: _Side, upper: _Side, strict: int, as_signed: bool) -> int | None:
    least, most = (-SIGN, SIGN - 1) if as_signed else (0, MASK)
    closing = lower.slowest - upper.fastest
    if closing <= 0:
        return None
    gap = upper.high - strict - lower.low
    if gap < 0:
        return 1
    rounds = gap // closing + 1
    if rounds > MOST:
        return None
    # As long as the loop went on, lower + strict <= upper held; one more step must not leave the numbers of the type.
    highest = upper.high + max(0, upper.fastest) * rounds - strict + max(0, lower.fastest)
    lowest = lower.low + min(0, lower.slowest) * rounds + strict + min(0, upper.slowest)
    if highest > most or lowest < least:
        return None
    if upper.high + max(0, upper.fastest) * rounds > most or lower.low + min(0, lower.slowest) * rounds < least:
        return None
    return rounds + 1
