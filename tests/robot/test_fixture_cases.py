"""The fixture programs compute the same under every compiler setting and core, for all the inputs of the case table."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from emulator import Emulator, Execution
from wcet.fixtures.cases import CASES, FOLDER, Case, loop_promises

DOUBLES = {
    "double_add", "double_sub", "double_mul", "double_div", "float_to_double", "int_to_double", "unsigned_to_double",
    "int64_to_double", "uint64_to_double", "dot_product", "polynomial", "newton_root",
}  # fmt: skip
FLOATS = {"float_add", "float_sub", "float_mul", "float_div", "double_to_float", "int_to_float", "unsigned_to_float",
          "int64_to_float", "low_pass"}  # fmt: skip
WIDE = {
    "multiply_wide", "multiply_64", "divide_64", "divide_64_signed", "modulo_64", "shift_left_64", "shift_right_64",
    "shift_right_64_signed", "multiply_accumulate_64", "float_to_int64", "double_to_int64", "double_to_uint64",
    "loop_wide_counter",
}  # fmt: skip


def cpu_of(image: Path) -> str:
    return image.name.split("-arm-")[0].split("-thumb-")[0]


def result(case: Case, execution: Execution) -> object:
    """What the C function returns. Which NaN it is, libraries choose freely."""
    if not case.returns:
        return None
    if case.function in DOUBLES:
        return "nan" if math.isnan(execution.float64) else execution.uint64
    if case.function in FLOATS:
        return "nan" if math.isnan(execution.float32) else execution.r0
    if case.function in WIDE:
        return execution.uint64
    return execution.r0


def run_all(image: Path) -> dict[int, object]:
    emulator, seen = Emulator(image, cpu_of(image)), {}
    for number, case in enumerate(CASES):
        if number % 40 == 0:
            emulator.reset()
        seen[number] = result(case, emulator.call(case.function, case.place(emulator)))
    return seen


@pytest.mark.slow
def test_all_images_agree() -> None:
    images = sorted(FOLDER.glob("*.elf"))
    reference = run_all(images[0])
    for image in images[1:]:
        other = run_all(image)
        different = [CASES[n] for n in reference if reference[n] != other[n]]
        assert not different, (image.name, different[:5])


def test_the_table_reaches_every_function_with_a_promise() -> None:
    """Each annotated loop lies in a function that some case calls, directly or not."""
    emulator = Emulator(FOLDER / "arm7tdmi-arm-O0.elf", "arm7tdmi")
    executed: set[int] = set()
    for number, case in enumerate(CASES):
        if number % 40 == 0:
            emulator.reset()
        executed |= emulator.call(case.function, case.place(emulator)).counts.keys()
    never = {
        symbol.name
        for symbol in emulator.symbols
        if symbol.is_function and symbol.size and symbol.address not in executed
        and not symbol.name.startswith(("asm_", "thumb_", "_"))
    }  # fmt: skip
    assert never <= {"spin_forever", "wait_for_flag", "return_struct", "memcpy"}


def test_promises_are_read_from_the_sources() -> None:
    promises = loop_promises()
    assert len(promises) > 80
    assert promises["loops.c", 9] == 100
    assert sum(bound is None for bound in promises.values()) == 7
