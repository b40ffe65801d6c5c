"""The cost of one instruction on its own: what it adds to time, what it waits for, and which results come late.

The two core models differ only here (`bus_step`, `pipeline_step`); sums over blocks and edges are the same for both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from mauve.wcet.binary.microop import (
    Condition,
    Instruction,
    Kind,
    Load,
    Next,
    SetCarry,
    SetFlags,
    Store,
    StoreUnknown,
)
from mauve.wcet.hardware.classes import CONDITION_FAILED, timing_class
from mauve.wcet.hardware.core import Core, CoreModel, Timing
from mauve.wcet.hardware.memory import Bytes, MemoryMap

Accesses = Mapping[tuple[int, int], Bytes]
"""(instruction address, index of the micro-operation) -> the bytes it may touch; missing: any."""

FETCH_AHEAD = 12
"""Bytes after an instruction's first that the core may be fetching while it executes: two A32 instructions ahead."""

REFILL_FETCHES = 2
"""Fetches at the target of a transfer of control that belong to the transfer itself (bus model: 2S + 1N)."""


@dataclass(frozen=True, slots=True)
class Delay:
    """A result that instructions right behind cannot read for `early` cycles (`late`: as store data or accumulator)."""

    register: int
    early: int
    late: int


@dataclass(frozen=True, slots=True)
class Step:
    """An instruction as the cost of a block sees it. `busy` counts cycles during which delays run off, `waits` those in
    which the core stands still for a memory. `failed` is the cost when the condition does not hold."""

    condition: Condition
    sets_flags: bool
    transfers_control: bool
    reads: tuple[int, ...]
    late_reads: tuple[int, ...]
    writes: tuple[int, ...]
    delays: tuple[Delay, ...]
    busy: int
    waits: int
    failed_busy: int
    failed_waits: int


@dataclass(frozen=True, slots=True)
class Untimed:
    """An instruction for which the core's table has no entry."""

    timing_class: str


def make_step(instruction: Instruction, core: Core, memory: MemoryMap, accesses: Accesses) -> Step | Untimed:
    """The cost of an instruction; waits at the target of a transfer of control are not in it (bus model)."""
    name = timing_class(instruction)
    timing, failed = core.timing.get(name), core.timing[CONDITION_FAILED]
    if timing is None:
        return Untimed(name)
    traits = instruction.traits
    code_wait = memory.code_wait(instruction.address, instruction.address + FETCH_AHEAD - 1)
    fetch = _bus_cycles if core.model is CoreModel.BUS else _pipeline_cycles
    transfers_control = not isinstance(instruction.flow, Next)
    busy, fetches = fetch(timing, core, traits.transfers, transfers_control)
    failed_busy, failed_fetches = fetch(failed, core, 0, False)
    return Step(
        condition=instruction.condition,
        sets_flags=traits.sets_flags or any(isinstance(op, (SetFlags, SetCarry)) for op in instruction.ops),
        transfers_control=transfers_control,
        reads=traits.reads,
        late_reads=traits.late_reads,
        writes=traits.writes,
        delays=_delays(timing, instruction),
        busy=busy,
        waits=fetches * code_wait + _data_waits(instruction, memory, accesses),
        failed_busy=failed_busy,
        failed_waits=failed_fetches * code_wait,
    )


def _bus_cycles(timing: Timing, core: Core, transfers: int, transfers_control: bool) -> tuple[int, int]:
    """Cycles without wait states, and the fetches at the instruction itself, of a core with one bus: S, N and I cycles
    are a cycle each; waits come on top of fetches and data accesses."""
    fetches = timing.fetch_s.at(transfers, core.multiplier) + timing.fetch_n.at(transfers, core.multiplier)
    data = timing.data_s.at(transfers, core.multiplier) + timing.data_n.at(transfers, core.multiplier)
    internal = timing.internal.at(transfers, core.multiplier)
    return fetches + data + internal, fetches - (REFILL_FETCHES if transfers_control else 0)


def _pipeline_cycles(timing: Timing, core: Core, transfers: int, transfers_control: bool) -> tuple[int, int]:
    """Cycles without wait states, and instruction fetches, of a pipelined core. The fetches thrown away by a transfer
    of control lie behind the instruction; those of its target belong to the instructions there."""
    del transfers_control
    return timing.cycles.at(transfers, core.multiplier), timing.fetches.at(transfers, core.multiplier)


def _data_waits(instruction: Instruction, memory: MemoryMap, accesses: Accesses) -> int:
    """Wait states of all data accesses: each word moved waits for the slowest memory it may reach."""
    waits = beats = 0
    for index, op in enumerate(instruction.ops):
        if isinstance(op, (Load, Store, StoreUnknown)):
            here = (op.size + 3) // 4
            waits += here * memory.data_wait(accesses.get((instruction.address, index)), not isinstance(op, Load))
            beats += here
    # Words that no micro-operation describes (coprocessor and FPU transfers, preloads) may come from anywhere.
    moved = max(instruction.traits.transfers, int(instruction.traits.kind is Kind.PRELOAD))
    missing = max(0, moved - beats)
    return waits + missing * max(memory.slowest_read, memory.slowest_write)


def _delays(timing: Timing, instruction: Instruction) -> tuple[Delay, ...]:
    """The results of an instruction that are late: loaded ones for a load, all for a multiply."""
    if timing.delay == 0 and timing.late_delay == 0:
        return ()
    results = instruction.traits.loaded or instruction.traits.writes
    late = results[-1:] if timing.last_only else results
    return tuple(Delay(register, timing.delay, timing.late_delay) for register in late)
