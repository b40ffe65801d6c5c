"""From a written board to a resolved one."""

from __future__ import annotations

from itertools import pairwise

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.model import Board, Feature, MemoryRegion, Wait
from mauve.syntax import ast
from mauve.syntax.quantities import cycles_of, frequency_of, size_of, time_of
from mauve.units import CYCLE_UNITS

ADDRESS_SPACE = 1 << 32


def resolve_board(declaration: ast.BoardDecl, report: Report) -> Board | None:
    """The board of a declaration, or None where it has no usable processor."""
    name = declaration.name
    if len(declaration.cpus) != 1:
        span = declaration.cpus[1].span if declaration.cpus else name.span
        message = f"the board `{name}` has {len(declaration.cpus) or 'no'} processor{'s' if declaration.cpus else ''}"
        help_ = Fix('a board has exactly one: `cpu "arm926ej-s" at 200MHz`')
        report.add(Diagnostic("MV405", message, Label(span), help=help_))
        if not declaration.cpus:
            return None
    cpu = declaration.cpus[0]
    hertz = frequency_of(cpu.frequency, report)
    if hertz is not None and hertz <= 0:
        report.add(Diagnostic("MV405", "a processor needs a frequency above 0", Label(cpu.frequency.span)))
        hertz = None
    memories = tuple(m for item in declaration.memories if (m := _memory(item, report)) is not None)
    _check_overlap(memories, report)
    features = tuple(Feature(f.name, f.settings, f.span) for f in declaration.features if not f.off)
    switch, tick_every, tick_cost = _overheads(declaration, report)
    if hertz is None:
        return None
    return Board(
        name.text, cpu.core.value, cpu.core.span, hertz, memories, features, switch, tick_every, tick_cost, name.span
    )


def _memory(item: ast.MemoryItem, report: Report) -> MemoryRegion | None:
    size = size_of(item.size, report)
    wait = _wait(item.wait, report)
    write_wait = _wait(item.write_wait, report) if item.write_wait else None
    if item.start is None:
        help_ = Fix(f"write `memory {item.name} at 0x... size {item.size.span.text} ...`")
        message = f"the memory `{item.name}` has no address"
        report.add(Diagnostic("MV405", message, Label(item.name.span), help=help_))
        return None
    start = item.start.integer if item.start.is_integer else -1
    if size is None or wait is None:
        return None
    if size <= 0 or start < 0 or start + size > ADDRESS_SPACE:
        message = f"the memory `{item.name}` does not lie in the address space of 32 bits"
        report.add(Diagnostic("MV405", message, Label(item.span)))
        return None
    return MemoryRegion(item.name.text, start, size, wait, write_wait, item.name.span)


def _wait(quantity: ast.Quantity, report: Report) -> Wait | None:
    in_cycles = quantity.unit in CYCLE_UNITS
    amount = cycles_of(quantity, report) if in_cycles else time_of(quantity, report)
    if amount is not None and amount < 0:
        report.add(Diagnostic("MV405", "wait states cannot be negative", Label(quantity.span)))
        return None
    return None if amount is None else Wait(amount, in_cycles)


def _check_overlap(memories: tuple[MemoryRegion, ...], report: Report) -> None:
    ordered = sorted(memories, key=lambda memory: memory.start)
    for left, right in pairwise(ordered):
        if left.start + left.size > right.start:
            labels = (Label(left.span, f"ends at {left.start + left.size:#x}"),)
            message = f"the memories `{left.name}` and `{right.name}` overlap"
            report.add(Diagnostic("MV405", message, Label(right.span, f"begins at {right.start:#x}"), labels=labels))


def _overheads(declaration: ast.BoardDecl, report: Report) -> tuple[int, int | None, int]:
    """Context switch, tick period and tick cost in picoseconds."""
    if len(declaration.systems) > 1:
        message = f"the board `{declaration.name}` has {len(declaration.systems)} operating systems"
        report.add(Diagnostic("MV405", message, Label(declaration.systems[1].span)))
    if not declaration.systems:
        return 0, None, 0
    system = declaration.systems[0]
    switch = _not_negative(system.context_switch, report)
    tick = _not_negative(system.tick_every, report) if system.tick_every else None
    cost = _not_negative(system.tick_cost, report)
    if system.tick_every is not None and tick == 0:
        report.add(Diagnostic("MV405", "a tick needs a period above 0", Label(system.tick_every.span)))
        tick = None
    return switch, tick, cost


def _not_negative(quantity: ast.Quantity | None, report: Report) -> int:
    time = time_of(quantity, report) if quantity is not None else 0
    if time is not None and time < 0 and quantity is not None:
        report.add(Diagnostic("MV405", "a cost cannot be negative", Label(quantity.span)))
        return 0
    return time or 0
