"""The stack of a task: the deepest of the codels that it executes, from the binary."""

from __future__ import annotations

from collections.abc import Iterable

from mauve.lower.codels import CodelTime
from mauve.lower.placed import PlacedTask
from mauve.records import record
from mauve.verdict.globals import executes


@record
class StackUse:
    """`size` is in bytes, on top of what the frame of the task's own loop takes, and None where the depth of a codel is
    not known; `codel` is the deepest one, or the first one of which nothing is known."""

    size: int | None
    codel: str


def stack_use(placed: PlacedTask, codels: Iterable[CodelTime]) -> StackUse | None:
    """The stack of a task whose codels are called one after the other; None for one that executes none."""
    deepest: StackUse | None = None
    for codel in codels:
        if not any(executes(placed, use) for use in codel.plan.uses):
            continue
        size = codel.result.stack if codel.result is not None else None
        if size is None:
            return StackUse(None, str(codel.plan.id))
        if deepest is None or deepest.size is None or size > deepest.size:
            deepest = StackUse(size, str(codel.plan.id))
    return deepest
