"""Spelling help: which known names may have been meant by an unknown one."""

from __future__ import annotations

from collections.abc import Iterable

LONGEST = 80
"""Names longer than this are compared exactly only: the cost grows with the product of the lengths."""


def closest(word: str, candidates: Iterable[str], limit: int = 3) -> tuple[str, ...]:
    """At most `limit` candidates that `word` may stand for, the likeliest first; empty where none is near.

    A name counts as near when it differs only in case or separators, when it is at most a third of its length (and at
    least one slip) away in the optimal string alignment distance, or when one name begins with the other.
    """
    scored: list[tuple[float, int, str]] = []
    for order, candidate in enumerate(dict.fromkeys(candidates)):
        score = _score(word, candidate)
        if score is not None and candidate != word:
            scored.append((score, order, candidate))
    return tuple(candidate for _, _, candidate in sorted(scored)[:limit])


def _score(word: str, candidate: str) -> float | None:
    """How far two names are apart, 0 for the same letters; None where they are unrelated."""
    if not word or not candidate:
        return None
    left, right = _letters(word), _letters(candidate)
    if left == right:
        return 0.0
    shorter, longer = sorted((left, right), key=len)
    slips = max(1, len(longer) // 3)
    if len(longer) > LONGEST:
        return None
    found = distance(left, right, slips)
    if found is not None and found < len(longer):
        return float(found)
    if len(shorter) >= 3 and longer.startswith(shorter):
        return slips + 0.5
    return None


def _letters(name: str) -> str:
    """A name without what is easily mistaken: case and separators."""
    bare = name.casefold().replace("_", "").replace("-", "")
    return bare or name


def distance(left: str, right: str, most: int) -> int | None:
    """The optimal string alignment distance (insert, delete, replace, swap neighbours); None above `most`."""
    if abs(len(left) - len(right)) > most:
        return None
    before: list[int] = []
    previous = list(range(len(right) + 1))
    for row, a in enumerate(left, 1):
        current = [row]
        for column, b in enumerate(right, 1):
            cost = min(previous[column] + 1, current[-1] + 1, previous[column - 1] + (a != b))
            if row > 1 and column > 1 and a == right[column - 2] and left[row - 2] == b:
                cost = min(cost, before[column - 2] + 1)
            current.append(cost)
        if min(current) > most:
            return None
        before, previous = previous, current
    return previous[-1] if previous[-1] <= most else None
