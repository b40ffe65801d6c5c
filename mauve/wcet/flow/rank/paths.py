"""Symbolic execution of an acyclic piece of a control flow graph: what a pass through a loop's body does.

The paths from a start block are followed with the values at its start as symbols. A loop inside is one step: everything
it may change becomes unknown at its header, then its blocks are walked once towards its exits. Paths that agree are
merged; where there are too many, they are joined and lose what differs. So a summary may say less than is true, never
something false.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from itertools import count

from mauve.wcet.binary.graph import EXIT, Cfg, Edge, EdgeKind
from mauve.wcet.binary.loops import Loop, LoopNest
from mauve.wcet.binary.microop import (
    CompareBranch,
    Compute,
    Condition,
    Imm,
    Instruction,
    Load,
    MicroOp,
    Next,
    Op,
    Operand,
    SetCarry,
    SetFlags,
    Store,
    StoreUnknown,
    SupervisorCall,
)
from mauve.wcet.clock import Deadline, check
from mauve.wcet.flow.locations import (
    AAPCS,
    WORD,
    Base,
    CallEffects,
    Cell,
    EntryValues,
    Interval,
    Location,
    NoValues,
    Region,
)
from mauve.wcet.flow.rank.flags import UNKNOWN, Flags, carry_term, facts, set_carry, set_flags, tells_all
from mauve.wcet.flow.rank.frame import Frame, analyse_frame
from mauve.wcet.flow.rank.liveness import FLAGS, live_registers
from mauve.wcet.flow.rank.merging import MOST_STATES, joined, merged, overlap, region_of
from mauve.wcet.flow.rank.terms import (
    ZERO,
    FrameBase,
    Fresh,
    Kind,
    Relation,
    Term,
    add,
    atom,
    bounds,
    compute,
    number,
    scale,
    signed,
    subtract,
    variable,
)

FEW_PASSES = 6
"""More passes than this through a loop are summarised again, coarsely."""

ALL_FRAME = Region(Base.SP, -WORD, WORD)
ALL_MEMORY = Region(Base.ABSOLUTE, 0, WORD)


@dataclass(slots=True)
class State:
    """Registers and cells as terms, flags, and relations that hold on the way here.

    `lost` are parts of memory whose contents at the start are gone; a cell neither in `cells` nor lost still has its
    value of the start.
    """

    registers: dict[int, Term]
    cells: dict[Cell, Term] = field(default_factory=dict)
    lost: tuple[Region, ...] = ()
    flags: Flags = UNKNOWN
    known: frozenset[Relation] = frozenset()
    vague: bool = False
    """the relations do not tell all decisions on the way here"""

    def copy(self) -> State:
        """A state that can be changed alone."""
        return State(dict(self.registers), dict(self.cells), self.lost, self.flags, self.known, self.vague)


@dataclass(frozen=True, slots=True)
class Changes:
    """What a piece of code may change: registers (FLAGS is always among them) and memory."""

    registers: frozenset[int]
    memory: frozenset[Region]


@dataclass(slots=True)
class Summaries:
    """The passes of loops, by header; `joined` are those for which paths had to be joined."""

    passes: dict[int, list[State]] = field(default_factory=dict)
    joined: set[int] = field(default_factory=set)


@dataclass(slots=True)
class Program:
    """A function and everything about it that all summaries share."""

    cfg: Cfg
    nest: LoopNest
    values: EntryValues
    effects: Mapping[int, CallEffects]
    frame: Frame
    live: tuple[frozenset[int], ...]
    leaving: Mapping[int, tuple[int, ...]]
    back_edges: frozenset[int]
    inductive: Callable[[Program, Loop, list[State]], Mapping[Location, Interval]]
    """intervals that hold at a loop's header in every iteration, given the states in which it is entered"""
    fresh: count[int] = field(default_factory=count)
    reads: dict[int, tuple[Term, int]] = field(default_factory=dict)
    """of unknowns that were read somewhere: the address, in terms of the values at the start, and the size"""
    summaries: Summaries = field(default_factory=Summaries)
    deadline: Deadline = None
    coarse: bool = False
    """a conditional instruction that sets no flags does not part the paths"""
    joined: bool = False
    """paths had to be joined in the summary that is being made"""

    def unknown(self, low: int = 0, high: int = WORD - 1) -> Term:
        """A value about which nothing else is known."""
        return atom(Fresh(next(self.fresh), low, high))


def nothing_inductive(program: Program, loop: Loop, states: list[State]) -> Mapping[Location, Interval]:
    """No intervals."""
    return {}


def prepare(
    cfg: Cfg,
    nest: LoopNest,
    values: EntryValues | None = None,
    effects: Mapping[int, CallEffects] | None = None,
    inductive: Callable[[Program, Loop, list[State]], Mapping[Location, Interval]] = nothing_inductive,
) -> Program:
    """Collect what summaries of this function need."""
    leaving: dict[int, list[int]] = {}
    for index, edge in enumerate(cfg.edges):
        leaving.setdefault(edge.source, []).append(index)
    effects = effects or {}
    return Program(
        cfg,
        nest,
        values or NoValues(),
        effects,
        analyse_frame(cfg, effects),
        live_registers(cfg),
        {block: tuple(edges) for block, edges in leaving.items()},
        frozenset(index for loop in nest.loops for index in loop.back_edges),
        inductive,
    )


def initial_state(program: Program, block: int) -> State:
    """Every register at the start of `block` as a symbol, pointers into the frame as such."""
    offsets = dict(program.frame.offsets[block])
    offset = program.values.sp_offset(block)
    if offset is not None:
        offsets[13] = offset
    registers = {r: add(atom(FrameBase()), number(offsets[r])) if r in offsets else variable(r) for r in range(15)}
    return State(registers)


def summarise_loop(program: Program, loop: Loop) -> list[State]:
    """The states at the ends of the back edges of `loop`, in terms of the values at the start of its header."""
    summaries = program.summaries
    if loop.header not in summaries.passes:
        outside, program.joined = program.joined, False
        states = _passes(program, loop)
        if len(states) > FEW_PASSES and not program.coarse:
            program.joined, program.coarse = True, True
            coarse = _passes(program, loop)
            program.coarse = False
            states = coarse if len(coarse) < len(states) else states
        summaries.passes[loop.header] = states
        if program.joined:
            summaries.joined.add(loop.header)
        program.joined |= outside
    program.joined |= loop.header in summaries.joined
    return [state.copy() for state in summaries.passes[loop.header]]


def _passes(program: Program, loop: Loop) -> list[State]:
    states: list[State] = []
    for edge, state in _walk(program, loop.header, loop.blocks, initial_state(program, loop.header), None):
        if edge in loop.back_edges:
            states.append(state)
    return merged(program, states, program.live[loop.header])


def exit_states(program: Program, loop: Loop) -> list[State]:
    """The states on the edges that lead out of a loop, in terms of the values at the start of its header."""
    start = initial_state(program, loop.header)
    return [s for e, s in _walk(program, loop.header, loop.blocks, start, None) if e not in loop.back_edges]


def entry_states(program: Program) -> dict[int, list[State]]:
    """For each loop header, the states when control comes from outside, in terms of values at the function's entry."""
    if program.nest.irreducible:
        return {}
    headers: dict[int, list[State]] = {}
    start = program.cfg.entry
    state = initial_state(program, start)
    everything = frozenset(range(len(program.cfg.blocks)))
    for _ in _walk(program, start, everything, state, headers):
        pass
    return headers


# ----------------------------------------------------------------------------------------------------------- walking
def _walk(
    program: Program, start: int, blocks: frozenset[int], state: State, headers: dict[int, list[State]] | None
) -> Iterable[tuple[int, State]]:
    """Follow the edges inside `blocks` from `start` without back edges; yields those not followed, with their states.

    `headers` collects the states in which loops are entered, also one at `start`. Without it the blocks are the body of
    a loop at `start`, whose passes are followed.
    """
    pending: dict[int, list[State]] = {start: [state]}
    loops = {loop.header: loop for loop in program.nest.loops}
    for block in _order(program, start, blocks):
        states = merged(program, pending.pop(block, []), program.live[block])
        if not states:
            continue
        check(program.deadline, program.cfg.blocks[block].address, program.cfg.name)
        if block in loops and (block != start or headers is not None):
            if headers is not None:
                headers[block] = [s.copy() for s in states]
            _enter_loop(program, loops[block], states)
            states = merged(program, states, program.live[block])
        for edge, after in _execute_block(program, block, states):
            target = program.cfg.edges[edge].target
            if edge in program.back_edges or target not in blocks:
                yield edge, after
            else:
                pending.setdefault(target, []).append(after)


def _enter_loop(program: Program, loop: Loop, states: list[State]) -> None:
    """Turn states in which a loop is entered into states at its header in any iteration."""
    ranges = program.inductive(program, loop, states)
    changes = loop_changes(program, loop)
    for state in states:
        forget(program, state, changes)
        for location, values in ranges.items():
            if isinstance(location, Cell):
                if any(overlap(location, region) for region in changes.memory):
                    _lose(state, region_of(location))
                    state.cells[location] = program.unknown(values.low, values.high)
            elif location in changes.registers:
                state.registers[location] = program.unknown(values.low, values.high)


def _order(program: Program, start: int, blocks: frozenset[int]) -> list[int]:
    """Reverse postorder of the blocks reached from `start` without back edges."""
    seen = {start}
    order: list[int] = []
    stack = [(start, iter(program.leaving.get(start, ())))]
    while stack:
        block, edges = stack[-1]
        for edge in edges:
            target = program.cfg.edges[edge].target
            if edge not in program.back_edges and target in blocks and target not in seen:
                seen.add(target)
                stack.append((target, iter(program.leaving.get(target, ()))))
                break
        else:
            order.append(block)
            stack.pop()
    return order[::-1]


def _execute_block(program: Program, block: int, states: list[State]) -> Iterable[tuple[int, State]]:
    instructions = program.cfg.blocks[block].instructions
    for instruction in instructions[:-1]:
        states = [after for state in states for after in _step(program, instruction, state)]
        if len(states) > 2 * MOST_STATES:
            states = merged(program, states, None)
    last = instructions[-1]
    edges = [(index, program.cfg.edges[index]) for index in program.leaving.get(block, ())]
    is_table = sum(edge.kind is not EdgeKind.FALL for _, edge in edges) > 1
    for state in states:
        if isinstance(last.flow, Next | SupervisorCall):
            for after in _step(program, last, state):
                for index, _ in edges:
                    yield index, after.copy()
            continue
        for index, edge in edges:
            taken = after_edge(program, last, index, edge, state)
            if taken is not None:
                taken.vague |= is_table and edge.kind is not EdgeKind.FALL
                yield index, taken


def after_edge(program: Program, last: Instruction, index: int, edge: Edge, state: State) -> State | None:
    """The state behind `edge`, which leaves its block with the branch or call `last`; None when it cannot be taken."""
    falls = edge.kind is EdgeKind.FALL
    after = state.copy()
    if isinstance(last.flow, CompareBranch):
        kind = Kind.NE if last.flow.nonzero != falls else Kind.EQ
        value = after.registers.get(last.flow.register)
        after.vague |= value is None
        if value is not None and not _learn(after, (Relation(kind, value, ZERO),)):
            return None
    elif last.condition is not Condition.AL:
        condition = last.condition.negated if falls else last.condition
        if not _learn(after, facts(state.flags, condition)):
            return None
        after.vague |= not tells_all(state.flags, condition)
    if falls:
        return after
    _perform(program, last, after)
    if edge.kind in (EdgeKind.CALL, EdgeKind.TAIL_CALL):
        _call(program, after, program.effects.get(index, AAPCS))
    return after


def _step(program: Program, instruction: Instruction, state: State) -> list[State]:
    """The states after an instruction that does not branch: two when it is conditional and both cases are possible."""
    result = []
    if instruction.condition is not Condition.AL:
        state.vague |= not tells_all(state.flags, instruction.condition)
        skipped = state.copy()
        if _learn(skipped, facts(state.flags, instruction.condition.negated)):
            result.append(skipped)
        if not _learn(state, facts(state.flags, instruction.condition)):
            return result
    _perform(program, instruction, state)
    if isinstance(instruction.flow, SupervisorCall):
        _call(program, state, AAPCS)
    if program.coarse and result and state.flags == result[0].flags:
        return [joined(program, [state, *result])]
    return [state, *result]


def _learn(state: State, relations: tuple[Relation, ...]) -> bool:
    """Add what holds; False when it contradicts what is known."""
    for relation in relations:
        if relation in state.known:
            continue
        if any(other in state.known for other in _excluded(relation)) or decide(relation) is False:
            return False
        state.known |= {relation}
    return True


def _excluded(relation: Relation) -> tuple[Relation, ...]:
    """Relations between the same terms that cannot hold together with this one."""
    a, b = relation.a, relation.b
    match relation.kind:
        case Kind.EQ:
            kinds = (Kind.NE, Kind.ULT, Kind.SLT)
            return tuple(Relation(k, *pair) for k in kinds for pair in ((a, b), (b, a)))
        case Kind.NE:
            return (Relation(Kind.EQ, a, b), Relation(Kind.EQ, b, a))
        case Kind.ULT | Kind.SLT:
            return (
                relation.negated,
                Relation(relation.kind, b, a),
                Relation(Kind.EQ, a, b),
                Relation(Kind.EQ, b, a),
            )
        case _:
            return (relation.negated,)


def decide(relation: Relation) -> bool | None:
    """Whether the relation holds for all values or for none of them, as far as constants and static ranges tell."""
    if relation.a == relation.b:
        return relation.kind in (Kind.EQ, Kind.UGE, Kind.SGE)
    a, b = bounds(relation.a), bounds(relation.b)
    if relation.kind in (Kind.EQ, Kind.NE):
        (al, ah), (bl, bh) = a.unsigned, b.unsigned
        if ah < bl or bh < al or bounds(subtract(relation.a, relation.b)).unsigned[0] > 0:
            return relation.kind is Kind.NE
        return (relation.kind is Kind.EQ) if al == ah == bl == bh else None
    (al, ah), (bl, bh) = (a.signed, b.signed) if relation.kind in (Kind.SLT, Kind.SGE) else (a.unsigned, b.unsigned)
    less = True if ah < bl else False if al >= bh else None
    return less if relation.kind in (Kind.ULT, Kind.SLT) or less is None else not less


# --------------------------------------------------------------------------------------------------------- executing
def _perform(program: Program, instruction: Instruction, state: State) -> None:
    for index, op in enumerate(instruction.ops):
        _micro(program, instruction.address, index, op, state)
    for temporary in [r for r in state.registers if r > 15]:
        del state.registers[temporary]


def _value(program: Program, state: State, operand: Operand) -> Term:
    if isinstance(operand, Imm):
        return number(operand.value)
    if operand not in state.registers:
        state.registers[operand] = program.unknown()
    return state.registers[operand]


def _micro(program: Program, address: int, index: int, op: MicroOp, state: State) -> None:
    match op:
        case Compute():
            a, b = _value(program, state, op.a), _value(program, state, op.b)
            state.registers[op.dst] = _computed(program, op.op, a, b, state.flags)
        case Load(dst, where, size, is_signed):
            loaded = _load(program, state, _value(program, state, where), size)
            if is_signed and size < 4:
                loaded = compute(Op.SXTB if size == 1 else Op.SXTH, loaded, ZERO) or program.unknown()
            state.registers[dst] = loaded
        case Store(where, value, size):
            _store(program, state, (address, index), _value(program, state, where), size, _value(program, state, value))
        case StoreUnknown(where, size):
            _store(program, state, (address, index), _value(program, state, where), size, None)
        case SetFlags(kind, a_operand, b_operand):
            a, b = _value(program, state, a_operand), _value(program, state, b_operand)
            state.flags = set_flags(kind, a, b, state.flags)
        case SetCarry(shift, shifted, amount):
            terms = _value(program, state, shifted), _value(program, state, amount)
            state.flags = set_carry(shift, *terms, state.flags)


def _computed(program: Program, op: Op, a: Term, b: Term, flags: Flags) -> Term:
    if op in (Op.ADC, Op.SBC, Op.RRX):
        carry = carry_term(flags) or program.unknown(0, 1)
        if op is Op.ADC:
            return add(add(a, b), carry)
        if op is Op.SBC:
            return add(subtract(subtract(a, b), number(1)), carry)
        half = compute(Op.LSR, a, number(1))
        return program.unknown() if half is None else add(half, scale(carry, 1 << 31))
    return compute(op, a, b) or program.unknown()


def locate(address: Term, size: int) -> Cell | None:
    """The cell that the address term names, if it is a constant distance from the frame's base or from zero."""
    if address.is_constant:
        return Cell(Base.ABSOLUTE, address.constant, size)
    if address.parts == frozenset({(FrameBase(), 1)}):
        return Cell(Base.SP, signed(address.constant), size)
    return None


def _load(program: Program, state: State, address: Term, size: int) -> Term:
    top = (1 << 8 * size) - 1
    cell = locate(address, size)
    if cell is None:
        found = Fresh(next(program.fresh), 0, top)
        program.reads[found.id] = address, size
        return atom(found)
    if cell.base is Base.ABSOLUTE:
        constant = program.values.constant(cell)
        if constant is not None:
            return number(constant)
        if not program.values.tracked(cell):
            return program.unknown(0, top)
    if cell in state.cells:
        return state.cells[cell]
    if any(overlap(cell, region_of(other)) for other in state.cells) or any(overlap(cell, r) for r in state.lost):
        return program.unknown(0, top)
    return variable(cell)


def _store(
    program: Program, state: State, where: tuple[int, int], address: Term, size: int, value: Term | None
) -> None:
    cell = locate(address, size)
    if cell is None:
        for region in store_regions(program, where):
            _lose(state, region)
        return
    _lose(state, region_of(cell))
    if value is not None and size < 4:
        value = compute(Op.UXTB if size == 1 else Op.UXTH, value, ZERO)
    if size <= 4:
        state.cells[cell] = value or program.unknown(0, (1 << 8 * size) - 1)


def store_regions(program: Program, where: tuple[int, int]) -> tuple[Region, ...]:
    """The memory that a store may change, of those parts of memory that summaries talk about."""
    target = program.frame.stores.get(where)
    if target is not None and target.region is not None:
        return (target.region,)
    region = program.values.access(*where)
    if region is not None:
        return (region,)
    frame = target is None or target.frame or program.frame.escapes
    return (ALL_FRAME, ALL_MEMORY) if frame else (ALL_MEMORY,)


def _lose(state: State, region: Region) -> None:
    for cell in [c for c in state.cells if overlap(c, region)]:
        del state.cells[cell]
        if region_of(cell) not in state.lost:
            state.lost += (region_of(cell),)
    if region not in state.lost:
        state.lost += (region,)


def _call(program: Program, state: State, effects: CallEffects) -> None:
    a, b = state.registers.get(0), state.registers.get(1)
    forget(program, state, call_changes(program, effects))
    if effects.helper is None or a is None or b is None:
        return
    helper = effects.helper
    quotient = compute(Op.SDIV if helper.is_signed else Op.UDIV, a, b)
    product = quotient and compute(Op.MUL, quotient, b)
    if quotient is not None and helper.quotient is not None:
        state.registers[helper.quotient] = quotient
    if product is not None and helper.remainder is not None:
        state.registers[helper.remainder] = subtract(a, product)


def call_changes(program: Program, effects: CallEffects) -> Changes:
    """What a call may change."""
    regions = {ALL_MEMORY} if effects.memory else set()
    if program.frame.escapes if effects.frame is None else effects.frame:
        regions.add(ALL_FRAME)
    return Changes(effects.registers | {FLAGS}, frozenset(regions))


def forget(program: Program, state: State, changes: Changes) -> None:
    """Make everything that `changes` names unknown."""
    for register in changes.registers:
        if register < 15 and register != FLAGS:
            state.registers[register] = program.unknown()
    for region in changes.memory:
        _lose(state, region)
    state.flags = UNKNOWN


def stores_of(program: Program, loop: Loop) -> tuple[tuple[int, int], ...]:
    """The stores in a loop, as addresses and indices of micro-operations."""
    return tuple(
        (instruction.address, index)
        for block in sorted(loop.blocks)
        for instruction in program.cfg.blocks[block].instructions
        for index, op in enumerate(instruction.ops)
        if isinstance(op, Store | StoreUnknown)
    )


def loop_changes(program: Program, loop: Loop) -> Changes:
    """What the blocks of a loop may change. A register that points to the same place in the frame always is kept."""
    registers: set[int] = set()
    memory: set[Region] = set()
    for block in loop.blocks:
        for instruction in program.cfg.blocks[block].instructions:
            for index, op in enumerate(instruction.ops):
                if isinstance(op, Compute | Load):
                    registers.add(op.dst)
                elif isinstance(op, Store | StoreUnknown):
                    memory.update(store_regions(program, (instruction.address, index)))
            if isinstance(instruction.flow, SupervisorCall):
                registers |= AAPCS.registers
                memory.update(call_changes(program, AAPCS).memory)
        for index in program.leaving.get(block, ()):
            edge = program.cfg.edges[index]
            if edge.kind in (EdgeKind.CALL, EdgeKind.TAIL_CALL) and edge.target != EXIT:
                changes = call_changes(program, program.effects.get(index, AAPCS))
                registers |= changes.registers
                memory |= changes.memory
    kept = program.frame.offsets[loop.header]
    return Changes(frozenset(r for r in registers if r <= 15 and r not in kept) | {FLAGS}, frozenset(memory))
