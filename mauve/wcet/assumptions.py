"""What every bound assumes of the hardware, listed in every result beside what flow analysis assumes of the program."""

from __future__ import annotations

from collections.abc import Iterator

from mauve.units import FREQUENCY_UNITS
from mauve.wcet.hardware.board import Board
from mauve.wcet.hardware.core import Core

ALWAYS = (
    "words and halfwords are accessed at multiples of their size, as the procedure call standard (AAPCS) aligns them",
    "nothing interrupts the function: preemption and interrupts are accounted for by the schedulability analysis",
)


def board_assumptions(core: Core, board: Board) -> Iterator[str]:
    """What a bound assumes of the board and of the model of its core."""
    yield f"the core is an {core.title} at {_frequency(board.hertz)}, timed by {'; '.join(core.sources)}"
    if not board.memories:
        yield "every memory access takes a single cycle (the board declares no memories)"
    else:
        waits = ", ".join(f"{memory.name} {_waits(memory.wait, memory.write_wait)}" for memory in board.memories)
        yield f"wait states per access in CPU cycles: {waits}; an unknown address takes those of the slowest memory"
        yield "data is accessed in the declared memories only, and no other bus master delays an access"
    if not core.shared_bus:
        yield "instruction and data ports do not wait for each other: contention is part of the declared wait states"
    if any(entry.confidence != "high" for entry in core.timing.values()):
        weak = ", ".join(sorted(name for name, entry in core.timing.items() if entry.confidence != "high"))
        yield f"times that the manual leaves in doubt are the worst it allows ({weak.replace('_', ' ')})"
    yield "caches, memory management and prefetch units are off or absent, as the board says"


def _frequency(hertz: int) -> str:
    unit, size = max(((unit, size) for unit, size in FREQUENCY_UNITS.items() if hertz >= size), key=lambda pair:
    pair[1])
    return f"{hertz / size:g} {unit}" if hertz % size == 0 else f"{hertz} Hz"


def _waits(read: int, write: int | None) -> str:
    return f"{read}" if write is None or write == read else f"{read} (stores {write})"
