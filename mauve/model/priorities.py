"""Priorities where none are written: rate monotonic, around those that are."""

from __future__ import annotations

from collections.abc import Sequence


def rate_monotonic(tasks: Sequence[tuple[int, int | None]]) -> tuple[int, ...]:
    """A priority for each (period, written priority or None), in the order given; larger is more urgent.

    Written priorities stay. The others are put in rate-monotonic order, ties by order of declaration, each just
    above the first written task of longer period. Where no number is left between two neighbours the lower one's is
    shared: equal priorities interfere both ways, so the bound stays sound.
    """
    missing = sorted((i for i, (_, priority) in enumerate(tasks) if priority is None), key=lambda i: (tasks[i][0], i))
    written = sorted((i for i, (_, priority) in enumerate(tasks) if priority is not None), key=lambda i: -_of(tasks[i]))
    order: list[int] = []
    for i in missing:
        while written and tasks[written[0]][0] <= tasks[i][0]:
            order.append(written.pop(0))
        order.append(i)
    return _numbers(order + written, tasks)


def _of(task: tuple[int, int | None]) -> int:
    return task[1] if task[1] is not None else 0


def _numbers(order: Sequence[int], tasks: Sequence[tuple[int, int | None]]) -> tuple[int, ...]:
    """Numbers that fall along `order`, keeping the written ones."""
    ceilings: list[int | None] = []
    above: int | None = None
    for i in order:
        ceilings.append(above)
        above = tasks[i][1] if tasks[i][1] is not None else above
    result = [0] * len(order)
    below = 0
    for i, ceiling in zip(reversed(order), reversed(ceilings), strict=True):
        if tasks[i][1] is not None:
            below = _of(tasks[i])
        elif ceiling is None or below + 1 < ceiling:
            below += 1
        result[i] = below
    return tuple(result)


def contradiction(tasks: Sequence[tuple[str, int, int]]) -> tuple[str, str] | None:
    """Two (name, period, priority) of which the first has the shorter period and the lower priority; None for a
    rate-monotonic set."""
    ordered = sorted(tasks, key=lambda task: (task[1], -task[2]))
    least: tuple[str, int, int] | None = None
    for task in ordered:
        if least is not None and task[1] > least[1] and task[2] > least[2]:
            return least[0], task[0]
        if least is None or task[2] < least[2]:
            least = task
    return None
