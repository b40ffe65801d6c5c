"""The functions of a binary under fixed control facts: each analysed once from an unknown state, callees first, and
again for the states in which its callers call it (`contexts`) where that leaves a loop without a bound.

What is found out about a function depends on nothing but the function and what it reaches, so several entries share
it. To keep it so, the limits on contexts count from the function whose analysis asks for them (a `Family`), and a
context that such a limit curtailed is kept for that family only.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from mauve.wcet.binary import callgraph
from mauve.wcet.binary.cfg import Control
from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import Cfg, UnresolvedKind
from mauve.wcet.binary.loops import Loop, LoopNest, loop_nest
from mauve.wcet.binary.split import split_irreducible
from mauve.wcet.clock import OutOfTime, check, is_over
from mauve.wcet.flow import effects
from mauve.wcet.flow.analysed import Analysed, Name
from mauve.wcet.flow.contexts import Contexts, Family
from mauve.wcet.flow.domain import MASK, Range
from mauve.wcet.flow.effects import UNKNOWN, ProgramCalls, Summary
from mauve.wcet.flow.function import Attempt, FunctionResult, Limits, analyse_function
from mauve.wcet.flow.given import Given, Stated
from mauve.wcet.flow.image import Image
from mauve.wcet.flow.locations import CallEffects, Helper
from mauve.wcet.flow.order import Order, arrange
from mauve.wcet.flow.ranked import ContextRanking, Ranked
from mauve.wcet.flow.record import GaveUp, Record
from mauve.wcet.flow.result import AddressRange, Exclusive, FunctionFlow, LoopBound
from mauve.wcet.flow.state import ABSOLUTE, State, Symbols
from mauve.wcet.flow.values import Hoped, LoopValues, writes_anywhere
from mauve.wcet.result import Origin, Problem, ProblemKind
from mauve.wcet.routines import is_closed, not_followed, searches_heap

if TYPE_CHECKING:
    from mauve.wcet.flow.library import KnownFunction, Recognised

POINTERS = (UnresolvedKind.BRANCH, UnresolvedKind.CALL)


class Functions:
    """See the module's description. What raises OutOfTime keeps nothing that is not complete. Within `leaving` (a point
    in time) nothing is raised when the deadline is over before that: each function keeps what was found until then, and
    those that come later have the bounds that need no values. `curtailed` says where time has first ended something."""

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
        self.defaults: dict[int, Analysed] = {}
        self.contexts = Contexts(self)
        self._sorting: dict[int, KnownFunction | None] = {}
        self.comparing: set[int] = set()
        self.cyclic: set[int] = set()
        self.excluded: dict[int, tuple[Exclusive, ...]] = {}
        self.curtailed: OutOfTime | None = None
        self.leaving: float | None = None
        self._incomplete: dict[int, bool] = {}
        self._angles: dict[int, bool] = {}

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
                found = self.quick[key] = self.analyse((key, ()), State(self.symbols), False)
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
        if bound is None and self.curtailed is None:
            before, self.leaving = self.limits, None
            try:
                self.settle(key, deadline)
                default = self._best(key)
                found = None if default is None else default.flow.bounds.get(loop)
                bound = None if found is None else found.bound
            except OutOfTime as reason:
                self.curtailed = reason
            self.limits = before
        return bound

    def known_bounds(self, key: int) -> dict[int, int]:
        """Bounds of a function's loops that need no analysis: those of library routines, and what facts state."""
        stated = self.given.bounds(self.cfgs[key], self.nest(key)).bounds
        return {loop: bound.bound for loop, bound in _smallest(stated, self._library(key)).items()}

    def default(self, key: int) -> Analysed | None:
        """The function in the context that covers every call, with all effort."""
        best = self._best(key)
        if key not in self.defaults and best is not None:
            found = replace(best)
            self.contexts.follow(found, 0, Family())
            self.defaults[key] = found
            best.sites, best.entered = {}, None
        return self.defaults.get(key)

    def _best(self, key: int) -> Analysed | None:
        """The same without the contexts of what it calls."""
        quick = self.quick.get(key)
        if quick is None or not quick.unbounded:
            return quick
        if key not in self.thorough:
            self.thorough[key] = self.analyse((key, ()), State(self.symbols), True, quick.attempt)
            quick.attempt, quick.sites, quick.entered = None, {}, None
        return self.thorough[key]

    def from_state(self, key: int, state: State) -> Analysed:
        """The function entered in a state, with all effort."""
        found = self.analyse((key, ()), state, True)
        self.contexts.follow(found, 0, Family())
        return found

    # ------------------------------------------------------------------------------------------------ one function
    def analyse(self, name: Name, state: State, thorough: bool, attempt: Attempt | None = None) -> Analysed:
        """A function entered in a state, the contexts of what it calls not followed."""
        cfg, nest = self.cfgs[name[0]], self.nest(name[0])
        if self.is_closed(cfg) or (searches_heap(cfg.name) and not self.given.inside_library):
            bare = self._bare(name, cfg, nest)
            return replace(bare, flow=replace(bare.flow, problems=(not_followed(cfg.name, cfg.address),)))
        sorts = self.sorts(name[0])
        if sorts is not None:
            return self._sorted(sorts, name, state)
        bare = self._bare(name, cfg, nest)
        if nest.irreducible or not cfg.blocks:
            return bare
        try:
            return self._full(name, cfg, nest, state, thorough, attempt)
        except GaveUp:
            message = f"the analysis of {cfg.name} takes more steps than allowed"
            problem = Problem(ProblemKind.LIMIT, message, cfg.address, cfg.name)
            found = self._without_values(bare)
            return replace(found, flow=replace(found.flow, problems=(problem, *found.flow.problems)))
        except OutOfTime as reason:
            if self.leaving is None:
                raise
            self.curtailed = self.curtailed or reason
            return self._without_values(bare)

    def is_leaving(self) -> bool:
        """Whether the time for everything but bringing what was found to an end is over."""
        return self.leaving is not None and is_over(self.limits.deadline)

    def _without_values(self, bare: Analysed) -> Analysed:
        """A function with the bounds that need no values: those that are known, and of counters between constants."""
        from mauve.wcet.flow.ranking import Ranking

        cfg, nest = bare.flow.cfg, bare.flow.nest
        stated = self.stated[cfg.key] = self.given.bounds(cfg, nest)
        bounds = _smallest(stated.bounds, self._library(cfg.key))
        ranking = Ranking(cfg, nest, None, self._effects(cfg, {}), self.leaving or self.limits.deadline)
        try:
            for loop in nest.loops:
                found = None if loop.id in bounds else ranking.bound(loop)
                if found is not None:
                    bounds[loop.id] = LoopBound(found.bound, Origin.ANALYSIS, found.method)
        except OutOfTime as reason:
            if self.leaving is None:
                raise
            self.curtailed = self.curtailed or reason
        left = (self._unbounded(cfg, nest, loop.id) for loop in nest.loops if loop.id not in bounds)
        return replace(bare, flow=replace(bare.flow, bounds=bounds, problems=tuple(left)))

    def sorts(self, key: int) -> KnownFunction | None:
        """What the table says of a function that sorts."""
        if key not in self._sorting:
            from mauve.wcet.flow.sorting import sorting

            self._sorting[key] = sorting(self.cfgs[key])
        return self._sorting[key]

    def _sorted(self, known: KnownFunction, name: Name, state: State) -> Analysed:
        """A sorting routine entered in a state."""
        from mauve.wcet.flow.sorting import Arguments, comparisons, sorted_flow

        key = name[0]
        cfg, nest = self.cfgs[key], self.nest(key)
        entered = self.given.assumed.entered(key, state)
        if entered is None:
            bare = self._bare(name, cfg, nest)
            return replace(bare, flow=replace(bare.flow, problems=(_contradicted(cfg, None),)))
        arguments = Arguments(*(entered.range_of(entered.regs[register]) for register in (1, 2, 3, 0)))
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
        callees = callgraph.callees(cfg)
        wanted = frozenset(k for k in callees if k in assumed or self.incomplete(k) or self.takes_angle(k))
        helpers = {k: helper for k in callees if (helper := self.helper(k)) is not None}
        results = {k: self._length for k in callees if self._measures(k)}
        calls = ProgramCalls(self.summaries, wanted, helpers, results)

        rankings: dict[int, ContextRanking] = {}

        def ranking(loop: Loop, record: Record) -> tuple[int, str] | None:
            values = LoopValues(record, loop.id, self.image)
            if id(record) not in rankings:
                what_calls_do = self._effects(cfg, helpers)
                deadline = self.limits.deadline
                rankings[id(record)] = ContextRanking(self.ranked, cfg, nest, values, what_calls_do, deadline)
            return rankings[id(record)].bound(loop, values)

        def guessing(loop: Loop, record: Record) -> tuple[int, str] | None:
            if not writes_anywhere(cfg, loop, record):
                return None
            hoped, effects = Hoped(record, loop.id, self.image), self._effects(cfg, helpers)
            return ContextRanking(Ranked(), cfg, nest, hoped, effects, self.limits.deadline).bound(loop, hoped)

        stated = _smallest(self.stated[key].bounds, self._library(key, narrowed))
        order = self.orders[key]
        arguments = (order, narrowed, self.image, calls, stated, ranking, self.limits, thorough, attempt, guessing)
        result = analyse_function(*arguments)
        if result.curtailed:
            if self.leaving is None:
                raise result.curtailed
            self.curtailed = self.curtailed or result.curtailed
        derived = {loop: bound.bound for loop, bound in result.bounds.items() if bound.origin is not Origin.ANNOTATION}
        called = {index: edge.callees for index, edge in enumerate(cfg.edges) if edge.callees}
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
            sites=result.record.calls,
            entered=narrowed,
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

    def _measures(self, key: int) -> bool:
        """Whether a function is known to be `strlen`, by its code."""
        self._library(key)
        return any(part.whole and "strlen" in part.known.names for part in self.routines.get(key, ()))

    def _length(self, state: State) -> Range | None:
        from mauve.wcet.flow.strings import measured

        return measured(state, self.image)

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

    def recognised(self, key: int) -> tuple[Recognised, ...]:
        """The routines of the table of libraries of which a function consists."""
        if key not in self.routines:
            from mauve.wcet.flow.library import recognise

            self.routines[key] = recognise(self.cfgs[key])
        return self.routines[key]

    def _library(self, key: int, entered: State | None = None) -> dict[int, LoopBound]:
        """Bounds of the loops of a known routine, entered in a state if that is known."""
        nest = self.nest(key)
        if not nest.loops:
            return {}
        from mauve.wcet.flow.library import STRING, library_bound
        from mauve.wcet.flow.strings import longest

        known = self.recognised(key)
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

    def incomplete(self, key: int) -> bool:
        """Whether the function, or something that it calls, might gain from knowing its caller."""
        if key in self._incomplete:
            return self._incomplete[key]
        seen, waiting, known, found = {key}, [key], True, False
        while waiting and not found:
            quick = self.quick.get(waiting.pop())
            if quick is None:
                known = False
                continue
            if quick.targets is None:
                continue
            found = bool(quick.unbounded) or quick.name[0] in self.cyclic
            found |= any(hole.kind in POINTERS for hole in quick.flow.cfg.unresolved)
            for callee in (callee for callees in quick.called.values() for callee in callees):
                assert not isinstance(callee, Analysed), "contexts are followed in copies"
                found |= self._incomplete.get(callee, False)
                if callee not in seen and callee not in self._incomplete:
                    seen.add(callee)
                    waiting.append(callee)
        if known or found:
            self._incomplete[key] = found
        return found


    def takes_angle(self, key: int) -> bool:
        """Whether a function's time hangs on how large the angle is that it is called with, in r0 and r1."""
        if key not in self._angles:
            from mauve.wcet.flow.regular import reduces

            reached = (key, *callgraph.callees(self.cfgs[key]))
            self._angles[key] = any(reduces(self.cfgs[other]) for other in reached)
        return self._angles[key]


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
