"""The automaton of a formula against the formula itself, evaluated on ultimately periodic words."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.mission.buchi import Automaton, TooLarge, automaton, negated
from mauve.mission.formula import Active, Binary, Formula, Infix, Prefix, Success, Truth, Unary

A, B, C = Active("a"), Active("b"), Success()
Word = tuple[list[frozenset[Formula]], list[frozenset[Formula]]]


def random_formula(random: Random, size: int) -> Formula:
    if size <= 1:
        return random.choice([A, B, C, A, B, C, Truth(True), Truth(False)])
    if random.random() < 0.4:
        return Prefix(random.choice(list(Unary)), random_formula(random, size - 1))
    left = random.randrange(1, size)
    operator = random.choice(list(Binary))
    return Infix(random_formula(random, left), operator, random_formula(random, size - left))


def random_word(random: Random) -> Word:
    def text(length: int) -> list[frozenset[Formula]]:
        return [frozenset(one for one in (A, B, C) if random.random() < 0.5) for _ in range(length)]

    return text(random.randrange(4)), text(random.randrange(1, 4))


formulas = st.recursive(
    st.sampled_from([A, B, C, Truth(True), Truth(False)]),
    lambda inner: (
        st.builds(Prefix, st.sampled_from(Unary), inner) | st.builds(Infix, inner, st.sampled_from(Binary), inner)
    ),
    max_leaves=6,
)
letters = st.frozensets(st.sampled_from([A, B, C]))
words = st.tuples(st.lists(letters, max_size=4), st.lists(letters, min_size=1, max_size=4))


def truths(formula: Formula, word: Word) -> list[bool]:
    """At which of the finitely many suffixes of prefix + cycle + cycle + ... the formula holds: by fixed points."""
    prefix, cycle = word
    text = prefix + cycle
    after = [at + 1 if at + 1 < len(text) else len(prefix) for at in range(len(text))]

    def least(now: list[bool], go: list[bool]) -> list[bool]:
        holds = [False] * len(text)
        for _ in text:
            holds = [now[at] or (go[at] and holds[after[at]]) for at in range(len(text))]
        return holds

    def greatest(now: list[bool], go: list[bool]) -> list[bool]:
        return [not one for one in least([not one for one in now], [not one for one in go])]

    match formula:
        case Truth(value):
            return [value] * len(text)
        case Prefix(operator, operand):
            inner = truths(operand, word)
            yes = [True] * len(text)
            match operator:
                case Unary.NOT:
                    return [not one for one in inner]
                case Unary.NEXT:
                    return [inner[after[at]] for at in range(len(text))]
                case Unary.EVENTUALLY:
                    return least(inner, yes)
                case Unary.ALWAYS:
                    return greatest(inner, [False] * len(text))
        case Infix(left, operator, right):
            a, b = truths(left, word), truths(right, word)
            pairs = list(zip(a, b, strict=True))
            match operator:
                case Binary.AND:
                    return [x and y for x, y in pairs]
                case Binary.OR:
                    return [x or y for x, y in pairs]
                case Binary.IMPLIES:
                    return [not x or y for x, y in pairs]
                case Binary.UNTIL:
                    return least(b, a)
                case Binary.UNLESS:
                    return [x or y for x, y in zip(least(b, a), greatest(a, [False] * len(text)), strict=True)]
                case Binary.RELEASE:  # b up to and with the first a, or for ever
                    holds = [True] * len(text)
                    for _ in text:
                        holds = [b[at] and (a[at] or holds[after[at]]) for at in range(len(text))]
                    return holds
    return [formula in letter for letter in text]


def accepts(machine: Automaton, word: Word) -> bool:
    """Whether some cycle of states over the word fulfils everything: brute force over pairs (place, state)."""
    prefix, cycle = word
    text = prefix + cycle
    edges: dict[tuple[int, int], list[tuple[int, tuple[int, int]]]] = {}
    reached, todo = {(0, 0)}, [(0, 0)]
    while todo:
        at, state = todo.pop()
        letter = sum(1 << i for i, atom in enumerate(machine.atoms) if atom in text[at])
        after = at + 1 if at + 1 < len(text) else len(prefix)
        fitting = [one for one in machine.arrows[state] if one.true & ~letter == 0 and one.false & letter == 0]
        edges[at, state] = [(one.fulfils, (after, one.target)) for one in fitting]
        todo += [node for _, node in edges[at, state] if node not in reached]
        reached |= {node for _, node in edges[at, state]}
    for start in reached:  # what the closed walks from here can fulfil together
        seen, todo2 = {(start, 0)}, [(start, 0)]
        while todo2:
            node, done = todo2.pop()
            for fulfils, target in edges[node]:
                if target == start and done | fulfils == machine.acceptance:
                    return True
                if (target, done | fulfils) not in seen:
                    seen.add((target, done | fulfils))
                    todo2.append((target, done | fulfils))
    return False


@settings(max_examples=30, deadline=None)
@given(formulas, words)
def test_accepts_exactly_the_words_that_satisfy_the_formula(formula: Formula, word: Word) -> None:
    holds = truths(formula, word)[0]
    assert accepts(automaton(formula), word) == holds
    assert accepts(automaton(negated(formula)), word) != holds


def test_many_random_formulas_on_random_words() -> None:
    random, satisfied = Random(7), 0
    for _ in range(400):
        formula = random_formula(random, random.randrange(1, 9))
        machine, opposite = automaton(formula), automaton(negated(formula))
        for word in (random_word(random) for _ in range(3)):
            holds = truths(formula, word)[0]
            satisfied += holds
            assert accepts(machine, word) == holds, (formula, word)
            assert accepts(opposite, word) != holds, (formula, word)
    assert 300 < satisfied < 900


@pytest.mark.parametrize(
    ("formula", "states"),
    [
        (Prefix(Unary.ALWAYS, A), 1),
        (Prefix(Unary.EVENTUALLY, A), 2),
        (Prefix(Unary.ALWAYS, Prefix(Unary.EVENTUALLY, A)), 2),
        (Prefix(Unary.ALWAYS, Infix(A, Binary.IMPLIES, Prefix(Unary.EVENTUALLY, B))), 2),
        (Infix(A, Binary.UNTIL, B), 2),
        (Infix(A, Binary.AND, Prefix(Unary.NOT, A)), 1),
    ],
)
def test_simplified_automata_are_small(formula: Formula, states: int) -> None:
    assert len(automaton(formula).arrows) <= states


def test_a_formula_without_words_has_no_transitions() -> None:
    assert automaton(Infix(A, Binary.AND, Prefix(Unary.NOT, A))).arrows == ((),)


def test_a_formula_past_the_limit_is_refused() -> None:
    many = [Prefix(Unary.EVENTUALLY, Active(f"a{at}")) for at in range(12)]
    formula: Formula = many[0]
    for one in many[1:]:
        formula = Infix(formula, Binary.AND, one)
    with pytest.raises(TooLarge):
        automaton(formula, limit=64)
