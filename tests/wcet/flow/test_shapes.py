"""Loops on numbers of which nothing is known, without a run: bounds, and executions beside them."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.flow import domain
from mauve.wcet.flow.effects import quotients
from mauve.wcet.flow.locations import Helper
from mauve.wcet.flow.program import Programs
from mauve.wcet.flow.result import ProgramFlow
from tests.emulator import EmulationError, Emulator
from tests.wcet.soundness.replay import Replay, record

SHAPES = Path(__file__).parent / "shapes"
IMAGES = ("arm7tdmi-O0", "cortex-m3-O2")
BOUNDS = {"trailing": 33, "normal": 4, "halves": 32, "leaves": 41, "common": 46, "divisor": 47,
          "refill": 19, "above": 9, "falls": 34, "guessed": 35, "meets": 35, "drifts": 100}  # fmt: skip
"""By function, the executions of the loop's header; one less where the compiler tests at the end."""
ENDLESS = {"trailing": 0, "normal": 0, "halves": 1 << 31}
CORNERS = (0, 1, 2, 3, 127, 128, 255, 256, 0x7FFF_FFFF, 0x8000_0000, 0x8000_0001, 0xFFFF_FFFF, 2_971_215_073)


@cache
def analysed(name: str, function: str) -> tuple[ProgramFlow, int | None]:
    """The result from any arguments, and the bound of the function's loop."""
    binary = load(SHAPES / f"{name}.elf")
    assert isinstance(binary, Binary)
    flow = Programs(binary).without_run(binary.function(function).key)
    (mine,) = (found for found in flow.functions.values() if found.cfg.name == function)
    (bound,) = (mine.bounds.get(loop.id) for loop in mine.nest.loops)
    return flow, None if bound is None else bound.bound


@pytest.mark.parametrize("function", BOUNDS)
@pytest.mark.parametrize("name", IMAGES)
def test_each_shape_has_its_bound(name: str, function: str) -> None:
    flow, bound = analysed(name, function)
    assert not flow.problems
    assert bound is not None and bound in (BOUNDS[function], BOUNDS[function] - 1)


@pytest.mark.parametrize("name", IMAGES)
def test_no_execution_exceeds_a_bound(name: str) -> None:
    emulator = Emulator(SHAPES / f"{name}.elf", name.rpartition("-")[0])
    for function in BOUNDS:
        replay, random, ended = Replay(analysed(name, function)[0], ()), Random(function), 0
        for number in range(24):
            first = random.choice(CORNERS) if number % 2 else random.getrandbits(32) >> random.randrange(32)
            second = random.choice(CORNERS) if number % 3 else random.getrandbits(32) >> random.randrange(32)
            emulator.reset()
            try:
                run = record(emulator, function, [first, second], 20_000)
            except EmulationError:
                assert function in ENDLESS and (first == 0 or first >= ENDLESS[function] > 0)
                continue
            ended += 1
            replay.walk(run)
        assert ended > 8 and not replay.wrong, (function, replay.wrong)


numbers = st.integers(0, domain.MASK) | st.sampled_from([0, 1, 2, domain.SIGN - 1, domain.SIGN, domain.MASK])


@settings(max_examples=150, deadline=None)
@given(numbers, st.integers(0, 40), numbers, st.integers(0, 40), st.sampled_from(list(Helper)))
def test_divisions_of_ranges_hold_all_results(a: int, more: int, b: int, wider: int, helper: Helper) -> None:
    x, y = domain.between(a, a + more), domain.between(b, b + wider)
    found = dict(quotients(helper, x, y))
    assert not (found and 0 in y) and (found or 0 in y or helper.is_signed)
    for dividend in (a, a + more // 2, a + more) if found else ():
        for divisor in (b, b + wider // 2, b + wider):
            n, d = dividend & domain.MASK, divisor & domain.MASK
            if helper.is_signed:
                n, d = domain.signed(n), domain.signed(d)
            quotient = abs(n) // abs(d) * (1 if (n < 0) == (d < 0) else -1)
            for register, value in ((helper.quotient, quotient), (helper.remainder, n - quotient * d)):
                assert register is None or value & domain.MASK in found[register]
