"""From flow facts to loops: which loops of a function a fact speaks of, and how many header executions it allows.

A fact by address (or symbol + offset) means the loop whose header begins there, or else the innermost loop that holds
the instruction at that address, so that the address of the branch back does as well.

A fact by source line means loops whose control stands on that line. Compilers put the test of a `for` or `while` at the
header or at the latch, so a loop matches strongly when an instruction that ends one of its own blocks by a branch back
or out of the loop has the line, weakly when any other instruction of its header or latches has it. Own blocks are those
of no inner loop. A weak match gives way to a strong one inside or around it, and to any match inside it: the start of
an inner `for` often stands in the header of the outer loop.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from mauve.records import changed
from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import Loop, LoopNest
from mauve.wcet.flow.facts import AtAddress, AtLine, AtSymbol, Counting, Fact, LoopFact, Place
from mauve.wcet.result import Problem, ProblemKind

Lines = Callable[[int], tuple[str, int] | None]
"""The file and line of the instruction at an address, None where there is no line information."""

Symbols = Callable[[str], int | None]
"""The address of a symbol without its Thumb bit, None when there is none."""


@dataclass(frozen=True, slots=True)
class FactBound:
    """What a fact says of a loop: header executions per entry, and per execution of the function (None: nothing)."""

    bound: int | None
    total: int | None
    fact: LoopFact


@dataclass(slots=True)
class Matches:
    """The loops of one function that facts speak of.

    The smallest bound and total by loop index, the facts that matched (indices into the sequence given), remarks and
    contradictions.
    """

    bounds: dict[int, FactBound] = field(default_factory=dict)
    matched: set[int] = field(default_factory=set)
    notes: list[Problem] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)


def match_facts(
    facts: Sequence[Fact],
    cfg: Cfg,
    nest: LoopNest,
    lines: Lines,
    symbols: Symbols,
    derived: Mapping[int, int] | None = None,
    least: Mapping[int, int] | None = None,
) -> Matches:
    """Apply the loop facts to the loops of one function.

    `derived` holds the bounds that analysis found: a fact that allows more is remarked on, the caller uses the smaller
    one. `least` holds header executions per entry that must happen whenever the loop is entered and left: a fact that
    allows fewer contradicts the binary.
    """
    result = Matches()
    for index, fact in enumerate(facts):
        if not isinstance(fact, LoopFact):
            continue
        found = loops_at(fact.place, cfg, nest, lines, symbols)
        if found:
            result.matched.add(index)
        if len(found) > 1:
            result.notes.append(_several(fact, cfg, nest, found, lines))
        for loop in found:
            _apply(result, fact, cfg, nest, loop, lines, derived or {}, least or {})
    return result


def unmatched(facts: Sequence[Fact], matched: set[int]) -> tuple[Problem, ...]:
    """A problem for each loop fact that matched no loop in any function analysed."""
    return tuple(
        Problem(ProblemKind.FACT_NOWHERE, f"no analysed loop is at {describe(fact.place)}", written=fact.written)
        for index, fact in enumerate(facts)
        if isinstance(fact, LoopFact) and index not in matched
    )


def describe(place: Place) -> str:
    """A place in words."""
    match place:
        case AtAddress(address):
            return f"address {address:#x}"
        case AtSymbol(symbol, offset):
            return f"`{symbol}`" + (f" + {offset:#x}" if offset else "")
        case AtLine(file, line):
            return f"{file}:{line}"


# ---------------------------------------------------------------------------------------------------------- matching
def loops_at(place: Place, cfg: Cfg, nest: LoopNest, lines: Lines, symbols: Symbols) -> list[int]:
    """Indices of the loops that a place means."""
    match place:
        case AtAddress(address):
            return _at_address(address & ~1 if cfg.thumb else address, cfg, nest)
        case AtSymbol(symbol, offset):
            base = symbols(symbol)
            return [] if base is None else _at_address(base + offset, cfg, nest)
        case AtLine():
            return _at_line(place, cfg, nest, lines)


def _at_address(address: int, cfg: Cfg, nest: LoopNest) -> list[int]:
    for index, loop in enumerate(nest.loops):
        if cfg.blocks[loop.header].address == address:
            return [index]
    holders = [
        index
        for index, loop in enumerate(nest.loops)
        if any(i.address == address for block in loop.blocks for i in cfg.blocks[block].instructions)
    ]
    return [max(holders, key=lambda index: nest.loops[index].depth)] if holders else []


def _at_line(place: AtLine, cfg: Cfg, nest: LoopNest, lines: Lines) -> list[int]:
    strong: set[int] = set()
    weak: set[int] = set()
    for index, loop in enumerate(nest.loops):
        latches = {cfg.edges[e].source for e in loop.back_edges}
        own = own_blocks(nest, index)
        ends = [cfg.blocks[b].instructions[-1] for b in own if b in latches or b in exit_blocks(cfg, loop)]
        if any(same_line(lines(i.address), place) for i in ends):
            strong.add(index)
            continue
        instructions = [i for b in (latches | {loop.header}) & own for i in cfg.blocks[b].instructions]
        if any(same_line(lines(i.address), place) for i in instructions):
            weak.add(index)
    kept = [
        index
        for index in weak
        if not any(_related(nest, index, other) for other in strong)
        and not any(other != index and _inside(nest, other, index) for other in weak)
    ]
    return sorted([*strong, *kept])


def own_blocks(nest: LoopNest, index: int) -> frozenset[int]:
    """The blocks of a loop that are in no inner loop."""
    loop = nest.loops[index]
    inner = [other.blocks for other in nest.loops if other.parent == index]
    return loop.blocks - frozenset[int]().union(*inner)


def exit_blocks(cfg: Cfg, loop: Loop) -> frozenset[int]:
    """The blocks of a loop from which an edge leaves it."""
    return frozenset(e.source for e in cfg.edges if e.source in loop.blocks and e.target not in loop.blocks)


def _inside(nest: LoopNest, inner: int, outer: int) -> bool:
    return nest.loops[inner].blocks < nest.loops[outer].blocks


def _related(nest: LoopNest, a: int, b: int) -> bool:
    return a != b and (_inside(nest, a, b) or _inside(nest, b, a))


def same_line(found: tuple[str, int] | None, place: AtLine) -> bool:
    """Whether a line-table entry is the place: same line, and the file's path or its last components."""
    if found is None or found[1] != place.line:
        return False
    have = [part for part in found[0].replace("\\", "/").split("/") if part != "."]
    want = [part for part in place.file.replace("\\", "/").split("/") if part != "."]
    return len(want) <= len(have) and have[len(have) - len(want) :] == want


# ---------------------------------------------------------------------------------------------------------- counting
def bottom_tested(cfg: Cfg, nest: LoopNest, index: int, place: Place, lines: Lines) -> bool:
    """Whether each execution of the header surely is one of the source loop's body.

    The loop must be left from latches only (no test before the body), and something of the header must come from
    another line than the loop statement: a loop that tests first and has nothing else in it (`while (*p++);`) looks the
    same but runs its header once more than its empty body.
    """
    loop = nest.loops[index]
    latches = {cfg.edges[e].source for e in loop.back_edges}
    if not exit_blocks(cfg, loop) <= latches or not isinstance(place, AtLine):
        return False
    header = [lines(i.address) for i in cfg.blocks[loop.header].instructions]
    return any(found is not None and not same_line(found, place) for found in header)


def header_executions(
    fact: LoopFact, cfg: Cfg, nest: LoopNest, index: int, lines: Lines
) -> tuple[int | None, int | None]:
    """The fact as header executions per entry and per execution of the function.

    A body or a back edge is passed at least as often as the header but for one execution per entry. A total over
    several entries of an inner loop would need one more for each of them: it is kept where the loop is entered once.
    """
    extra = 1
    match fact.counting:
        case Counting.HEADER:
            extra = 0
        case Counting.BODY if bottom_tested(cfg, nest, index, fact.place, lines):
            extra = 0
    bound = None if fact.maximum is None else fact.maximum + extra
    keeps_total = extra == 0 or nest.loops[index].depth == 1
    total = fact.total + extra if fact.total is not None and keeps_total else None
    if bound is None and total is not None:
        bound = total
    return bound, total


def _apply(
    result: Matches,
    fact: LoopFact,
    cfg: Cfg,
    nest: LoopNest,
    index: int,
    lines: Lines,
    derived: Mapping[int, int],
    least: Mapping[int, int],
) -> None:
    bound, total = header_executions(fact, cfg, nest, index, lines)
    header = cfg.blocks[nest.loops[index].header].address
    place = Problem(ProblemKind.FACT_LOOSE, "", header, cfg.name, _source(lines, header), written=fact.written)
    if bound is not None and index in least and bound < least[index]:
        message = f"the fact allows {bound} executions of the loop's header, but at least {least[index]} always happen"
        result.problems.append(changed(place, kind=ProblemKind.FACT_CONTRADICTED, message=message))
        return
    if bound is not None and index in derived and bound > derived[index]:
        message = f"the fact allows {bound} executions of the loop's header, the analysis proves {derived[index]}"
        result.notes.append(changed(place, message=message))
    before = result.bounds.get(index)
    if before is not None:
        bound, total = _smaller(before.bound, bound), _smaller(before.total, total)
        fact = before.fact if bound == before.bound else fact
    result.bounds[index] = FactBound(bound, total, fact)


def _smaller(a: int | None, b: int | None) -> int | None:
    return b if a is None else a if b is None else min(a, b)


def _source(lines: Lines, address: int) -> str:
    found = lines(address)
    return "" if found is None else f"{found[0]}:{found[1]}"


def _several(fact: LoopFact, cfg: Cfg, nest: LoopNest, found: list[int], lines: Lines) -> Problem:
    headers = [cfg.blocks[nest.loops[index].header].address for index in found]
    places = ", ".join(f"{header:#x}" for header in headers)
    message = f"the fact at {describe(fact.place)} matches {len(found)} loops of `{cfg.name}` ({places}); each gets it"
    source = _source(lines, headers[0])
    return Problem(ProblemKind.FACT_SEVERAL, message, headers[0], cfg.name, source, written=fact.written)
