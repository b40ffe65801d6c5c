"""Abstract execution of the passes on intervals of a few measures: shifts, doublings, divisions, halved distances."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow.locations import WORD, Interval
from mauve.wcet.flow.rank.measures import Contradiction, Knowledge, hull, intersection, learn, pull_halves
from mauve.wcet.flow.rank.problem import Problem
from mauve.wcet.flow.rank.terms import (
    Apply,
    Atom,
    Fresh,
    Ranges,
    Relation,
    Term,
    Var,
    add,
    atom,
    atoms,
    interval,
    simplify,
    substitute,
    subtract,
    variable,
)

MOST_STEPS = 160
"""steps times passes"""
STEADY = 6
"""After so many steps that were all the same it is looked where they lead."""
MOST_MEASURES = 10


@dataclass(frozen=True, slots=True)
class _Distance:
    """The measure x - y of two variables, and the atom that stands for it inside other terms."""

    x: Var
    y: Var
    name: Fresh
    term: Term
    """x - y"""
    whole: Term
    """x as y and the distance"""
    rewritten: dict[Term, Term | None] = field(default_factory=dict, compare=False)
    """terms in which x was written so"""

    def rewrite(self, term: Term) -> Term | None:
        """The term with x written as y and the distance; None where it grows too large."""
        if term not in self.rewritten:
            self.rewritten[term] = substitute(term, lambda of: self.whole if of == self.x else None)
        return self.rewritten[term]


def _distance(x: Var, y: Var, name: Fresh) -> _Distance:
    return _Distance(x, y, name, subtract(atom(x), atom(y)), add(atom(y), atom(name)))


def iterate(problem: Problem) -> int | None:
    """How many passes can follow each other, by following intervals.

    I(0) holds the measures at entry; I(n + 1) holds them after any pass that is possible from I(n), given the relations
    of the pass. By induction I(n) contains the measures whenever n passes have been made; when no pass is possible from
    I(n), at most n are ever made. Measures are the variables that the relations depend on, and the distances between
    variables that are compared, so that halving an interval shows: with w = hi - lo, (lo + hi) / 2 is lo + w / 2.
    """
    engine = Engine(problem)
    if not 0 < len(engine.measures) <= MOST_MEASURES:
        return None
    history = [engine.start()]
    most = max(MOST_STEPS // len(problem.passes), 1)
    for steps in range(most):
        following = engine.step(history[-1])
        if following is None:
            return steps
        if following == history[-1]:
            return None
        history.append(following)
        if steps % STEADY == 0 and steps > 2 * STEADY and _leads_nowhere(problem, history, most - steps):
            return None
    return None


def _leads_nowhere(problem: Problem, history: list[list[Interval]], left: int) -> bool:
    """Whether all ends of the intervals have moved by the same steps for a while, and would not come to another end or
    to a number in a relation in the steps that are left (a heuristic: slow counters have arguments of their own)."""
    ends = [[end for of in moment for end in (of.low, of.high)] for moment in history[-STEADY:]]
    steps = [b - a for a, b in zip(ends[-2], ends[-1], strict=True)]
    for before, after in pairwise(ends):
        if any(b - a != step for a, b, step in zip(before, after, steps, strict=True)):
            return False
    marks = {t.constant for s in problem.passes for r in s.known for t in (r.a, r.b, subtract(r.a, r.b))}
    fixed = [(mark, 0) for mark in {0, WORD // 2} | marks | {WORD - mark for mark in marks}]
    moving = list(zip(ends[-1], steps, strict=True))
    for end, step in moving:
        for mark, its_step in (*moving, *fixed) if step else ():
            nearer = step - its_step
            gap = (mark - end if nearer > 0 else end - mark) % WORD
            if nearer and gap <= abs(nearer) * (left + 1):
                return False
    return True


class Engine:
    """The measures of a problem, and what a pass does to their intervals."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.distances = _distances(problem)
        self.measures = [*_variables(problem), *(d.term for d in self.distances)]
        self._known = [sorted(state.known, key=str) for state in problem.passes]
        self._after = [[problem.after(m, i) for m in self.measures] for i in range(len(problem.passes))]

    def start(self) -> list[Interval]:
        """The measures when the loop is entered."""
        return [self.problem.on_entry(m) for m in self.measures]

    def step(self, current: list[Interval]) -> list[Interval] | None:
        """Intervals after any one pass; None when none is possible."""
        results = []
        for index, after in enumerate(self._after):
            known = self._known[index]
            result = _step(self.problem, known, self.measures, current, after, self.distances)
            if result is not None:
                results.append(result)
        return [hull([r[k] for r in results]) for k in range(len(self.measures))] if results else None


def _variables(problem: Problem) -> list[Term]:
    """The variables in the relations, and those that their values after a pass come from."""
    found: dict[Var, None] = {}
    work = [
        of
        for s in problem.passes
        for r in sorted(s.known, key=str)
        for t in (r.a, r.b)
        for of in sorted(atoms(t), key=str)
    ]
    while work and len(found) <= MOST_MEASURES:
        of = work.pop(0)
        if isinstance(of, Var) and of not in found:
            found[of] = None
            for index in range(len(problem.passes)):
                after = problem.after(atom(of), index)
                work.extend(sorted(atoms(after), key=str) if after is not None else ())
    return [variable(of.location) for of in found]


def _distances(problem: Problem) -> list[_Distance]:
    """Differences of variables that change and stand together in a relation."""
    found: dict[tuple[Var, Var], None] = {}
    for state in problem.passes:
        for relation in sorted(state.known, key=str):
            together = atoms(relation.a) | atoms(relation.b)
            changing = [of for of in together if isinstance(of, Var) and not problem.is_invariant(atom(of))]
            changing.sort(key=str)
            found.update({(x, y): None for x in changing for y in changing if x != y})
            parts = subtract(relation.a, relation.b).parts
            if len(parts) == 2 and all(isinstance(of, Var) and factor in (1, WORD - 1) for of, factor in parts):
                x, y = sorted((of for of, _ in parts if isinstance(of, Var)), key=str)
                found.update({(x, y): None, (y, x): None})
    return [_distance(x, y, Fresh(-1 - k)) for k, (x, y) in enumerate(found)] if len(found) <= 6 else []


def _step(
    problem: Problem,
    known: list[Relation],
    measures: list[Term],
    current: list[Interval],
    after: list[Term | None],
    distances: list[_Distance],
) -> list[Interval] | None:
    """The measures after a pass of which relations are known, from `current`; None when it is impossible."""

    knowledge = Knowledge(problem.ranges)
    try:
        for measure, values in zip(measures, current, strict=True):
            knowledge.narrow(measure, values)
        for distance in distances:
            _propagate(knowledge, distance)
        learn(knowledge, [_plain(relation, knowledge) for relation in known], 1)
    except Contradiction:
        return None
    ranges = _with_distances(knowledge, distances)
    try:
        return [Interval(0, WORD - 1) if t is None else _value(t, knowledge, ranges, distances) for t in after]
    except Contradiction:
        return None


def _plain(relation: Relation, knowledge: Knowledge) -> Relation:
    """The relation with arithmetic shifts of what is not negative as logical ones, as values after a pass have them."""
    if not any(isinstance(of, Apply) and of.op is Op.ASR for of in atoms(relation.a) | atoms(relation.b)):
        return relation
    a, b = (simplify(term, knowledge.of_atom) for term in (relation.a, relation.b))
    return Relation(relation.kind, a, b)


def _propagate(knowledge: Knowledge, distance: _Distance) -> None:
    """x = y + (x - y), and y = x - (x - y)."""
    apart = knowledge.of_term(distance.term)
    y = knowledge.of_atom(distance.y)
    knowledge.narrow(atom(distance.x), interval(y.low + apart.low, y.high + apart.high))
    x = knowledge.of_atom(distance.x)
    knowledge.narrow(atom(distance.y), interval(x.low - apart.high, x.high - apart.low))


def _with_distances(knowledge: Knowledge, distances: list[_Distance]) -> Ranges:
    table: dict[Atom, Interval] = {d.name: knowledge.of_term(d.term) for d in distances}

    def ranges(of: Atom) -> Interval:
        known = table.get(of)
        return knowledge.of_atom(of) if known is None else known

    return ranges


def _value(term: Term, knowledge: Knowledge, ranges: Ranges, distances: list[_Distance]) -> Interval:
    """The best interval of the term as it stands and with one variable written as another plus their distance."""
    plain = simplify(term, knowledge.of_atom)
    best = knowledge.of_term(plain)
    renamed = Knowledge(ranges)
    for distance in distances:
        there = distance.rewrite(plain)
        if there is not None and there != plain:
            both = intersection(best, renamed.of_term(pull_halves(there, ranges)))
            if both is None:
                raise Contradiction
            best = both
    return best
