"""What conditions say of values: for each term the numbers that it may have, for each pair of terms their order.

A fact is a key and what is allowed for it. Facts of one key are sets, so they are intersected where all hold, united
where one of them holds, and contradict each other exactly when nothing is left.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from mauve.wcet.flow.locations import HALF, WORD
from mauve.wcet.flow.rank.terms import (
    Atom,
    Fresh,
    Kind,
    Relation,
    Term,
    Truth,
    number,
    scale,
    subtract,
)

MOST_PIECES = 40
"""Intervals that a set of numbers is made of at most; greater sets are not kept."""
MOST_FACTS = 64
"""Facts that hold together at most; the first ones are forgotten."""
DEEPEST = 16
"""Atoms of a term at most."""


@dataclass(frozen=True, slots=True)
class ValueKey:
    """The value of a linear term without its constant."""

    parts: frozenset[tuple[Atom, int]]


@dataclass(frozen=True, slots=True)
class OrderKey:
    """How two terms are ordered, as signed or as unsigned numbers."""

    signed: bool
    a: Term
    b: Term


Key = ValueKey | OrderKey

Numbers = tuple[tuple[int, int], ...]
"""Disjoint intervals of numbers from 0 to 2**32 - 1, both ends included, in order; of an order: 0 less, 1 equal, 2
greater."""

Facts = dict[Key, Numbers]

_ORDERS: Mapping[Kind, Numbers] = {
    Kind.EQ: ((1, 1),),
    Kind.NE: ((0, 0), (2, 2)),
    Kind.ULT: ((0, 0),),
    Kind.SLT: ((0, 0),),
    Kind.UGE: ((1, 2),),
    Kind.SGE: ((1, 2),),
}


def between(low: int, high: int) -> Numbers:
    """The numbers from `low` to `high` modulo 2**32."""
    if high - low >= WORD - 1:
        return ((0, WORD - 1),)
    if high < low:
        return ()
    low, high = low % WORD, high % WORD
    return ((low, high),) if low <= high else ((0, high), (low, WORD - 1))


def common(a: Numbers, b: Numbers) -> Numbers:
    """The numbers in both sets."""
    found = []
    i = j = 0
    while i < len(a) and j < len(b):
        low, high = max(a[i][0], b[j][0]), min(a[i][1], b[j][1])
        if low <= high:
            found.append((low, high))
        if a[i][1] < b[j][1]:
            i += 1
        else:
            j += 1
    return tuple(found)


def united(a: Numbers, b: Numbers) -> Numbers:
    """The numbers in one of the sets."""
    found: list[tuple[int, int]] = []
    for low, high in sorted((*a, *b)):
        if found and low <= found[-1][1] + 1:
            found[-1] = (found[-1][0], max(found[-1][1], high))
        else:
            found.append((low, high))
    return tuple(found)


def moved(numbers: Numbers, by: int) -> Numbers:
    """Every number plus `by`, modulo 2**32."""
    result: Numbers = ()
    for low, high in numbers:
        result = united(result, between(low + by, high + by))
    return result


Choices = Callable[[Fresh], "tuple[Relation, Term, Term] | None"]
"""For a value chosen by a condition: the condition, the value where it holds, and the value where it does not."""


def nothing_chosen(of: Fresh) -> None:
    """No value is chosen by a condition."""
    return


def facts_of(relations: Iterable[Relation], choices: Choices = nothing_chosen) -> Facts:
    """What relations that hold together say. An empty set of numbers: they cannot hold together."""
    found: Facts = {}
    for relation in relations:
        _add(found, relation, choices, 3)
    return found


def _add(found: Facts, relation: Relation, choices: Choices, depth: int) -> None:
    kind, a, b = relation.kind, relation.a, relation.b
    if a.size + b.size > DEEPEST:
        return
    if b.is_constant or kind in (Kind.EQ, Kind.NE):
        difference = subtract(a, b) if kind in (Kind.EQ, Kind.NE) else a
        limit = 0 if kind in (Kind.EQ, Kind.NE) else b.constant
        _add_value(found, difference, _right_of(kind, limit), choices, depth)
    elif a.is_constant:
        _add_value(found, b, _left_of(kind, a.constant), choices, depth)
    if a.is_constant or b.is_constant:
        return
    for is_signed in (False, True):
        if kind in (Kind.EQ, Kind.NE) or is_signed is (kind in (Kind.SLT, Kind.SGE)):
            _narrow(found, *_ordered(is_signed, a, b, _ORDERS[kind]))
    if kind in (Kind.ULT, Kind.SLT):
        _add_value(found, subtract(a, b), between(1, WORD - 1), choices, depth)


def _right_of(kind: Kind, limit: int) -> Numbers:
    """The numbers x with `x kind limit`."""
    signed_limit = (limit + HALF) % WORD - HALF
    match kind:
        case Kind.EQ:
            return between(limit, limit)
        case Kind.NE:
            return between(limit + 1, limit + WORD - 1)
        case Kind.ULT:
            return between(0, limit - 1)
        case Kind.UGE:
            return between(limit, WORD - 1)
        case Kind.SLT:
            return between(-HALF, signed_limit - 1)
        case Kind.SGE:
            return between(signed_limit, HALF - 1)


def _left_of(kind: Kind, limit: int) -> Numbers:
    """The numbers x with `limit kind x`."""
    signed_limit = (limit + HALF) % WORD - HALF
    match kind:
        case Kind.ULT:
            return between(limit + 1, WORD - 1)
        case Kind.UGE:
            return between(0, limit)
        case Kind.SLT:
            return between(signed_limit + 1, HALF - 1)
        case Kind.SGE:
            return between(-HALF, signed_limit)
        case _:
            return _right_of(kind, limit)


def _add_value(found: Facts, term: Term, allowed: Numbers, choices: Choices, depth: int) -> None:
    """Learn that the term's value is one of `allowed`."""
    if term.is_constant:
        if not common(allowed, between(term.constant, term.constant)):
            found[ValueKey(frozenset())] = ()
        return
    rest = moved(allowed, -term.constant)
    parts = Term(0, term.parts, term.size)
    if _is_mirrored(parts):
        parts, rest = scale(parts, -1), _mirrored(rest)
    _narrow(found, ValueKey(parts.parts), rest)
    if len(parts.parts) != 1 or not depth:
        return
    ((of, factor),) = parts.parts
    chosen: tuple[Relation, Term, Term] | None = None
    if isinstance(of, Truth):
        chosen = of.relation, number(factor), number(0)
    elif isinstance(of, Fresh) and factor == 1:
        _narrow(found, ValueKey(parts.parts), between(of.low, of.high))
        chosen = choices(of)
    if chosen is None:
        return
    relation, yes, no = chosen
    for value, other in ((yes, relation.negated), (no, relation)):
        if value.is_constant and not common(rest, between(value.constant, value.constant)):
            _add(found, other, choices, depth - 1)


def _is_mirrored(parts: Term) -> bool:
    """Of a term and its negation, one is: the same facts have the same key."""
    ordered = [factor for _, factor in parts.parts]
    if len(ordered) > 1:
        total = sum(ordered) % WORD
        if total % HALF:
            return total > HALF
        ordered = [factor for _, factor in sorted(parts.parts, key=lambda part: repr(part[0]))]
    return ordered[0] > HALF


def _mirrored(numbers: Numbers) -> Numbers:
    result: Numbers = ()
    for low, high in numbers:
        result = united(result, between(-high, -low))
    return result


def _ordered(is_signed: bool, a: Term, b: Term, allowed: Numbers) -> tuple[OrderKey, Numbers]:
    """The key for two terms whichever comes first."""
    if repr(a) <= repr(b):
        return OrderKey(is_signed, a, b), allowed
    turned: Numbers = ()
    for low, high in allowed:
        turned = united(turned, ((2 - high, 2 - low),))
    return OrderKey(is_signed, b, a), turned


def _narrow(found: Facts, key: Key, allowed: Numbers) -> None:
    known = found.get(key)
    both = allowed if known is None else common(known, allowed)
    if len(both) <= MOST_PIECES:
        found[key] = both


def all_of(first: Facts, second: Facts) -> Facts:
    """What holds where both hold."""
    if not second:
        return first
    found = dict(first)
    for key, allowed in second.items():
        _narrow(found, key, allowed)
    while len(found) > MOST_FACTS:
        del found[next(iter(found))]
    return found


def one_of(alternatives: list[Facts]) -> Facts:
    """What holds where one of several holds; those that contradict themselves do not."""
    possible = [facts for facts in alternatives if not contradicts(facts)]
    if len(possible) < 2:
        return possible[0] if possible else alternatives[0] if alternatives else {}
    found: Facts = {}
    for key, allowed in possible[0].items():
        for other in possible[1:]:
            if key not in other:
                break
            allowed = united(allowed, other[key])
            if len(allowed) > MOST_PIECES or allowed == ((0, WORD - 1),):
                break
        else:
            found[key] = allowed
    return found


def contradicts(facts: Facts) -> bool:
    """Whether the facts cannot hold together."""
    return any(not allowed for allowed in facts.values())


__all__ = [
    "Facts",
    "Key",
    "Numbers",
    "OrderKey",
    "ValueKey",
    "all_of",
    "between",
    "common",
    "contradicts",
    "facts_of",
    "one_of",
]
