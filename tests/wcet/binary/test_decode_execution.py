"""The decoder's promise: what its micro-operations say an instruction does is what a core does.

Random words of every class run once in an emulator and once as micro-operations, from the same random state. Registers,
flags, memory and the next program counter must agree wherever the micro-operations claim to know.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest
from wcet.microop_machine import State, execute

from mauve.wcet.binary.decode import Decoded, DecodeProblem, Decoder
from mauve.wcet.binary.microop import Condition, IndirectJump, Kind, Next, Stop, SupervisorCall

CODE, CODE_SIZE = 0x0100_0000, 0x4_0000
DATA, DATA_SIZE = 0x2000_0000, 0x4000
SLOT = 16

# Fixed bits as (value, mask); the other bits are random. Each line is a class of its own.
A32 = {
    "any": (0x00000000, 0x00000000),
    "data processing, shifted by constant": (0x00000000, 0x0E000010),
    "data processing, shifted by register": (0x00000010, 0x0E000090),
    "data processing, immediate": (0x02000000, 0x0E000000),
    "moves": (0x01A00000, 0x0FAF0010),
    "moves shifted by register": (0x01A00010, 0x0FAF0090),
    "multiply": (0x00000090, 0x0FE0F0F0),
    "multiply accumulate": (0x00200090, 0x0FA000F0),
    "long multiply": (0x00800090, 0x0F8000F0),
    "half multiply": (0x01000080, 0x0F900090),
    "swap": (0x01000090, 0x0FB00FF0),
    "exclusive": (0x01900F9F, 0x0F900FFF),
    "saturating": (0x01000050, 0x0F900FF0),
    "clz": (0x016F0F10, 0x0FFF0FF0),
    "status": (0x0128F000, 0x0FBFFFF0),
    "status read": (0x010F0000, 0x0FFF0FFF),
    "branch exchange": (0x012FFF10, 0x0FFFFFD0),
    "word, immediate": (0x04000000, 0x0E000000),
    "word, register": (0x06000000, 0x0E000010),
    "half, immediate": (0x00400090, 0x0E400090),
    "half, register": (0x00000090, 0x0E400F90),
    "multiple": (0x08000000, 0x0E400000),
    "branch": (0x0A000000, 0x0E000000),
    "wide move": (0x03000000, 0x0FB00000),
    "extend": (0x06800070, 0x0F8003F0),
    "pack": (0x06800010, 0x0FF00030),
    "reverse": (0x06BF0F30, 0x0FBF0F70),
    "bit field": (0x07A00010, 0x0FA00070),
    "bit insert": (0x07C00010, 0x0FE00070),
    "divide": (0x0710F010, 0x0FD0F0F0),
    "most significant": (0x0750F010, 0x0FF0F0D0),
    "parallel": (0x06000F10, 0x0F800F10),
    "coprocessor fpu": (0x0C000A00, 0x0C000E00),
}
T16 = {
    "any": (0x0000, 0x0000),
    "shift, add, subtract": (0x0000, 0xC000),
    "immediate": (0x2000, 0xE000),
    "two registers": (0x4000, 0xFC00),
    "high registers": (0x4400, 0xFC00),
    "literal": (0x4800, 0xF800),
    "loads and stores": (0x5000, 0xF000),
    "offsets": (0x6000, 0xE000),
    "half and stack": (0x8000, 0xE000),
    "address, miscellaneous": (0xA000, 0xE000),
    "compare and branch": (0xB100, 0xF500),
    "multiple": (0xC000, 0xF000),
    "branch": (0xD000, 0xF000),
    "long branch": (0xE000, 0xF800),
}
T32 = {
    "multiple": (0xE8000000, 0xFE402000),
    "double": (0xE8400000, 0xFE400000),
    "table": (0xE8D0F000, 0xFFF0FFE0),
    "shifted register": (0xEA000000, 0xFE008000),
    "moves": (0xEA4F0000, 0xFFEF8000),
    "modified immediate": (0xF0000000, 0xFA008000),
    "plain immediate": (0xF2000000, 0xFA008000),
    "branch": (0xF0008000, 0xF8008000),
    "single": (0xF8000000, 0xFE000000),
    "single, register": (0xF8000000, 0xFE000FC0),
    "single, writeback": (0xF8000800, 0xFE000800),
    "register": (0xFA00F000, 0xFF00F000),
    "register extend": (0xFA00F080, 0xFF80F0C0),
    "register miscellaneous": (0xFA80F080, 0xFFC0F0C0),
    "multiply": (0xFB000000, 0xFF8000C0),
    "long multiply": (0xFB800000, 0xFF800000),
    "coprocessor fpu": (0xEC000A00, 0xFC000E00),
}


# Privileged or system-dependent: a core may refuse them, and what they do is declared unknown anyway.
_NOT_COMPARED = (Kind.IT, Kind.WAIT, Kind.MSR, Kind.CPS, Kind.COPROCESSOR, Kind.COPROCESSOR_READ)


def _words(classes: dict[str, tuple[int, int]], bits: int, each: int, chance: random.Random) -> Iterator[int]:
    for value, mask in classes.values():
        for _ in range(each):
            yield value | chance.getrandbits(bits) & ~mask


class Rig:
    """An emulated core with code, data and random contents."""

    def __init__(self, thumb: bool, code: bytes, chance: random.Random) -> None:
        import unicorn
        from unicorn import arm_const as arm

        self.unicorn, self.arm, self.thumb = unicorn, arm, thumb
        mode = unicorn.UC_MODE_THUMB if thumb else unicorn.UC_MODE_ARM
        self.core = unicorn.Uc(unicorn.UC_ARCH_ARM, mode, arm.UC_CPU_ARM_CORTEX_A15)
        self.core.mem_map(CODE, CODE_SIZE)
        self.core.mem_map(DATA, DATA_SIZE)
        self.core.mem_write(CODE, code)
        self.code = code.ljust(CODE_SIZE, b"\0")
        self.data = chance.randbytes(DATA_SIZE)
        self.core.reg_write(arm.UC_ARM_REG_FPEXC, 1 << 30)
        self.numbers = [arm.UC_ARM_REG_R0 + n for n in range(13)] + [arm.UC_ARM_REG_SP, arm.UC_ARM_REG_LR]

    def read(self, at: int) -> int:
        if CODE <= at < CODE + CODE_SIZE:
            return self.code[at - CODE]
        return self.data[(at - DATA) % DATA_SIZE]

    def run(self, at: int, end: int, registers: list[int], flags: list[int], it: int) -> tuple[int, bool, bool]:
        """One step from a state (none, when an IT condition fails: then `end` stops it); the next pc, whether
        it is in Thumb state, and whether the core refused."""
        self.core.mem_write(DATA, self.data)
        word = sum(flag << bit for flag, bit in zip(flags, (31, 30, 29, 28), strict=True)) | 0x13
        if self.thumb:
            word |= 0x20 | (it & 3) << 25 | (it >> 2) << 10
        self.core.reg_write(self.arm.UC_ARM_REG_CPSR, word)
        for number, value in zip(self.numbers, registers, strict=True):
            self.core.reg_write(number, value)
        failed = False
        try:
            self.core.emu_start(at | self.thumb, end, count=1)
        except self.unicorn.UcError as error:
            failed = error.errno not in (self.unicorn.UC_ERR_FETCH_UNMAPPED, self.unicorn.UC_ERR_FETCH_PROT)
        status = self.core.reg_read(self.arm.UC_ARM_REG_CPSR)
        return self.core.reg_read(self.arm.UC_ARM_REG_PC), bool(status & 0x20), failed


def _registers(chance: random.Random) -> list[int]:
    pointers = [DATA + 0x800 + 4 * chance.randrange(0xC00) for _ in range(15)]
    kinds = (
        lambda n: pointers[n],
        lambda n: pointers[n] + chance.randrange(4),
        lambda n: chance.getrandbits(32),
        lambda n: chance.choice((0, 1, 2, 31, 32, 33, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 255, 0xFFFF8000)),
        lambda n: chance.randrange(64),
        lambda n: chance.randrange(64) * 4,
    )
    return [chance.choices(kinds, (6, 1, 3, 2, 2, 2))[0](n) for n in range(13)] + pointers[13:]


def _compare(rig: Rig, decoded: Decoded, at: int, it: int, chance: random.Random) -> bool:
    """Whether the instruction could be compared; asserts that it agrees."""
    instruction = decoded.instruction
    registers, flags = _registers(chance), [chance.randrange(2) for _ in range(4)]
    state = State(list(registers), list(flags), rig.read)
    execute(instruction, state)
    if isinstance(instruction.flow, Stop | SupervisorCall) or instruction.traits.kind in _NOT_COMPARED:
        return False
    if it and not isinstance(instruction.flow, Next):
        return False  # the emulator does not stop behind a branch at the end of an IT block
    wide = 8 if instruction.traits.kind is Kind.EXCLUSIVE else 1
    for address, size in state.accesses:
        inside = DATA <= address <= DATA + DATA_SIZE - size or CODE <= address <= CODE + CODE_SIZE - size
        if state.wild or not inside or address % max(size, wide) or (address < DATA and state.memory):
            return False
    pc, thumb, failed = rig.run(at, instruction.end, registers, flags, it)
    shown = f"{instruction} ({instruction.ops}, {instruction.flow}) from {[hex(r) for r in registers]} {flags}"
    if failed and instruction.traits.kind.name.startswith("FPU"):
        return False  # not every FPU has every operation; none of them touches the core's registers
    assert not failed, f"the core refuses {shown}"
    for number in range(15):
        claimed = state.registers[number]
        found = rig.core.reg_read(rig.numbers[number])
        assert claimed is None or claimed == found, f"r{number} is {found:#x}, not {claimed:#x}: {shown}"
    status = rig.core.reg_read(rig.arm.UC_ARM_REG_CPSR)
    for name, bit, claimed in zip("NZCV", (31, 30, 29, 28), state.flags, strict=True):
        assert claimed is None or claimed == status >> bit & 1, f"{name} is {status >> bit & 1}: {shown}"
    memory = bytearray(rig.data)
    for address, byte in state.memory.items():
        memory[address - DATA] = rig.core.mem_read(address, 1)[0] if byte is None else byte
    assert rig.core.mem_read(DATA, DATA_SIZE) == memory, f"memory differs: {shown}"
    stays = isinstance(instruction.flow, IndirectJump) and not instruction.flow.exchanges and not rig.thumb
    if state.pc is not None and not (stays and state.pc & 3):
        if state.thumb is False and state.pc & 2:
            return True
        assert (pc, thumb) == (state.pc, state.thumb), f"goes to {pc:#x}, not {state.pc:#x}: {shown}"
    return True


def _campaign(rig: Rig, decoder: Decoder, states: list[int], chance: random.Random) -> int:
    compared = 0
    for slot, it in enumerate(states):
        at = CODE + slot * SLOT
        decoded = decoder.decode(at, rig.thumb, it)
        if not isinstance(decoded, DecodeProblem):
            compared += sum(_compare(rig, decoded, at, it, chance) for _ in range(3))
    return compared


@pytest.mark.parametrize("seed", range(2))
def test_a32_executes_as_decoded(seed: int) -> None:
    chance = random.Random(seed)
    words = list(_words(A32, 32, 45, chance))
    words = [w | 0xE0000000 if chance.random() < 0.7 else w & 0x0FFFFFFF | chance.randrange(16) << 28 for w in words]
    code = b"".join(w.to_bytes(4, "little").ljust(SLOT, b"\0") for w in words)
    rig = Rig(False, code, chance)
    decoder = Decoder(lambda at, size: rig.code[at - CODE : at - CODE + size])
    assert _campaign(rig, decoder, [0] * len(words), chance) > len(words)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("in_it", (False, True))
@pytest.mark.parametrize("size", (2, 4))
def test_thumb_executes_as_decoded(size: int, in_it: bool, seed: int) -> None:
    chance = random.Random(seed)
    if size == 2:
        words = [w.to_bytes(2, "little") for w in _words(T16, 16, 75, chance) if w >> 11 < 0b11101]
    else:
        halves = _words(T32, 32, 75, chance)
        words = [(w >> 16).to_bytes(2, "little") + (w & 0xFFFF).to_bytes(2, "little") for w in halves]
    states = [chance.randrange(14) << 4 | 8 if in_it else 0 for _ in words]
    rig = Rig(True, b"".join(word.ljust(SLOT, b"\0") for word in words), chance)
    decoder = Decoder(lambda at, n: rig.code[at - CODE : at - CODE + n])
    assert _campaign(rig, decoder, states, chance) > len(words) // 2


def test_conditions_are_those_of_the_encoding() -> None:
    decoder = Decoder(lambda at, size: (0x00A00001 | at << 28).to_bytes(4, "little"))
    found = [decoder.decode(0, False)]
    assert isinstance(found[0], Decoded) and found[0].instruction.condition is Condition.EQ
