"""The FPU and the DSP extension in runs: what a compiled block leaves in registers, flags and memory is what an
emulated Cortex-M4F leaves there, or unknown."""

from __future__ import annotations

import random
import struct
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mauve.wcet.binary.decode import Decoded, Decoder
from mauve.wcet.binary.graph import EXIT, Block, Cfg, Edge, EdgeKind
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.flow.order import arrange
from mauve.wcet.flow.run.compile import ASKED, ASSUMED, Run, Sites, compile_function
from mauve.wcet.flow.run.float_text import FLOAT, FLOAT_FLAGS, FLOAT_MODE, SLOTS
from mauve.wcet.flow.run.media import Partial, media_select, partial
from mauve.wcet.flow.run.words import MASK, UNKNOWN, Undecided

CODE, DATA, DATA_SIZE = 0x1000, 0x2000_0000, 0x900
N_FLAGS = slice(16, 20)

# Fixed bits of T32 words as (value, mask); the other bits are random. "sure" forms must have known results.
ARITHMETIC = {
    "vmla, vmls": (0xEE00_0A00, 0xFFB0_0F10),
    "vnmla, vnmls": (0xEE10_0A00, 0xFFB0_0F10),
    "vmul, vnmul": (0xEE20_0A00, 0xFFB0_0F10),
    "vadd, vsub": (0xEE30_0A00, 0xFFB0_0F10),
    "vdiv": (0xEE80_0A00, 0xFFB0_0F50),
    "vfnma, vfnms": (0xEE90_0A00, 0xFFB0_0F10),
    "vfma, vfms": (0xEEA0_0A00, 0xFFB0_0F10),
    "vmov constant": (0xEEB0_0A00, 0xFFB0_0FF0),
    "vmov, vabs": (0xEEB0_0A40, 0xFFBF_0F50),
    "vneg": (0xEEB1_0A40, 0xFFBF_0FD0),
    "vsqrt": (0xEEB1_0AC0, 0xFFBF_0FD0),
    "vcmp, vcmpe": (0xEEB4_0A40, 0xFFBF_0F50),
    "vcmp, vcmpe with 0": (0xEEB5_0A40, 0xFFBF_0F7F),
    "vcvt from integer": (0xEEB8_0A40, 0xFFBF_0F50),
    "vcvt, vcvtr to integer": (0xEEBC_0A40, 0xFFBE_0F50),
    "vcvt from fixed point": (0xEEBA_0A40, 0xFFBE_0F50),
    "vcvt to fixed point": (0xEEBE_0A40, 0xFFBE_0F50),
    "vcvtb, vcvtt": (0xEEB2_0A40, 0xFFBE_0F50),
}
MOVES = {
    "vmov from and to core": (0xEE00_0A10, 0xFFE0_0F7F),
    "vmov of two": (0xEC40_0A10, 0xFFE0_0FD0),
    "vmov of a pair": (0xEC40_0B10, 0xFFE0_0FF0),
    "vmrs, vmsr": (0xEEE1_0A10, 0xFFEF_0FFF),
    "vldr, vstr of s": (0xED00_0A00, 0xFF20_0F00),
    "vldr, vstr of d": (0xED00_0B00, 0xFF60_0F00),
    "vldm, vstm of s": (0xEC80_0A00, 0xFF80_0FF0),
    "vldmdb, vstmdb of s": (0xED20_0A00, 0xFFA0_0FF0),
    "vldm, vstm of d": (0xEC80_0B00, 0xFFC0_0FF1),
}
PARALLEL = (0xFA80_F000, 0xFF80_F080)
COMPARING = (0xFA80_F000, 0xFF80_F0B0)
SELECT = (0xFAA0_F080, 0xFFF0_F0F0)
SATURATE = (0xF300_0000, 0xFF50_8020)
SPECIAL = (
    *(0, 1, 2, 3, 0x007F_FFFF, 0x0080_0000, 0x0080_0001, 0x00FF_FFFF, 0x0100_0000, 0x3F80_0000, 0x3F80_0001),
    *(0x3F7F_FFFF, 0x3F00_0000, 0x3FC0_0000, 0x4020_0000, 0x4B00_0000, 0x4B00_0001, 0x4B7F_FFFF, 0x4AFF_FFFF),
    *(0x4EFF_FFFF, 0x4F00_0000, 0x4F7F_FFFF, 0x4F80_0000, 0x5F00_0000, 0x7F7F_FFFF, 0x7F00_0000, 0x7F80_0000),
    *(0x7FC0_0000, 0x7F80_0001, 0x3380_0000, 0x3380_0001, 0x3400_0000, 0x4700_0000, 0x46FF_FE00, 0x7FFF, 0x8000),
)


def words_of(forms: dict[str, tuple[int, int]], each: int, chance: random.Random) -> Iterator[int]:
    for value, mask in forms.values():
        for _ in range(each):
            yield value | chance.getrandbits(32) & ~mask


def operand(chance: random.Random) -> int:
    kind = chance.randrange(5)
    if kind < 2:
        return chance.choice(SPECIAL) | chance.randrange(2) << 31
    if kind == 2:
        return chance.getrandbits(32)
    exponent = chance.choice((0, 1, 2, 20, 60, 64, 104, 126, 127, 128, 129, 150, 158, 200, 254)) + chance.randrange(2)
    mantissa = chance.getrandbits(23) & chance.choice((0x7F_FFFF, 0x7F_F000, 0x7C_0000, 0x40_0001))
    return chance.randrange(2) << 31 | min(exponent, 254) << 23 | mantissa


class Words:
    """Memory of a block: words by address."""

    def __init__(self) -> None:
        self.content: dict[int, Any] = {}
        self.load_byte = self.load_half = self.load_signed_byte = self.load_signed_half = None
        self.store_byte = self.store_half = None

    def site(self) -> int:
        return 0

    def load(self, address: int, _site: int) -> Any:
        return self.content.get(address, UNKNOWN)

    def store(self, address: int, value: Any, _site: int) -> None:
        self.content[address] = value


class Rig:
    """An emulated Cortex-M4F, and the same instructions as compiled blocks."""

    def __init__(self) -> None:
        import unicorn
        from unicorn import arm_const as arm

        mode = unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS
        self.core: Any = unicorn.Uc(unicorn.UC_ARCH_ARM, mode, arm.UC_CPU_ARM_CORTEX_M4)
        self.core.mem_map(CODE, 0x1000)
        self.core.mem_map(DATA, 0x1000)
        self.floats = [arm.UC_ARM_REG_S0 + n for n in range(32)]
        self.numbers = [arm.UC_ARM_REG_R0 + n for n in range(13)] + [arm.UC_ARM_REG_SP, arm.UC_ARM_REG_LR]
        self.status, self.fpscr, self.refused = arm.UC_ARM_REG_CPSR, arm.UC_ARM_REG_FPSCR, unicorn.UcError
        self.memory = Words()
        self.core.mem_write(CODE, b"\xb0\xee\x40\x0a")  # the first use of the FPU sets FPSCR: vmov s0, s0
        self.core.emu_start(CODE | 1, CODE + 4)

    def block(self, *words: int) -> tuple[Run, int] | None:
        """A block of instructions as a function, and its end; None where one is not decoded."""
        code = b"".join(struct.pack("<HH", word >> 16, word & 0xFFFF) for word in words)
        decoder = Decoder(lambda at, size: code[at - CODE : at - CODE + size])
        found = [decoder.decode(CODE + 4 * n, True) for n in range(len(words))]
        if not all(isinstance(one, Decoded) for one in found):
            return None
        instructions = tuple(one.instruction for one in found if isinstance(one, Decoded))
        block = Block(0, instructions)
        cfg = Cfg("f", CODE, True, 0, (block,), (Edge(0, EXIT, EdgeKind.RETURN),))
        sites = Sites(self.memory)  # type: ignore[arg-type]
        self.core.ctl_flush_tb()
        self.core.mem_write(CODE, code)
        return compile_function(arrange(cfg, LoopNest(())), sites).blocks[0], CODE + len(code)

    def compare(self, run: Run, end: int, floats: list[int], core: list[int], flags: list[int]) -> list[Any] | None:
        """The registers that the block leaves, none of which an execution contradicts; None if the core refuses."""
        data = struct.pack(f"<{DATA_SIZE // 4}I", *(floats * 18))
        self.core.mem_write(DATA, data)
        self.core.reg_write_batch([*zip(self.floats, floats, strict=True), *zip(self.numbers, core, strict=True)])
        top = sum(flag << 31 - n for n, flag in enumerate(flags))
        self.core.reg_write(self.status, top)
        self.core.reg_write(self.fpscr, top ^ 0xF000_0000)
        try:
            self.core.emu_start(CODE | 1, end)
        except self.refused:
            return None
        registers: list[Any] = [UNKNOWN] * SLOTS
        registers[ASKED] = registers[ASSUMED] = None
        registers[:15], registers[N_FLAGS], registers[FLOAT:] = core, flags, floats
        registers[FLOAT_FLAGS:FLOAT_MODE], registers[FLOAT_MODE] = [1 - flag for flag in flags], 0
        self.memory.content = {DATA + 4 * n: floats[n % 32] for n in range(DATA_SIZE // 4)}
        run(registers)
        status, fpscr = self.core.reg_read(self.status), self.core.reg_read(self.fpscr)
        seen = list(self.core.reg_read_batch(self.numbers))
        seen += [status >> 31 - n & 1 for n in range(4)] + [fpscr >> 31 - n & 1 for n in range(4)]
        seen += self.core.reg_read_batch(self.floats)
        claimed = registers[:15] + registers[N_FLAGS] + registers[FLOAT_FLAGS:FLOAT_MODE] + registers[FLOAT:]
        for place, (left, right) in enumerate(zip(claimed, seen, strict=True)):
            assert type(left) is not int or left == right, (place, hex(left), hex(right))
        after = struct.unpack(f"<{DATA_SIZE // 4}I", self.core.mem_read(DATA, DATA_SIZE))
        for number, found in enumerate(after):
            word = self.memory.content[DATA + 4 * number]
            assert type(word) is not int or word == found
        return claimed


@pytest.mark.parametrize("name", [*ARITHMETIC, *MOVES])
def test_an_instruction_leaves_what_a_core_leaves(name: str) -> None:
    chance = random.Random(name)
    rig = Rig()
    known = executed = 0
    for word in words_of({name: (ARITHMETIC | MOVES)[name]}, 5, chance):
        made = rig.block(word)
        if made is None:
            continue
        for _ in range(16):
            core = [DATA + 0x400 + 4 * chance.randrange(0x20) for _ in range(15)]
            if "vmsr" in name:
                core = [chance.choice((0, 0xF000_0000, 0x0040_0000, 0x0100_0000, 0x8000_0000, 0x4000_009F))] * 15
            left = rig.compare(*made, [operand(chance) for _ in range(32)], core, [chance.randrange(2) for _ in "NZCV"])
            if left is not None:
                executed += 1
                known += all(type(word) is int for word in left)
    assert executed > 20
    if name not in ("vcvtb, vcvtt", "vmrs, vmsr"):  # fixed point of 16 bits can have a fraction that is undefined
        assert known == executed or ("fixed" in name and known > executed // 3)


def test_parts_of_words_are_added_selected_and_saturated_as_a_core_does() -> None:
    """Pairs of a parallel addition and a `sel` of what it left in GE; ssat and usat."""
    chance = random.Random(3)
    rig = Rig()
    edges = (0, 1, 0x7F, 0x80, 0x8000, 0x7FFF, 0xFFFF, 0x80FF_7F01, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF, 0x0100_FF00)
    executed = known = 0
    for first, second in zip(
        words_of({"any": PARALLEL, "comparing": COMPARING, "saturate": SATURATE}, 80, chance),
        words_of({"sel": SELECT}, 240, chance),
        strict=True,
    ):
        made = rig.block(first, second)
        if made is None:
            continue
        for _ in range(6):
            core = [chance.choice((chance.choice(edges), chance.getrandbits(32))) for _ in range(15)]
            left = rig.compare(*made, [0] * 32, core, [0, 1, 0, 1])
            if left is not None:
                executed += 1
                known += all(type(word) is int for word in left)
    assert executed > 300 and known > 150


masks = st.sampled_from([0, 0xFF, 0xFFFF_0000, 0xFF00_FFFF, 0xF0, MASK])


@given(st.tuples(masks, masks), *[st.integers(0, MASK)] * 2, st.integers(0, 15), st.booleans(), st.integers(0, MASK))
def test_what_is_known_of_a_selection_is_so(
    known: tuple[int, int], a: int, b: int, greater: int, sure: bool, other: int
) -> None:
    """Whatever the bits are that are not known."""
    found = media_select(greater if sure else UNKNOWN, partial(known[0], a), partial(known[1], b))
    exact = media_select(greater, a, b)
    assert type(exact) is int
    if type(found) is int:
        assert found == exact
    elif isinstance(found, Partial):
        assert (exact ^ found.bits) & found.known == 0
        assert type(masked := found & other) is not int or masked == exact & other
        for number in (other, exact, 0):
            try:
                assert (found == number) == (exact == number)
            except Undecided:
                assert (number ^ found.bits) & found.known == 0
