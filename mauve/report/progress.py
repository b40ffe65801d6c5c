"""How far long work has come, on one line of a terminal that is wiped when the work is done."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TextIO

from mauve.diagnostics.display import one_line

INTERVAL = 0.1
"""Seconds between two updates at least."""

WIDTH = 78


@contextmanager
def progress(stream: TextIO, what: str) -> Iterator[Callable[[int, int, str], None] | None]:
    """A function to be told how many of how many are done and the name of the last one; None where nobody watches."""
    if not stream.isatty():
        yield None
        return
    shown = 0.0

    def show(done: int, total: int, name: str) -> None:
        nonlocal shown
        now = time.monotonic()
        if now - shown >= INTERVAL:
            shown = now
            stream.write("\r" + one_line(f"{done}/{total} {what}: {name}")[:WIDTH].ljust(WIDTH))
            stream.flush()

    try:
        yield show
    finally:
        if shown:
            stream.write("\r" + " " * WIDTH + "\r")
            stream.flush()
