"""The flow facts that a function's bound still waits for: loops without a bound, nested as they are, and what else a
fact can settle.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mauve.records import changed, record
from mauve.wcet.flow.facts import AtLine, AtSymbol, Fact, Place
from mauve.wcet.result import Problem, ProblemKind

if TYPE_CHECKING:
    from mauve.wcet.binary.elf import Binary
    from mauve.wcet.binary.lines import LineTable
    from mauve.wcet.flow.result import FunctionFlow, ProgramFlow


@record
class MissingLoop:
    """A loop without a bound (`bound` None), or one with a bound around such a loop. `place` is how a fact names it:
    by source line where that means this loop, else by symbol and offset. `copies` counts the loops of that place."""

    place: Place
    address: int
    source: str
    bound: int | None
    inner: tuple[MissingLoop, ...]
    copies: int = 1


@record
class MissingIn:
    """What is missing in one function; `callers` is a shortest way to it from the function asked for, that included."""

    function: str
    callers: tuple[str, ...]
    loops: tuple[MissingLoop, ...]
    others: tuple[Problem, ...]


def missing_facts(
    path: str,
    function: str,
    facts: Sequence[Fact] = (),
    *,
    initial_data: bool = False,
    timeout: float | None = None,
) -> tuple[MissingIn, ...] | Problem:
    """What keeps `function` and what it calls from having a bound, callers before callees; a problem where there is no
    such executable or function."""
    from mauve.wcet.analysis import elf_problem
    from mauve.wcet.binary.elf import ElfProblem, load
    from mauve.wcet.binary.lines import load_lines
    from mauve.wcet.flow.program import Programs

    binary = load(path)
    if isinstance(binary, ElfProblem):
        return elf_problem(binary)
    symbol = binary.function(function)
    if isinstance(symbol, ElfProblem):
        return elf_problem(symbol)
    lines = load_lines(binary)
    program = Programs(binary, facts, initial_data=initial_data, lines=lines).program(symbol.key, timeout)
    return _collect(program, binary, lines)


def _collect(program: ProgramFlow, binary: Binary, lines: LineTable) -> tuple[MissingIn, ...]:
    from mauve.wcet.assemble import call_paths
    from mauve.wcet.ipet.bottom_up import unresolved
    from mauve.wcet.routines import is_told

    paths = call_paths(program)
    found: dict[int, MissingIn] = {}
    told: set[tuple[str, ...]] = set()
    reached = sorted(paths, key=lambda key: len(paths[key]))
    for key in reached:
        flow = program.functions[key]
        loops = _loops(flow, None, binary, lines)
        holes = (*flow.problems, *unresolved(flow))
        others = tuple(problem for problem in holes if problem.kind is not ProblemKind.LOOP or is_told(problem))
        asked = _asked(flow, paths[key], lines) if loops else ()
        if asked:
            loops, others = (), (*(one for one in asked if one.suggestions not in told), *others)
            told |= {one.suggestions for one in asked}
        known = found.get(key[0])
        if known is None:
            found[key[0]] = MissingIn(flow.cfg.name, paths[key], loops, others)
        else:
            loops = _merged((*known.loops, *loops))
            found[key[0]] = changed(known, loops=loops, others=tuple(dict.fromkeys((*known.others, *others))))
    missing = [one for one in found.values() if one.loops or one.others]
    general = tuple(program.problems)
    if general:
        missing.insert(0, MissingIn(next(iter(paths.values()), ("",))[0], (), (), general))
    return tuple(missing)


def _asked(flow: FunctionFlow, path: tuple[str, ...], lines: LineTable) -> tuple[Problem, ...]:
    """For a routine of the library whose loops arguments bound, its own or those of the routine on the way to it: the
    facts about those arguments."""
    from mauve.wcet.routines import facts, is_library, routine

    name, at = next((name for name in (*path, flow.cfg.name) if facts(name)), ""), flow.cfg.address
    known, suggested = routine(name), facts(name)
    if known is None or not is_library(lines.source(at)):
        return ()
    message = f"`{name}`: {known.reason}"
    return (Problem(ProblemKind.LOOP, message, at, name, suggestions=suggested),)


def _loops(flow: FunctionFlow, parent: int | None, binary: Binary, lines: LineTable) -> tuple[MissingLoop, ...]:
    """The loops directly inside `parent` that miss a bound, or that hold one that does."""
    missing = {problem.address for problem in flow.problems if problem.kind is ProblemKind.LOOP}
    found = []
    for index, loop in enumerate(flow.nest.loops):
        if loop.parent != parent:
            continue
        inner = _loops(flow, index, binary, lines)
        address = flow.cfg.blocks[loop.header].address
        if address not in missing and not inner:
            continue
        bound = flow.bounds.get(index)
        known = None if bound is None or address in missing else bound.bound
        found.append(MissingLoop(_place(flow, index, binary, lines), address, lines.source(address), known, inner))
    return _merged(tuple(found))


def _place(flow: FunctionFlow, index: int, binary: Binary, lines: LineTable) -> Place:
    """A place that a fact can use for the loop and that means no other loop around or inside it."""
    from mauve.wcet.flow.matching import loops_at

    cfg, nest = flow.cfg, flow.nest
    loop = nest.loops[index]
    blocks = [loop.header, *sorted(cfg.edges[edge].source for edge in loop.back_edges)]
    header = cfg.blocks[loop.header].address
    for block in blocks:
        for instruction in (cfg.blocks[block].instructions[-1], cfg.blocks[block].instructions[0]):
            at = lines.location(instruction.address)
            if at is None:
                continue
            place = AtLine(*at)
            meant = loops_at(place, cfg, nest, lines.location, lambda name: None)
            if index in meant and all(nest.loops[other].parent == loop.parent for other in meant):
                return place
    symbol = binary.function_at(header)
    name = symbol.name if symbol is not None else cfg.name
    return AtSymbol(name, header - (symbol.address if symbol is not None else cfg.address))


def _merged(loops: tuple[MissingLoop, ...]) -> tuple[MissingLoop, ...]:
    """Loops with one place as one: copies that the compiler made, or contexts of the function."""
    found: dict[Place, MissingLoop] = {}
    for loop in sorted(loops, key=lambda one: one.address):
        known = found.get(loop.place)
        if known is None:
            found[loop.place] = loop
            continue
        copies = known.copies + (loop.address != known.address)
        bound = None if known.bound is None or loop.bound is None else max(known.bound, loop.bound)
        found[loop.place] = changed(known, copies=copies, bound=bound, inner=_merged((*known.inner, *loop.inner)))
    return tuple(found.values())
