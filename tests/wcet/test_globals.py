"""The objects that a function reads and writes are told by name, callees included."""

from __future__ import annotations

from pathlib import Path

import pytest

from mauve.wcet.analysis import analyse
from mauve.wcet.hardware.board import Board

IMAGES = Path(__file__).parent


@pytest.mark.parametrize(
    ("image", "function", "expected"),
    [
        ("assumed/arm7tdmi.elf", "global", [("length", True, False), ("source", True, False)]),
        ("assumed/cortex-m3.elf", "element", [("offsets", True, False), ("source", True, False)]),
        ("recursion/arm7tdmi.elf", "even_of_11", [("values", True, False)]),
        ("recursion/arm7tdmi.elf", "_start", [("values", True, True)]),
        ("recursion/arm7tdmi.elf", "factorial", []),
    ],
)
def test_objects_by_name(image: str, function: str, expected: list[tuple[str, bool, bool]]) -> None:
    core = "cortex-m3" if "m3" in image else "arm7tdmi"
    (result,) = analyse(IMAGES / image, [function], Board("test", core, 100_000_000))
    assert [(use.symbol, use.reads, use.writes) for use in result.globals] == expected
