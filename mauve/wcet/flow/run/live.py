"""Registers whose content may still be read: where paths meet, the others need not be compared or kept."""

from __future__ import annotations

from collections.abc import Collection
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
_LEAVING = (EdgeKind.TAIL_CALL, EdgeKind.RETURN)


def dead_registers(cfg: Cfg) -> list[tuple[int, ...]]:
    """Per block the registers that nothing reads from its start on before they are written. A callee or a
    caller may read all."""
    live = live_registers(cfg, range(len(cfg.blocks)), leaves=True)
    return [tuple(r for r in range(CORE) if r not in live[block.id]) for block in cfg.blocks]


def live_registers(cfg: Cfg, inside: Collection[int], *, leaves: bool = False) -> dict[int, frozenset[int]]:
    """The registers that may be read from the start of each of some blocks on before they are written, in these
    blocks or by a callee; where control `leaves` the function by a caller as well."""
    following: dict[int, list[int]] = {}
    behind = dict.fromkeys(inside, 0)
    for edge in cfg.edges:
        if edge.source not in behind:
            continue
        if edge.callees or edge.kind is EdgeKind.CALL or (leaves and edge.kind in _LEAVING):
            behind[edge.source] = _ALL
        if edge.target in behind:
            following.setdefault(edge.source, []).append(edge.target)
    entering = {block: _before(cfg.blocks[block].instructions, behind[block]) for block in inside}
    changed = True
    while changed:
        changed = False
        for block in reversed(inside if isinstance(inside, range) else sorted(inside)):
            out = behind[block]
            for target in following.get(block, ()):
                out |= entering[target]
            if out != behind[block]:
                behind[block], changed = out, True
                entering[block] = _before(cfg.blocks[block].instructions, out)
    return {block: frozenset(r for r in range(CORE) if live >> r & 1) for block, live in entering.items()}


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


__all__ = ["CORE", "dead_registers", "live_registers"]
