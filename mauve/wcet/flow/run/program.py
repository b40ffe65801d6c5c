"""From a binary to the contexts of its functions by running it: `run_program`."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from time import monotonic
from typing import Any, Protocol

from mauve.wcet.binary.callgraph import order
from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import LoopNest, loop_nest
from mauve.wcet.binary.microop import SP, Call
from mauve.wcet.binary.split import restricted, split_irreducible
from mauve.wcet.flow import domain
from mauve.wcet.flow.assumed import IN_REGISTERS
from mauve.wcet.flow.domain import Range
from mauve.wcet.flow.library import Recognised
from mauve.wcet.flow.locations import Helper
from mauve.wcet.flow.order import Order, arrange
from mauve.wcet.flow.result import AddressRange, ContextKey, FunctionFlow, LoopBound
from mauve.wcet.flow.run.behaviour import MOST, Behaviour, Behaviours
from mauve.wcet.flow.run.content import Given
from mauve.wcet.flow.run.frames import Function, Unresolved
from mauve.wcet.flow.run.machine import Machine
from mauve.wcet.flow.run.memory import Lost, Memory
from mauve.wcet.flow.run.narrow import within
from mauve.wcet.flow.run.remembered import closed
from mauve.wcet.result import Origin, Problem, ProblemKind

STEPS = 25_000_000
"""Instructions that a run may execute."""

METHOD = "run from the linked data"

MOST_CASES = 64
"""Values of numbers that are not known for which a program runs apart."""
FOR_RANGES = 3
"""One part in so many of the time is for a run with the ranges of such numbers."""
FOR_PROOF = 5
"""One part in so many of the time left is for a proof that a loop has a bound."""
AT_LEAST = 0.5
"""Seconds for better bounds, beside twice the time of the run."""
FEW = 8
"""Iterations for which no better bound is looked for."""


@dataclass(frozen=True, slots=True)
class Ran:
    """What a run found: the contexts, callees first, and the entry's; None where it could not go on, for the `reason`.
    `targets` are the places to which indirect branches went that the graphs do not know, by address."""

    flows: Mapping[ContextKey, FunctionFlow] | None
    entry: ContextKey
    targets: Mapping[int, frozenset[int]]
    reason: str = ""


class Functions(Protocol):
    """The functions of a binary as the rest of flow analysis keeps them."""

    @property
    def binary(self) -> Binary:
        """The executable."""

    def graphs_from(self, entry: int) -> Mapping[int, Cfg]:
        """The graphs of everything that a function (a key) reaches, by key, irreducible regions split."""

    def nest(self, key: int) -> LoopNest:
        """The loops of a function."""

    def known_bounds(self, key: int) -> dict[int, int]:
        """Bounds of a function's loops that need no analysis."""

    def helper(self, key: int) -> Helper | None:
        """What a run-time helper computes, by its name."""

    def recognised(self, key: int) -> tuple[Recognised, ...]:
        """The routines of the table of libraries of which a function consists."""

    def bound_anyhow(self, key: int, loop: int, deadline: float | None) -> int | None:
        """Executions of a loop's header per entry, whatever the function is called with; None as well where that is not
        found out in time."""


Arguments = Mapping[int, Sequence[tuple[int, Range]]]
"""What is assumed of arguments, by function (a key): their slots, counted from 1, with their values."""


class Source:
    """The functions of a binary, made ready when they are first called."""

    def __init__(
        self, functions: Functions, entry: int, arguments: Arguments | None = None, deadline: float | None = None
    ) -> None:
        self.deadline = deadline
        self.unstructured: set[int] = set()
        """functions that are run without their loops being known, as some have several entries"""
        self._restricted: set[int] = set()
        self.binary, self._functions = functions.binary, functions
        self._arguments = arguments or {}
        self.cfgs = dict(functions.graphs_from(entry))
        self._groups = {key: number for number, c in enumerate(order(self.cfgs).cycles) for key in c.members}

    def enter(self, key: int, registers: list[Any], memory: Memory) -> bool:
        """Narrow the arguments with which a function is entered to what is assumed of them; False when none remain."""
        for slot, values in self._arguments.get(key, ()):
            if slot <= IN_REGISTERS:
                word = within(registers[slot - 1], values)
                if word is not None:
                    registers[slot - 1] = word
            else:
                place = registers[SP] + 4 * (slot - IN_REGISTERS - 1)
                word = within(memory.peek(place), values)
                if word is not None:
                    memory.poke(place, word)
            if word is None:
                return False
        return True

    def function(self, key: int) -> tuple[Cfg, LoopNest, Order, int]:
        """The graph of a function, its loops, its order, and a number it shares with those it recurses with."""
        if key not in self.cfgs:
            if self.binary.read_code(key & ~1, 2) is None:
                raise Lost("a call goes to no code")
            self.cfgs |= self._functions.graphs_from(key)
        cfg = self.cfgs[key]
        if not cfg.blocks:
            raise Lost("a call goes to bytes that are no instruction")
        nest = loop_nest(cfg) if key in self._restricted else self._functions.nest(key)
        if nest.irreducible and key not in self._restricted:
            # Which of its entries such a region has in the run is known afterwards.
            self.unstructured.add(key)
            nest = LoopNest(())
        return cfg, nest, arrange(cfg, nest), self._groups.get(key, -1 - key)

    def restrict(self, key: int, edges: Container[int]) -> None:
        """Go on with those edges of a function's graph that a run took; that may leave its loops one entry each."""
        self.cfgs[key] = split_irreducible(restricted(self.cfgs[key], edges))
        self._restricted.add(key)
        self.unstructured.discard(key)

    def bound(self, key: int, loop: int) -> int | None:
        """See Functions.bound_anyhow."""
        if key in self._restricted:
            return None
        now = monotonic()
        until = None if self.deadline is None else now + (self.deadline - now) / FOR_PROOF
        return self._functions.bound_anyhow(key, loop, until)

    def known(self, key: int) -> dict[int, int]:
        """Bounds of loops of a function that need no analysis: those of library routines, and what facts state."""
        return {} if key in self.unstructured or key in self._restricted else self._functions.known_bounds(key)

    def closed(self, key: int) -> bool:
        """See remembered.closed."""
        return closed(key, self.cfgs)

    def helper(self, key: int) -> Helper | None:
        """What a run-time helper computes, by its name."""
        return self._functions.helper(key)

    def recognised(self, key: int) -> tuple[Recognised, ...]:
        """The routines of the table of libraries of which a function consists."""
        return () if key in self.unstructured or key in self._restricted else self._functions.recognised(key)

    @property
    def unaligned(self) -> bool:
        """Whether the code is for a core that reads words from any address: one with 32-bit Thumb instructions."""
        return any(
            instruction.thumb and instruction.size == 4 and not isinstance(instruction.flow, Call)
            for cfg in self.cfgs.values()
            for block in cfg.blocks
            for instruction in block.instructions
        )


def run_program(
    source: Source,
    entry: int,
    deadline: float | None,
    most: int = MOST,
    given: Sequence[Given] = (),
    steps: int = STEPS,
) -> Ran:
    """Run a program from `entry` (a key) with its linked data, unknown registers and an unknown stack; `most` contexts
    of a function are told apart. `given` are stretches of data of which the linked content does not count, `steps` the
    instructions that may be executed.

    Where that leaves a loop open, the program runs once for each of the values that numbers in `given` can have, if
    they are few.
    """
    cases = _cases(given)
    now = monotonic()
    until = deadline if deadline is None or len(cases) == 1 else now + (deadline - now) / FOR_RANGES
    ran = _run(source, entry, until, most, [list(given)], steps)
    left_open = ran.flows is None or any(flow.problems for flow in ran.flows.values())
    if not left_open or ran.targets or len(cases) == 1:
        return ran
    apart = _run(source, entry, deadline, most, cases, steps)
    return ran if apart.flows is None and not apart.targets else apart


def _cases(given: Sequence[Given]) -> list[list[Given]]:
    """What is given with each of the values that numbers in it have, those with few values first."""
    cases = [list(given)]
    numbers = [n for n, one in enumerate(given) if one.width and one.end - one.start == one.width]
    for number in sorted(numbers, key=lambda n: given[n].values.size):
        if len(cases) * given[number].values.size > MOST_CASES:
            break
        values = [domain.constant(value) for value in given[number].values.members()]
        cases = [[*c[:number], replace(c[number], values=value), *c[number + 1 :]] for c in cases for value in values]
    return cases


def _run(
    source: Source, entry: int, deadline: float | None, most: int, cases: list[list[Given]], steps: int
) -> Ran:
    """Run a program once for each case; the result covers all."""
    source.deadline = deadline
    started = monotonic()
    memory, behaviours = Memory(source.binary, source.unaligned, cases[0]), Behaviours(most)
    machine = Machine(source, memory, behaviours, steps, deadline)
    key: ContextKey = (entry, "")
    numbers = []
    try:
        for case in cases:
            memory.restart(case)
            numbers.append(machine.run(entry))
    except Lost as lost:
        return Ran(None, key, _found(machine), str(lost))
    except Unresolved as unresolved:
        address, target = unresolved.args
        machine.targets.setdefault(address, set()).add(target)
        return Ran(None, key, _found(machine), "a branch leaves the graphs")
    if source.unstructured:
        for key_, taken in behaviours.taken(source.unstructured).items():
            source.restrict(key_, taken)
        return _run(source, entry, deadline, most, cases, steps)
    settled = behaviours.settle(behaviours.together(numbers))
    if settled is None:
        return Ran(None, key, _found(machine), "calls go round in circles")
    now = monotonic()
    source.deadline = min(now + AT_LEAST + 2 * (now - started), deadline or inf)
    flows, first = _flows(machine, behaviours, *settled)
    return Ran(flows, first, {})


def _found(machine: Machine) -> dict[int, frozenset[int]]:
    return {address: frozenset(targets) for address, targets in machine.targets.items()}


def _flows(
    machine: Machine, behaviours: Behaviours, start: int, numbers: list[int]
) -> tuple[dict[ContextKey, FunctionFlow], ContextKey]:
    """The behaviours as contexts; the entry's has no words."""
    times: dict[int, int] = {}
    names: dict[int, ContextKey] = {}
    for number in reversed(numbers):
        key = behaviours.all[number].function.key
        times[key] = times.get(key, 0) + 1
        names[number] = (key, "" if times[key] == 1 else f"way {times[key]}")
    accesses = _accesses(machine)
    graphs = _graphs(behaviours, numbers)
    flows = {}
    for number in numbers:
        mine = behaviours.all[number]
        flows[names[number]] = _flow(mine, graphs[mine.function.key], names, accesses, machine)
    return flows, names[start]


def _graphs(behaviours: Behaviours, numbers: list[int]) -> dict[int, Cfg]:
    """The graphs of the functions, with what was called through pointers. What a run did not come to does not matter,
    and it comes to no hole."""
    called: dict[int, dict[int, set[int]]] = {}
    for number in numbers:
        mine = behaviours.all[number]
        found = called.setdefault(mine.function.key, {})
        for edge, callees in mine.calls.items():
            found.setdefault(edge, set()).update(behaviours.all[callee].function.key for callee in callees)
    graphs = {}
    for number in numbers:
        cfg = behaviours.all[number].function.cfg
        if cfg.key not in graphs:
            found = called[cfg.key]
            edges = tuple(
                replace(edge, callees=tuple(sorted(found[index]))) if index in found else edge
                for index, edge in enumerate(cfg.edges)
            )
            graphs[cfg.key] = replace(cfg, edges=edges, unresolved=())
    return graphs


def _flow(
    mine: Behaviour,
    cfg: Cfg,
    names: Mapping[int, ContextKey],
    accesses: Mapping[int, dict[tuple[int, int], AddressRange]],
    machine: Machine,
) -> FunctionFlow:
    function: Function = mine.function
    loose = frozenset[int]().union(*(function.nest.loops[loop].blocks for loop in mine.loose))
    bounds, problems = {}, []
    for loop in function.nest.loops:
        if not mine.most[loop.id]:
            continue
        entries = sum(mine.counts[edge] for edge in loop.entry_edges) + (loop.header == function.cfg.entry)
        most: int | None = None if loop.id in mine.endless else mine.most[loop.id]
        # Where unknown values decide, a run may go on for longer than an execution.
        if most is None or (most > FEW and loop.id in function.undecided):
            proven = machine.source.bound(function.key, loop.id)
            most = proven if most is None or (proven is not None and proven < most) else most
        if most is None:
            problems.append(_unbounded(cfg, cfg.blocks[loop.header].address))
            continue
        total = None
        if not loop.blocks & loose:
            total = min(entries + sum(mine.counts[edge] for edge in loop.back_edges), entries * most)
        bounds[loop.id] = LoopBound(most, Origin.ANALYSIS, METHOD, total)
    calls = {edge: tuple(sorted(names[callee] for callee in callees)) for edge, callees in mine.calls.items()}
    never = frozenset(index for index, count in enumerate(mine.counts) if not count)
    limits = {
        index: count
        for index, (count, edge) in enumerate(zip(mine.counts, cfg.edges, strict=True))
        if count and edge.source not in loose
    }
    return FunctionFlow(
        cfg,
        function.nest,
        bounds,
        never,
        accesses.get(function.key, {}),
        calls,
        tuple(problems),
        mine.stack,
        limits,
    )


def _unbounded(cfg: Cfg, address: int) -> Problem:
    message = f"no bound was found for the loop at {address:#x} in {cfg.name}"
    return Problem(ProblemKind.LOOP, message, address, cfg.name)


def _accesses(machine: Machine) -> dict[int, dict[tuple[int, int], AddressRange]]:
    """The bytes that each access touched outside the stack, by function."""
    memory = machine.memory
    known = {
        place: AddressRange(memory.low[site], memory.high[site])
        for place, site in machine.sites.numbers.items()
        if site not in memory.wild and memory.high[site] >= 0
    }
    found: dict[int, dict[tuple[int, int], AddressRange]] = {}
    for function in machine.functions.values():
        mine = found[function.key] = {}
        for block in function.cfg.blocks:
            for instruction in block.instructions:
                for index in range(len(instruction.ops)):
                    place = (instruction.address, index)
                    if place in known:
                        mine[place] = known[place]
    return found
