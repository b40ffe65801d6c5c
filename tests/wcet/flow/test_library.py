"""The table of helper loops: recognised in linked images, refused for other code, and never below what is executed."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path

import pytest

from mauve.wcet.binary.cfg import build_cfg
from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import loop_nest
from mauve.wcet.binary.split import split_irreducible
from mauve.wcet.flow.facts import Argument, AssumeFact
from mauve.wcet.flow.library import fingerprint, known_functions, library_bound, read_formula, read_table
from mauve.wcet.flow.program import analyse_program
from tests.emulator import EmulationError, Emulator
from tests.wcet.flow.build_library_table import LIBRARY, operands

FIXTURES = Path(__file__).resolve().parents[1] / "fixtures"


def helper(image: str, name: str) -> Cfg:
    binary = load(FIXTURES / image)
    assert isinstance(binary, Binary)
    return split_irreducible(build_cfg(binary, binary.function(name).key))


CASES = [
    ("arm7tdmi-arm-O2.elf", "arm7tdmi", "__divdf3", {13}),
    ("arm7tdmi-arm-O2.elf", "arm7tdmi", "__mulsf3", {23}),
    ("arm7tdmi-arm-O2.elf", "arm7tdmi", "__divsf3", {23}),
    ("arm7tdmi-arm-O2.elf", "arm7tdmi", "__udivmoddi4", {64}),
    ("cortex-m0-thumb-O2.elf", "cortex-m0", "__udivsi3", {3}),
    ("cortex-m0-thumb-O2.elf", "cortex-m0", "__divsi3", {5}),
    ("cortex-m3-thumb-O2.elf", "cortex-m3", "__aeabi_ddiv", {13}),
]


@pytest.mark.parametrize(("image", "cpu", "name", "totals"), CASES)
def test_helpers_are_recognised_and_never_run_longer(image: str, cpu: str, name: str, totals: set[int]) -> None:
    cfg = helper(image, name)
    bounds = {
        cfg.blocks[loop.header].address: bound.bound
        for loop in loop_nest(cfg).loops
        if (bound := library_bound(cfg, loop)) is not None
    }
    assert set(bounds.values()) == totals
    emulator = Emulator(FIXTURES / image, cpu)
    result = emulator.alloc(bytes(16))
    rng = random.Random(11)
    observed = 0
    for _ in range(150):
        try:
            run = emulator.call(name, [*operands(rng), result], max_instructions=50_000)
        except EmulationError:
            continue
        for header, bound in bounds.items():
            observed = max(observed, run.counts.get(header, 0))
            assert run.counts.get(header, 0) <= bound
    assert observed > 0 or name == "__udivmoddi4"


def test_code_that_differs_in_one_instruction_is_not_recognised() -> None:
    cfg = helper("arm7tdmi-arm-O2.elf", "__divdf3")
    block = cfg.blocks[cfg.entry]
    changed = replace(block.instructions[0], text="mov r0, r0")
    blocks = list(cfg.blocks)
    blocks[cfg.entry] = replace(block, instructions=(changed, *block.instructions[1:]))
    other = replace(cfg, blocks=tuple(blocks))
    assert fingerprint(other) != fingerprint(cfg)
    assert all(library_bound(other, loop) is None for loop in loop_nest(other).loops)


def test_the_place_does_not_matter() -> None:
    first, second = (helper(image, "__divdf3") for image in ("arm7tdmi-arm-O2.elf", "arm7tdmi-arm-O0.elf"))
    assert first.address != second.address
    assert fingerprint(first) == fingerprint(second)


COPIES = [
    ("arm7tdmi-arm-O2", "arm7tdmi"),
    ("arm7tdmi-thumb-O2", "arm7tdmi"),
    ("cortex-m0-thumb-O2", "cortex-m0"),
    ("cortex-m3-thumb-O2", "cortex-m3"),
]


@pytest.mark.parametrize(("image", "cpu"), COPIES)
def test_a_copy_is_bounded_by_its_size(image: str, cpu: str) -> None:
    loaded = load(FIXTURES / f"{image}.elf")
    assert isinstance(loaded, Binary)
    key = loaded.function("memcpy").key
    fact = AssumeFact(Argument("memcpy", 3), 0, 90)
    flow = analyse_program(loaded, key, facts=(fact,)).functions[key, ""]
    assert set(flow.bounds) == {loop.id for loop in flow.nest.loops} and not flow.problems
    emulator = Emulator(FIXTURES / f"{image}.elf", cpu)
    here, there = emulator.alloc(200), emulator.alloc(200)
    for size in (0, 1, 3, 7, 15, 16, 31, 47, 63, 64, 79, 80, 89, 90):
        for shift in (0, 1):
            run = emulator.call("memcpy", [there + shift, here, size])
            for loop, bound in flow.bounds.items():
                assert run.counts.get(flow.cfg.blocks[flow.nest.loops[loop].header].address, 0) <= bound.bound
    wide = analyse_program(loaded, key, facts=(AssumeFact(Argument("memcpy", 3), 0, 1 << 30),)).functions[key, ""]
    assert wide.problems


def test_formulas_of_arguments() -> None:
    formula = read_formula("r2 / 16 + 1")
    assert formula.most(lambda register: 47 + register) == 49 // 16 + 1
    assert formula.most(None) is None and formula.most(lambda _: 1 << 31) is None
    assert read_formula(7).most(None) == 7
    assert read_formula("r1 * r1 / 2 + 3 * r1 + 1").most(lambda _: 5) == 12 + 15 + 1


def test_tables_are_complete() -> None:
    assert {path.name for path in LIBRARY.glob("*.toml")} == {
        *("regular.toml", "libgcc.toml", "compiler-rt.toml", "newlib.toml", "sorting.toml", "strings.toml")
    }
    for known in known_functions().values():
        assert known.names and known.found and known.loops
        for loop in known.loops:
            least = loop.total.most(lambda _: 1)
            assert least is not None and least >= 1 and loop.proof


def test_loops_inside_loops_have_a_bound_for_each_entry_and_one_for_the_call() -> None:
    text = """format = 1
    [proofs]
    because = "of this"
    [[function]]
    fingerprint = "00"
    names = ["inner"]
    found = ["here"]
    loops = [{ offset = 8, total = 19, each = 8, proof = "because" }, { offset = 4, total = 3, proof = "because" }]"""
    inner, outer = read_table(text)["00"].loops
    assert inner.each is not None and (inner.total.most(None), inner.each.most(None)) == (19, 8)
    assert (outer.total.most(None), outer.each) == (3, None)


def test_division_of_both_compilers_is_known_in_every_state() -> None:
    found = {place for known in known_functions().values() for place in known.found}
    for core in ("arm7tdmi", "arm926ej_s", "thumb arm7tdmi", "thumb arm926ej_s", "thumb cortex_m0", "thumb cortex_m3"):
        assert f"compiler-rt (zig 0.17.1) {core}" in found
    for multilib in (".", "thumb/nofp", "thumb/v6-m/nofp", "thumb/v7-m/nofp", "thumb/v7e-m/nofp"):
        assert f"libgcc 12.2 {multilib}" in found


def test_a_table_of_another_format_is_empty() -> None:
    assert read_table("format = 0") == {}
