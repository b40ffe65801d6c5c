"""Micro-operations of the FPU and of the DSP extension as lines of Python, for the functions that blocks become.

GE has a slot among the machine's registers, and the FPU has some: N, Z, C and V of FPSCR, a mode (0 where FPSCR asks
for the arithmetic of `floating`, else unknown), and s0 to s31. Its temporaries have numbers behind the slots.
"""

from __future__ import annotations

from collections.abc import Callable

from mauve.wcet.binary.floats import (
    FLOATS,
    FloatCompare,
    FloatCompute,
    FloatConstant,
    FloatFlags,
    FloatMicroOp,
    FloatMode,
    FloatOp,
    FromFloat,
    FromInteger,
    ToFloat,
    ToInteger,
)
from mauve.wcet.binary.media import MediaMicroOp, Parallel, Refine, Saturate, Select
from mauve.wcet.binary.microop import Compute, Instruction, Load

FLOAT_FLAGS, FLOAT_MODE, GREATER, FLOAT = 24, 28, 29, 30
SLOTS = FLOAT + FLOATS
"""Slots of the FPU, that of GE, and how many there are in all."""

Name = Callable[[int], str]
"""The name of a register by its slot, noting that it is read or written."""

_ONE = frozenset({FloatOp.MOV, FloatOp.NEG, FloatOp.ABS, FloatOp.SQRT})
_ANY_MODE = frozenset({FloatOp.NEG, FloatOp.ABS})
"""Operations with the same result in every mode."""


def has_slot(register: int) -> bool:
    """Whether a number is that of a register (of the core or the FPU) and not of a temporary."""
    return register < 16 or FLOAT_FLAGS <= register < SLOTS


def written(instruction: Instruction) -> set[int]:
    """The slots of all registers that an instruction may write; the core's flags apart."""
    slots: set[int] = set()
    for op in instruction.ops:
        match op:
            case Compute(dst=dst) | Load(dst=dst) | FromFloat(dst=dst) | Refine(dst=dst):
                slots.add(dst)
            case Parallel(prefix=prefix) if prefix.compares:
                slots.add(GREATER)
            case FloatCompute(dst=dst) | FloatConstant(dst=dst) | ToFloat(dst=dst):
                slots.add(FLOAT + dst)
            case FromInteger(dst=dst) | ToInteger(dst=dst):
                slots.add(FLOAT + dst)
            case FloatCompare():
                slots |= set(range(FLOAT_FLAGS, FLOAT_MODE))
            case FloatMode():
                slots |= set(range(FLOAT_FLAGS, GREATER))
    return {slot for slot in slots if has_slot(slot)}


def media_line(op: MediaMicroOp, use: Name, target: Name) -> str:
    """The statement for a micro-operation of the DSP extension."""
    match op:
        case Parallel(dst, prefix, shape, a, b):
            text = f"media_parallel({prefix.value!r}, {shape.value!r}, {use(a)}, {use(b)})"
            if prefix.compares:
                return f"{target(dst)}, {target(GREATER)} = {text}"
            return f"{target(dst)} = {text}[0]"
        case Select(dst, a, b):
            return f"{target(dst)} = media_select({use(GREATER)}, {use(a)}, {use(b)})"
        case Saturate(dst, a, bits, signed):
            return f"{target(dst)} = media_saturate({use(a)}, {bits}, {signed})"
        case Refine(dst, source):
            return f"{target(dst)} = {use(source)}"


def float_line(op: FloatMicroOp, use: Name, target: Name) -> str:
    """The statement for a micro-operation of the FPU."""
    text: str
    to: int
    match op:
        case ToFloat(dst, source):
            text, to = use(source), FLOAT + dst
        case FromFloat(dst, source):
            text, to = use(FLOAT + source), dst
        case FloatConstant(dst, bits):
            text, to = str(bits), FLOAT + dst
        case FloatCompute(dst=dst):
            text, to = _computed(op, use), FLOAT + dst
        case FromInteger(dst, a, signed, size, fraction):
            text = _usual(f"float_from_integer({use(FLOAT + a)}, {signed}, {size}, {fraction})", use)
            to = FLOAT + dst
        case ToInteger(dst, a, signed, size, fraction, rounds):
            text = _usual(f"float_to_integer({use(FLOAT + a)}, {signed}, {size}, {fraction}, {rounds})", use)
            to = FLOAT + dst
        case FloatCompare(a, b):
            text = f"float_compare({use(FLOAT + a)}, {0 if b is None else use(FLOAT + b)})"
            text = _usual(text, use, "(UNKNOWN,) * 4")
            return f"{_flags(target)} = {text}"
        case FloatFlags():
            return f"r[16:20] = {_flags(use)}"
        case FloatMode(source):
            word = "UNKNOWN" if source is None else use(source)
            return f"{target(FLOAT_MODE)} = float_mode({word}); {_flags(target)} = float_flags({word})"
    return f"{target(to)} = {text}"


def _computed(op: FloatCompute, use: Name) -> str:
    if op.op is FloatOp.UNKNOWN:
        return "UNKNOWN"
    numbers = (op.a,) if op.op in _ONE else (op.a, op.b, op.c) if op.op is FloatOp.FMA else (op.a, op.b)
    operands = ", ".join(use(FLOAT + number) for number in numbers)
    if op.op is FloatOp.MOV:
        return operands
    text = f"float_{op.op.value}({operands})"
    return text if op.op in _ANY_MODE else _usual(text, use)


def _usual(text: str, use: Name, otherwise: str = "UNKNOWN") -> str:
    """A result that holds where FPSCR asks for the usual arithmetic."""
    return f"{text} if type({use(FLOAT_MODE)}) is int else {otherwise}"


def _flags(name: Name) -> str:
    return ", ".join(name(FLOAT_FLAGS + i) for i in range(4))
