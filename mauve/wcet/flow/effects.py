"""What a call does to the caller's state, from the analysis of the callee."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from mauve.wcet.binary.graph import Edge, EdgeKind
from mauve.wcet.binary.microop import SP, Op
from mauve.wcet.flow import domain, flags, joining, linear, spills
from mauve.wcet.flow.domain import MASK, SIGN, TOP, Range
from mauve.wcet.flow.linear import FRAME, Value, entry_symbol
from mauve.wcet.flow.locations import CALL_CLOBBERED, CallEffects, Helper
from mauve.wcet.flow.record import Record
from mauve.wcet.flow.state import ABSOLUTE, ENDS, IN_STACK, MASK_OF_ALL, OF_FRAME, Cells, State, is_end

ARGUMENTS = (0, 1, 2, 3)
RESULTS = (0, 1, 2, 3)
CLOBBERED = (0, 1, 2, 3, 12, 14)
PRESERVED = (4, 5, 6, 7, 8, 9, 10, 11)
NEAR = 512
"""How many bytes around a pointer argument a context knows of the caller's memory."""

Place = tuple[int | None, int, int]


@dataclass(frozen=True, slots=True)
class Summary:
    """The effect of a function: `results` are the values of r0-r3 on return, as ranges; `writes` the places it may
    write, in regions of its entry registers, fixed addresses, or None (anywhere but in frames it does not know);
    `leaks`: the arguments (State.mask) that may live on in memory, `masks` those that each result may be computed
    of; `changed` the callee-saved registers that it changes without having saved them, `kept` the others that it leaves
    as they were (compilers that know the callee rely on it)."""

    returns: bool
    results: tuple[Range, Range, Range, Range]
    writes: frozenset[Place]
    leaks: int
    changed: frozenset[int]
    masks: tuple[int, int, int, int] = (MASK_OF_ALL, MASK_OF_ALL, MASK_OF_ALL, MASK_OF_ALL)
    kept: frozenset[int] = frozenset()


UNKNOWN = Summary(True, (TOP, TOP, TOP, TOP), frozenset({(None, 0, MASK)}), MASK_OF_ALL, frozenset())
"""A function of which only AAPCS is known."""


def summarise(record: Record) -> Summary:
    """The effect of a function from a pass over it from an unknown state."""
    writes = frozenset(_known_at_entry(place) for place in record.writes if place[0] != FRAME or place[2] >= 0)
    if not record.returned:
        return Summary(False, (TOP, TOP, TOP, TOP), writes, record.leaks, frozenset())
    state = record.returned[0]
    first, second, third, fourth = (_result(state, r) for r in RESULTS)
    changed = frozenset(
        r
        for r in PRESERVED
        if state.regs[r] != linear.of_symbol(entry_symbol(r)) and entry_symbol(r) not in record.saved
    )
    first_mask, second_mask, third_mask, fourth_mask = (state.mask(state.regs[r]) for r in RESULTS)
    masks = (first_mask, second_mask, third_mask, fourth_mask)
    kept = frozenset(r for r in CLOBBERED if state.regs[r] == linear.of_symbol(entry_symbol(r)))
    return Summary(True, (first, second, third, fourth), writes, record.leaks, changed, masks, kept)


def _result(state: State, register: int) -> Range:
    value = state.regs[register]
    return TOP if linear.factor_of(value, FRAME) else state.range_of(value)


def _known_at_entry(place: Place) -> Place:
    region = place[0]
    if region in (None, ABSOLUTE, FRAME) or region in {entry_symbol(r) for r in ARGUMENTS}:
        return place
    return None, 0, MASK


def call(
    state: State,
    summary: Summary,
    record: Record | None,
    helper: Helper | None = None,
    result: Range | None = None,
) -> State | None:
    """Change the caller's state as the callee may; None when it does not return. `result`: what is known of r0 on
    return beside the summary."""
    writes = [translated for place in summary.writes for translated in _translate(state, place)]
    exposed = _exposed(state)
    for region, low, high in writes:
        _write(state, region, low, high, exposed)
    arguments = [state.mask(state.regs[r]) for r in ARGUMENTS]
    leaking = _of_arguments(summary.leaks, arguments, state)
    if record is not None:
        record.writes.update(_outside(place) for place in writes)
        record.leaks |= leaking
    if not summary.returns:
        return None
    if leaking & OF_FRAME:
        state.leaked = True
    divided = None if helper is None else quotients(helper, *(state.range_of(state.regs[r]) for r in (0, 1)))
    _leave_frame(state)
    spills.forget_after_call(state)
    state.flags, state.origin = flags.ANY, None
    for register in CLOBBERED:
        if register not in summary.kept:
            state.regs[register] = state.fresh()
    for register, known, mask in zip(RESULTS, summary.results, summary.masks, strict=True):
        if register in summary.kept:
            continue
        state.regs[register] = state.tainted(state.fresh(known), _of_arguments(mask, arguments, state))
    for register in summary.changed:
        state.regs[register] = state.fresh()
    for register, known in divided or ():
        state.regs[register] = state.fresh(known)
    if result is not None:
        known = domain.meet(result, state.range_of(state.regs[0])) or result
        state.regs[0] = state.fresh(known)
    return state


def quotients(helper: Helper, a: Range, b: Range) -> list[tuple[int, Range]]:
    """The results of a division of a by b, by their registers; none where b may be 0."""
    low, high = b.signed_bounds() if helper.is_signed else b.unsigned_bounds()
    if low <= 0 <= high:
        return []  # what a division by zero gives is not said
    quotient = domain.apply(Op.SDIV if helper.is_signed else Op.UDIV, a, b)
    least, most = a.signed_bounds() if helper.is_signed else a.unsigned_bounds()
    below = max(abs(low), abs(high)) - 1
    rest = domain.sub(a, domain.apply(Op.MUL, quotient, b)) if a.n == b.n == 0 else None
    rest = rest or domain.between(max(-below, min(least, 0)), min(below, max(most, 0)))
    found = ((helper.quotient, quotient), (helper.remainder, rest))
    return [(register, known) for register, known in found if register is not None]


_HELPERS = {
    "__aeabi_uidiv": Helper.UDIV,
    "__udivsi3": Helper.UDIV,
    "__aeabi_uidivmod": Helper.UDIVMOD,
    "__umodsi3": Helper.UMOD,
    "__aeabi_idiv": Helper.SDIV,
    "__divsi3": Helper.SDIV,
    "__aeabi_idivmod": Helper.SDIVMOD,
    "__modsi3": Helper.SMOD,
}
"""The names that the run-time ABI and the compilers' libraries reserve for divisions of words."""


def helper_named(names: Iterable[str]) -> Helper | None:
    """What a function of one of these names computes, by the run-time ABI."""
    return next((_HELPERS[name] for name in names if name in _HELPERS), None)


def call_effects(callees: Sequence[tuple[Summary, Helper | None]]) -> CallEffects:
    """What a call of one of these functions changes, in the words of the ranking arguments."""
    kept = frozenset(CLOBBERED).intersection(*(summary.kept for summary, _ in callees))
    changed = frozenset[int]().union(*(summary.changed for summary, _ in callees))
    places = [place for summary, _ in callees for place in summary.writes]
    memory = any(region != FRAME or high >= low for region, low, high in places if region != FRAME or high >= 0)
    helpers = {helper for _, helper in callees}
    helper = helpers.pop() if len(helpers) == 1 else None
    return CallEffects((CALL_CLOBBERED - kept) | changed, memory, None if memory else False, helper)


def _of_arguments(mask: int, arguments: list[int], state: State) -> int:
    """The callee's mask in terms of the caller's addresses."""
    result = state.held if mask & IN_STACK else 0
    for register, own in zip(ARGUMENTS, arguments, strict=True):
        if mask >> register & 1:
            result |= own
    return result


def _outside(place: Place) -> Place:
    """The place as a caller of this function sees it."""
    region, _, high = place
    if region == FRAME and high < 0:
        return FRAME, 0, -1
    return place if region is None or linear.is_entry_symbol(region) or region == ABSOLUTE else (None, 0, MASK)


def _translate(state: State, place: Place) -> list[Place]:
    """A place of the callee in terms of the caller's state."""
    region, low, high = place
    if region is None or region == ABSOLUTE:
        return [place]
    register = SP if region == FRAME else region - 1
    base, first, last = state.place(state.regs[register])
    if base is None:
        return [(FRAME, -SIGN, SIGN - 1)] if linear.factor_of(state.regs[register], FRAME) else [(None, 0, MASK)]
    if region == FRAME:
        low = max(low, 0)
    if base == ABSOLUTE and (first + low < 0 or last + high > MASK):
        return [(None, 0, MASK)]
    return [(base, first + low, last + high)]


def _exposed(state: State) -> bool:
    """Whether a callee can know an address of the caller's frame: as an argument, or left in the frame as data."""
    return state.leaked or bool(state.held & OF_FRAME) or any(state.mask(state.regs[r]) & OF_FRAME for r in ARGUMENTS)


def _write(state: State, region: int | None, low: int, high: int, exposed: bool) -> None:
    if region == FRAME:
        state.forget_frame(low, high)
        return
    state.forget_aliases(region)
    if region is None:
        if exposed:
            state.forget_frame()
        return
    state.forget_bytes(region, low, high)


def _leave_frame(state: State) -> None:
    """What lies below sp is the callee's to overwrite."""
    region, low, high = state.place(state.regs[SP])
    if region == FRAME and low == high:
        state.forget_bytes(FRAME, -SIGN, low - 1)
    else:
        state.memory.pop(FRAME, None)


class ProgramCalls:
    """Calls within a program: effects by key of the callee; `wanted` are callees whose entry states are to be
    collected; `results` tell r0 on return from the state before the call."""

    def __init__(
        self,
        summaries: Mapping[int, Summary],
        wanted: frozenset[int],
        helpers: Mapping[int, Helper] | None = None,
        results: Mapping[int, Callable[[State], Range | None]] | None = None,
    ) -> None:
        self.summaries, self.wanted, self.helpers, self.results = summaries, wanted, helpers or {}, results or {}

    def apply(self, state: State, index: int, edge: Edge, record: Record | None) -> State | None:
        """The state after a call: the join over its callees."""
        after: list[State] = []
        for callee in edge.callees or (0,):
            before = state.copy() if len(edge.callees) > 1 else state
            if record is not None and callee in self.wanted:
                entered = enter(before)
                known = record.calls.get((index, callee))
                record.calls[index, callee] = entered if known is None else joining.join(known, entered)
            tell = self.results.get(callee)
            result = None if tell is None else tell(before)
            called = call(before, self.summaries.get(callee, UNKNOWN), record, self.helpers.get(callee), result)
            if called is not None:
                after.append(called)
        if edge.kind is EdgeKind.STOP or not after:
            return state if edge.kind is EdgeKind.STOP else None
        return joining.join_all(after)


def enter(caller: State) -> State:
    """The state in which the callee starts: ranges of its arguments, and the caller's memory near pointers into its
    frame."""
    state = State(caller.symbols)
    for register in ARGUMENTS:
        value = caller.regs[register]
        region, low, high = caller.place(value)
        if region is not None and region != ABSOLUTE and low == high:
            _copy_cells(caller, region, low, state, entry_symbol(register))
            if caller.range_of(value).span >= SIGN:
                continue
        known = caller.range_of(value)
        if known.n == 0:
            state.regs[register] = known.low
        elif not known.is_top:
            state.ranges[entry_symbol(register)] = known
    region, low, high = caller.place(caller.regs[SP])
    if region == FRAME and low == high:
        _copy_cells(caller, FRAME, low, state, FRAME, 0)
    absolute = caller.memory.get(ABSOLUTE, {})
    state.memory[ABSOLUTE] = {o: _moved(caller, state, c) for o, c in absolute.items() if _movable(caller, c)}
    return state


def _copy_cells(caller: State, region: int, origin: int, state: State, new: int, least: int = -NEAR) -> None:
    cells = caller.memory.get(region, {})
    near = {o - origin: c for o, c in cells.items() if least <= o - origin <= NEAR and _movable(caller, c)}
    near |= _moved_ends(cells, origin)
    if near:
        state.memory[new] = {offset: _moved(caller, state, cell) for offset, cell in near.items()}


def _moved_ends(cells: Cells, origin: int) -> Cells:
    """What is known of where strings end, from `origin` on."""
    moved: Cells = {}
    for offset, (_, length) in cells.items():
        if is_end(offset) and type(length) is int:
            before = max(0, origin - (offset - ENDS))
            if before < length:
                moved[ENDS + max(0, offset - ENDS - origin)] = (1, length - before)
    return moved


def _movable(caller: State, cell: tuple[int, Value]) -> bool:
    """Whether the cell tells a callee something."""
    size, value = cell
    if type(value) is int:
        return True
    return not linear.factor_of(value, FRAME) and caller.range_of(value).size < 1 << 8 * size


def _moved(caller: State, state: State, cell: tuple[int, Value]) -> tuple[int, Value]:
    size, value = cell
    return size, value if type(value) is int else state.fresh(caller.range_of(value))


def describe(state: State) -> str:
    """A context in a few words: the arguments that it knows."""
    known = []
    for register in ARGUMENTS:
        values = state.range_of(state.regs[register])
        if values.n == 0:
            known.append(f"r{register}={domain.signed(values.low)}")
        elif not values.is_top:
            low, high = values.signed_bounds()
            known.append(f"r{register}={low}..{high}")
    return " ".join(known)


def fingerprint(state: State) -> tuple[object, ...]:
    """Equal for states from which the callee behaves the same."""
    registers = tuple(state.range_of(state.regs[r]) for r in ARGUMENTS)
    memory = tuple(
        (region, offset, cell[0], state.range_of(cell[1]))
        for region in sorted(state.memory)
        for offset, cell in sorted(state.memory[region].items())
    )
    return registers, memory


__all__ = ["UNKNOWN", "ProgramCalls", "Summary", "call", "describe", "enter", "fingerprint", "summarise"]
