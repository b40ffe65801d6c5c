"""A board as the WCET engine sees it: a core, its clock, its memories, and the features that must be modelled or
off."""

from __future__ import annotations

from mauve.records import record


@record
class Memory:
    """A region of the address space. `wait` counts wait states in CPU cycles added to each access (0: single cycle)."""

    name: str
    start: int
    size: int
    wait: int
    write_wait: int | None = None
    """wait states of a store where they differ"""

    @property
    def end(self) -> int:
        """The address after the last byte."""
        return self.start + self.size


@record
class Board:
    """`features` are hardware mechanisms the board has switched on, in words (`icache 16KiB 4-way`, `mmu`): those that
    no model covers are a problem of every bound. A board without memories has zero wait states everywhere."""

    name: str
    core: str
    hertz: int
    memories: tuple[Memory, ...] = ()
    features: tuple[str, ...] = ()
