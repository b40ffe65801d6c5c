"""Executables damaged at random: bytes of the headers, of the code, of the tables changed, the end cut off."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from random import Random

_HEADER = struct.Struct("<16sHHIIIIIHHHHHH")
_SECTION = struct.Struct("<10I")


def damaged(image: bytes, random: Random, count: int) -> Iterator[tuple[str, bytes]]:
    """`count` damaged copies of a good image, each with the kind of its damage."""
    regions = dict(_regions(image))
    for _ in range(count):
        kind = random.choice([*regions, "cut", "word"])
        data = bytearray(image)
        match kind:
            case "cut":
                del data[random.randrange(len(data)) :]
            case "word":
                at = random.randrange(len(data) // 4) * 4
                data[at : at + 4] = struct.pack(
                    "<I", random.choice([0, 1, 0x7FFF_FFFF, 0xFFFF_FFFF, random.getrandbits(32)])
                )
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
