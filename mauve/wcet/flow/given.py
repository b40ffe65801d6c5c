"""What people state (flow facts) put to use: control facts for the graphs, loop facts for the bounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from mauve.wcet.binary.cfg import Control
from mauve.wcet.binary.elf import Binary, ElfProblem
from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.lines import LineTable, load_lines
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.flow.assumed import resolve
from mauve.wcet.flow.facts import (
    AtAddress,
    AtLine,
    AtSymbol,
    ControlFact,
    ControlKind,
    Fact,
    LoopFact,
    Place,
    RecursionFact,
)
from mauve.wcet.flow.matching import Matches, describe, match_facts, unmatched
from mauve.wcet.flow.result import LoopBound
from mauve.wcet.result import Origin, Problem, ProblemKind
from mauve.wcet.routines import is_closed


@dataclass(frozen=True, slots=True)
class Stated:
    """What facts say of the loops of one function: bounds by loop, which facts matched, contradictions."""

    bounds: Mapping[int, LoopBound] = field(default_factory=dict)
    matched: frozenset[int] = frozenset()
    problems: tuple[Problem, ...] = ()


class Given:
    """The facts of one analysis."""

    def __init__(self, binary: Binary, facts: Sequence[Fact], lines: LineTable | None = None) -> None:
        self.binary, self.facts = binary, tuple(facts)
        by_line = any(isinstance(place, AtLine) for fact in facts for place in (fact.place, *_targets(fact)))
        self.lines = (lines or load_lines(binary)) if by_line else LineTable()
        self.loops = any(isinstance(fact, LoopFact) for fact in self.facts)
        self.assumed = resolve(binary, self.facts)
        self.inside_library = any(self._is_inside_library(fact) for fact in self.facts)
        self.depths, self._nowhere = self._recursions()

    def _is_inside_library(self, fact: Fact) -> bool:
        """Whether a fact about loops or branches lies in a function whose name is reserved for the library."""
        if not isinstance(fact, LoopFact | ControlFact | RecursionFact):
            return False
        found = (self.binary.function_at(address & ~1) for address in self._addresses(fact.place))
        return any(symbol is not None and symbol.name.startswith("_") for symbol in found)

    def control(self) -> Control:
        """The control facts by address. A function that returns after all is what graphs assume anyway."""
        targets: dict[int, tuple[int, ...]] = {}
        no_call: set[int] = set()
        no_return: set[int] = set()
        for fact in self.facts:
            if not isinstance(fact, ControlFact):
                continue
            for address in self._addresses(fact.place):
                match fact.kind:
                    case ControlKind.TARGETS:
                        targets[address & ~1] = tuple(self._key(a) for t in fact.targets for a in self._addresses(t))
                    case ControlKind.NO_CALL:
                        no_call.add(address & ~1)
                    case ControlKind.NO_RETURN:
                        no_return.add(self._key(address))
                    case ControlKind.RETURN:
                        pass
        closed = () if self.inside_library else (s.key for s in self.binary.functions if is_closed(s.name))
        return Control(
            targets=targets,
            no_call=frozenset(no_call),
            no_return=frozenset(no_return),
            closed=frozenset(closed),
        )

    def bounds(self, cfg: Cfg, nest: LoopNest) -> Stated:
        """What facts state for the loops of a function."""
        if not self.loops or not nest.loops:
            return Stated()
        found = self._match(cfg, nest, None)
        bounds = {
            loop: LoopBound(fact.bound, Origin.ANNOTATION, "flow fact", fact.total)
            for loop, fact in found.bounds.items()
            if fact.bound is not None
        }
        return Stated(bounds, frozenset(found.matched), tuple(found.problems))

    def compare(self, cfg: Cfg, nest: LoopNest, derived: dict[int, int]) -> tuple[Problem, ...]:
        """Remarks on facts that allow more than the analysis found."""
        return tuple(self._match(cfg, nest, derived).notes) if self.loops and nest.loops else ()

    def unused(self, matched: set[int]) -> tuple[Problem, ...]:
        """Loop facts other than those that matched a loop, and what facts say of what is not in the binary."""
        return (*unmatched(self.facts, matched), *self.assumed.problems, *self._nowhere)

    def _recursions(self) -> tuple[dict[int, int], tuple[Problem, ...]]:
        """The activations under way at most, by function; facts about functions that do not exist."""
        depths: dict[int, int] = {}
        nowhere: list[Problem] = []
        for fact in self.facts:
            if not isinstance(fact, RecursionFact):
                continue
            keys = [self._key(address) for address in self._addresses(fact.place)]
            if not keys:
                message = f"there is no function at {describe(fact.place)}"
                nowhere.append(Problem(ProblemKind.FACT_NOWHERE, message, written=fact.written))
            for key in keys:
                depths[key] = min(fact.maximum, depths.get(key, fact.maximum))
        return depths, tuple(nowhere)

    def _match(self, cfg: Cfg, nest: LoopNest, derived: dict[int, int] | None) -> Matches:
        return match_facts(self.facts, cfg, nest, self.lines.location, self._symbol, derived)

    def _symbol(self, name: str) -> int | None:
        found = self.binary.function(name)
        return None if isinstance(found, ElfProblem) else found.address

    def _addresses(self, place: Place) -> tuple[int, ...]:
        match place:
            case AtAddress(address):
                return (address,)
            case AtSymbol(symbol, offset):
                found = self.binary.function(symbol)
                return () if isinstance(found, ElfProblem) else (found.key + offset,)
            case AtLine(file, line):
                return self.lines.addresses(file, line)

    def _key(self, address: int) -> int:
        symbol = self.binary.symbol_at(address)
        return address if symbol is None else symbol.key


def _targets(fact: Fact) -> tuple[Place, ...]:
    return fact.targets if isinstance(fact, ControlFact) else ()
