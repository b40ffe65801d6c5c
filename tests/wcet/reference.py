"""A second opinion on time: executed instructions, one by one, through a simulation written apart from the cost model.

The emulator executes a function; every instruction is seen with its flags, its memory accesses and the multiplier's
operand. `bus_cycles` counts S, N and I cycles of an ARM7TDMI (figures measured on hardware), `pipeline_cycles` keeps
a scoreboard of an ARM9: when each register is ready, in absolute time. What they say of an execution is never above a
bound.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from emulator import Argument, Emulator

from mauve.wcet.binary.decode import Decoded, Decoder
from mauve.wcet.binary.microop import Condition, Instruction, Kind, Next
from mauve.wcet.hardware.board import Board
from mauve.wcet.hardware.classes import timing_class
from mauve.wcet.hardware.core import Core

RETURN_TO = 0x7000_0000


@dataclass(slots=True)
class Executed:
    """An instruction that was issued. `acted`: its condition held. `accesses` are (address, is a store)."""

    instruction: Instruction
    acted: bool
    multiplier: int
    accesses: list[tuple[int, bool]] = field(default_factory=list)


class Tracer:
    """An emulator whose runs are recorded instruction by instruction."""

    def __init__(self, elf: Path, cpu: str) -> None:
        self.emulator = Emulator(elf, cpu)
        self._decoder = Decoder(self._read)
        self._known: dict[tuple[int, bool], Instruction] = {}

    def _read(self, address: int, size: int) -> bytes | None:
        return self.emulator.read(address, size)

    def run(self, function: str | int, args: Sequence[Argument]) -> list[Executed]:
        from unicorn import UC_HOOK_CODE, UC_HOOK_MEM_READ, UC_HOOK_MEM_WRITE, UC_MEM_WRITE
        from unicorn import arm_const as arm

        trace: list[Executed] = []
        uc: Any = self.emulator._uc

        def on_code(_uc: Any, address: int, _size: int, _data: object) -> None:
            if address == RETURN_TO:
                return
            cpsr = uc.reg_read(arm.UC_ARM_REG_CPSR)
            instruction = self._decode(address, bool(cpsr & 0x20))
            register = instruction.traits.multiplier
            operand = uc.reg_read(arm.UC_ARM_REG_R0 + register) if register is not None else 0
            trace.append(Executed(instruction, acts(instruction.condition, cpsr), operand))

        def on_memory(_uc: Any, access: int, address: int, _size: int, _value: int, _data: object) -> None:
            trace[-1].accesses.append((address, access == UC_MEM_WRITE))

        hooks = [uc.hook_add(UC_HOOK_CODE, on_code), uc.hook_add(UC_HOOK_MEM_READ | UC_HOOK_MEM_WRITE, on_memory)]
        try:
            self.emulator.call(function, args)
        finally:
            for hook in hooks:
                uc.hook_del(hook)
        return trace

    def _decode(self, address: int, thumb: bool) -> Instruction:
        if (address, thumb) not in self._known:
            decoded = self._decoder.decode(address, thumb)
            assert isinstance(decoded, Decoded), decoded
            self._known[address, thumb] = decoded.instruction
        return self._known[address, thumb]


def acts(condition: Condition, cpsr: int) -> bool:
    """Whether a condition holds in a program status word."""
    n, z, c, v = (bool(cpsr >> bit & 1) for bit in (31, 30, 29, 28))
    table: dict[Condition, bool] = {
        Condition.EQ: z,
        Condition.NE: not z,
        Condition.CS: c,
        Condition.CC: not c,
        Condition.MI: n,
        Condition.PL: not n,
        Condition.VS: v,
        Condition.VC: not v,
        Condition.HI: c and not z,
        Condition.LS: not c or z,
        Condition.GE: n == v,
        Condition.LT: n != v,
        Condition.GT: not z and n == v,
        Condition.LE: z or n != v,
    }
    return table.get(condition, True)


def early_termination(operand: int, signed: bool) -> int:
    """Multiplier cycles m of an ARM7TDMI: by the leading bytes of the operand that are 0 (or all 1 where signed)."""
    for m, low in ((1, 8), (2, 16), (3, 24)):
        top = operand >> low
        if top == 0 or (signed and top == (1 << (32 - low)) - 1):
            return m
    return 4


Wait = Callable[[int, bool], int]


def waits_of(board: Board) -> Wait:
    """Wait states of an access at an address."""

    def wait(address: int, store: bool) -> int:
        for memory in board.memories:
            if memory.start <= address < memory.end:
                return memory.write_wait if store and memory.write_wait is not None else memory.wait
        return 0

    return wait


def bus_cycles(trace: Sequence[Executed], board: Board) -> int:
    """Cycles of an executed function on an ARM7TDMI, the refill at its return counted without wait states."""
    wait = waits_of(board)
    total = 0
    for index, step in enumerate(trace):
        instruction, traits = step.instruction, step.instruction.traits
        fetches = 2 if traits.kind is Kind.BRANCH_LINK and instruction.thumb else 1
        total += fetches * (1 + wait(instruction.address, False))
        if not step.acted:
            continue
        for address, store in step.accesses:
            total += 1 + wait(address, store)
        match traits.kind:
            case Kind.MUL | Kind.MLA | Kind.LONG_MUL | Kind.LONG_MLA:
                signed = "umull" not in instruction.text and "umlal" not in instruction.text
                more = {Kind.MUL: 0, Kind.MLA: 1, Kind.LONG_MUL: 1, Kind.LONG_MLA: 2}[traits.kind]
                total += early_termination(step.multiplier, signed) + more
            case Kind.LOAD | Kind.LOAD_MULTIPLE | Kind.SWAP:
                total += 1
            case Kind.ALU if traits.shifts_by_register:
                total += 1
        if not isinstance(instruction.flow, Next):
            target = trace[index + 1].instruction.address if index + 1 < len(trace) else None
            total += 2 * (1 + (0 if target is None else wait(target, False)))
    return total


def pipeline_cycles(trace: Sequence[Executed], core: Core, board: Board) -> int:
    """Cycles of an executed function on a pipelined core: each instruction starts when what it reads is ready."""
    wait = waits_of(board)
    now = 0
    ready: dict[int, tuple[int, int]] = {}
    for step in trace:
        instruction, traits = step.instruction, step.instruction.traits
        entry = core.timing[timing_class(instruction) if step.acted else "condition_failed"]
        start = now
        for register in traits.reads:
            start = max(start, ready.get(register, (0, 0))[0])
        for register in traits.late_reads:
            start = max(start, ready.get(register, (0, 0))[1])
        m = early_termination(step.multiplier, True) if core.multiplier else 0
        stalls = wait(instruction.address, False)
        if step.acted:
            stalls += sum(wait(address, store) for address, store in step.accesses)
        now = start + entry.cycles.at(traits.transfers, m) + stalls
        if step.acted:
            for register in traits.writes:
                ready[register] = (now, now)
            late = traits.loaded or traits.writes
            for register in late[-1:] if entry.last_only else late:
                ready[register] = (now + entry.delay, now + entry.late_delay)
    return now
