"""Which condition flags instructions read and set, and which registers they read: what is worth keeping."""

from __future__ import annotations

from mauve.wcet.binary.floats import FloatFlags
from mauve.wcet.binary.graph import Cfg, EdgeKind
from mauve.wcet.binary.microop import (
    Compute,
    Condition,
    FlagKind,
    Instruction,
    Load,
    MicroOp,
    Op,
    Operand,
    SetCarry,
    SetFlags,
    Store,
    StoreUnknown,
)

NZ, CV = 1, 2
_READS = {0: NZ, 1: NZ, 2: CV, 3: CV, 4: NZ, 5: NZ, 6: CV, 7: CV, 14: 0}


def live_flags(cfg: Cfg) -> list[int]:
    """Per block which of the flags (N and Z, C and V) may be read behind it. A call or return may lead to a reader."""
    following: dict[int, list[int]] = {}
    live = [0] * len(cfg.blocks)
    for edge in cfg.edges:
        if edge.kind in (EdgeKind.CALL, EdgeKind.RETURN, EdgeKind.TAIL_CALL):
            live[edge.source] = NZ | CV
        elif edge.target >= 0:
            following.setdefault(edge.source, []).append(edge.target)
    changed = True
    entering = [read_before(block.instructions, 0) for block in cfg.blocks]
    while changed:
        changed = False
        for block in reversed(cfg.blocks):
            out = live[block.id]
            for target in following.get(block.id, ()):
                out |= entering[target]
            before = read_before(block.instructions, out)
            if out != live[block.id] or before != entering[block.id]:
                live[block.id], entering[block.id], changed = out, before, True
    return live


def read_before(instructions: tuple[Instruction, ...], live: int) -> int:
    """The flags that may be read from the start of instructions on, given those read behind them."""
    for instruction in reversed(instructions):
        live = instruction_before(instruction, live)
    return live


def instruction_before(instruction: Instruction, live: int) -> int:
    """The flags that may be read from an instruction on, given those read behind it."""
    always = instruction.condition is Condition.AL
    for op in reversed(instruction.ops):
        live = op_before(op, live, always)
    return live | _READS.get(instruction.condition.value, NZ | CV)


def op_before(op: MicroOp, live: int, always: bool) -> int:
    """The flags that may be read from a micro-operation on; `always`: its instruction has no condition."""
    match op:
        case SetFlags(kind):
            if always:
                live &= ~NZ if kind in (FlagKind.LOGIC, FlagKind.WIDE) else 0
            return live | (CV if kind in (FlagKind.ADC, FlagKind.SBC) else 0)
        case SetCarry():
            return live | CV if live & CV else live
        case Compute(op=Op.ADC | Op.SBC | Op.RRX):
            return live | CV
    return live


def sets_flags(instruction: Instruction) -> bool:
    """Whether an instruction changes the condition flags."""
    return any(isinstance(op, SetFlags | SetCarry | FloatFlags) for op in instruction.ops)


def sharing(instructions: tuple[Instruction, ...]) -> frozenset[int]:
    """The positions of conditional instructions behind which another one asks the same flags. Such a block is run for
    each answer, from its start: so nothing is stored before them."""
    found: set[int] = set()
    group: list[int] = []
    for position, instruction in enumerate(instructions):
        if instruction.condition is not Condition.AL:
            found.update(group)
            group = [position]
        if sets_flags(instruction):
            group = []
        if any(isinstance(op, Store | StoreUnknown) for op in instruction.ops):
            if instruction.condition is not Condition.AL:
                found.update(group)
            break
    return frozenset(found)


def sources_of(ops: tuple[MicroOp, ...]) -> set[int]:
    """The core registers that micro-operations read."""
    found: list[Operand] = []
    for op in ops:
        match op:
            case Compute(_, _, a, b) | SetFlags(_, a, b) | SetCarry(_, a, b):
                found += [a, b]
            case Load(_, address) | StoreUnknown(address):
                found.append(address)
            case Store(address, value):
                found += [address, value]
    return {operand for operand in found if isinstance(operand, int) and operand < 16}
