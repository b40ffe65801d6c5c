"""Recursion: the contexts of a program, which may call each other in circles, as contexts that do not.

Where abstract values lead each call on to another context until one calls no further, there is no circle. Else a fact
says how many activations of a function are under way at once: its contexts, and all others on the circle, are then kept
apart by that number, and the call that would exceed it is infeasible.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from mauve.records import record
from mauve.wcet.binary.callgraph import way_round
from mauve.wcet.binary.loops import strong_components
from mauve.wcet.flow.result import ContextKey, FunctionFlow
from mauve.wcet.result import Problem, ProblemKind

MOST = 20_000
"""How many contexts a program may have with its recursions unrolled."""

Node = tuple[ContextKey, int]
"""A context, and how many activations of the functions that facts speak of are under way in its circle."""


@record
class Unrolled:
    """The contexts, callees before callers, of which each has a name of its own; `words` are the names of the contexts
    that were multiplied without what tells their copies apart."""

    entry: ContextKey
    flows: Mapping[ContextKey, FunctionFlow]
    words: Mapping[ContextKey, str]
    problems: tuple[Problem, ...] = ()


def unroll(entry: ContextKey, flows: Mapping[ContextKey, FunctionFlow], depths: Mapping[int, int]) -> Unrolled:
    """The contexts without circles. `depths`: the greatest number of activations under way, by function. A circle that
    no function of `depths` is on is a problem."""
    # Callers come first, so that a way round is told from the function that is called first.
    keys = [*flows][::-1]
    numbers = {key: number for number, key in enumerate(keys)}
    following = [[numbers[callee] for callee in _callees(flows[key]) if callee in numbers] for key in keys]
    circle: dict[ContextKey, int] = {}
    most: list[int] = []
    problems: list[Problem] = []
    for component in strong_components(following, range(len(keys))):
        if len(component) == 1 and component[0] not in following[component[0]]:
            continue
        free = _circle(component, following, keys, depths)
        if free is not None:
            problems.append(_problem([flows[keys[number]] for number in free]))
        circle |= {keys[number]: len(most) for number in component}
        limited = {keys[number][0] for number in component}
        most.append(sum(depth for key, depth in depths.items() if key in limited))
    if problems or not circle:
        ordered = {keys[n]: flows[keys[n]] for c in strong_components(following, range(len(keys))) for n in c}
        return Unrolled(entry, ordered, {}, tuple(problems))
    return _copies(entry, flows, depths, circle, most)


def _callees(flow: FunctionFlow) -> Iterator[ContextKey]:
    for index, contexts in flow.calls.items():
        if index not in flow.infeasible:
            yield from contexts


def _circle(
    component: list[int], following: list[list[int]], keys: list[ContextKey], depths: Mapping[int, int]
) -> list[int] | None:
    """A way round that no function of `depths` is on."""
    rest = [number for number in component if keys[number][0] not in depths]
    inside = set(rest)
    kept = [[other for other in ways if other in inside] for ways in following]
    for part in strong_components(kept, rest):
        if len(part) > 1 or part[0] in kept[part[0]]:
            return way_round(part, kept)
    return None


def _problem(around: list[FunctionFlow]) -> Problem:
    names = [flow.cfg.name for flow in around]
    kept = [name for name, before in zip(names, [None, *names], strict=False) if name != before]
    path = kept if len(kept) > 1 else [names[0], names[0]]
    first = around[0].cfg
    return Problem(ProblemKind.RECURSION, f"recursion: {' -> '.join(path)}", first.address, first.name)


def _copies(
    entry: ContextKey,
    flows: Mapping[ContextKey, FunctionFlow],
    depths: Mapping[int, int],
    circle: Mapping[ContextKey, int],
    most: list[int],
) -> Unrolled:
    """Depth first from the entry: each context once for each number of activations."""

    def called(caller: Node, callee: ContextKey) -> Node | None:
        mine = circle.get(callee)
        if mine is None:
            return callee, 0
        before = caller[1] if circle.get(caller[0]) == mine else 0
        level = before + (callee[0] in depths)
        return (callee, level) if level <= most[mine] else None

    start: Node = (entry, int(entry in circle and entry[0] in depths))
    order: dict[Node, None] = {}
    seen = {start}
    stack = [(start, False)]
    while stack:
        node, finished = stack.pop()
        if finished:
            order[node] = None
            continue
        stack.append((node, True))
        for callee in _callees(flows[node[0]]):
            after = called(node, callee) if callee in flows else None
            if after is not None and after not in seen:
                seen.add(after)
                stack.append((after, False))
        if len(seen) > MOST:
            first = flows[entry].cfg
            message = f"the recursions of {first.name} have more than {MOST} contexts"
            problem = Problem(ProblemKind.LIMIT, message, first.address, first.name)
            return Unrolled(entry, dict(flows), {}, (problem,))
    names = {node: _name(node) for node in order}
    found: dict[ContextKey, FunctionFlow] = {}
    for node in order:
        flow = flows[node[0]]
        calls = {
            index: tuple(names[after] for callee in contexts if (after := called(node, callee)) in names)
            for index, contexts in flow.calls.items()
        }
        ended = {index for index, contexts in flow.calls.items() if contexts and not calls[index]}
        found[names[node]] = replace(flow, calls=calls, infeasible=flow.infeasible | ended)
    words = {names[node]: node[0][1] for node in order if node[1]}
    return Unrolled(names[start], found, words)


def _name(node: Node) -> ContextKey:
    (key, words), level = node
    return (key, f"{words}, {level} deep" if words else f"{level} deep") if level else (key, words)
