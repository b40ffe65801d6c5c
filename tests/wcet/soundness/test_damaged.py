"""Damaged executables: a result with a bound or with reasons, in bounded time, never an exception."""

from __future__ import annotations

import time
from pathlib import Path
from random import Random

import pytest
from wcet.soundness.damage import damaged

from mauve.wcet.analysis import analyse
from mauve.wcet.hardware.board import Board

FIXTURES = Path(__file__).parent.parent / "fixtures"
IMAGES = {"arm7tdmi-arm-O2": "arm7tdmi", "arm7tdmi-thumb-O2": "arm7tdmi", "cortex-m3-thumb-O2": "cortex-m3"}
FUNCTIONS = ("sum", "loop_nested", "switch_dense", "insertion_sort", "divide_signed", "tail_call_conditional")


def check(folder: Path, image: str, seed: int, count: int) -> None:
    random, board = Random(seed), Board("bench", IMAGES[image], 1_000_000)
    for number, (kind, data) in enumerate(damaged((FIXTURES / f"{image}.elf").read_bytes(), random, count)):
        started = time.process_time()
        results = analyse(_file(folder, data), random.sample(FUNCTIONS, 2), board, timeout=10.0)
        assert time.process_time() - started < 30, f"damage {number} ({kind}) takes too long"
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
