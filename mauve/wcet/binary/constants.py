"""Registers and stack slots that hold one constant, as far as the known code of a function tells.

Compilers load the base of a switch table before a loop, and keep it in a register, or in the frame where registers are
short. Followed forward over the code: constants, and addresses in the frame, in registers and in words of the frame.
Joined where ways meet.

Called functions with a symbol keep r4 to r11 and sp (AAPCS 6.1.1, which every result assumes). What is stored at an
address of which nothing is known may change the frame from the lowest address on of which something was told: that was
stored, passed to a call, or added to something unknown. Compilers keep what they spill below or above such an object,
and never inside.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import EdgeKind
from mauve.wcet.binary.microop import (
    FIRST_TEMPORARY,
    SP,
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
from mauve.wcet.binary.terms import MASK, concrete, signed

_KEPT = (4, 5, 6, 7, 8, 9, 10, 11, SP)
_MOST = 40_000
"""Instructions of a function that are followed."""
_VISITS = 24
"""How often a block is followed on average before giving up."""


@dataclass(frozen=True, slots=True)
class InFrame:
    """The address so many bytes above where sp was at the entry."""

    offset: int


Known = int | InFrame


@dataclass(slots=True)
class Values:
    """What is known at one place: `registers` and words of the frame (`slots`, by offset); `told` is the lowest offset
    of which code elsewhere may know the address."""

    registers: dict[int, Known] = field(default_factory=dict)
    slots: dict[int, Known] = field(default_factory=dict)
    told: int = 1 << 40

    def copy(self) -> Values:
        """The same, to be changed."""
        return Values(dict(self.registers), dict(self.slots), self.told)

    def of(self, operand: Operand) -> Known | None:
        """The value of an operand."""
        return operand.value & MASK if isinstance(operand, Imm) else self.registers.get(operand)

    def join(self, other: Values) -> bool:
        """Keep what both know; whether that changed this one."""
        registers = {r: v for r, v in self.registers.items() if other.registers.get(r) == v}
        slots = {o: v for o, v in self.slots.items() if other.slots.get(o) == v}
        told = min(self.told, other.told)
        changed = (len(registers), len(slots), told) != (len(self.registers), len(self.slots), self.told)
        self.registers, self.slots, self.told = registers, slots, told
        return changed

    def tell(self, value: Known | None) -> None:
        """Somebody else may know this value from now on."""
        if isinstance(value, InFrame):
            self.told = min(self.told, value.offset)

    def forget_told(self) -> None:
        """Memory changes at an address of which nothing is known."""
        self.slots = {offset: value for offset, value in self.slots.items() if offset + 4 <= self.told}

    def write(self, offset: int, size: int, value: Known | None) -> None:
        """Store at a place in the frame."""
        for other in [o for o in self.slots if offset - 4 < o < offset + size]:
            del self.slots[other]
        if size == 4 and value is not None:
            self.slots[offset] = value


class Constants:
    """What is known at the start of each block. `after`: the ways on from an instruction, as (target, kind)."""

    def __init__(
        self,
        binary: Binary,
        entry: int,
        instructions: Mapping[int, Instruction],
        after: Mapping[int, Iterable[tuple[int, EdgeKind]]],
        keeps: Callable[[Instruction], bool],
    ) -> None:
        self._binary, self._instructions, self._after, self._keeps = binary, instructions, after, keeps
        leaders = {entry, *(target for ways in after.values() for target, _ in ways)}
        self._starts: dict[int, Values] = {entry: Values({SP: InFrame(0)})}
        self._leaders = leaders
        self.made: set[int] = set()
        """all constants that instructions compute"""
        if len(instructions) <= _MOST and not self._settle(entry):
            self._starts = {}

    def at(self, address: int) -> Values:
        """What is known before the instruction at an address: nothing for code that was not reached."""
        start, passed = address, list[int]()
        while start not in self._leaders:
            before = next(
                (a for size in (2, 4) if (i := self._instructions.get(a := start - size)) and i.size == size), None
            )
            if before is None:
                return Values()
            start = before
            passed.append(before)
        values = self._starts.get(start)
        if values is None:
            return Values()
        values = values.copy()
        for place in reversed(passed):
            self._pass(self._instructions[place], values)
        return values

    def loaded(self, address: int) -> Known | None:
        """What the instruction at an address loads, where that is one word of the frame."""
        instruction = self._instructions[address]
        loads = [op for op in instruction.ops if isinstance(op, Load)]
        if len(loads) != 1 or instruction.condition is not Condition.AL:
            return None
        values = self.at(address)
        for op in instruction.ops:
            if op is loads[0]:
                where = values.of(loads[0].address)
                return values.slots.get(where.offset) if isinstance(where, InFrame) and loads[0].size == 4 else None
            self._operation(op, values)
        return None

    def _settle(self, entry: int) -> bool:
        """Follow the code until nothing new comes; False where that takes too long."""
        work, left = [entry], _VISITS * len(self._leaders) + 64
        while work:
            left -= 1
            if left < 0:
                return False
            address = work.pop()
            values = self._starts[address].copy()
            guard, skipped = Condition.AL, values  # what is known where a condition does not hold since it was asked
            while (instruction := self._instructions.get(address)) is not None:
                if instruction.condition not in (Condition.AL, guard):
                    guard, skipped = instruction.condition, values.copy()
                passed = skipped if instruction.condition is guard else values
                self._pass(instruction, values, goes=True)
                if guard is not Condition.AL and instruction.condition is Condition.AL:
                    self._pass(instruction, skipped)
                if any(isinstance(op, SetFlags | SetCarry) for op in instruction.ops):
                    guard = Condition.AL
                ways = list(self._after.get(address, ()))
                if isinstance(instruction.flow, Next | SupervisorCall):
                    if instruction.end not in self._leaders:
                        address = instruction.end
                        continue
                    ways.append((instruction.end, EdgeKind.FALL))
                for target, kind in ways:
                    if self._arrive(target, kind, instruction, passed if kind is EdgeKind.FALL else values):
                        work.append(target)
                break
        return True

    def _arrive(self, target: int, kind: EdgeKind, instruction: Instruction, values: Values) -> bool:
        if kind is EdgeKind.CALL:
            values = self._called(instruction, values)
        known = self._starts.get(target)
        if known is None:
            self._starts[target] = values.copy()
            return True
        return known.join(values)

    def _called(self, instruction: Instruction, values: Values) -> Values:
        """What is known behind a call."""
        if not self._keeps(instruction):
            return Values()
        after = values.copy()
        for register in range(4):
            after.tell(values.registers.get(register))
        after.registers = {r: v for r, v in values.registers.items() if r in _KEPT}
        stack = values.registers.get(SP)
        least = stack.offset if isinstance(stack, InFrame) else 1 << 40
        after.slots = {o: v for o, v in values.slots.items() if o >= least}
        after.forget_told()
        return after

    # ------------------------------------------------------------------------------------------------ instructions
    def _pass(self, instruction: Instruction, values: Values, goes: bool = False) -> None:
        """Run an instruction; a branch is taken where it `goes`."""
        sure = instruction.condition is Condition.AL or (goes and not isinstance(instruction.flow, Next))
        before = None if sure else values.copy()
        for op in instruction.ops:
            self._operation(op, values)
        for register in [r for r in values.registers if r >= FIRST_TEMPORARY]:
            del values.registers[register]
        if before is not None:
            values.join(before)

    def _operation(self, op: MicroOp, values: Values) -> None:
        match op:
            case Compute(name, dst, a, b):
                computed = _computed(name, values, a, b)
                if isinstance(computed, int):
                    self.made.add(computed)
                self._set(values, dst, computed)
            case Load(dst, address, size, is_signed):
                self._set(values, dst, self._loaded(values, values.of(address), size, is_signed))
            case Store(address, value, size):
                values.tell(values.of(value))
                self._store(values, values.of(address), size, values.of(value))
            case StoreUnknown(address, size):
                self._store(values, values.of(address), size, None)
            case _:
                other = getattr(op, "dst", None)
                if isinstance(other, int):
                    self._set(values, other, None)

    def _set(self, values: Values, register: int, value: Known | None) -> None:
        if value is None:
            values.registers.pop(register, None)
        else:
            values.registers[register] = value

    def _loaded(self, values: Values, address: Known | None, size: int, is_signed: bool) -> Known | None:
        if isinstance(address, InFrame):
            return values.slots.get(address.offset) if size == 4 else None
        raw = None if address is None else self._binary.read_constant(address, size)
        return None if raw is None else int.from_bytes(raw, "little", signed=is_signed) & MASK

    def _store(self, values: Values, address: Known | None, size: int, value: Known | None) -> None:
        if isinstance(address, InFrame):
            values.write(address.offset, size, value)
        elif address is None:
            values.forget_told()


def _computed(op: Op, values: Values, a: Operand, b: Operand) -> Known | None:
    x, y = values.of(a), values.of(b)
    if op is Op.MOV:
        return x
    if isinstance(x, int) and isinstance(y, int):
        return concrete(op, x, y)
    if op in (Op.ADD, Op.SUB):
        if isinstance(x, InFrame) and isinstance(y, int):
            return InFrame(x.offset + (signed(y) if op is Op.ADD else -signed(y)))
        if isinstance(y, InFrame) and isinstance(x, int) and op is Op.ADD:
            return InFrame(y.offset + signed(x))
    values.tell(x)
    values.tell(y)
    return None
