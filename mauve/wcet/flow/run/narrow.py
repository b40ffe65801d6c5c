"""What a branch tells of the words that its condition compares."""

from __future__ import annotations

from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import MASK, SIGN, TOP, Range
from mauve.wcet.flow.run.flags import CS, EQ, GE, GT, HI, MI, Flags, Source
from mauve.wcet.flow.run.words import Ranged, Some, Stack, Stacks, Word, made, range_of, signed

Told = list[tuple[Ranged, Range]]
"""Words and what their ranges are less than before."""

MOST_SIGNED = SIGN - 1


def told(flags: Flags, code: int, is_true: bool) -> Told | None:
    """What is known of the words in `flags` where a condition (its even encoding) holds, or where it does not; None
    when it cannot be so."""
    a, b = range_of(flags.a), range_of(flags.b)
    a, b = TOP if a is None else a, TOP if b is None else b
    source, result = flags.source, flags.result
    if source is Source.RESULT:
        kept = _against_zero(a, code, is_true)
        return None if kept is None else _changes(((flags.a, a, kept),))
    if source is Source.SUM:
        if b.n == 0 and b.low not in (0, SIGN):
            b = domain.negate(b)
        elif code not in (EQ, MI):
            return []
        else:
            b = domain.negate(b)
    before = a, b
    kept_a, kept_b = _compared(a, b, code, is_true)
    if kept_a is None or kept_b is None:
        return None
    changes = [(flags.a, before[0], kept_a)]
    if source is Source.DIFFERENCE:
        changes.append((flags.b, before[1], kept_b))
    if result is not None:
        values = range_of(result)
        if values is not None:
            kept = domain.meet(values, domain.sub(kept_a, kept_b))
            kept = None if kept is None else _against_zero(kept, code, is_true)
            if kept is None:
                return None
            changes.append((result, values, kept))
    return _changes(changes)


def narrower(word: Ranged, values: Range) -> Word:
    """The same word with fewer values."""
    if type(word) is Stacks:
        return Stack(signed(values.low)) if values.n == 0 else Stacks(values, word.base, word.offset)
    return values.low if values.n == 0 else Some(values, word.base, word.offset)


def within(word: Word, values: Range) -> Word | None:
    """A word of which it is known that it is one of these values; None when it is not."""
    if type(word) is int:
        return word if word in values else None
    before = range_of(word)
    if before is None:
        return word
    kept = domain.meet(before, values)
    if kept is None:
        return None
    return narrower(word, kept) if type(word) is Some else made(kept)


def sides(flags: Flags | None, code: int, negated: bool) -> tuple[dict[int, Word], dict[int, Word]]:
    """The narrower words, by the identity of those before, where a condition holds and where it does not."""
    if flags is None:
        return {}, {}
    yes, no = told(flags, code, not negated), told(flags, code, negated)
    return tuple({id(word): narrower(word, values) for word, values in side or ()} for side in (yes, no))  # type: ignore[return-value]


def _changes(found: list[tuple[Word, Range, Range]] | tuple[tuple[Word, Range, Range], ...]) -> Told:
    changes: Told = [(word, kept) for word, before, kept in found if type(word) is Some and kept != before]
    for word, kept in changes[:]:
        if type(word) is not Some or word.low is None or kept.n:
            continue
        # The low bits are known of the word that it was made of.
        whole, bits, by = word.low
        numbers = domain.progression(kept.low >> by, 1 << bits, (1 << 32 - bits) - 1)
        congruent = domain.clip(numbers, whole.range.low, whole.range.high)
        if congruent is not None and congruent.size < whole.range.size:
            changes.append((whole, congruent))
    return changes


def _against_zero(a: Range, code: int, is_true: bool) -> Range | None:
    """What remains of the values that came of an operation, by Z or N."""
    match code, is_true:
        case 0, True:
            return domain.clip(a, 0, 0)
        case 0, False:
            return domain.without(a, 0)
        case 4, True:
            return domain.clip(a, SIGN, MASK)
        case 4, False:
            return domain.clip(a, 0, MOST_SIGNED)
    return a


def _compared(a: Range, b: Range, code: int, is_true: bool) -> tuple[Range | None, Range | None]:
    """What remains of a and b when they compare as said."""
    if code == EQ:
        if is_true:
            return domain.meet(a, b), domain.meet(b, a)
        return _other(a, b), _other(b, a)
    if code == MI:
        if b.n == 0:
            kept = _against_zero(domain.shift(a, -b.low), code, is_true)
            return (None if kept is None else domain.meet(a, domain.shift(kept, b.low))), b
        return a, b
    if code in (CS, HI):
        # a >= b is CS, a < b its negation; a > b is HI, a <= b its negation.
        return _ordered(a, b, is_true, strict=(code == HI) if is_true else (code == CS), bias=0)
    if code in (GE, GT):
        return _ordered(a, b, is_true, strict=(code == GT) if is_true else (code == GE), bias=SIGN)
    return a, b


def _other(a: Range, b: Range) -> Range | None:
    return domain.without(a, b.low) if b.n == 0 else a


def _ordered(a: Range, b: Range, greater: bool, *, strict: bool, bias: int) -> tuple[Range | None, Range | None]:
    """a above b, or below it where not `greater`; `strict`: not equal. `bias` SIGN compares with signs."""
    if bias:
        a, b = domain.shift(a, bias), domain.shift(b, bias)
    more, less = (a, b) if greater else (b, a)
    least, most = less.unsigned_bounds()[0] + strict, more.unsigned_bounds()[1] - strict
    kept_more = domain.clip(more, least, MASK) if least <= MASK else None
    kept_less = domain.clip(less, 0, most) if most >= 0 else None
    if bias:
        kept_more = None if kept_more is None else domain.shift(kept_more, bias)
        kept_less = None if kept_less is None else domain.shift(kept_less, bias)
    return (kept_more, kept_less) if greater else (kept_less, kept_more)


__all__ = [
    "narrower",
    "sides",
    "told",
    "within",
]
