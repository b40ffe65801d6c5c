"""Periodic state machines (MAUVE paper, section III.C.2, figure 4): at each activation one transition fires.

A PSM is not deterministic: which transition of a state fires is unknown, only what each may cost at most.
Costs are integers in any unit (picoseconds in mauvec). A start pseudo-state is a state like any other, named as the
caller likes, e.g. `(start)`. A state without any transition is allowed: the machine then does nothing, at no cost.
The shape (what is reachable, what is never left) is computed and reported, never required.

Invariants, checked by `verify`: names are unique, the initial state and both ends of each transition are states, at
most one transition per ordered pair, costs are not negative, and parts, where given, sum to the cost.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction

from mauve.records import changed, record


@record
class CostPart:
    """One contribution to the cost of a transition, e.g. a codel (`label`) that runs `count` times, `cost` in all."""

    label: str
    cost: int
    count: int = 1

    def __str__(self) -> str:
        return f"{self.label} x{self.count}" if self.count > 1 else self.label


@record
class PsmTransition:
    """A transition, what it costs at most (its `parts` itemise that), and the cheaper ones merged into it."""

    source: str
    target: str
    cost: int
    label: str = ""
    parts: tuple[CostPart, ...] = ()
    alternatives: tuple[PsmTransition, ...] = ()

    def __str__(self) -> str:
        text = f"{self.source} -{self.cost}-> {self.target}"
        return f"{text}  {self.label}" if self.label else text


@record
class Psm:
    """A periodic state machine; build it with `make_psm`, which merges transitions between one pair of states."""

    name: str
    initial: str
    states: tuple[str, ...]
    transitions: tuple[PsmTransition, ...]

    def __str__(self) -> str:
        return format_psm(self)


def make_psm(name: str, initial: str, transitions: Iterable[PsmTransition], states: Iterable[str] = ()) -> Psm:
    """The PSM of these transitions; of several between one ordered pair the dearest stands (the first of equals).

    The others are kept in its `alternatives`, so that a later change of costs can merge again.
    States are listed in the order given, then as the transitions name them. Raises ValueError on a negative cost.
    """
    names = dict.fromkeys([*states, initial])
    merged: dict[tuple[str, str], list[PsmTransition]] = {}
    for transition in transitions:
        if transition.cost < 0:
            raise ValueError(f"a cost is not negative: {transition}")
        names[transition.source] = names[transition.target] = None
        merged.setdefault((transition.source, transition.target), []).extend(_unmerged(transition))
    return Psm(name, initial, tuple(names), tuple(_merge(group) for group in merged.values()))


def _unmerged(transition: PsmTransition) -> tuple[PsmTransition, ...]:
    return (changed(transition, alternatives=()), *transition.alternatives)


def _merge(group: list[PsmTransition]) -> PsmTransition:
    if len(group) == 1:
        return group[0]
    dearest = max(range(len(group)), key=lambda index: (group[index].cost, -index))
    return changed(group[dearest], alternatives=tuple(t for index, t in enumerate(group) if index != dearest))


def map_costs(psm: Psm, change: Callable[[PsmTransition], PsmTransition]) -> Psm:
    """The PSM with `change` applied to each transition and each merged alternative, merged by maximum again."""
    changed = [change(one) for transition in psm.transitions for one in _unmerged(transition)]
    return make_psm(psm.name, psm.initial, changed, psm.states)


def format_psm(psm: Psm, show: Callable[[int], str] = str) -> str:
    """A readable text: one line per transition, in order, with its parts; merged alternatives are not shown.

    `show` writes a cost, e.g. with its unit.
    """
    lines = [f"psm {psm.name}", f"  initial {psm.initial}"]
    width = max((len(t.source) for t in psm.transitions), default=0)
    target_width = max((len(t.target) for t in psm.transitions), default=0)
    cost_width = max((len(show(t.cost)) for t in psm.transitions), default=0)
    for t in psm.transitions:
        parts = " + ".join(f"{part} {show(part.cost)}" for part in t.parts)
        line = f"  {t.source:<{width}} -> {t.target:<{target_width}}  {show(t.cost):>{cost_width}}"
        line += f"  {t.label}" if t.label else ""
        line += f"  = {parts}" if parts else ""
        lines.append(line)
    sources = {t.source for t in psm.transitions}
    lines += [f"  {state} has no transition" for state in psm.states if state not in sources]
    return "\n".join(lines)


def verify(psm: Psm) -> list[str]:
    """What breaks the invariants of the module, as sentences; empty for a well-formed PSM."""
    faults = []
    if len(set(psm.states)) != len(psm.states):
        faults.append("a state is listed twice")
    if psm.initial not in psm.states:
        faults.append(f"the initial state {psm.initial} is not a state")
    pairs: set[tuple[str, str]] = set()
    for top in psm.transitions:
        if (top.source, top.target) in pairs:
            faults.append(f"two transitions from {top.source} to {top.target}")
        pairs.add((top.source, top.target))
        for t in (top, *top.alternatives):
            if t.source not in psm.states or t.target not in psm.states:
                faults.append(f"{t} does not join two states")
            if (t.source, t.target) != (top.source, top.target) or t.cost > top.cost:
                faults.append(f"{t} is not a cheaper alternative of {top}")
            if t.cost < 0 or any(part.cost < 0 for part in t.parts):
                faults.append(f"{t} has a negative cost")
            if t.parts and sum(part.cost for part in t.parts) != t.cost:
                faults.append(f"the parts of {t} do not sum to its cost")
    return faults


@record
class Shape:
    """What can be reached from where; all tuples in the order of `Psm.states`.

    `components` are the strongly connected components of the reachable part, an earlier one never reached from a later
    one; `cyclic` those with a cycle; `traps` the cyclic ones never left again although another cyclic one leads there
    (its costs are counted only until then); `dead_ends` the reachable states without any transition.
    """

    reachable: tuple[str, ...]
    unreachable: tuple[str, ...]
    components: tuple[tuple[str, ...], ...]
    cyclic: tuple[tuple[str, ...], ...]
    traps: tuple[tuple[str, ...], ...]
    dead_ends: tuple[str, ...]

    @property
    def strongly_connected(self) -> bool:
        """Whether every reachable state is reached from every other (what the paper expects of its PSMs)."""
        return len(self.components) == 1


def shape(psm: Psm) -> Shape:
    """The shape of a PSM as a graph, from its initial state."""
    index = {state: number for number, state in enumerate(psm.states)}
    successors = _successors(psm, index)
    components = strong_components(successors, index[psm.initial])
    home = {node: number for number, component in enumerate(components) for node in component}
    cyclic = [len(component) > 1 or component[0] in successors[component[0]] for component in components]
    leads_from_cycle = [False] * len(components)
    left = [False] * len(components)
    for number, component in enumerate(components):
        for node in component:
            for target in successors[node]:
                if home[target] != number:
                    left[number] = True
                    leads_from_cycle[home[target]] |= cyclic[number] or leads_from_cycle[number]
    named = [tuple(psm.states[node] for node in sorted(component)) for component in components]
    trap_numbers = [n for n in range(len(named)) if leads_from_cycle[n] and cyclic[n] and not left[n]]
    return Shape(
        reachable=tuple(state for state in psm.states if index[state] in home),
        unreachable=tuple(state for state in psm.states if index[state] not in home),
        components=tuple(named),
        cyclic=tuple(named[n] for n in range(len(named)) if cyclic[n]),
        traps=tuple(named[n] for n in trap_numbers),
        dead_ends=tuple(state for state in psm.states if index[state] in home and not successors[index[state]]),
    )


def _successors(psm: Psm, index: dict[str, int]) -> list[list[int]]:
    successors: list[list[int]] = [[] for _ in psm.states]
    for transition in psm.transitions:
        successors[index[transition.source]].append(index[transition.target])
    return successors


def strong_components(successors: list[list[int]], root: int) -> list[list[int]]:
    """The strongly connected components reachable from `root` in topological order (Tarjan, without recursion)."""
    order: dict[int, int] = {}
    low: dict[int, int] = {}
    stack: list[int] = []
    on_stack: set[int] = set()
    found: list[list[int]] = []
    work = [(root, 0)]
    while work:
        node, edge = work.pop()
        if edge == 0:
            order[node] = low[node] = len(order)
            stack.append(node)
            on_stack.add(node)
        descend = False
        for position in range(edge, len(successors[node])):
            target = successors[node][position]
            if target not in order:
                work += [(node, position + 1), (target, 0)]
                descend = True
                break
            if target in on_stack:
                low[node] = min(low[node], order[target])
        if descend:
            continue
        if low[node] == order[node]:
            component = [stack.pop()]
            while component[-1] != node:
                component.append(stack.pop())
            on_stack.difference_update(component)
            found.append(component)
        if work:
            parent = work[-1][0]
            low[parent] = min(low[parent], low[node])
    return found[::-1]


def reachable_edges(psm: Psm) -> tuple[tuple[str, ...], list[list[tuple[int, int]]]]:
    """The reachable states, and per state its transitions as (cost, number of the target among these states)."""
    out: dict[str, list[PsmTransition]] = {state: [] for state in psm.states}
    for transition in psm.transitions:
        out[transition.source].append(transition)
    seen = {psm.initial}
    work = [psm.initial]
    while work:
        for transition in out[work.pop()]:
            if transition.target not in seen:
                seen.add(transition.target)
                work.append(transition.target)
    states = tuple(state for state in psm.states if state in seen)
    number = {state: position for position, state in enumerate(states)}
    return states, [[(t.cost, number[t.target]) for t in out[state]] for state in states]


def max_cycle_mean(psm: Psm) -> Fraction:
    """The long-run cost per activation: the greatest mean over all reachable cycles, exact; 0 without a cycle.

    Karp's theorem, per strongly connected component: max over v of min over k of (D_n(v) - D_k(v)) / (n - k), where
    D_k(v) is the dearest walk of k transitions from a fixed state to v. O(states x transitions).
    """
    states, edges = reachable_edges(psm)
    successors = [[target for _, target in out] for out in edges]
    root = states.index(psm.initial)
    best = Fraction(0)
    for component in strong_components(successors, root):
        number = {node: position for position, node in enumerate(component)}
        inner = [[(cost, number[t]) for cost, t in edges[node] if t in number] for node in component]
        if any(inner):
            best = max(best, _karp(inner))
    return best


def _karp(edges: list[list[tuple[int, int]]]) -> Fraction:
    """The maximum cycle mean of one strongly connected component with at least one transition."""
    size = len(edges)
    incoming: list[list[tuple[int, int]]] = [[] for _ in edges]
    for source, out in enumerate(edges):
        for cost, target in out:
            incoming[target].append((cost, source))
    rows: list[list[int | None]] = [[0 if node == 0 else None for node in range(size)]]
    for _ in range(size):
        last = rows[-1]
        row: list[int | None] = []
        for sources in incoming:
            row.append(max([cost + at for cost, source in sources if (at := last[source]) is not None], default=None))
        rows.append(row)
    best = Fraction(0)
    for node in range(size):
        end = rows[size][node]
        if end is None:
            continue
        # The least fraction by cross-multiplication: creating a Fraction for each k would dominate the time.
        numerator, denominator = 0, 0
        for k in range(size):
            at = rows[k][node]
            if at is not None and (denominator == 0 or (end - at) * denominator < numerator * (size - k)):
                numerator, denominator = end - at, size - k
        if numerator * best.denominator > best.numerator * denominator:
            best = Fraction(numerator, denominator)
    return best
