"""Bounds of whole programs with loop bounds given by hand: equal to what is executed where there is only one path."""

from __future__ import annotations

import struct
from dataclasses import replace

import pytest

from mauve.wcet.assemble import assemble
from mauve.wcet.binary.graph import EdgeKind
from mauve.wcet.flow.result import LoopBound, ProgramFlow
from mauve.wcet.hardware.board import Board, Memory
from mauve.wcet.hardware.core import load_core
from mauve.wcet.ipet.bottom_up import bound_program
from mauve.wcet.ipet.problem import problem_of
from mauve.wcet.ipet.program import format_program
from mauve.wcet.ipet.solve import Method
from mauve.wcet.result import Origin, Problem, ProblemKind, WcetResult
from tests.wcet.programs import FIXTURES, image, program_of
from tests.wcet.reference import Tracer, bus_cycles, pipeline_cycles

IMAGES = [
    ("arm7tdmi-arm-O0.elf", "arm7tdmi"),
    ("arm7tdmi-arm-O2.elf", "arm7tdmi"),
    ("arm7tdmi-arm-Os.elf", "arm920t"),
    ("arm926ej-s-arm-O2.elf", "arm926ej-s"),
    ("arm7tdmi-thumb-O2.elf", "arm7tdmi"),
    ("arm7tdmi-thumb-O2.elf", "arm920t"),
]


def result_of(program: ProgramFlow, board: Board, method: Method = Method.AUTO) -> WcetResult:
    core = load_core(board.core)
    assert core is not None
    bounds = bound_program(program, core, board, method)
    return assemble(program.functions[program.entry].cfg.name, program, bounds, core, board, (), lambda address: "")


def executed_cycles(elf: str, board: Board, function: str) -> int:
    core = load_core(board.core)
    assert core is not None
    tracer = Tracer(FIXTURES / elf, board.core)
    table = tracer.emulator.alloc(struct.pack("<100i", *range(1, 101)))
    trace = tracer.run(function, [table])
    return bus_cycles(trace, board) if board.core == "arm7tdmi" else pipeline_cycles(trace, core, board)


@pytest.mark.parametrize(("elf", "core"), IMAGES)
@pytest.mark.parametrize(
    ("function", "bodies"), [("sum", (100,)), ("loop_step_up", (14,)), ("loop_sequence", (11, 13))]
)
def test_one_path_is_exact(elf: str, core: str, function: str, bodies: tuple[int, ...]) -> None:
    board = Board("bench", core, 100_000_000)
    tests_first = "-O0" in elf
    program = program_of(image(elf), function, {function: [n + tests_first for n in bodies]})
    result = result_of(program, board)
    assert result.problems == ()
    assert result.cycles == executed_cycles(elf, board, function)


@pytest.mark.parametrize(("elf", "core"), IMAGES)
def test_wait_states_cover_execution_and_never_lower_a_bound(elf: str, core: str) -> None:
    """Code in slow flash, data anywhere: the emulator's stack and heap are declared as memories too."""
    first = 101 if "-O0" in elf else 100
    program = program_of(image(elf), "sum", {"sum": [first]})
    before = 0
    for wait in (0, 1, 3):
        memories = (
            Memory("flash", 0x8000, 0x10000, wait),
            Memory("stack", 0x6000_0000, 0x1_0000, 0),
            Memory("heap", 0x5000_0000, 0x4_0000, 2, 3),
        )
        board = Board("slow", core, 100_000_000, memories)
        result = result_of(program, board)
        assert result.cycles is not None
        assert executed_cycles(elf, board, "sum") <= result.cycles
        assert result.cycles > before
        before = result.cycles


def test_figure_2_of_the_paper() -> None:
    """`sum` over t[100] at -O0: the header tests first and runs 101 times, the body 100; its graph and program."""
    program = program_of(image("arm7tdmi-arm-O0.elf"), "sum", {"sum": [101]})
    flow = program.functions[program.entry]
    kinds = [(edge.source, edge.target, edge.kind) for edge in flow.cfg.edges]
    assert kinds == [
        (0, 2, EdgeKind.TAKEN),
        (1, 2, EdgeKind.FALL),
        (2, 1, EdgeKind.TAKEN),
        (2, 3, EdgeKind.FALL),
        (3, -1, EdgeKind.RETURN),
    ]
    result = result_of(program, Board("bench", "arm7tdmi", 100_000_000))
    assert [block.count for block in result.blocks] == [1, 100, 101, 1]
    assert sum(block.total for block in result.blocks) == result.cycles
    bounds = {0: flow.bounds[0].bound}
    assert format_program(problem_of(flow.cfg, flow.nest, (19, 26, 7, 5, 10), bounds)) == (
        "Maximize\n"
        " cycles: 19 x_b0_b2 + 26 x_b1_b2 + 7 x_b2_b1 + 5 x_b2_b3 + 10 x_b3_exit\n"
        "Subject To\n"
        " block_0: - x_b0_b2 = -1\n"
        " block_1: - x_b1_b2 + x_b2_b1 = 0\n"
        " block_2: x_b0_b2 + x_b1_b2 - x_b2_b1 - x_b2_b3 = 0\n"
        " block_3: x_b2_b3 - x_b3_exit = 0\n"
        " loop_2: - 100 x_b0_b2 + x_b1_b2 <= 0\n"
        "General\n"
        " x_b0_b2 x_b1_b2 x_b2_b1 x_b2_b3 x_b3_exit\n"
        "End\n"
    )


@pytest.mark.parametrize(("elf", "core"), IMAGES)
def test_the_linear_program_agrees(elf: str, core: str) -> None:
    board = Board("bench", core, 100_000_000)
    for function, bounds in (("loop_triple", (5, 5, 5)), ("loop_break", (81,)), ("loop_two_exits", (31,))):
        program = program_of(image(elf), function, {function: bounds})
        if len(program.functions) == 1:
            structural = result_of(program, board, Method.STRUCTURAL)
            ilp = result_of(program, board, Method.ILP)
            assert structural.cycles is not None and structural.cycles == ilp.cycles


def test_callees_are_counted_and_their_blocks_add_up() -> None:
    board = Board("bench", "arm7tdmi", 100_000_000)
    program = program_of(image("arm7tdmi-arm-O0.elf"), "call_chain", {})
    result = result_of(program, board)
    assert result.problems == ()
    assert sum(block.total for block in result.blocks) == result.cycles
    assert result.calls
    for call in result.calls:
        entry = next(block for block in result.blocks if block.address == call.address)
        assert entry.count == call.count and call.cycles > 0


def test_contexts_keep_their_own_bounds() -> None:
    """A caller pays for each call what that call's context needs; the report adds the contexts up."""
    board = Board("bench", "arm7tdmi", 100_000_000)
    program = program_of(image("arm7tdmi-arm-O0.elf"), "loop_by_context", {"sum_range": [31]})
    both_thirty = result_of(program, board)
    callee = next(key for key, flow in program.functions.items() if flow.cfg.name == "sum_range")
    short = replace(program.functions[callee], bounds={0: LoopBound(11, Origin.ANALYSIS, "test")})
    caller = program.functions[program.entry]
    calls = {edge: ((callee[0], name),) for edge, name in zip(sorted(caller.calls), ("short", ""), strict=True)}
    functions = {(callee[0], "short"): short, callee: program.functions[callee], program.entry: caller}
    functions[program.entry] = replace(caller, calls=calls)
    exact = result_of(replace(program, functions=functions), board)
    assert both_thirty.cycles is not None and exact.cycles is not None
    assert exact.cycles < both_thirty.cycles
    assert exact.cycles == executed_cycles("arm7tdmi-arm-O0.elf", board, "loop_by_context")
    assert {(loop.context, loop.bound) for loop in exact.loops} == {("short", 11), ("", 31)}
    header = next(loop.header for loop in exact.loops)
    assert [block.count for block in exact.blocks if block.address == header] == [11 + 31]


def test_a_loop_without_a_bound_is_a_problem_with_its_call_path() -> None:
    program = program_of(image("arm7tdmi-arm-O0.elf"), "loop_by_context", {})
    result = result_of(program, Board("bench", "arm7tdmi", 100_000_000))
    assert result.cycles is None and result.time is None and result.blocks == ()
    assert [(p.kind, p.function, p.call_path) for p in result.problems] == [
        (ProblemKind.LOOP, "sum_range", ("loop_by_context", "sum_range"))
    ]


def test_no_callee_no_bound_and_never_without_a_reason() -> None:
    program = program_of(image("arm7tdmi-arm-O0.elf"), "loop_by_context", {"sum_range": [31]})
    alone = replace(program, functions={program.entry: program.functions[program.entry]})
    result = result_of(alone, Board("bench", "arm7tdmi", 100_000_000))
    assert result.cycles is None and result.problems


def test_board_problems_leave_no_bound() -> None:
    program = program_of(image("arm7tdmi-arm-O0.elf"), "sum", {"sum": [101]})
    board = Board("bench", "arm7tdmi", 100_000_000)
    core = load_core("arm7tdmi")
    assert core is not None
    problem = Problem(ProblemKind.HARDWARE, "a cache is not modelled")
    result = assemble("sum", program, bound_program(program, core, board), core, board, (problem,), lambda address: "")
    assert result.cycles is None and result.problems == (problem,)


def test_stack_is_the_frame_and_the_deepest_callee() -> None:
    program = program_of(image("arm7tdmi-arm-O0.elf"), "loop_by_context", {"sum_range": [31]})
    frames = {"loop_by_context": 24, "sum_range": 28}
    functions = {key: replace(flow, stack=frames[flow.cfg.name]) for key, flow in program.functions.items()}
    board = Board("bench", "arm7tdmi", 100_000_000)
    assert result_of(replace(program, functions=functions), board).stack == 24 + 28
    unknown = {key: replace(flow, stack=None) for key, flow in program.functions.items()}
    assert result_of(replace(program, functions=unknown), board).stack is None


def test_assumptions_name_the_core_and_the_waits() -> None:
    program = program_of(image("arm7tdmi-arm-O0.elf"), "sum", {"sum": [101]})
    text = "\n".join(result_of(program, Board("bench", "arm920t", 200_000_000)).assumptions)
    assert "ARM9TDMI (ARM920T) at 200 MHz" in text and "DDI 0145B" in text and "AAPCS" in text
    memories = (Memory("rom", 0, 0x100000, 1), Memory("ram", 0x40000000, 0x1000, 0, 2))
    text = "\n".join(result_of(program, Board("bench", "arm920t", 200_000_000, memories)).assumptions)
    assert "rom 1, ram 0 (stores 2)" in text
