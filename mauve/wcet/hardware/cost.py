"""What each edge of a control flow graph costs: the cycles of its source block when control leaves by that edge.

A block is cut where an instruction changes the flags: between two cuts, conditional instructions execute together or
exclude each other as the flags demand, so the cost of a piece is the greatest over the possible outcomes; the last
piece knows from the edge whether the closing branch is taken. Results that come late (interlocks) are carried along
straight code and into the blocks behind it: per block the worst delays of all ways into it, found by a fixpoint over
the edges.

Why taking the worst of both, time and delays, is safe: let T be the cycles charged so far and p(r) the cycles until
register r can be read. Charged values keep T >= true T and T + p(r) >= true T + true p(r) for every r: an instruction
starts at the maximum of T and of T + p over what it reads, which is monotone in both.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

from mauve.wcet.binary.graph import EXIT, Block, Cfg, Edge, EdgeKind
from mauve.wcet.binary.microop import CompareBranch, Condition, Instruction, Next
from mauve.wcet.clock import Deadline, check
from mauve.wcet.hardware.board import Board
from mauve.wcet.hardware.conditions import outcomes
from mauve.wcet.hardware.core import Core, CoreModel
from mauve.wcet.hardware.memory import MemoryMap, memory_map
from mauve.wcet.hardware.step import FETCH_AHEAD, REFILL_FETCHES, Accesses, Step, Untimed, make_step
from mauve.wcet.result import Problem, ProblemKind

Known = dict[tuple[object, ...], Step | Untimed]
"""Steps by what they depend on: the identities of the parts of an instruction, its condition, the wait for code."""

_AT_ONCE = 128
"""Instructions between two looks at the clock."""

Pending = dict[int, tuple[int, int]]
"""Registers that cannot be read yet: cycles still to go, and the same for store data and accumulators."""


@dataclass(frozen=True, slots=True)
class EdgeCosts:
    """`cycles[i]` is the cost of edge i, callees excluded. With problems the costs mean nothing."""

    cycles: tuple[int, ...]
    problems: tuple[Problem, ...] = ()


def edge_costs(
    cfg: Cfg,
    core: Core,
    board: Board,
    accesses: Accesses,
    infeasible: frozenset[int] = frozenset(),
    deadline: Deadline = None,
) -> EdgeCosts:
    """The cycles of every edge of a function on a core with the board's memories, 0 for infeasible edges.

    Problems: an instruction the core has no time for (HARDWARE), code outside the board's memories (OUTSIDE). Raises
    OutOfTime.
    """
    memory = memory_map(board)
    reachable = _reachable(cfg, infeasible)
    problems = list(_outside(cfg, memory, reachable))
    steps: dict[int, tuple[Step, ...]] = {}
    known: Known = {}
    for block in cfg.blocks:
        if block.id in reachable:
            made = _block_steps(cfg, block, core, memory, accesses, problems, known, deadline)
            if made is not None:
                steps[block.id] = made
    if problems or not cfg.blocks:
        return EdgeCosts((), tuple(problems))
    worst = [0] * len(cfg.edges)
    outgoing: dict[int, list[int]] = {}
    for index, edge in enumerate(cfg.edges):
        if index not in infeasible and edge.source in reachable:
            outgoing.setdefault(edge.source, []).append(index)
    target_waits = {index: _target_waits(cfg, edge, core, memory) for index, edge in enumerate(cfg.edges)}
    branching = {edge.source for edge in cfg.edges if edge.kind is not EdgeKind.FALL}
    endings = {index: _endings(cfg, edge, edge.source in branching) for index, edge in enumerate(cfg.edges)}
    pending: dict[int, Pending] = {cfg.entry: {}}
    waiting, queued = deque([cfg.entry]), {cfg.entry}
    while waiting:
        block_id = waiting.popleft()
        queued.discard(block_id)
        check(deadline, cfg.blocks[block_id].address, cfg.name)
        leave = _Leaving(steps[block_id], pending[block_id])
        for index in outgoing.get(block_id, ()):
            edge = cfg.edges[index]
            cycles, after = leave.by(endings[index])
            if edge.callees and endings[index] != (True,):
                # Falling into another function: it was analysed with all results ready at its entry.
                cycles += max((max(delays) for delays in after.values()), default=0)
            worst[index] = max(worst[index], cycles + target_waits[index])
            if edge.target == EXIT:
                continue
            # A callee's return is a transfer of control: it takes longer than any result is late (checked by
            # load_core).
            changed = _join(pending, edge.target, {} if edge.kind is EdgeKind.CALL else after)
            if changed and edge.target not in queued:
                queued.add(edge.target)
                waiting.append(edge.target)
    return EdgeCosts(tuple(worst))


def return_waits(core: Core, board: Board) -> int:
    """Wait states of the return of the analysed function, whose caller is not known: the slowest memory is assumed."""
    return REFILL_FETCHES * memory_map(board).slowest_read if core.model is CoreModel.BUS else 0


def board_problems(board: Board, core: Core | None) -> tuple[Problem, ...]:
    """Why no bound can be given on this board: an unknown core, switched-on features or wait states without a model."""
    found = []
    if core is None:
        found.append(Problem(ProblemKind.HARDWARE, f"there is no timing model of the core {board.core}"))
    found += [
        Problem(
            ProblemKind.HARDWARE,
            f"{feature} is declared by the board {board.name} and not modelled",
            suggestions=("switch it off if the program runs without it",),
        )
        for feature in board.features
    ]
    if core is not None and not core.compositional and any(m.wait or m.write_wait for m in board.memories):
        found.append(
            Problem(ProblemKind.HARDWARE, f"wait states cannot be added to the times of {core.title}: {core.reason}")
        )
    return tuple(found)


# --------------------------------------------------------------------------------------------------------- blocks
class _Leaving:
    """The cost of one block from one pending state, by the outcome of its last instruction; each is computed once."""

    def __init__(self, steps: tuple[Step, ...], pending: Pending) -> None:
        self._steps = steps
        self._pending = pending
        self._known: dict[bool | None, tuple[int, Pending]] = {}

    def by(self, endings: tuple[bool | None, ...]) -> tuple[int, Pending]:
        """Cycles of the block when its last instruction does one of these things, and what is pending then."""
        alternatives = []
        for taken in endings:
            if taken not in self._known:
                self._known[taken] = _block_cost(self._steps, self._pending, taken)
            alternatives.append(self._known[taken])
        spent = max(cost for cost, _ in alternatives)
        return spent, _latest(spent, alternatives)


def _endings(cfg: Cfg, edge: Edge, branches: bool) -> tuple[bool | None, ...]:
    """Whether the last instruction of the edge's block transfers control on the way to the edge: (True,), (False,),
    both where the edge does not tell, and (None,) when it is no transfer of control. `branches`: the block has edges
    of other kinds than FALL."""
    last = cfg.blocks[edge.source].instructions[-1]
    if isinstance(last.flow, Next):
        return (None,)
    if last.condition is Condition.AL and not isinstance(last.flow, CompareBranch):
        return (True,)
    if edge.kind is EdgeKind.FALL:
        # A call that is said not to happen falls through as well: it is the only way on then.
        return (False,) if branches else (False, True)
    # Falling into the next function is a tail call of it.
    return (False, True) if any(callee & ~1 == last.end for callee in edge.callees) else (True,)


def _block_cost(steps: tuple[Step, ...], pending: Pending, taken: bool | None) -> tuple[int, Pending]:
    """The greatest cost of a block. `taken`: whether its last instruction's condition holds; None: it is no branch."""
    cycles = 0
    for first, last in _pieces(steps):
        piece = steps[first:last]
        conditions = frozenset(step.condition for step in piece if step.condition is not Condition.AL)
        alternatives: list[tuple[int, Pending]] = []
        final = taken if last == len(steps) else None
        closing = steps[-1].condition
        for held in outcomes(conditions):
            if final is not None and closing is not Condition.AL and (closing in held) != final:
                continue
            alternatives.append(_run(piece, held, pending, fails_last=final is False))
        spent = max(cost for cost, _ in alternatives)
        pending = _latest(spent, alternatives)
        cycles += spent
    return cycles, pending


def _pieces(steps: tuple[Step, ...]) -> Iterable[tuple[int, int]]:
    """Index ranges of a block between changes of the flags."""
    start = 0
    for index, step in enumerate(steps):
        if step.sets_flags and index + 1 < len(steps):
            yield start, index + 1
            start = index + 1
    yield start, len(steps)


def _run(
    piece: tuple[Step, ...], held: frozenset[Condition], pending: Pending, fails_last: bool
) -> tuple[int, Pending]:
    """Cycles of a piece and the delays after it, when exactly the conditions in `held` hold. A branch without a
    condition field that is not taken (compare and branch) is told by `fails_last`."""
    total = 0
    pending = dict(pending)
    for index, step in enumerate(piece):
        executes = step.condition is Condition.AL or step.condition in held
        if fails_last and index == len(piece) - 1:
            executes = False
        stall = 0
        if pending:
            stall = max((pending[r][0] for r in step.reads if r in pending), default=0)
            stall = max(stall, max((pending[r][1] for r in step.late_reads if r in pending), default=0))
        busy = stall + (step.busy if executes else step.failed_busy)
        total += busy + (step.waits if executes else step.failed_waits)
        if pending:
            pending = {
                register: (max(0, early - busy), max(0, late - busy))
                for register, (early, late) in pending.items()
                if early > busy or late > busy
            }
        if executes:
            for register in step.writes:
                pending.pop(register, None)
            for delay in step.delays:
                pending[delay.register] = (delay.early, delay.late)
    return total, pending


def _latest(spent: int, alternatives: list[tuple[int, Pending]]) -> Pending:
    """What is pending after the alternatives, counted from the cost of the dearest one."""
    if len(alternatives) == 1:
        return alternatives[0][1]
    merged: Pending = {}
    for cost, pending in alternatives:
        for register, (early, late) in pending.items():
            shift = spent - cost
            was = merged.get(register, (0, 0))
            merged[register] = (max(was[0], early - shift), max(was[1], late - shift))
    return {register: delays for register, delays in merged.items() if max(delays) > 0}


def _join(states: dict[int, Pending], block: int, arriving: Pending) -> bool:
    """Merge what is pending on one more way into a block; whether that changed anything (or is the first way)."""
    state = states.get(block)
    if state is None:
        states[block] = dict(arriving)
        return True
    changed = False
    for register, (early, late) in arriving.items():
        was = state.get(register, (0, 0))
        if early > was[0] or late > was[1]:
            state[register] = (max(was[0], early), max(was[1], late))
            changed = True
    return changed


# ------------------------------------------------------------------------------------------------------ functions
def _block_steps(
    cfg: Cfg,
    block: Block,
    core: Core,
    memory: MemoryMap,
    accesses: Accesses,
    problems: list[Problem],
    known: Known,
    deadline: Deadline,
) -> tuple[Step, ...] | None:
    """The steps of a block; instructions without a time and accesses outside all memories are added to `problems`;
    `known` are the steps of this function's instructions, by what they depend on."""
    steps = []
    for number, instruction in enumerate(block.instructions):
        if number % _AT_ONCE == 0:
            check(deadline, instruction.address, cfg.name)
        anywhere = True
        for index in range(len(instruction.ops)) if memory.memories else ():
            place = accesses.get((instruction.address, index))
            if place is not None:
                anywhere = False
                if not memory.reaches(place):
                    problems.append(_no_memory(cfg, instruction.address, instruction.text, place.low, place.high))
        step = _shared(instruction, core, memory, known) if anywhere else make_step(instruction, core, memory, accesses)
        if isinstance(step, Untimed):
            what = step.timing_class.replace("_", " ")
            message = f"{instruction.text}: the model of {core.title} has no time for {what}"
            problems.append(Problem(ProblemKind.HARDWARE, message, instruction.address, cfg.name))
        else:
            steps.append(step)
    return tuple(steps) if len(steps) == len(block.instructions) else None


def _shared(instruction: Instruction, core: Core, memory: MemoryMap, known: Known) -> Step | Untimed:
    """The step of an instruction whose accesses go anywhere: the same for all that share their meaning and wait alike
    for their code."""
    wait = _ahead(memory, instruction.address)
    same = instruction.condition, instruction.thumb, wait
    key = id(instruction.ops), id(instruction.traits), id(instruction.flow), *same
    step = known.get(key)
    if step is None:
        step = known[key] = make_step(instruction, core, memory, {})
    return step


def _no_memory(cfg: Cfg, address: int, text: str, low: int, high: int) -> Problem:
    return Problem(
        ProblemKind.HARDWARE,
        f"{text}: no memory of the board holds {low:#x}" + (f" to {high:#x}" if high > low + 3 else ""),
        address,
        cfg.name,
        suggestions=("declare the memory or device at this address on the board",),
    )


def _outside(cfg: Cfg, memory: MemoryMap, reachable: frozenset[int]) -> Iterable[Problem]:
    """The first instruction of the function that no memory of the board holds."""
    for block in cfg.blocks:
        whole = memory.holds_together(block.address, block.instructions[-1].end - 1)
        for instruction in block.instructions if block.id in reachable and not whole else ():
            if not memory.holds(instruction.address, instruction.end - 1):
                message = f"the code of {cfg.name} at {instruction.address:#x} is in no memory of the board"
                yield Problem(ProblemKind.OUTSIDE, message, instruction.address, cfg.name)
                return


def _target_waits(cfg: Cfg, edge: Edge, core: Core, memory: MemoryMap) -> int:
    """Wait states of the fetches at the target of a transfer of control, which the bus model counts with the transfer.

    A call pays them twice: at its callee and, for the callee's return, at the instruction after the call.
    """
    if core.model is not CoreModel.BUS or edge.kind in (EdgeKind.FALL, EdgeKind.RETURN):
        return 0
    waits = max((_ahead(memory, callee & ~1) for callee in edge.callees), default=0)
    if edge.target != EXIT:
        waits += _ahead(memory, cfg.blocks[edge.target].address)
    return REFILL_FETCHES * waits


def _ahead(memory: MemoryMap, address: int) -> int:
    return memory.code_wait(address, address + FETCH_AHEAD - 1)


def _reachable(cfg: Cfg, infeasible: frozenset[int]) -> frozenset[int]:
    """Blocks that a path of feasible edges reaches."""
    successors: dict[int, list[int]] = {}
    for index, edge in enumerate(cfg.edges):
        if index not in infeasible and edge.target != EXIT:
            successors.setdefault(edge.source, []).append(edge.target)
    seen, waiting = {cfg.entry}, [cfg.entry]
    while waiting:
        for target in successors.get(waiting.pop(), ()):
            if target not in seen:
                seen.add(target)
                waiting.append(target)
    return frozenset(seen)
