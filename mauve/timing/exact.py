"""The exact response time of machines: concrete runs instead of workload curves (combinatorial refinement).

A workload curve takes its maximum at each length over all runs, so it may mix runs that cannot happen together. For a
job that ends before its successor arrives (R <= T) and interferers without jitter, the worst case is a synchronous
release with one concrete run per machine (Stigge and Yi, combinatorial abstraction refinement, 2013): a request
function, here the prefix sums of a run, as every transition of a PSM takes one period. Only the runs that no other run
dominates at every length matter. They are the leaves of a binary tree per machine whose inner nodes hold maxima; the
search starts from the roots (which are the workload curves) and splits only the combination with the greatest response.
"""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heappop, heappush

from mauve.records import record
from mauve.timing.level import Interference
from mauve.timing.psm import Psm, reachable_edges
from mauve.timing.task import Task
from mauve.timing.traces import ConstantCurve, Curve, FramesCurve, PsmCurve

COMPARISONS = 300_000
"""Comparisons of runs spent on one machine before its curve is used instead."""

COMBINATIONS = 20_000
"""Combinations of runs evaluated per task before the greatest bound so far is taken."""

Totals = tuple[int, ...]


@record
class Refinement:
    """The response w(1), a run for each machine that attains it as (task, place in its work, costs of its jobs).

    `complete` is False where a limit was met: the value is then a sound bound, not above that of the curves.
    """

    finish: int
    charges: tuple[tuple[str, int, tuple[int, ...]], ...]
    complete: bool


@record
class _Node:
    """The greatest totals of 0, 1, 2, ... jobs over the runs below; a leaf has no halves."""

    totals: Totals
    halves: tuple[_Node, ...]


@record
class _Machine:
    task: str
    place: int
    period: int
    root: _Node
    concrete: bool


def refine(task: Task, others: Interference, bound: int, known: dict[int, Runs]) -> Refinement | None:
    """The response of the first job of `task`, given the `bound` of the curves; None where this does not cover it.

    Covered are: no jitter anywhere, and bound <= period. Blocking is added as it is. `known` keeps the runs of each
    curve (by its id) from one task to the next.
    """
    if bound > task.period or task.jitter or any(other.jitter for other in others.tasks):
        return None
    fixed, machines = _split(others, bound, known)
    base = task.blocking + task.demand(1)
    if not machines:
        return Refinement(bound, (), True)

    def response(nodes: Sequence[_Node]) -> int:
        tables = [(node.totals, machine.period) for node, machine in zip(nodes, machines, strict=True)]
        at = 1
        while True:
            then = base + fixed.demand(at) + sum([totals[-(-at // period)] for totals, period in tables])
            if then <= at:
                return at if then else 0
            at = then

    roots = tuple(machine.root for machine in machines)
    heap: list[tuple[int, int, tuple[_Node, ...]]] = [(-response(roots), 0, roots)]
    count = 1
    while True:
        negative, _, nodes = heappop(heap)
        splittable = [place for place, node in enumerate(nodes) if node.halves]
        if not splittable or count > COMBINATIONS:
            complete = not splittable and all(machine.concrete for machine in machines)
            return Refinement(-negative, _charges(machines, nodes), complete)
        widest = max(splittable, key=lambda place: _slack(nodes[place]))
        for half in nodes[widest].halves:
            split = (*nodes[:widest], half, *nodes[widest + 1 :])
            # The count breaks ties, so that nodes are never compared.
            heappush(heap, (-response(split), count, split))
            count += 1


def _slack(node: _Node) -> int:
    """How much a split of the node can take away."""
    return sum(node.totals) - min(sum(half.totals) for half in node.halves)


def _charges(machines: Sequence[_Machine], nodes: Sequence[_Node]) -> tuple[tuple[str, int, tuple[int, ...]], ...]:
    return tuple(
        (machine.task, machine.place, tuple(later - node.totals[at] for at, later in enumerate(node.totals[1:])))
        for machine, node in zip(machines, nodes, strict=True)
    )


def _split(others: Interference, window: int, known: dict[int, Runs]) -> tuple[Interference, list[_Machine]]:
    """The interference of constant costs, and the machines with the runs that fit into the window."""
    fixed = Interference()
    fixed.plain = others.plain
    machines = []
    for other in others.tasks:
        for place, part in enumerate(other.work):
            if isinstance(part.curve, ConstantCurve):
                continue
            period = part.period or other.period
            jobs = max(1, -(-window // period))
            runs = _request_functions(part.curve, jobs, known)
            if runs is None:
                root = _Node(tuple(part.curve.total(count) for count in range(jobs + 1)), ())
            else:
                root = _tree(sorted(runs, reverse=True))
            machines.append(_Machine(other.name, place, period, root, runs is not None))
    return fixed, machines


def _tree(runs: Sequence[Totals]) -> _Node:
    """A balanced tree over the runs, neighbours (in lexicographic order) first."""
    if len(runs) == 1:
        return _Node(runs[0], ())
    middle = len(runs) // 2
    halves = (_tree(runs[:middle]), _tree(runs[middle:]))
    return _Node(tuple(map(max, halves[0].totals, halves[1].totals)), halves)


def _request_functions(curve: Curve, jobs: int, known: dict[int, Runs]) -> list[Totals] | None:
    """The totals after 0 .. jobs jobs of every run that no other dominates; None if they are too many or unknown."""
    match curve:
        case FramesCurve():
            size = len(curve.frames)
            runs = []
            for start in range(size):
                totals = [0]
                for job in range(jobs):
                    totals.append(totals[-1] + curve.frames[(start + job) % size])
                runs.append(tuple(totals))
            return undominated(runs)
        case PsmCurve():
            if id(curve) not in known:
                known[id(curve)] = Runs(curve.psm)
            return known[id(curve)].of_length(jobs)
    return None


class Runs:
    """The runs of a machine that no other dominates, per state they start in; grows by the job."""

    __slots__ = ("_edges", "_fronts", "_jobs", "_work")

    def __init__(self, psm: Psm) -> None:
        _, edges = reachable_edges(psm)
        self._edges = [out or [(0, state)] for state, out in enumerate(edges)]
        self._fronts: list[list[Totals]] = [[(0,)] for _ in edges]
        self._jobs = 0
        self._work = COMPARISONS

    def of_length(self, jobs: int) -> list[Totals] | None:
        """The totals of all undominated runs of so many jobs; None where that takes too many comparisons."""
        while self._jobs < jobs:
            longer = []
            for out in self._edges:
                runs = [(0, *[cost + n for n in run]) for cost, target in out for run in self._fronts[target]]
                self._work -= len(runs) ** 2
                if self._work < 0:
                    return None
                longer.append(undominated(runs))
            self._fronts = longer
            self._jobs += 1
        # A longer run than asked for is cut: what dominates it dominates its beginning too.
        every = {run[: jobs + 1] for front in self._fronts for run in front}
        return undominated(tuple(every)) if len(every) ** 2 <= COMPARISONS else None


def undominated(runs: Sequence[Totals]) -> list[Totals]:
    """The runs of one length that no other reaches or exceeds at every length, in falling lexicographic order."""
    kept: list[Totals] = []
    for run in sorted(set(runs), reverse=True):
        if not any(all(map(int.__ge__, other, run)) for other in kept):
            kept.append(run)
    return kept
