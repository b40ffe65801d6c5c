"""From a binary to the contexts of its functions by running it: `run_program`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from mauve.wcet.binary.callgraph import order
from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.binary.microop import Call
from mauve.wcet.flow.order import Order, arrange
from mauve.wcet.flow.result import AddressRange, ContextKey, FunctionFlow, LoopBound
from mauve.wcet.flow.run.behaviour import MOST, Behaviour, Behaviours
from mauve.wcet.flow.run.machine import Function, Machine, Unresolved
from mauve.wcet.flow.run.memory import Lost, Memory
from mauve.wcet.result import Origin

STEPS = 25_000_000
"""Instructions that a run may execute."""

METHOD = "run from the linked data"


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

    def bound_anyhow(self, key: int, loop: int) -> int | None:
        """Executions of a loop's header per entry, whatever the function is called with."""


class Source:
    """The functions of a binary, made ready when they are first called."""

    def __init__(self, functions: Functions, entry: int) -> None:
        self.binary, self._functions = functions.binary, functions
        self.cfgs = dict(functions.graphs_from(entry))
        self._groups = {key: number for number, c in enumerate(order(self.cfgs).cycles) for key in c.members}

    def function(self, key: int) -> tuple[Cfg, LoopNest, Order, int]:
        """The graph of a function, its loops, its order, and a number it shares with those it recurses with."""
        if key not in self.cfgs:
            if self.binary.read_code(key & ~1, 2) is None:
                raise Lost("a call goes to no code")
            self.cfgs |= self._functions.graphs_from(key)
        cfg, nest = self.cfgs[key], self._functions.nest(key)
        return cfg, nest, arrange(cfg, nest), self._groups.get(key, -1 - key)

    def bound(self, key: int, loop: int) -> int | None:
        """See Functions.bound_anyhow."""
        return self._functions.bound_anyhow(key, loop)

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
    unknown: Sequence[tuple[int, int]] = (),
) -> Ran:
    """Run a program from `entry` (a key) with its linked data, unknown registers and an unknown stack; `most` contexts
    of a function are told apart. `unknown` are stretches of data of which the linked content does not count."""
    memory, behaviours = Memory(source.binary, source.unaligned, unknown), Behaviours(most)
    machine = Machine(source, memory, behaviours, STEPS, deadline)
    key: ContextKey = (entry, "")
    try:
        number = machine.run(entry)
    except Lost as lost:
        return Ran(None, key, _found(machine), str(lost))
    except Unresolved as unresolved:
        address, target = unresolved.args
        machine.targets.setdefault(address, set()).add(target)
        return Ran(None, key, _found(machine), "a branch leaves the graphs")
    settled = behaviours.settle(number)
    if settled is None:
        return Ran(None, key, _found(machine), "calls go round in circles")
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
                replace(edge, callees=tuple(sorted(found[index]))) if index in found and not edge.callees else edge
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
    bounds = {}
    for loop in function.nest.loops:
        if mine.most[loop.id]:
            entries = sum(mine.counts[edge] for edge in loop.entry_edges) + (loop.header == function.cfg.entry)
            total = entries + sum(mine.counts[edge] for edge in loop.back_edges)
            most = mine.most[loop.id]
            # Where unknown values decide, a run goes on for longer than an execution may.
            if any((function.key, block) in machine.forked for block in loop.blocks):
                most = min(most, machine.source.bound(function.key, loop.id) or most)
            bounds[loop.id] = LoopBound(most, Origin.ANALYSIS, METHOD, min(total, entries * most))
    calls = {edge: tuple(sorted(names[callee] for callee in callees)) for edge, callees in mine.calls.items()}
    never = frozenset(index for index, count in enumerate(mine.counts) if not count)
    return FunctionFlow(
        cfg,
        function.nest,
        bounds,
        never,
        accesses.get(function.key, {}),
        calls,
        (),
        mine.stack,
    )


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
