"""Real images: no execution under the emulator exceeds a bound or a total, or enters a block called infeasible."""

from __future__ import annotations

from functools import lru_cache

import pytest
from emulator import Emulator
from wcet.fixtures.cases import CASES, FOLDER

from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.graph import EXIT
from mauve.wcet.flow.facts import AtAddress, AtLine, Counting, LoopFact
from mauve.wcet.flow.program import Limits, Programs, analyse_program
from mauve.wcet.flow.result import ProgramFlow
from mauve.wcet.result import Origin

IMAGES = {
    "arm7tdmi-arm-O0": "arm7tdmi",
    "arm7tdmi-arm-O1": "arm7tdmi",
    "arm7tdmi-arm-O2": "arm7tdmi",
    "arm7tdmi-arm-Os": "arm7tdmi",
    "arm926ej-s-arm-O2": "arm926ej-s",
    "arm7tdmi-thumb-O2": "arm7tdmi",
    "cortex-m0-thumb-O2": "cortex-m0",
    "cortex-m0-thumb-Os": "cortex-m0",
    "cortex-m3-thumb-O2": "cortex-m3",
}
LIGHT = Limits(steps=4_000)


@lru_cache(maxsize=1)
def binary(image: str) -> Binary:
    loaded = load(FOLDER / f"{image}.elf")
    assert isinstance(loaded, Binary)
    return loaded


def analyse(image: str, function: str, limits: Limits = LIGHT) -> ProgramFlow:
    symbol = binary(image).function(function)
    return analyse_program(binary(image), symbol.key, limits=limits)


def check(flow: ProgramFlow, counts: dict[int, int]) -> list[str]:
    """What an execution did that the analysis says cannot be."""
    wrong = []
    by_function: dict[int, list] = {}
    for (key, _), function in flow.functions.items():
        by_function.setdefault(key, []).append(function)
    for key, functions in by_function.items():
        calls = counts.get(key & ~1, 0)
        for function in functions:
            headers = {function.cfg.blocks[loop.header].address for loop in function.nest.loops}
            entered_at_header = key & ~1 in headers
            copied = len({block.address for block in function.cfg.blocks}) < len(function.cfg.blocks)
            for index, bound in function.bounds.items():
                if len(functions) > 1 or entered_at_header or copied:
                    continue
                loop = function.nest.loops[index]
                header = function.cfg.blocks[loop.header]
                executed = counts.get(header.address, 0)
                if bound.total is not None and executed > bound.total * calls:
                    allowed = bound.total * calls
                    wrong.append(f"{function.cfg.name}: {header.address:#x} ran {executed} > {allowed} in all")
                entries = sum(
                    counts.get(function.cfg.blocks[function.cfg.edges[e].source].instructions[-1].address, 0)
                    for e in loop.entry_edges
                )
                if executed > bound.bound * entries:
                    wrong.append(f"{function.cfg.name}: {header.address:#x} ran {executed} > {bound.bound} x {entries}")
        # A block may stand in a graph twice (node splitting): what ran is one of the two.
        live = {function.cfg.blocks[block].address for function in functions for block in _live(function)}
        for block in functions[0].cfg.blocks:
            if block.address not in live and counts.get(block.address, 0):
                wrong.append(f"{functions[0].cfg.name}: block {block.address:#x} ran but was called infeasible")
    return wrong


def _live(function) -> set[int]:
    seen, work = {function.cfg.entry}, [function.cfg.entry]
    while work:
        block = work.pop()
        for index, edge in enumerate(function.cfg.edges):
            if edge.source != block or index in function.infeasible:
                continue
            if edge.target != EXIT and edge.target not in seen:
                seen.add(edge.target)
                work.append(edge.target)
    return seen


def compare(image: str, keep) -> tuple[list[str], int]:
    """All mismatches of the cases that `keep` accepts, and how many executions were compared."""
    emulator = Emulator(FOLDER / f"{image}.elf", IMAGES[image])
    flows: dict[str, ProgramFlow] = {}
    wrong, compared = [], 0
    for case in CASES:
        if not keep(case.function):
            continue
        if case.function not in flows:
            flows[case.function] = analyse(image, case.function)
        emulator.reset()
        execution = emulator.call(case.function, case.place(emulator))
        wrong += [f"{case.function}: {line}" for line in check(flows[case.function], execution.counts)]
        compared += 1
    return wrong, compared


QUICK = ("sum", "loop_triangular", "loop_by_context", "loop_clamped_unsigned", "insertion_sort", "shift_log2")


@pytest.mark.parametrize("image", IMAGES)
def test_executions_stay_within_the_bounds(image):
    wrong, compared = compare(image, lambda name: name in QUICK)
    assert compared >= len(QUICK)
    assert not wrong


@pytest.mark.slow
@pytest.mark.parametrize("image", IMAGES)
def test_all_executions_stay_within_the_bounds(image):
    wrong, compared = compare(image, lambda name: True)
    assert compared > 100
    assert not wrong


def bound_of(image: str, function: str, limits: Limits = LIGHT) -> list[tuple[int, int | None]]:
    """(bound, total) of the loops of a function, outer ones first."""
    flow = analyse(image, function, limits)
    bounds = flow.functions[flow.entry].bounds
    return [(bounds[loop].bound, bounds[loop].total) for loop in sorted(bounds)]


@pytest.mark.parametrize(
    ("function", "at_o0", "at_o2"),
    [
        ("sum", [101], [100]),
        ("loop_up_unsigned", [38], [37]),
        ("loop_step_up", [15], [14]),
        ("loop_ne", [17], [16]),
        ("loop_dowhile", [31], [31]),
        ("loop_pointer_end", [41], [40]),
        ("loop_clamped", [61], [60]),
        ("loop_clamped_unsigned", [29], [28]),
        ("loop_masked", [16], [15]),
        ("loop_rejected", [51], [50]),
        ("loop_from_argument", [55], [54]),
        ("loop_two_exits", [31], [30]),
        ("loop_two_indices", [21], [20]),
        ("loop_variable_step", [51], [50]),
        ("loop_memory_counter", [27], [26]),
        ("loop_nested", [9, 13], [8, 12]),
        ("loop_nested_clamped", [7, 10], [6, 9]),
        ("loop_sequence", [12, 14], [11, 13]),
        ("loop_wide_counter", [22], [21]),
        ("crc32_bitwise", [33, 9], [32, 8]),
        ("shift_count_bits", [33], [32]),
        ("stack_array", [25, 25], [24, 24]),
        ("filter_step", [8], [7]),
    ],
)
def test_counted_loops_get_the_exact_number_of_header_executions(function, at_o0, at_o2):
    assert [bound for bound, _ in bound_of("arm7tdmi-arm-O0", function)] == at_o0
    assert [bound for bound, _ in bound_of("arm7tdmi-arm-O2", function)] == at_o2


def test_a_triangular_nest_has_its_total():
    assert bound_of("arm7tdmi-arm-O2", "loop_triangular") == [(9, 9), (9, 45)]
    assert bound_of("arm7tdmi-arm-O0", "loop_triangular", Limits()) == [(10, 10), (10, 54)]
    assert bound_of("arm7tdmi-arm-O2", "loop_triple") == [(4, 4), (4, 16), (4, 64)]


def test_a_callee_bounded_by_its_callers_only_has_a_context_for_each_call():
    flow = analyse("arm7tdmi-arm-O2", "loop_by_context")
    callees = {name[1]: function for name, function in flow.functions.items() if function.cfg.name == "sum_range"}
    found = {words: function.bounds[0].bound for words, function in callees.items()}
    assert found == {"r1=10": 10, "r1=30": 30}


@pytest.mark.parametrize("function", ["list_sum", "string_length", "wait_for_flag", "spin_forever", "sum_range"])
@pytest.mark.parametrize("image", ["arm7tdmi-arm-O0", "arm7tdmi-arm-O2", "cortex-m0-thumb-Os", "cortex-m3-thumb-O2"])
def test_what_depends_on_unknown_data_gets_a_located_problem_and_no_number(image, function):
    flow = analyse(image, function)
    entry = flow.functions[flow.entry]
    assert not entry.bounds
    assert [problem.kind.name for problem in entry.problems] == ["LOOP"]
    assert entry.problems[0].function == function
    assert entry.problems[0].address in {entry.cfg.blocks[loop.header].address for loop in entry.nest.loops}


TOGETHER = ["loop_by_context", "sum_range", "loop_triangular", "calls_recursion", "string_length", "shift_count_bits"]


@pytest.mark.parametrize("order", [TOGETHER, TOGETHER[::-1]])
def test_what_entries_share_does_not_change_their_results(order):
    image = binary("arm7tdmi-arm-O2")
    programs = Programs(image, limits=LIGHT)
    for function in order:
        assert programs.program(image.function(function).key) == analyse("arm7tdmi-arm-O2", function)


def test_a_time_limit_of_one_entry_spoils_nothing_for_the_next():
    image = binary("arm7tdmi-arm-O2")
    programs, key = Programs(image, limits=LIGHT), image.function("loop_by_context").key
    assert [p.kind.name for p in programs.program(key, 0.0).problems] == ["LIMIT"]
    assert programs.program(key) == analyse("arm7tdmi-arm-O2", "loop_by_context")


def test_recursion_is_named():
    flow = analyse("arm7tdmi-arm-O0", "calls_recursion")
    assert [problem.message for problem in flow.problems] == ["recursion: recursive_factorial -> recursive_factorial"]


def test_a_flow_fact_bounds_a_loop_and_is_named_as_its_origin():
    symbol = binary("arm7tdmi-arm-O2").function("list_sum")
    line = next(n for n, text in enumerate((FOLDER / "data.c").read_text().splitlines(), 1) if "while (node) {" in text)
    fact = LoopFact(AtLine("data.c", line), 40, Counting.BODY, written="robot.mauve:7")
    flow = analyse_program(binary("arm7tdmi-arm-O2"), symbol.key, facts=[fact], limits=LIGHT)
    bound = flow.functions[flow.entry].bounds[0]
    assert (bound.origin, bound.bound in (40, 41)) == (Origin.ANNOTATION, True)
    assert not flow.functions[flow.entry].problems


def test_a_flow_fact_that_is_looser_than_the_analysis_changes_nothing():
    symbol = binary("arm7tdmi-arm-O0").function("sum")
    address = next(
        function.cfg.blocks[function.nest.loops[0].header].address
        for function in analyse("arm7tdmi-arm-O0", "sum").functions.values()
    )
    fact = LoopFact(AtAddress(address), 5000, Counting.HEADER, written="robot.ff:3")
    flow = analyse_program(binary("arm7tdmi-arm-O0"), symbol.key, facts=[fact], limits=LIGHT)
    bound = flow.functions[flow.entry].bounds[0]
    assert (bound.bound, bound.origin) == (101, Origin.ANALYSIS)


def test_a_helper_of_the_library_is_bounded_by_table():
    flow = analyse("arm7tdmi-arm-O2", "float_div")
    helper = next(function for function in flow.functions.values() if function.cfg.name == "__aeabi_fdiv")
    assert not helper.problems
    assert {bound.origin for bound in helper.bounds.values()} <= {Origin.LIBRARY, Origin.ANALYSIS}


def test_a_time_limit_gives_a_problem_and_no_number():
    symbol = binary("arm7tdmi-arm-O2").function("matrix_multiply")
    flow = analyse_program(binary("arm7tdmi-arm-O2"), symbol.key, timeout=0.0)
    assert [problem.kind.name for problem in flow.problems] == ["LIMIT"]
    assert not flow.functions
