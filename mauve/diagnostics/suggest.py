"""Spelling help: which known names may have been meant by an unknown one."""

from __future__ import annotations

from collections.abc import Iterable

LONGEST = 80
"""Names longer than this have no suggestions: the cost of comparing grows with the product of the lengths."""


def closest(word: str, candidates: Iterable[str], limit: int = 3) -> tuple[str, ...]:
    """At most `limit` candidates that `word` may stand for, the likeliest first; empty where none is near.

    A name is near when it differs only in case or separators, or is at most a third of its length (and at least one
    slip) away in the optimal string alignment distance. Only the best of these and those one slip further are named.
    Where there are none, names of which one begins with the other are.
    """
    near: list[tuple[int, int, str]] = []
    begun: list[tuple[int, int, str]] = []
    for order, candidate in enumerate(dict.fromkeys(candidates)):
        if candidate == word or max(len(word), len(candidate)) > LONGEST:
            continue
        left, right = _letters(word), _letters(candidate)
        slips = _slips(left, right)
        if slips is not None:
            near.append((slips, order, candidate))
        elif _one_begins_the_other(left, right):
            begun.append((abs(len(left) - len(right)), order, candidate))
    best = min(near, default=(0, 0, ""))[0]
    chosen = [each for each in sorted(near) if each[0] <= best + (best > 0)] or sorted(begun)
    return tuple(candidate for _, _, candidate in chosen[:limit])


def _slips(left: str, right: str) -> int | None:
    """The distance of two names, None where it is more than slips of the hand explain."""
    longer = max(len(left), len(right))
    found = distance(left, right, max(1, longer // 3))
    return None if found is None or found >= longer > 0 else found


def _one_begins_the_other(left: str, right: str) -> bool:
    """Whether one name is the beginning of the other, and not by chance: three letters, or half of a short name."""
    shorter, longer = sorted((left, right), key=len)
    return longer.startswith(shorter) and (len(shorter) >= 3 or 2 * len(shorter) >= len(longer) > 0)


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
