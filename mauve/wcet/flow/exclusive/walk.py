"""One walk over a function, every block once: for each edge the facts that hold in the scope in which it is taken.

Blocks are visited in an order in which all that leads to a block without a back edge comes before it. A loop starts
from the state in which it is entered, with everything that it may change unknown; so what its branches say of values
that it does not change is said of the same values as outside.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from mauve.wcet.binary.graph import EXIT, Cfg, EdgeKind
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.binary.microop import (
    CompareBranch,
    Compute,
    Condition,
    Imm,
    IndirectJump,
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
    TableJump,
)
from mauve.wcet.flow.exclusive.facts import Facts, all_of, contradicts, facts_of, one_of
from mauve.wcet.flow.exclusive.numbers import ALL, ROOT, Numbering, State
from mauve.wcet.flow.exclusive.switches import table_facts
from mauve.wcet.flow.locations import AAPCS, WORD, Base, CallEffects, Cell, Region
from mauve.wcet.flow.rank.flags import UNKNOWN, carry_term, facts, set_carry, set_flags
from mauve.wcet.flow.rank.frame import Frame, analyse_frame
from mauve.wcet.flow.rank.paths import locate
from mauve.wcet.flow.rank.terms import (
    ZERO,
    FrameBase,
    Fresh,
    Kind,
    Relation,
    Term,
    Var,
    add,
    atom,
    atoms,
    compute,
    number,
    scale,
    subtract,
    variable,
)

ARGUMENTS = frozenset({0, 1, 2, 3})


class Memory(Protocol):
    """The memory of the binary, and where the function's accesses go."""

    def constant(self, cell: Cell) -> int | None:
        """The number in an absolute cell that is never written."""

    def tracked(self, cell: Cell) -> bool:
        """Whether an absolute cell changes only by the analysed code."""

    def access(self, address: int, index: int) -> Region | None:
        """The bytes touched by micro-operation `index` of the instruction at `address`."""


@dataclass(frozen=True, slots=True)
class Written:
    """What a call may write: offsets (low, high) by region, an argument register, ABSOLUTE for fixed addresses,
    or None for anything."""

    places: tuple[tuple[int | Base | None, int, int], ...]


@dataclass(slots=True)
class Walk:
    """`own[e]` is what taking the edge e says by itself, `known[e]` with all that holds before it. An edge that is
    missing is never taken or says nothing."""

    cfg: Cfg
    nest: LoopNest
    memory: Memory
    effects: Mapping[int, CallEffects]
    written: Mapping[int, Written]
    frame: Frame
    numbering: Numbering
    leaving: Mapping[int, tuple[int, ...]]
    innermost: tuple[int, ...]
    own: dict[int, Facts] = field(default_factory=dict)
    known: dict[int, Facts] = field(default_factory=dict)
    order: list[int] = field(default_factory=list)


def walk(
    cfg: Cfg,
    nest: LoopNest,
    memory: Memory,
    effects: Mapping[int, CallEffects],
    written: Mapping[int, Written],
    infeasible: frozenset[int],
) -> Walk:
    """Walk over a function without irreducible regions whose blocks are numbered in order."""
    leaving: dict[int, list[int]] = {}
    for index, edge in enumerate(cfg.edges):
        if index not in infeasible:
            leaving.setdefault(edge.source, []).append(index)
    innermost = [ROOT] * len(cfg.blocks)
    for loop in nest.loops:
        for block in loop.blocks:
            innermost[block] = loop.id
    parents = tuple(ROOT if loop.parent is None else loop.parent for loop in nest.loops)
    here = Walk(
        cfg,
        nest,
        memory,
        effects,
        written,
        analyse_frame(cfg, effects),
        Numbering(parents),
        {block: tuple(edges) for block, edges in leaving.items()},
        tuple(innermost),
    )
    _follow(here)
    return here


def _follow(here: Walk) -> None:
    cfg, numbering = here.cfg, here.numbering
    back = {edge for loop in here.nest.loops for edge in loop.back_edges}
    headers = {loop.header: loop.id for loop in here.nest.loops}
    pending: dict[int, list[tuple[int | None, State]]] = {cfg.entry: [(None, _start(here))]}
    here.order = _order(here, back)
    for block in here.order:
        arrived = pending.pop(block, [])
        if not arrived:
            continue
        scope = here.innermost[block]
        outside = here.nest.loops[scope].parent if headers.get(block) == scope != ROOT else scope
        numbering.scope = ROOT if outside is None else outside
        state, said = numbering.join([state for _, state in arrived])
        for (edge, _), facts_here in zip(arrived, said, strict=True):
            if edge is not None and facts_here:
                here.own[edge] = all_of(here.own.get(edge, {}), facts_here)
                here.known[edge] = all_of(here.known[edge], facts_here)
        if len(arrived) > 1:
            ways = zip(arrived, said, strict=True)
            state.facts = one_of([all_of(before.facts, facts_here) for (_, before), facts_here in ways])
        if outside != scope:
            _enter(here, state, scope)
        for edge, after in _execute(here, block, state):
            target = cfg.edges[edge].target
            if edge in back or target == EXIT or contradicts(after.facts):
                continue
            inner = here.innermost[target]
            to = here.nest.loops[inner].parent if headers.get(target) == inner != ROOT else inner
            to = ROOT if to is None else to
            if not numbering.around(scope, to):
                after = numbering.leave(after, to)
            pending.setdefault(target, []).append((edge, after))


def _start(here: Walk) -> State:
    registers = {register: variable(register) for register in range(15)}
    registers[13] = atom(FrameBase())
    return State(registers)


def _order(here: Walk, back: set[int]) -> list[int]:
    """Reverse postorder without back edges."""
    seen = {here.cfg.entry}
    order: list[int] = []
    stack = [(here.cfg.entry, iter(here.leaving.get(here.cfg.entry, ())))]
    while stack:
        block, edges = stack[-1]
        for edge in edges:
            target = here.cfg.edges[edge].target
            if edge not in back and target != EXIT and target not in seen:
                seen.add(target)
                stack.append((target, iter(here.leaving.get(target, ()))))
                break
        else:
            order.append(block)
            stack.pop()
    return order[::-1]


def _enter(here: Walk, state: State, scope: int) -> None:
    """What a loop may change becomes unknown. A register that points to one place in the frame always is kept."""
    loop = here.nest.loops[scope]
    registers: set[int] = set()
    regions: dict[Region, None] = {}
    heap = False
    for block in loop.blocks:
        for instruction in here.cfg.blocks[block].instructions:
            for index, op in enumerate(instruction.ops):
                if isinstance(op, Compute | Load):
                    registers.add(op.dst)
                elif isinstance(op, Store | StoreUnknown):
                    regions |= dict.fromkeys(_store_regions(here, (instruction.address, index)))
            if isinstance(instruction.flow, SupervisorCall):
                registers |= AAPCS.registers
                regions |= dict.fromkeys(ALL.values())
        for edge in here.leaving.get(block, ()):
            if here.cfg.edges[edge].kind is EdgeKind.CALL:
                registers |= here.effects.get(edge, AAPCS).registers
                regions |= dict.fromkeys(_call_regions(here, edge, None))
    offsets = here.frame.offsets[loop.header]
    heap = any(region.base is Base.ABSOLUTE for region in regions)
    here.numbering.enter(state, scope, sorted(registers - offsets.keys()), regions, heap)
    for register in registers & offsets.keys():
        if register < 15:
            state.registers[register] = add(atom(FrameBase()), number(offsets[register]))


# --------------------------------------------------------------------------------------------------------- executing
def _execute(here: Walk, block: int, state: State) -> list[tuple[int, State]]:
    """The states on the edges that leave a block; the facts of each edge are noted."""
    instructions = here.cfg.blocks[block].instructions
    for instruction in instructions[:-1]:
        state = _step(here, instruction, state)
    last = instructions[-1]
    edges = here.leaving.get(block, ())
    if isinstance(last.flow, Next | SupervisorCall):
        state = _step(here, last, state)
        for edge in edges:
            here.known[edge] = state.facts
        return [(edge, state.copy()) for edge in edges]
    found = []
    for edge in edges:
        after = state.copy()
        said = _branch(here, last, edge, after)
        after.facts = here.known[edge] = all_of(state.facts, said)
        if said:
            here.own[edge] = said
        found.append((edge, after))
    return found


def _branch(here: Walk, last: Instruction, index: int, after: State) -> Facts:
    """Carry `after` over the edge behind a branch or call, and what taking the edge says."""
    edge = here.cfg.edges[index]
    falls = edge.kind is EdgeKind.FALL
    relations: tuple[Relation, ...] = ()
    if isinstance(last.flow, CompareBranch):
        kind = Kind.NE if last.flow.nonzero != falls else Kind.EQ
        relations = (Relation(kind, after.registers[last.flow.register], ZERO),)
    elif last.condition is not Condition.AL:
        relations = facts(after.flags, last.condition.negated if falls else last.condition)
    said = facts_of(relations, here.numbering.chosen)
    if falls:
        return said
    for at, op in enumerate(last.ops):
        _micro(here, (last.address, at), op, after)
    if edge.kind is EdgeKind.SWITCH and edge.target != EXIT:
        said = all_of(said, _switch(here, last, edge.target, after, all_of(after.facts, said)))
    _drop_temporaries(after)
    if edge.kind is EdgeKind.CALL:
        _call(here, after, index)
    return said


def _switch(here: Walk, last: Instruction, target: int, after: State, known: Facts) -> Facts:
    """What it says of a jump's index that control goes to a block."""
    goes = here.cfg.blocks[target].address
    match last.flow:
        case TableJump(table, index, size, start):
            address = add(_value(here, after, table), scale(_value(here, after, index), size))
            return table_facts(address, size, 2, start, known, here.memory, goes)
        case IndirectJump(operand):
            term = _value(here, after, operand)
            read = next((here.numbering.origins.get(of.id) for of, _ in term.parts if isinstance(of, Fresh)), None)
            if isinstance(read, tuple) and len(term.parts) == 1 and term == atom(next(iter(term.parts))[0]):
                return table_facts(read[0], read[1], 1, 0, known, here.memory, goes)
    return {}


def _step(here: Walk, instruction: Instruction, state: State) -> State:
    """The state after an instruction that does not branch."""
    if instruction.condition is Condition.AL:
        _perform(here, instruction, state)
    else:
        done, flags = state.copy(), state.flags
        _perform(here, instruction, done)
        state = here.numbering.choose(flags, instruction.condition, done, state)
    if isinstance(instruction.flow, SupervisorCall):
        _forget(here, state, AAPCS.registers, tuple(ALL.values()))
    return state


def _perform(here: Walk, instruction: Instruction, state: State) -> None:
    for index, op in enumerate(instruction.ops):
        _micro(here, (instruction.address, index), op, state)
    _drop_temporaries(state)


def _drop_temporaries(state: State) -> None:
    for temporary in [r for r in state.registers if r > 14]:
        del state.registers[temporary]


def _value(here: Walk, state: State, operand: Operand) -> Term:
    if isinstance(operand, Imm):
        return number(operand.value)
    if operand not in state.registers:
        state.registers[operand] = here.numbering.unknown()
    return state.registers[operand]


def _micro(here: Walk, where: tuple[int, int], op: MicroOp, state: State) -> None:
    numbering = here.numbering
    match op:
        case Compute():
            a, b = _value(here, state, op.a), _value(here, state, op.b)
            state.registers[op.dst] = _computed(here, op.op, a, b, state)
        case Load(dst, address, size, is_signed):
            loaded = _load(here, state, _value(here, state, address), size)
            if is_signed and size < 4:
                loaded = compute(Op.SXTB if size == 1 else Op.SXTH, loaded, ZERO) or numbering.unknown()
            state.registers[dst] = loaded
        case Store(address, value, size):
            _store(here, state, where, _value(here, state, address), size, _value(here, state, value))
        case StoreUnknown(address, size):
            _store(here, state, where, _value(here, state, address), size, None)
        case SetFlags(kind, first, second):
            state.flags = set_flags(kind, _value(here, state, first), _value(here, state, second), state.flags)
        case SetCarry(shift, shifted, amount):
            terms = _value(here, state, shifted), _value(here, state, amount)
            state.flags = set_carry(shift, *terms, state.flags)


def _computed(here: Walk, op: Op, a: Term, b: Term, state: State) -> Term:
    if op in (Op.ADC, Op.SBC):
        carry = carry_term(state.flags)
        if carry is None:
            return here.numbering.unknown()
        return add(add(a, b), carry) if op is Op.ADC else add(subtract(subtract(a, b), number(1)), carry)
    return compute(op, a, b) or here.numbering.unknown()


def _load(here: Walk, state: State, address: Term, size: int) -> Term:
    numbering = here.numbering
    cell = locate(address, size)
    if cell is None:
        return numbering.read_object(state, address, size) if _is_object(here, address) else numbering.unknown(size)
    if cell.base is Base.ABSOLUTE:
        constant = here.memory.constant(cell)
        if constant is not None:
            return number(constant)
        if not here.memory.tracked(cell):
            return numbering.unknown(size)
    return numbering.read(state, cell) or numbering.unknown(size)


def _is_object(here: Walk, address: Term) -> bool:
    """Whether an address lies in what an argument points to, or in an object of the binary."""
    if any(isinstance(of, FrameBase) for of in atoms(address)):
        return False
    if any(isinstance(of, Var) and of.location in ARGUMENTS and factor == 1 for of, factor in address.parts):
        return True
    return here.memory.tracked(Cell(Base.ABSOLUTE, address.constant, 1))


def _store(here: Walk, state: State, where: tuple[int, int], address: Term, size: int, value: Term | None) -> None:
    if value is not None and size < 4:
        value = compute(Op.UXTB if size == 1 else Op.UXTH, value, ZERO)
    cell = locate(address, size)
    if cell is not None:
        here.numbering.write(state, cell, value)
        return
    regions = _store_regions(here, where)
    for region in regions:
        here.numbering.lose(state, region)
    if not any(region.base is Base.ABSOLUTE for region in regions):
        return
    if _is_object(here, address) and ALL[Base.SP] not in regions:
        here.numbering.write_object(state, address, size, value)
    else:
        here.numbering.lose_objects(state)


def _store_regions(here: Walk, where: tuple[int, int]) -> tuple[Region, ...]:
    """The memory that a store may change."""
    target = here.frame.stores.get(where)
    if target is not None and target.region is not None:
        return (target.region,)
    region = here.memory.access(*where)
    if region is not None:
        return (region,)
    frame = target is None or target.frame or here.frame.escapes
    return tuple(ALL.values()) if frame else (ALL[Base.ABSOLUTE],)


# ------------------------------------------------------------------------------------------------------------- calls
def _call(here: Walk, state: State, edge: int) -> None:
    effects = here.effects.get(edge, AAPCS)
    _forget(here, state, effects.registers, _call_regions(here, edge, state))


def _call_regions(here: Walk, edge: int, state: State | None) -> tuple[Region, ...]:
    """What a call may write; in `state`, or in any where there is none."""
    effects = here.effects.get(edge, AAPCS)
    everything = [ALL[Base.ABSOLUTE]] if effects.memory else []
    if here.frame.escapes if effects.frame is None else effects.frame:
        everything.append(ALL[Base.SP])
    written = here.written.get(edge)
    if written is None or (state is None and any(isinstance(region, int) for region, _, _ in written.places)):
        return tuple(everything)
    found = []
    for region, low, high in written.places:
        if isinstance(region, Base):
            found.append(Region(region, low, high))
            continue
        base = None if region is None or state is None else state.registers[region]
        cell = None if base is None else locate(base, 1)
        if cell is None or (cell.base is Base.ABSOLUTE and not 0 <= cell.offset + low <= cell.offset + high < WORD):
            return tuple(everything)
        found.append(Region(cell.base, cell.offset + low, cell.offset + high))
    return tuple(found)


def _forget(here: Walk, state: State, registers: frozenset[int], regions: tuple[Region, ...]) -> None:
    for register in sorted(registers):
        if register < 15:
            state.registers[register] = here.numbering.unknown()
    for region in regions:
        here.numbering.lose(state, region)
    if any(region.base is Base.ABSOLUTE for region in regions):
        here.numbering.lose_objects(state)
    state.flags = UNKNOWN
