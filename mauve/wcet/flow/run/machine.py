"""The run of a program: functions call each other as the binary says, block by block.

Where a condition depends on an unknown value, the paths are followed apart until they come to the same block in the
same iteration of all loops around it; there they become one path, which covers both. The path that is furthest behind
goes on first, so that as many as possible meet: as in Gustafsson, Ermedahl, Sandberg, Lisper, "Automatic derivation of
loop bounds and infeasible paths for WCET analysis using abstract execution" (RTSS 2006).
"""

from __future__ import annotations

import sys
from heapq import heappop, heappush
from time import monotonic
from typing import Any

from mauve.wcet.binary.graph import EXIT, EdgeKind
from mauve.wcet.binary.microop import CompareBranch, IndirectCall, IndirectJump, Stop
from mauve.wcet.flow.run.behaviour import Behaviours
from mauve.wcet.flow.run.compile import ASKED, ASSUMED, DEPTH, DYNAMIC, RELATED, TARGET, Sites
from mauve.wcet.flow.run.flags import Flags
from mauve.wcet.flow.run.float_text import FLOAT_MODE, SLOTS
from mauve.wcet.flow.run.frames import (
    END,
    Covered,
    Ended,
    Frame,
    Function,
    Impossible,
    Place,
    Several,
    Unresolved,
    Way,
    prepare,
)
from mauve.wcet.flow.run.layers import Layer, branch, release
from mauve.wcet.flow.run.learn import learn
from mauve.wcet.flow.run.long_loops import ASKING, arrive, end_census, starts_of
from mauve.wcet.flow.run.memory import Lost, Memory
from mauve.wcet.flow.run.narrow import Told, told, within
from mauve.wcet.flow.run.paths import Counters, Meeting, Path
from mauve.wcet.flow.run.related import told_apart
from mauve.wcet.flow.run.remembered import ARGUMENTS, MOST_APART, RESULTS, Call, computed, result_of
from mauve.wcet.flow.run.routines import length_at, limits
from mauve.wcet.flow.run.words import UNKNOWN, WILD, Some, Stack, Undecided, Word, fresh, is_wild, made

MOST_DEPTH = 1_500
"""Calls inside each other."""
LONG = 2_000
"""Iterations after which a proof of a loop's bound is asked for where paths have parted."""
OFTEN = 30_000
"""Instructions after which the clock is looked at."""
FORK = 1_000
"""A fork counts as so many instructions."""
UNHURRIED = 2
"""After one part in so many of the work or time that is allowed, loops are followed for all values at once."""
MOST_TARGETS = 64
"""Places that an indirect branch may go to."""
_FRAMES = 40_000
"""How deep Python may nest calls: a call takes a handful of them."""

_GONE = Layer(None)
"""Stands for the memory of no path."""


class Machine:
    """One run. `limit` bounds the work done, in instructions, `deadline` the time (of time.monotonic)."""

    def __init__(self, source: Any, memory: Memory, behaviours: Behaviours, limit: int, deadline: float | None) -> None:
        self.source, self.memory, self.behaviours = source, memory, behaviours
        self.sites = Sites(memory)
        self.functions: dict[int, Function] = {}
        self.registers: list[Any] = []
        self.steps, self.limit, self.deadline, self.look_again = 0, limit, deadline, 0
        now = monotonic()
        self.hurries_at = limit // UNHURRIED, None if deadline is None else now + (deadline - now) / UNHURRIED
        self.targets: dict[int, set[int]] = {}
        self.depth, self.parted, self.hurried = 0, False, False
        self.active: dict[int, int] = {}

    def run(self, entry: int) -> int:
        """Run from an entry (a key) to its return: the number of its behaviour. Raises Lost or Unresolved."""
        self.registers = [*(fresh() for _ in range(16)), *[UNKNOWN] * 8, *(fresh() for _ in range(24, SLOTS))]
        self.registers[13], self.registers[DEPTH], self.registers[FLOAT_MODE] = Stack(0), 0, 0
        self.registers[ASKED] = self.registers[ASSUMED] = None
        self.registers[RELATED] = {}
        before = sys.getrecursionlimit()
        sys.setrecursionlimit(max(before, _FRAMES))
        try:
            return self._call(entry, None)
        except (Ended, Impossible):
            raise Lost("the program does not return") from None
        finally:
            sys.setrecursionlimit(before)

    # ------------------------------------------------------------------------------------------------ calls
    def _function(self, key: int) -> Function:
        if key not in self.functions:
            self.functions[key] = prepare(key, self.source, self.sites)
        return self.functions[key]

    def _call(self, key: int, back: frozenset[int] | None) -> int:
        """Execute a function, or recall what came of it: the number of its behaviour."""
        function = self._function(key)
        if not self.source.enter(key, self.registers, self.memory):
            raise Impossible
        simple = back is not None and len(back) == 1
        arguments = [self.registers[number] for number in ARGUMENTS]
        if not simple or not function.closed or all(type(word) is int for word in arguments):
            length = length_at(arguments[0], self.memory) if function.measures and self.parted else None
            number = self._execute(function, back)[0]
            result = None if length is None else within(self.registers[0], length)
            if result is not None:
                self.registers[0] = result
            return number
        found = next((call for call in function.calls if call.holds_for(self.registers)), None)
        if found is None:
            found, number = self._remember(function, back)
            if found is None:
                return number
        else:
            self._recall(found)
        if function.helper is not None:
            for register, values in enumerate(computed(function.helper, *arguments[:2])):
                word = self.registers[register]
                if values is not None and type(word) is Some:
                    self.registers[register] = within(word, values)
        return found.behaviour

    def _remember(self, function: Function, back: frozenset[int] | None) -> tuple[Call | None, int]:
        """Execute a closed function, once for all arguments if it was often executed for some; what came of it."""
        if len(function.calls) >= MOST_APART:
            for number in ARGUMENTS:
                if not is_wild(self.registers[number]):
                    self.registers[number] = fresh()
        before, top = self.registers[:], self.memory.top_read
        self.memory.top_read = -(1 << 62)
        number, used = self._execute(function, back)
        own = self.memory.top_read < before[13].offset if type(before[13]) is Stack else False
        self.memory.top_read = max(self.memory.top_read, top)
        found = result_of(before, self.registers, number, used) if own else None
        if found is not None:
            function.calls.append(found)
        return found, number

    def _recall(self, found: Call) -> None:
        """Put the results of a call into the registers."""
        registers = self.registers
        for number, values in zip(RESULTS, found.results, strict=True):
            registers[number] = made(values)
        registers[14] = fresh()
        registers[16:20] = [UNKNOWN] * 4
        if type(registers[13]) is Stack:
            registers[DEPTH] = min(registers[DEPTH], registers[13].offset - found.used)

    def _execute(self, function: Function, back: frozenset[int] | None) -> tuple[int, int]:
        """Execute a function: its behaviour and the bytes of stack that it used."""
        loops = len(function.nest.loops)
        frame = Frame(function, Counters([0] * len(function.cfg.edges), [0] * loops, [0] * loops, {}), back)
        for loop in function.nest.loops:
            if loop.header == function.cfg.entry:
                frame.now.current[loop.id] = frame.now.most[loop.id] = 1
        if function.routine and self.parted:
            frame.limits = limits(function.routine, self.registers, self.memory)
        depth, sp = self.registers[DEPTH], self.registers[13]
        self.registers[DEPTH] = start = sp.offset if type(sp) is Stack else 0
        self.depth += 1
        if self.depth > MOST_DEPTH:
            raise Lost("calls are nested too deeply")
        level = self.active[function.group] = self.active.get(function.group, 0) + 1
        try:
            self._follow(frame, function.cfg.entry)
        finally:
            for path in frame.kept.values():
                release(path.path.layer)
            self.active[function.group] = level - 1
            self.depth -= 1
        used = start - self.registers[DEPTH]
        self.registers[DEPTH] = min(depth, self.registers[DEPTH])
        return self.behaviours.note(function, level, frame, used), used

    # ------------------------------------------------------------------------------------------------ blocks
    def _follow(self, frame: Frame, block: int) -> None:
        """Go on from a block until all paths have left the function."""
        function, registers = frame.function, self.registers
        blocks, sizes, plain, counts = function.code.blocks, function.sizes, function.plain, frame.now.counts
        while True:
            self.steps += sizes[block]
            try:
                edge = blocks[block](registers)
                if edge < 0:
                    edge = self._dynamic(frame, block)
                target = plain[edge]
                if target is None:
                    block = self._pass(frame, block, Way(edge))
                else:
                    counts[edge] += 1
                    block = target
            except (Undecided, Several) as open_:
                self._fork(frame, block, open_.args if type(open_) is Several else ())
                block = self._next(frame)
            except (Ended, Impossible) as over:
                if not frame.waiting:
                    raise
                self._leave(frame, counts=type(over) is Ended)
                block = self._next(frame)
            else:
                if frame.waiting or self.hurried:
                    block = self._meet(frame, block)
            if block == EXIT:
                break
            registers, counts = self.registers, frame.now.counts
        if frame.ended is not None:
            frame.now.join(frame.ended)
        end_census(frame)
        for loop, limit in frame.proven.items():
            frame.now.most[loop] = max(frame.now.most[loop], limit)

    def _check_time(self) -> None:
        self.look_again = self.steps + OFTEN
        if self.steps > self.limit:
            raise Lost("the run takes more steps than allowed")
        now, (steps, time) = monotonic(), self.hurries_at
        if self.deadline is not None and now > self.deadline:
            raise Lost("the run takes more time than allowed")
        self.hurried = self.parted and (self.hurried or self.steps > steps or (time is not None and now > time))

    def _pass(self, frame: Frame, block: int, way: Way) -> int:
        """Pass along an edge that does more than lead on."""
        function, index = frame.function, way.edge
        edge = function.cfg.edges[index]
        if edge.kind is EdgeKind.STOP:
            frame.now.counts[index] += 1
            if not edge.callees and not isinstance(function.cfg.blocks[block].instructions[-1].flow, Stop):
                place = function.cfg.blocks[block].instructions[-1].address
                raise Lost(f"control leaves the code that is known at {place:#x} in {function.cfg.name}")
            raise Ended
        if edge.target == block and function.sizes[block] == 1 and not function.cfg.blocks[block].instructions[0].ops:
            raise Ended
        if edge.kind is EdgeKind.CALL:
            index = self._through(frame, block, index, way.through is not None)
            edge = function.cfg.edges[index]
        now = frame.now
        for loop in function.repeats.get(index, ()):
            self._repeat(frame, loop)
        now.counts[index] += 1
        for loop in function.starts.get(index, ()):
            if frame.census is not None and frame.census.loop == loop:
                end_census(frame)
            now.current[loop] = 1
            now.most[loop] = max(now.most[loop], 1)
            frame.open[loop] = 0
            kept = frame.kept.pop(loop, None)
            if kept is not None:
                release(kept.path.layer)
        if edge.kind is EdgeKind.TAIL_CALL:
            self._note(frame, index, self._call(self._callee(edge.callees), frame.back))
        if self.steps > self.look_again:
            self._check_time()
        return edge.target

    def _repeat(self, frame: Frame, loop: int) -> None:
        """One more iteration of a loop. Raises Impossible where a proof says that there is none."""
        now = frame.now
        count = now.current[loop] + 1
        # A path with values that no execution has may go on for ever.
        asks = frame.open.get(loop, 0) > ASKING or (count % LONG == 0 and self.parted)
        if asks or loop in frame.function.limits or loop in frame.limits:
            limit = self.limit_of(frame, loop)
            if limit is not None and count > limit:
                raise Impossible
        now.current[loop] = count
        if count > now.most[loop]:
            now.most[loop] = count

    def limit_of(self, frame: Frame, loop: int) -> int | None:
        """A bound of a loop: for the arguments of this call, or whatever the function is called with."""
        function = frame.function
        if loop in frame.limits:
            return min(frame.limits[loop], function.limits.get(loop) or frame.limits[loop])
        if loop not in function.limits:
            function.limits[loop] = self.source.bound(function.key, loop)
        return function.limits[loop]

    def _callee(self, callees: tuple[int, ...]) -> int:
        if len(callees) == 1:
            return callees[0]
        target = self.registers[TARGET]
        if type(target) is not int:
            raise Several(*self._choices(target))
        for key in callees:
            if key & ~1 == target & ~1:
                return key
        raise Lost("a call goes to no known function")

    def _choices(self, target: Word) -> tuple[int, ...]:
        """The places to which a pointer may lead. Raises Lost."""
        if type(target) is Some and target.range.size <= MOST_TARGETS:
            return tuple(target.range.members())
        raise Lost("control goes through an unknown pointer")

    def _through(self, frame: Frame, block: int, index: int, chosen: bool) -> int:
        """Make the call of an edge: the edge on which control comes back (a helper may come back elsewhere)."""
        function = frame.function
        edges = function.cfg.edges
        callees = edges[index].callees
        flow = function.cfg.blocks[block].instructions[-1].flow
        if isinstance(flow, IndirectCall | IndirectJump):
            target = self.registers[TARGET]
            if type(target) is not int:
                raise Several(*self._choices(target))
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
        if len(places) < 2 or chosen:
            self._note(frame, index, self._call(key, frozenset(places)))
            return index
        before, layer = self.registers[:], self.memory.layer
        self.memory.enter(Layer(layer))
        behaviour = self._call(key, frozenset(places))
        arrived = self.registers[TARGET]
        if type(arrived) is not int:
            self._drop()
            self.registers = before
            self.memory.enter(layer)
            raise Undecided
        release(layer)
        index = places[arrived & ~1]
        self._note(frame, index, behaviour)
        return index

    def _note(self, frame: Frame, index: int, behaviour: int) -> None:
        """Remember what was called on an edge."""
        known = frame.now.calls.get(index)
        if known is None:
            frame.now.calls[index] = frozenset((behaviour,))
        elif behaviour not in known:
            frame.now.calls[index] = known | {behaviour}

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
            if type(target) is Some and target.range.size <= MOST_TARGETS:
                raise Several(*target.range.members())
            if all(edges[way].kind is EdgeKind.SWITCH for way in ways) and ways and not is_wild(target):
                raise Several(*(function.cfg.blocks[edges[way].target].address for way in ways))
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

    # ------------------------------------------------------------------------------------------------ paths
    def _place(self, frame: Frame, block: int) -> Place:
        if block == EXIT:
            return END
        loops, last = frame.function.around[block]
        if not loops:
            return (last,)
        place: list[int] = []
        for where, loop in loops:
            place += (where, frame.now.current[loop])
        place.append(last)
        if frame.census is not None and block in frame.census.blocks:
            place.append(frame.now.trail)
        return tuple(place)

    def _meet(self, frame: Frame, block: int) -> int:
        """Come to a block while other paths wait: go on with the path that is furthest behind."""
        place = self._place(frame, block)
        if not frame.places or place < frame.places[0]:
            try:
                return arrive(self, frame, block)
            except Covered:
                self._leave(frame, counts=True)
        else:
            self._wait(frame, block, place)
        return self._next(frame)

    def _wait(self, frame: Frame, block: int, place: Place) -> None:
        """Let the path that is followed wait at a block, together with one that waits there already."""
        path = Path(block, self.registers, self.memory.layer, frame.now)
        for register in frame.function.dead[block] if block != EXIT else ():
            self.registers[register] = WILD
        other = frame.waiting.get(place)
        if other is None:
            frame.waiting[place] = path
            heappush(frame.places, place)
        else:
            frame.waiting[place] = Meeting(self.memory).join(
                other, path, frame.function.compared.pairs, starts_of(frame, path.block)
            )

    def _next(self, frame: Frame) -> int:
        """Go on with the path that is furthest behind: the block where it is. Raises Ended where no path is left."""
        while frame.places:
            path = frame.waiting.pop(heappop(frame.places))
            self.take(frame, path)
            try:
                return arrive(self, frame, path.block)
            except Covered:
                self._leave(frame, counts=True)
        raise Ended

    def take(self, frame: Frame, path: Path) -> None:
        """Go on with a path."""
        self.registers, frame.now = path.registers, path.counters
        self.memory.enter(path.layer)

    def _drop(self) -> None:
        """Nothing needs the memory of the path that was followed any more."""
        if self.memory.layer is not _GONE:
            release(self.memory.layer)
            self.memory.layer = _GONE

    def _leave(self, frame: Frame, *, counts: bool) -> None:
        """The path that is followed does not go on; what an execution did on it `counts` if there is one."""
        self._drop()
        if counts:
            if frame.ended is None:
                frame.ended = frame.now
            else:
                frame.ended.join(frame.now)

    def _fork(self, frame: Frame, block: int, targets: tuple[int, ...]) -> None:
        """Make all ways on from a block paths that wait."""
        self.steps += FORK
        if self.steps > self.look_again:
            self._check_time()
        asked = self.registers[ASKED] or (None, 0, False)
        self.registers[ASKED] = None
        self.parted = True
        if frame.function.key in self.source.unstructured:
            raise Lost(f"{frame.function.cfg.name} has loops with several entries")
        self._count_open(frame, block)
        if len(asked) > 3:
            self._run_apart(frame, block, *asked)
            return
        self.registers[ASSUMED] = None
        flags, code, negated = asked
        start, layer, now = self.registers, self.memory.layer, frame.now
        ways = [Way(DYNAMIC, target=target) for target in targets] or self._ways(frame, block)
        for way in ways:
            found: Told = []
            related = start[RELATED]
            if way.holds is not None and flags is not None:
                holds = way.holds != negated
                alone, apart = told(flags, code, holds), told_apart(flags, code, holds, related)
                if alone is None or apart is None:
                    continue
                found, related = alone + apart[0], apart[1]
            self.registers, frame.now = start[:], now.copy()
            self._part(frame, block)
            self.memory.enter(branch(layer))
            self.registers[RELATED] = related
            learn(self.registers, self.memory, found)
            ways += self._try(frame, block, way, ways)
        release(layer)

    def _run_apart(self, frame: Frame, block: int, flags: Flags | None, code: int, negated: bool, number: int) -> None:
        """Run a block again from its start, for each answer of a condition inside it."""
        start, layer, now = self.registers, self.memory.layer, frame.now
        for answer in (True, False):
            if flags is not None and told(flags, code, answer != negated) is None:
                continue
            self.registers, frame.now = start[:], now.copy()
            self._part(frame, block)
            self.registers[ASSUMED] = {**(start[ASSUMED] or {}), number: answer}
            self.memory.enter(branch(layer))
            try:
                edge = frame.function.code.blocks[block](self.registers)
                self.registers[ASSUMED] = None
                arrived = self._along(frame, block, self._dynamic(frame, block) if edge < 0 else edge, None)
            except (Undecided, Several) as open_:
                self._fork(frame, block, open_.args if type(open_) is Several else ())
            except (Ended, Impossible) as over:
                self._leave(frame, counts=type(over) is Ended)
            else:
                self._wait(frame, arrived, self._place(frame, arrived))
        release(layer)

    def _part(self, frame: Frame, block: int) -> None:
        """Give a way a trail of its own where paths part in a loop of which each way is followed apart."""
        around = frame.function.around[block][0]
        if frame.census is not None and around and around[-1][1] == frame.census.loop:
            frame.now.trail = frame.census.next_trail()

    def _try(self, frame: Frame, block: int, way: Way, ways: list[Way]) -> list[Way]:
        """Go one way on from a block, to where the path waits; ways that turn out to be open instead."""
        more: list[Way] = []
        try:
            arrived = self._go(frame, block, way)
        except (Ended, Impossible) as over:
            self._leave(frame, counts=type(over) is Ended)
        except Several as open_:
            self._drop()
            more = [Way(way.edge, way.holds, target) for target in open_.args]
        except Undecided:
            self._drop()
            more = [Way(DYNAMIC, way.holds, way.target, edge) for edge in frame.function.order.taken[block]]
        else:
            self._wait(frame, arrived, self._place(frame, arrived))
        return [one for one in more if one not in ways]

    def _go(self, frame: Frame, block: int, way: Way) -> int:
        """Go one way on from a block."""
        edge = way.edge
        if edge == DYNAMIC:
            taken = frame.function.code.last[block]
            if taken is not None and way.holds is not None:
                edge = taken(self.registers)
            if way.target is not None:
                self.registers[TARGET] = way.target
            if edge < 0:
                edge = self._dynamic(frame, block) if way.through is None else way.through
        elif way.target is not None:
            self.registers[TARGET] = way.target
        return self._along(frame, block, edge, way.through)

    def _along(self, frame: Frame, block: int, edge: int, through: int | None) -> int:
        """Pass along an edge: the block where it ends."""
        target = frame.function.plain[edge]
        if target is None:
            return self._pass(frame, block, Way(edge, through=through))
        frame.now.counts[edge] += 1
        return target

    def _ways(self, frame: Frame, block: int) -> list[Way]:
        """The edges on which control may leave a block; DYNAMIC for what its last instruction does first."""
        order = frame.function.order
        last = frame.function.cfg.blocks[block].instructions[-1]
        taken = [Way(edge, True) for edge in order.taken[block]]
        fall = [Way(edge, False) for edge in order.fall[block]]
        if isinstance(last.flow, CompareBranch):
            return taken + fall
        if not fall:
            return [Way(way.edge) for way in taken]
        return [*fall, Way(DYNAMIC, True)] if frame.function.code.last[block] is not None else taken + fall

    # ------------------------------------------------------------------------------------------------ long loops
    def _count_open(self, frame: Frame, block: int) -> None:
        """Note for the loops that are left from a block that an unknown value does not end them."""
        for loop in frame.function.exits.get(block, ()):
            frame.open[loop] = frame.open.get(loop, 0) + 1
            frame.function.undecided.add(loop)


__all__ = ["Machine"]
