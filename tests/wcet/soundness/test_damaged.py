"""Damaged executables: a result with a bound or with reasons, in bounded time, never an exception."""

from __future__ import annotations

import time
from pathlib import Path
from random import Random

import pytest
from wcet.soundness.damage import change_symbols, damaged
from wcet.soundness.machine_code import POP_PC, PUSH_LR, START, branch, executable

from mauve.wcet.analysis import analyse
from mauve.wcet.binary.elf import Binary, load_bytes
from mauve.wcet.hardware.board import Board

FIXTURES = Path(__file__).parent.parent / "fixtures"
IMAGES = {"arm7tdmi-arm-O2": "arm7tdmi", "arm7tdmi-thumb-O2": "arm7tdmi", "cortex-m3-thumb-O2": "cortex-m3"}
FUNCTIONS = ("sum", "loop_nested", "switch_dense", "insertion_sort", "divide_signed", "tail_call_conditional")


def check(folder: Path, image: str, seed: int, count: int) -> None:
    random, board = Random(seed), Board("bench", IMAGES[image], 1_000_000)
    for number, (kind, data) in enumerate(damaged((FIXTURES / f"{image}.elf").read_bytes(), random, count)):
        started = time.process_time()
        whole = number % 3 == 2
        results = analyse(_file(folder, data), random.sample(FUNCTIONS, 2), board, initial_data=whole, timeout=1.5)
        assert time.process_time() - started < 12, f"damage {number} ({kind}) takes too long"
        for found in results:
            assert found.bounded or found.problems, f"damage {number} ({kind}): no reason"
            assert all(problem.message for problem in found.problems)


def _file(folder: Path, data: bytes) -> Path:
    path = folder / "damaged.elf"
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("image", IMAGES)
def test_damage_gives_reasons(image: str, tmp_path: Path) -> None:
    check(tmp_path, image, 3, 3)


@pytest.mark.slow
@pytest.mark.parametrize("image", IMAGES)
@pytest.mark.parametrize("seed", range(4))
def test_much_damage_gives_reasons(image: str, seed: int, tmp_path: Path) -> None:
    check(tmp_path, image, seed, 100)


@pytest.mark.parametrize("kind", ["unmarked", "sizes", "overlaps", "states"])
def test_symbols_that_lie_do_no_harm(kind: str, tmp_path: Path) -> None:
    data, board = bytearray((FIXTURES / "cortex-m3-thumb-O2.elf").read_bytes()), Board("bench", "cortex-m3", 1_000_000)
    change_symbols(data, kind, Random(5))
    for whole in (False, True):
        for found in analyse(_file(tmp_path, bytes(data)), FUNCTIONS[2:5], board, initial_data=whole, timeout=10.0):
            assert found.bounded or found.problems


def test_a_run_that_calls_bytes_that_are_no_instruction_ends_with_a_reason() -> None:
    """bl to a word that no decoder knows: no graph has blocks for it."""
    words = [PUSH_LR, branch(1, 3, link=True), POP_PC, 0xFFFF_FFFF]
    image = load_bytes(executable(words), "f.elf")
    assert isinstance(image, Binary)
    (found,) = analyse(image, ["f"], Board("bench", "arm7tdmi", 1_000_000), initial_data=True)
    assert [problem.address for problem in found.problems] == [START + 12]
