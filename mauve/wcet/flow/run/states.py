"""Loops that go through few different states: none comes twice, or the loop never ends.

What a loop does next follows from what it found when an iteration began, as far as its decisions depend on that. Where
no value of this comes from elsewhere (a device, a store that may have gone to several places), two iterations that
begin alike go on alike for ever, and a program that returns has no such two. So a walk along a list whose links do not
change comes to each link once. rank/finite finds the same without a run.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields

from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import Loop
from mauve.wcet.binary.microop import (
    SP,
    CompareBranch,
    Compute,
    Condition,
    IndirectCall,
    IndirectJump,
    Instruction,
    Load,
    MicroOp,
    Op,
    Operand,
    SetCarry,
    SetFlags,
    Store,
    StoreUnknown,
    TableJump,
)
from mauve.wcet.flow.domain import Range
from mauve.wcet.flow.run.cells import parts_of
from mauve.wcet.flow.run.compile import C, N, V, Z
from mauve.wcet.flow.run.float_text import FLOAT_FLAGS, SLOTS
from mauve.wcet.flow.run.frames import Function
from mauve.wcet.flow.run.joining import pairs_since
from mauve.wcet.flow.run.layers import Half, Part, common, forgotten
from mauve.wcet.flow.run.live import CORE, live_registers
from mauve.wcet.flow.run.memory import DATA_END, STACK, Memory
from mauve.wcet.flow.run.paths import Path
from mauve.wcet.flow.run.repeats import Kept
from mauve.wcet.flow.run.words import Ranged, Stack

MOST_STATES = 1 << 16
"""More states tell of the width of words, not of a loop."""
FLAGS = -1
"""Stands for the condition flags among registers."""
_WITH_CARRY = (Op.ADC, Op.SBC, Op.RRX)


def few_states(memory: Memory, kept: Kept, path: Path, function: Function, loop: int) -> int | None:
    """How often the header of a loop can be come to, at most, in states that the kept path covers, this one included.
    `path` is the later one on which nothing new came."""
    if memory.vague != kept.vague:
        return None
    before = kept.path
    base = common(before.layer, path.layer)
    if forgotten(path.layer, base)[0] or forgotten(before.layer, base)[0]:
        return None
    sp = before.registers[SP]
    low = STACK + sp.offset if type(sp) is Stack else DATA_END
    changed: list[tuple[Part, Part]] = []
    for key, first, second in pairs_since(memory, before.layer, path.layer, base):
        if key >= low or key < DATA_END:
            whole = isinstance(first, list) or isinstance(second, list)
            changed += zip(parts_of(first), parts_of(second), strict=True) if whole else [(first, second)]  # type: ignore
    body = function.nest.loops[loop]
    wanted = deciding(function.cfg, body)
    if FLAGS in wanted and not {N, Z, C, V} <= {*function.code.stale[body.header]}:
        return None
    registers = wanted & live_registers(function.cfg, body.blocks)[body.header]
    changed += [(before.registers[n], path.registers[n]) for n in (*registers, *range(FLOAT_FLAGS, SLOTS))]
    return _states(changed)


def _states(parts: Iterable[tuple[Part, Part]]) -> int | None:
    """How many states there are of what was known first as one thing and later as another; None where they are too
    many."""
    states, seen = 1, set[int]()
    for first, second in parts:
        if isinstance(first, Half) and isinstance(second, Half):
            first, second = first.value, second.value
        if type(first) is int and type(second) is int and first == second:
            continue
        if type(first) is Stack and type(second) is Stack and first.offset == second.offset:
            continue
        values = first if isinstance(first, Range) else None
        if isinstance(first, Ranged):
            if first is second or id(first.base) in seen:
                continue
            seen.add(id(first.base))
            values = first.range
        if values is None:
            return None
        states *= values.size
        if states > MOST_STATES:
            return None
    return states


def deciding(cfg: Cfg, loop: Loop) -> frozenset[int]:
    """The registers (and FLAGS) on which it depends where control goes in a loop, in this iteration or a later one, and
    what it stores; all of them where it calls others."""
    sources: dict[int, set[int]] = {}
    wanted: set[int] = set()
    if any(edge.callees for edge in cfg.edges if edge.source in loop.blocks):
        return frozenset(range(CORE)) | {FLAGS}
    for block in loop.blocks:
        for instruction in cfg.blocks[block].instructions:
            wanted |= _asked(instruction)
            for op in instruction.ops:
                targets, read = _effect(op)
                if instruction.condition is not Condition.AL:
                    read |= {FLAGS}
                for target in targets:
                    sources.setdefault(target, set()).update(read)
                if isinstance(op, Store | StoreUnknown):
                    wanted |= read
    work = list(wanted)
    while work:
        for more in sources.get(work.pop(), ()):
            if more not in wanted:
                wanted.add(more)
                work.append(more)
    return frozenset(wanted)


def _asked(instruction: Instruction) -> set[int]:
    """What tells where control goes behind an instruction."""
    match instruction.flow:
        case IndirectJump(target) | IndirectCall(target):
            return {*_registers(target), FLAGS}
        case TableJump(table, index):
            return {*_registers(table, index), FLAGS}
        case CompareBranch(register):
            return {register}
    return {FLAGS} if instruction.condition is not Condition.AL else set()


def _effect(op: MicroOp) -> tuple[set[int], set[int]]:
    """What an operation changes, and what of that depends on what."""
    match op:
        case Compute(what, target, a, b):
            return {target}, _registers(a, b) | ({FLAGS} if what in _WITH_CARRY else set())
        case SetFlags(_, a, b) | SetCarry(_, a, b):
            return {FLAGS}, _registers(a, b)
        case Load(target, address):
            return {target}, _registers(address)
        case Store(address, value):
            return set(), _registers(address, value)
        case StoreUnknown(address):
            return set(), _registers(address)
    # Of the others (FPU, DSP) every number that could be a register counts as one that is read and changed.
    every = _registers(*(v for one in fields(op) if type(v := getattr(op, one.name)) is int)) | {FLAGS}
    return every, every


def _registers(*operands: Operand) -> set[int]:
    return {operand for operand in operands if type(operand) is int}


__all__ = ["few_states"]
