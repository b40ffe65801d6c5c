"""Thumb `bl` as a jump inside one function, as compilers write it where a function is longer than a branch reaches."""

from __future__ import annotations

from pathlib import Path

import pytest
from wcet.soundness.machine_code import START, executable
from wcet.soundness.replay import Replay, record

from mauve.wcet.binary.cfg import build_cfg
from mauve.wcet.binary.elf import Binary, load_bytes
from mauve.wcet.binary.graph import Cfg, EdgeKind
from mauve.wcet.flow.program import analyse_program
from tests.emulator import Emulator

PUSH_R4_LR, POP_R4_PC, BX_LR, SHIFT, SKIP_BL, COUNT, RESULT, ZERO = (
    0xB510, 0xBD10, 0x4770, 0x0840, 0xD301, 0x3401, 0x0020, 0x2400,
)  # fmt: skip


def bl(at: int, to: int) -> list[int]:
    """The two halves of a bl, both places as indices of half-words."""
    distance = 2 * (to - at) - 4
    return [0xF000 | distance >> 12 & 0x7FF, 0xF800 | distance >> 1 & 0x7FF]


def image(halves: list[int]) -> bytes:
    """An executable with one Thumb function `f`."""
    halves = halves + [0xBF00] * (len(halves) % 2)
    words = [low | high << 16 for low, high in zip(halves[::2], halves[1::2], strict=True)]
    return executable(words, [("f", START | 1, 4 * len(words))])


def bits_set(number: int) -> bytes:
    """f counts the bits set among the lowest `number` of r0: for each a jump far down, and one back."""
    below = 2 + 4 * number + 2
    halves = [PUSH_R4_LR, ZERO]
    for bit in range(number):
        halves += [SHIFT, SKIP_BL, *bl(len(halves) + 2, below + 3 * bit)]
    halves += [RESULT, POP_R4_PC]
    for bit in range(number):
        halves += [COUNT, *bl(len(halves) + 1, 2 + 4 * (bit + 1))]
    return image(halves)


def graph(data: bytes) -> tuple[Binary, Cfg]:
    binary = load_bytes(data, "far.elf")
    assert isinstance(binary, Binary), binary
    return binary, build_cfg(binary, START | 1)


@pytest.mark.parametrize("number", [1, 16])
def test_far_jumps_are_edges_of_one_graph(number: int, tmp_path: Path) -> None:
    """As local subroutines that return for their caller they would be copied into each other without end."""
    path = tmp_path / "far.elf"
    path.write_bytes(bits_set(number))
    binary, cfg = graph(path.read_bytes())
    assert not cfg.unresolved and all(edge.kind is not EdgeKind.CALL for edge in cfg.edges)
    assert len(cfg.blocks) == 3 * number + 1
    program = analyse_program(binary, START | 1)
    replay, emulator = Replay(program, ()), Emulator(path, "cortex-m0")
    for value in (0, 1, 0x5555, 0xFFFF):
        run = record(emulator, "f", [value])
        far = [address for address in run.addresses if address > START + 2 * (2 + 4 * number + 1)]
        assert len(far) == 2 * (value & (1 << number) - 1).bit_count()
        replay.walk(run)
    assert not replay.wrong


def test_a_local_subroutine_stays_a_call() -> None:
    """Control comes back behind a bl where the code it goes to reads lr."""
    halves = [PUSH_R4_LR, ZERO, *bl(2, 6), RESULT, POP_R4_PC, COUNT, BX_LR]
    binary, cfg = graph(image(halves))
    (call,) = [edge for edge in cfg.edges if edge.kind is EdgeKind.CALL]
    assert call.callees == (START + 12 | 1,) and cfg.blocks[call.target].address == START + 8
    assert not analyse_program(binary, START | 1).problems


def test_a_loop_closed_by_a_far_jump_is_a_loop(tmp_path: Path) -> None:
    """Taken for a subroutine that the table of the library may know, its parts were looked for without end."""
    subtract, leave = 0x3801, 0xD001  # subs r0, #1; beq behind the bl
    path = tmp_path / "far.elf"
    path.write_bytes(image([PUSH_R4_LR, ZERO, COUNT, subtract, leave, *bl(5, 2), RESULT, POP_R4_PC]))
    binary, cfg = graph(path.read_bytes())
    program = analyse_program(binary, START | 1)
    ((_, flow),) = program.functions.items()
    assert len(flow.nest.loops) == 1 and not cfg.unresolved
    replay, emulator = Replay(program, ()), Emulator(path, "cortex-m0")
    run = record(emulator, "f", [7])
    assert run.addresses.count(START + 4) == 7
    replay.walk(run)
    assert not replay.wrong
