"""Calls of a known sorting routine: bounded by the number and size of the elements, for any comparison function.

The routine is known by its instructions (`library`), and the table says how often each of its loops runs, whatever the
comparisons answer. So its instructions are not interpreted: what a call takes follows from its arguments.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from mauve.records import record
from mauve.wcet.binary.graph import Cfg, Edge, UnresolvedKind
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.flow.domain import TOP, Range
from mauve.wcet.flow.library import KnownFunction, fingerprint, known_bound, known_functions
from mauve.wcet.flow.result import FunctionFlow, LoopBound
from mauve.wcet.result import Origin, Problem, ProblemKind
from mauve.wcet.routines import HEAD

MOST_COMPARISONS = 16
"""How many functions may be the one that compares."""


@record
class Arguments:
    """What is known of a call: the number of elements, their size, the address of the function that compares, and that
    of the elements."""

    elements: Range
    size: Range
    compares: Range
    base: Range = TOP

    def exchanged(self, unit: int) -> bool:
        """Whether elements may be exchanged in a loop that takes bytes (`unit` 1), words (4: one element at a time)."""
        words = _divisible(self.base) and _divisible(self.size)
        return not words if unit == 1 else not (words and self.size.n == 0 and self.size.low == 4)


@record
class Sorted:
    """The flow of a call, and the functions that it calls by edge, as keys."""

    flow: FunctionFlow
    called: Mapping[int, tuple[int, ...]]


def sorting(cfg: Cfg) -> KnownFunction | None:
    """The table's entry for a function that sorts; None for any other."""
    if not any(cfg.key in edge.callees for edge in cfg.edges):
        return None
    if any(hole.kind is not UnresolvedKind.CALL for hole in cfg.unresolved):
        return None
    known = known_functions().get(fingerprint(cfg))
    return known if known is not None and known.sorts else None


def comparisons(arguments: Arguments, is_code: Callable[[int], bool]) -> tuple[int, ...]:
    """The functions that may be called to compare, as keys; empty where they are not known."""
    if arguments.compares.size > MOST_COMPARISONS:
        return ()
    keys = tuple(sorted(arguments.compares.members()))
    return keys if all(is_code(key) for key in keys) else ()


def sorted_flow(
    known: KnownFunction, cfg: Cfg, nest: LoopNest, arguments: Arguments, compares: tuple[int, ...]
) -> Sorted:
    """A call with such arguments. It calls `compares` wherever it calls through a pointer, and not itself."""
    holes = {hole.address for hole in cfg.unresolved}
    again = frozenset(index for index, edge in enumerate(cfg.edges) if cfg.key in edge.callees)
    called = {
        index: edge.callees or compares
        for index, edge in enumerate(cfg.edges)
        if index not in again and (edge.callees or _last(cfg, edge) in holes)
    }
    edges = tuple(replace(edge, callees=called.get(index, edge.callees)) for index, edge in enumerate(cfg.edges))
    graph = replace(cfg, edges=edges, unresolved=())
    problem = _problem(known, cfg, arguments, bool(compares) or not holes)
    bounds: dict[int, LoopBound] = {}
    if problem is None:
        greatest = {1: arguments.elements.unsigned_bounds()[1], 2: arguments.size.unsigned_bounds()[1]}
        loops = {loop.offset: loop for loop in known.loops}
        for loop in nest.loops:
            found = known_bound(known, loops[cfg.blocks[loop.header].address - cfg.address], greatest.__getitem__, True)
            assert found is not None
            bounds[loop.id] = LoopBound(found.bound, Origin.LIBRARY, found.method, found.total)
    problems = () if problem is None else (problem,)
    again |= _not_entered(known, cfg, nest, arguments)
    flow = FunctionFlow(graph, nest, bounds, again, {}, {}, problems, known.stack)
    return Sorted(flow, called if problem is None else {i: c for i, c in called.items() if cfg.edges[i].callees})


def _divisible(known: Range) -> bool:
    """Whether all members are multiples of 4."""
    return known.low % 4 == 0 and known.step * (known.n > 0) % 4 == 0


def _not_entered(known: KnownFunction, cfg: Cfg, nest: LoopNest, arguments: Arguments) -> frozenset[int]:
    """The edges into loops that exchange elements in another way than their size and place ask for."""
    units = {loop.offset: loop.exchanges for loop in known.loops if loop.exchanges}
    closed: set[int] = set()
    for loop in nest.loops:
        unit = units.get(cfg.blocks[loop.header].address - cfg.address)
        if unit is not None and not arguments.exchanged(unit):
            closed |= {i for i, edge in enumerate(cfg.edges) if edge.target == loop.header} - set(loop.back_edges)
    return frozenset(closed)


def _last(cfg: Cfg, edge: Edge) -> int:
    return cfg.blocks[edge.source].instructions[-1].address


def _problem(known: KnownFunction, cfg: Cfg, arguments: Arguments, compares: bool) -> Problem | None:
    """What is missing for a bound."""
    elements, size = arguments.elements.unsigned_bounds(), arguments.size.unsigned_bounds()
    suggestions: tuple[str, ...] = (f'assume "{cfg.name}" argument 2 from 0 to N',)
    if elements[1] > known.most:
        reason = f"it sorts as many elements as its argument 2 says, which is not known to be at most {known.most}"
    elif size[0] == 0 or size[1] > 1 << 12:
        reason = "it moves elements of as many bytes as its argument 3 says, which is not known"
        suggestions = (f'assume "{cfg.name}" argument 3 from 1 to N',)
    elif not compares:
        reason, suggestions = "it calls the function that its argument 4 points to, which is not known", ()
    else:
        return None
    message = f"{HEAD} `{cfg.name}` has no bound: {reason}"
    return Problem(ProblemKind.LOOP, message, cfg.address, cfg.name, suggestions=suggestions)
