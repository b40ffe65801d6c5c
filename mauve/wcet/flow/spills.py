"""Words that compilers keep in FPU registers, in the abstract states of the value analysis.

The registers are cells of a region of their own, so joins and loop headers treat them like stack slots. Numbers are not
computed with: the result of a floating-point operation is unknown. An address that goes there counts as one that is
held in the frame: whatever comes out of an FPU register of which nothing is known may be it.
"""

from __future__ import annotations

from mauve.wcet.binary.floats import (
    FloatCompute,
    FloatConstant,
    FloatOp,
    FromFloat,
    FromInteger,
    ToFloat,
    ToInteger,
)
from mauve.wcet.binary.microop import FIRST_TEMPORARY, MicroOp
from mauve.wcet.flow.linear import FPU, Value, is_entry_symbol
from mauve.wcet.flow.state import State

CALLER_SAVED = 16
"""s0 to s15 are the callee's to overwrite (AAPCS, VFP variant and base standard alike)."""


def operate(state: State, op: MicroOp) -> None:
    """Change the state as a micro-operation of the FPU does; the DSP extension's are left out."""
    match op:
        case ToFloat(dst, source):
            value = state.regs[source]
            state.held |= state.mask(value)
            _put(state, dst, value if source < FIRST_TEMPORARY or _says_something(state, value) else None)
        case FromFloat(dst, source):
            found = _get(state, source)
            state.regs[dst] = state.tainted(state.fresh(), state.held) if found is None else found
        case FloatConstant(dst, word):
            _put(state, dst, word)
        case FloatCompute(FloatOp.MOV, dst, a):
            _put(state, dst, _get(state, a))
        case FloatCompute(dst=dst) | FromInteger(dst=dst) | ToInteger(dst=dst):
            _put(state, dst, None)


def forget_after_call(state: State) -> None:
    """Drop what a callee may overwrite."""
    if any(offset < 4 * CALLER_SAVED for offset in state.memory.get(FPU, ())):
        cells = state.cells(FPU)
        for offset in [offset for offset in cells if offset < 4 * CALLER_SAVED]:
            del cells[offset]


def _get(state: State, register: int) -> Value | None:
    cell = state.memory.get(FPU, {}).get(4 * register)
    return None if cell is None else cell[1]


def _put(state: State, register: int, value: Value | None) -> None:
    if value is not None:
        state.cells(FPU)[4 * register] = (4, value)
    elif 4 * register in state.memory.get(FPU, ()):
        del state.cells(FPU)[4 * register]


def _says_something(state: State, value: Value) -> bool:
    """Whether a word from memory is worth following: not so a number of which nothing is known."""
    if type(value) is int:
        return True
    assert isinstance(value, tuple)
    symbol = value[1]
    return len(value) > 3 or is_entry_symbol(symbol) or symbol in state.ranges or state.mask(value) != 0
