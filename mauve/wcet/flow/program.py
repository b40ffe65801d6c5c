"""Flow analysis of a program: graphs, callees before callers, contexts where a loop needs them, indirect targets
until stable.

Every function is analysed once from an unknown entry state. Where that leaves a loop without a bound (or a pointer
without targets), the function is analysed again for the states in which its callers call it, on demand and
remembered by state.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from time import monotonic

from mauve.wcet.binary import callgraph
from mauve.wcet.binary.cfg import Control
from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import EXIT, Cfg, UnresolvedKind
from mauve.wcet.binary.loops import Loop, LoopNest, loop_nest
from mauve.wcet.binary.microop import IndirectCall, IndirectJump, Instruction
from mauve.wcet.binary.split import split_irreducible
from mauve.wcet.flow import effects
from mauve.wcet.flow.domain import MASK
from mauve.wcet.flow.effects import UNKNOWN, ProgramCalls, Summary
from mauve.wcet.flow.execute import GaveUp, Record
from mauve.wcet.flow.facts import Fact
from mauve.wcet.flow.function import FunctionResult, Limits, analyse_function
from mauve.wcet.flow.given import Given
from mauve.wcet.flow.order import Order, arrange
from mauve.wcet.flow.result import AddressRange, ContextKey, FunctionFlow, LoopBound, ProgramFlow
from mauve.wcet.flow.state import ABSOLUTE, Cells, State, Symbols
from mauve.wcet.flow.values import LoopValues
from mauve.wcet.hardware.board import Board
from mauve.wcet.result import Origin, Problem, ProblemKind

ASSUMPTIONS = (
    "functions keep the procedure call standard (AAPCS): r4-r11 and sp are preserved by calls",
    "the stack pointer is valid, and the stack is not reached through arguments or globals",
    "code is not written",
    "pointer arguments do not alias the active frames",
    "data in the binary's memory changes only by the analysed code while it runs",
)
MOST_CONTEXTS = 24
"""How many contexts one function is analysed in."""
MOST_VAIN = 3
"""After so many contexts of a function that bounded no further loop no more are tried."""
MOST_DEPTH = 12
"""How many calls deep contexts are followed."""
ROUNDS = 4
"""How often targets of pointers that the analysis found are put into the graphs."""
MOST_TARGETS = 64


Targets = dict[int, tuple[int, ...]]
"""Of indirect jumps and calls by address: where they go, as keys; empty when that is not known."""


class BinaryImage:
    """The memory of a binary: read-only data, and with `initial` the data it starts with."""

    def __init__(self, binary: Binary) -> None:
        self.binary = binary

    def constant(self, address: int, size: int) -> int | None:
        """See transfer.Image."""
        if size == 0:
            return 0 if self.owns(address) else None
        found = self.binary.read_constant(address, size)
        return None if found is None else int.from_bytes(found, "little")

    def owns(self, address: int) -> bool:
        """Whether an address lies in a segment."""
        return self.binary.segment_at(address) is not None


@dataclass(slots=True)
class _Function:
    """One function in one context as analysed: the result, or None with the reason."""

    result: FunctionResult | None
    flow: FunctionFlow


def analyse_program(
    binary: Binary,
    entry_key: int,
    board: Board | None = None,
    facts: Sequence[Fact] = (),
    *,
    initial_data: bool = False,
    timeout: float | None = None,
    limits: Limits | None = None,
) -> ProgramFlow:
    """Everything that flow analysis finds out about `entry_key` and what it calls.

    `initial_data` starts from the linked data instead of unknown globals. `timeout` is in seconds. Holes are
    problems in the result; no input makes this raise.
    """
    limits = limits or Limits()
    if timeout is not None:
        limits = replace(limits, deadline=monotonic() + timeout)
    given = Given(binary, facts)
    stated = given.control()
    found: Targets = {}
    for last in (*(False for _ in range(ROUNDS)), True):
        # Targets that still change when the rounds are over are not known.
        known = {address: targets for address, targets in found.items() if targets and not last}
        control = replace(stated, targets={**known, **stated.targets})
        analysis = _Program(binary, entry_key, control, given, initial_data, limits)
        analysis.run()
        seen = analysis.targets(found, frozenset(stated.targets))
        if seen == found:
            break
        found = seen
    return analysis.flow()


class _Program:
    """One round: the graphs are fixed."""

    def __init__(
        self, binary: Binary, entry: int, control: Control, given: Given, initial_data: bool, limits: Limits
    ) -> None:
        self.binary, self.entry, self.control, self.given, self.limits = binary, entry, control, given, limits
        self.initial_data = initial_data
        self.image = BinaryImage(binary)
        graphs = callgraph.build_program(binary, entry, control)
        self.cfgs: Mapping[int, Cfg] = {key: split_irreducible(cfg) for key, cfg in graphs.items()}
        self.order = callgraph.order(self.cfgs)
        self.symbols = Symbols()
        self.nests: dict[int, LoopNest] = {}
        self.orders: dict[int, Order] = {}
        self.summaries: dict[int, Summary] = {}
        self.done: dict[ContextKey, _Function] = {}
        self.names: dict[tuple[int, tuple[object, ...]], ContextKey] = {}
        self.hasty: set[int] = set()
        self.cyclic = frozenset(key for cycle in self.order.cycles for key in cycle.members)

    def run(self) -> None:
        """Analyse all functions, callees first."""
        for key in self.order.functions:
            if key in self.cyclic:
                self.summaries[key] = UNKNOWN
                continue
            first = key == self.entry
            function = self._analyse((key, ""), self._initial_state() if first else State(self.symbols), 0, first)
            if not first and function.result is not None and function.result.unbounded:
                self.hasty.add(key)
            result = function.result
            self.summaries[key] = UNKNOWN if result is None else effects.summarise(result.record)

    def _initial_state(self) -> State:
        state = State(self.symbols)
        if self.initial_data:
            cells = state.cells(ABSOLUTE)
            for segment in self.binary.segments:
                if segment.writable:
                    _fill(cells, segment.address, segment.data.ljust(min(segment.size, MOST_INITIAL), b"\0"))
        return state

    # ------------------------------------------------------------------------------------------------ one function
    def _analyse(self, name: ContextKey, state: State, depth: int, thorough: bool = True) -> _Function:
        key = name[0]
        cfg, nest = self.cfgs[key], self._nest(key)
        function = self._bare(cfg, nest, name)
        if not nest.irreducible and cfg.blocks:
            try:
                function = self._full(cfg, nest, name, state, depth, thorough)
            except GaveUp:
                message = f"the analysis of {cfg.name} takes more steps or time than allowed"
                problem = Problem(ProblemKind.LIMIT, message, cfg.address, cfg.name)
                function.flow = replace(function.flow, problems=(problem,))
        self.done[name] = function
        return function

    def _nest(self, key: int) -> LoopNest:
        if key not in self.nests:
            self.nests[key] = loop_nest(self.cfgs[key])
        return self.nests[key]

    def _bare(self, cfg: Cfg, nest: LoopNest, name: ContextKey) -> _Function:
        """A function of which only the graph is known."""
        calls = {i: tuple((k, "") for k in e.callees) for i, e in enumerate(cfg.edges) if e.callees}
        return _Function(None, FunctionFlow(cfg, nest, {}, frozenset(), {}, calls))

    def _full(
        self, cfg: Cfg, nest: LoopNest, name: ContextKey, state: State, depth: int, thorough: bool
    ) -> _Function:
        key = name[0]
        if key not in self.orders:
            self.orders[key] = arrange(cfg, nest)
        wanted = frozenset(k for k in callgraph.callees(cfg) if self._incomplete(k))
        calls = ProgramCalls(self.summaries, wanted)

        def ranking(loop: Loop, record: Record) -> tuple[int, str] | None:
            from mauve.wcet.flow.ranking import bound_by_ranking

            found = bound_by_ranking(cfg, nest, loop, LoopValues(record, loop.id, self.image))
            return None if found is None else (found.bound, found.method)

        stated = _smallest(self.given.bounds(cfg, nest), _library(cfg, nest))
        limits = self.limits if thorough else replace(self.limits, steps=0)
        result = analyse_function(self.orders[key], state, self.image, calls, stated, ranking, limits)
        derived = {loop: bound.bound for loop, bound in result.bounds.items() if bound.origin is not Origin.ANNOTATION}
        self.given.compare(cfg, nest, derived)
        contexts = self._contexts(cfg, result, depth)
        flow = FunctionFlow(
            cfg,
            nest,
            result.bounds,
            result.infeasible,
            {at: AddressRange(low, high) for at, (region, low, high) in result.accesses.items() if _fixed(region,
            high)}, contexts,
            tuple(self._unbounded(cfg, nest, loop) for loop in sorted(result.unbounded)),
            result.depth,
        )
        return _Function(result, flow)

    def _unbounded(self, cfg: Cfg, nest: LoopNest, loop: int) -> Problem:
        block = cfg.blocks[nest.loops[loop].header]
        message = f"no bound was found for the loop at {block.address:#x} in {cfg.name}"
        return Problem(ProblemKind.LOOP, message, block.address, cfg.name)

    # ------------------------------------------------------------------------------------------------ contexts
    def _incomplete(self, key: int) -> bool:
        """Whether the function, or something that it calls, might gain from knowing its caller."""
        function = self.done.get((key, ""))
        if function is None or function.result is None:
            return False
        if function.result.unbounded or any(hole.kind in _POINTERS for hole in function.flow.cfg.unresolved):
            return True
        called = (context for contexts in function.flow.calls.values() for context in contexts)
        return any(words or self._incomplete(callee) for callee, words in called)

    def _contexts(self, cfg: Cfg, result: FunctionResult, depth: int) -> dict[int, tuple[ContextKey, ...]]:
        found = {}
        for index, edge in enumerate(cfg.edges):
            if edge.callees:
                found[index] = tuple(self._context(k, result.record.calls.get((index, k)), depth) for k in edge.callees)
        return found

    def _context(self, key: int, state: State | None, depth: int) -> ContextKey:
        """The context of a callee for an entry state: the one that covers all calls unless that is incomplete."""
        known = self.names.get((key, effects.fingerprint(state))) if state is not None else None
        if known is not None:
            return known
        if state is None or not self._promising(key, state, depth):
            if key in self.hasty:
                self.hasty.discard(key)
                self._analyse((key, ""), State(self.symbols), 0)
            return key, ""
        words = effects.describe(state)
        mine = [name for name in self.names.values() if name[0] == key]
        name = (key, words or f"call {len(mine) + 1}")
        if name in mine:
            name = (key, f"{name[1]} #{len(mine) + 1}")
        self.names[key, effects.fingerprint(state)] = name
        self._analyse(name, state, depth + 1)
        return name

    def _promising(self, key: int, state: State, depth: int) -> bool:
        """Whether one more context of a function is worth its time."""
        mine = [name for name in self.names.values() if name[0] == key]
        if depth >= MOST_DEPTH or len(mine) >= MOST_CONTEXTS:
            return False
        if not effects.describe(state) and not any(state.memory.values()):
            return False
        return len(mine) < MOST_VAIN or not all(self._no_better(name) for name in mine)

    def _no_better(self, name: ContextKey) -> bool:
        """Whether a context left open what was open without it."""
        inside, default = self.done.get(name), self.done[name[0], ""]
        return inside is None or inside.result is None or (
            default.result is not None and inside.result.unbounded >= default.result.unbounded
        )

    # ------------------------------------------------------------------------------------------------ results
    def _used(self) -> list[ContextKey]:
        """The contexts that the entry reaches, callees first."""
        order: list[ContextKey] = []
        seen: set[ContextKey] = set()
        stack: list[tuple[ContextKey, bool]] = [((self.entry, ""), False)]
        while stack:
            name, finished = stack.pop()
            if finished:
                order.append(name)
            elif name not in seen and name in self.done:
                seen.add(name)
                stack.append((name, True))
                stack += [(callee, False) for callees in self.done[name].flow.calls.values() for callee in callees]
        return order

    def targets(self, before: Targets, stated: frozenset[int]) -> Targets:
        """Where branches and calls through pointers go, of those that the graphs alone leave open: all targets in every
        context in use, and those of earlier rounds. A way found in one round leads to new values in the next: what was
        found holds only when a round in which it is followed finds nothing else. Empty: not known, and never again.
        """
        found: dict[int, set[int] | None] = {
            address: set(targets) if targets else None for address, targets in before.items()
        }
        for name in self._used():
            function = self.done[name]
            cfg = function.flow.cfg
            holes = {hole.address for hole in cfg.unresolved if hole.kind in _POINTERS}
            for block in cfg.blocks:
                last = block.instructions[-1]
                if last.address in stated or (last.address not in holes and last.address not in before):
                    continue
                targets, known = self._keys(function, last), found.get(last.address, set())
                found[last.address] = None if targets is None or known is None else known | targets
        return {address: tuple(sorted(targets or ())) for address, targets in found.items()}

    def _keys(self, function: _Function, jump: Instruction) -> set[int] | None:
        """The targets of an indirect jump or call in one context, as keys; None when they are not known."""
        values = None if function.result is None else function.result.targets.get(jump.address)
        if values is None or values.size > MOST_TARGETS:
            return None
        match jump.flow:
            case IndirectJump(exchanges=True) | IndirectCall(exchanges=True):
                keys = set(values.members())
            case _:
                keys = {value & ~1 | jump.thumb for value in values.members()}
        return None if any(self.binary.read_code(key & ~1, 2) is None for key in keys) else keys

    def flow(self) -> ProgramFlow:
        """The result."""
        problems = []
        for cycle in self.order.cycles:
            names = " -> ".join(self.cfgs[key].name for key in cycle.path)
            first = self.cfgs[cycle.path[0]]
            problems.append(Problem(ProblemKind.RECURSION, f"recursion: {names}", first.address, first.name))
        functions = {name: self.done[name].flow for name in self._used()}
        problems += self.given.problems.values()
        notes = (*self.given.notes.values(), *self.given.unused())
        return ProgramFlow((self.entry, ""), functions, tuple(problems), notes, ASSUMPTIONS)


_POINTERS = (UnresolvedKind.BRANCH, UnresolvedKind.CALL)
MOST_INITIAL = 1 << 16
"""Bytes of a zero-filled segment that are followed as initial data."""


def _library(cfg: Cfg, nest: LoopNest) -> dict[int, LoopBound]:
    """Bounds of the loops of known helpers."""
    from mauve.wcet.flow.library import library_bound

    found = {loop.id: library_bound(cfg, loop) for loop in nest.loops}
    return {
        loop: LoopBound(known.bound, Origin.LIBRARY, known.method) for loop, known in found.items() if known is not None
    }


def _smallest(first: dict[int, LoopBound], second: dict[int, LoopBound]) -> dict[int, LoopBound]:
    result = dict(first)
    for loop, bound in second.items():
        if loop not in result or bound.bound < result[loop].bound:
            result[loop] = bound
    return result


def _fixed(region: int | None, high: int) -> bool:
    return region == ABSOLUTE and high <= MASK


def _fill(cells: Cells, start: int, data: bytes) -> None:
    """Write initial data as words."""
    for offset in range(0, len(data) // 4 * 4, 4):
        cells[start + offset] = (4, int.from_bytes(data[offset : offset + 4], "little"))
    for offset in range(len(data) // 4 * 4, len(data)):
        cells[start + offset] = (1, data[offset])


__all__ = ["ASSUMPTIONS", "EXIT", "Limits", "analyse_program"]
