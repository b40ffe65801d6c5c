"""Blocks of a control flow graph as Python functions.

A block becomes a function of the machine's registers (a list: r0-r14 in 0..14, then N, Z, C, V in 16..19, those of the
FPU from 24 on) and returns the index of the edge on which control leaves, or DYNAMIC with the place it goes to in slot
TARGET. What a conditional branch does before it leaves (a conditional load of pc, say) is a function of its own, for
when it is undecided whether the branch is taken.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from mauve.wcet.binary.floats import FloatFlags
from mauve.wcet.binary.media import Parallel, Refine, Saturate, Select
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
    MicroOp,
    Op,
    Operand,
    SetCarry,
    SetFlags,
    Store,
    StoreUnknown,
    SupervisorCall,
    TableJump,
)
from mauve.wcet.binary.microop import Shift as ShiftKind
from mauve.wcet.flow.order import Order
from mauve.wcet.flow.run import covering, flags, floating, media, narrow, operations, words
from mauve.wcet.flow.run.flag_use import (
    CV,
    NZ,
    instruction_before,
    live_flags,
    op_before,
    read_before,
    sets_flags,
    sharing,
    sources_of,
)
from mauve.wcet.flow.run.float_text import float_line, has_slot, media_line, written
from mauve.wcet.flow.run.memory import Lost, Memory

RELATED, N, Z, C, V, TARGET, DEPTH, ASKED, ASSUMED = 15, 16, 17, 18, 19, 20, 21, 22, 23
"""Slots behind the core registers; DEPTH holds the least offset of sp that was seen in the current function, ASKED what
an undecided condition asked: flags (or None), its even encoding, whether it is negated, and the number of the
instruction where it is not the block's last. ASSUMED maps such numbers to what the conditions are taken to say. RELATED
holds what is known of differences of words (pc itself is a constant wherever it is read)."""
DYNAMIC, NOWHERE = -1, -2

Run = Callable[[list[Any]], int]

_M, _H = "4294967295", "2147483648"
_SIMPLE = {
    Op.MOV: "{a}",
    Op.NOT: f"{{a}} ^ {_M}",
    Op.ADD: f"({{a}} + {{b}}) & {_M}",
    Op.SUB: f"({{a}} - {{b}}) & {_M}",
    Op.ADC: f"({{a}} + {{b}} + carry_word(r[18])) & {_M}",
    Op.SBC: f"({{a}} - {{b}} - 1 + carry_word(r[18])) & {_M}",
    Op.AND: "{a} & {b}",
    Op.OR: "{a} | {b}",
    Op.XOR: "{a} ^ {b}",
    Op.MUL: f"({{a}} * {{b}}) & {_M}",
    Op.UMULH: "high_unsigned({a}, {b})",
    Op.SMULH: "high_signed({a}, {b})",
    Op.SXTB: "extend_byte({a})",
    Op.SXTH: "extend_half({a})",
    Op.UXTB: "{a} & 255",
    Op.UXTH: "{a} & 65535",
    Op.RRX: "rotate_through_carry({a}, r[18])",
    Op.UDIV: "divide({a}, {b})",
    Op.CLZ: "leading_zeros({a})",
    Op.ROR: "rotate({a}, {b})",
    Op.UNKNOWN: "UNKNOWN",
}
_ACCESSES = (
    *("load", "load_byte", "load_signed_byte", "load_half", "load_signed_half"),
    *("store", "store_byte", "store_half"),
)
_BY_REGISTER = {Op.SHL: "shift_left", Op.LSR: "shift_right", Op.ASR: "shift_right_signed"}


@dataclass(slots=True)
class Compiled:
    """The blocks of one function; `last` does what the last instruction of a block does when its condition holds.
    `stale` are the slots (of flags) that nothing reads from a block on."""

    blocks: list[Run]
    last: list[Run | None]
    stale: list[tuple[int, ...]]


@dataclass(slots=True)
class Sites:
    """Accesses by number: the site of each micro-operation that loads or stores."""

    memory: Memory
    numbers: dict[tuple[int, int], int] = field(default_factory=dict)

    def of(self, instruction: Instruction, index: int) -> int:
        """The number of an access."""
        key = (instruction.address, index)
        if key not in self.numbers:
            self.numbers[key] = self.memory.site()
        return self.numbers[key]


def compile_function(order: Order, sites: Sites) -> Compiled:
    """All blocks of a function."""
    live = live_flags(order.cfg)
    names: dict[str, Any] = {
        "UNKNOWN": words.UNKNOWN,
        "Undecided": words.Undecided,
        "merge": covering.merge,
        "Stack": words.Stack,
        "Stacks": words.Stacks,
        "Lost": Lost,
        "ShiftKind": ShiftKind,
        "Op": Op,
        **{name: getattr(module, name) for module in (operations, flags, narrow) for name in module.__all__},
        **{name: getattr(floating, name) for name in dir(floating) if name.startswith("float_")},
        **{name: getattr(media, name) for name in dir(media) if name.startswith("media_")},
    }
    memory = sites.memory
    names |= {name: getattr(memory, name) for name in _ACCESSES}
    blocks: list[Run] = []
    last: list[Run | None] = []
    text: list[str] = []
    for block in order.cfg.blocks:
        writer = _Block(order, block.id, sites, live[block.id])
        text += writer.whole()
        text += writer.taken()
    exec(compile("\n".join(text), f"<blocks of {order.cfg.name}>", "exec"), names)
    for block in order.cfg.blocks:
        blocks.append(names[f"b{block.id}"])
        last.append(names.get(f"t{block.id}"))
    stale = []
    for block in order.cfg.blocks:
        read = read_before(block.instructions, live[block.id])
        stale.append((*((N, Z) if not read & NZ else ()), *((C, V) if not read & CV else ())))
    return Compiled(blocks, last, stale)


# ------------------------------------------------------------------------------------------------------ one block
class _Block:
    """Writes the text of one block. `flags` tells where the flags are that were set last: (SUB, a, b) or (ADD, a, b)
    with the names of the operands, (LOGIC, a) with C and V in their slots, None when all are in their slots."""

    def __init__(self, order: Order, block: int, sites: Sites, live: int) -> None:
        self.order, self.block, self.sites, self.live = order, block, sites, live
        self.instructions = order.cfg.blocks[block].instructions
        self.lines: list[str] = []
        self.flags: tuple[str, ...] | None = None
        self.expected: tuple[str, Operand, Operand] | None = None
        self.names = 0
        self.depth = 1
        self.written: set[int] = set()
        self.read: set[int] = set()
        self.answers: dict[int, str] = {}
        """names that hold whether a condition (its even encoding) holds, since the flags were set last"""
        self.shared = sharing(self.instructions)

    def emit(self, text: str) -> None:
        """One line."""
        self.lines.append("    " * self.depth + text)

    # ------------------------------------------------------------------------------------------------ frames
    def whole(self) -> list[str]:
        """The function of the block."""
        after = self._liveness()
        last = self.instructions[-1]
        for position, instruction in enumerate(self.instructions[:-1]):
            self._instruction(instruction, after[position], position)
        split = last.condition is not Condition.AL and self._branches()
        if not split:
            self._instruction(last, after[-1], len(after) - 1)
        condition = self._condition(last.condition) if split else ""
        asked = self._asked(last.condition) if split else ""
        body = self.lines
        self.lines = []
        self._write_back()
        if split:
            self._conditional(last, condition, asked)
        else:
            self._leave(last)
        tail, self.lines = self.lines, []
        registers = sorted(self.read | self.written)
        head = [f"def b{self.block}(r):"]
        if registers:
            head.append("    " + "; ".join(f"r{n} = r[{n}]" for n in registers))
        return head + body + tail

    def taken(self) -> list[str]:
        """The function of the last instruction alone, when that is a conditional branch that does something first."""
        last = self.instructions[-1]
        if last.condition is Condition.AL or not self._branches():
            return []
        self.lines, self.flags, self.read, self.written, self.answers = [], None, set(), set(), {}
        self._operations(last, self.live)
        body, self.lines = self.lines, []
        self._write_back()
        self._ways(last)
        tail, self.lines = self.lines, []
        registers = sorted(self.read | self.written)
        return [f"def t{self.block}(r):", *(f"    r{n} = r[{n}]" for n in registers), *body, *tail]

    def _branches(self) -> bool:
        return bool(self.order.taken[self.block])

    def _liveness(self) -> list[int]:
        """The flags that are read behind each instruction."""
        after, live = [], self.live
        for instruction in reversed(self.instructions):
            after.append(live)
            live = instruction_before(instruction, live)
        return after[::-1]

    def _write_back(self) -> None:
        if self.live:
            self._settle()
        for register in sorted(self.written):
            self.emit(f"r[{register}] = r{register}")
        if 13 in self.written:
            self.emit("if type(r13) is Stack and r13.offset < r[21]: r[21] = r13.offset")
            self.emit("elif type(r13) is Stacks: raise Lost('the depth of the stack is not known')")

    def _conditional(self, last: Instruction, condition: str, asked: str) -> None:
        """The end of a block that may fall through."""
        self.emit(f"try: go = bool({condition})")
        self.emit("except Undecided:")
        self.emit(f"    r[22] = ({asked})")
        self.emit("    raise")
        fall = self.order.fall[self.block]
        static = not last.ops and not isinstance(last.flow, IndirectJump | IndirectCall | TableJump)
        if static and len(self.order.taken[self.block]) == 1 and len(fall) == 1:
            self.emit(f"return {self.order.taken[self.block][0]} if go else {fall[0]}")
            return
        self.emit(f"if go: return t{self.block}(r)")
        self.emit(f"return {fall[0] if fall else NOWHERE}")

    def _leave(self, last: Instruction) -> None:
        """The end of a block whose last instruction always acts."""
        if isinstance(last.flow, CompareBranch):
            taken, fall = self.order.taken[self.block], self.order.fall[self.block]
            test = "!=" if last.flow.nonzero else "=="
            taken, fall = taken or (NOWHERE,), fall or (NOWHERE,)
            self.emit(f"word = r[{last.flow.register}]")
            self.emit(f"try: go = word {test} 0")
            self.emit("except Undecided:")
            self.emit(f"    r[22] = (Flags(Source.RESULT, word), 0, {last.flow.nonzero})")
            self.emit("    raise")
            self.emit(f"return {taken[0]} if go else {fall[0]}")
            return
        self._ways(last)

    def _ways(self, last: Instruction) -> None:
        if isinstance(last.flow, SupervisorCall):
            self.emit("raise Lost('a supervisor call')")
            return
        ways = self.order.taken[self.block] or self.order.fall[self.block]
        match last.flow:
            case IndirectJump(target) | IndirectCall(target):
                where = str(target.value) if isinstance(target, Imm) else self._slot(target)
                self.emit(f"r[20] = {where}")
                self.emit("return -1")
            case TableJump(table, index, size, pc):
                base = table.value if isinstance(table, Imm) else f"r[{table}]"
                at = index.value if isinstance(index, Imm) else f"r[{index}]"
                load = "load_byte" if size == 1 else "load_half"
                site = self.sites.of(last, -1)
                self.emit(f"r[20] = ({pc} + 2 * {load}(({base} + {size} * {at}) & {_M}, {site})) & {_M}")
                self.emit("return -1")
            case _ if len(ways) == 1:
                self.emit(f"return {ways[0]}")
            case _:
                self.emit("r[20] = None")
                self.emit("return -1")

    def _slot(self, register: int) -> str:
        return f"r[{register}]" if register < 16 else f"r{register}"

    # ------------------------------------------------------------------------------------------------ instructions
    def _instruction(self, instruction: Instruction, live: int, position: int) -> None:
        self._conditionally(instruction, live, position)
        if sets_flags(instruction):
            self.answers = {}

    def _conditionally(self, instruction: Instruction, live: int, position: int) -> None:
        if isinstance(instruction.flow, SupervisorCall):
            self.emit("raise Lost('a supervisor call')")
        if instruction.condition is Condition.AL:
            self._operations(instruction, live)
            return
        sets = sets_flags(instruction)
        code = instruction.condition.value & ~1
        condition = self._condition(instruction.condition)
        if sets:
            self._settle()
        targets = written(instruction)
        sources = sources_of(instruction.ops) - targets
        self.read |= targets | sources
        asked = self._asked(instruction.condition)
        self.emit(f"try: go = bool({condition})")
        apart = position in self.shared and code not in self.answers
        if apart:
            self._ask(asked, position)
            self.answers[code] = f"k{position}"
            self.emit(f"k{position} = {'not go' if instruction.condition.value & 1 else 'go'}")
        else:
            self.emit("except Undecided: go = None")
        before, flags = self.written.copy(), self.flags
        self.emit("if go:")
        self.depth += 1
        self.emit("pass")
        self._operations(instruction, live)
        if sets:
            self._settle()
        self.depth -= 1
        self.flags = flags
        if apart:
            self.flags = None if sets else flags
            self.written |= before
            return
        self.emit("elif go is None:")
        self.depth += 1
        self.emit("old = r[16:20]")
        self.emit(f"yes, no = sides({asked})")
        for register in sorted(targets | sources):
            other = f"no.get(id(r{register}), r{register})" if register in targets else f"r{register}"
            self.emit(f"o{register} = {other}")
            self.emit(f"r{register} = yes.get(id(r{register}), r{register})")
        self._operations(instruction, live, maybe=True)
        if sets:
            self._settle()
            self.emit("r[16:20] = [merge(a, b) for a, b in zip(old, r[16:20])]")
        for register in sorted(targets):
            self.emit(f"r{register} = merge(o{register}, r{register})")
        for register in sorted(sources):
            self.emit(f"r{register} = o{register}")
        self.depth -= 1
        self.flags = None if sets else flags
        self.written |= before

    def _ask(self, asked: str, position: int) -> None:
        """Take what is assumed of a condition that is not decided, and what that tells of the words in use."""
        self.emit("except Undecided:")
        self.depth += 1
        self.emit(f"go = None if r[23] is None else r[23].get({position})")
        self.emit(f"asked = ({asked})")
        self.emit("if go is None:")
        self.emit(f"    r[22] = (*asked, {position})")
        self.emit("    raise")
        self.emit("told = sides(*asked)[not go]")
        self.emit("for i in range(15): r[i] = told.get(id(r[i]), r[i])")
        names = [f"r{register}" for register in sorted(self.read | self.written)]
        names += [name for name in (self.flags or ())[1:] if name != "None"]
        for name in names:
            self.emit(f"{name} = told.get(id({name}), {name})")
        self.depth -= 1

    def _operations(self, instruction: Instruction, live: int, maybe: bool = False) -> None:
        after, now = [], live
        self.expected = None
        for op in reversed(instruction.ops):
            after.append(now)
            now = op_before(op, now, True)
        for index, (op, needed) in enumerate(zip(instruction.ops, reversed(after), strict=True)):
            self._operation(instruction, index, op, needed, maybe)

    def _operation(self, instruction: Instruction, index: int, op: MicroOp, needed: int, maybe: bool) -> None:
        match op:
            case Compute():
                if op.op in (Op.ADC, Op.SBC, Op.RRX):
                    self._settle_carry()
                self.emit(f"{self._target(op.dst)} = {self._expression(op)}")
                if self.expected == (op.op.name, op.a, op.b):
                    self.emit(f"z{self.names} = r{op.dst}")
                    self.flags = (*self.flags[:3], f"z{self.names}") if self.flags else None
            case Load(_, address, size, is_signed):
                name = {1: "byte", 2: "half", 4: ""}[size]
                name = "load" if size == 4 else f"load_signed_{name}" if is_signed else f"load_{name}"
                access = f"{name}({self._use(address)}, {self.sites.of(instruction, index)})"
                self.emit(f"{self._target(op.dst)} = {access}")
            case Store(address, value, size):
                self._store(instruction, index, self._use(address), self._use(value), size, maybe)
            case StoreUnknown(address, size):
                for offset in range(0, size, 4):
                    at = f"({self._use(address)} + {offset}) & {_M}"
                    self._store(instruction, index, at, "UNKNOWN", min(4, size - offset), maybe)
            case SetFlags(kind, a, b):
                self._set_flags(kind, a, b, needed)
            case SetCarry(shift, value, amount):
                if needed & CV:
                    if self.flags is not None and self.flags[0] != "LOGIC":
                        self._settle()
                    terms = f"ShiftKind.{shift.name}, {self._use(value)}, {self._use(amount)}"
                    self.emit(f"r[18] = carry_out({terms}, r[18])")
            case Parallel() | Select() | Saturate() | Refine():
                self.emit(media_line(op, self._use, self._target))
            case _:
                self.emit(float_line(op, self._use, self._target))
                if isinstance(op, FloatFlags):
                    self.flags = None

    def _store(self, instruction: Instruction, index: int, at: str, value: str, size: int, maybe: bool) -> None:
        suffix = {1: "_byte", 2: "_half", 4: ""}[size]
        site = self.sites.of(instruction, index)
        if maybe:
            self.emit(f"at = {at}")
            at, value = "at", f"merge({value}, load{suffix}(at, {site}))"
        self.emit(f"store{suffix}({at}, {value}, {site})")

    def _use(self, operand: Operand) -> str:
        if isinstance(operand, Imm):
            return str(operand.value)
        if has_slot(operand) and operand not in self.written:
            self.read.add(operand)
        return f"r{operand}"

    def _target(self, register: int) -> str:
        if has_slot(register):
            self.written.add(register)
        return f"r{register}"

    def _expression(self, op: Compute) -> str:
        a, b = self._use(op.a), self._use(op.b)
        if op.op in _SIMPLE:
            return _SIMPLE[op.op].format(a=a, b=b)
        if op.op in _BY_REGISTER:
            if not isinstance(op.b, Imm):
                return f"{_BY_REGISTER[op.op]}({a}, {b})"
            amount = op.b.value & 0xFF
            if op.op is Op.SHL:
                return f"({a} << {amount}) & {_M}" if amount < 32 else "0"
            if op.op is Op.LSR:
                return f"{a} >> {amount}"
            return f"shift_right_signed({a}, {amount})"
        return f"binary(Op.{op.op.name}, {a}, {b})"

    # ------------------------------------------------------------------------------------------------ flags
    def _set_flags(self, kind: FlagKind, a: Operand, b: Operand, needed: int) -> None:
        first, second = self._use(a), self._use(b)
        match kind:
            case FlagKind.SUB | FlagKind.ADD:
                self.names += 1
                self.emit(f"x{self.names} = {first}; y{self.names} = {second}")
                self.flags = (kind.name, f"x{self.names}", f"y{self.names}", "None")
                self.expected = (kind.name, a, b)
            case FlagKind.LOGIC:
                if self.flags is not None and self.flags[0] != "LOGIC" and needed & CV:
                    self._settle()
                self.names += 1
                self.emit(f"x{self.names} = {first}")
                self.flags = ("LOGIC", f"x{self.names}")
            case FlagKind.WIDE:
                self._settle()
                self.emit(f"r[16:18] = of_wide({first}, {second})")
                self.flags = None
            case FlagKind.ADC | FlagKind.SBC:
                self._settle_carry()
                name = "of_sum_with_carry" if kind is FlagKind.ADC else "of_difference_with_borrow"
                self.emit(f"r[16:20] = {name}({first}, {second}, r[18])")
                self.flags = None
            case _:
                self.emit("r[16:20] = (UNKNOWN,) * 4")
                self.flags = None

    def _settle_carry(self) -> None:
        if self.flags is not None and self.flags[0] != "LOGIC":
            self._settle()

    def _settle(self) -> None:
        """Put all flags into their slots."""
        match self.flags:
            case ("SUB", a, b, result):
                self.emit(f"r[16:20] = of_difference({a}, {b}, {result})")
            case ("ADD", a, b, result):
                self.emit(f"r[16:20] = of_sum({a}, {b}, {result})")
            case ("LOGIC", a):
                self.emit(f"r[16:18] = of_result({a})")
        self.flags = None

    def _asked(self, condition: Condition) -> str:
        """What a condition asks, for slot ASKED."""
        code, negated = condition.value & ~1, bool(condition.value & 1)
        match self.flags:
            case ("SUB", a, b, result):
                source = f"Flags(Source.DIFFERENCE, {a}, {b}, {result})"
            case ("ADD", a, b, result):
                source = f"Flags(Source.SUM, {a}, {b}, {result})"
            case ("LOGIC", a) if code in (0, 4):
                source = f"Flags(Source.RESULT, {a})"
            case None:
                source = f"told_by({code}, r[16], r[17], r[18], r[19])"
            case _:
                source = "None"
        return f"{source}, {code}, {negated}"

    def _condition(self, condition: Condition) -> str:
        """An expression that is true when the condition holds; evaluating it may raise Undecided."""
        if condition is Condition.AL:
            return "True"
        code, negated = condition.value & ~1, condition.value & 1
        if code in self.answers:
            return f"not {self.answers[code]}" if negated else self.answers[code]
        text = self._from_operands(code)
        if text is None:
            self._settle()
            text = f"holds({code}, r[16], r[17], r[18], r[19])"
        return f"not ({text})" if negated else text

    def _from_operands(self, code: int) -> str | None:
        match self.flags, code:
            case ("SUB", a, b, _), 0:
                return f"{a} == {b}"
            case ("SUB", a, b, _), 2:
                return f"{a} >= {b}"
            case ("SUB", a, b, _), 4:
                return f"({a} - {b}) & {_H}"
            case ("SUB", a, b, _), 8:
                return f"{a} > {b}"
            case ("SUB", a, b, _), 10:
                return f"({a} ^ {_H}) >= ({b} ^ {_H})"
            case ("SUB", a, b, _), 12:
                return f"({a} ^ {_H}) > ({b} ^ {_H})"
            case ("ADD", a, b, _), 0:
                return f"({a} + {b}) & {_M} == 0"
            case ("ADD", a, b, _), 2:
                return f"overflows({a}, {b})"
            case ("ADD", a, b, _), 4:
                return f"({a} + {b}) & {_H}"
            case ("LOGIC", a), 0:
                return f"{a} == 0"
            case ("LOGIC", a), 4:
                return f"{a} & {_H}"
        return None
