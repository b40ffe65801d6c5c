"""The functions of a binary under fixed control facts: each analysed once from an unknown state, callees first, and
again for the states in which its callers call it where that leaves a loop without a bound.

What is found out about a function depends on nothing but the function and what it reaches, so several entries share
it. To keep it so, the limits on contexts count from the function whose analysis asks for them (a `_Family`), and a
context that such a limit curtailed is kept for that family only.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from mauve.wcet.binary import callgraph
from mauve.wcet.binary.cfg import Control
from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import Cfg, UnresolvedKind
from mauve.wcet.binary.loops import Loop, LoopNest, loop_nest
from mauve.wcet.binary.split import split_irreducible
from mauve.wcet.clock import OutOfTime, check
from mauve.wcet.flow import effects
from mauve.wcet.flow.domain import MASK, Range
from mauve.wcet.flow.effects import ARGUMENTS, UNKNOWN, ProgramCalls, Summary
from mauve.wcet.flow.function import Attempt, FunctionResult, Limits, analyse_function
from mauve.wcet.flow.given import Given, Stated
from mauve.wcet.flow.image import Image
from mauve.wcet.flow.locations import CallEffects, Helper
from mauve.wcet.flow.order import Order, arrange
from mauve.wcet.flow.ranked import ContextRanking, Ranked
from mauve.wcet.flow.record import GaveUp, Record
from mauve.wcet.flow.result import AddressRange, Exclusive, FunctionFlow, LoopBound
from mauve.wcet.flow.state import ABSOLUTE, State, Symbols
from mauve.wcet.flow.values import LoopValues
from mauve.wcet.result import Origin, Problem, ProblemKind
from mauve.wcet.routines import is_closed, not_followed

if TYPE_CHECKING:
    from mauve.wcet.flow.library import KnownFunction, Recognised

MOST_CONTEXTS = 24
"""How many contexts of one function are asked for in the analysis of one other."""
MOST_VAIN = 3
"""After so many contexts of a function that bounded no further loop no more are tried."""
MOST_DEPTH = 12
"""How many calls deep contexts are followed."""
DEEP = 2
"""From so many calls on, a context that leaves open all that was open without it is followed no further."""
MOST_CALLS = 48
"""How many contexts of a function that calls itself, directly or not, are followed into each other."""
POINTERS = (UnresolvedKind.BRANCH, UnresolvedKind.CALL)

Name = tuple[int, tuple[object, ...]]
"""A function by key, and the fingerprint of the state in which it is entered; empty for any state."""


@dataclass(slots=True, eq=False)
class Analysed:
    """One function in one context. `flow` is complete but for `calls`: they are in `called`, by edge, as contexts or as
    the keys of functions that are called in the context for every call. `words` describe the context; `asked` are the
    contexts that its analysis asked for, directly or not. `targets` None: nothing but the graph is known. `places` are
    what accesses touch, kept where the state is unknown."""

    flow: FunctionFlow
    called: Mapping[int, tuple[int | Analysed, ...]]
    name: Name
    unbounded: frozenset[int] = frozenset()
    targets: Mapping[int, Range] | None = None
    notes: tuple[Problem, ...] = ()
    words: str = ""
    summary: Summary = UNKNOWN
    attempt: Attempt | None = None
    places: Mapping[tuple[int, int], effects.Place] = field(default_factory=dict)


@dataclass(slots=True)
class _Family:
    """The contexts asked for in the analysis of one function from an unknown state; `refused` counts those that a limit
    forbade; `lost` are functions on cycles of calls to whose end no contexts lead."""

    asked: dict[int, dict[Name, Analysed | None]] = field(default_factory=dict)
    refused: int = 0
    lost: set[int] = field(default_factory=set)

    def enter(self, context: Analysed) -> None:
        """Note that a context is in use, with all that it asked for itself."""
        mine = self.asked.setdefault(context.name[0], {})
        if mine.get(context.name) is not context:
            mine[context.name] = context
            for called in context.called.values():
                for inner in called:
                    if isinstance(inner, Analysed):
                        self.enter(inner)


class Functions:
    """See the module's description. What raises OutOfTime keeps nothing that is not complete; `curtailed` says that a
    proof asked for by a run ended so: no more are begun."""

    def __init__(self, binary: Binary, image: Image, control: Control, given: Given, limits: Limits) -> None:
        self.binary = binary
        self.graphs = callgraph.Graphs(binary, control)
        self.image, self.given, self.limits = image, given, limits
        self.symbols = Symbols()
        self.cfgs: dict[int, Cfg] = {}
        self.nests: dict[int, LoopNest] = {}
        self.orders: dict[int, Order] = {}
        self.stated: dict[int, Stated] = {}
        self.routines: dict[int, tuple[Recognised, ...]] = {}
        self.ranked = Ranked()
        self.summaries: dict[int, Summary] = {}
        self.quick: dict[int, Analysed] = {}
        self.thorough: dict[int, Analysed] = {}
        self.contexts: dict[Name, Analysed] = {}
        self.sorts: dict[int, KnownFunction | None] = {}
        self.comparing: set[int] = set()
        self.cyclic: set[int] = set()
        self.excluded: dict[int, tuple[Exclusive, ...]] = {}
        self.curtailed = False

    def settle(self, entry: int, deadline: float | None, from_state: bool = False) -> callgraph.Order:
        """Analyse everything that `entry` reaches and that is not known yet; the functions, callees first. Of a callee
        on the same cycle of calls that comes later, nothing but AAPCS is known. Where the entry will be analysed
        `from_state`, it is left out here, unless it is called as well."""
        self.limits = replace(self.limits, deadline=deadline)
        order = callgraph.order(self.graphs_from(entry))
        self.cyclic |= {key for cycle in order.cycles for key in cycle.members}
        for key in order.functions:
            alone = from_state and key == entry and not any(entry in callgraph.callees(self.cfgs[k]) for k in self.cfgs)
            if key not in self.summaries and not alone:
                found = self.quick[key] = self._analyse((key, ()), State(self.symbols), 0, _Family(), False)
                self.summaries[key] = found.summary
        return order

    def graphs_from(self, entry: int) -> dict[int, Cfg]:
        """The graphs of everything that `entry` reaches, by key, irreducible regions split."""
        deadline = self.limits.deadline
        graphs = self.graphs.program(entry, deadline)
        for key, cfg in graphs.items():
            if key not in self.cfgs:
                check(deadline, cfg.address, cfg.name)
                closed = self.is_closed(cfg)
                self.cfgs[key] = without_calls(cfg) if closed else split_irreducible(cfg, deadline=deadline)
        reached, waiting = {entry: self.cfgs[entry]}, [entry]
        while waiting:
            fresh = [key for key in callgraph.callees(self.cfgs[waiting.pop()]) if key not in reached]
            reached |= {key: self.cfgs[key] for key in fresh}
            waiting += fresh
        return reached

    def is_closed(self, cfg: Cfg) -> bool:
        """Whether a function is not followed: one of the library that nobody states facts about."""
        return is_closed(cfg.name) and not self.given.inside_library

    def bound_anyhow(self, key: int, loop: int, deadline: float | None) -> int | None:
        """Executions of a loop's header per entry, whatever the function is called with; None as well where that is not
        found out in time."""
        bound = self.known_bounds(key).get(loop)
        if bound is None and not self.curtailed:
            before = self.limits
            try:
                self.settle(key, deadline)
                default = self.default(key)
                found = None if default is None else default.flow.bounds.get(loop)
                bound = None if found is None else found.bound
            except OutOfTime:
                self.curtailed = True
            self.limits = before
        return bound

    def known_bounds(self, key: int) -> dict[int, int]:
        """Bounds of a function's loops that need no analysis: those of library routines, and what facts state."""
        stated = self.given.bounds(self.cfgs[key], self.nest(key)).bounds
        return {loop: bound.bound for loop, bound in _smallest(stated, self._library(key)).items()}

    def default(self, key: int) -> Analysed | None:
        """The function in the context that covers every call, with all effort."""
        quick = self.quick.get(key)
        if quick is None or not quick.unbounded:
            return quick
        if key not in self.thorough:
            self.thorough[key] = self._analyse((key, ()), State(self.symbols), 0, _Family(), True, quick.attempt)
            quick.attempt = None
        return self.thorough[key]

    def from_state(self, key: int, state: State) -> Analysed:
        """The function entered in a state, with all effort."""
        return self._analyse((key, ()), state, 0, _Family(), True)

    # ------------------------------------------------------------------------------------------------ one function
    def _analyse(
        self,
        name: Name,
        state: State,
        depth: int,
        family: _Family,
        thorough: bool,
        attempt: Attempt | None = None,
    ) -> Analysed:
        cfg, nest = self.cfgs[name[0]], self.nest(name[0])
        if self.is_closed(cfg):
            bare = self._bare(name, cfg, nest)
            return replace(bare, flow=replace(bare.flow, problems=(not_followed(cfg.name, cfg.address),)))
        sorts = self._sorts(name[0])
        if sorts is not None:
            return self._sorted(sorts, name, state)
        bare = self._bare(name, cfg, nest)
        if nest.irreducible or not cfg.blocks:
            return bare
        try:
            return self._full(name, cfg, nest, state, depth, family, thorough, attempt)
        except GaveUp:
            message = f"the analysis of {cfg.name} takes more steps than allowed"
            problem = Problem(ProblemKind.LIMIT, message, cfg.address, cfg.name)
            return replace(bare, flow=replace(bare.flow, problems=(problem,)))

    def _sorts(self, key: int) -> KnownFunction | None:
        """What the table says of a function that sorts."""
        if key not in self.sorts:
            from mauve.wcet.flow.sorting import sorting

            self.sorts[key] = sorting(self.cfgs[key])
        return self.sorts[key]

    def _sorted(self, known: KnownFunction, name: Name, state: State) -> Analysed:
        """A sorting routine entered in a state."""
        from mauve.wcet.flow.sorting import Arguments, comparisons, sorted_flow

        key = name[0]
        cfg, nest = self.cfgs[key], self.nest(key)
        entered = self.given.assumed.entered(key, state)
        if entered is None:
            bare = self._bare(name, cfg, nest)
            return replace(bare, flow=replace(bare.flow, problems=(_contradicted(cfg, None),)))
        arguments = Arguments(*(entered.range_of(entered.regs[register]) for register in (1, 2, 3)))
        compares = comparisons(arguments, lambda at: self.binary.read_code(at & ~1, 2) is not None)
        if any(other in self.comparing for other in compares):
            compares = ()
        self.comparing |= set(compares)
        try:
            for other in compares:
                self.settle(other, self.limits.deadline)
                self.default(other)
        finally:
            self.comparing -= set(compares)
        found = sorted_flow(known, cfg, nest, arguments, compares)
        self.stated[key] = self.given.bounds(cfg, nest)
        stated = self.stated[key].bounds
        flow = replace(found.flow, bounds=_smallest(stated, dict(found.flow.bounds))) if stated else found.flow
        return Analysed(flow, found.called, name, targets={})

    def nest(self, key: int) -> LoopNest:
        """The loops of a function."""
        if key not in self.nests:
            self.nests[key] = loop_nest(self.cfgs[key])
        return self.nests[key]

    def _bare(self, name: Name, cfg: Cfg, nest: LoopNest) -> Analysed:
        """A function of which only the graph is known."""
        called = {index: edge.callees for index, edge in enumerate(cfg.edges) if edge.callees}
        return Analysed(FunctionFlow(cfg, nest, {}, frozenset(), {}, {}), called, name)

    def _full(
        self,
        name: Name,
        cfg: Cfg,
        nest: LoopNest,
        state: State,
        depth: int,
        family: _Family,
        thorough: bool,
        attempt: Attempt | None,
    ) -> Analysed:
        key = cfg.key
        if key not in self.orders:
            self.orders[key] = arrange(cfg, nest)
            self.stated[key] = self.given.bounds(cfg, nest)
        narrowed = self.given.assumed.entered(key, state)
        if narrowed is None:
            bare = self._bare(name, cfg, nest)
            return replace(bare, flow=replace(bare.flow, problems=(_contradicted(cfg, None),)))
        assumed = self.given.assumed.spoken_of
        wanted = frozenset(k for k in callgraph.callees(cfg) if k in assumed or self._incomplete(k))
        helpers = {k: helper for k in callgraph.callees(cfg) if (helper := self.helper(k)) is not None}
        calls = ProgramCalls(self.summaries, wanted, helpers)

        rankings: dict[int, ContextRanking] = {}

        def ranking(loop: Loop, record: Record) -> tuple[int, str] | None:
            values = LoopValues(record, loop.id, self.image)
            if id(record) not in rankings:
                what_calls_do = self._effects(cfg, helpers)
                rankings[id(record)] = ContextRanking(self.ranked, cfg, nest, values, what_calls_do)
            return rankings[id(record)].bound(loop, values)

        stated = _smallest(self.stated[key].bounds, self._library(key, narrowed))
        order = self.orders[key]
        result = analyse_function(order, narrowed, self.image, calls, stated, ranking, self.limits, thorough, attempt)
        derived = {loop: bound.bound for loop, bound in result.bounds.items() if bound.origin is not Origin.ANNOTATION}
        called = self._contexts(cfg, result, depth, family, narrowed)
        flow = FunctionFlow(
            cfg,
            nest,
            result.bounds,
            result.infeasible,
            {
                at: AddressRange(low, high)
                for at, (region, low, high) in result.accesses.items()
                if region == ABSOLUTE and high <= MASK
            },
            {},
            (
                *(self._unbounded(cfg, nest, loop) for loop in sorted(result.unbounded)),
                *self._broken_facts(cfg, result),
            ),
            result.depth,
        )
        return Analysed(
            flow,
            called,
            name,
            result.unbounded,
            result.targets,
            self.given.compare(cfg, nest, derived),
            summary=effects.summarise(result.record),
            attempt=result.attempt,
            places={} if name[1] else result.accesses,
        )

    def _broken_facts(self, cfg: Cfg, result: FunctionResult) -> Iterator[Problem]:
        """The calls whose arguments no fact about the callee allows."""
        for index, edge in enumerate(cfg.edges):
            for key in edge.callees:
                state = result.record.calls.get((index, key))
                if state is not None and self.given.assumed.entered(key, state) is None:
                    yield _contradicted(self.cfgs[key], cfg.blocks[edge.source].instructions[-1].address)

    def helper(self, key: int) -> Helper | None:
        """What a run-time helper computes, by its name."""
        symbol = self.binary.symbol_at(key)
        return None if symbol is None else effects.helper_named({symbol.name, self.cfgs[key].name})

    def exclusive(self, key: int) -> tuple[Exclusive, ...]:
        """The edges of a function that exclude each other, whatever it is called with."""
        if key not in self.excluded:
            from mauve.wcet.flow.exclusive.find import exclusive
            from mauve.wcet.flow.exclusive.memory import FunctionMemory, Names, written

            cfg, known = self.cfgs[key], self.thorough.get(key) or self.quick.get(key)
            memory = FunctionMemory(self.image, {} if known is None else known.places)
            never = frozenset[int]() if known is None else known.flow.infeasible
            changes = self._effects(cfg, {}), written(cfg.edges, self.summaries)
            self.excluded[key] = exclusive(cfg, self.nest(key), memory, *changes, never, Names(self.binary))
        return self.excluded[key]

    def _effects(self, cfg: Cfg, helpers: Mapping[int, Helper]) -> dict[int, CallEffects]:
        """What the calls on each edge change."""
        return {
            index: effects.call_effects([(self.summaries.get(k, UNKNOWN), helpers.get(k)) for k in edge.callees])
            for index, edge in enumerate(cfg.edges)
            if edge.callees
        }

    def _unbounded(self, cfg: Cfg, nest: LoopNest, loop: int) -> Problem:
        block = cfg.blocks[nest.loops[loop].header]
        message = f"no bound was found for the loop at {block.address:#x} in {cfg.name}"
        return Problem(ProblemKind.LOOP, message, block.address, cfg.name)

    def _library(self, key: int, entered: State | None = None) -> dict[int, LoopBound]:
        """Bounds of the loops of a known routine, entered in a state if that is known."""
        nest = self.nest(key)
        if not nest.loops:
            return {}
        from mauve.wcet.flow.library import STRING, library_bound, recognise
        from mauve.wcet.flow.strings import longest

        if key not in self.routines:
            self.routines[key] = recognise(self.cfgs[key])
        known = self.routines[key]
        if not known:
            return {}

        def greatest(register: int) -> int:
            if entered is None:
                return MASK
            if register >= STRING:
                length = longest(entered, entered.regs[register - STRING], self.image)
                return MASK if length is None else length
            return entered.range_of(entered.regs[register]).unsigned_bounds()[1]

        found = {loop.id: library_bound(self.cfgs[key], loop, greatest, known) for loop in nest.loops}
        return {
            loop: LoopBound(bound.bound, Origin.LIBRARY, bound.method, bound.total)
            for loop, bound in found.items()
            if bound is not None
        }

    # ------------------------------------------------------------------------------------------------ contexts
    def _incomplete(self, key: int) -> bool:
        """Whether the function, or something that it calls, might gain from knowing its caller."""
        seen, waiting = {key}, [key]
        while waiting:
            quick = self.quick.get(waiting.pop())
            if quick is None or quick.targets is None:
                continue
            if quick.unbounded or quick.name[0] in self.cyclic:
                return True
            if any(hole.kind in POINTERS for hole in quick.flow.cfg.unresolved):
                return True
            for callee in (callee for callees in quick.called.values() for callee in callees):
                if isinstance(callee, Analysed):
                    return True
                if callee not in seen:
                    seen.add(callee)
                    waiting.append(callee)
        return False

    def _contexts(
        self, cfg: Cfg, result: FunctionResult, depth: int, family: _Family, entered: State
    ) -> dict[int, tuple[int | Analysed, ...]]:
        found, caller = {}, (cfg.key, entered)
        quick = self.quick.get(cfg.key)
        if depth >= DEEP and quick is not None and quick.unbounded and result.unbounded >= quick.unbounded:
            # No bound comes of this: contexts inside it would be asked for again for every function on the way here.
            return {index: edge.callees for index, edge in enumerate(cfg.edges) if edge.callees}
        for index, edge in enumerate(cfg.edges):
            if edge.callees:
                states = ((key, result.record.calls.get((index, key))) for key in edge.callees)
                found[index] = tuple(self._context(key, state, depth, family, caller) for key, state in states)
        return found

    def _context(
        self, key: int, state: State | None, depth: int, family: _Family, caller: tuple[int, State]
    ) -> int | Analysed:
        """The context of a callee for an entry state, or its key: the context for all calls, unless that is
        incomplete."""
        if state is None:
            return key
        name = (key, effects.fingerprint(state))
        mine = family.asked.setdefault(key, {})
        known = mine.get(name)
        if known is None and self._sorts(key) is None and not self._promising(key, state, depth, family, caller):
            return key
        if known is None:
            known = self.contexts.get(name)
        if known is None:
            refused = family.refused
            mine[name] = None
            known = self._analyse(name, state, depth + 1, family, True)
            known.words = effects.describe(state)
            if family.refused == refused:
                self.contexts[name] = known
            if key in family.lost:
                return key
        family.enter(known)
        return known

    def _advances(self, key: int, state: State, caller: tuple[int, State]) -> bool:
        """Whether a call on a cycle of calls, with known arguments, comes nearer to its end as far as one can see: some
        argument is another number than the caller's was."""
        numbers = [(state.constant_of(state.regs[r]), caller[1].constant_of(caller[1].regs[r])) for r in ARGUMENTS]
        if caller[0] not in self.cyclic:
            return any(mine is not None for mine, _ in numbers)
        return any(mine is not None and other is not None and mine != other for mine, other in numbers)

    def _promising(self, key: int, state: State, depth: int, family: _Family, caller: tuple[int, State]) -> bool:
        """Whether one more context of a function is worth its time."""
        if key in family.lost:
            return False
        if not effects.describe(state) and not any(state.memory.values()):
            return False
        mine = family.asked.get(key, {})
        if key in self.cyclic:
            if depth < MOST_CALLS and len(mine) < MOST_CALLS and self._advances(key, state, caller):
                return True
            family.refused += 1
            family.lost.add(key)
            return False
        quick = self.quick[key]
        vain = len(mine) >= MOST_VAIN and all(self._no_better(inside, quick) for inside in mine.values())
        if depth < MOST_DEPTH and len(mine) < MOST_CONTEXTS and not vain:
            return True
        family.refused += 1
        return False

    @staticmethod
    def _no_better(inside: Analysed | None, default: Analysed) -> bool:
        """Whether a context left open what was open without it."""
        return inside is None or inside.targets is None or inside.unbounded >= default.unbounded


def without_calls(cfg: Cfg) -> Cfg:
    """The graph with nothing said of whom it calls."""
    return replace(cfg, edges=tuple(replace(edge, callees=()) for edge in cfg.edges), unresolved=())


def _contradicted(cfg: Cfg, call: int | None) -> Problem:
    """No call of a function, or not this one, keeps what facts assume of its arguments."""
    message = f"the arguments of `{cfg.name}` are not as the facts assume"
    return Problem(ProblemKind.FACT_CONTRADICTED, message, cfg.address if call is None else call, cfg.name)


def _smallest(first: Mapping[int, LoopBound], second: dict[int, LoopBound]) -> dict[int, LoopBound]:
    result = dict(first)
    for loop, bound in second.items():
        if loop not in result or bound.bound < result[loop].bound:
            result[loop] = bound
    return result
