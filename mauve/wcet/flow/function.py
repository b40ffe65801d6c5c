"""One function in one context: abstract executions in growing strength, and the smallest sound bound of each loop."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import Loop
from mauve.wcet.binary.microop import Compute, Imm, Instruction, SetFlags
from mauve.wcet.clock import OutOfTime, check
from mauve.wcet.flow.closed_form import MOST
from mauve.wcet.flow.domain import MASK, SIGN, Range
from mauve.wcet.flow.execute import Execution
from mauve.wcet.flow.image import Image
from mauve.wcet.flow.order import Order
from mauve.wcet.flow.ranked import looks_ahead
from mauve.wcet.flow.record import Calls, GaveUp, Policy, Record
from mauve.wcet.flow.result import LoopBound
from mauve.wcet.flow.state import State
from mauve.wcet.result import Origin

WIDTH = 8
"""States kept apart at once where one did not suffice."""

LIGHT = 1_500
"""Instructions of the first attempt to step through loops, before ranking arguments are sought."""

DEEPEST = 8
"""Loops inside a loop, one inside the other, from which on it is summarised and never stepped."""

MOST_PROOFS = 2
"""How often arguments are sought again with the values that the bounds found before lead to."""

MOST_GUESSES = 3
"""How often guesses are tried together, fewer each time."""

REPEATED = 40_000
"""Instructions of a pass that is made again for more arguments."""

MOST_PASSES = 16
"""Passes over a large function, on average, whatever `Limits.most` says."""

Ranking = Callable[[Loop, Record], tuple[int, str] | None]


@dataclass(frozen=True, slots=True)
class Limits:
    """What the analysis of one function may cost: instructions executed abstractly in stepped and in summarised
    loops, and a point in time (of time.monotonic) at which everything ends."""

    steps: int = 12_000
    most: int = 400_000
    deadline: float | None = None


@dataclass(slots=True)
class Attempt:
    """How far an analysis came: the passes made, the bounds proven elsewhere, all bounds that later passes may use, the
    loops that need not be stepped again, and whether a pass with more steps would find out the same (`settled`)."""

    records: list[Record]
    bounds: dict[int, LoopBound]
    known: dict[int, int]
    hopeless: frozenset[int] = frozenset()
    settled: bool = False


@dataclass(slots=True)
class FunctionResult:
    """What the passes over a function found, best of all; `record` is that of the last pass."""

    record: Record
    bounds: dict[int, LoopBound] = field(default_factory=dict)
    infeasible: frozenset[int] = frozenset()
    accesses: dict[tuple[int, int], tuple[int | None, int, int]] = field(default_factory=dict)
    targets: dict[int, Range] = field(default_factory=dict)
    unbounded: frozenset[int] = frozenset()
    depth: int | None = None
    attempt: Attempt | None = None
    curtailed: OutOfTime | None = None
    """where time was over before all was tried that might have found a bound"""


def thresholds(cfg: Cfg) -> list[int]:
    """The constants of a function's compares and sums, with their neighbours: where ranges stop growing first."""
    found = {0, SIGN - 1, SIGN, MASK}
    for block in cfg.blocks:
        for instruction in block.instructions:
            for constant in _constants(instruction):
                found.update((constant + offset) & MASK for offset in (-1, 0, 1))
    return sorted(found)


def _constants(instruction: Instruction) -> list[int]:
    operands = [o for op in instruction.ops if isinstance(op, Compute | SetFlags) for o in (op.a, op.b)]
    return [operand.value for operand in operands if isinstance(operand, Imm)]


def analyse_function(
    order: Order,
    entry: State,
    image: Image,
    calls: Calls,
    given: Mapping[int, LoopBound],
    ranking: Ranking | None,
    limits: Limits,
    thorough: bool = True,
    attempt: Attempt | None = None,
    guessing: Ranking | None = None,
) -> FunctionResult:
    """Analyse a function from an entry state. `given` are bounds proven or stated elsewhere; `guessing` gives numbers
    that may be bounds, for loops without one (`_confirmed`). Where not `thorough`, a
    loop that resists ranking arguments stays without a bound, and `attempt` of the result lets a later analysis from
    the same state go on there. What was found stays when the time is over (`curtailed`). Raises GaveUp, and OutOfTime
    where not even the first pass is complete."""
    if attempt is None:
        attempt = Attempt([], dict(given), {loop: bound.bound for loop, bound in given.items()})
    records, bounds, known = attempt.records, attempt.bounds, attempt.known
    spent: list[int] = []
    marks = thresholds(order.cfg) if order.nest.loops else []

    most = max(limits.most, MOST_PASSES * sum(len(block.instructions) for block in order.cfg.blocks))

    def execute(
        stepped: frozenset[int],
        width: int = 1,
        steps: int = limits.steps,
        earlier: Record | None = None,
        guessed: dict[int, int] | None = None,
    ) -> Record:
        policy = Policy(stepped, width, steps, most=most)
        execution = Execution(order, image, calls, policy, marks, known | (guessed or {}), limits.deadline, earlier)
        record = execution.execute(entry.copy())
        spent.append(execution.summary_steps)
        if width == 1:
            attempt.hopeless |= stepped - execution.stepped - execution.cut_short
            attempt.settled = bool(stepped) and not execution.cut_short
        return record

    nest = order.nest.loops

    def prove(record: Record) -> int:
        """Seek arguments for the loops without a bound, with the values of a pass; how many were found."""
        missing = _missing(records, known) if ranking is not None else []
        for loop in missing:
            check(limits.deadline, order.cfg.blocks[nest[loop].header].address, order.cfg.name)
            assert ranking is not None
            found = ranking(nest[loop], record)
            if found is not None:
                attempt.settled = False
                known[loop] = found[0]
                bounds[loop] = LoopBound(found[0], Origin.ANALYSIS, found[1])
        return sum(loop in known for loop in missing)

    deep = _deep(order)
    loops = frozenset(range(len(order.nest.loops))) - deep

    def steppable() -> list[int]:
        return [loop for loop in _missing(records, known) if loop not in deep]

    known_whole = all(loop in given and given[loop].origin is Origin.LIBRARY for loop in loops)
    nested = any(loop.parent is not None for loop in order.nest.loops) and not known_whole
    first, curtailed = not records, None
    if first:
        records.append(execute(frozenset()))
    try:
        if first and steppable():
            records.append(execute(loops, steps=LIGHT, earlier=records[0]))
            # Later passes, which do not follow these loops step by step, keep what was found that way.
            known |= {loop: most for loop, most in records[-1].visits.items() if most is not None and loop not in known}
        proven = prove(records[0]) if first else 0
        for _ in range(MOST_PROOFS):
            # What the bounds say of values where these loops end may bound those that follow them.
            if not proven or spent[0] > REPEATED or not _missing(records, known):
                break
            records.append(execute(frozenset()))
            proven = prove(records[-1])
        if first and guessing is not None and ranking is not None and spent[0] <= REPEATED:
            guesses = {loop: g[0] for loop in _missing(records, known) if (g := guessing(nest[loop], records[-1]))}
            again = partial(execute, frozenset[int]())
            confirmed = _confirmed(guesses, nest, ranking, lambda guessed: again(guessed=guessed))
            if confirmed is not None:
                records.append(confirmed[0])
                bounds |= confirmed[1]
                known |= {loop: bound.bound for loop, bound in confirmed[1].items()}
                attempt.settled = False
        more = thorough and steppable()
        if not attempt.settled and (more or (first and nested and loops and _few(order, records, known, limits))):
            records.append(execute(loops - attempt.hopeless))
        if thorough and (left := steppable()):
            records.append(execute(_relatives(order, left) - deep, WIDTH))
    except GaveUp:
        pass
    except OutOfTime as reason:
        curtailed = reason
    result = _merge(order, records, bounds)
    result.curtailed = curtailed
    result.attempt = attempt if result.unbounded and not thorough else None
    return result


def _confirmed(
    guesses: dict[int, int], nest: Sequence[Loop], ranking: Ranking, execute: Callable[[dict[int, int]], Record]
) -> tuple[Record, dict[int, LoopBound]] | None:
    """The guesses that are bounds, with the pass that shows it; None where none is.

    A pass takes all guesses for granted, and with its values each of them is proven. Then they hold: were some loop's
    header to be executed more often, then once for the first time in an execution; all that came before is as the pass
    says, and of that the argument proves that it does not come to it (one that looks ahead proves nothing here: what
    comes later need not be as the pass says). So a store whose place is known as long as its
    loop goes on for no longer than it should does not destroy what ends the loop.
    """
    for _ in range(MOST_GUESSES):
        if not guesses:
            break
        record = execute(guesses)
        found = {loop: ranking(nest[loop], record) for loop in guesses}
        proven = {
            loop: one
            for loop, one in found.items()
            if one is not None and one[0] <= guesses[loop] and not looks_ahead(one[1])
        }
        if len(proven) == len(guesses):
            return record, {loop: LoopBound(one[0], Origin.ANALYSIS, one[1]) for loop, one in proven.items()}
        guesses = {loop: guesses[loop] for loop in proven}
    return None


def _deep(order: Order) -> frozenset[int]:
    """The loops of nests so deep that stepping through them comes to no end within any limits."""
    outermost = [loop for loop in order.nest.loops if order.height[loop.id] >= DEEPEST]
    return frozenset(loop.id for loop in order.nest.loops if any(loop.header in o.blocks for o in outermost))


def _relatives(order: Order, loops: list[int]) -> frozenset[int]:
    """The loops, those around and those inside them."""
    blocks = [order.nest.loops[loop].blocks for loop in loops]
    return frozenset(other.id for other in order.nest.loops if any(mine & other.blocks for mine in blocks))


def _few(order: Order, records: list[Record], known: Mapping[int, int], limits: Limits) -> bool:
    """Whether stepping through all loops, which gives totals of nests, is within the limits."""
    return _cost(order, records[0], known) <= limits.steps


def _missing(records: list[Record], known: Mapping[int, int]) -> list[int]:
    reached = set.intersection(*(set(record.visits) for record in records))
    return [loop for loop in reached if loop not in known and all(record.visits[loop] is None for record in records)]


def _cost(order: Order, record: Record, known: Mapping[int, int]) -> int:
    """About how many instructions a pass executes that steps through every loop."""
    inside: dict[int | None, int] = {}
    for loop in reversed(order.nest.loops):
        body = sum(len(order.cfg.blocks[b].instructions) for b in loop.blocks if order.innermost[b] == loop.id)
        visits = record.visits.get(loop.id, 1)
        times = visits if visits is not None else known.get(loop.id, MOST)
        inside[loop.parent] = inside.get(loop.parent, 0) + times * (body + inside.get(loop.id, 0))
    return inside.get(None, 0)


def _merge(order: Order, records: list[Record], given: Mapping[int, LoopBound]) -> FunctionResult:
    result = FunctionResult(records[-1])
    reached = set.intersection(*(set(record.visits) for record in records))
    for loop in sorted(reached):
        # A pass that was given a bound reports it as its own: what is no smaller than the given one is the given one.
        candidates = [given[loop]] if loop in given else []
        candidates += [
            LoopBound(visits, Origin.ANALYSIS, record.methods.get(loop, ""))
            for record in records
            if (visits := record.visits[loop]) is not None
        ]
        if candidates:
            best = min(candidates, key=lambda bound: bound.bound)
            totals = [total for record in records if (total := record.totals.get(loop)) is not None]
            totals += [candidate.total for candidate in candidates if candidate.total is not None]
            result.bounds[loop] = LoopBound(best.bound, best.origin, best.method, min(totals, default=None))
    result.unbounded = frozenset(reached - result.bounds.keys())
    taken = set.intersection(*(record.taken for record in records))
    result.infeasible = frozenset(range(len(order.cfg.edges))) - taken
    for record in records:
        for key, place in record.accesses.items():
            result.accesses[key] = _smaller(result.accesses.get(key), place)
        for address, values in record.targets.items():
            before = result.targets.get(address)
            result.targets[address] = values if before is None or values.size < before.size else before
    depths = [record.depth for record in records if record.depth is not None]
    result.depth = min(depths, default=None)
    return result


def _smaller(
    first: tuple[int | None, int, int] | None, second: tuple[int | None, int, int]
) -> tuple[int | None, int, int]:
    if first is None or first[0] is None:
        return second
    if second[0] is None:
        return first
    return second if second[2] - second[1] < first[2] - first[1] else first


__all__ = ["FunctionResult", "Limits", "analyse_function", "thresholds"]
