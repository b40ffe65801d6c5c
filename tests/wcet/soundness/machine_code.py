"""Executables from instruction words: no compiler, and any symbol table."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence

START = 0x8000
PUSH_LR, POP_PC, BX_LR, NOP = 0xE52D_E004, 0xE49D_F004, 0xE12F_FF1E, 0xE1A0_0000
_HEADER = struct.Struct("<16sHHIIIIIHHHHHH")

Symbol = tuple[str, int, int]
"""Name, value (address, bit 0 set for Thumb), size."""


def branch(at: int, to: int, link: bool = False, condition: int = 0xE) -> int:
    """`b` or `bl`, both places as indices of words."""
    return condition << 28 | (0xB if link else 0xA) << 24 | (to - at - 2) & 0xFF_FFFF


def executable(words: Sequence[int], symbols: Iterable[Symbol] = (("f", START, 0),)) -> bytes:
    """An ARM executable with one segment of code at START and these function symbols, without mapping symbols."""
    code = struct.pack(f"<{len(words)}I", *words)
    names, table = b"\0", bytes(16)
    for name, value, size in symbols:
        table += struct.pack("<IIIBBH", len(names), value, size, 0x12, 0, 1)
        names += name.encode() + b"\0"
    section_names = b"\0.text\0.symtab\0.strtab\0.shstrtab\0"
    offset = _HEADER.size + 32
    parts, places = b"", []
    for part in (code, table, names, section_names):
        places.append((offset + len(parts), len(part)))
        parts += part + bytes(-len(part) % 4)
    sections = bytes(40)
    kinds = ((1, 1, 6, START, 0, 0), (7, 2, 0, 0, 3, 16), (15, 3, 0, 0, 0, 0), (23, 3, 0, 0, 0, 0))
    for (at, size), (name_at, kind, flags, address, link, entry) in zip(places, kinds, strict=True):
        sections += struct.pack("<10I", name_at, kind, flags, address, at, size, link, 0, 4, entry)
    ident = b"\x7fELF\1\1\1" + bytes(9)
    header = (ident, 2, 40, 1, START, _HEADER.size, offset + len(parts), 0x0500_0000, _HEADER.size, 32, 1, 40, 5, 4)
    segment = struct.pack("<8I", 1, offset, START, START, len(code), len(code), 5, 4)
    return _HEADER.pack(*header) + segment + parts + sections


def chain(depth: int, calls: int) -> tuple[list[int], list[Symbol]]:
    """Functions f, c1, c2, ... each of which calls the next `calls` times."""
    size = calls + 2
    words: list[int] = []
    symbols: list[Symbol] = []
    for number in range(depth):
        symbols.append((f"c{number}" if number else "f", START + 4 * len(words), 4 * size))
        words.append(PUSH_LR)
        words += [branch(len(words) + k, (number + 1) * size, link=True) for k in range(calls)]
        words.append(POP_PC)
    symbols.append(("last", START + 4 * len(words), 4))
    return [*words, BX_LR], symbols


def nest(depth: int, times: int) -> list[int]:
    """Loops in each other, each running its body `times` times, counters on the stack."""
    words: list[int] = []
    heads = []
    for _ in range(depth):
        words += [0xE3A0_0000 | times, 0xE52D_0004]  # mov r0, #times; push {r0}
        heads.append(len(words))
    words.append(0xE281_1001)  # add r1, r1, #1
    for head in reversed(heads):
        words += [0xE49D_0004, 0xE250_0001, 0x152D_0004]  # pop {r0}; subs r0, r0, #1; pushne {r0}
        words.append(branch(len(words), head, condition=1))
    return [*words, BX_LR]
