"""Ranking arguments of the loops of a function, remembered from one context to the next.

An argument asks a few questions about values and accesses (`EntryValues`). In another context that gives the same
answers it comes to the same end.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import Loop, LoopNest
from mauve.wcet.clock import Deadline
from mauve.wcet.flow.locations import CallEffects, Cell, EntryValues, Interval, Location, Region, Sum

Answer = Interval | Region | int | None
NEVER_REPEAT = "states that never repeat"
RETURNING = ", in executions that return"
"""What the methods say of bounds that hold as an execution that goes on for ever has no time."""

Stores = tuple[tuple[int, int], ...]
Question = tuple[str, Location | tuple[int, int] | Cell | tuple[Sum, int, Stores]]

MOST = 8
"""Contexts that are remembered of one loop."""


class Asked:
    """Values that note what they were asked."""

    def __init__(self, values: EntryValues) -> None:
        self._values = values
        self.answers: dict[Question, Answer] = {}

    def answer(self, question: Question) -> Answer:
        """The answer to a question, noted."""
        if question not in self.answers:
            self.answers[question] = _ask(self._values, question)
        return self.answers[question]

    def on_entry(self, location: Location) -> Interval:
        """See EntryValues."""
        found = self.answer(("on entry", location))
        assert isinstance(found, Interval)
        return found

    def invariant(self, location: Location) -> Interval:
        """See EntryValues."""
        found = self.answer(("invariant", location))
        assert isinstance(found, Interval)
        return found

    def sp_offset(self, block: int) -> int | None:
        """See EntryValues."""
        found = self.answer(("sp", block))
        assert found is None or isinstance(found, int)
        return found

    def access(self, address: int, index: int) -> Region | None:
        """See EntryValues."""
        found = self.answer(("access", (address, index)))
        assert found is None or isinstance(found, Region)
        return found

    def tracked(self, cell: Cell) -> bool:
        """See EntryValues."""
        return bool(self.answer(("tracked", cell)))

    def constant(self, cell: Cell) -> int | None:
        """See EntryValues."""
        found = self.answer(("constant", cell))
        assert found is None or isinstance(found, int)
        return found


    def string(self, parts: Sum, offset: int, stores: Stores) -> int | None:
        """See EntryValues."""
        found = self.answer(("string", (parts, offset, stores)))
        assert found is None or isinstance(found, int)
        return found


def _ask(values: EntryValues, question: Question) -> Answer:
    match question:
        case ("on entry", (int() | Cell()) as location):
            return values.on_entry(location)
        case ("invariant", (int() | Cell()) as location):
            return values.invariant(location)
        case ("sp", int() as block):
            return values.sp_offset(block)
        case ("access", (int() as address, int() as index)):
            return values.access(address, index)
        case ("tracked", Cell() as cell):
            return values.tracked(cell)
        case ("constant", Cell() as cell):
            return values.constant(cell)
        case ("string", (tuple() as parts, int() as offset, tuple() as stores)):
            return values.string(parts, offset, stores)
        case _:
            raise AssertionError(question)


@dataclass(frozen=True, slots=True)
class _Known:
    """A result, and the answers that led to it: of the function's values, and of those at the loop's header."""

    common: Mapping[Question, Answer]
    own: Mapping[Question, Answer]
    effects: Mapping[int, CallEffects]
    result: tuple[int, str] | None


@dataclass(slots=True)
class Ranked:
    """The ranking results of one binary so far, by function and loop."""

    known: dict[tuple[int, int], list[_Known]] = field(default_factory=dict)


def looks_ahead(method: str) -> bool:
    """Whether a bound rests on what comes after the loop has gone on for too long: that the execution returns."""
    return method == NEVER_REPEAT or method.endswith(RETURNING)


class ContextRanking:
    """Ranking arguments for the loops of one function in one context; `common` gives the values of the function."""

    def __init__(
        self,
        ranked: Ranked,
        cfg: Cfg,
        nest: LoopNest,
        common: EntryValues,
        effects: Mapping[int, CallEffects],
        deadline: Deadline = None,
    ) -> None:
        from mauve.wcet.flow.ranking import Ranking

        self._ranked, self._key, self._effects = ranked, cfg.key, effects
        self._common = Asked(common)
        self._ranking = Ranking(cfg, nest, self._common, effects, deadline)

    def bound(self, loop: Loop, values: EntryValues) -> tuple[int, str] | None:
        """The best bound of a loop and the argument for it, or None; `values` are those at its header."""
        known = self._ranked.known.setdefault((self._key, loop.id), [])
        own = Asked(values)
        for one in known:
            if one.effects == self._effects and _agree(one.common, self._common) and _agree(one.own, own):
                return one.result
        own = Asked(values)
        found = self._ranking.bound(loop, own)
        result = None if found is None else (found.bound, found.method)
        if len(known) < MOST:
            known.append(_Known(dict(self._common.answers), own.answers, self._effects, result))
        return result


def _agree(answers: Mapping[Question, Answer], asked: Asked) -> bool:
    return all(asked.answer(question) == answer for question, answer in answers.items())
