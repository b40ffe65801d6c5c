"""The run of a program: functions call each other as the binary says, block by block, and every path that an unknown
value leaves open is followed up to where the paths meet again."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

from mauve.wcet.binary.graph import EXIT, Cfg, EdgeKind
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.binary.microop import (
    CompareBranch,
    IndirectCall,
    IndirectJump,
    Stop,
    Store,
    StoreUnknown,
)
from mauve.wcet.flow.order import Order
from mauve.wcet.flow.run.behaviour import Behaviours
from mauve.wcet.flow.run.compile import DEPTH, DYNAMIC, TARGET, Compiled, Sites, compile_function
from mauve.wcet.flow.run.float_text import FLOAT_MODE, SLOTS, written
from mauve.wcet.flow.run.meeting import meeting_points
from mauve.wcet.flow.run.memory import Cell, Lost, Memory
from mauve.wcet.flow.run.words import UNKNOWN, Stack, Undecided, merge

MOST_DEPTH, MOST_FORKS = 1_500, 2_000
"""Calls, and decisions left open, inside each other."""
PATIENCE = 70
"""Decisions inside each other that a branch may leave open before its loop is summarised."""
_FRAMES = 40_000
"""How deep Python may nest calls: a call or a decision takes a handful of them."""


class Ended(Exception):
    """A path that does not come back: it ends in a trap or in a function that does not return."""


class Unresolved(Exception):
    """Control goes where the graphs have no edge: `args` are the address of the branch and the target, as a key."""


@dataclass(slots=True)
class Function:
    """A function made ready. `plain[edge]` is the target of an edge that only leads from block to block, None for one
    that counts for loops, calls or leaves; `starts` and `repeats` are the loops that an edge enters and repeats."""

    key: int
    cfg: Cfg
    nest: LoopNest
    order: Order
    code: Compiled
    sizes: list[int]
    plain: list[int | None]
    starts: dict[int, list[int]]
    repeats: dict[int, list[int]]
    group: int
    meetings: list[int] | None = None


@dataclass(slots=True)
class Frame:
    """One execution of a function: how often each edge was passed, the executions of each loop's header since it was
    entered and the most of them, what was called, and where it may return to (addresses; None: anywhere)."""

    function: Function
    counts: list[int]
    current: list[int]
    most: list[int]
    calls: dict[int, frozenset[int]] = field(default_factory=dict)
    back: frozenset[int] | None = None
    open: dict[int, int] = field(default_factory=dict)
    """decisions inside each other that each block has left open"""

    def snapshot(self) -> tuple[list[int], list[int], list[int], dict[int, frozenset[int]]]:
        """The counters."""
        return self.counts.copy(), self.current.copy(), self.most.copy(), self.calls.copy()


class Machine:
    """One run. `limit` bounds the instructions executed, `deadline` the time (of time.monotonic). `forked` are the
    blocks, by function, from which several ways were followed."""

    def __init__(
        self, source: Any, memory: Memory, behaviours: Behaviours, limit: int, deadline: float | None
    ) -> None:
        self.source, self.memory, self.behaviours = source, memory, behaviours
        self.sites = Sites(memory)
        self.functions: dict[int, Function] = {}
        self.registers: list[Any] = [UNKNOWN] * SLOTS
        self.registers[13] = Stack(0)
        self.registers[FLOAT_MODE] = 0
        self.steps, self.limit, self.deadline = 0, limit, deadline
        self.targets: dict[int, set[int]] = {}
        self.depth = self.forks = 0
        self.forked: set[tuple[int, int]] = set()
        self.active: dict[int, int] = {}

    def run(self, entry: int) -> int:
        """Run from an entry (a key) to its return: the number of its behaviour. Raises Lost or Unresolved."""
        before = sys.getrecursionlimit()
        sys.setrecursionlimit(max(before, _FRAMES))
        try:
            return self._call(entry, None)
        except Ended:
            raise Lost("the program does not return") from None
        finally:
            sys.setrecursionlimit(before)

    # ------------------------------------------------------------------------------------------------ calls
    def _call(self, key: int, back: frozenset[int] | None) -> int:
        function = self.functions.get(key) or self._prepare(key)
        frame = Frame(
            function,
            [0] * len(function.cfg.edges),
            [0] * len(function.nest.loops),
            [0] * len(function.nest.loops),
            back=back,
        )
        for loop in function.nest.loops:
            if loop.header == function.cfg.entry:
                frame.current[loop.id] = frame.most[loop.id] = 1
        registers = self.registers
        depth, sp = registers[DEPTH], registers[13]
        registers[DEPTH] = start = sp.offset if type(sp) is Stack else 0
        self.depth += 1
        if self.depth > MOST_DEPTH:
            raise Lost("calls are nested too deeply")
        level = self.active[function.group] = self.active.get(function.group, 0) + 1
        self._follow(frame, function.cfg.entry, None)
        self.active[function.group] = level - 1
        self.depth -= 1
        used = start - registers[DEPTH]
        registers[DEPTH] = depth
        return self.behaviours.note(function, level, frame, used)

    def _prepare(self, key: int) -> Function:
        cfg, nest, order, group = self.source.function(key)
        if nest.irreducible or not cfg.blocks:
            raise Lost(f"{cfg.name} has loops with several entries" if cfg.blocks else f"{cfg.name} is no code")
        starts: dict[int, list[int]] = {}
        repeats: dict[int, list[int]] = {}
        for loop in nest.loops:
            for edge in loop.entry_edges:
                starts.setdefault(edge, []).append(loop.id)
            for edge in loop.back_edges:
                repeats.setdefault(edge, []).append(loop.id)
        plain: list[int | None] = []
        for index, edge in enumerate(cfg.edges):
            through = edge.kind in (EdgeKind.FALL, EdgeKind.TAKEN, EdgeKind.SWITCH)
            special = index in starts or index in repeats or not through or edge.target == EXIT
            plain.append(None if special else edge.target)
        sizes = [len(block.instructions) for block in cfg.blocks]
        code = compile_function(order, self.sites)
        made = Function(key, cfg, nest, order, code, sizes, plain, starts, repeats, group)
        self.functions[key] = made
        return made

    # ------------------------------------------------------------------------------------------------ blocks
    def _follow(self, frame: Frame, block: int, stop: int | None) -> int:
        """Go on from a block until control leaves the function (EXIT) or comes to the block `stop`."""
        function, registers = frame.function, self.registers
        blocks, sizes, plain, counts = function.code.blocks, function.sizes, function.plain, frame.counts
        while True:
            self.steps += sizes[block]
            if self.steps > self.limit:
                self._check_time()
            try:
                edge = blocks[block](registers)
                if edge < 0:
                    edge = self._dynamic(frame, block)
            except Undecided:
                block = self._fork(frame, block)
                counts = frame.counts
            else:
                target = plain[edge]
                if target is None:
                    try:
                        block = self._pass(frame, block, edge)
                    except Undecided:
                        block = self._fork(frame, block)
                        counts = frame.counts
                else:
                    counts[edge] += 1
                    block = target
            if block in (stop, EXIT):
                return block

    def _check_time(self) -> None:
        raise Lost("the run takes more steps than allowed")

    def _pass(self, frame: Frame, block: int, index: int, chosen: bool = False) -> int:
        """Pass along an edge that does more than lead on; `chosen`: that one, where a call may come back on several."""
        function = frame.function
        edge = function.cfg.edges[index]
        if edge.kind is EdgeKind.STOP:
            frame.counts[index] += 1
            if not edge.callees and not isinstance(function.cfg.blocks[block].instructions[-1].flow, Stop):
                place = function.cfg.blocks[block].instructions[-1].address
                raise Lost(f"control leaves the code that is known at {place:#x} in {function.cfg.name}")
            raise Ended
        if edge.target == block and function.sizes[block] == 1 and not function.cfg.blocks[block].instructions[0].ops:
            raise Ended
        if edge.kind is EdgeKind.CALL:
            index = self._through(frame, block, index, chosen)
            edge = function.cfg.edges[index]
        frame.counts[index] += 1
        for loop in function.starts.get(index, ()):
            frame.current[loop] = 1
            frame.most[loop] = max(frame.most[loop], 1)
        for loop in function.repeats.get(index, ()):
            frame.current[loop] += 1
            if frame.current[loop] > frame.most[loop]:
                frame.most[loop] = frame.current[loop]
        if edge.kind is EdgeKind.TAIL_CALL:
            self._note(frame, index, self._call(self._callee(edge.callees), frame.back))
        if self.deadline is not None and self.steps & 15 == 0 and monotonic() > self.deadline:
            raise Lost("the run takes more time than allowed")
        return edge.target

    def _callee(self, callees: tuple[int, ...]) -> int:
        if len(callees) == 1:
            return callees[0]
        target = self.registers[TARGET]
        if type(target) is not int:
            raise Lost("a call goes through an unknown pointer")
        for key in callees:
            if key & ~1 == target & ~1:
                return key
        raise Lost("a call goes to no known function")

    def _through(self, frame: Frame, block: int, index: int, chosen: bool) -> int:
        """Make the call of an edge: the edge on which control comes back (a helper may come back elsewhere)."""
        function = frame.function
        edges = function.cfg.edges
        callees = edges[index].callees
        flow = function.cfg.blocks[block].instructions[-1].flow
        if isinstance(flow, IndirectCall | IndirectJump):
            target = self.registers[TARGET]
            if type(target) is not int:
                raise Lost("a call goes through an unknown pointer")
            address = function.cfg.blocks[block].instructions[-1].address
            known = next((key for key in callees if key & ~1 == target & ~1), None)
            exchanges = flow.exchanges
            key = known if known is not None else (target if exchanges else target & ~1 | function.cfg.thumb)
            if known is None:
                self.targets.setdefault(address, set()).add(key)
        else:
            key = self._callee(callees)
        ways = [i for i in function.order.taken[block] if edges[i].kind is EdgeKind.CALL and edges[i].target != EXIT]
        places = {function.cfg.blocks[edges[i].target].address: i for i in ways}
        before = self.registers[:] if len(places) > 1 else None
        behaviour = self._call(key, frozenset(places))
        if before is not None:
            arrived = self.registers[TARGET]
            if type(arrived) is int:
                index = places[arrived & ~1]
            elif not chosen:
                self.registers[:] = before
                raise Undecided
        self._note(frame, index, behaviour)
        return index

    def _note(self, frame: Frame, index: int, behaviour: int) -> None:
        """Remember what was called on an edge."""
        known = frame.calls.get(index)
        if known is None:
            frame.calls[index] = frozenset((behaviour,))
        elif behaviour not in known:
            frame.calls[index] = known | {behaviour}

    def _dynamic(self, frame: Frame, block: int) -> int:
        """The edge to where an indirect branch goes. Raises Undecided where that depends on an unknown."""
        function, target = frame.function, self.registers[TARGET]
        edges, ways = function.cfg.edges, function.order.taken[block]
        last = function.cfg.blocks[block].instructions[-1]
        if target is None and ways:
            return ways[0]
        if all(edges[way].kind is EdgeKind.CALL for way in ways) and ways:
            return ways[0]
        if type(target) is not int:
            # Only the entry of the program, or a function that ends in one of those, comes back to an unknown place.
            back = next((way for way in ways if edges[way].kind is EdgeKind.RETURN), None)
            if back is not None and (frame.back is None or len(frame.back) > 1):
                return back
            if all(edges[way].kind is EdgeKind.SWITCH for way in ways) and ways:
                raise Undecided
            raise Lost("a branch goes to an unknown place")
        for way in ways:
            edge = edges[way]
            if edge.kind is EdgeKind.SWITCH and function.cfg.blocks[edge.target].address == target & ~1:
                return way
            if edge.kind is EdgeKind.RETURN and frame.back is not None and target & ~1 in frame.back:
                return way
            if edge.kind is not EdgeKind.FALL and any(key & ~1 == target & ~1 for key in edge.callees):
                return way
        exchanges = isinstance(last.flow, IndirectJump | IndirectCall) and last.flow.exchanges
        raise Unresolved(last.address, target if exchanges else target & ~1 | last.thumb)

    # ------------------------------------------------------------------------------------------------ forks
    def _fork(self, frame: Frame, block: int) -> int:
        """Follow all ways on from a block to where they meet, and go on there with what holds on all of them."""
        function, registers, memory = frame.function, self.registers, self.memory
        if function.meetings is None:
            function.meetings = meeting_points(function.cfg)
        meeting = function.meetings[block]
        self.forks += 1
        self.forked.add((function.key, block))
        if self.forks > MOST_FORKS:
            raise Lost("a loop goes on for as long as an unknown value says")
        frame.open[block] = frame.open.get(block, 0) + 1
        ways: list[tuple[int, int | None]] = [(way, None) for way in self._ways(frame, block)]
        if frame.open[block] >= PATIENCE and (leaving := self._summarise(frame, block)):
            ways = [(way, None) for way in leaving]
        start, counters, outer = registers[:], frame.snapshot(), memory.journal
        sides = []
        for way, through in ways:
            registers[:] = start
            frame.counts, frame.current, frame.most = (part.copy() for part in counters[:3])
            frame.calls = counters[3].copy()
            journal: dict[int, Cell | None] = {}
            memory.journal = journal
            comes = True
            try:
                self._side(frame, block, way, through, meeting)
            except Ended:
                comes = False
            except Undecided:
                ways += [(DYNAMIC, edge) for edge in function.order.taken[block]]
                continue
            left = {key: memory.cells.get(key) for key in journal}
            for key, value in journal.items():
                if value is None:
                    memory.cells.pop(key, None)
                else:
                    memory.cells[key] = value
            sides.append((comes, registers[:], frame.snapshot(), journal, left))
        memory.journal = outer
        self.forks -= 1
        frame.open[block] -= 1
        self._meet(frame, sides)
        return meeting

    def _summarise(self, frame: Frame, block: int) -> list[int]:
        """Make one step of a loop that goes on for as long as an unknown value says, where a bound is known anyhow and
        it changes nothing but registers: the edges on which it is left; none where that cannot be done."""
        function = frame.function
        around = [loop for loop in function.nest.loops if block in loop.blocks]
        loop = max(around, key=lambda loop: loop.depth, default=None)
        if loop is None or any(other.parent == loop.id for other in function.nest.loops):
            return []
        changed = set(range(16, 20))
        for member in loop.blocks:
            for instruction in function.cfg.blocks[member].instructions:
                if any(isinstance(op, Store | StoreUnknown) for op in instruction.ops):
                    return []
                changed |= written(instruction)
        if 13 in changed:
            return []
        inside = [i for i, edge in enumerate(function.cfg.edges) if edge.source in loop.blocks]
        if any(function.cfg.edges[i].kind is EdgeKind.CALL for i in inside):
            return []
        bound = self.source.bound(function.key, loop.id)
        if bound is None:
            return []
        for register in changed:
            self.registers[register] = UNKNOWN
        for index in inside:
            frame.counts[index] += bound
        frame.most[loop.id] = max(frame.most[loop.id], bound)
        return [i for i in inside if function.cfg.edges[i].target not in loop.blocks]

    def _side(self, frame: Frame, block: int, way: int, through: int | None, meeting: int) -> None:
        """Go one way from a block to the meeting point; `through` is the edge of a branch to an unknown place."""
        depth, active = self.depth, self.active.copy()
        try:
            index = way
            if way == DYNAMIC:
                taken = frame.function.code.last[block]
                assert taken is not None
                index = taken(self.registers)
                if index < 0:
                    index = self._dynamic(frame, block) if through is None else through
            target = self._pass(frame, block, index, True)
            if target not in (meeting, EXIT):
                self._follow(frame, target, meeting)
        finally:
            self.depth, self.active = depth, active

    def _ways(self, frame: Frame, block: int) -> list[int]:
        """The edges on which control may leave a block; DYNAMIC for what its last instruction does first."""
        order = frame.function.order
        last = frame.function.cfg.blocks[block].instructions[-1]
        taken, fall = list(order.taken[block]), list(order.fall[block])
        if isinstance(last.flow, CompareBranch) or not fall:
            return taken + fall
        return [*fall, DYNAMIC] if frame.function.code.last[block] is not None else taken + fall

    def _meet(self, frame: Frame, sides: list[Any]) -> None:
        comes = [side for side in sides if side[0]]
        counters = [side[2] for side in sides]
        frame.counts = [max(values) for values in zip(*(c[0] for c in counters), strict=True)]
        frame.current = [max(values) for values in zip(*(c[1] for c in counters), strict=True)]
        frame.most = [max(values) for values in zip(*(c[2] for c in counters), strict=True)]
        frame.calls = {}
        for found in counters:
            for edge, callees in found[3].items():
                frame.calls[edge] = frame.calls.get(edge, frozenset()) | callees
        if not comes:
            raise Ended
        first = comes[0][1]
        for _, registers, _, _, _ in comes[1:]:
            depth = min(first[DEPTH], registers[DEPTH])
            first = [merge(a, b) for a, b in zip(first, registers, strict=True)]
            first[DEPTH] = depth
        self.registers[:] = first
        self.memory.join([side[3] for side in comes], [side[4] for side in comes])


__all__ = ["Machine", "Unresolved"]
