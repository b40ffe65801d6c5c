"""Boards as written."""

from __future__ import annotations

from mauve.records import record
from mauve.source import Span
from mauve.syntax.ast.names import Name, Number, Quantity, String


@record
class CpuItem:
    """`cpu "arm926ej-s" at 200MHz`."""

    core: String
    frequency: Quantity
    span: Span


@record
class FeatureItem:
    """A hardware mechanism: `icache off`, `dcache 16KiB 4-way line 32B`, `mmu off`, `prefetch on`.

    `name` is icache, dcache, mmu or prefetch; `settings` is what follows, word by word.
    """

    name: str
    off: bool
    settings: tuple[str, ...]
    span: Span


@record
class MemoryItem:
    """`memory sram at 0x00200000 size 64KiB wait 1cycles`, optionally `write wait 2cycles`."""

    name: Name
    start: Number | None
    size: Quantity
    wait: Quantity
    write_wait: Quantity | None
    span: Span


@record
class OsItem:
    """`os xenomai { context_switch 8us  tick every 1ms cost 5us }`."""

    name: Name
    context_switch: Quantity | None
    tick_every: Quantity | None
    tick_cost: Quantity | None
    span: Span


@record
class BoardDecl:
    """A processor, its memories and its operating system's overheads."""

    name: Name
    cpus: tuple[CpuItem, ...]
    features: tuple[FeatureItem, ...]
    memories: tuple[MemoryItem, ...]
    systems: tuple[OsItem, ...]
    span: Span
    doc: str = ""
