"""No execution takes longer than the bound: functions of the fixtures on random inputs, timed by a second model."""

from __future__ import annotations

import struct
from pathlib import Path
from random import Random

import pytest
from emulator import Argument, EmulationError, Emulator, Int64, f32

from mauve.wcet.analysis import analyse
from mauve.wcet.hardware.board import Board, Memory
from mauve.wcet.hardware.core import load_core
from mauve.wcet.result import WcetResult
from tests.wcet.programs import FIXTURES, image
from tests.wcet.reference import Executed, Tracer, bus_cycles, pipeline_cycles

ELVES = [
    ("arm7tdmi-arm-O0.elf", "arm7tdmi"),
    ("arm7tdmi-arm-O2.elf", "arm7tdmi"),
    ("arm7tdmi-arm-Os.elf", "arm920t"),
    ("arm926ej-s-arm-O2.elf", "arm926ej-s"),
    ("arm7tdmi-thumb-O2.elf", "arm7tdmi"),
    ("arm7tdmi-thumb-O2.elf", "arm926ej-s"),
]

# b: random bytes, w: small words, i: a small integer (mostly), u: any word; f, d, q: float, double, 64-bit integer
QUICK = {
    "sum": "w",
    "loop_down_unsigned": "w",
    "loop_break": "wi",
    "loop_continue": "w",
    "loop_nested": "w",
    "loop_triangular": "w",
    "loop_triple": "www",
    "loop_clamped": "wi",
    "loop_rejected": "wi",
    "loop_two_exits": "wi",
    "loop_conditional_increment": "w",
    "switch_dense": "iuu",
    "switch_sparse": "iuu",
    "switch_in_loop": "bu",
    "tail_call_conditional": "uu",
    "call_chain": "uu",
    "return_early": "wi",
    "conditional_execution": "iii",
    "absolute_sum": "w",
    "clamp": "uuu",
    "logical": "iii",
    "unbalanced": "wi",
    "call_by_value": "wi",
    "stack_array": "u",
    "table_scan": "i",
    "insertion_sort": "w",
    "crc16_ccitt": "b",
    "shift_count_bits": "u",
    "reverse_bits": "u",
    "filter_step": "u",
    "divide_constant": "u",
    "multiply_64": "qq",
    "compare_64": "qq",
    "float_add": "ff",
    "float_less": "ff",
    "float_to_int": "f",
    "double_add": "dd",
    "double_less": "dd",
    "double_to_int": "d",
}
SLOW = {
    "divide_unsigned": "uu",
    "divide_signed": "uu",
    "modulo_unsigned": "uu",
    "modulo_signed": "uu",
    "decimal_digits": "uib",
    "average": "wi",
    "divide_64": "qq",
    "float_mul": "ff",
    "float_div": "ff",
    "double_mul": "dd",
    "double_div": "dd",
    "double_to_int64": "d",
    "dot_product": "bb",
    "polynomial": "d",
    "newton_root": "d",
    "matrix_multiply": "bbb",
}


def argument(kind: str, random: Random, emulator: Emulator) -> Argument:
    def words(low: int, high: int, count: int = 200) -> list[int]:
        return [random.randint(low, high) for _ in range(count)]

    match kind:
        case "b":
            return emulator.alloc(random.randbytes(512))
        case "w":
            return emulator.alloc(struct.pack("<200i", *words(-5, 60)))
        case "i":
            return random.choice([random.randint(-3, 70), random.randint(-(1 << 31), (1 << 31) - 1)]) & 0xFFFF_FFFF
        case "u":
            return random.getrandbits(random.choice([3, 8, 16, 32]))
        case "f":
            return random.choice([random.getrandbits(32), f32(random.uniform(-1e5, 1e5))])
        case "d":
            (any_bits,) = struct.unpack("<d", random.randbytes(8))
            return float(random.choice([any_bits, random.uniform(-1e9, 1e9), 0.0]))
        case "q":
            return Int64(random.getrandbits(random.choice([8, 32, 64])))
    raise ValueError(kind)


def runs(tracer: Tracer, function: str, kinds: str, times: int, seed: int) -> list[list[Executed]]:
    """Executions on random inputs; an input that the emulated machine rejects is replaced by another."""
    random = Random(seed)
    found: list[list[Executed]] = []
    rejected = 0
    while len(found) < times:
        tracer.emulator.reset()
        try:
            found.append(tracer.run(function, [argument(kind, random, tracer.emulator) for kind in kinds]))
        except EmulationError:
            rejected += 1
            assert rejected < times, f"{function} does not run"
    return found


def cycles_of(trace: list[Executed], board: Board) -> int:
    core = load_core(board.core)
    assert core is not None
    return bus_cycles(trace, board) if board.core == "arm7tdmi" else pipeline_cycles(trace, core, board)


def check(elf: str, board: Board, functions: dict[str, str], times: int) -> dict[str, tuple[int, int]]:
    """Every bounded function: the bound and the longest execution. Also every block count and the stack."""
    tracer = Tracer(FIXTURES / elf, board.core)
    known = [name for name in functions if name in image(elf).function_names()]
    found = {}
    for result in analyse(image(elf), known, board):
        if result.cycles is None:
            continue
        traces = runs(tracer, result.name, functions[result.name], times, seed=hash_of(result.name))
        longest = max(cycles_of(trace, board) for trace in traces)
        assert longest <= result.cycles, f"{elf} {board.core} {result.name}: {longest} executed, bound {result.cycles}"
        found[result.name] = (result.cycles, longest)
        check_loops(result, traces)
    return found


def check_loops(result: WcetResult, traces: list[list[Executed]]) -> None:
    """No loop header runs more often in all than its bound allows where it is entered once."""
    outermost = {}
    for loop in result.loops:
        if loop.function == result.name and loop.total is not None:
            outermost[loop.header] = loop.total
    for trace in traces:
        for header, total in outermost.items():
            assert sum(step.instruction.address == header for step in trace) <= total


def hash_of(name: str) -> int:
    return int.from_bytes(name.encode()[-6:], "little")


@pytest.mark.parametrize(("elf", "core"), ELVES)
def test_no_execution_exceeds_its_bound(elf: str, core: str) -> None:
    """A slice of the functions, another one for each image and core."""
    some = dict(list(QUICK.items())[ELVES.index((elf, core)) :: 5]) | {"loop_nested": "w"}
    found = check(elf, Board("bench", core, 100_000_000), some, times=4)
    assert len(found) >= len(some) - 2, sorted(set(some) - set(found))
    bound, longest = found["loop_nested"]
    assert core == "arm7tdmi" or bound == longest


@pytest.mark.slow
@pytest.mark.parametrize(("elf", "core"), [ELVES[1], ELVES[3], ELVES[4]])
def test_no_execution_exceeds_its_bound_with_wait_states(elf: str, core: str) -> None:
    memories = (
        Memory("flash", 0x8000, 0x30000, 3),
        Memory("data", 0x40000, 0x10000, 1, 2),
        Memory("stack", 0x6000_0000, 0x1_0000, 0),
        Memory("heap", 0x5000_0000, 0x4_0000, 2, 4),
    )
    found = check(elf, Board("slow", core, 100_000_000, memories), QUICK, times=10)
    assert len(found) >= 35


@pytest.mark.slow
@pytest.mark.parametrize(("elf", "core"), ELVES)
def test_no_execution_of_library_code_exceeds_its_bound(elf: str, core: str) -> None:
    found = check(elf, Board("bench", core, 100_000_000), SLOW, times=100)
    assert {"divide_unsigned", "double_mul", "double_div", "polynomial"} <= set(found)


@pytest.mark.slow
@pytest.mark.parametrize(("elf", "core"), ELVES)
def test_many_inputs(elf: str, core: str) -> None:
    assert len(check(elf, Board("bench", core, 100_000_000), QUICK, times=100)) >= 35


def test_the_fixtures_are_where_the_tests_look() -> None:
    assert all(Path(FIXTURES / elf).is_file() for elf, _ in ELVES)
