"""Which words the instructions of a function compare: where they lie when a block starts, and with what."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.microop import CompareBranch, Compute, FlagKind, Imm, Load, MicroOp, Op, Operand, SetFlags
from mauve.wcet.flow.domain import MASK


@dataclass(frozen=True, slots=True)
class Register:
    """A word in a register."""

    number: int


@dataclass(frozen=True, slots=True)
class Cell:
    """A number of `size` bytes in memory, `offset` bytes from where a register points."""

    register: int
    offset: int
    size: int


Where: TypeAlias = Register | Cell
Pairs: TypeAlias = tuple[tuple[Where, Where], ...]


@dataclass(frozen=True, slots=True)
class Compared:
    """`pairs` are compared with each other, `places` with anything; by place the `numbers` that stand on or beside the
    borders that comparisons with constants draw."""

    pairs: Pairs
    places: tuple[Where, ...]
    numbers: Mapping[Where, frozenset[int]]


_Known: TypeAlias = dict[int, tuple[Where, int]]
"""By register: a place and a number whose sum it holds."""


def compared_in(cfg: Cfg) -> Compared:
    """What a function compares."""
    pairs: dict[tuple[Where, Where], None] = {}
    places: dict[Where, None] = {}
    numbers: dict[Where, frozenset[int]] = {}
    for block in cfg.blocks:
        known: _Known = {register: (Register(register), 0) for register in range(15)}
        for instruction in block.instructions:
            for op in instruction.ops:
                if isinstance(op, SetFlags):
                    _note(op, known, pairs, places, numbers)
                else:
                    _define(known, op)
            if isinstance(instruction.flow, CompareBranch) and instruction.flow.register in known:
                places[known[instruction.flow.register][0]] = None
    return Compared(tuple(pairs), tuple(places), numbers)


def borders(number: int) -> Iterable[int]:
    """Where a range may end that a comparison with a number bounds."""
    return ((number + beside) & MASK for beside in (-1, 0, 1))


def _note(
    op: SetFlags,
    known: _Known,
    pairs: dict[tuple[Where, Where], None],
    places: dict[Where, None],
    numbers: dict[Where, frozenset[int]],
) -> None:
    operands = [known.get(operand) if isinstance(operand, int) else None for operand in (op.a, op.b)]
    found = [one[0] for one in operands if one is not None]
    places |= dict.fromkeys(found)
    if op.kind is FlagKind.SUB and len(found) == 2 and found[0] != found[1]:
        pairs[found[0], found[1]] = None
    elif op.kind in (FlagKind.SUB, FlagKind.ADD) and isinstance(op.b, Imm) and operands[0] is not None:
        place, moved = operands[0]
        number = op.b.value if op.kind is FlagKind.SUB else -op.b.value
        numbers[place] = numbers.get(place, frozenset()) | {*borders(number), *borders(number - moved)}


def _define(known: _Known, op: MicroOp) -> None:
    """Follow what an operation leaves in a register."""
    match op:
        case Compute(what, target, a, b):
            value = _moved(known, what, a, b)
        case Load(target, address, size):
            value = _loaded(known, address, size)
        case _:
            target, value = getattr(op, "dst", -1), None
    if value is None:
        known.pop(target, None)
    else:
        known[target] = value


def _moved(known: _Known, op: Op, a: Operand, b: Operand) -> tuple[Where, int] | None:
    """The sum of a place's word and a number."""
    value = known.get(a) if isinstance(a, int) else None
    if value is None:
        return None
    match op, b:
        case Op.MOV, _:
            return value
        case Op.ADD, Imm(number):
            return value[0], value[1] + number
        case Op.SUB, Imm(number):
            return value[0], value[1] - number
        case Op.AND, Imm(0xFF | 0xFFFF):
            return value
        case ((Op.UXTB | Op.UXTH), _):
            return value
    return None


def _loaded(known: _Known, address: Operand, size: int) -> tuple[Where, int] | None:
    value = known.get(address) if isinstance(address, int) else None
    if value is None or not isinstance(value[0], Register):
        return None
    return Cell(value[0].number, value[1], size), 0


__all__ = ["Cell", "Compared", "Pairs", "Register", "Where", "borders", "compared_in"]
