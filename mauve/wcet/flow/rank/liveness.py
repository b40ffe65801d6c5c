"""Which registers, and whether the flags, are read later: so that paths which differ only in dead values merge."""

from __future__ import annotations

from mauve.wcet.binary.graph import EXIT, Cfg
from mauve.wcet.binary.microop import (
    CompareBranch,
    Compute,
    Condition,
    FlagKind,
    Imm,
    IndirectCall,
    IndirectJump,
    Instruction,
    Load,
    Op,
    Operand,
    SetCarry,
    SetFlags,
    Store,
    StoreUnknown,
    TableJump,
)

FLAGS = -1
"""Stands for the condition flags among register numbers."""

_ARGUMENTS = frozenset({0, 1, 2, 3})


def live_registers(cfg: Cfg) -> tuple[frozenset[int], ...]:
    """For each block the registers that some path from its start reads first. Nothing is live behind an exit."""
    successors: dict[int, list[int]] = {}
    predecessors: dict[int, list[int]] = {}
    calls: set[int] = set()
    for edge in cfg.edges:
        if edge.target != EXIT:
            successors.setdefault(edge.source, []).append(edge.target)
            predecessors.setdefault(edge.target, []).append(edge.source)
        if edge.kind.value in ("call", "tail"):
            calls.add(edge.source)
    effects = [_block_effect(block.instructions, block.id in calls) for block in cfg.blocks]
    live: list[frozenset[int]] = [frozenset()] * len(cfg.blocks)
    work = list(range(len(cfg.blocks)))
    while work:
        block = work.pop()
        out = frozenset[int]().union(*(live[t] for t in successors.get(block, ())))
        reads, writes = effects[block]
        before = reads | (out - writes)
        if before != live[block]:
            live[block] = before
            work.extend(predecessors.get(block, ()))
    return tuple(live)


def _block_effect(instructions: tuple[Instruction, ...], calls: bool) -> tuple[frozenset[int], frozenset[int]]:
    """Registers read before they are written, and registers surely written."""
    reads: set[int] = set()
    writes: set[int] = set()
    for instruction in instructions:
        read, written = _instruction_effect(instruction)
        reads |= read - writes
        writes |= written
    if calls:
        reads |= _ARGUMENTS - writes
    return frozenset(reads), frozenset(writes)


def _instruction_effect(instruction: Instruction) -> tuple[set[int], set[int]]:
    reads: set[int] = set()
    writes: set[int] = set()

    def read(*operands: Operand) -> None:
        reads.update(o for o in operands if not isinstance(o, Imm) and o not in writes)

    def flags() -> None:
        if FLAGS not in writes:
            reads.add(FLAGS)

    if instruction.condition is not Condition.AL:
        flags()
    for op in instruction.ops:
        match op:
            case Compute():
                read(op.a, op.b)
                if op.op in (Op.ADC, Op.SBC, Op.RRX):
                    flags()
                writes.add(op.dst)
            case Load(dst, address):
                read(address)
                writes.add(dst)
            case Store(address, value):
                read(address, value)
            case StoreUnknown(address):
                read(address)
            case SetFlags(kind, a, b):
                read(a, b)
                if kind in (FlagKind.ADD, FlagKind.SUB, FlagKind.UNKNOWN):
                    writes.add(FLAGS)
                else:
                    flags()
            case SetCarry(_, value, amount):
                read(value, amount)
                flags()
    match instruction.flow:
        case CompareBranch(register):
            read(register)
        case IndirectJump(target) | IndirectCall(target):
            read(target)
        case TableJump(table, index):
            read(table, index)
    reads.update(r for r in instruction.traits.reads if r not in writes)
    return reads, writes if instruction.condition is Condition.AL else set()
