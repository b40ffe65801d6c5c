"""Bytes to instructions. The only place that knows capstone, which is asked for the printed text and for nothing else.

Meaning comes from our own decoders (`a32`, `t16`, `t32`): capstone keeps IT state across calls, and its operands need
as much care as the encodings themselves. Results are cached by word where they do not depend on the address.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from mauve.wcet.binary.a32 import decode_a32
from mauve.wcet.binary.microop import Condition, Instruction, Kind, Traits
from mauve.wcet.binary.semantics import Action, Undecodable, require
from mauve.wcet.binary.t16 import decode_t16
from mauve.wcet.binary.t32 import decode_t32


@dataclass(frozen=True, slots=True)
class DecodeProblem:
    """Bytes at `address` that are no instruction with a known meaning; `message` completes "the word at ADDRESS
    ..."."""

    address: int
    message: str


@dataclass(frozen=True, slots=True)
class Decoded:
    """An instruction, and the IT state that the one behind it stands in (0: none; the encoding of ITSTATE)."""

    instruction: Instruction
    it: int


class _Template(NamedTuple):
    text: str
    condition: Condition
    action: Action


_CONDITIONS = tuple(Condition(value) for value in range(15))


class Decoder:
    """Decodes single instructions out of memory. `read(address, size)` gives bytes, or None where there are none."""

    def __init__(self, read: Callable[[int, int], bytes | None]) -> None:
        self._read = read
        self._cache: dict[tuple[int, int], _Template] = {}
        self._arm: Any = None
        self._thumb: Any = None

    def decode(self, address: int, thumb: bool, it: int = 0) -> Decoded | DecodeProblem:
        """The instruction at `address`; `it` is the state that the one before it left."""
        try:
            if thumb:
                return self._decode_thumb(address, it)
            return Decoded(self._decode_arm(address), 0)
        except Undecodable as reason:
            return DecodeProblem(address, str(reason))

    # ------------------------------------------------------------------------------------------------ A32
    def _decode_arm(self, address: int) -> Instruction:
        require(address & 3 == 0, "is not aligned for an A32 instruction")
        raw = self._bytes(address, 4)
        word = int.from_bytes(raw, "little")
        template = self._cache.get((word, 4))
        if template is None:
            condition, action = decode_a32(word, address)
            template = _Template(self._arm_text(raw, address), condition, action)
            if _independent(word):
                self._cache[word, 4] = template
        return _instruction(address, 4, False, template)

    def _arm_text(self, raw: bytes, address: int) -> str:
        if self._arm is None:
            import capstone

            self._arm = capstone.Cs(capstone.CS_ARCH_ARM, capstone.CS_MODE_ARM)
        for _, _, mnemonic, operands in self._arm.disasm_lite(raw, address, 1):
            return f"{mnemonic} {operands}".rstrip()
        return f".word {int.from_bytes(raw, 'little'):#010x}"

    # ------------------------------------------------------------------------------------------------ Thumb
    def _decode_thumb(self, address: int, it: int) -> Decoded:
        require(address & 1 == 0, "is not aligned for a Thumb instruction")
        raw = self._bytes(address, 2)
        first = int.from_bytes(raw, "little")
        size = 4 if first >> 11 >= 0b11101 else 2
        if size == 4:
            raw = self._bytes(address, 4)
        key = (int.from_bytes(raw, "little"), it << 4 | size)
        if size == 2 and first >> 8 == 0xBF and first & 15:
            require(it == 0, "is an IT instruction inside an IT block")
            return Decoded(_it_instruction(address, first), first & 255)
        template = self._cache.get(key)
        if template is None:
            template = self._thumb_template(raw, first, address, it)
            if _independent_thumb(first, key[0] >> 16, size):
                self._cache[key] = template
        following = 0 if it & 7 == 0 else it & 0xE0 | it << 1 & 0x1F
        writes_pc = template.action.traits.writes_pc
        require(not (writes_pc and following), "leaves an IT block before its end")
        return Decoded(_instruction(address, size, True, template), following)

    def _thumb_template(self, raw: bytes, first: int, address: int, it: int) -> _Template:
        if len(raw) == 2:
            condition, action = decode_t16(first, address, it != 0)
        else:
            condition, action = decode_t32(first, int.from_bytes(raw[2:], "little"), address, it != 0)
        if it:
            condition = _CONDITIONS[it >> 4]
        return _Template(self._thumb_text(raw, address, it), condition or Condition.AL, action)

    def _thumb_text(self, raw: bytes, address: int, it: int) -> str:
        """In an IT block the instruction is printed behind an IT of its own, which leaves no state in capstone."""
        if self._thumb is None:
            import capstone

            self._thumb = capstone.Cs(capstone.CS_ARCH_ARM, capstone.CS_MODE_THUMB)
        prefix = bytes((it & 0xF0 | 8, 0xBF)) if it else b""
        found = list(self._thumb.disasm_lite(prefix + raw, address - len(prefix)))
        if found and found[-1][0] == address:
            return f"{found[-1][2]} {found[-1][3]}".rstrip()
        if it:
            self._thumb = None  # the state of the unused IT must not reach the next instruction
        return f".inst {int.from_bytes(raw, 'little'):#x}"

    def _bytes(self, address: int, size: int) -> bytes:
        raw = self._read(address, size)
        if raw is None or len(raw) < size:
            raise Undecodable("lies outside the code of the binary")
        return raw


def _instruction(address: int, size: int, thumb: bool, template: _Template) -> Instruction:
    action = template.action
    return Instruction(address, size, thumb, template.text, template.condition, action.ops, action.flow, action.traits)


def _it_instruction(address: int, half: int) -> Instruction:
    """it, itt, ite and so on: the mask gives, from the top, whether each further instruction shares the condition's
    low bit."""
    condition, mask = half >> 4 & 15, half & 15
    require(condition != 15 and (condition != 14 or mask.bit_count() == 1), "is an unpredictable IT instruction")
    length = 4 - (mask & -mask).bit_length() + 1
    letters = "".join("t" if mask >> (3 - n) & 1 == condition & 1 else "e" for n in range(length - 1))
    name = _CONDITIONS[condition].name.lower()
    return Instruction(
        address, 2, True, f"it{letters} {name}", Condition.AL, (), Action((), Traits(Kind.IT)).flow, Traits(Kind.IT)
    )


def _independent(word: int) -> bool:
    """Whether an A32 word surely means the same at every address: no branch, no register field that could be the pc."""
    if word >> 25 & 7 == 5 or word >> 28 == 15:
        return False
    return all(word >> shift & 15 != 15 for shift in (0, 8, 12, 16))


def _independent_thumb(first: int, second: int, size: int) -> bool:
    """Whether a Thumb instruction surely means the same at every address."""
    if size == 2:
        top = first >> 11
        if top in (0b01001, 0b10100, 0b11010, 0b11011, 0b11100) or first >> 10 == 0b010001:
            return False
        return first & 0xF500 != 0xB100  # cbz, cbnz
    if first >> 11 == 0b11110 and second & 0x8000:
        return False
    return first & 15 != 15 and first >> 4 != 0xE8D  # tbb and tbh add to the pc
