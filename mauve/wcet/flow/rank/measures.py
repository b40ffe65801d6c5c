"""What relations say about ranges: refine intervals of atoms and of linear terms by the facts that hold on a path."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow.locations import HALF, WORD, Interval
from mauve.wcet.flow.rank.terms import (
    ZERO,
    Apply,
    Atom,
    Kind,
    Ranges,
    Relation,
    Term,
    add,
    apply_bounds,
    atom,
    bounds,
    compute,
    interval,
    meet,
    number,
    scale,
    signed,
)

Parts = frozenset[tuple[Atom, int]]


class Contradiction(Exception):
    """Facts that cannot hold together: the path they describe is never taken."""


@dataclass(slots=True)
class Knowledge:
    """Intervals of atoms (`base`, refined in `atoms`) and of linear terms without their constant (`terms`)."""

    base: Ranges
    atoms: dict[Atom, Interval] = field(default_factory=dict)
    terms: dict[Parts, Interval] = field(default_factory=dict)

    def of_atom(self, of: Atom) -> Interval:
        """What is known of an atom."""
        known = self.atoms.get(of)
        best = self.base(of) if known is None else meet(known, self.base(of))
        if isinstance(of, Apply) and of.args[0].parts in self.terms:
            second = self.of_term(of.args[1]) if len(of.args) > 1 else Interval(0, 0)
            best = meet(best, apply_bounds(of.op, self.of_term(of.args[0]), second))
        return best

    def of_term(self, term: Term) -> Interval:
        """What is known of a term."""
        best = correlated_bounds(term, self.of_atom)
        known = self.terms.get(term.parts)
        if known is not None:
            best = meet(best, shift(known, term.constant))
        opposite = self.terms.get(scale(term, -1).parts) if self.terms else None
        if opposite is not None:
            best = meet(best, interval(term.constant - opposite.high, term.constant - opposite.low))
        return best

    def narrow(self, term: Term, to: Interval) -> None:
        """Learn that the term's value lies in `to`."""
        if term.is_constant:
            if not contains(to, term.constant):
                raise Contradiction
            return
        before = self.of_term(term)
        after = intersection(before, to)
        if after is None:
            raise Contradiction
        moved = shift(after, -term.constant)
        if len(term.parts) == 1:
            ((of, coefficient),) = term.parts
            if coefficient == 1:
                self.atoms[of] = moved
                return
            self._narrow_multiple(of, signed(coefficient), moved)
        self.terms[term.parts] = moved

    def _narrow_multiple(self, of: Atom, factor: int, to: Interval) -> None:
        """Learn that factor * atom lies in `to`, where the product does not wrap."""
        if factor < 0:
            factor, to = -factor, interval(-to.high, -to.low)
        (low, high), (least, most) = self.of_atom(of).unsigned, to.unsigned
        if high * factor < WORD:
            low, high = max(low, -(-least // factor)), min(high, most // factor)
            if low > high:
                raise Contradiction
            self.atoms[of] = Interval(low, high)


def shift(of: Interval, by: int) -> Interval:
    """The interval of v + by."""
    return interval(of.low + by, of.high + by)


def contains(of: Interval, value: int) -> bool:
    """Whether the interval holds the 32-bit value."""
    return (value - of.low) % WORD <= of.high - of.low


def intersection(a: Interval, b: Interval) -> Interval | None:
    """An interval around the common part, None when there is none."""
    if not (contains(a, b.low) or contains(b, a.low)):
        return None
    return meet(a, b)


def learn(knowledge: Knowledge, relations: Iterable[Relation], rounds: int = 2) -> Knowledge:
    """Narrow `knowledge` by relations that hold; raises Contradiction when they cannot."""
    listed = list(relations)
    for _ in range(rounds):
        for relation in listed:
            _learn(knowledge, relation)
    return knowledge


def _learn(knowledge: Knowledge, relation: Relation) -> None:
    a, b = relation.a, relation.b
    if relation.kind is Kind.EQ and b == ZERO:
        _learn_masked(knowledge, a)
    left, right = knowledge.of_term(a), knowledge.of_term(b)
    if relation.kind is Kind.NE:
        _exclude(knowledge, a, right)
        _exclude(knowledge, b, left)
        _exclude(knowledge, add(a, b, -1), Interval(0, 0))
        return
    knowledge.narrow(a, arc(relation.kind, right))
    knowledge.narrow(b, mirrored_arc(relation.kind, knowledge.of_term(a)))
    difference = add(a, b, -1)
    if relation.kind is Kind.EQ:
        knowledge.narrow(difference, Interval(0, 0))
        return
    # With both sides in a half-range their difference does not wrap, and the relation is one about the difference.
    left, right = knowledge.of_term(a), knowledge.of_term(b)
    is_signed = relation.kind in (Kind.SLT, Kind.SGE)
    (al, ah), (bl, bh) = (left.signed, right.signed) if is_signed else (left.unsigned, right.unsigned)
    low, high = al - bh, ah - bl
    if relation.kind in (Kind.SLT, Kind.ULT):
        high = min(high, -1)
    else:
        low = max(low, 0)
    if low > high:
        raise Contradiction
    if high - low < WORD - 1:
        knowledge.narrow(difference, interval(low, high))
    if relation.kind in (Kind.SLT, Kind.ULT):
        _exclude(knowledge, difference, Interval(0, 0))


def _learn_masked(knowledge: Knowledge, masked: Term) -> None:
    """x & mask == 0 where the mask is the top bits: x is below the lowest of them."""
    if len(masked.parts) != 1 or masked.constant:
        return
    ((of, factor),) = masked.parts
    if factor == 1 and isinstance(of, Apply) and of.op is Op.AND and of.args[1].is_constant:
        rest = WORD - 1 - of.args[1].constant
        if rest & (rest + 1) == 0:
            knowledge.narrow(of.args[0], Interval(0, rest))


def _exclude(knowledge: Knowledge, term: Term, value: Interval) -> None:
    """Learn that the term is not the one value of `value`, if that shows at an end of its range."""
    if value.low != value.high:
        return
    known = knowledge.of_term(term)
    low, high = known.low, known.high
    if (low - value.low) % WORD == 0:
        low += 1
    elif (high - value.low) % WORD == 0 and high > low:
        high -= 1
    else:
        return
    if low > high:
        raise Contradiction
    knowledge.narrow(term, interval(low, high))


def hull(arcs: list[Interval]) -> Interval:
    """A small arc around all, tried from each of their ends."""
    best = Interval(0, WORD - 1)
    for start in arcs:
        length = max((a.low - start.low) % WORD + a.high - a.low for a in arcs)
        if length < best.high - best.low:
            best = interval(start.low, start.low + length)
    return best


def arc(kind: Kind, limit: Interval) -> Interval:
    """The values a for which `a kind b` holds for some b in `limit`; raises Contradiction when there are none."""
    low, high = limit.signed if kind in (Kind.SLT, Kind.SGE) else limit.unsigned
    match kind:
        case Kind.EQ:
            return limit
        case Kind.ULT:
            return _proper(0, high - 1)
        case Kind.UGE:
            return _proper(low, WORD - 1)
        case Kind.SLT:
            return _proper(-HALF, high - 1)
        case Kind.SGE:
            return _proper(low, HALF - 1)
        case _:
            return Interval(0, WORD - 1)


def mirrored_arc(kind: Kind, limit: Interval) -> Interval:
    """The values b for which `a kind b` holds for some a in `limit`."""
    low, high = limit.signed if kind in (Kind.SLT, Kind.SGE) else limit.unsigned
    match kind:
        case Kind.EQ:
            return limit
        case Kind.ULT:
            return _proper(low + 1, WORD - 1)
        case Kind.UGE:
            return _proper(0, high)
        case Kind.SLT:
            return _proper(low + 1, HALF - 1)
        case Kind.SGE:
            return _proper(-HALF, high)
        case _:
            return Interval(0, WORD - 1)


def _proper(low: int, high: int) -> Interval:
    if low > high:
        raise Contradiction
    return Interval(low, high)


def correlated_bounds(term: Term, ranges: Ranges) -> Interval:
    """`bounds`, tighter where the term holds x and x >> k: c*x + d*(x >> k) grows with x when c >= 0 and c + d >= 0."""
    plain = _remainder_bounds(term, ranges, bounds(term, ranges))
    coefficients = dict(term.parts)
    for part, factor in term.parts:
        if not (isinstance(part, Apply) and part.op in (Op.LSR, Op.ASR) and part.args[1].is_constant):
            continue
        inner = part.args[0]
        if inner.constant or len(inner.parts) != 1:
            continue
        ((of, one),) = inner.parts
        c, d = signed(coefficients.get(of, 0)), signed(factor)
        low, high = ranges(of).unsigned
        if one != 1 or c <= 0 or c + d < 0 or high >= HALF:
            continue
        amount = min(part.args[1].constant & 0xFF, 31)
        ends = [c * v + d * (v >> amount) for v in (low, high)]
        rest = Term(term.constant, frozenset(p for p in term.parts if p[0] not in (of, part)), term.size)
        others = bounds(rest, ranges)
        plain = meet(plain, interval(ends[0] + others.low, ends[1] + others.high))
    return plain


def _remainder_bounds(term: Term, ranges: Ranges, plain: Interval) -> Interval:
    """Tighter where the term holds x - d * (x / d), unsigned: that is less than d."""
    for part, factor in term.parts:
        if not (isinstance(part, Apply) and part.op is Op.UDIV and part.args[1].is_constant):
            continue
        x, divisor = part.args[0], part.args[1].constant
        if divisor and signed(factor) == -divisor:
            rest = add(add(term, x, -1), atom(part), divisor)
            if part not in dict(rest.parts) and rest.size < term.size:
                others = bounds(rest, ranges)
                high = min(divisor - 1, bounds(x, ranges).unsigned[1])
                plain = meet(plain, interval(others.low, others.high + high))
    return plain


def pull_halves(term: Term, ranges: Ranges) -> Term:
    """The term with whole parts moved out of shifts: (2x + w) >> 1 = x + (w >> 1), where 2x + w does not wrap."""
    result = number(term.constant)
    for part, factor in term.parts:
        result = add(result, _pulled(part, ranges), factor)
    return result


def _pulled(part: Atom, ranges: Ranges) -> Term:
    if not (isinstance(part, Apply) and part.op in (Op.LSR, Op.ASR) and part.args[1].is_constant):
        return atom(part)
    amount = part.args[1].constant & 0xFF
    inner = part.args[0]
    inner = Term(inner.constant, frozenset(p for p in inner.parts if not _is_zero(p[0], ranges)), inner.size)
    unit = 1 << amount
    low, high = _integer_bounds(inner, ranges, part.op)
    fits = low >= -HALF and high < HALF if part.op is Op.ASR else low >= 0 and high < WORD
    if not fits or not 0 < amount < 31:
        return atom(part)
    whole = {of: signed(c) // unit for of, c in inner.parts if signed(c) % unit == 0}
    outside = number(0)
    for of, c in whole.items():
        outside = add(outside, atom(of), c)
    rest = Term(inner.constant, frozenset(p for p in inner.parts if p[0] not in whole), inner.size)
    low, high = _integer_bounds(rest, ranges, part.op)
    if low < -HALF or high >= WORD or (low < 0 and high >= HALF):
        return atom(part)
    remaining = compute(Op.ASR if high < HALF else Op.LSR, rest, part.args[1])
    return atom(part) if remaining is None else add(outside, remaining)


def _integer_bounds(term: Term, ranges: Ranges, op: Op) -> tuple[int, int]:
    """The bounds of the term as an integer, its atoms read as the shift reads its operand."""
    low = high = signed(term.constant)
    for of, coefficient in term.parts:
        known = ranges(of)
        least, greatest = known.signed if op is Op.ASR else known.unsigned
        ends = (signed(coefficient) * least, signed(coefficient) * greatest)
        low, high = low + min(ends), high + max(ends)
    return low, high


def _is_zero(of: Atom, ranges: Ranges) -> bool:
    known = ranges(of)
    if isinstance(of, Apply):
        known = meet(known, bounds(atom(of), ranges))
    return known.low % WORD == 0 and known.high == known.low


def lookup(table: Mapping[Atom, Interval], otherwise: Ranges) -> Ranges:
    """Ranges from a table, and from `otherwise` for what is not in it."""

    def ranges(of: Atom) -> Interval:
        known = table.get(of)
        return otherwise(of) if known is None else known

    return ranges
