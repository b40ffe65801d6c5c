"""Linear temporal logic to a generalised Büchi automaton whose acceptance sits on its transitions.

The tableau of Couvreur ("On-the-fly verification of linear temporal logic", FM 1999, section 3): a state of the
automaton is the set of formulas that the rest of the word must satisfy; a transition reads one letter, and may promise
the right side of an until that it puts off. A run accepts where no promise is put off for ever.
"""

from __future__ import annotations

from typing import TypeAlias

from mauve.mission.formula import Binary, Formula, Infix, Prefix, Truth, Unary
from mauve.records import record

__all__ = ["Arrow", "Automaton", "TooLarge", "accepts_all", "automaton", "negated"]


class TooLarge(Exception):
    """The automaton of a formula has more states than the caller allows."""


@record
class Arrow:
    """Reads a letter with all atoms of `true` and none of `false` (bit sets over the automaton's atoms).

    `fulfils` is the set of untils (bits) whose right side this transition does not put off.
    """

    true: int
    false: int
    fulfils: int
    target: int


@record
class Automaton:
    """`arrows[q]` leave state q; state 0 is initial. A run accepts iff each bit of `acceptance` is fulfilled for ever
    again. A letter is a bit set: bit i says that atom i holds."""

    atoms: tuple[Formula, ...]
    arrows: tuple[tuple[Arrow, ...], ...]
    acceptance: int


# A formula in negation normal form. Literals are numbered: ("atom", index, positive).
Node: TypeAlias = tuple["str | int | bool | Node", ...]
Cover: TypeAlias = tuple[int, int, int, frozenset[Node]]
"""Atoms that must hold, atoms that must not, untils put off, and what the next letter on must satisfy."""

YES: Node = ("true",)
NO: Node = ("false",)


def negated(formula: Formula) -> Formula:
    """The formula that holds of exactly the other words."""
    return Prefix(Unary.NOT, formula)


def automaton(formula: Formula, limit: int = 512) -> Automaton:
    """The automaton of the words (of sets of atoms) that satisfy the formula; TooLarge past `limit` states."""
    atoms: list[Formula] = []
    start = frozenset([_normal(formula, True, atoms)])
    untils: list[Node] = []
    numbers: dict[frozenset[Node], int] = {start: 0}
    pending, drawn = [start], list[list[Cover]]()
    for state in pending:  # grows while it is read
        covers = _least(_cover_all(sorted(state, key=repr), untils, limit))
        drawn.append(covers)
        for cover in covers:
            if cover[3] not in numbers:
                if len(numbers) >= limit:
                    raise TooLarge(f"the automaton has more than {limit} states")
                numbers[cover[3]] = len(numbers)
                pending.append(cover[3])
    everything = (1 << len(untils)) - 1
    table = [[Arrow(yes, no, everything & ~late, numbers[rest]) for yes, no, late, rest in covers] for covers in drawn]
    return Automaton(tuple(atoms), _small(table), everything)


def accepts_all(machine: Automaton, state: int) -> bool:
    """Whether every word is accepted from this state: it loops on any letter and fulfils everything."""
    return any(
        one.target == state and not one.true and not one.false and one.fulfils == machine.acceptance
        for one in machine.arrows[state]
    )


# ------------------------------------------------------------------------------------------------ negation normal form
def _normal(formula: Formula, positive: bool, atoms: list[Formula]) -> Node:
    """The formula, or its negation, with negation at atoms only and four temporal operators: next, until, release."""
    match formula:
        case Truth(value):
            return YES if value == positive else NO
        case Prefix(operator, operand):
            return _normal_prefix(operator, operand, positive, atoms)
        case Infix(left, operator, right):
            return _normal_infix(left, operator, right, positive, atoms)
    if formula not in atoms:
        atoms.append(formula)
    return ("atom", atoms.index(formula), positive)


def _normal_prefix(operator: Unary, operand: Formula, positive: bool, atoms: list[Formula]) -> Node:
    if operator is Unary.NOT:
        return _normal(operand, not positive, atoms)
    inner = _normal(operand, positive, atoms)
    if operator is Unary.NEXT:
        return inner if inner in (YES, NO) else ("next", inner)
    return _until(YES, inner) if (operator is Unary.EVENTUALLY) == positive else _release(NO, inner)


def _normal_infix(left: Formula, operator: Binary, right: Formula, positive: bool, atoms: list[Formula]) -> Node:
    if operator is Binary.IMPLIES:
        a, b = _normal(left, not positive, atoms), _normal(right, positive, atoms)
        return _or(a, b) if positive else _and(a, b)
    a, b = _normal(left, positive, atoms), _normal(right, positive, atoms)
    match operator:
        case Binary.AND:
            return _and(a, b) if positive else _or(a, b)
        case Binary.OR:
            return _or(a, b) if positive else _and(a, b)
        case Binary.UNTIL:
            return _until(a, b) if positive else _release(a, b)
        case Binary.RELEASE:
            return _release(a, b) if positive else _until(a, b)
        case _:  # a unless b = b release (a or b); its negation is (not b) until (not a and not b)
            return _release(b, _or(a, b)) if positive else _until(b, _and(a, b))


def _opposite(a: Node, b: Node) -> bool:
    return a[0] == "atom" == b[0] and a[1] == b[1] and a[2] != b[2]


def _and(a: Node, b: Node) -> Node:
    if NO in (a, b) or _opposite(a, b):
        return NO
    if a in (YES, b):
        return b
    return a if b == YES else ("and", a, b)


def _or(a: Node, b: Node) -> Node:
    if YES in (a, b) or _opposite(a, b):
        return YES
    if a in (NO, b):
        return b
    return a if b == NO else ("or", a, b)


def _until(a: Node, b: Node) -> Node:
    if b in (YES, NO) or a in (NO, b):
        return b
    if b[0] == "until" and (a == b[1] or a == YES):  # F F b and a U (a U b)
        return ("until", a, b[2])
    return ("until", a, b)


def _release(a: Node, b: Node) -> Node:
    if b in (YES, NO) or a in (YES, b):
        return b
    if b[0] == "release" and (a == b[1] or a == NO):
        return ("release", a, b[2])
    return ("release", a, b)


# --------------------------------------------------------------------------------------------------------- the tableau
def _cover_all(nodes: list[Node], untils: list[Node], limit: int) -> list[Cover]:
    """All ways to satisfy all the nodes with one letter and what follows it."""
    covers: list[Cover] = [(0, 0, 0, frozenset())]
    for node in nodes:
        covers = _join(covers, _cover(node, untils, limit), limit)
    return covers


def _cover(node: Node, untils: list[Node], limit: int) -> list[Cover]:
    match node:
        case ("true",):
            return [(0, 0, 0, frozenset())]
        case ("false",):
            return []
        case ("atom", int(index), positive):
            return [(1 << index, 0, 0, frozenset()) if positive else (0, 1 << index, 0, frozenset())]
        case ("and", tuple(a), tuple(b)):
            return _join(_cover(a, untils, limit), _cover(b, untils, limit), limit)
        case ("or", tuple(a), tuple(b)):
            return _least(_cover(a, untils, limit) + _cover(b, untils, limit))
        case ("next", tuple(a)):
            return [(0, 0, 0, _conjuncts(a))]
        case ("until", tuple(a), tuple(b)):
            if node not in untils:
                untils.append(node)
            later: list[Cover] = [(0, 0, 1 << untils.index(node), frozenset([node]))]
            return _least(_cover(b, untils, limit) + _join(_cover(a, untils, limit), later, limit))
        case ("release", tuple(a), tuple(b)):
            now = _cover(b, untils, limit)
            kept: list[Cover] = [(0, 0, 0, frozenset([node]))]
            return _least(_join(_cover(a, untils, limit), now, limit) + _join(now, kept, limit))
    raise ValueError(f"no such operator: {node[0]}")


def _conjuncts(node: Node) -> frozenset[Node]:
    if node == YES:
        return frozenset()
    match node:
        case ("and", tuple(a), tuple(b)):
            return _conjuncts(a) | _conjuncts(b)
    return frozenset([node])


def _join(some: list[Cover], others: list[Cover], limit: int) -> list[Cover]:
    if len(some) * len(others) > 2 * limit:
        raise TooLarge("a state of the automaton has too many transitions")
    joined = [(a[0] | b[0], a[1] | b[1], a[2] | b[2], a[3] | b[3]) for a in some for b in others]
    return _least([one for one in joined if not one[0] & one[1]])


def _least(covers: list[Cover]) -> list[Cover]:
    """Without those that ask for all that another one asks for: each word they accept, the other accepts."""
    kept: list[Cover] = []
    for one in sorted(set(covers), key=lambda one: (one[0].bit_count() + one[1].bit_count(), len(one[3]), repr(one))):
        if not any(_asks_no_more(other, one) for other in kept):
            kept = [other for other in kept if not _asks_no_more(one, other)]
            kept.append(one)
    return kept


def _asks_no_more(a: Cover, b: Cover) -> bool:
    return a[0] & ~b[0] == 0 and a[1] & ~b[1] == 0 and a[2] & ~b[2] == 0 and a[3] <= b[3]


# ------------------------------------------------------------------------------------------------------ simplification
def _small(table: list[list[Arrow]]) -> tuple[tuple[Arrow, ...], ...]:
    """Without states that accept nothing for want of transitions, and with one of each group of equal states."""
    while True:
        alive = [bool(arrows) for arrows in table]
        table = [[one for one in arrows if alive[one.target]] for arrows in table]
        first: dict[frozenset[Arrow], int] = {}
        stands = [first.setdefault(frozenset(arrows), at) for at, arrows in enumerate(table)]
        merged = [
            list(dict.fromkeys(Arrow(one.true, one.false, one.fulfils, stands[one.target]) for one in arrows))
            for arrows in table
        ]
        if merged == table and all(bool(arrows) == was for arrows, was in zip(table, alive, strict=True)):
            return _reachable(table)
        table = merged


def _reachable(table: list[list[Arrow]]) -> tuple[tuple[Arrow, ...], ...]:
    order, number = [0], {0: 0}
    for state in order:
        for one in table[state]:
            if one.target not in number:
                number[one.target] = len(order)
                order.append(one.target)
    return tuple(
        tuple(Arrow(one.true, one.false, one.fulfils, number[one.target]) for one in table[state]) for state in order
    )
