"""Executables: symbols, memory, and a named problem for everything that is none."""

from __future__ import annotations

import random
import struct
from pathlib import Path

import pytest

from mauve.wcet.binary.elf import Binary, Content, ElfProblem, ElfProblemKind, Symbol, load, load_bytes
from mauve.wcet.binary.lines import load_lines, same_file

FIXTURES = Path(__file__).parent.parent / "fixtures"
RAW = (FIXTURES / "arm7tdmi-arm-O2.elf").read_bytes()


def _patched(*changes: tuple[int, bytes]) -> bytes:
    data = bytearray(RAW)
    for at, new in changes:
        data[at : at + len(new)] = new
    return bytes(data)


def _binary(name: str = "arm7tdmi-arm-O2") -> Binary:
    binary = load(FIXTURES / f"{name}.elf")
    assert isinstance(binary, Binary)
    return binary


@pytest.mark.parametrize(
    ("data", "kind", "text"),
    [
        (b"", ElfProblemKind.NOT_ELF, "empty"),
        (b"hello", ElfProblemKind.NOT_ELF, "not an ELF"),
        (RAW[:30], ElfProblemKind.TRUNCATED, "truncated"),
        (RAW[:5000], ElfProblemKind.TRUNCATED, "truncated"),
        (_patched((4, b"\2")), ElfProblemKind.SIXTY_FOUR_BIT, "64-bit"),
        (_patched((18, b"\3\0")), ElfProblemKind.NOT_ARM, "e_machine is 3"),
        (_patched((16, b"\1\0")), ElfProblemKind.RELOCATABLE, "link it first"),
        (_patched((44, b"\0\0")), ElfProblemKind.NO_CODE, "no program headers"),
    ],
)
def test_what_is_no_executable_is_named(data: bytes, kind: ElfProblemKind, text: str) -> None:
    problem = load_bytes(data, "robot.elf")
    assert isinstance(problem, ElfProblem)
    assert problem.kind is kind and text in problem.message and "robot.elf" in problem.message


@pytest.mark.parametrize(("flags", "form"), [(0x05800000, "BE8"), (0x05000000, "BE32")])
def test_big_endian_is_named(flags: int, form: str) -> None:
    header = b"\x7fELF\1\2\1" + bytes(9) + struct.pack(">HHIIIIIHHHHHH", 2, 40, 1, 0, 52, 0, flags, 52, 32, 1, 40, 0, 0)
    problem = load_bytes(header + bytes(32), "robot.elf")
    assert isinstance(problem, ElfProblem)
    assert problem.kind is ElfProblemKind.BIG_ENDIAN and form in problem.message


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    for path in (tmp_path / "none.elf", tmp_path):
        problem = load(path)
        assert isinstance(problem, ElfProblem) and problem.kind is ElfProblemKind.NOT_A_FILE


def test_functions_data_and_addresses() -> None:
    binary = _binary()
    assert isinstance(binary.function("sum"), Symbol)
    missing, data = binary.function("summ"), binary.function(binary.objects[0].name)
    assert isinstance(missing, ElfProblem) and missing.kind is ElfProblemKind.NOT_FOUND
    assert isinstance(data, ElfProblem) and data.kind is ElfProblemKind.NOT_A_FUNCTION
    thumb = binary.function("asm_thumb_triple")
    assert isinstance(thumb, Symbol) and thumb.thumb and thumb.key == thumb.address + 1
    assert binary.function(hex(thumb.address)) == thumb == binary.symbol_at(thumb.key)
    assert binary.name_at(thumb.address + 2) == "asm_thumb_triple+0x2"
    assert binary.content_at(thumb.address) is Content.THUMB
    assert "sum" in binary.function_names()


def test_constants_are_only_what_nothing_writes() -> None:
    binary = _binary()
    code = binary.function("sum")
    assert isinstance(code, Symbol)
    assert binary.read_constant(code.address, 4) == binary.read(code.address, 4) is not None
    writable = next(s for s in binary.segments if s.writable)
    assert binary.read(writable.address, 4) is not None and binary.read_constant(writable.address, 4) is None
    assert binary.read(writable.end - 2, 4) is None and binary.read_code(writable.address, 2) is None
    if writable.zero_fill:
        assert binary.read(writable.end - 1, 1) == b"\0"


def test_a_stripped_binary_offers_addresses() -> None:
    offset = RAW.index(b".symtab\0")
    assert offset > 0
    shoff, shentsize, shnum = (struct.unpack_from(f, RAW, at)[0] for f, at in (("<I", 32), ("<H", 46), ("<H", 48)))
    data = bytearray(RAW)
    for number in range(shnum):
        at = shoff + number * shentsize + 4
        if struct.unpack_from("<I", data, at)[0] == 2:
            struct.pack_into("<I", data, at, 1)
    binary = load_bytes(bytes(data), "robot.elf")
    assert isinstance(binary, Binary) and binary.stripped
    problem = binary.function("sum")
    assert isinstance(problem, ElfProblem) and "stripped" in problem.message and "address" in problem.message
    found = binary.function("0x8000")
    assert isinstance(found, Symbol) and found.address == 0x8000 and not found.thumb


@pytest.mark.parametrize("seed", range(60))
def test_damaged_files_never_raise(seed: int) -> None:
    chance = random.Random(seed)
    data = bytearray(RAW)
    if seed % 3 == 0:
        del data[chance.randrange(len(data)) :]
    else:
        low, high = (0, 0x100) if seed % 3 == 1 else (0x6000, len(data))
        for _ in range(30):
            data[chance.randrange(low, high)] = chance.randrange(256)
    found = load_bytes(bytes(data), "robot.elf")
    if isinstance(found, Binary):
        assert load_lines(found).location(found.entry) is None or found.functions is not None
    else:
        assert "robot.elf" in found.message and "\n" not in found.message


def test_lines_of_code_and_code_of_lines() -> None:
    binary = _binary("arm7tdmi-arm-O0")
    table = load_lines(binary)
    assert [table.source(0x8000), table.source(0x8050), table.source(0x806C)] == [
        "loops.c:6",
        "loops.c:9",
        "loops.c:12",
    ]
    assert table.addresses("loops.c", 8) == table.addresses("tests/wcet/fixtures/loops.c", 8) == (0x8010,)
    assert table.addresses("oops.c", 8) == () and table.source(0x10) == ""
    assert {"loops.c", "control.c"} <= {unit.name for unit in table.units}


def test_which_paths_name_the_same_file() -> None:
    assert same_file("src/fusion.c", "fusion.c") and same_file("fusion.c", "src/fusion.c")
    assert same_file("/home/a/src/fusion.c", "src/fusion.c") and same_file("./fusion.c", "fusion.c")
    assert not same_file("src/fusion.c", "lib/fusion.c") and not same_file("confusion.c", "fusion.c")
