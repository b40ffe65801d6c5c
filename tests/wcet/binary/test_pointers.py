"""Functions whose address is taken, by every way in which compilers write it."""

from __future__ import annotations

import struct

import pytest

from mauve.wcet.binary.elf import Binary, Bind, Segment, Symbol
from mauve.wcet.binary.pointers import taken
from tests.wcet.programs import FIXTURES, image

POINTED_AT = {"leaf_add", "leaf_sub", "leaf_mix", "leaf_max"}


@pytest.mark.parametrize("path", sorted(FIXTURES.glob("*-O[0s].elf")), ids=lambda path: path.stem)
def test_functions_in_tables_are_found(path: object) -> None:
    binary = image(path.name)  # type: ignore[attr-defined]
    found = {binary.name_at(key) for key in taken(binary)}
    assert found >= POINTED_AT and len(found) < len(binary.functions) / 4
    assert all(binary.symbol_at(key).key == key for key in taken(binary))  # type: ignore[union-attr]


def _binary(code: bytes, target: int, thumb: bool) -> Binary:
    segments = (Segment(0x8000, len(code), code, False, True), Segment(0x20000, 8, bytes(8), False, True))
    function = Symbol("target", target, 4, Bind.GLOBAL, thumb)
    return Binary("x", "", 0x8000, 0, segments, (function,), (), (), (), _by_address={target: function})


def test_addresses_that_instructions_put_together() -> None:
    """movw r3, #1; nop; movt r3, #2 in T32, and movw r3, #0; movt r4, #2; movt r3, #2 in A32."""
    t32 = struct.pack("<5H", 0xF240, 0x0301, 0xBF00, 0xF2C0, 0x0302)
    assert taken(_binary(t32, 0x20000, True)) == (0x20001,)
    a32 = struct.pack("<3I", 0xE3003000, 0xE3404002, 0xE3403002)
    assert taken(_binary(a32, 0x20000, False)) == (0x20000,)
    other_register = struct.pack("<2I", 0xE3003000, 0xE3404002)
    assert taken(_binary(other_register, 0x20000, False)) == ()


def test_an_address_in_the_wrong_state_is_none() -> None:
    assert taken(_binary(struct.pack("<I", 0x20000), 0x20000, True)) == ()
    assert taken(_binary(struct.pack("<I", 0x20001), 0x20000, True)) == (0x20001,)
