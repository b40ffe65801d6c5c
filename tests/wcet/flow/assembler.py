"""A tiny assembler of micro-operations: code with labels to a control flow graph, and a concrete run that counts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from wcet import microop_machine as machine

from mauve.wcet.binary.graph import EXIT, Block, Cfg, Edge, EdgeKind
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.binary.microop import (
    Compute,
    Condition,
    FlagKind,
    Imm,
    IndirectJump,
    Instruction,
    Jump,
    Kind,
    Load,
    MicroOp,
    Next,
    Op,
    SetFlags,
    Store,
    Traits,
)

ALU = Traits(Kind.ALU)
BASE = 0x8000
STACK = 0x20001000


@dataclass
class Code:
    """Instructions in order; branches name labels."""

    lines: list[tuple[Condition, tuple[MicroOp, ...], str | None]] = field(default_factory=list)
    labels: dict[str, int] = field(default_factory=dict)

    def label(self, name: str) -> None:
        self.labels[name] = len(self.lines)

    def do(self, *ops: MicroOp, when: Condition = Condition.AL) -> None:
        self.lines.append((when, ops, None))

    def move(self, dst: int, value: int | Imm, when: Condition = Condition.AL) -> None:
        self.do(Compute(Op.MOV, dst, value), when=when)

    def compute(self, op: Op, dst: int, a: int | Imm, b: int | Imm, when: Condition = Condition.AL) -> None:
        self.do(Compute(op, dst, a, b), when=when)

    def compare(self, a: int | Imm, b: int | Imm) -> None:
        self.do(SetFlags(FlagKind.SUB, a, b))

    def load(self, dst: int, slot: int) -> None:
        self.do(Compute(Op.ADD, 16, 13, Imm(slot & 0xFFFFFFFF)), Load(dst, 16))

    def store(self, source: int | Imm, slot: int) -> None:
        self.do(Compute(Op.ADD, 16, 13, Imm(slot & 0xFFFFFFFF)), Store(16, source))

    def branch(self, label: str, when: Condition = Condition.AL) -> None:
        self.lines.append((when, (), label))

    def cfg(self) -> Cfg:
        """The graph; the code ends with a return."""
        lines = [*self.lines, (Condition.AL, (), "return")]
        instructions = []
        for number, (condition, ops, label) in enumerate(lines):
            flow = Next()
            if label == "return":
                flow = IndirectJump(14, True, True)
            elif label is not None:
                flow = Jump(BASE + 4 * self.labels[label], False)
            instructions.append(Instruction(BASE + 4 * number, 4, False, f"i{number}", condition, ops, flow, ALU))
        leaders = {0, *self.labels.values()} | {i + 1 for i, line in enumerate(lines[:-1]) if line[2] is not None}
        return _graph(instructions, sorted(leaders))


def _graph(instructions: list[Instruction], leaders: list[int]) -> Cfg:
    number = {BASE + 4 * leader: i for i, leader in enumerate(leaders)}
    blocks, edges = [], []
    for i, leader in enumerate(leaders):
        end = leaders[i + 1] if i + 1 < len(leaders) else len(instructions)
        block = Block(i, tuple(instructions[leader:end]))
        last = block.instructions[-1]
        blocks.append(block)
        if isinstance(last.flow, Jump):
            edges.append(Edge(i, number[last.flow.target], EdgeKind.TAKEN))
        elif isinstance(last.flow, IndirectJump):
            edges.append(Edge(i, EXIT, EdgeKind.RETURN))
        if isinstance(last.flow, Next) or last.condition is not Condition.AL:
            edges.append(Edge(i, number[last.end], EdgeKind.FALL))
    return _reachable(Cfg("code", BASE, False, 0, tuple(blocks), tuple(edges)))


def _reachable(cfg: Cfg) -> Cfg:
    seen, work = {0}, [0]
    while work:
        block = work.pop()
        for edge in cfg.edges:
            if edge.source == block and edge.target != EXIT and edge.target not in seen:
                seen.add(edge.target)
                work.append(edge.target)
    number = {old: new for new, old in enumerate(sorted(seen))}
    blocks = tuple(Block(number[b.id], b.instructions) for b in cfg.blocks if b.id in seen)
    number[EXIT] = EXIT
    edges = tuple(Edge(number[e.source], number[e.target], e.kind) for e in cfg.edges if e.source in seen)
    return Cfg(cfg.name, cfg.address, cfg.thumb, 0, blocks, edges)


@dataclass
class Counts:
    """What a concrete run did: most header executions per entry and in all, by loop; blocks and edges taken."""

    per_entry: dict[int, int] = field(default_factory=dict)
    total: dict[int, int] = field(default_factory=dict)
    edges: set[int] = field(default_factory=set)
    finished: bool = False


def run(cfg: Cfg, nest: LoopNest, registers: list[int], read: Callable[[int], int], steps: int = 4000) -> Counts:
    """Execute from the entry with the registers given (r13 is the stack) for so many instructions."""
    values = [*registers, *([0] * (13 - len(registers))), STACK, 0] + [0] * 20
    state = machine.State(values, [0, 0, 0, 0], read)
    counts, current = Counts(), dict.fromkeys(range(len(nest.loops)), 0)
    headers = {loop.header: loop for loop in nest.loops}
    block, came_from = cfg.entry, EXIT
    at = {b.address: b.id for b in cfg.blocks}
    while steps > 0:
        loop = headers.get(block)
        if loop is not None:
            current[loop.id] = current[loop.id] + 1 if came_from in loop.blocks else 1
            counts.per_entry[loop.id] = max(counts.per_entry.get(loop.id, 0), current[loop.id])
            counts.total[loop.id] = counts.total.get(loop.id, 0) + 1
        taken = False
        for instruction in cfg.blocks[block].instructions:
            steps -= 1
            taken = bool(machine._holds(instruction.condition, state.flags))
            if isinstance(instruction.flow, Next):
                machine.execute(instruction, state)
        last = cfg.blocks[block].instructions[-1]
        target = EXIT if isinstance(last.flow, IndirectJump) else None
        if isinstance(last.flow, Jump) and taken:
            target = at[last.flow.target]
        elif target is None:
            target = at[last.end]
        jumps = isinstance(last.flow, Jump) and taken
        wanted = EdgeKind.RETURN if target == EXIT else EdgeKind.TAKEN if jumps else EdgeKind.FALL
        counts.edges.add(next(i for i, e in enumerate(cfg.edges) if e.source == block and e.kind is wanted))
        if target == EXIT:
            counts.finished = True
            return counts
        block, came_from = target, block
    return counts
