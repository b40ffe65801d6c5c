"""Priorities where none are written: rate monotonic, around those that are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence


def rate_monotonic(tasks: Sequence[tuple[int, int | None]]) -> Iterator[int]:
    """A priority for each (period, written priority or None), in the order given; larger is more urgent.

    Written priorities stay. The others are put in rate-monotonic order, ties by order of declaration, each just
    above the written task of longer period that it must precede. Where no number is left between two neighbours the
    lower one's is shared: equal priorities interfere both ways, so the bound stays sound.
    """
    missing = sorted((i for i, (_, priority) in enumerate(tasks) if priority is None), key=lambda i: (tasks[i][0], i))
    given = sorted((i for i, (_, priority) in enumerate(tasks) if priority is not None), key=lambda i: -_of(tasks[i]))
    order = list(given)
    at = 0
    for i in missing:
        later = (
            k for k in range(at, len(order)) if tasks[order[k]][1] is not None and tasks[order[k]][0] > tasks[i][0]
        )
        at = next(later, len(order))
        order.insert(at, i)
        at += 1
    return iter(_numbers(order, tasks))


def _of(task: tuple[int, int | None]) -> int:
    return task[1] if task[1] is not None else 0


def _numbers(order: Sequence[int], tasks: Sequence[tuple[int, int | None]]) -> list[int]:
    """Numbers that fall along `order`, keeping the written ones."""
    result = [0] * len(order)
    below = 0
    for position in range(len(order) - 1, -1, -1):
        i = order[position]
        written = tasks[i][1]
        if written is not None:
            below = written
        else:
            above = next((_of(tasks[k]) for k in reversed(order[:position]) if tasks[k][1] is not None), None)
            below = below + 1 if above is None or below + 1 < above else below
        result[i] = below
    return result
