"""The question that every ranking argument answers: the passes of a loop, what holds on them, and how it is entered.

The header runs once more than control passes along a back edge. A pass is the state at the end of a back edge in terms
of the values at the start of the header, with the relations that held on the way.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from mauve.wcet.flow.locations import WORD, Interval, Location
from mauve.wcet.flow.rank.measures import Contradiction, Knowledge, hull, learn
from mauve.wcet.flow.rank.merging import value_at
from mauve.wcet.flow.rank.paths import Program, State
from mauve.wcet.flow.rank.terms import (
    Atom,
    Fresh,
    Kind,
    Ranges,
    Relation,
    Term,
    Truth,
    Var,
    atom,
    atoms,
    bounds,
    meet,
    number,
    scale,
    static_range,
    substitute,
    subtract,
)

MOST_RELATIONS, DEEPEST_RELATION = 14, 12
MOST = 1 << 20
"""A greater number of passes only says how wide a type is, and counts as none."""


@dataclass(slots=True)
class Problem:
    """A loop to rank: its passes with what is known on each, and the states in which it is entered (none: unknown)."""

    program: Program
    ranges: Ranges
    """what holds of an atom at the header in any iteration"""
    entry_ranges: Ranges
    """what holds of an atom when the loop is entered"""
    passes: list[State]
    known: list[Knowledge]
    entries: list[tuple[State, Knowledge]]

    def after(self, term: Term, index: int) -> Term | None:
        """The term's value after pass `index`, in terms of the values before."""
        return self.within(self.passes[index], term)

    def within(self, state: State, term: Term) -> Term | None:
        """The term with its variables replaced by their values in a state."""
        return substitute(term, lambda of: value_at(self.program, state, of.location) if isinstance(of, Var) else None)

    def is_invariant(self, term: Term) -> bool:
        """Whether no pass changes the term."""
        return is_header_term(term) and all(self.after(term, i) == term for i in range(len(self.passes)))

    def on_entry(self, term: Term) -> Interval:
        """The term's values when the loop is entered."""
        best = bounds(term, self.entry_ranges)
        if not self.entries:
            return best
        found = []
        for state, knowledge in self.entries:
            there = self.within(state, term)
            if there is None:
                return best
            found.append(knowledge.of_term(there))
        return meet(best, hull(found))


def is_header_term(term: Term) -> bool:
    """Whether the term is made of values at the header alone: an unknown of one pass is another one in the next."""
    return not any(isinstance(of, Fresh | Truth) for of in atoms(term))


def pose(
    program: Program,
    passes: list[State],
    entries: list[State],
    ranges: Ranges = static_range,
    entry_ranges: Ranges = static_range,
) -> Problem:
    """Put the facts of each pass and entry together; those whose facts contradict each other are dropped."""
    kept: list[State] = []
    known: list[Knowledge] = []
    for state in passes:
        _settle_constants(state, ranges)
        _eliminate(state)
        state.known = _telling(state.known)
        try:
            known.append(learn(Knowledge(ranges), sorted(state.known, key=str)))
            kept.append(state)
        except Contradiction:
            continue
    possible: list[tuple[State, Knowledge]] = []
    for entry in entries:
        try:
            possible.append((entry, learn(Knowledge(static_range), sorted(entry.known, key=str))))
        except Contradiction:
            continue
    return Problem(program, ranges, entry_ranges, kept, known, possible)


def _settle_constants(state: State, ranges: Ranges) -> None:
    """Write numbers for the variables that are the same number in every iteration."""

    def number_of(of: Atom) -> Term | None:
        known = ranges(of) if isinstance(of, Var) else None
        return number(known.low) if known is not None and known.low == known.high else None

    def change(term: Term) -> Term:
        return substitute(term, number_of) or term

    if any(number_of(of) is not None for r in state.known for t in (r.a, r.b) for of in atoms(t)):
        state.registers = {r: change(t) for r, t in state.registers.items()}
        state.cells = {c: change(t) for c, t in state.cells.items()}
        state.known = frozenset({Relation(r.kind, change(r.a), change(r.b)) for r in state.known})


def _telling(known: frozenset[Relation]) -> frozenset[Relation]:
    """The simplest relations: arguments get slow with many and learn nothing from deep terms."""
    small = [r for r in known if r.a.size + r.b.size <= DEEPEST_RELATION]
    return frozenset(sorted(small, key=lambda r: (r.a.size + r.b.size, str(r)))[:MOST_RELATIONS])


def _eliminate(state: State) -> None:
    """Replace unknowns of the pass by what they are known to be equal to."""
    for relation in sorted(state.known, key=str):
        if relation.kind is not Kind.EQ:
            continue
        difference = subtract(relation.a, relation.b)
        for of, factor in sorted(difference.parts, key=lambda part: str(part[0])):
            if not isinstance(of, Fresh) or factor not in (1, WORD - 1):
                continue
            # factor * of + rest == 0, so of == -rest / factor
            rest = subtract(difference, atom(of, factor))
            value = scale(rest, -1 if factor == 1 else 1)
            if of not in atoms(value):
                _replace(state, of, value)
                break


def _replace(state: State, old: Fresh, value: Term) -> None:
    def change(term: Term) -> Term:
        return substitute(term, lambda of: value if of == old else None) or term

    state.registers = {r: change(t) for r, t in state.registers.items()}
    state.cells = {c: change(t) for c, t in state.cells.items()}
    state.known = frozenset({Relation(r.kind, change(r.a), change(r.b)) for r in state.known}) | state.known


def locations(problem: Problem) -> Iterator[Location]:
    """Registers and cells that the relations of the first pass speak of."""
    found = {of.location for r in problem.passes[0].known for t in (r.a, r.b) for of in atoms(t) if isinstance(of, Var)}
    yield from sorted(found, key=str)
