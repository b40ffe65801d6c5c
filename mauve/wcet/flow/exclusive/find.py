"""The groups of a function's edges that exclude each other, with the conditions in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from mauve.wcet.binary.graph import Cfg, EdgeKind
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.binary.microop import CompareBranch, Condition, IndirectJump, TableJump
from mauve.wcet.flow.exclusive.facts import Key, Numbers, OrderKey
from mauve.wcet.flow.exclusive.groups import Group, groups
from mauve.wcet.flow.exclusive.numbers import Numbering
from mauve.wcet.flow.exclusive.walk import Memory, Written, walk
from mauve.wcet.flow.locations import HALF, WORD, Base, CallEffects, Cell
from mauve.wcet.flow.rank.terms import Apply, Atom, Fresh, Term, Var, signed
from mauve.wcet.flow.result import Exclusive

MOST_INSTRUCTIONS = 12_000
"""A longer function is not looked at."""

Symbols = Callable[[int], str]
"""The name of the object at an address, with the distance from its start; empty when there is none."""


def exclusive(
    cfg: Cfg,
    nest: LoopNest,
    memory: Memory,
    effects: Mapping[int, CallEffects],
    written: Mapping[int, Written],
    infeasible: frozenset[int],
    symbols: Symbols,
) -> tuple[Exclusive, ...]:
    """Groups of edges of which at most one is taken in one execution of the function, or iteration of a loop.

    `effects` and `written` say what calls change, by edge; an edge that is missing follows AAPCS. Irreducible functions
    have none.
    """
    if nest.irreducible or any(block.id != index for index, block in enumerate(cfg.blocks)):
        return ()
    if _deciding(cfg, infeasible) < 2 or sum(len(block.instructions) for block in cfg.blocks) > MOST_INSTRUCTIONS:
        return ()
    done = walk(cfg, nest, memory, effects, written, infeasible)
    return tuple(_told(group, done.numbering, symbols) for group in groups(done))


def _deciding(cfg: Cfg, infeasible: frozenset[int]) -> int:
    """How many blocks end in a decision."""
    sources = set()
    for index, edge in enumerate(cfg.edges):
        if index not in infeasible and edge.kind is not EdgeKind.FALL:
            last = cfg.blocks[edge.source].instructions[-1]
            if last.condition is not Condition.AL or isinstance(last.flow, CompareBranch | TableJump | IndirectJump):
                sources.add(edge.source)
    return len(sources)


def _told(group: Group, numbering: Numbering, symbols: Symbols) -> Exclusive:
    conditions = tuple(_condition(group.key, allowed, numbering, symbols) for allowed in group.allowed)
    return Exclusive(group.edges, group.loop, conditions)


def _condition(key: Key, allowed: Numbers, numbering: Numbering, symbols: Symbols) -> str:
    """The fact in words."""
    if isinstance(key, OrderKey):
        names: dict[Numbers, str] = {((0, 0),): "<", ((1, 1),): "==", ((2, 2),): ">", ((0, 1),): "<=", ((1, 2),): ">="}
        sign = names.get(allowed, "!=")
        return f"{_name(key.a, numbering, symbols)} {sign} {_name(key.b, numbering, symbols)}"
    name = _name(Term(0, key.parts), numbering, symbols)
    if len(allowed) == 1 and allowed[0][0] == allowed[0][1]:
        return f"{name} == {signed(allowed[0][0])}"
    missing = _rest(allowed)
    if len(missing) == 1 and missing[0][0] == missing[0][1]:
        return f"{name} != {signed(missing[0][0])}"
    pieces = _as_signed(allowed) if any(high >= HALF for _, high in allowed) else list(allowed)
    return " or ".join(_between(name, low, high) for low, high in pieces)


def _between(name: str, low: int, high: int) -> str:
    if low == high:
        return f"{name} == {low}"
    if low in (-HALF, 0) and high < HALF - 1:
        return f"{name} <= {high}" if low else f"{name} in 0..{high}"
    if high in (HALF - 1, WORD - 1):
        return f"{name} >= {low}"
    return f"{name} in {low}..{high}"


def _rest(allowed: Numbers) -> Numbers:
    """The numbers that are not in the set."""
    ends = [-1, *(end for low, high in allowed for end in (low, high)), WORD]
    gaps = [(a + 1, b - 1) for a, b in zip(ends[::2], ends[1::2], strict=True)]
    return tuple((low, high) for low, high in gaps if low <= high)


def _as_signed(allowed: Numbers) -> list[tuple[int, int]]:
    """The same numbers read as two's complement, in order."""
    found: list[tuple[int, int]] = []
    for low, high in allowed:
        if low < HALF:
            found.append((low, min(high, HALF - 1)))
        if high >= HALF:
            found.append((max(low, HALF) - WORD, high - WORD))
    result: list[tuple[int, int]] = []
    for low, high in sorted(found):
        if result and low == result[-1][1] + 1:
            result[-1] = (result[-1][0], high)
        else:
            result.append((low, high))
    return result


def _name(term: Term, numbering: Numbering, symbols: Symbols) -> str:
    """A term in words: objects by their names, arguments by number."""
    words = []
    for of, factor in sorted(term.parts, key=lambda part: repr(part[0])):
        name = _atom_name(of, numbering, symbols)
        times = signed(factor)
        words.append(name if times == 1 else f"-{name}" if times == -1 else f"{times}*{name}")
    if term.constant or not words:
        words.append(str(signed(term.constant)))
    return " + ".join(words).replace("+ -", "- ")


def _atom_name(of: Atom, numbering: Numbering, symbols: Symbols) -> str:
    match of:
        case Var(int() as register):
            return f"argument {register + 1}" if register < 4 else f"r{register}"
        case Fresh(identity):
            origin = numbering.origins.get(identity)
            if isinstance(origin, Cell):
                return _cell_name(origin, symbols)
            if origin is not None:
                return f"*({_name(origin[0], numbering, symbols)})"
            return "a value"
        case Apply(op, (value, other)):
            return f"{op.value}({_name(value, numbering, symbols)}, {_name(other, numbering, symbols)})"
        case Apply(op, args):
            return f"{op.value}({', '.join(_name(arg, numbering, symbols) for arg in args)})"
        case _:
            return "a value"


def _cell_name(cell: Cell, symbols: Symbols) -> str:
    if cell.base is Base.ABSOLUTE:
        return symbols(cell.offset) or f"[{cell.offset:#x}]"
    return f"a local variable at {cell.offset}" if cell.offset < 0 else f"stack argument {cell.offset // 4 + 1}"
