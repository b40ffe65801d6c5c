"""Registers whose content may still be read: where paths meet, the others need not be compared or kept."""

from __future__ import annotations

from dataclasses import fields

from mauve.wcet.binary.graph import Cfg, EdgeKind
from mauve.wcet.binary.microop import (
    CompareBranch,
    Compute,
    Condition,
    IndirectCall,
    IndirectJump,
    Instruction,
    Load,
    MicroOp,
    Operand,
    SetCarry,
    SetFlags,
    Store,
    StoreUnknown,
    TableJump,
)

CORE = 15
"""Registers r0 to r14."""
_ALL = (1 << CORE) - 1


def dead_registers(cfg: Cfg) -> list[tuple[int, ...]]:
    """Per block the registers that nothing reads from its start on before they are written. A callee or a
    caller may read all."""
    following: dict[int, list[int]] = {}
    behind = [0] * len(cfg.blocks)
    for edge in cfg.edges:
        if edge.kind in (EdgeKind.CALL, EdgeKind.TAIL_CALL, EdgeKind.RETURN) or edge.callees:
            behind[edge.source] = _ALL
        if edge.target >= 0:
            following.setdefault(edge.source, []).append(edge.target)
    entering = [_before(block.instructions, behind[block.id]) for block in cfg.blocks]
    changed = True
    while changed:
        changed = False
        for block in reversed(cfg.blocks):
            out = behind[block.id]
            for target in following.get(block.id, ()):
                out |= entering[target]
            if out != behind[block.id]:
                behind[block.id], changed = out, True
                entering[block.id] = _before(block.instructions, out)
    return [tuple(r for r in range(CORE) if not live >> r & 1) for live in entering]


def _before(instructions: tuple[Instruction, ...], live: int) -> int:
    for instruction in reversed(instructions):
        live |= _asked(instruction)
        for op in reversed(instruction.ops):
            if instruction.condition is Condition.AL and isinstance(op, Compute | Load) and op.dst < CORE:
                live &= ~(1 << op.dst)
            live |= _read(op)
    return live


def _asked(instruction: Instruction) -> int:
    """The registers that tell where control goes."""
    match instruction.flow:
        case IndirectJump(target) | IndirectCall(target):
            return _bits(target)
        case TableJump(table, index):
            return _bits(table, index)
        case CompareBranch(register):
            return _bits(register)
    return 0


def _read(op: MicroOp) -> int:
    match op:
        case Compute(_, _, a, b) | SetFlags(_, a, b) | SetCarry(_, a, b):
            return _bits(a, b)
        case Load(_, address) | StoreUnknown(address):
            return _bits(address)
        case Store(address, value):
            return _bits(address, value)
    # Of the others (FPU, DSP) every number that could be a register counts as one.
    return _bits(*(v for one in fields(op) if type(v := getattr(op, one.name)) is int))


def _bits(*operands: Operand) -> int:
    return sum({1 << operand for operand in operands if isinstance(operand, int) and 0 <= operand < CORE})


__all__ = ["dead_registers"]
