"""Objects of a binary that codels of several tasks reach, one of them writing, with nothing that keeps them apart.

What the model declares is looked at elsewhere (MV214); here it is what the code does behind the model's back: C globals
and statics, as the addresses of accesses show. Operations of one passive component run in its critical section.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.lower.calls import Use
from mauve.lower.codels import CodelTime
from mauve.lower.placed import NodeTasks, PlacedTask
from mauve.records import record

MOST = 8
"""Objects that are told apart in messages, per processor."""


@record
class _Access:
    """A codel that some task executes uses an object; `section` is the provider in whose section it does."""

    task: str
    codel: CodelTime
    writes: bool
    section: str


def check_globals(nodes: Sequence[NodeTasks], codels: Sequence[CodelTime], report: Report) -> None:
    """MV217 for each object of a binary that two tasks of a processor reach unprotected."""
    for node in nodes:
        found: dict[tuple[str, str], list[_Access]] = {}
        for placed in node.tasks:
            for codel, use in _executed(placed, codels):
                section = use.provider if use.provider and not use.waits else ""
                for one in codel.result.globals if codel.result is not None else ():
                    access = _Access(placed.task.name, codel, one.writes, section)
                    found.setdefault((codel.binary, one.symbol), []).append(access)
        races = [(key, pair) for key, accesses in found.items() if (pair := _race(accesses)) is not None]
        for (_, symbol), (first, other) in races[:MOST]:
            more = len(races) - MOST if symbol == races[:MOST][-1][0][1] else 0
            report.add(_diagnostic(symbol, first, other, more))


def executes(placed: PlacedTask, use: Use) -> bool:
    """Whether a task is the one that executes a use of a codel: that of its region, or the owner that serves it."""
    if use.waits:
        return use.provider in {instance.name for instance in placed.instances}
    return use.region in {machine.region for machine in placed.machines}


def _executed(placed: PlacedTask, codels: Sequence[CodelTime]) -> Iterator[tuple[CodelTime, Use]]:
    for codel in codels:
        for use in codel.plan.uses:
            if executes(placed, use):
                yield codel, use


def _race(accesses: Sequence[_Access]) -> tuple[_Access, _Access] | None:
    """A write and another access, in different tasks and not in one critical section."""
    for first in accesses:
        for other in accesses if first.writes else ():
            together = first.section and first.section == other.section
            if other.task != first.task and not together:
                return first, other
    return None


def _diagnostic(symbol: str, first: _Access, other: _Access, more: int) -> Diagnostic:
    message = f"the object `{symbol}` of the binary is written in one task and used in another, and nothing protects it"
    primary = Label(first.codel.plan.codel.span, f"`{first.codel.plan.id}` writes it in task `{first.task}`")
    word = "writes" if other.writes else "reads"
    label = Label(other.codel.plan.codel.span, f"`{other.codel.plan.id}` {word} it in task `{other.task}`")
    help_ = Fix("hand the data over by a port, or keep it in a passive component whose operations use it")
    notes = (f"the same holds for {more} more object{'s' if more > 1 else ''}",) if more > 0 else ()
    return Diagnostic("MV217", message, primary, labels=(label,), notes=notes, help=help_)
