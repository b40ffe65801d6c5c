"""Functions made ready to run, and the executions of them under way."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from mauve.wcet.binary.graph import EXIT, Cfg, EdgeKind
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.flow.locations import Helper
from mauve.wcet.flow.order import FUNCTION, Order
from mauve.wcet.flow.run.census import Census
from mauve.wcet.flow.run.compared import Compared, compared_in
from mauve.wcet.flow.run.compile import Compiled, Sites, compile_function
from mauve.wcet.flow.run.live import dead_registers
from mauve.wcet.flow.run.memory import Lost
from mauve.wcet.flow.run.paths import Counters, Path
from mauve.wcet.flow.run.remembered import Call
from mauve.wcet.flow.run.repeats import Kept
from mauve.wcet.flow.run.routines import Formulas, formulas, measures

Place = tuple[int, ...]
"""Where a path is: per loop around it its place in the region around and the iteration, then the block's place."""
END: Place = (1 << 60,)


class Ended(Exception):
    """A path that does not come back: it ends in a trap or in a function that does not return."""


class Impossible(Exception):
    """A path that no execution takes."""


class Covered(Exception):
    """A path that can do nothing that an earlier one did not do; what it did on its way counts."""


class Unresolved(Exception):
    """Control goes where the graphs have no edge: `args` are the address of the branch and the target, as a key."""


class Several(Exception):
    """An indirect call goes to one of several functions: `args` are the places."""


@dataclass(slots=True)
class Function:
    """A function made ready. `plain[edge]` is the target of an edge that only leads from block to block, None for one
    that counts for loops, calls or leaves; `starts` and `repeats` are the loops that an edge enters and repeats;
    `around[block]` the loops around a block with their places, and its own place; `exits[block]` those that are left
    from it; `compared` is what it compares, `dead[block]` the registers that nothing reads from a block on; `routine`
    are its loops where the table of library routines knows it, which `measures` a string or does not."""

    key: int
    cfg: Cfg
    nest: LoopNest
    order: Order
    code: Compiled
    sizes: list[int]
    plain: list[int | None]
    starts: dict[int, list[int]]
    repeats: dict[int, list[int]]
    group: int
    around: list[tuple[tuple[tuple[int, int], ...], int]]
    headers: dict[int, int]
    exits: dict[int, list[int]]
    compared: Compared
    dead: list[tuple[int, ...]]
    closed: bool
    helper: Helper | None
    routine: Formulas
    measures: bool
    calls: list[Call] = field(default_factory=list)
    """calls that were followed, of a closed function"""
    undecided: set[int] = field(default_factory=set)
    """loops that unknown values did not end"""
    endless: set[int] = field(default_factory=set)
    """loops that were found to go on for as long as unknown values say"""
    limits: dict[int, int | None] = field(default_factory=dict)
    """bounds of loops that are proven whatever the function is called with, as far as they were asked for"""
    unmeasured: set[int] = field(default_factory=set)
    """loops of which a census told nothing"""


@dataclass(slots=True)
class Frame:
    """One execution of a function: the counters of the path that is followed and where it may return to (addresses;
    None: anywhere); the paths that wait, by place. `ended` are the counters of paths that do not come back, `open` how
    often unknown values did not end each loop since it was entered, `kept` an earlier iteration of each such loop.
    `endless` are the loops that go on for as long as unknown values say, `proven` those of them with a bound all the
    same, `loose` those with counts that say nothing; `limits` are bounds that hold for its arguments;
    `census` is of a loop of which each way is followed apart.
    """

    function: Function
    now: Counters
    back: frozenset[int] | None = None
    waiting: dict[Place, Path] = field(default_factory=dict)
    places: list[Place] = field(default_factory=list)
    ended: Counters | None = None
    open: dict[int, int] = field(default_factory=dict)
    kept: dict[int, Kept] = field(default_factory=dict)
    endless: set[int] = field(default_factory=set)
    proven: dict[int, int] = field(default_factory=dict)
    limits: dict[int, int] = field(default_factory=dict)
    census: Census | None = None
    loose: set[int] = field(default_factory=set)


@dataclass(frozen=True, slots=True)
class Way:
    """A way on from a block: an edge, or DYNAMIC for what its last instruction does first. `holds` is what the block's
    condition says on it, `target` where an indirect branch goes, `through` the edge that an unknown one takes."""

    edge: int
    holds: bool | None = None
    target: int | None = None
    through: int | None = None


def prepare(key: int, source: Any, sites: Sites) -> Function:
    """Make a function ready. Raises Lost."""
    cfg, nest, order, group = source.function(key)
    if nest.irreducible or not cfg.blocks:
        raise Lost(f"{cfg.name} has loops with several entries" if cfg.blocks else f"{cfg.name} is no code")
    starts: dict[int, list[int]] = {}
    repeats: dict[int, list[int]] = {}
    for loop in nest.loops:
        for edge in loop.entry_edges:
            starts.setdefault(edge, []).append(loop.id)
        for edge in loop.back_edges:
            repeats.setdefault(edge, []).append(loop.id)
    plain: list[int | None] = []
    for index, edge in enumerate(cfg.edges):
        through = edge.kind in (EdgeKind.FALL, EdgeKind.TAKEN, EdgeKind.SWITCH)
        special = index in starts or index in repeats or not through or edge.target == EXIT
        plain.append(None if special else edge.target)
    sizes = [len(block.instructions) for block in cfg.blocks]
    code = compile_function(order, sites)
    headers = {loop.header: loop.id for loop in nest.loops}
    around = _places_of(order)
    exits: dict[int, list[int]] = {}
    for loop in nest.loops:
        for block in {e.source for e in cfg.edges if e.source in loop.blocks and e.target not in loop.blocks}:
            exits.setdefault(block, []).append(loop.id)
    recognised = source.recognised(key)
    function = Function(
        *(key, cfg, nest, order, code, sizes, plain, starts, repeats, group, around, headers, exits),
        *(compared_in(cfg), dead_registers(cfg), source.closed(key), source.helper(key)),
        *(formulas(cfg, nest, recognised), any(part.whole and measures(part.known.names) for part in recognised)),
    )
    function.limits |= source.known(key)
    return function


def _places_of(order: Order) -> list[tuple[tuple[tuple[int, int], ...], int]]:
    """For each block the loops around it, each with its place in the region around it, and its own place."""
    places = {region.id: {node: i for i, node in enumerate(region.nodes)} for region in order.regions.values()}
    found = []
    for block in range(len(order.cfg.blocks)):
        region = order.innermost[block]
        own = places[region].get(block, 0)
        chain: list[tuple[int, int]] = []
        while region != FUNCTION:
            loop = order.nest.loops[region]
            parent = FUNCTION if loop.parent is None else loop.parent
            chain.append((places[parent][loop.header], region))
            region = parent
        found.append((tuple(reversed(chain)), own))
    return found
