"""The response of a task per transition and per state of its machines, not one number for all of its jobs.

A job that takes transition t of a machine costs c_t there, not E(1). As the q-th job of a busy period it ends a run of
q transitions, so E^t(q) = c_t + max over runs of q - 1 transitions that end in the source of t, and

    w^t(q) = least fixed point of B + E^t(q) + (other parts of the task)(q) + sum over j of E_j(ceil((w + J_j) / T_j))
    R^t    = max over q of J + w^t(q) - (q-1) T,  over the jobs of the longest busy period

The greatest R^t over the transitions of a task's only machine is the task's response. Where the busy period is not
known to end, and for the exact method, whose runs are those of the worst job, the task's response bounds every R^t.
"""

from __future__ import annotations

from collections.abc import Sequence

from mauve.records import record
from mauve.timing.deferred import end_of, is_deferred, section_of, start_of
from mauve.timing.level import Budget, Interference, finish
from mauve.timing.psm import Psm, PsmTransition
from mauve.timing.response import STEPS, Analysis, Method, interference_on
from mauve.timing.task import Kind, Task
from mauve.timing.traces import PsmCurve

JOBS = 1024
"""In busy periods of more jobs the response of the task stands for that of its transitions."""


@record
class TransitionResponse:
    """The response of a job that takes this transition of the machine `machine`; `worst_job` is the q that attains it.

    `own` is False where the task's response stands in for a tighter one.
    """

    machine: str
    transition: PsmTransition
    wcrt: int
    worst_job: int
    own: bool = True


@record
class StateResponse:
    """The response of a job that finds the machine in this state: the greatest of its transitions."""

    machine: str
    state: str
    wcrt: int


def transition_responses(analysis: Analysis, name: str, steps: int = STEPS) -> tuple[TransitionResponse, ...]:
    """Per transition of the task's machines, merged alternatives included, the response of a job that takes it.

    Empty where the task has no response time or no machine; transitions of states that are never reached are left out.
    """
    result = analysis.result(name)
    task = analysis.task(name)
    if result.wcrt is None:
        return ()
    jobs = 1 if analysis.method is Method.PAPER else _jobs(task, result.busy_period)
    others = interference_on(task, analysis.tasks)
    budget = Budget(steps)
    found = []
    for place, part in enumerate(task.work):
        if not isinstance(part.curve, PsmCurve):
            continue
        before = _costs_before(part.curve.psm, jobs or 1)
        for transition in part.curve.psm.transitions:
            for one in (transition, *transition.alternatives):
                if one.source not in before:
                    continue
                worst = None
                if jobs:
                    worst = _response(task, place, one, before[one.source][:jobs], others, budget)
                if worst is None or worst[0] > result.wcrt:
                    found.append(TransitionResponse(part.name, one, result.wcrt, result.worst_job, own=False))
                else:
                    found.append(TransitionResponse(part.name, one, *worst))
    return tuple(found)


def state_responses(responses: Sequence[TransitionResponse]) -> tuple[StateResponse, ...]:
    """Per machine and state the greatest response of the transitions from there."""
    worst: dict[tuple[str, str], int] = {}
    for one in responses:
        key = one.machine, one.transition.source
        worst[key] = max(worst.get(key, 0), one.wcrt)
    return tuple(StateResponse(*key, wcrt) for key, wcrt in worst.items())


def _jobs(task: Task, busy: int | None) -> int:
    """How many jobs the longest busy period has at most; 0 for too many, or for none known."""
    jobs = 0 if busy is None else max(1, -(-(busy + task.jitter) // task.period))
    return jobs if jobs <= JOBS else 0


def _costs_before(psm: Psm, length: int) -> dict[str, list[int | None]]:
    """Per reachable state s the greatest cost of 0 .. length - 1 transitions that end in s; None where no run does."""
    into: dict[str, list[PsmTransition]] = {}
    reachable, work = {psm.initial}, [psm.initial]
    outgoing: dict[str, list[PsmTransition]] = {}
    for transition in psm.transitions:
        outgoing.setdefault(transition.source, []).append(transition)
    while work:
        for transition in outgoing.get(work.pop(), ()):
            into.setdefault(transition.target, []).append(transition)
            if transition.target not in reachable:
                reachable.add(transition.target)
                work.append(transition.target)
    rows: dict[str, list[int | None]] = {state: [0] for state in psm.states if state in reachable}
    for at in range(length - 1):
        for state, row in rows.items():
            costs = [t.cost + known for t in into.get(state, ()) if (known := rows[t.source][at]) is not None]
            if state not in outgoing and row[at] is not None:
                costs.append(row[at] or 0)
            row.append(max(costs, default=None))
    return rows


def _response(
    task: Task, place: int, one: PsmTransition, before: Sequence[int | None], others: Interference, budget: Budget
) -> tuple[int, int] | None:
    """R^t and the job that attains it; None where the budget ends."""
    rest = Task(
        task.name,
        task.priority,
        task.period,
        task.deadline,
        tuple(part for at, part in enumerate(task.work) if at != place),
        overhead=task.overhead,
    )
    part = task.work[place]
    handlers = Interference()
    for other in others.tasks:
        if other.kind is not Kind.TASK:
            handlers.add(other)
    worst: tuple[int, int] | None = None
    for q in range(1, len(before) + 1):
        # A slow part runs in some jobs only: as the last job it ends the run of its activations so far.
        earlier = before[task.activations(part, q) - 1]
        if earlier is None:
            continue
        end = _end(task, rest, q, earlier, one.cost, others, handlers, budget)
        if end is None:
            return None
        lasting = task.jitter + end - (q - 1) * task.period
        if worst is None or lasting > worst[0]:
            worst = lasting, q
    return worst


def _end(
    task: Task,
    rest: Task,
    q: int,
    earlier: int,
    cost: int,
    others: Interference,
    handlers: Interference,
    budget: Budget,
) -> int | None:
    """w^t(q): `earlier` and `cost` of the machine, and the `rest` of the task's work."""
    if not is_deferred(task):
        return finish(others, task.blocking + earlier + cost + rest.demand(q), 0, budget)
    last = cost + rest.demand(1)
    section = last if not task.preemptive else min(section_of(task), last)
    start = start_of(others, task.blocking + earlier + rest.demand(q - 1) + last - section, 0, budget)
    return None if start is None else end_of(handlers, start, section, budget)
