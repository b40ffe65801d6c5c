"""The choices of a simulation: when jobs arrive, which transitions they take, how long these last.

All are drawn from generators seeded by the settings' seed and the names of processor and task, so a run can be had
again, and one more task leaves the choices of the others as they were.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count
from random import Random

from mauve.records import changed, record
from mauve.timing.psm import CostPart, Psm, PsmTransition
from mauve.timing.simulation.system import Arrivals, Execution, Hold, Jitter, Offsets, Runs, Settings, SimTask
from mauve.timing.task import Task, Workload
from mauve.timing.traces import ConstantCurve, FramesCurve, PsmCurve, TableCurve

STRETCH = 256
"""A worst run is planned for so many activations at most."""

PLANNED = 200_000
"""A worst run is planned for fewer where states x activations exceeds this."""

Step = tuple[str, tuple[CostPart, ...]]
"""What one activation of a workload does: its name, and its parts."""


def generator(settings: Settings, *names: str) -> Random:
    """The generator for one purpose."""
    return Random(f"{settings.seed}/" + "/".join(names))


# --------------------------------------------------------------------------------------------------------- arrivals
def arrivals(one: SimTask, settings: Settings, rng: Random) -> Iterator[tuple[int, int]]:
    """Nominal arrival and release of each job, in order; jobs of a task are never released out of order."""
    task = one.task
    start = rng.randrange(task.period) if settings.offsets is Offsets.RANDOM else 0
    worst = settings.jitter is Jitter.WORST
    arrival = start - task.jitter if worst else start
    release = start
    spread = one.sporadic and settings.arrivals is Arrivals.SPORADIC
    while True:
        delay = rng.randint(0, task.jitter) if settings.jitter is Jitter.RANDOM and task.jitter else 0
        release = max(release, arrival + delay)
        yield arrival, release
        arrival += task.period
        if spread and rng.random() < 0.5:
            arrival += rng.randint(0, task.period)


# ------------------------------------------------------------------------------------------------------------- runs
def steps(part: Workload, runs: Runs, length: int, rng: Random) -> Iterator[Step]:
    """What each activation of a workload does, for ever. `length` is how many activations a busy period has."""
    curve = part.curve
    match curve:
        case PsmCurve():
            for taken in _transitions(curve.psm, runs, length, rng):
                yield f"{taken.source} -> {taken.target}", taken.parts or (CostPart(part.name, taken.cost),)
        case FramesCurve():
            size = len(curve.frames)
            at = _frame(curve.frames, runs, length, rng)
            while True:
                yield (f"frame {at + 1}" if size > 1 else ""), (CostPart(part.name, curve.frames[at]),)
                at = (at + 1) % size
        case TableCurve():
            for cost in _table(curve, runs, rng):
                yield "", (CostPart(part.name, cost),)
        case _:
            cost = curve.cost if isinstance(curve, ConstantCurve) else curve.total(1)
            while True:
                yield "", (CostPart(part.name, cost),)


def _frame(costs: Sequence[int], runs: Runs, length: int, rng: Random) -> int:
    """The frame to start with: for a worst run the one from which `length` frames cost most."""
    size = len(costs)
    match runs:
        case Runs.FIRST:
            return 0
        case Runs.RANDOM:
            return rng.randrange(size)
        case Runs.WORST:
            rest = length % size
            return max(range(size), key=lambda at: (sum(costs[(at + n) % size] for n in range(rest)), costs[at], -at))


def _table(curve: TableCurve, runs: Runs, rng: Random) -> Iterator[int]:
    """Costs of which no stretch exceeds the table: each job the most that all stretches ending with it leave, or a
    random part of that."""
    totals = curve.values
    last: list[int] = []
    while True:
        spent, most = 0, totals[1]
        for length, cost in enumerate(reversed(last), start=2):
            spent += cost
            most = min(most, totals[length] - spent)
        cost = rng.randint(0, most) if runs is Runs.RANDOM and rng.random() < 0.5 else most
        yield cost
        last = [*last, cost][2 - len(totals) :] if len(totals) > 2 else []


def _transitions(psm: Psm, runs: Runs, length: int, rng: Random) -> Iterator[PsmTransition]:
    out: dict[str, list[PsmTransition]] = {state: [] for state in psm.states}
    for transition in psm.transitions:
        out[transition.source].append(transition)
    match runs:
        case Runs.FIRST:
            return _first(psm, out)
        case Runs.RANDOM:
            return _random(psm, out, rng)
        case Runs.WORST:
            return _worst(psm, out, length)


def _idle(state: str) -> PsmTransition:
    """What a machine does in a state without a transition."""
    return PsmTransition(state, state, 0)


def _first(psm: Psm, out: dict[str, list[PsmTransition]]) -> Iterator[PsmTransition]:
    state = psm.initial
    while True:
        taken = out[state][0] if out[state] else _idle(state)
        yield taken
        state = taken.target


def _random(psm: Psm, out: dict[str, list[PsmTransition]], rng: Random) -> Iterator[PsmTransition]:
    """The run may have gone on for a while when the simulation starts."""
    state = psm.initial
    for _ in range(rng.randrange(2 * len(psm.states))):
        state = rng.choice(out[state]).target if out[state] else state
    while True:
        taken = rng.choice(out[state]) if out[state] else _idle(state)
        taken = rng.choice((taken, *taken.alternatives)) if taken.alternatives else taken
        yield taken
        state = taken.target


def _worst(psm: Psm, out: dict[str, list[PsmTransition]], length: int) -> Iterator[PsmTransition]:
    """The witness of E(length) from the state where it starts, then the dearest run of that length from where that
    one ended, and so on. Ties go to the run that costs more at once, then to the first in order."""
    length = max(1, min(length, STRETCH, PLANNED // max(1, len(psm.states))))
    values = dict.fromkeys(psm.states, 0)
    plan: list[dict[str, PsmTransition]] = []
    for _ in range(length):
        best = {
            state: max(ways, key=lambda t: (t.cost + values[t.target], t.cost)) if ways else _idle(state)
            for state, ways in out.items()
        }
        values = {state: taken.cost + values[taken.target] for state, taken in best.items()}
        plan.append(best)
    state = max(_reachable(psm, out), key=lambda name: (values[name], plan[-1][name].cost))
    while True:
        for best in reversed(plan):
            taken = best[state]
            yield taken
            state = taken.target


def _reachable(psm: Psm, out: dict[str, list[PsmTransition]]) -> list[str]:
    seen = dict.fromkeys([psm.initial])
    work = [psm.initial]
    while work:
        for transition in out[work.pop()]:
            if transition.target not in seen:
                seen[transition.target] = None
                work.append(transition.target)
    return [state for state in psm.states if state in seen]


# ------------------------------------------------------------------------------------------------------------- jobs
@record
class Piece:
    """A stretch of a job's execution: `section` numbers the section that it belongs to, 0 for none; in the `tail` the
    job is not preempted any more; `wait` is time that the job spends off the processor instead."""

    length: int
    label: str
    section: int = 0
    resources: tuple[str, ...] = ()
    above_all: bool = False
    switch: bool = False
    tail: bool = False
    wait: bool = False


Plan = tuple[str, tuple[Piece, ...]]
"""What a job does: the transitions it takes in words, and its pieces."""


def plans(one: SimTask, settings: Settings, lengths: Sequence[int], rng: Random) -> Iterator[Plan]:
    """The plan of each job, in order; a workload with a period of its own takes part in some jobs only.

    `lengths` are the activations of each workload in a busy period.
    """
    task = one.task
    sources = [
        (steps(part, settings.runs, length, rng), *_share(task, part, settings.runs, rng))
        for part, length in zip(task.work, lengths, strict=True)
    ]
    locked = {part.label: part.holds for part in one.locked}
    waits = dict(one.waits)
    anywhere = settings.runs is Runs.RANDOM and bool(one.holds)
    number = 0
    while True:
        names: list[str] = []
        pieces: list[Piece] = []
        numbers = count(1)
        for source, every, phase in sources:
            if number % every == phase:
                name, parts = next(source)
                names.append(name)
                for work in parts:
                    if work.label in waits:
                        pieces += [_wait(work.label, waits[work.label], settings, rng) for _ in range(work.count)]
                        continue
                    held = locked.get(work.label, ()) * work.count
                    pieces += _overlay([Piece(work.cost, work.label)], held, numbers)
        held = _spread(one.holds, sum(p.length for p in pieces if not p.wait), rng) if anywhere else one.holds
        pieces = _overlay(pieces, held, numbers)
        if settings.execution is Execution.RANDOM:
            pieces = [piece if piece.wait else _shortened(piece, rng) for piece in pieces]
        yield ", ".join(filter(None, names)), _with_tail(_switched(pieces, task.overhead), task.tail)
        number += 1


def _share(task: Task, part: Workload, runs: Runs, rng: Random) -> tuple[int, int]:
    """In which jobs a workload takes part: every so many, and from which on."""
    every = (part.period or task.period) // task.period
    return every, rng.randrange(every) if runs is Runs.RANDOM else 0


def _wait(label: str, most: int, settings: Settings, rng: Random) -> Piece:
    """A wait: the longest, or a random part of that."""
    length = rng.randint(0, most) if settings.execution is Execution.RANDOM else most
    return Piece(length, label, wait=True)


def _spread(holds: Sequence[Hold], work: int, rng: Random) -> tuple[Hold, ...]:
    """The sections with stretches between them, as far as the work goes."""
    left = work - sum(hold.length for hold in holds)
    found: list[Hold] = []
    for hold in holds:
        gap = rng.randint(0, left) if left > 0 else 0
        left -= gap
        found += [Hold((), gap), hold]
    return tuple(found)


def _overlay(pieces: Sequence[Piece], holds: Sequence[Hold], numbers: Iterator[int]) -> list[Piece]:
    """The pieces with sections laid over them from the start; what holds a resource already keeps it."""
    if not holds:
        return list(pieces)
    left = list(reversed(pieces))
    found: list[Piece] = []
    for hold in holds:
        need = hold.length
        over = next(numbers) if hold.resources or hold.above_all else 0, hold.resources, hold.above_all
        while need > 0 and left:
            piece = left.pop()
            if piece.wait:
                found.append(piece)
                break
            taken = min(need, piece.length)
            own = piece.section, piece.resources, piece.above_all
            found.append(Piece(taken, piece.label, *(own if piece.section else over)))
            if piece.length > taken:
                left.append(Piece(piece.length - taken, piece.label, *own))
            need -= taken
    return found + left[::-1]


def _shortened(piece: Piece, rng: Random) -> Piece:
    length = rng.randint(0, piece.length) if rng.random() < 0.5 else piece.length
    return changed(piece, length=length)


def _switched(pieces: Sequence[Piece], overhead: int) -> tuple[Piece, ...]:
    """With the switch to the job and the one back; without pieces of no length."""
    kept = [piece for piece in pieces if piece.length]
    if not overhead:
        return tuple(kept)
    there, back = overhead - overhead // 2, overhead // 2
    ends = [Piece(there, "context switch", switch=True)], [Piece(back, "context switch", switch=True)] if back else []
    return (*ends[0], *kept, *ends[1])


def _with_tail(pieces: tuple[Piece, ...], tail: int) -> tuple[Piece, ...]:
    """The last `tail` units of execution marked as what nothing but interrupts preempts.

    A section that would last into it ends where it begins, as the analysis counts the two apart: with what is more
    urgent between them.
    """
    if not tail:
        return pieces
    found: list[Piece] = []
    for piece in reversed(pieces):
        taken = min(tail, piece.length)
        tail -= taken
        if taken:
            found.append(Piece(taken, piece.label, switch=piece.switch, tail=True))
        if piece.length > taken:
            found.append(changed(piece, length=piece.length - taken))
    return tuple(reversed(found))
