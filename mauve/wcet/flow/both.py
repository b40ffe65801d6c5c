"""What two analyses of one program found, put together: each loop has the better of two bounds."""

from __future__ import annotations

from dataclasses import replace

from mauve.wcet.flow.functions import POINTERS
from mauve.wcet.flow.result import FunctionFlow, LoopBound, ProgramFlow
from mauve.wcet.result import ProblemKind

Place = tuple[int, int]
"""A loop: its function (a key) and the address of its header."""


def better(flow: ProgramFlow, other: ProgramFlow) -> ProgramFlow:
    """The first result, with the bounds of the second for loops that have none or a greater one in the first. Both are
    of the same program from the same entry, so what the second says of a loop in all its contexts is so in all of the
    first, unless the second does not know all calls. Where a run left loops of a function one entry by the ways that it
    took, headers are not those of the same loops: nothing is taken over then."""
    if any(hole.kind in POINTERS for function in other.functions.values() for hole in function.cfg.unresolved):
        return flow
    found = _bounds(other)
    nests = {function.cfg.key: function.nest for function in other.functions.values()}
    functions = {
        key: _with(function, found) if nests.get(key[0]) in (None, function.nest) else function
        for key, function in flow.functions.items()
    }
    return replace(flow, functions=functions)


def _bounds(flow: ProgramFlow) -> dict[Place, LoopBound | None]:
    """The bound of each loop in all contexts; None where one of them leaves it open."""
    found: dict[Place, LoopBound | None] = {}
    for function in flow.functions.values():
        left_open, all_open = _open(function), _is_partial(function)
        for loop in function.nest.loops:
            place = function.cfg.key, function.cfg.blocks[loop.header].address
            bound = function.bounds.get(loop.id)
            if bound is None and (all_open or place[1] in left_open):
                found[place] = None
            elif bound is not None:
                known = found.setdefault(place, bound)
                if known is not None and known.bound < bound.bound:
                    found[place] = bound
    return found


def _open(function: FunctionFlow) -> set[int | None]:
    return {problem.address for problem in function.problems if problem.kind is ProblemKind.LOOP}


def _is_partial(function: FunctionFlow) -> bool:
    """Whether a loop without a bound may be reached all the same: the function was not analysed to its end."""
    return bool(function.nest.irreducible) or any(p.kind is not ProblemKind.LOOP for p in function.problems)


def _with(function: FunctionFlow, found: dict[Place, LoopBound | None]) -> FunctionFlow:
    left_open = _open(function)
    bounds, closed = dict(function.bounds), set()
    for loop in function.nest.loops:
        header = function.cfg.blocks[loop.header].address
        mine, other = bounds.get(loop.id), found.get((function.cfg.key, header))
        if other is None:
            continue
        if mine is None and header in left_open:
            bounds[loop.id] = replace(other, total=None)
            closed.add(header)
        elif mine is not None and other.bound < mine.bound:
            bounds[loop.id] = replace(other, total=mine.total)
    if bounds == function.bounds:
        return function
    problems = tuple(p for p in function.problems if p.kind is not ProblemKind.LOOP or p.address not in closed)
    return replace(function, bounds=bounds, problems=problems)


__all__ = ["better"]
