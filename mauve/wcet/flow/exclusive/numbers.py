"""Value numbers: what registers and memory hold at a point of a function, as terms over values that are fixed.

An atom of a term is a value that is the same throughout one execution of its scope: the function, or one iteration of a
loop. Where ways join and differ, a location gets a new atom; so does everything that a loop may change, at its header.
Two branches that test the same term test the same value.

Memory is versioned: a cell that nothing was stored to has the contents that it had at the last event that may have
changed it, and that value is one atom wherever it is read.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Protocol

from mauve.wcet.binary.microop import Condition
from mauve.wcet.flow.exclusive.facts import Facts, Key, OrderKey, facts_of
from mauve.wcet.flow.locations import HALF, WORD, Base, Cell, Region
from mauve.wcet.flow.rank.flags import UNKNOWN, Flags, facts, tells_all
from mauve.wcet.flow.rank.merging import overlap, region_of
from mauve.wcet.flow.rank.terms import Fresh, Kind, Relation, Term, Truth, add, atom, atoms, number

ROOT = -1
"""The scope of the whole function; loops have their own numbers."""
ALL = {base: Region(base, -WORD, 2 * WORD) for base in Base}
MOST_EVENTS = 12
"""Events of one kind of memory that are told apart."""


@dataclass(slots=True)
class State:
    """`objects` are values behind addresses that are no constant distance from anything, `heap` the event that may have
    changed them last. `events` are what may have changed memory: a number and where, the last one at the end. `facts`
    hold whenever control comes here."""

    registers: dict[int, Term]
    cells: dict[Cell, Term] = field(default_factory=dict)
    objects: dict[tuple[Term, int], Term] = field(default_factory=dict)
    events: tuple[tuple[int, Region], ...] = ()
    heap: int = 0
    flags: Flags = UNKNOWN
    facts: Facts = field(default_factory=dict)

    def copy(self) -> State:
        """A state that can be changed alone."""
        return State(
            dict(self.registers), dict(self.cells), dict(self.objects), self.events, self.heap, self.flags, self.facts
        )


class Meet(Protocol):
    """One term for the values that a location has on several ways."""

    def __call__(self, terms: list[Term], size: int = 4) -> Term:
        """The value, of so many bytes."""


class Numbering:
    """The atoms of one function: their scopes (`parents` maps a loop to the one around it), what they stand for, and by
    which condition some were chosen."""

    def __init__(self, parents: tuple[int, ...]) -> None:
        self._parents = parents
        self._scopes: list[int] = [ROOT]
        self._read: dict[tuple[object, int, int], Fresh] = {}
        self._chosen: dict[int, tuple[Relation, Term, Term]] = {}
        self.origins: dict[int, Cell | tuple[Term, int]] = {}
        self.scope = ROOT

    # ------------------------------------------------------------------------------------------------ atoms
    def _number(self, scope: int) -> int:
        self._scopes.append(scope)
        return len(self._scopes) - 1

    def unknown(self, size: int = 4, scope: int | None = None) -> Term:
        """A value of so many bytes of which nothing is known, fixed in the present scope."""
        return atom(Fresh(self._number(self.scope if scope is None else scope), 0, (1 << 8 * size) - 1))

    def chosen(self, of: Fresh) -> tuple[Relation, Term, Term] | None:
        """The condition that chose a value, the value where it holds, and the one where it does not."""
        return self._chosen.get(of.id)

    def around(self, scope: int, other: int) -> bool:
        """Whether `scope` is `other` or lies around it."""
        while other not in (scope, ROOT):
            other = self._parents[other]
        return scope in (ROOT, other)

    def scope_of(self, term: Term) -> int:
        """The innermost scope of a value in the term. The scopes of values that are read together are nested."""
        deepest = ROOT
        for of in atoms(term):
            mine = self._scopes[of.id] if isinstance(of, Fresh) else ROOT
            if self.around(deepest, mine):
                deepest = mine
        return deepest

    def _lasts(self, term: Term, scope: int) -> bool:
        """Whether every value in the term is fixed throughout `scope`."""
        return all(self.around(self._scopes[of.id], scope) for of in atoms(term) if isinstance(of, Fresh))

    # ------------------------------------------------------------------------------------------------ memory
    def read(self, state: State, cell: Cell) -> Term | None:
        """The contents of a cell; None where parts of it have been written apart."""
        known = state.cells.get(cell)
        if known is not None:
            return known
        if any(overlap(cell, region_of(other)) for other in state.cells):
            return None
        event = next((number for number, region in reversed(state.events) if overlap(cell, region)), 0)
        return self._contents(cell, event, self._scopes[event], cell.size)

    def read_object(self, state: State, address: Term, size: int) -> Term:
        """The value behind an address."""
        known = state.objects.get((address, size))
        if known is not None:
            return known
        scope = self.scope_of(address)
        mine = self._scopes[state.heap]
        return self._contents((address, size), state.heap, mine if self.around(scope, mine) else scope, size)

    def _contents(self, of: Cell | tuple[Term, int], event: int, scope: int, size: int) -> Term:
        key = (of, event, size)
        found = self._read.get(key)
        if found is None:
            found = self._read[key] = Fresh(self._number(scope), 0, (1 << 8 * size) - 1)
            self.origins[found.id] = of
        return atom(found)

    def write(self, state: State, cell: Cell, value: Term | None) -> None:
        """Store to a cell; None: anything."""
        mine = region_of(cell)
        for other in [c for c in state.cells if overlap(c, mine)]:
            del state.cells[other]
            if other != cell:
                self.lose(state, region_of(other))
        if value is None or cell.size not in (1, 2, 4):
            self.lose(state, mine)
        else:
            state.cells[cell] = value
        if cell.base is Base.ABSOLUTE:
            self.lose_objects(state)

    def write_object(self, state: State, address: Term, size: int, value: Term | None) -> None:
        """Store behind an address that is no constant: all but what surely lies beside it may change."""
        beside = {
            (where, width): known
            for (where, width), known in state.objects.items()
            if where.parts == address.parts and _apart(where.constant, width, address.constant, size)
        }
        self.lose(state, ALL[Base.ABSOLUTE])
        self.lose_objects(state)
        state.objects = beside
        if value is not None and size in (1, 2, 4):
            state.objects[address, size] = value

    def lose(self, state: State, region: Region) -> None:
        """The memory in the region may have changed."""
        for other in [c for c in state.cells if overlap(c, region)]:
            del state.cells[other]
        kept = tuple(event for event in state.events if not _inside(event[1], region))
        if sum(event[1].base is region.base for event in kept) >= MOST_EVENTS:
            region = ALL[region.base]
            for other in [c for c in state.cells if overlap(c, region)]:
                del state.cells[other]
            kept = tuple(event for event in kept if event[1].base is not region.base)
        state.events = (*kept, (self._number(self.scope), region))

    def lose_objects(self, state: State) -> None:
        """What lies behind pointers may have changed."""
        state.heap = self._number(self.scope)
        state.objects = {}

    # ------------------------------------------------------------------------------------------------ control flow
    def join(self, states: list[State]) -> tuple[State, list[Facts]]:
        """The state behind several ways, in the present scope, and for each way what coming by it says of the values
        that are new here. The facts of several states are not put together."""
        if len(states) == 1:
            return states[0], [{}]
        said: list[list[Relation]] = [[] for _ in states]

        def met(terms: list[Term], size: int = 4) -> Term:
            if all(term == terms[0] for term in terms):
                return terms[0]
            new = self.unknown(size)
            for relations, term in zip(said, terms, strict=True):
                if term.is_constant:
                    relations.append(Relation(Kind.EQ, new, term))
            return new

        result = State({})
        for register in range(15):
            result.registers[register] = met([state.registers[register] for state in states])
        self._join_memory(states, result, met)
        first = states[0].flags
        result.flags = first if all(state.flags == first for state in states) else UNKNOWN
        return result, [facts_of(relations, self.chosen) for relations in said]

    def _join_memory(self, states: list[State], result: State, met: Meet) -> None:
        shared = 0
        while all(shared < len(s.events) and s.events[shared] == states[0].events[shared] for s in states):
            shared += 1
        result.events = states[0].events[:shared]
        for region in dict.fromkeys(region for s in states for _, region in s.events[shared:]):
            self.lose(result, region)
        for cell in dict.fromkeys(cell for state in states for cell in state.cells):
            values = [self.read(state, cell) for state in states]
            known = [value for value in values if value is not None]
            if len(known) == len(states):
                # Cells of one state do not overlap.
                others = () if cell in states[0].cells else tuple(result.cells)
                for other in [c for c in others if overlap(c, region_of(cell))]:
                    del result.cells[other]
                    self.lose(result, region_of(other))
                result.cells[cell] = met(known, cell.size)
            else:
                self.lose(result, region_of(cell))
        result.heap = states[0].heap
        if any(state.heap != result.heap for state in states):
            self.lose_objects(result)
            keys = [key for key in states[0].objects if all(key in state.objects for state in states)]
        else:
            keys = list(dict.fromkeys(key for state in states for key in state.objects))
        for address, size in keys:
            result.objects[address, size] = met([self.read_object(state, address, size) for state in states], size)

    def choose(self, flags: Flags, condition: Condition, done: State, skipped: State) -> State:
        """The state after a conditional instruction: `done` where the condition holds, else `skipped`."""
        relations = facts(flags, condition)
        exact = relations[0] if tells_all(flags, condition) and len(relations) == 1 else None
        said = done.facts
        result, _ = self.join([done, skipped])
        result.facts = said
        if exact is None:
            return result
        for register, term in result.registers.items():
            yes = self._where(done.registers[register], exact, True)
            no = self._where(skipped.registers[register], exact, False)
            if done.registers[register] != skipped.registers[register]:
                result.registers[register] = self._choice(term, exact, yes, no)
        for cell, term in result.cells.items():
            if cell in done.cells and cell in skipped.cells and done.cells[cell] != skipped.cells[cell]:
                yes, no = self._where(done.cells[cell], exact, True), self._where(skipped.cells[cell], exact, False)
                result.cells[cell] = self._choice(term, exact, yes, no)
        return result

    def _choice(self, new: Term, relation: Relation, yes: Term, no: Term) -> Term:
        """The term for a value chosen by a relation, of which nothing was known but its name `new`."""
        if yes == no:
            return yes
        if yes.is_constant and no.is_constant:
            return add(no, atom(Truth(relation), yes.constant - no.constant))
        ((of, _),) = new.parts
        if isinstance(of, Fresh):
            self._chosen[of.id] = relation, yes, no
        return new

    def _where(self, term: Term, relation: Relation, holds: bool) -> Term:
        """The term where a relation holds, or does not."""
        if len(term.parts) == 1:
            ((of, factor),) = term.parts
            if isinstance(of, Truth) and relation in (of.relation, of.relation.negated):
                return number(term.constant + factor * (holds is (relation == of.relation)))
            if term.constant:
                return term
            chosen = self._chosen.get(of.id) if isinstance(of, Fresh) and factor == 1 else None
            if chosen is not None and relation in (chosen[0], chosen[0].negated):
                return chosen[1] if holds is (relation == chosen[0]) else chosen[2]
        return term

    def enter(self, state: State, loop: int, registers: Iterable[int], regions: Iterable[Region], heap: bool) -> None:
        """Turn the state in which a loop is entered into that at its header in any iteration; the loop becomes the
        present scope."""
        self.scope = loop
        for register in registers:
            if register < 15:
                state.registers[register] = self.unknown()
        for region in regions:
            self.lose(state, region)
        if heap:
            self.lose_objects(state)
        state.flags = UNKNOWN

    def leave(self, state: State, scope: int) -> State:
        """The state on an edge out of loops into `scope`: what is fixed in an iteration only gets a new name, that of
        its value at the end."""
        names: dict[Term, Term] = {}

        def renamed(term: Term, size: int = 4) -> Term:
            if self._lasts(term, scope):
                return term
            if term not in names:
                names[term] = self.unknown(size, scope)
            return names[term]

        numbers = {
            event: event if self.around(self._scopes[event], scope) else self._number(scope)
            for event in dict.fromkeys((*(event for event, _ in state.events), state.heap))
        }
        return State(
            {register: renamed(term) for register, term in state.registers.items()},
            {cell: renamed(term, cell.size) for cell, term in state.cells.items()},
            {key: renamed(term, key[1]) for key, term in state.objects.items() if self._lasts(key[0], scope)},
            tuple((numbers[event], region) for event, region in state.events),
            numbers[state.heap],
            UNKNOWN,
            self.lasting(state.facts, scope),
        )

    def lasting(self, known: Facts, scope: int) -> Facts:
        """The facts about values that are fixed throughout a scope."""
        return {key: allowed for key, allowed in known.items() if self._lasts(_terms(key), scope)}

    def key_scope(self, key: Key) -> int:
        """The scope throughout which the values in a key are fixed."""
        return self.scope_of(_terms(key))


def _terms(key: Key) -> Term:
    """A term with the atoms of a key."""
    parts = key.a.parts | key.b.parts if isinstance(key, OrderKey) else key.parts
    return Term(0, parts)


def _inside(inner: Region, outer: Region) -> bool:
    return inner.base is outer.base and outer.low <= inner.low and inner.high <= outer.high


def _apart(first: int, width: int, second: int, size: int) -> bool:
    """Whether two stretches of memory at constant distances from one place do not overlap."""
    distance = (second - first + HALF) % WORD - HALF
    return distance >= width or -distance >= size
