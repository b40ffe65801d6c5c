"""Executions retraced in the graphs of the analysis: context by context, edge by edge.

An execution is recorded in the emulator, instruction by instruction with its memory accesses, and then walked along
the graphs of the functions in the contexts that flow analysis assigned to their calls. What the analysis calls
impossible and what it bounds is checked at every step.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from emulator import Argument, Emulator

from mauve.wcet.binary.graph import EXIT, EdgeKind
from mauve.wcet.binary.microop import Condition, Load, Store
from mauve.wcet.flow.result import AddressRange, ContextKey, FunctionFlow, ProgramFlow
from mauve.wcet.ipet.bottom_up import FunctionBound

RETURN_TO = 0x7000_0000
Access = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Recording:
    """The addresses of the instructions issued, in order, and the (address, size) of the accesses of each."""

    addresses: list[int]
    accesses: dict[int, list[Access]]


def record(emulator: Emulator, function: str, arguments: Sequence[Argument], most: int = 400_000) -> Recording:
    """Run a function; EmulationError when it does not return.

    On cores with IT blocks the emulator leaves instructions out when it is asked for each: there the straight runs are
    recorded instead, without accesses.
    """
    if emulator._thumb_only:
        run = emulator.call(function, arguments, max_instructions=most, trace=True)
        return Recording([a for block in run.blocks for a in emulator._lengths[block]], {})
    from unicorn import UC_HOOK_CODE, UC_HOOK_MEM_READ, UC_HOOK_MEM_WRITE

    addresses: list[int] = []
    accesses: dict[int, list[Access]] = {}
    uc: Any = emulator._uc

    def on_code(_uc: Any, address: int, _size: int, _data: object) -> None:
        addresses.append(address)

    def on_memory(_uc: Any, _kind: int, address: int, size: int, _value: int, _data: object) -> None:
        accesses.setdefault(len(addresses) - 1, []).append((address, size))

    hooks = [uc.hook_add(UC_HOOK_CODE, on_code), uc.hook_add(UC_HOOK_MEM_READ | UC_HOOK_MEM_WRITE, on_memory)]
    try:
        emulator.call(function, arguments, max_instructions=most)
    finally:
        for hook in hooks:
            uc.hook_del(hook)
    while addresses and addresses[-1] == RETURN_TO:
        addresses.pop()
    return Recording(addresses, accesses)


@dataclass(slots=True)
class _Plan:
    """A function in one context, indexed for walking."""

    flow: FunctionFlow
    own: tuple[tuple[int, ...], ...]
    """cycles of every edge, per board"""
    addresses: list[tuple[int, ...]]
    steps: list[tuple[tuple[int, bool], ...]]
    """per block the addresses, and whether the instruction may be missing in a recording"""
    edges: dict[int, list[int]]
    enters: dict[int, list[int]]
    repeats: dict[int, list[int]]
    ranges: dict[int, list[tuple[int, int]]]
    groups: dict[int, list[int]]
    """for an edge the groups of edges that exclude each other and hold it"""


def united(flows: Sequence[FunctionFlow]) -> FunctionFlow:
    """What holds in one of some contexts of a function, whichever it is."""
    first = flows[0]
    if len(flows) == 1:
        return first
    bounds, calls = {}, {}
    for loop in {loop for flow in flows for loop in flow.bounds}:
        mine = [flow.bounds[loop] for flow in flows if loop in flow.bounds]
        totals = [bound.total for bound in mine]
        total = None if None in totals else max(total for total in totals if total is not None)
        bounds[loop] = replace(max(mine, key=lambda bound: bound.bound), total=total)
    for edge in {edge for flow in flows for edge in flow.calls}:
        calls[edge] = tuple(dict.fromkeys(name for flow in flows for name in flow.calls.get(edge, ())))
    accesses = {}
    for key in set.intersection(*(set(flow.accesses) for flow in flows)):
        ranges = [flow.accesses[key] for flow in flows]
        accesses[key] = AddressRange(min(r.low for r in ranges), max(r.high for r in ranges))
    infeasible = frozenset.intersection(*(flow.infeasible for flow in flows))
    limits = {
        edge: max(flow.edge_limits[edge] for flow in flows)
        for edge in set.intersection(*(set(flow.edge_limits) for flow in flows))
    }
    groups = tuple(group for group in first.exclusive if all(group in flow.exclusive for flow in flows))
    return replace(
        first,
        bounds=bounds,
        infeasible=infeasible,
        calls=calls,
        accesses=accesses,
        edge_limits=limits,
        exclusive=groups,
    )


def _plan(flow: FunctionFlow, bounds: Sequence[tuple[int, ...]]) -> _Plan:
    edges, enters, repeats = defaultdict(list), defaultdict(list), defaultdict(list)
    for index, edge in enumerate(flow.cfg.edges):
        edges[edge.source].append(index)
    for number, loop in enumerate(flow.nest.loops):
        for index in loop.entry_edges:
            enters[index].append(number)
        for index in loop.back_edges:
            repeats[index].append(number)
    ranges = {}
    for block in flow.cfg.blocks:
        for instruction in block.instructions:
            keys = [(instruction.address, k) for k, op in enumerate(instruction.ops) if isinstance(op, Load | Store)]
            if keys and all(key in flow.accesses for key in keys):
                ranges[instruction.address] = [(flow.accesses[key].low, flow.accesses[key].high) for key in keys]
    own = tuple(bounds)
    addresses = [tuple(i.address for i in block.instructions) for block in flow.cfg.blocks]
    steps = [
        tuple((i.address, i.thumb and i.condition is not Condition.AL) for i in block.instructions)
        for block in flow.cfg.blocks
    ]
    groups = defaultdict(list)
    for number, group in enumerate(flow.exclusive):
        for index in group.edges:
            groups[index].append(number)
    return _Plan(flow, own, addresses, steps, edges, enters, repeats, ranges, groups)


@dataclass(slots=True)
class _Frame:
    """One execution of a function: where it is, and how often its loops ran since they were entered, and in all."""

    names: tuple[ContextKey, ...]
    plan: _Plan
    block: int
    back_to: frozenset[int]
    """addresses to which it may return: several where a helper comes back behind a table"""
    calling: tuple[int, ...] = ()
    """the edges of a call that is under way, one of which will have been taken"""
    counts: dict[int, int] = field(default_factory=dict)
    totals: dict[int, int] = field(default_factory=lambda: defaultdict(int))
    taken: dict[int, int] = field(default_factory=dict)
    """of groups of edges that exclude each other, by number: the one taken in this execution or iteration"""
    passed: dict[int, int] = field(default_factory=lambda: defaultdict(int))
    """executions of edges that are limited"""


@dataclass(slots=True)
class Replay:
    """Walks executions through one analysed program. `wrong` collects every contradiction; `seen` the greatest count
    of every loop (function in context, number of the loop) per entry and in all."""

    program: ProgramFlow
    bounds: Sequence[Mapping[ContextKey, FunctionBound]]
    wrong: list[str] = field(default_factory=list)
    seen: dict[tuple[ContextKey, int], tuple[int, int]] = field(default_factory=dict)
    _plans: dict[tuple[ContextKey, ...], _Plan] = field(default_factory=dict)

    @property
    def holes(self) -> bool:
        """Whether a graph is incomplete: there is no bound then, and what lies behind the hole is not analysed."""
        return any(flow.cfg.unresolved for flow in self.program.functions.values())

    def walk(self, run: Recording) -> tuple[int, ...] | None:
        """The cycles of an execution on every board, by the costs of its edges; None where it leaves the graphs."""
        cycles = [0] * len(self.bounds)
        frames = [self._enter((self.program.entry,), frozenset({RETURN_TO}))]
        at, trace = 0, run.addresses
        while frames:
            frame = frames[-1]
            if frame.calling:
                following = trace[at] if at < len(trace) else RETURN_TO
                fits = [
                    e
                    for e in frame.calling
                    if frame.plan.addresses[frame.plan.flow.cfg.edges[e].target][0] == following
                ]
                frame.calling = ()
            else:
                after = self._through(frame, run, at)
                if after is None:
                    return None
                at = after
                following = trace[at] if at < len(trace) else RETURN_TO
                fits = self._fitting(frame, following)
                if any(frame.plan.flow.cfg.edges[e].kind is EdgeKind.CALL for e in fits):
                    frame.calling = tuple(fits)
                    callee = self._called(frame, fits, following)
                    if callee is None:
                        return None
                    frames.append(callee)
                    continue
            if not fits and self._leaves(frames, following):
                continue
            edge = self._edge(frame, fits, following)
            if edge is None:
                return None
            if len([e for e in fits if e not in frame.plan.flow.infeasible]) == 1:
                self._check_edge(frame, edge)
            for board, own in enumerate(frame.plan.own):
                cycles[board] += own[edge] if own else 0
            kind, target = frame.plan.flow.cfg.edges[edge].kind, frame.plan.flow.cfg.edges[edge].target
            if target != EXIT:
                self._pass(frame, edge, target)
                continue
            frames.pop()
            if kind is EdgeKind.TAIL_CALL:
                callee = self._called(frame, [edge], following)
                if callee is None:
                    return None
                frames.append(callee)
        if at != len(trace):
            self.wrong.append(f"returned {len(trace) - at} instructions early")
        return tuple(cycles)

    def _through(self, frame: _Frame, run: Recording, at: int) -> int | None:
        """Past the block where a frame is. The emulator does not show the instructions of an IT block that it skips."""
        trace = run.addresses
        for address, optional in frame.plan.steps[frame.block]:
            if at < len(trace) and trace[at] == address:
                self._check_access(frame, run, at, address)
                at += 1
            elif not optional:
                what = f"{address:#x} expected, {hex(trace[at]) if at < len(trace) else 'the end'} executed"
                self._tell(frame, what)
                return None
        return at

    def _enter(self, names: tuple[ContextKey, ...], back_to: frozenset[int]) -> _Frame:
        """The frame of a function in one of some contexts: where a run tells calls apart by what they do, it is not
        known before in which."""
        if names not in self._plans:
            flows = [self.program.functions[name] for name in names]
            self._plans[names] = _plan(united(flows), [self._costs(bounds, names) for bounds in self.bounds])
        plan = self._plans[names]
        frame = _Frame(names, plan, plan.flow.cfg.entry, back_to)
        for number, loop in enumerate(plan.flow.nest.loops):
            if loop.header == plan.flow.cfg.entry:
                self._count(frame, number, 1)
        return frame

    def _costs(self, bounds: Mapping[ContextKey, FunctionBound], names: tuple[ContextKey, ...]) -> tuple[int, ...]:
        """The greatest cycles of every edge."""
        own = [bounds[name].own for name in names if name in bounds]
        if not all(own):  # one of the contexts has no bound
            return ()
        return tuple(map(max, zip(*own, strict=True))) if len(own) > 1 else tuple(own[0]) if own else ()

    def _called(self, frame: _Frame, edges: list[int], callee: int) -> _Frame | None:
        """The frame of a callee; a tail call returns where its caller would. None where the analysis says nothing of
        the callee: it holds the call for impossible, unless it gave the caller up."""
        calls = frame.plan.flow.calls
        told = [edge for edge in edges if edge in calls]  # a helper that comes back behind a table is on several
        if not told:
            if not frame.plan.flow.problems:
                self._tell(frame, f"{callee:#x} is called, which was not analysed")
            return None
        all_edges = frame.plan.flow.cfg.edges
        back = frozenset(frame.plan.addresses[all_edges[e].target][0] for e in edges if all_edges[e].target != EXIT)
        names = tuple(dict.fromkeys(name for edge in told for name in calls[edge] if name[0] & ~1 == callee))
        if not names:
            self._tell(frame, f"{callee:#x} is called, for which there is no context")
            return None
        return self._enter(names, back or frame.back_to)

    def _fitting(self, frame: _Frame, following: int) -> list[int]:
        """The edges of a block that go on at an address."""
        cfg, fits = frame.plan.flow.cfg, []
        for index in frame.plan.edges[frame.block]:
            edge = cfg.edges[index]
            if edge.callees:
                fit = any(key & ~1 == following for key in edge.callees)
            elif edge.target == EXIT:
                fit = following in frame.back_to and edge.kind is EdgeKind.RETURN
            else:
                fit = frame.plan.addresses[edge.target][0] == following
            if fit:
                fits.append(index)
        return fits

    def _leaves(self, frames: list[_Frame], following: int) -> bool:
        """Whether a part of a function that it calls as a subroutine returns for both (libgcc's floating point does so
        with NaN): both are left then. The analysis goes on after the call instead, which takes longer."""
        if len(frames) < 2 or "+" not in frames[-1].plan.flow.cfg.name or following not in frames[-2].back_to:
            return False
        own = frames[-1].plan
        if all(own.flow.cfg.edges[index].kind is not EdgeKind.RETURN for index in own.edges[frames[-1].block]):
            return False
        del frames[-2:]
        return True

    def _edge(self, frame: _Frame, fits: list[int], following: int) -> int | None:
        """A feasible one of the edges that fit, unless there is none."""
        feasible = [index for index in fits if index not in frame.plan.flow.infeasible]
        if feasible:
            return feasible[0]
        last = frame.plan.addresses[frame.block][-1]
        self._tell(frame, f"{last:#x} -> {following:#x} {'is called infeasible' if fits else 'is no edge'}")
        return None

    def _check_edge(self, frame: _Frame, edge: int) -> None:
        """Whether an edge may be taken once more, and after those that were taken."""
        flow = frame.plan.flow
        frame.passed[edge] += 1
        if frame.passed[edge] > flow.edge_limits.get(edge, frame.passed[edge]):
            self._tell(frame, f"edge {edge} is taken {frame.passed[edge]} times, limit {flow.edge_limits[edge]}")
        for number in frame.plan.groups.get(edge, ()):
            before = frame.taken.setdefault(number, edge)
            if before != edge:
                group = flow.exclusive[number]
                said = dict(zip(group.edges, group.conditions, strict=True))
                places = [frame.plan.addresses[flow.cfg.edges[e].source][-1] for e in (before, edge)]
                what = f"{places[0]:#x} ({said[before]}) and {places[1]:#x} ({said[edge]}), never together, were taken"
                self._tell(frame, what)

    def _pass(self, frame: _Frame, edge: int, target: int) -> None:
        frame.block = target
        for number in frame.plan.enters.get(edge, ()):
            self._count(frame, number, 1)
        for number in frame.plan.repeats.get(edge, ()):
            self._count(frame, number, frame.counts.get(number, 0) + 1)

    def _count(self, frame: _Frame, number: int, count: int) -> None:
        for group in [g for g in frame.taken if frame.plan.flow.exclusive[g].loop == number]:
            del frame.taken[group]
        frame.counts[number] = count
        frame.totals[number] += 1
        per_entry, total = self.seen.get((frame.names[0], number), (0, 0))
        bound = frame.plan.flow.bounds.get(number)
        if count > per_entry or frame.totals[number] > total:
            for name in frame.names:
                before = self.seen.get((name, number), (0, 0))
                self.seen[name, number] = max(before[0], count), max(before[1], frame.totals[number])
            header = frame.plan.addresses[frame.plan.flow.nest.loops[number].header][0]
            if bound is not None and count > bound.bound:
                self._tell(frame, f"loop {header:#x} ran {count} times, bound {bound.bound} ({bound.method})")
            if bound is not None and bound.total is not None and frame.totals[number] > bound.total:
                self._tell(frame, f"loop {header:#x} ran {frame.totals[number]} times in all, total {bound.total}")

    def _check_access(self, frame: _Frame, run: Recording, at: int, address: int) -> None:
        ranges = frame.plan.ranges.get(address)
        for low, size in run.accesses.get(at, ()) if ranges else ():
            if not any(first <= low and low + size - 1 <= last for first, last in ranges or ()):
                said = ", ".join(f"{a:#x}..{b:#x}" for a, b in ranges or ())
                self._tell(frame, f"{address:#x} touches {low:#x}, said to stay in {said}")

    def _tell(self, frame: _Frame, what: str) -> None:
        cfg = frame.plan.flow.cfg
        text = f"{cfg.name}[{frame.names[0][1]}]: {what}"
        if self.holes:
            return
        if text not in self.wrong and len(self.wrong) < 20:
            self.wrong.append(text)
