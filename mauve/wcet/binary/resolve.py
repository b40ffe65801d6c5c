"""Where indirect jumps go: a backward slice over the paths that lead to the jump, with value ranges.

The target is followed symbolically along each path that ends at the jump. It is known when it is a constant, the return
address, or a function of one value with a small range (by its making or by comparisons on the path) through constant
memory: a switch table. Paths grow backwards, a block at a time, until each answers; all must. That finds the tables of
gcc and clang in A32, T16 and T32, veneers, calls through literals and computed jumps into unrolled code.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from mauve.wcet.binary.constants import Constants, InFrame, Known
from mauve.wcet.binary.elf import Binary, Content
from mauve.wcet.binary.graph import EdgeKind
from mauve.wcet.binary.microop import (
    LR,
    SP,
    Call,
    CompareBranch,
    Compute,
    Condition,
    FlagKind,
    Imm,
    IndirectCall,
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
from mauve.wcet.binary.tables import MOST_ENTRIES, evaluate, inline_table, labels, open_table
from mauve.wcet.binary.terms import MASK, Flags, Terms

_PATHS, _LENGTH = 96, 300
_FRAME = (7, 11, SP)
"""Registers through which frames are read."""


@dataclass(frozen=True, slots=True)
class Resolution:
    """Where an indirect jump goes: `targets` are keys; `returns`: out of the function; with a `link` it is a call
    that comes back to that address (for a call instruction `link` is None: it comes back behind itself). `is_partial`:
    it may go elsewhere as well."""

    targets: tuple[int, ...] = ()
    returns: bool = False
    link: int | None = None
    is_partial: bool = False


_Step = tuple[int, EdgeKind | None]
"""An instruction's address, and the kind of edge by which the path leaves it (None: to the next instruction)."""


class Code:
    """The part of a function that is known so far: instructions by address and the edges between them."""

    def __init__(self, binary: Binary, key: int) -> None:
        self.binary, self.entry = binary, key & ~1
        self.instructions: dict[int, Instruction] = {}
        self.literals: set[int] = set()
        """the addresses of data that instructions name"""
        self.helpers: dict[int, tuple[Instruction, ...]] = {}
        """calls of helpers that return behind a table, by address of the call: the helper's code"""
        self._sources: dict[int, dict[_Step, None]] = {}
        self._ending: dict[int, int] = {}
        self._edges = 0
        self._constants: tuple[tuple[int, int], Constants] | None = None

    def add(self, instruction: Instruction) -> None:
        """Enter an instruction."""
        self.instructions[instruction.address] = instruction
        self.literals.update(
            op.address.value for op in instruction.ops if isinstance(op, Load) and isinstance(op.address, Imm)
        )
        self._ending[instruction.end] = instruction.address

    def connect(self, source: int, target: int, kind: EdgeKind) -> None:
        """Enter an edge from the instruction at `source` to the one at `target`."""
        sources = self._sources.setdefault(target, {})
        self._edges += (source, kind) not in sources
        sources[source, kind] = None

    def constants(self) -> Constants:
        """What is constant in the code that is known so far."""
        stamp = len(self.instructions), self._edges
        if self._constants is None or self._constants[0] != stamp:
            after: dict[int, list[tuple[int, EdgeKind]]] = {}
            for target, sources in self._sources.items():
                for source, kind in sources:
                    after.setdefault(source, []).append((target, kind or EdgeKind.FALL))
            found = Constants(self.binary, self.entry, self.instructions, after, self._keeps_registers)
            self._constants = stamp, found
        return self._constants[1]

    def labels(self, thumb: bool) -> frozenset[int]:
        """The places of the function whose address is taken, as keys."""
        return labels(self.binary, self.entry, thumb, self.constants().made)

    def _keeps_registers(self, call: Instruction) -> bool:
        """Whether a call is one of a function with a symbol: those follow the procedure call standard."""
        return isinstance(call.flow, Call) and self.binary.symbol_at(call.flow.target) is not None

    def before(self, address: int) -> list[_Step]:
        """The steps that lead to `address`."""
        steps = list(self._sources.get(address, ()))
        linear = self._ending.get(address)
        if linear is not None and isinstance(self.instructions[linear].flow, Next | SupervisorCall):
            steps.append((linear, None))
        return steps


# ---------------------------------------------------------------------------------------------------- paths
class _Path:
    """The state after running the steps of one path symbolically."""

    def __init__(self, code: Code, steps: list[_Step]) -> None:
        self.code, self.terms = code, Terms()
        self.registers: dict[int, int] = {}
        self.places: dict[int, int] = {}
        """terms that were loaded, with the address of an instruction that did so"""
        self.stored: list[tuple[int, int, int]] = []
        self.version = 0
        self.flags: Flags | None = None
        self.flags_version = 0
        self.holding: set[tuple[int, Condition]] = set()
        self.place = code.instructions[steps[0][0]].end if steps[0][0] in code.instructions else 0
        """the address behind the instruction that the path leads to"""
        for address, kind in reversed(steps[1:]):
            self._pass(code.instructions[address], kind)

    def operand(self, operand: Operand) -> int:
        """The term of an operand."""
        if isinstance(operand, Imm):
            return self.terms.constant(operand.value)
        found = self.registers.get(operand)
        if found is None:
            found = self.registers[operand] = self.terms.initial(operand)
        return found

    def assume(self, condition: Condition) -> None:
        """From here on the condition is known to hold."""
        if condition is Condition.AL:
            return
        self.holding.add((self.flags_version, condition))
        if self.flags is not None:
            self.terms.facts.append((condition, self.flags))

    def settle(self, term: int) -> int:
        """The term with its conditional parts decided by what is known to hold."""
        settled: dict[int, int] = {}
        for number in self.terms.below(term):
            parts = self.terms.table[number]
            if parts[0] == "either":
                version, condition = parts[3]
                if (version, condition) in self.holding:
                    settled[number] = settled[parts[1]]
                    continue
                if (version, condition.negated) in self.holding:
                    settled[number] = settled[parts[2]]
                    continue
                settled[number] = self.terms.either(parts[3], settled[parts[1]], settled[parts[2]])
            elif isinstance(parts[0], Op):
                settled[number] = self.terms.apply(parts[0], settled[parts[1]], settled[parts[2]])
            elif parts[0] == "load":
                settled[number] = self.terms.load(settled[parts[1]], *parts[2:])
                if number in self.places:
                    self.places.setdefault(settled[number], self.places[number])
            else:
                settled[number] = number
        return settled[term]

    def inline_table(self, term: int, below: Sequence[int], fixed: dict[int, int]) -> set[int] | None:
        """See tables.inline_table."""
        code = self.code
        return inline_table(
            self.terms, term, below, fixed, code.binary, self.place,
            lambda at: at in code.instructions or at in code.literals,
        )  # fmt: skip

    def _pass(self, instruction: Instruction, kind: EdgeKind | None) -> None:
        """Run one instruction and leave it by an edge of this kind."""
        flow, condition = instruction.flow, instruction.condition
        if kind is EdgeKind.CALL:
            self._forget()
            return
        if isinstance(flow, CompareBranch):
            term = self.operand(flow.register)
            zero = flow.nonzero is not (kind is EdgeKind.TAKEN)
            flags = (FlagKind.LOGIC, term, term)
            self.terms.facts.append((Condition.EQ if zero else Condition.NE, flags))
            return
        if not isinstance(flow, Next | SupervisorCall):
            taken = kind is not EdgeKind.FALL
            if condition is not Condition.AL:
                self.assume(condition if taken else condition.negated)
            if not taken:
                return
            condition = Condition.AL
        self.perform(instruction, condition)

    def perform(self, instruction: Instruction, condition: Condition) -> None:
        """The micro-operations, under a condition that is not known to hold unless it is AL."""
        guard = (self.flags_version, condition)
        if guard in self.holding:
            condition = Condition.AL
        popped = SP in instruction.traits.reads and SP in instruction.traits.writes
        for op in instruction.ops:
            self._operation(op, condition, guard, popped)
            if isinstance(op, Load):
                self.places.setdefault(self.registers[op.dst], instruction.address)

    def _operation(self, op: MicroOp, condition: Condition, guard: tuple[int, Condition], popped: bool) -> None:
        always = condition is Condition.AL
        match op:
            case Compute(name, dst, a, b):
                self._write(dst, self.terms.apply(name, self.operand(a), self.operand(b)), always, guard)
            case Load(dst, address, size, is_signed):
                self._write(dst, self._load(self.operand(address), size, is_signed, popped), always, guard)
            case Store(address, value, size):
                self._store(self.operand(address), self.operand(value), size, always)
            case StoreUnknown(address, size):
                self._store(self.operand(address), self.terms.unknown(), size, False)
            case SetFlags(kind, a, b):
                self.flags = (kind, self.operand(a), self.operand(b)) if always else None
                self.flags_version += 1
            case SetCarry():
                if self.flags is not None and self.flags[0] is not FlagKind.LOGIC:
                    self.flags = None
                self.flags_version += 1

    def _write(self, dst: int, term: int, always: bool, guard: tuple[int, Condition]) -> None:
        self.registers[dst] = term if always or dst > LR else self.terms.either(guard, term, self.operand(dst))

    def _load(self, address: int, size: int, is_signed: bool, popped: bool) -> int:
        for change in range(len(self.stored) - 1, -1, -1):
            where, width, value = self.stored[change]
            if where == address and width == size == 4:
                return value
            if not self._apart(where, width, address, size):
                return self.terms.load(address, size, is_signed, self.version + change + 1, popped)
        return self.terms.load(address, size, is_signed, self.version, popped)

    def _store(self, address: int, value: int, size: int, always: bool) -> None:
        self.stored.append((address, size, value if always else self.terms.unknown()))

    def _apart(self, first: int, width: int, second: int, size: int) -> bool:
        """Whether two accesses surely touch different bytes: same base, offsets apart; or constants apart."""
        base, offset = self._split(first)
        other, distance = self._split(second)
        if base != other:
            return self._own(base) != self._own(other) and None not in (self._own(base), self._own(other))
        gap = (distance - offset) & MASK
        return width <= gap <= MASK + 1 - size

    def _own(self, base: int | None) -> str | None:
        """The stack and constant addresses never meet (the stack is not reached through globals)."""
        if base is None:
            return "constant"
        return "stack" if self.terms.table[base] == ("initial", SP) else None

    def _split(self, term: int) -> tuple[int | None, int]:
        parts = self.terms.table[term]
        if parts[0] == "constant":
            return None, parts[1]
        if parts[0] is Op.ADD and (k := self.terms.value(parts[2])) is not None:
            return parts[1], k
        return term, 0

    def _forget(self) -> None:
        """After a call nothing is known: helpers need not follow the procedure call standard."""
        self.registers = {register: self.terms.unknown() for register in range(LR + 1)}
        self.version += len(self.stored) + 1
        self.stored = []
        self.flags = None
        self.flags_version += 1


def link_before(code: Code, instruction: Instruction) -> int | None:
    """The constant that lr holds at the instruction, as far as the block before it tells: where a callee would return
    to."""
    steps = _extend_straight(code, [(instruction.address, None)])
    path = _Path(code, steps)
    path.assume(instruction.condition)
    return path.terms.value(path.settle(path.operand(LR)))


def link_of_jump(code: Code, instruction: Instruction, leaves: bool) -> int | None:
    """Where the target of a direct jump comes back to, when the jump is a call: lr holds the address behind it, or
    the jump leaves the function with the address of code in lr. Else lr is a register as any other."""
    link = link_before(code, instruction)
    if link is None or link & ~1 == instruction.end:
        return link
    return link if leaves and _keys({link}, True, instruction.thumb, code.binary) is not None else None


def _extend_straight(code: Code, steps: list[_Step]) -> list[_Step]:
    """Back to the start of the block."""
    while len(steps) < _LENGTH:
        address = steps[-1][0]
        before = code.before(address)
        if address == code.entry or len(before) != 1 or before[0][1] is not None:
            break
        steps = [*steps, before[0]]
    return steps


def resolve(code: Code, instruction: Instruction) -> Resolution | None:
    """The targets of an indirect jump, call or table jump; None when they are not known."""
    if isinstance(instruction.flow, IndirectCall) and _comes_in(code, instruction):
        return None
    found = _search(code, instruction, False)
    if found is None and isinstance(instruction.flow, IndirectJump | TableJump):
        found = _search(code, instruction, True)
    return found


def _search(code: Code, instruction: Instruction, unchecked: bool) -> Resolution | None:
    """Grow paths backwards until each answers. `unchecked`: of a table that is known, not how long it is, nor what the
    index is compared with; of a pointer, that it is one to a label."""
    found: Resolution | None = None
    work: list[list[_Step]] = [_extend_straight(code, [(instruction.address, None)])]
    spent = 0
    while work:
        steps = work.pop()
        spent += 1
        answer = _answer(code, steps, instruction, unchecked)
        if answer is None:
            start = steps[-1][0]
            before = code.before(start)
            if start == code.entry or not before or spent + len(before) > _PATHS or len(steps) >= _LENGTH:
                return None
            work += [_extend_straight(code, [*steps, step]) for step in before]
            continue
        found = answer if found is None else _union(found, answer)
        if found is None or len(found.targets) > MOST_ENTRIES:
            return None
    return found


def _comes_in(code: Code, call: Instruction) -> bool:
    """Whether the target of a call can be what a register held when the function was entered, by copies between
    registers alone: then no path search will find it."""
    assert isinstance(call.flow, IndirectCall)
    if isinstance(call.flow.target, Imm):
        return False
    work = [(call.address, call.flow.target)]
    seen = set(work)
    while work:
        address, register = work.pop()
        if address == code.entry:
            return True
        for source, _ in code.before(address):
            before = _copied(code.instructions[source], register)
            if before is not None and (source, before) not in seen:
                seen.add((source, before))
                work.append((source, before))
    return False


def _copied(instruction: Instruction, register: int) -> int | None:
    """The register whose value `register` has behind an instruction; None where it has another value."""
    if isinstance(instruction.flow, Call | IndirectCall) and (register <= 3 or register >= 12):
        return None
    writes = [op for op in instruction.ops if getattr(op, "dst", None) == register]
    if not writes:
        return register
    match instruction.ops:
        case (Compute(op=Op.MOV, a=source),) if instruction.condition is Condition.AL and not isinstance(source, Imm):
            return source
    return None


def _union(first: Resolution, second: Resolution) -> Resolution | None:
    if (first.returns, first.link) != (second.returns, second.link):
        return None
    is_partial = first.is_partial or second.is_partial
    return Resolution(tuple(sorted({*first.targets, *second.targets})), first.returns, first.link, is_partial)


# ------------------------------------------------------------------------------------------------ the answer of a path
def _answer(code: Code, steps: list[_Step], instruction: Instruction, unchecked: bool) -> Resolution | None:
    path = _Path(code, steps)
    path.assume(instruction.condition)
    flow = instruction.flow
    path.perform(instruction, Condition.AL)
    if isinstance(flow, Call):
        return _answer_of_helper(code, path, steps[-1][0], code.helpers[instruction.address])
    calls = isinstance(flow, IndirectCall)
    link = None
    if not calls and not isinstance(flow, TableJump):
        link = path.terms.value(path.settle(path.operand(LR)))
    term = path.settle(_target_term(path, flow))
    parts = path.terms.table[term]
    if isinstance(flow, IndirectJump) and (link is None or parts[0] != "constant"):
        if flow.returns and parts[0] != "constant" and not _is_foreign(path, term):
            return Resolution(returns=True)
        if parts[0] == "load" and parts[5]:
            return Resolution(returns=True)
        if parts == ("initial", LR) and steps[-1][0] == code.entry:
            return Resolution(returns=True)
    exchanges = flow.exchanges if isinstance(flow, IndirectJump | IndirectCall) else False
    keys = _targets(code, path, term, steps[-1][0], exchanges, instruction.thumb, unchecked)
    if keys is None:
        if unchecked and link is None and _is_pointer(path, term):
            return _label(code, instruction)
        if link == instruction.end | instruction.thumb or link == instruction.end:
            return Resolution(link=link)
        return None
    functions = all(code.binary.symbol_at(key) is not None and key & ~1 != code.entry for key in keys)
    if link is not None and not (functions or link & ~1 == instruction.end):
        link = None  # lr holds some constant, as any register may
    if link is not None and isinstance(flow, IndirectJump) and flow.target == LR:
        link = None
    return Resolution(tuple(sorted(keys)), link=link)


def computes_return(binary: Binary, helper: tuple[Instruction, ...]) -> bool:
    """Whether straight code that is called comes back somewhere else than behind the call, at a place computed from
    it."""
    path = _Path(Code(binary, helper[0].address), [(helper[0].address, None)])
    for instruction in helper:
        path.perform(instruction, instruction.condition)
    term = path.settle(_target_term(path, helper[-1].flow))
    link = path.terms.initial(LR)
    return term != link and link in path.terms.below(term)


def _answer_of_helper(code: Code, path: _Path, start: int, helper: tuple[Instruction, ...]) -> Resolution | None:
    for instruction in helper:
        path.perform(instruction, instruction.condition)
    flow = helper[-1].flow
    assert isinstance(flow, IndirectJump)
    keys = _targets(code, path, path.settle(_target_term(path, flow)), start, flow.exchanges, helper[-1].thumb)
    return None if keys is None else Resolution(tuple(sorted(keys)))


def _target_term(path: _Path, flow: object) -> int:
    if isinstance(flow, TableJump):
        scale = path.terms.constant(flow.entry_size - 1)
        index = path.terms.apply(Op.SHL, path.operand(flow.index), scale)
        address = path.terms.apply(Op.ADD, path.operand(flow.table), index)
        entry = path.terms.load(address, flow.entry_size, False, path.version, False)
        doubled = path.terms.apply(Op.SHL, entry, path.terms.constant(1))
        return path.terms.apply(Op.ADD, doubled, path.terms.constant(flow.pc_value))
    assert isinstance(flow, IndirectJump | IndirectCall)
    return path.operand(flow.target)


def _is_foreign(path: _Path, term: int) -> bool:
    """Whether lr was read from memory that is not the frame: then it is a register as any other."""
    parts, terms = path.terms.table[term], path.terms
    if parts[0] != "load" or parts[5]:
        return False
    origins = (terms.table[number] for number in terms.below(parts[1]))
    return not any(origin[0] == "initial" and origin[1] in _FRAME for origin in origins)


def _is_pointer(path: _Path, term: int) -> bool:
    """Whether a term is a word from memory, or one with bit 0 set."""
    parts = path.terms.table[term]
    if parts[0] is Op.OR and path.terms.value(parts[2]) == 1:
        parts = path.terms.table[parts[1]]
    return bool(parts[0] == "load" and parts[2] == 4)


def _label(code: Code, instruction: Instruction) -> Resolution | None:
    """A jump to what a pointer holds goes to one of the function's labels; unless that is a function: where the frame
    is given back, it may be the last call."""
    keys = code.labels(instruction.thumb)
    stack = code.constants().at(instruction.address).registers.get(SP)
    is_sure = not getattr(instruction.flow, "exchanges", False) or (stack is not None and stack != InFrame(0))
    return Resolution(tuple(sorted(keys)), is_partial=not is_sure) if keys else None


def _targets(
    code: Code, path: _Path, term: int, start: int, exchanges: bool, thumb: bool, unchecked: bool = False
) -> set[int] | None:
    """Where a jump to the term goes on a path from `start`, as keys: all values of the term, by running through the
    range of one of the terms it is made of, where all of them are code. Where they are not, an index was not checked,
    and the table ends before its range does."""
    terms, binary = path.terms, code.binary
    below = terms.below(term)
    fixed = _fixed(code, path, below, start)
    constant = evaluate(terms, below, fixed, binary)
    if constant is not None:
        return _keys({constant}, exchanges, thumb, binary)
    candidates: list[tuple[int, int, tuple[tuple[int, int], ...]]] = []
    for number in below:
        if terms.value(number) is None and number != term and number not in fixed:
            ranges = terms.ranges(number)
            count = sum(high - low + 1 for low, high in ranges)
            if count <= MOST_ENTRIES:
                candidates.append((count, -number, ranges))
    for _, negative, ranges in sorted(candidates):
        values: set[int] = set()
        if terms.table[-negative][0] == "load" and (table := path.inline_table(term, below, fixed)):
            return _keys(table, exchanges, thumb, binary)  # of an entry of a table only its width is known
        for value in (v for low, high in ranges for v in range(low, high + 1)):
            result = evaluate(terms, below, {**fixed, -negative: value}, binary)
            if result is None:
                break
            values.add(result)
        else:
            keys = _keys(values, exchanges, thumb, binary)
            if keys is not None:
                return keys
    table = path.inline_table(term, below, fixed)
    if table is None and unchecked:
        table = open_table(terms, term, below, fixed, binary, code.entry)
    return None if table is None else _keys(table, exchanges, thumb, binary)


def _fixed(code: Code, path: _Path, below: Iterable[int], start: int) -> dict[int, int]:
    """The terms that are constant as registers, or words of the frame, are where the path starts."""
    constants = code.constants()
    known = constants.at(start)
    fixed: dict[int, int] = {}
    for number in below:
        parts = path.terms.table[number]
        value: Known | None = None
        if parts[0] == "initial":
            value = known.registers.get(parts[1])
        elif parts[0] == "load" and parts[2] == 4 and number in path.places:
            value = constants.loaded(path.places[number])
        if isinstance(value, int):
            fixed[number] = value
    return fixed


def _keys(values: set[int], exchanges: bool, thumb: bool, binary: Binary) -> set[int] | None:
    """Jump targets as keys; None when one of them is no code."""
    keys: set[int] = set()
    for value in values:
        state = bool(value & 1) if exchanges else thumb
        address = value & ~1 if state else value
        if not state and address & 3:
            return None
        content = binary.content_at(address)
        if binary.read_code(address, 2) is None or content is Content.DATA:
            return None
        if content is not None and content is not (Content.THUMB if state else Content.ARM):
            return None
        keys.add(address | state)
    return keys
