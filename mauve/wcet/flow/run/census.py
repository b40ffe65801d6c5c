"""Bounds of loops whose ways through the body move different words: each way is followed apart, once.

What came of all ways together tells of no word that each of them moves. So one more iteration is made from the path
that covers all, on which paths do not meet that parted in the loop itself. A loop ends where a word, a difference or a
sum of two moves one way on some of the ways and on none the other way, and the same is so of the other ways: a
lexicographic ranking (Alias, Darte, Feautrier, Gonnord, "Multi-dimensional rankings, program termination, and
complexity bounds of flowchart programs", SAS 2010).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations

from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import Range
from mauve.wcet.flow.run.compared import Pairs
from mauve.wcet.flow.run.compile import RELATED
from mauve.wcet.flow.run.memory import Memory
from mauve.wcet.flow.run.paths import Path, word_at
from mauve.wcet.flow.run.related import difference
from mauve.wcet.flow.run.repeats import Kept
from mauve.wcet.flow.run.words import Ranged

MOST_TRAILS, MOST_MEASURES, DEPTH = 48, 24, 3
"""Ways through a loop and words that are looked at; how many words one after the other."""
MOST_SPAN, MOST_TIMES = 1 << 16, 1 << 20
"""More values than that tell of the width of words, not of a loop."""

Move = tuple[int, int] | None
"""How far a way moves a word, at least and at most; None: not known."""


@dataclass(frozen=True, slots=True)
class Measure:
    """A word that may have values of a `span`, and how far each way moves it."""

    span: int
    moves: tuple[Move, ...]

    def turned(self) -> Measure:
        """The same with the other sign."""
        return Measure(self.span, tuple(None if move is None else (-move[1], -move[0]) for move in self.moves))


@dataclass(slots=True)
class Census:
    """The ways of a loop that is followed once more from a `kept` path: how far each of them moved the measured words.
    `spans` are those of their values, `blocks` the loop's, `before` the executions of its header until the kept path;
    `limit` is a bound that is known in any case."""

    loop: int
    blocks: frozenset[int]
    kept: Kept
    pairs: Pairs
    before: int
    spans: list[int | None]
    limit: int | None = None
    ways: list[list[Move]] = field(default_factory=list)
    trails: int = 0

    def next_trail(self) -> int:
        """A number for one more way."""
        self.trails += 1
        return self.trails

    def note(self, memory: Memory, path: Path) -> None:
        """A way that came back to the header."""
        self.ways.append(_moves(memory, self.kept, path, self.pairs))

    def limit_now(self) -> int | None:
        """The bound of the loop; None where it has none."""
        more = self.more()
        known = [one for one in (self.limit, None if more is None else self.before + more) if one is not None]
        return min(known, default=None)

    def more(self) -> int | None:
        """How many more times the header is executed after the kept path; None where no words tell."""
        if self.trails > MOST_TRAILS or not self.ways:
            return None
        measures = [
            Measure(span, moves)
            for span, moves in zip(self.spans, zip(*self.ways, strict=True), strict=True)
            if span is not None and any(move not in (None, (0, 0)) for move in moves)
        ]
        most = rank(tuple(dict.fromkeys(measures))[:MOST_MEASURES], frozenset(range(len(self.ways))))
        return most if most is not None and most <= MOST_TIMES else None


def census(memory: Memory, kept: Kept, loop: int, blocks: frozenset[int], pairs: Pairs, limit: int | None) -> Census:
    """A census of a loop that was found to do nothing new after a kept path."""
    spans = [_span(start.range) for _, start in kept.starts]
    for a, b in pairs:
        first, second = word_at(memory, a, kept.path), word_at(memory, b, kept.path)
        both = isinstance(first, Ranged) and isinstance(second, Ranged)
        values = difference(first, second, kept.path.registers[RELATED]) if both else None  # type: ignore[arg-type]
        spans.append(None if values is None else _span(values))
    return Census(loop, blocks, kept, pairs, kept.path.counters.current[loop], spans, limit)


def _span(values: Range) -> int | None:
    return values.span if values.span <= MOST_SPAN else None


def _moves(memory: Memory, kept: Kept, path: Path, pairs: Pairs) -> list[Move]:
    """How far the words that began an iteration were moved in it, and the differences of pairs."""
    related = path.registers[RELATED]
    steps: dict[object, Range | None] = {}
    for place, start in kept.starts:
        word = word_at(memory, place, path)
        steps[place] = None if word is None else difference(word, start, related)
    moves = [_move(steps[place]) for place, _ in kept.starts]
    for a, b in pairs:
        one, other = steps.get(a), steps.get(b)
        moves.append(None if one is None or other is None else _move(domain.sub(one, other)))
    return moves


def _move(step: Range | None) -> Move:
    return None if step is None or step.span > MOST_SPAN else step.signed_bounds()


def rank(measures: Sequence[Measure], ways: frozenset[int], depth: int = DEPTH) -> int | None:
    """How many iterations of these ways there can be, one after the other in any order, by the measured words; None
    where they do not tell."""
    best: int | None = None
    for measure in _candidates(measures, ways):
        falling = {way for way in ways if measure.moves[way][1] < 0}  # type: ignore[index]
        most = measure.span // min(-measure.moves[way][1] for way in falling)  # type: ignore[index]
        rest = ways - falling
        inner = 0 if not rest else rank(measures, rest, depth - 1) if depth > 1 else None
        if inner is not None:
            bound = most + (most + 1) * inner
            best = bound if best is None else min(best, bound)
    return best


def _candidates(measures: Sequence[Measure], ways: frozenset[int]) -> list[Measure]:
    """Words, and where none does sums of two, that some of the ways let fall and none lets grow."""
    single = [one for measure in measures for one in (measure, measure.turned()) if _falls(one, ways)]
    if single:
        return single
    signed = [one for measure in measures for one in (measure, measure.turned())]
    sums = (_sum(a, b) for a, b in combinations(signed, 2))
    return [one for one in sums if _falls(one, ways)]


def _sum(a: Measure, b: Measure) -> Measure:
    pairs = zip(a.moves, b.moves, strict=True)
    moves = (None if x is None or y is None else (x[0] + y[0], x[1] + y[1]) for x, y in pairs)
    return Measure(a.span + b.span, tuple(moves))


def _falls(measure: Measure, ways: frozenset[int]) -> bool:
    moves = [measure.moves[way] for way in ways]
    return all(move is not None and move[1] <= 0 for move in moves) and any(move[1] < 0 for move in moves if move)


__all__ = ["Census", "Measure", "census", "rank"]
