"""The example robot, built by another compiler and with counters kept in addresses: the same two facts bound all."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mauve.wcet.analysis import analyse
from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.flow.facts import AtLine, Counting, LoopFact
from mauve.wcet.hardware.board import Board, Memory

ROBOT = Path(__file__).parents[3] / "examples" / "ttrk"
BOARD = Board("bench", "arm926ej-s", 200_000_000, (Memory("itcm", 0, 0x10000, 0), Memory("sram", 0x200000, 0x10000, 1)))
FACTS = (
    LoopFact(AtLine("ig500.c", 60), 254, Counting.BODY),
    LoopFact(AtLine("chr6dm.c", 46), 62, Counting.BODY),
)
COMPONENTS = ("IG500_", "CHR6dm_", "StateFusion_", "Command_", "CICAS_")


def unbounded(image: Path) -> list[str]:
    binary = load(image)
    assert isinstance(binary, Binary)
    codels = sorted({symbol.name for symbol in binary.functions if symbol.name.startswith(COMPONENTS)})
    assert len(codels) >= 13
    results = analyse(binary, codels, BOARD, FACTS)
    reading = next(result for result in results if result.name == "IG500_read")
    assert reading.cycles is None or reading.cycles < 20_000, "a loop has the bound of a type"
    return [result.name for result in results if result.cycles is None]


def test_every_codel_of_the_committed_build_is_bounded():
    assert unbounded(ROBOT / "ttrk.elf") == []


@pytest.mark.slow
def test_every_codel_of_the_clang_build_is_bounded(tmp_path):
    image = tmp_path / "clang.elf"
    subprocess.run([sys.executable, "build.py", "--compiler", "clang", "--output", str(image)], cwd=ROBOT, check=True)
    assert unbounded(image) == []
