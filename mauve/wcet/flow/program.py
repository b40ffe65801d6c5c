"""Flow analysis of programs: entries of one binary, indirect targets until stable.

Every function is analysed once from an unknown entry state. Where that leaves a loop without a bound (or a pointer
without targets), the function is analysed again for the states in which its callers call it, on demand and
remembered by state (`Functions`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from time import monotonic
from typing import TYPE_CHECKING

from mauve.wcet.binary.callgraph import Order
from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import EXIT
from mauve.wcet.binary.lines import LineTable
from mauve.wcet.binary.microop import IndirectCall, IndirectJump, Instruction
from mauve.wcet.binary.pointers import taken
from mauve.wcet.clock import OutOfTime, is_over
from mauve.wcet.flow import domain
from mauve.wcet.flow.analysed import Analysed
from mauve.wcet.flow.assumed import Assumed
from mauve.wcet.flow.both import better
from mauve.wcet.flow.candidates import MOST as MOST_CANDIDATES
from mauve.wcet.flow.candidates import open_calls, open_edges, pointer_problems
from mauve.wcet.flow.domain import MASK, Range
from mauve.wcet.flow.facts import Fact
from mauve.wcet.flow.function import Limits
from mauve.wcet.flow.functions import POINTERS, Functions
from mauve.wcet.flow.given import Given
from mauve.wcet.flow.recursion import unroll
from mauve.wcet.flow.result import ContextKey, FunctionFlow, ProgramFlow
from mauve.wcet.flow.state import ABSOLUTE, Cells, State
from mauve.wcet.hardware.board import Board
from mauve.wcet.result import Problem, ProblemKind

if TYPE_CHECKING:
    from mauve.wcet.flow.run.content import Given as Start
    from mauve.wcet.flow.run.program import Ran

ASSUMPTIONS = (
    "functions keep the procedure call standard (AAPCS): r4-r11 and sp are preserved by calls",
    "the stack pointer is valid, and the stack is not reached through arguments or globals",
    "code is not written",
    "pointer arguments do not alias the active frames",
    "data in the binary's memory, and objects reached through pointers, change only by the analysed code while it runs",
    "functions with the names that the ABI reserves for helpers (__aeabi_idiv and others) do what the ABI says",
    "the function returns: an execution that goes on for ever has no time",
)
ROUNDS = 4
"""How often targets of pointers that the analysis found are put into the graphs."""
MOST_TARGETS = 64
MOST_SHARED, MOST_VARIANTS = 300_000, 8
"""Instructions of graphs, and sets of targets, that are kept for later entries."""


Targets = dict[int, tuple[int, ...]]
"""Of indirect jumps and calls by address: where they go, as keys; empty when that is not known."""


class BinaryImage:
    """The memory of a binary: its read-only data, and what facts assume of the other."""

    def __init__(self, binary: Binary, assumed: Assumed) -> None:
        self.binary = binary
        self._assumed = assumed

    def constant(self, address: int, size: int) -> int | None:
        """See image.Image."""
        if size == 0:
            return 0 if self.owns(address) else None
        found = self.binary.read_constant(address, size)
        return None if found is None else int.from_bytes(found, "little")

    def assumed(self, addresses: Range, size: int, is_signed: bool) -> Range | None:
        """See image.Image."""
        return self._assumed.reading(addresses, size, is_signed)

    def owns(self, address: int) -> bool:
        """Whether an address lies in a segment."""
        return self.binary.segment_at(address) is not None


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
    """Everything that flow analysis finds out about `entry_key` and what it calls; see `Programs.program`."""
    return Programs(binary, facts, initial_data=initial_data, limits=limits).program(entry_key, timeout)


class Programs:
    """The flow analyses of several entries of one binary under the same facts. What entries have in common is analysed
    once; the results are those of separate analyses."""

    def __init__(
        self,
        binary: Binary,
        facts: Sequence[Fact] = (),
        *,
        initial_data: bool = False,
        limits: Limits | None = None,
        lines: LineTable | None = None,
    ) -> None:
        self._binary, self._initial_data, self._limits = binary, initial_data, limits or Limits()
        self._given = Given(binary, facts, lines)
        self._image = BinaryImage(binary, self._given.assumed)
        self._stated = self._given.control()
        self._shared: dict[tuple[tuple[int, tuple[int, ...]], ...], Functions] = {}
        self._pointers: tuple[int, ...] | None = None

    def program(self, entry_key: int, timeout: float | None = None) -> ProgramFlow:
        """Everything that flow analysis finds out about `entry_key` and what it calls.

        `initial_data` starts from the linked data instead of unknown globals. `timeout` is in seconds. Holes are
        problems in the result, and so is the end of the time; no input makes this raise.
        """
        deadline = self._limits.deadline if timeout is None else monotonic() + timeout
        started = monotonic()
        ran = self._run(entry_key, self._first_run(deadline)) if self._initial_data else None
        short = bool(self._given.assumed.memory) and (ran is None or monotonic() - started > FIRST_RUN / 4)
        if ran is not None and not _open(ran) and not (short and _may_gain(ran, None)):
            return ran
        try:
            analysed = self.without_run(entry_key, deadline, timeout)
        except OutOfTime as reason:
            return self._unfinished(entry_key, reason, timeout) if ran is None else ran
        if _open(analysed) if not self._initial_data else short and _may_gain(analysed, ran):
            ran = _of_both(self._run(entry_key, _share(deadline, LAST_RUN)), ran)
        if ran is None:
            return analysed
        ran, analysed = better(ran, analysed), better(analysed, ran)
        return analysed if _open(analysed) < _open(ran) else ran

    def _first_run(self, deadline: float | None) -> float | None:
        """When the run that comes before all else ends: unknown values that decide fork a run, which may end nowhere,
        while the analysis without one often takes little time."""
        if not self._given.assumed.memory:
            return deadline
        first = monotonic() + FIRST_RUN
        share = _share(deadline, FOR_RUNS)
        return first if share is None else min(first, share)

    def without_run(self, entry_key: int, deadline: float | None = None, timeout: float | None = None) -> ProgramFlow:
        """The analysis without a run. When its time is over, it keeps what it has. Raises OutOfTime where there are not
        even graphs."""
        found: Targets = {}
        analysis: _Program | None = None
        late: OutOfTime | None = None
        stated = frozenset(self._stated.targets)
        try:
            for last in (*(False for _ in range(ROUNDS)), True):
                # Targets that still change when the rounds are over are not known.
                known = {address: targets for address, targets in found.items() if targets and not last}
                functions = self._functions(known)
                analysis = _Program(self._binary, functions, entry_key, deadline, self._initial_data)
                seen = analysis.targets(found, stated)
                late = functions.curtailed
                if seen == found and late is None and analysis.suppose(self._taken()):
                    seen = analysis.targets(found, stated)
                if seen == found or late is not None:
                    break
                found = seen
        except OutOfTime as reason:
            if analysis is None:
                raise
            late = reason
        assert analysis is not None
        analysis.suppose(self._taken())
        flow = analysis.flow(self._given)
        if any(functions.curtailed is not None for functions in self._shared.values()):
            self._shared.clear()
        if late is None or not _open(flow):
            return flow
        entry = self._binary.name_at(entry_key)
        return replace(flow, problems=(out_of_time(entry, entry_key & ~1, late, timeout), *flow.problems))

    def _taken(self) -> tuple[int, ...]:
        """The functions whose address the binary takes."""
        if self._pointers is None:
            self._pointers = taken(self._binary)
        return self._pointers

    def _unfinished(self, entry: int, reason: OutOfTime, timeout: float | None) -> ProgramFlow:
        """The result when time ended the analysis: no function has a bound, and the problem says where it was."""
        problem = out_of_time(self._binary.name_at(entry), entry & ~1, reason, timeout)
        return ProgramFlow((entry, ""), {}, (problem,), (), (*ASSUMPTIONS, *self._given.assumed.sentences))

    def _run(self, entry: int, until: float | None) -> ProgramFlow | None:
        """The program executed from its linked data, or from any; None where that did not come to its end in time."""
        from mauve.wcet.flow.run.content import Given as Start
        from mauve.wcet.flow.run.program import STEPS, Source, run_program

        assumed = self._given.assumed
        given = [
            Start(one.start, one.end, one.width, domain.between(one.low & MASK, one.high & MASK))
            if one.width
            else Start(one.start, one.end)
            for one in assumed.memory
        ]
        steps = STEPS
        if not self._initial_data:
            given, steps = [*given, *self._anything(given)], FEW_STEPS
        found: dict[int, frozenset[int]] = {}
        for _ in range(RUNS):
            functions = self._functions({address: tuple(sorted(targets)) for address, targets in found.items()})
            functions.limits = replace(functions.limits, deadline=until)
            try:
                source = Source(functions, entry, assumed.arguments, until)
                ran = run_program(source, entry, until, given=given, steps=steps)
            except OutOfTime:
                return None
            if ran.flows is not None:
                return _with_facts(ran, self._given, (RAN,) if self._initial_data else ())
            grown = {at: found.get(at, frozenset()) | more for at, more in ran.targets.items()}
            if all(found.get(at) == targets for at, targets in grown.items()):
                return None
            found |= grown
        return None

    def _anything(self, given: Sequence[Start]) -> list[Start]:
        """The data that a codel may find in any state: all that can be written and is not `given`."""
        from mauve.wcet.flow.run.content import Given as Start

        found = []
        for segment in self._binary.segments:
            start = segment.address
            for one in sorted(given, key=lambda one: one.start) if segment.writable else ():
                if start < one.start < segment.end:
                    found.append(Start(start, one.start))
                start = max(start, one.end)
            if segment.writable and start < segment.end:
                found.append(Start(start, segment.end))
        return found

    def _functions(self, targets: Targets) -> Functions:
        """The functions with the targets that were found so far; what many entries have left is dropped in time."""
        key = tuple(sorted(targets.items()))
        kept = sum(functions.graphs.instructions for functions in self._shared.values())
        if key not in self._shared and (kept > MOST_SHARED or len(self._shared) >= MOST_VARIANTS):
            self._shared = {k: v for k, v in self._shared.items() if not k and v.graphs.instructions < MOST_SHARED}
        if key not in self._shared:
            control = replace(self._stated, targets={**targets, **self._stated.targets})
            self._shared[key] = Functions(self._binary, self._image, control, self._given, self._limits)
        return self._shared[key]


class _Program:
    """One round for one entry: the graphs are fixed."""

    def __init__(
        self, binary: Binary, functions: Functions, entry: int, deadline: float | None, initial_data: bool
    ) -> None:
        self.binary, self.functions, self.entry, self.deadline = binary, functions, entry, deadline
        self.candidates: tuple[int, ...] = ()
        self.supposed: tuple[Analysed, ...] = ()
        functions.leaving, functions.curtailed = deadline, None  # a proof for a run may have been cut short before
        before = None if deadline is None else deadline - (deadline - monotonic()) / FOR_THE_END
        try:
            self.order: Order = functions.settle(entry, before, initial_data)
            self.top: Analysed | None = None
            if initial_data:
                self.top = functions.from_state(entry, self._initial_state(functions.given.assumed))
            top = self.top or functions.default(entry)
            self.shared = {} if top is None else functions.contexts.joined((top,), reversed(self.order.functions))
        finally:
            functions.leaving = None
        self.used = self._used()
        self.holding = frozenset(function.name[0] for function in self.used if open_calls(function.flow.cfg))

    def _initial_state(self, assumed: Assumed) -> State:
        state = State(self.functions.symbols)
        cells = state.cells(ABSOLUTE)
        for segment in self.binary.segments:
            if segment.writable:
                _fill(cells, segment.address, segment.data.ljust(min(segment.size, MOST_INITIAL), b"\0"))
        for stretch in assumed.memory:
            state.forget_bytes(ABSOLUTE, stretch.start, stretch.end - 1)
        return state

    # ------------------------------------------------------------------------------------------------ open pointers
    def suppose(self, candidates: tuple[int, ...]) -> bool:
        """Where targets of calls are not known, analyse the `candidates` for any state; False where all are known, or
        where that was done."""
        if not self.holding or not candidates or self.candidates:
            return False
        self.candidates = candidates
        if len(candidates) > MOST_CANDIDATES:
            return False
        functions, now = self.functions, monotonic()
        functions.leaving = self.deadline
        try:
            share = SECONDS if self.deadline is None else (self.deadline - now) / FOR_CANDIDATES
            self._enter(candidates, now + share)
        except OutOfTime:
            self.supposed = self._bare(candidates, monotonic() + FOR_GRAPHS)
        finally:
            functions.leaving = None
        functions.limits = replace(functions.limits, deadline=self.deadline)
        self.used = self._used()
        return True

    def _enter(self, candidates: tuple[int, ...], until: float) -> None:
        """Take candidates up beside what the entry calls."""
        functions, order = self.functions, self.order.functions
        for key in candidates:
            order = (*functions.settle(key, until).functions, *order)
        found = (functions.default(key) for key in candidates)
        supposed = tuple(function for function in found if function is not None)
        top = self.top or functions.default(self.entry)
        tops = supposed if top is None else (top, *supposed)
        self.shared = functions.contexts.joined(tops, reversed(dict.fromkeys(order)))
        self.supposed = supposed

    def _bare(self, candidates: tuple[int, ...], until: float) -> tuple[Analysed, ...]:
        """No more than the graphs of candidates and of what they call, as far as there is time."""
        functions, known = self.functions, {function.name[0] for function in self.used}
        functions.limits = replace(functions.limits, deadline=until)
        found: dict[int, Analysed] = {}
        try:
            for candidate in candidates:
                for key, cfg in functions.graphs_from(candidate).items():
                    flow = FunctionFlow(cfg, functions.nest(key), {}, frozenset(), {}, {})
                    found |= {key: Analysed(flow, {}, (key, ()))} if key not in known else {}
        except OutOfTime:
            pass
        return tuple(found.values())

    # ------------------------------------------------------------------------------------------------ results
    def _used(self) -> tuple[Analysed, ...]:
        """The contexts that the entry reaches, callees first; before them those of what is supposed to be called."""
        order: list[Analysed] = []
        seen: set[Analysed] = set()
        stack = [(self.top or self.functions.default(self.entry), False)]
        stack += [(function, False) for function in self.supposed]
        while stack:
            function, finished = stack.pop()
            if function is None:
                continue
            if finished:
                order.append(function)
            elif function not in seen:
                seen.add(function)
                stack.append((function, True))
                stack += [(callee, False) for callee in self._callees(function)]
        return tuple(order)

    def _callees(self, function: Analysed) -> Iterator[Analysed | None]:
        for index, callees in function.called.items():
            for callee in () if index in function.flow.infeasible else callees:
                yield callee if isinstance(callee, Analysed) else self.shared.get(callee)

    def targets(self, before: Targets, stated: frozenset[int]) -> Targets:
        """Where branches and calls through pointers go, of those that the graphs alone leave open: all targets in every
        context in use, and those of earlier rounds. A way found in one round leads to new values in the next: what was
        found holds only when a round in which it is followed finds nothing else. Empty: not known, and never again.
        """
        found: dict[int, set[int] | None] = {
            address: set(targets) if targets else None for address, targets in before.items()
        }
        for function in self.used:
            cfg = function.flow.cfg
            holes = {hole.address for hole in cfg.unresolved if hole.kind in POINTERS}
            for block in cfg.blocks:
                last = block.instructions[-1]
                if last.address in stated or (last.address not in holes and last.address not in before):
                    continue
                targets, known = self._keys(function, last), found.get(last.address, set())
                found[last.address] = None if targets is None or known is None else known | targets
        return {address: tuple(sorted(targets or ())) for address, targets in found.items()}

    def _keys(self, function: Analysed, jump: Instruction) -> set[int] | None:
        """The targets of an indirect jump or call in one context, as keys; None when they are not known."""
        values = None if function.targets is None else function.targets.get(jump.address)
        if values is None or values.size > MOST_TARGETS:
            return None
        match jump.flow:
            case IndirectJump(exchanges=True) | IndirectCall(exchanges=True):
                keys = set(values.members())
            case _:
                keys = {value & ~1 | jump.thumb for value in values.members()}
        return None if any(self.binary.read_code(key & ~1, 2) is None for key in keys) else keys

    def flow(self, given: Given) -> ProgramFlow:
        """The result."""
        keys = dict.fromkeys((*self.order.functions, *(function.name[0] for function in self.used)))
        stated = [self.functions.stated.get(key) for key in keys]
        problems = dict.fromkeys(problem for facts in stated if facts is not None for problem in facts.problems)
        matched = {fact for facts in stated if facts is not None for fact in facts.matched}
        notes = dict.fromkeys(note for function in self.used for note in function.notes)
        contexts = self._names()
        self.callable = tuple(function for function in self.supposed if not self._calls_back(function))
        flows = {contexts[function]: self._flow(function, contexts) for function in self.used}
        unrolled = unroll(contexts[self.used[-1]], flows, given.depths)
        return ProgramFlow(
            unrolled.entry,
            unrolled.flows,
            (*unrolled.problems, *problems),
            (*notes, *given.unused(matched)),
            (*ASSUMPTIONS, *given.assumed.sentences),
            unrolled.words,
        )

    def _names(self) -> dict[Analysed, ContextKey]:
        """A name for each context: its words, which tell it from the others of the function."""
        names: dict[Analysed, ContextKey] = {}
        taken: set[ContextKey] = set()
        counts: dict[int, int] = {}
        for function in self.used:
            key, fingerprint = function.name
            words = ""
            if fingerprint:
                counts[key] = counts.get(key, 0) + 1
                words = function.words or f"call {counts[key]}"
                if (key, words) in taken:
                    words = f"{words} #{counts[key]}"
            names[function] = key, words
            taken.add((key, words))
        return names

    def _flow(self, function: Analysed, names: Mapping[Analysed, ContextKey]) -> FunctionFlow:
        """The function's flow with the names of the contexts that it calls; the same object for the same names."""
        calls = {}
        for index, callees in function.called.items():
            # What only infeasible edges call has no name.
            contexts = (c if isinstance(c, Analysed) else self.shared.get(c, c) for c in callees)
            if index not in function.flow.infeasible:
                calls[index] = tuple(names[c] if isinstance(c, Analysed) else (c, "") for c in contexts)
        excluded = () if is_over(self.deadline) else self.functions.exclusive(function.name[0])
        if function.flow.calls != calls or function.flow.exclusive != excluded:
            function.flow = replace(function.flow, calls=calls, exclusive=excluded)
        told = pointer_problems(function.flow.cfg, self.candidates, self.binary)
        if not told:
            return function.flow
        inside = function.name[0] in self.holding
        may = tuple(names[callee] for callee in self.callable) if inside else ()
        opened = {index: may for index, _ in open_edges(function.flow.cfg)} if may else {}
        return replace(function.flow, calls=calls | opened, problems=(*function.flow.problems, *told))

    def _calls_back(self, function: Analysed) -> bool:
        """Whether a candidate calls functions with open calls, which would close a circle that may not be there."""
        seen, waiting = {function}, [function]
        while waiting:
            here = waiting.pop()
            if here.name[0] in self.holding:
                return True
            fresh = [callee for callee in self._callees(here) if callee is not None and callee not in seen]
            seen |= set(fresh)
            waiting += fresh
        return False


def out_of_time(name: str, address: int, reason: OutOfTime, timeout: float | None) -> Problem:
    """What is said when time ended the analysis of a function."""
    allowed = "is allowed" if timeout is None else f"the {timeout:g} s that it may take"
    where = f": it was at {reason.function}" if reason.function and reason.function != name else ""
    at = address if reason.address is None else reason.address
    return Problem(ProblemKind.LIMIT, f"the analysis of {name} takes longer than {allowed}{where}", at, reason.function)


def _share(deadline: float | None, part: int) -> float | None:
    """When a run with unknown data ends: the analysis without one needs time as well."""
    now = monotonic()
    return None if deadline is None else now + (deadline - now) / part


def _may_gain(analysed: ProgramFlow, ran: ProgramFlow | None) -> bool:
    """Whether a longer run might find more than the analysis without one and a short run: a loop has no bound, or one
    that may come from the range of a type alone."""
    if ran is not None:
        analysed = better(analysed, ran)
    bounds = (bound.bound for function in analysed.functions.values() for bound in function.bounds.values())
    return bool(_open(analysed)) or any(bound in OF_TYPES for bound in bounds)


def _of_both(first: ProgramFlow | None, second: ProgramFlow | None) -> ProgramFlow | None:
    """The better of two runs, with the bounds of the other where those are smaller."""
    if first is None or second is None:
        return first or second
    first, second = better(first, second), better(second, first)
    return second if _open(second) < _open(first) else first


def _open(flow: ProgramFlow) -> int:
    """How much a result leaves without a bound."""
    return len(flow.problems) + sum(len(function.problems) for function in flow.functions.values())


def _with_facts(ran: Ran, given: Given, also: tuple[str, ...]) -> ProgramFlow:
    """The contexts of a run with what flow facts state of their loops."""
    assert ran.flows is not None
    flows: dict[ContextKey, FunctionFlow] = {}
    problems: dict[Problem, None] = {}
    notes: dict[Problem, None] = {}
    matched: set[int] = set()
    for key, flow in ran.flows.items():
        stated = given.bounds(flow.cfg, flow.nest)
        matched |= stated.matched
        problems |= dict.fromkeys(stated.problems)
        notes |= dict.fromkeys(given.compare(flow.cfg, flow.nest, {k: b.bound for k, b in flow.bounds.items()}))
        bounds = {k: min(b, stated.bounds.get(k, b), key=lambda bound: bound.bound) for k, b in flow.bounds.items()}
        flows[key] = replace(flow, bounds=bounds) if stated.bounds else flow
    assumptions = (*ASSUMPTIONS, *also, *given.assumed.sentences)
    remarks = (*notes, *given.unused(matched))
    return ProgramFlow(ran.entry, flows, tuple(problems), remarks, assumptions)


RAN = "the program starts with the data it is linked with, and runs once"
FEW_STEPS = 1_000_000
"""Instructions of a run from any data: it is short of time from the start, and follows all values at once soon."""
FOR_THE_END = 5
"""One part in so many of the time is kept for bringing to an end what has no time for all effort."""
FIRST_RUN = 3.0
"""Seconds of a first run with unknown data."""
OF_TYPES = frozenset(2**width + more for width in (7, 8, 15, 16) for more in (-1, 0, 1))
"""Bounds that may only say how wide a type is."""
FOR_RUNS, LAST_RUN = 3, 2
"""A run with unknown data gets at most one part in so many of the time that is left, the last one of that after all
other analyses."""
RUNS = 16
"""How often a run starts again with the targets of pointers that it came to."""

FOR_CANDIDATES, SECONDS = 4, 5.0
"""One part in so many of the time is for what calls of unknown targets may lead to; without a limit so many seconds."""
FOR_GRAPHS = 0.5
"""Seconds for its graphs alone, when that is over."""

MOST_INITIAL = 1 << 16
"""Bytes of a zero-filled segment that are followed as initial data."""


def _fill(cells: Cells, start: int, data: bytes) -> None:
    """Write initial data as words."""
    for offset in range(0, len(data) // 4 * 4, 4):
        cells[start + offset] = (4, int.from_bytes(data[offset : offset + 4], "little"))
    for offset in range(len(data) // 4 * 4, len(data)):
        cells[start + offset] = (1, data[offset])


__all__ = ["ASSUMPTIONS", "EXIT", "Limits", "analyse_program"]
