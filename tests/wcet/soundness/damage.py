"""Executables damaged at random: bytes of the headers, of the code, of the tables changed, the end cut off, symbols
moved, made to overlap, without their sizes, or without those that tell code from data."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from random import Random

_HEADER = struct.Struct("<16sHHIIIIIHHHHHH")
_SECTION = struct.Struct("<10I")
_SYMBOL = struct.Struct("<IIIBBH")
_SYMBOLS = ("unmarked", "sizes", "overlaps", "states")
_TABLE, _FUNCTION = 2, 2


def damaged(image: bytes, random: Random, count: int) -> Iterator[tuple[str, bytes]]:
    """`count` damaged copies of a good image, each with the kind of its damage."""
    regions = dict(_regions(image))
    for _ in range(count):
        kind = random.choice([*regions, "cut", "word", *_SYMBOLS])
        data = bytearray(image)
        match kind:
            case "cut":
                del data[random.randrange(len(data)) :]
            case "word":
                at = random.randrange(len(data) // 4) * 4
                data[at : at + 4] = struct.pack(
                    "<I", random.choice([0, 1, 0x7FFF_FFFF, 0xFFFF_FFFF, random.getrandbits(32)])
                )
            case "unmarked" | "sizes" | "overlaps" | "states":
                change_symbols(data, kind, random)
            case _:
                start, size = regions[kind]
                for _ in range(random.choice([1, 1, 2, 8, 64])):
                    data[start + random.randrange(size)] = random.choice([0, 0xFF, random.getrandbits(8)])
        yield kind, bytes(data)


def _regions(image: bytes) -> Iterator[tuple[str, tuple[int, int]]]:
    """Where the headers and the sections with content stand in the file."""
    fields = _HEADER.unpack_from(image)
    programs, sections, program_size, program_count, size, count = fields[5], fields[6], *fields[9:13]
    yield "header", (0, _HEADER.size)
    yield "program headers", (programs, program_size * program_count)
    yield "section headers", (sections, size * count)
    for index in range(count):
        _, kind, flags, _, offset, length, *_ = _SECTION.unpack_from(image, sections + index * size)
        if kind != 8 and length:
            yield f"section {index} of kind {kind} flags {flags}", (offset, length)


def change_symbols(image: bytearray, kind: str, random: Random) -> None:
    """Change the symbol table: no marks of code and data, no sizes, functions that overlap, or the other state."""
    fields = _HEADER.unpack_from(image)
    sections = [_SECTION.unpack_from(image, fields[6] + number * fields[11]) for number in range(fields[12])]
    table = next(section for section in sections if section[1] == _TABLE)
    names = sections[table[6]][4]
    for at in range(table[4], table[4] + table[5], _SYMBOL.size):
        name, value, size, info, other, section = _SYMBOL.unpack_from(image, at)
        is_function = info & 15 == _FUNCTION
        match kind:
            case "unmarked" if image[names + name : names + name + 1] == b"$":
                name, value, info = 0, 0, 0
            case "sizes" if is_function:
                size = 0
            case "overlaps" if is_function and random.random() < 0.2:
                value, size = value + 2 * random.randrange(-8, 40), random.choice([4, 3 * size, 1 << 20])
            case "states" if is_function and random.random() < 0.2:
                value ^= 1
        _SYMBOL.pack_into(image, at, name, value & 0xFFFF_FFFF, size, info, other, section)
