"""How words of a run lie to each other, where ranges do not tell: differences that branches told of.

A path knows, for some pairs of words, the values of the first less the second: a zone (Mine, "A new numerical abstract
domain based on difference-bound matrices", PADO 2001) of a few pairs, with the circular progressions of the value
analysis in the place of bounds. `p != end` with an unknown end leaves the distance from p to end one value less each
time; where paths meet, the distances of the words that the function compares are kept.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from typing import TypeAlias

from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import MASK, SIGN, Range
from mauve.wcet.flow.run.flags import CS, EQ, GE, GT, HI, Flags, Source
from mauve.wcet.flow.run.words import Ranged, Some, Stack, Stacks, Word, offsets_of, range_of

Related: TypeAlias = dict[tuple[int, int, int], tuple[Ranged, Ranged, Range]]
"""By the identities of two bases and a factor: the bases, and the values of the first less so many times the second.
Never changed in place. With the factor SUM the second stands nowhere: it is the sum of its terms."""

SUM = 0

MOST, FAR, WIDE = 32, 1 << 16, 1 << 12
"""Pairs of words that a path knows something of; how far apart two of them may lie; how many values both may have where
nothing is known of their difference so far: more tell of data, not of how far a loop has come."""


# ------------------------------------------------------------------------------------------------------ differences
def difference(a: Word, b: Word, related: Related) -> Range | None:
    """The values of a - b as they are known; None where they are not numbers or not addresses in the stack both."""
    first, second = _both(a, b)
    if first is None or second is None:
        return None
    from_a, at_a = base_of(a)
    from_b, at_b = base_of(b)
    if from_a is from_b:
        return domain.constant((at_a - at_b) & MASK)
    values = domain.sub(first, second)
    if from_a is not None and from_b is not None:
        for known in (*_told(from_a, from_b, related), *_sums(from_a, from_b, related)):
            met = domain.meet(domain.shift(known, at_a - at_b), values)
            values = values if met is None else met
    return values


def _sums(a: Ranged, b: Ranged, related: Related) -> Iterator[Range]:
    """What is known of the difference of two bases where one is a sum, of another sum of the same two words."""
    for one, whole, negated in ((a, b, False), (b, a, True)):
        if whole.terms is None:
            continue
        for (_, _, factor), (x, y, known) in related.items():
            apart = _between(whole, y) if x is one and factor == SUM else None
            if apart is not None:
                values = domain.shift(known, -apart)
                yield domain.negate(values) if negated else values


def _between(whole: Ranged, other: Ranged) -> int | None:
    """How far a sum of two words is above another sum of the same two; None for other words."""
    if whole.terms is None or other.terms is None:
        return None
    (a, b), (x, y) = whole.terms, other.terms
    if a.base is y.base and b.base is x.base:
        x, y = y, x
    if a.base is not x.base or b.base is not y.base:
        return None
    return a.offset + b.offset - x.offset - y.offset


def with_sums(a: Word, b: Word, values: Range, related: Related) -> Related:
    """What is known when a - b is one of these values and one of both is how far an address is from an end: how far
    from it is their sum, as in `n <= end - p`."""
    for rest, length, known in ((a, b, values), (b, a, domain.negate(values))):
        less = rest.base.less if type(rest) is Some and type(rest.base) is Some else None
        if less is not None and type(length) is Some:
            end, start = less
            total = type(start)(domain.add(start.range, length.range))
            total.terms = start, length
            related = with_difference(end, total, domain.shift(known, -rest.offset), related, SUM)  # type: ignore
    return related


def _is_known(a: Word, b: Word, related: Related) -> bool:
    """Whether more is known of a - b than the values of both tell."""
    if not isinstance(a, Ranged) or not isinstance(b, Ranged):
        return type(a) is type(b) and type(a) in (int, Stack)
    from_a, from_b = a.base, b.base
    if from_a is from_b:
        return True
    return (
        _key(from_a, from_b) in related
        or _key(from_b, from_a) in related
        or from_a.terms is not None
        or from_b.terms is not None
    )


def _is_near(word: Word) -> bool:
    return not isinstance(word, Ranged) or word.range.span < WIDE


def _both(a: Word, b: Word) -> tuple[Range | None, Range | None]:
    if type(a) is Stack or type(a) is Stacks:
        return offsets_of(a), offsets_of(b)
    return (range_of(a), range_of(b)) if type(a) in (int, Some) and type(b) in (int, Some) else (None, None)


def base_of(word: Word) -> tuple[Ranged | None, int]:
    """What a word has a known distance from (None: zero, or sp at the entry of the program), and the distance."""
    kind = type(word)
    if kind is Some or kind is Stacks:
        return (word if word.root is None else word.root), word.offset  # type: ignore[union-attr,return-value]
    return None, word.offset if kind is Stack else word  # type: ignore[return-value,union-attr]


def _told(a: Ranged, b: Ranged, related: Related) -> list[Range]:
    """What else is known of the difference of two bases."""
    known = []
    found = related.get(_key(a, b))
    if found is not None:
        known.append(found[2])
    found = related.get(_key(b, a))
    if found is not None:
        known.append(domain.negate(found[2]))
    if a.terms is None and b.terms is None:
        return known
    for whole, part, sign in ((a, b, False), (b, a, True)):
        for term, other in (whole.terms, whole.terms[::-1]) if whole.terms else ():
            if term.base is part and type(other) is Some:
                # The sum less one of its terms is the other one.
                rest = domain.shift(other.range, term.offset)
                known.append(domain.negate(rest) if sign else rest)
    return known


def _key(a: Ranged, b: Ranged, factor: int = 1) -> tuple[int, int, int]:
    return id(a), id(b), factor


def with_difference(a: Word, b: Word, values: Range, related: Related, factor: int = 1) -> Related:
    """What is known when a less `factor` times b is one of the values as well."""
    from_a, at_a = base_of(a)
    from_b, at_b = base_of(b)
    if from_a is None or from_b is None:
        return related
    key = _key(from_a, from_b, factor)
    found = {one: known for one, known in related.items() if one not in (key, (key[1], key[0], 1))}
    if len(found) >= MOST:
        del found[next(iter(found))]
    found[key] = from_a, from_b, domain.shift(values, factor * at_b - at_a)
    return found


def apart(a: Word, b: Word, factor: int, related: Related) -> Range | None:
    """The values of a less `factor` times b (offsets in the place of addresses in the stack); None where they are not
    known."""
    first, second = _number(a), _number(b)
    if first is None or second is None:
        return None
    if factor == 1 and (type(a) in _IN_STACK) == (type(b) in _IN_STACK):
        return difference(a, b, related)
    values = domain.sub(first, domain.scale(second, factor))
    (from_a, at_a), (from_b, at_b) = base_of(a), base_of(b)
    if from_a is None or from_b is None:
        return values
    found = related.get(_key(from_a, from_b, factor))
    known = None if found is None else found[2]
    if known is None:
        known = multiple(from_a, from_b, factor)
    met = None if known is None else domain.meet(domain.shift(known, at_a - factor * at_b), values)
    return values if met is None else met


def multiple(a: Ranged, b: Ranged, factor: int) -> Range | None:
    """The values of a less `factor` times b where a was made as such a multiple, or as a sum with one; None for other
    words."""
    whole = _shifted(a, factor)
    if whole is not None and whole.base is b:
        return domain.constant(factor * whole.offset)
    for term, other in () if a.terms is None else (a.terms, a.terms[::-1]):
        whole = _shifted(term.base, factor)
        if whole is not None and whole.base is b:
            return domain.shift(other.range, term.offset + factor * whole.offset)
    return None


def _shifted(word: Ranged, factor: int) -> Some | None:
    """The word of which another is a multiple, modulo 2**32."""
    if type(word) is not Some or word.low is None or word.low[1] + word.low[2] != 32:
        return None
    return word.low[0] if factor == 1 << word.low[2] else None


def _number(word: Word) -> Range | None:
    return offsets_of(word) if type(word) in _IN_STACK else range_of(word) if type(word) in (int, Some) else None


def follow(word: Ranged, values: Range, related: Related) -> list[tuple[Ranged, Range]]:
    """What follows for other words where one is one of these values."""
    base, found = word.base, []
    numbers = domain.shift(values, -word.offset)
    for (_, _, factor), (x, y, known) in related.items():
        if factor == SUM:
            continue
        if y is base:
            found.append((x, domain.add(domain.scale(numbers, factor), known)))
        elif x is base:
            low, high = y.range.signed_bounds()
            if max(-low, high) * abs(factor) >= SIGN:
                continue
            # The multiple does not go around the circle: it is one of these numbers with a sign.
            first, last = domain.sub(numbers, known).signed_bounds()
            first, last = (first, last) if factor > 0 else (-last, -first)
            least, most = -(-first // abs(factor)), last // abs(factor)
            if least <= most:
                found.append((y, domain.between(least & MASK, most & MASK)))
    return found


def told_apart(
    flags: Flags, code: int, is_true: bool, related: Related
) -> tuple[list[tuple[Ranged, Range]], Related] | None:
    """What a condition (its even encoding) tells of two words by what is known of their difference: less values of
    each, and of the difference. None where it cannot be as said."""
    a, b = flags.a, flags.b
    if flags.source is not Source.DIFFERENCE or type(a) is int or type(b) is int:
        return [], related
    if not _is_known(a, b, related) and not (_is_near(a) and _is_near(b)):
        return [], related
    before = difference(a, b, related)
    if before is None:
        return [], related
    kept = _compared(a, b, before, code, is_true)
    if kept is None:
        return None
    first, second = _both(a, b)
    assert first is not None and second is not None
    changes: list[tuple[Ranged, Range]] = []
    for word, values, other in ((a, first, domain.add(second, kept)), (b, second, domain.sub(first, kept))):
        met = domain.meet(values, other)
        if met is None:
            return None
        if isinstance(word, Ranged) and met.size < values.size:
            changes.append((word, met))
    if kept.span < min(domain.sub(first, second).span, FAR):
        related = with_sums(a, b, kept, with_difference(a, b, kept, related))
    return changes, related


def _compared(a: Word, b: Word, values: Range, code: int, is_true: bool) -> Range | None:
    """What remains of the values of a - b where a and b compare as said."""
    if code == EQ:
        return domain.clip(values, 0, 0) if is_true else domain.without(values, 0)
    if code not in (CS, HI, GE, GT) or not _ordered_by_difference(a, b, signed=code in (GE, GT)):
        return values
    least = int(code in (HI, GT))
    if is_true:
        return domain.clip(values, least, SIGN - 1)
    return domain.clip(values, SIGN, (least - 1) & MASK)


def _ordered_by_difference(a: Word, b: Word, *, signed: bool) -> bool:
    """Whether a is above b just where a - b, as a number with sign, is above zero."""
    first, second = _both(a, b)
    if first is None or second is None:
        return False
    in_stack = type(a) is Stack or type(a) is Stacks
    if in_stack and signed:
        return False
    ends = Range.signed_bounds if signed or in_stack else Range.unsigned_bounds
    (low, high), (least, most) = ends(first), ends(second)
    return high - least < SIGN and most - low < SIGN


# ----------------------------------------------------------------------------------------------------- where paths meet
Triple: TypeAlias = tuple[Word, Word, Word]
"""A word on one path, on another, and where they have met."""


_IN_STACK = (Stack, Stacks)
Combine: TypeAlias = Callable[[Range, Range], Range]


def together(
    one: Related,
    other: Related,
    words: Iterable[Triple],
    pairs: Sequence[tuple[Triple, Triple]],
    alive: Container[int],
    starts: Container[int],
    combine: Combine = domain.join,
    lines: Sequence[tuple[Triple, Triple, int]] = (),
) -> Related:
    """What is known of differences where two paths meet. `words` are those that became another, `pairs` those that the
    function compares, `alive` the bases (their identities) that lie in registers, `starts` those from which
    distances are kept in any case; `combine` makes one range of two; `lines` are words that move in step, with the
    factor."""
    found: Related = {}
    words = list(words) if starts or one or other else ()
    for triple in words if starts else ():
        for base in {id(base): base for base in (base_of(triple[0])[0], base_of(triple[1])[0])}.values():
            if base is not None and id(base) in starts:
                found = _met(triple, (base, base, base), one, other, combine, found)
    for first, second in pairs:
        if first[0] is not first[1] or second[0] is not second[1]:
            found = _met(first, second, one, other, combine, found, always=True)
    for first, second, factor in lines:
        found = _met(first, second, one, other, combine, found, factor, always=True)
    if not one and not other:
        return found
    became: dict[int, list[Triple]] = {}
    for triple in words:
        for word in {id(base): base for base in (base_of(triple[0])[0], base_of(triple[1])[0]) if base is not None}:
            became.setdefault(word, []).append(triple)
    for key, (x, y, _) in {**other, **one}.items():
        if key[2] == SUM:
            if key in one and key in other and len(found) < MOST:
                found[key] = x, y, combine(one[key][2], other[key][2])
            continue
        firsts, seconds = tuple(became.get(key[0], ())), tuple(became.get(key[1], ()))
        if not firsts and not seconds and not (key in one and key in other):
            continue
        # A word that is in no register became all that it is now.
        firsts = (*firsts, (x, x, x)) if not firsts or key[0] in alive else firsts
        seconds = (*seconds, (y, y, y)) if not seconds or key[1] in alive else seconds
        for first in firsts:
            for second in seconds:
                found = _met(first, second, one, other, combine, found, key[2])
    return found


def _met(
    first: Triple,
    second: Triple,
    one: Related,
    other: Related,
    combine: Combine,
    found: Related,
    factor: int = 1,
    *,
    always: bool = False,
) -> Related:
    """With the difference of two words as it is where two paths have met; `always` also where neither path knows more
    of it than the values of the words."""
    (a, b, c), (x, y, z) = first, second
    if not isinstance(c, Ranged) or not isinstance(z, Ranged) or c.base is z.base or len(found) >= MOST:
        return found
    if _key(c.base, z.base, factor) in found or (factor == 1 and _key(z.base, c.base) in found):
        return found
    is_told = _is_known(a, x, one) or _is_known(b, y, other) or (always and _is_near(c) and _is_near(z))
    if factor == 1 and type(c) is type(z) and not is_told:
        return found
    here, there = apart(a, x, factor, one), apart(b, y, factor, other)
    if here is None or there is None:
        return found
    values = combine(here, there)
    if values.span >= min(c.range.span + abs(factor) * z.range.span, FAR):
        return found
    return with_difference(c, z, values, found, factor)


__all__ = [
    "Related",
    "Triple",
    "apart",
    "base_of",
    "difference",
    "follow",
    "multiple",
    "together",
    "told_apart",
    "with_difference",
]
