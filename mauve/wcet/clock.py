"""The time that the analysis of one function may take, and how it ends when that is over."""

from __future__ import annotations

from time import monotonic

Deadline = float | None
"""A point in time as `time.monotonic` counts it; None: any time."""


class OutOfTime(Exception):
    """The deadline is over. `address` and `function` say where the analysis was, as far as the place that noticed
    knows it. Raised between two steps: what was found before is complete and stays in use."""

    def __init__(self, address: int | None = None, function: str = "") -> None:
        super().__init__(address, function)
        self.address, self.function = address, function


def is_over(deadline: Deadline) -> bool:
    """Whether the deadline has passed."""
    return deadline is not None and monotonic() > deadline


def left(deadline: float) -> float:
    """The seconds until the deadline, at least a little."""
    return max(0.01, deadline - monotonic())


def check(deadline: Deadline, address: int | None = None, function: str = "") -> None:
    """Raise OutOfTime when the deadline has passed."""
    if deadline is not None and monotonic() > deadline:
        raise OutOfTime(address, function)
