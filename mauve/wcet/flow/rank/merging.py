"""States at one block put together: those that agree in all that lives on become one; too many become one that loses
what differs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mauve.wcet.flow.locations import WORD, Cell, Location, Region
from mauve.wcet.flow.rank.flags import UNKNOWN
from mauve.wcet.flow.rank.liveness import FLAGS
from mauve.wcet.flow.rank.terms import Term, add, bounds, subtract, variable

if TYPE_CHECKING:
    from mauve.wcet.flow.rank.paths import Program, State

MOST_STATES = 16
"""States kept apart at one block."""


def overlap(cell: Cell, region: Region) -> bool:
    """Whether the cell has a byte in the region."""
    return cell.base is region.base and cell.offset <= region.high and region.low < cell.offset + cell.size


def region_of(cell: Cell) -> Region:
    """The bytes of the cell."""
    return Region(cell.base, cell.offset, cell.offset + cell.size - 1)


def merged(program: Program, states: list[State], live: frozenset[int] | None) -> list[State]:
    """States with the same live values become one; when there are still too many, all do."""
    kept: list[State] = []
    for state in states:
        if live is not None:
            state.registers = {r: t for r, t in state.registers.items() if r in live or r == 13}
            if FLAGS not in live:
                state.flags = UNKNOWN
        for other in kept:
            if (state.registers, state.cells, state.lost, state.flags) == (
                other.registers,
                other.cells,
                other.lost,
                other.flags,
            ):
                other.known &= state.known
                other.vague |= state.vague
                break
        else:
            kept.append(state)
    if len(kept) <= MOST_STATES:
        return kept
    program.joined = True
    return [joined(program, kept)]


def joined(program: Program, states: list[State]) -> State:
    """One state that covers all: what differs becomes unknown, a constant difference becomes a small range."""
    first, rest = states[0], states[1:]
    if not rest:
        return first
    registers = {}
    for register in first.registers:
        terms = [s.registers.get(register) for s in states]
        registers[register] = _joined_terms(program, terms)
    cells: dict[Cell, Term] = {}
    lost = tuple(dict.fromkeys(r for s in states for r in s.lost))
    for cell in dict.fromkeys(c for s in states for c in s.cells):
        values = [peek(s, cell) for s in states]
        if all(v is not None for v in values):
            cells[cell] = _joined_terms(program, values, (1 << 8 * cell.size) - 1)
        elif region_of(cell) not in lost:
            lost += (region_of(cell),)
    flags = first.flags if all(s.flags == first.flags for s in rest) else UNKNOWN
    known = frozenset.intersection(*(s.known for s in states))
    return replace(first, registers=registers, cells=cells, lost=lost, flags=flags, known=known, vague=True)


def peek(state: State, cell: Cell) -> Term | None:
    """The cell's value if the state knows it, also when it is still the one of the start."""
    if cell in state.cells:
        return state.cells[cell]
    if any(overlap(cell, region_of(c)) for c in state.cells) or any(overlap(cell, r) for r in state.lost):
        return None
    return variable(cell)


def _joined_terms(program: Program, terms: list[Term | None], top: int = WORD - 1) -> Term:
    first = terms[0]
    if first is None or any(t is None for t in terms):
        return program.unknown(0, top)
    if all(t == first for t in terms):
        return first
    low = high = 0
    for term in terms:
        assert term is not None
        difference = bounds(subtract(term, first)).signed
        low, high = min(low, difference[0]), max(high, difference[1])
    if high - low < 1 << 16:
        return add(first, program.unknown(low, high))
    return program.unknown(0, top)


def value_at(program: Program, state: State, location: Location) -> Term:
    """The value of a register or cell in a state."""
    if isinstance(location, int):
        return state.registers.get(location) or program.unknown()
    return peek(state, location) or program.unknown(0, (1 << 8 * location.size) - 1)
