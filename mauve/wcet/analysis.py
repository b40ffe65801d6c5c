"""The entry of the WCET library: an executable, functions, a board and flow facts give bounds or the reasons for none.

The stages are imported when they are needed: a result that the cache holds costs neither a disassembler nor a solver.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from mauve.records import changed
from mauve.wcet.cache import Cache, result_key
from mauve.wcet.clock import Deadline, OutOfTime
from mauve.wcet.flow.facts import Fact
from mauve.wcet.hardware.board import Board
from mauve.wcet.result import Problem, ProblemKind, WcetResult

if TYPE_CHECKING:
    from mauve.wcet.binary.elf import Binary, ElfProblem
    from mauve.wcet.flow.result import ContextKey, FunctionFlow
    from mauve.wcet.hardware.core import Core
    from mauve.wcet.ipet.bottom_up import FunctionBound


def analyse(
    binary: Binary | str | Path,
    functions: Sequence[str | int],
    board: Board,
    facts: Sequence[Fact] = (),
    *,
    initial_data: bool = False,
    timeout: float | None = None,
    cache: Cache | None = None,
) -> tuple[WcetResult, ...]:
    """The bound of every function, in the order given; a function is a symbol or an address (bit 0 set for Thumb).

    `facts` are flow facts; `initial_data` starts the analysis from the linked data instead of unknown globals;
    `timeout`
    bounds the seconds spent on one function, which has no bound then. An executable that cannot be read, an unknown
    symbol, a loop without a bound: each is a problem in the results concerned, never an exception.
    """
    return tuple(analyse_each(binary, functions, board, facts, initial_data, timeout, cache))


def analyse_each(
    binary: Binary | str | Path,
    functions: Sequence[str | int],
    board: Board,
    facts: Sequence[Fact],
    initial_data: bool,
    timeout: float | None,
    cache: Cache | None,
) -> Iterator[WcetResult]:
    """`analyse`, one result at a time as they come."""
    data, identity = _bytes(binary)
    common: _Common | Problem | None = None
    for function in functions:
        key = None
        if cache is not None and identity is not None:
            key = result_key(identity, function, board, tuple(facts), initial_data)
            known = cache.get(key)
            if known is not None:
                yield known
                continue
        started = time.perf_counter()
        if common is None:
            loaded = _load(binary, data)
            common = loaded if isinstance(loaded, Problem) else _Common(loaded, board, tuple(facts), initial_data)
        result = _failed(function, None, common) if isinstance(common, Problem) else common.analyse(function, timeout)
        result = changed(result, seconds=time.perf_counter() - started)
        # Time or size ended it, or a search for less than the bound: another run may come further.
        late = timeout is not None and result.seconds > timeout
        gave_up = late or any(problem.kind is ProblemKind.LIMIT for problem in result.problems)
        if cache is not None and key is not None and not gave_up:
            cache.put(key, result)
        yield result


class _Common:
    """What the analyses of several functions of one executable share."""

    def __init__(self, binary: Binary, board: Board, facts: tuple[Fact, ...], initial_data: bool) -> None:
        from mauve.wcet.binary.lines import load_lines
        from mauve.wcet.flow.program import Programs
        from mauve.wcet.hardware.core import load_core
        from mauve.wcet.hardware.cost import board_problems

        self._binary, self._board = binary, board
        self._core = load_core(board.core)
        self._problems = board_problems(board, self._core)
        self._lines = load_lines(binary)
        self._programs = Programs(binary, facts, initial_data=initial_data, lines=self._lines)
        self._known: dict[tuple[int, ...], tuple[FunctionFlow, tuple[FunctionBound | None, ...], FunctionBound]] = {}

    def analyse(self, function: str | int, timeout: float | None) -> WcetResult:
        """One function, from its symbol to its result."""
        from mauve.wcet.assemble import assemble
        from mauve.wcet.binary.elf import ElfProblem
        from mauve.wcet.flow.program import out_of_time
        from mauve.wcet.globals import global_uses

        symbol = self._binary.function(function if isinstance(function, str) else f"{function:#x}")
        if isinstance(symbol, ElfProblem):
            return _failed(function, None, elf_problem(symbol))
        core, board = self._core, self._board
        if core is None:
            return _failed(function, symbol.address, *self._problems)
        deadline = None if timeout is None else time.monotonic() + timeout
        program = self._programs.program(symbol.key, timeout)
        bounds: dict[ContextKey, FunctionBound] = {}
        try:
            for key, flow in program.functions.items():
                bounds[key] = self._bound(flow, core, bounds, deadline)
        except OutOfTime as reason:
            problem = out_of_time(symbol.name, symbol.address, reason, timeout)
            program = replace(program, problems=(*program.problems, problem))
        result = assemble(symbol.name, program, bounds, core, board, self._problems, self._lines.source)
        return changed(result, globals=global_uses(program, self._binary))

    def _bound(
        self, flow: FunctionFlow, core: Core, bounds: Mapping[ContextKey, FunctionBound], deadline: Deadline
    ) -> FunctionBound:
        """The bound of one function from those of its callees, computed once for the same flow and the same bounds."""
        from mauve.wcet.ipet.bottom_up import bound_function

        callees = tuple(bounds.get(key) for contexts in flow.calls.values() for key in contexts)
        identity = (id(flow), *map(id, callees))
        known = self._known.get(identity)
        if known is None:
            # The flow and the bounds are kept with the result: their identities stay theirs.
            bound = bound_function(flow, core, self._board, bounds, deadline=deadline)
            known = self._known[identity] = flow, callees, bound
        return known[2]


def _bytes(binary: Binary | str | Path) -> tuple[bytes | None, str | None]:
    """The bytes of the executable where it is a path, and the hash of its content without parsing it."""
    if not isinstance(binary, (str, Path)):
        return None, binary.sha256
    try:
        data = Path(binary).read_bytes()
    except OSError:
        return None, None
    return data, sha256(data).hexdigest()


def _load(binary: Binary | str | Path, data: bytes | None) -> Binary | Problem:
    from mauve.wcet.binary.elf import ElfProblem, load, load_bytes

    if not isinstance(binary, (str, Path)):
        return binary
    found = load(binary) if data is None else load_bytes(data, str(binary))
    return elf_problem(found) if isinstance(found, ElfProblem) else found


def elf_problem(problem: ElfProblem) -> Problem:
    """What is wrong with an executable or a symbol, as a reason for having no bound."""
    from mauve.wcet.binary.elf import ElfProblemKind

    kinds = {
        ElfProblemKind.NOT_ARM: ProblemKind.NOT_ARM,
        ElfProblemKind.BIG_ENDIAN: ProblemKind.NOT_ARM,
        ElfProblemKind.SIXTY_FOUR_BIT: ProblemKind.NOT_ARM,
        ElfProblemKind.NOT_FOUND: ProblemKind.SYMBOL,
        ElfProblemKind.AMBIGUOUS: ProblemKind.SYMBOL,
        ElfProblemKind.NOT_A_FUNCTION: ProblemKind.NOT_A_FUNCTION,
    }
    return Problem(kinds.get(problem.kind, ProblemKind.BINARY), problem.message)


def _failed(function: str | int, address: int | None, *problems: Problem) -> WcetResult:
    name = function if isinstance(function, str) else f"{function:#x}"
    return WcetResult(name, address, None, None, problems=problems)
