"""Abstract execution of a function: every loop either iteration by iteration, or once with a header that holds all
iterations.

Stepped loops give exact counts (triangular nests included) at the price of their length; summarised loops (`Header`)
cost a few passes whatever their length and get their bounds in closed form. Which loop is treated how is decided by
the caller and by a budget of steps: a stepped loop that exceeds its share is summarised instead.
"""

from __future__ import annotations

from collections.abc import Sequence

from mauve.wcet.binary.graph import EXIT, Edge, EdgeKind
from mauve.wcet.binary.microop import (
    SP,
    CompareBranch,
    Condition,
    FlagKind,
    Imm,
    IndirectCall,
    IndirectJump,
    Instruction,
    Load,
    MicroOp,
    Next,
    Store,
    TableJump,
)
from mauve.wcet.clock import check
from mauve.wcet.flow import closed_form, domain, flags, joining, linear
from mauve.wcet.flow.closed_form import Stay
from mauve.wcet.flow.domain import Range
from mauve.wcet.flow.image import Image
from mauve.wcet.flow.joining import Header, Place
from mauve.wcet.flow.linear import FIRST_FRESH, FRAME, Value
from mauve.wcet.flow.order import FUNCTION, Order
from mauve.wcet.flow.progress import Exits, Marks, stands_still
from mauve.wcet.flow.record import Calls, Exhausted, GaveUp, Policy, Record
from mauve.wcet.flow.state import MASK_OF_ALL, State
from mauve.wcet.flow.transfer import run

States = list[State]
Leaving = dict[int, States]
"""States by the index of the edge on which they leave a region."""

SEARCHED = (0, 1, 2, 3, 2, 1, 1, 0)
"""While the header of a loop is sought, the headers of loops at most so much deeper are sought anew each time, those
even deeper are passed roughly: by how many loops lie inside each other in the loop, the last one for more."""
MOST_ROUGH = 6
"""Attempts at a rough header."""
MANY = 64
"""Iterations after which a loop whose exits depend on wide ranges is not stepped to its end."""
AT_ONCE = 64
"""Instructions between two looks at the clock."""
MOST_SPLITS = 8
"""In a block, conditional instructions split a state at most into this many."""


class Execution:
    """One abstract execution of one function. `cut_short` are loops that more steps might bring further. With an
    `earlier` execution from the same state that stepped through no loop, one that cannot be stepped to its end is
    passed from the header found there."""

    def __init__(
        self,
        order: Order,
        image: Image,
        calls: Calls,
        policy: Policy,
        thresholds: Sequence[int],
        known: dict[int, int] | None = None,
        deadline: float | None = None,
        earlier: Record | None = None,
    ) -> None:
        self.order, self.image, self.calls, self.policy, self.thresholds = order, image, calls, policy, thresholds
        self.known = known or {}
        self.deadline = deadline
        self.earlier = earlier
        self.summary_steps = 0
        self.stepped = set(policy.stepped)
        self.cut_short: set[int] = set()
        self.steps = 0
        self.record: Record | None = None
        self.summaries = 0
        self.stays: dict[int, list[Stay]] | None = None
        self.limits: list[tuple[int, int]] = []
        self.watching: Exits | None = None
        self.marks: list[Marks] = []
        self.deepest: int | None = None
        self.moving: dict[int, dict[Place, int]] = {}

    def execute(self, entry: State) -> Record:
        """Execute from the function's entry; the record is complete."""
        record = self.record = Record()
        entry.symbols.floor = FIRST_FRESH
        leaving, back = self._region(FUNCTION, [entry])
        for index, states in leaving.items():
            if self.order.cfg.edges[index].target == EXIT:
                record.returned += states
        assert not back
        record.returned = joining.restrict(record.returned, 1)
        return record

    # ------------------------------------------------------------------------------------------------ regions
    def _region(self, region_id: int, states: States) -> tuple[Leaving, States]:
        """Pass once through a region from its header: what leaves it, and what comes back to the header."""
        order, region = self.order, self.order.regions[region_id]
        width = self.policy.width
        waiting: dict[int, States] = {region.header: states}
        leaving: Leaving = {}
        back: States = []
        edges = order.cfg.edges
        for node in region.nodes:
            here = waiting.pop(node, None)
            if not here:
                continue
            here = joining.restrict(here, width)
            loop = order.inner.get(node)
            if loop is not None and loop != region_id:
                left = self._loop(loop, here)
            else:
                left = self._block(node, here)
            for index, after in left.items():
                target = edges[index].target
                if target == region.header and region_id != FUNCTION:
                    back += after
                elif target == EXIT or target not in region.blocks:
                    leaving[index] = after
                else:
                    waiting.setdefault(target, []).extend(after)
        return leaving, joining.restrict(back, width) if back else back

    def _loop(self, loop: int, states: States) -> Leaving:
        if loop in self.stepped:
            try:
                return self._step(loop, [state.copy() for state in states])
            except Exhausted as exhausted:
                if exhausted.region != loop:
                    raise
                self.stepped.discard(loop)
                if not exhausted.hopeless or self.summaries:
                    self.cut_short.add(loop)
                if self.record is not None:
                    self.record.totals[loop] = None
            header = None if self.earlier is None else self.earlier.headers.get(loop)
            if header is not None:
                return self._again(loop, header)
        return self._summarise(loop, joining.join_all(states))

    def _again(self, loop: int, header: Header) -> Leaving:
        """Pass through a loop from a header that holds all iterations of all its entries."""
        assert self.earlier is not None
        self._note_visits(loop, self.earlier.visits.get(loop), "affine")
        if self.record is not None:
            self.record.headers[loop] = header
        self.summaries += 1
        try:
            return self._region(loop, [header.state.copy()])[0]
        finally:
            self.summaries -= 1

    # ------------------------------------------------------------------------------------------------ stepping
    def _step(self, loop: int, states: States) -> Leaving:
        """Execute a loop iteration by iteration."""
        left_steps = (self.limits[-1][1] if self.limits else self.policy.steps) - self.steps
        inside = self.order.height[loop] + 1
        self.limits.append((loop, self.steps + left_steps * inside // (inside + 1)))
        saved = self._checkpoint()
        leaving: Leaving = {}
        count, checkpoint = 0, None
        before, watching = Exits(), self.watching
        try:
            while states:
                count += 1
                now: Exits | None = None
                if count & (count - 1) == 0 and count >= 8:
                    checkpoint = [state.copy() for state in states]
                    now = Exits(self._exits(loop), count >= MANY)
                elif checkpoint is not None and stands_still(checkpoint, states):
                    raise Exhausted(loop, True)
                for state in states:
                    state.prune()
                self.watching = now
                left, states = self._region(loop, states)
                if now is not None and now.hopeless(before):
                    raise Exhausted(loop, True)
                before = now or before
                for index, after in left.items():
                    leaving[index] = joining.restrict(leaving.get(index, []) + after, self.policy.width)
        except Exhausted:
            self._restore(saved)
            raise
        finally:
            self.limits.pop()
            self.watching = watching
        self._note_visits(loop, count, "abstract execution")
        return leaving

    def _exits(self, loop: int) -> frozenset[int]:
        """The blocks of a loop that have a way out of it."""
        order, blocks, edges = self.order, self.order.regions[loop].blocks, self.order.cfg.edges
        leaving = {block: (*order.taken[block], *order.fall[block]) for block in blocks}
        return frozenset(b for b in blocks if any(edges[index].target not in blocks for index in leaving[b]))

    def _checkpoint(self) -> tuple[dict[int, int | None], dict[int, int | None]] | None:
        return None if self.record is None else (dict(self.record.visits), dict(self.record.totals))

    def _restore(self, saved: tuple[dict[int, int | None], dict[int, int | None]] | None) -> None:
        """Take back counts of an attempt that was given up (what else it recorded is a harmless superset)."""
        if self.record is not None and saved is not None:
            self.record.visits, self.record.totals = dict(saved[0]), dict(saved[1])

    def _note_visits(self, loop: int, count: int | None, method: str) -> None:
        record = self.record
        if record is None:
            return
        before = record.visits.get(loop, 0)
        record.visits[loop] = None if count is None or before is None else max(count, before)
        if before is not None and (count is None or count >= before):
            record.methods[loop] = method
        total = record.totals.get(loop, 0)
        record.totals[loop] = None if count is None or total is None or self.summaries else total + count

    # ------------------------------------------------------------------------------------------------ summarising
    def _summarise(self, loop: int, entry: State) -> Leaving:
        """Find a header that holds all iterations, bound it, and pass through the loop once from there."""
        depth, deepest = self.order.nest.loops[loop].depth, self.deepest
        if deepest is not None and depth > deepest:
            return self._rough(loop, entry)
        entry.trim()
        record, stays = self.record, self.stays
        self.record = None
        self.summaries += 1
        try:
            try:
                if deepest is None:
                    inside = self.order.height[loop]
                    self.deepest = depth + SEARCHED[min(inside, len(SEARCHED) - 1)]
                header, bound = self._header(loop, entry)
            finally:
                self.record, self.stays, self.deepest = record, stays, deepest
            self._note_visits(loop, bound, "affine")
            if record is not None and header is not None:
                record.headers[loop] = header
            leaving, _ = self._region(loop, [entry if header is None else header.state])
        finally:
            self.summaries -= 1
        return leaving

    def _rough(self, loop: int, entry: State) -> Leaving:
        """Pass through a loop from a header in which all that some iteration changes is unknown. Deep in a nest this
        keeps the search for the outer headers short: what is remembered of such a loop from one time to the next makes
        it one pass through its blocks."""
        state, moving = entry.copy(), self.moving.setdefault(loop, {})
        state.flags, state.origin = flags.ANY, None
        for place, mask in moving.items():
            joining.forget(state, place, mask)
        for _ in range(MOST_ROUGH):
            leaving, back, _ = self._pass(loop, state)
            if back is None or joining.unmoved(state, back, moving):
                return leaving
        header = self._surrender(loop, entry)
        return self._pass(loop, header.state)[0]

    def _try(self, loop: int, state: State) -> tuple[State | None, list[Stay]]:
        """One pass from a header state: the state at the back edges, and the conditions for going on."""
        return self._pass(loop, state)[1:]

    def _pass(self, loop: int, state: State) -> tuple[Leaving, State | None, list[Stay]]:
        """One pass from a header state: what leaves the loop, the state at the back edges, and the conditions for going
        on."""
        outer, floor, symbols = self.stays, state.symbols.floor, state.symbols
        self.stays, symbols.floor = {loop: []}, symbols.fresh()
        try:
            leaving, back = self._region(loop, [state.copy()])
            found = self.stays[loop]
        finally:
            self.stays, symbols.floor = outer, floor
        return leaving, (joining.join_all(back) if back else None), found

    def _header(self, loop: int, entry: State) -> tuple[Header | None, int | None]:
        """A header that holds all visits and a bound of their number; (None, 1) where the loop never comes back."""
        marks = Marks(entry.symbols.fresh(), set(self.thresholds))
        self.marks.append(marks)
        try:
            return self._invariant(loop, entry, marks)
        finally:
            self.marks.pop()

    def _invariant(self, loop: int, entry: State, marks: Marks) -> tuple[Header | None, int | None]:
        back, _ = self._try(loop, entry)
        if back is None:
            return None, 1
        header = joining.generalise(entry, back, sorted(marks.found), tuple(marks.limits))
        marks.of_symbol = {symbol: set() for symbol in header.free}
        most: int | None = 2
        last = self.policy.passes - 1
        for attempt in range(self.policy.passes):
            header.limit(most)
            back, stays = self._try(loop, header.state)
            if back is None:
                return header, most
            fits = joining.fit(header, back, marks.thresholds(attempt, last - 4))
            bound = self._least(loop, closed_form.visits(header, stays))
            header.facts = header.facts or closed_form.distances(header, stays)
            reached = back.range_of((1, header.kappa, 1))
            if fits and (most is None or reached.low + reached.span < most or (bound is not None and bound <= most)):
                most = bound if bound is not None and (most is None or bound < most) else most
                break
            if fits or attempt == 0:
                most = bound
            if attempt > last - 4:
                most = None
        else:
            return self._surrender(loop, entry), self.known.get(loop)
        return header, self._descend(loop, header, most)

    def _descend(self, loop: int, header: Header, most: int | None) -> int | None:
        """Tighten a header that fits, and its bound."""
        for last in (False, True):
            header.limit(most)
            back, stays = self._try(loop, header.state)
            if back is None:
                return most
            joining.narrow(header, back)
            bounds = [most, closed_form.visits(header, stays), *(joining.one_way(header, s) for s in header.free)]
            found = min((bound for bound in bounds if bound is not None and bound <= closed_form.MOST), default=None)
            if found == most and (last or most is not None):
                break
            most = found
        header.limit(most)
        return most

    def _least(self, loop: int, bound: int | None) -> int | None:
        """The better of a bound found here and one proven elsewhere."""
        known = self.known.get(loop)
        return bound if known is None or (bound is not None and bound < known) else known

    def _surrender(self, loop: int, entry: State) -> Header:
        """A header of which nothing is known, except that sp stands where it stood if one pass confirms it."""
        state = State(entry.symbols)
        state.regs = [state.fresh() for _ in range(16)] + [0] * 16
        state.leaked, state.held = True, MASK_OF_ALL
        state.taints = {linear.symbols(value)[0]: MASK_OF_ALL for value in state.regs[:16]}
        stack = state.regs[SP] = entry.regs[SP]
        state.ranges = {s: known for s, known in entry.ranges.items() if s in linear.symbols(stack)}
        back, _ = self._try(loop, state)
        if back is not None and back.regs[SP] != stack:
            state.regs[SP] = state.fresh()
        return Header(entry, state, entry.symbols.fresh())

    # ------------------------------------------------------------------------------------------------ blocks
    def _block(self, block: int, states: States) -> Leaving:
        """Execute a block: the states by the edge on which they leave it."""
        instructions = self.order.cfg.blocks[block].instructions
        self.steps += len(instructions) * len(states)
        if self.limits and self.steps > self.limits[-1][1]:
            raise Exhausted(next(r for r, limit in self.limits if self.steps > limit))
        if not self.limits:
            self.summary_steps += len(instructions) * len(states)
        if self.summary_steps > self.policy.most:
            raise GaveUp
        states = [state.copy() for state in states]
        check(self.deadline, instructions[0].address, self.order.cfg.name)
        for number, instruction in enumerate(instructions[:-1]):
            if number % AT_ONCE == AT_ONCE - 1:
                check(self.deadline, instruction.address, self.order.cfg.name)
            states = self._instruction(instruction, states)
        self._note_stay(block, instructions[-1], states)
        if self.watching is not None and block in self.watching.blocks:
            self.watching.note(block, instructions[-1], states)
        leaving: Leaving = {}
        for state in states:
            self._leave(block, instructions[-1], state, leaving)
        if self.record is not None:
            self.record.taken.update(leaving)
        return {index: joining.restrict(after, self.policy.width) for index, after in leaving.items()}

    def _instruction(self, instruction: Instruction, states: States) -> States:
        condition = instruction.condition
        if condition is Condition.AL:
            for state in states:
                self._act(instruction, state)
            return states
        after: States = []
        for state in states:
            if not flags.may_hold(state.flags, condition):
                after.append(state)
                continue
            if not flags.must_hold(state.flags, condition):
                skipped = state.copy()
                if skipped.assume(condition.negated):
                    after.append(skipped)
                if not state.assume(condition):
                    continue
            self._act(instruction, state)
            after.append(state)
        return joining.restrict(after, MOST_SPLITS)

    def _act(self, instruction: Instruction, state: State) -> None:
        if self.record is None:
            run(state, instruction.ops, self.image)
            return
        before = state.regs[SP]
        run(state, instruction.ops, self.image, lambda s, i, a, n: self._note_access(instruction, s, i, a, n))
        if state.regs[SP] is not before:
            self._note_depth(state)

    def _note_access(self, instruction: Instruction, state: State, index: int, address: Value, size: int) -> None:
        assert self.record is not None
        region, low, high = state.place(address)
        if region is not None and not linear.is_entry_symbol(region):
            region = None
        key = (instruction.address, index)
        place = (region, low, high + size - 1)
        op = instruction.ops[index]
        if not isinstance(op, Load):
            self._note_write(state, op, place)
        before = self.record.accesses.get(key)
        if before is not None and before != place:
            same = before[0] == region and region is not None
            place = (region, min(before[1], low), max(before[2], place[2])) if same else (None, 0, domain.MASK)
        self.record.accesses[key] = place

    def _note_write(self, state: State, op: MicroOp, place: tuple[int | None, int, int]) -> None:
        assert self.record is not None
        self.record.writes.add(place if place[0] != FRAME or place[2] >= 0 else (FRAME, 0, -1))
        if not isinstance(op, Store) or isinstance(op.value, Imm):
            return
        value = state.regs[op.value]
        if type(value) is int:
            return
        if place[0] != FRAME:
            self.record.leaks |= state.mask(value)
        elif len(value) == 3 and value[0] == 0 and linear.is_entry_symbol(value[1]):  # type: ignore[arg-type, index]
            self.record.saved.add(value[1])  # type: ignore[index]

    def _note_depth(self, state: State) -> None:
        assert self.record is not None
        region, low, high = state.place(state.regs[SP])
        if region != FRAME or low != high:
            self.record.depth = None
        elif self.record.depth is not None:
            self.record.depth = max(self.record.depth, -low)

    def _leave(self, block: int, last: Instruction, state: State, leaving: Leaving) -> None:
        """Execute the last instruction of a block and pass the states on."""
        order = self.order
        taken, fall = order.taken[block], order.fall[block]
        flow = last.flow
        if isinstance(flow, CompareBranch):
            self._compare_and_branch(block, flow, state, leaving)
            return
        if isinstance(flow, Next):
            for after in self._instruction(last, [state]):
                self._pass_on(last, after, taken + fall, leaving)
            return
        if last.condition is not Condition.AL:
            for marks in self.marks:
                marks.note(state)
            skipped = state.copy()
            if skipped.assume(last.condition.negated):
                self._pass_on(last, skipped, fall, leaving)
            if not state.assume(last.condition):
                return
            fall = ()
        self._act(last, state)
        self._pass_on(last, state, taken or fall, leaving)

    def _compare_and_branch(self, block: int, flow: CompareBranch, state: State, leaving: Leaving) -> None:
        condition = Condition.NE if flow.nonzero else Condition.EQ
        before, origin = state.flags, state.origin
        _compare_with_zero(state, flow)
        for edges, holds in ((self.order.taken[block], condition), (self.order.fall[block], condition.negated)):
            after = state.copy()
            if edges and after.assume(holds):
                after.flags, after.origin = before, origin
                self._deliver(after, edges, leaving)

    def _note_stay(self, block: int, last: Instruction, states: States) -> None:
        """Note under which condition the loop goes on after its exit at the end of this block, for all states that
        come here."""
        region = self.order.innermost[block]
        if self.stays is None or region not in self.stays or block not in self.order.always[region] or not states:
            return
        state, condition = joining.join_all(states).copy(), last.condition
        if isinstance(last.flow, CompareBranch):
            condition = Condition.NE if last.flow.nonzero else Condition.EQ
            _compare_with_zero(state, last.flow)
        edges, blocks = self.order.cfg.edges, self.order.regions[region].blocks
        stays_taken = any(edges[index].target in blocks for index in self.order.taken[block])
        stays_fall = any(edges[index].target in blocks for index in self.order.fall[block])
        if stays_taken != stays_fall and state.origin is not None and condition is not Condition.AL:
            goes_on = condition if stays_taken else condition.negated
            self.stays[region].append(Stay(goes_on, *state.origin, state))

    def _pass_on(self, last: Instruction, state: State, edges: tuple[int, ...], leaving: Leaving) -> None:
        all_edges = self.order.cfg.edges
        if len(edges) > 1 or isinstance(last.flow, IndirectJump | IndirectCall):
            targets = self._targets(last, state)
            if targets is not None:
                if self.record is not None:
                    before = self.record.targets.get(last.address)
                    self.record.targets[last.address] = targets if before is None else domain.join(before, targets)
                if isinstance(last.flow, IndirectJump | TableJump) and targets.size <= 1024:
                    places = {value & ~1 for value in targets.members()}
                    edges = tuple(i for i in edges if self._edge_among(all_edges[i], places))
        self._deliver(state, edges, leaving)

    def _edge_among(self, edge: Edge, places: set[int]) -> bool:
        return edge.kind is not EdgeKind.SWITCH or self.order.cfg.blocks[edge.target].address in places

    def _targets(self, last: Instruction, state: State) -> Range | None:
        match last.flow:
            case IndirectJump(target) | IndirectCall(target):
                return state.range_of(target.value if isinstance(target, Imm) else state.regs[target])
            case TableJump(table, index, size, pc):
                base = state.constant_of(table.value if isinstance(table, Imm) else state.regs[table])
                at = state.range_of(index.value if isinstance(index, Imm) else state.regs[index])
                if base is None or at.size > 1024:
                    return None
                found = [self.image.constant((base + size * i) & domain.MASK, size) for i in at.members()]
                known = [pc + 2 * entry for entry in found if entry is not None]
                return domain.of(known) if known and len(known) == len(found) else None
            case _:
                return None

    def _deliver(self, state: State, edges: tuple[int, ...], leaving: Leaving) -> None:
        for position, index in enumerate(edges):
            edge = self.order.cfg.edges[index]
            after = state if position == len(edges) - 1 else state.copy()
            if edge.callees or edge.kind in (EdgeKind.CALL, EdgeKind.TAIL_CALL):
                called = self.calls.apply(after, index, edge, self.record)
                if called is None:
                    continue
                after = called
            leaving.setdefault(index, []).append(after)


def _compare_with_zero(state: State, flow: CompareBranch) -> None:
    value = state.regs[flow.register]
    state.flags = flags.of_logic(state.range_of(value), state.flags)
    state.origin = (FlagKind.LOGIC, value, 0)
