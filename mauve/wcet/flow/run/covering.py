"""Words that cover others: where two paths meet, and where all iterations of a loop are followed at once."""

from __future__ import annotations

from collections.abc import Sequence

from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import TOP, Range
from mauve.wcet.flow.run.words import UNKNOWN, WILD, Some, Stack, Stacks, Unknown, Word, is_wild, offsets_of, range_of

_WORDS = (int, Some, Unknown)
"""Others are flags, or made from an address in the stack."""


def merge(a: Word, b: Word) -> Word:
    """A word that covers both."""
    if a is b:
        return a
    kind, other = type(a), type(b)
    if kind is int and other is int:
        return a if a == b else Some(domain.of((a, b)))  # type: ignore[arg-type]
    if (kind is int or kind is Some) and (other is int or other is Some):
        one = Range(a, 0, 0) if kind is int else a.range  # type: ignore[union-attr,arg-type]
        two = Range(b, 0, 0) if other is int else b.range  # type: ignore[union-attr,arg-type]
        return Some(domain.join(one, two))
    if is_wild(a) or is_wild(b):
        first, second = offsets_of(a), offsets_of(b)
        if first is None or second is None:
            return WILD
        return a if kind is Stack and first == second else Stacks(domain.join(first, second))
    return Some(TOP) if kind in _WORDS and other in _WORDS else UNKNOWN


def covers(wide: Word, word: Word) -> bool:
    """Whether every value of `word` is one of `wide`."""
    if wide is word or wide is WILD:
        return True
    if is_wild(wide) or is_wild(word):
        first, second = offsets_of(wide), offsets_of(word)
        return first is not None and second is not None and domain.includes(first, second)
    if type(wide) not in (int, Some, Unknown):
        return False
    one, two = range_of(wide), range_of(word)
    return one is not None and two is not None and domain.includes(one, two)


def widened(old: Word, new: Word, borders: Sequence[int] = ()) -> Word:
    """A word that covers both and grows in few steps, first up to `borders` (sorted words)."""
    if covers(old, new):
        return merge(old, new)
    if is_wild(old) or is_wild(new):
        first, second = offsets_of(old), offsets_of(new)
        return WILD if first is None or second is None else Stacks(domain.widen(first, second, borders))
    one, two = range_of(old), range_of(new)
    assert one is not None and two is not None
    if type(old) not in _WORDS or type(new) not in _WORDS:
        return UNKNOWN
    return Some(domain.widen(one, two, borders))


__all__ = ["covers", "merge", "widened"]
