"""Runs single functions of an ARM ELF in unicorn and counts the instructions that were executed.

The oracle of the soundness tests: what was executed must lie inside the CFG, and no count may exceed its bound.
Counts are exact per instruction. An instruction whose condition fails counts as executed: it is fetched and issued.
The emulator knows nothing of time.

    emulator = Emulator("arm7tdmi-arm-O2.elf", "arm7tdmi")
    table = emulator.alloc(struct.pack("<100i", *range(100)))
    run = emulator.call("sum", [table])
    assert run.r0 == 4950 and run.counts[header] == 101
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_STACK, _STACK_SIZE = 0x6000_0000, 0x1_0000
_HEAP, _HEAP_SIZE = 0x5000_0000, 0x4_0000
_RETURN = 0x7000_0000
_PAGE = 0x1000


class EmulationError(Exception):
    """The function did not run to its return: an invalid access, an undefined instruction, or too many instructions."""


@dataclass(frozen=True, slots=True)
class Int64:
    """A 64-bit integer argument: two words in an even-aligned register pair or stack slot (AAPCS 6.5)."""

    value: int


@dataclass(frozen=True, slots=True)
class Symbol:
    """A symbol of the image: `address` without the Thumb bit, `size` in bytes as the symbol table states it."""

    name: str
    address: int
    size: int
    thumb: bool
    is_function: bool


@dataclass(frozen=True, slots=True)
class Execution:
    """What one call did. `counts` maps instruction addresses (without Thumb bit) to executions."""

    r0: int
    r1: int
    counts: dict[int, int]
    instructions: int
    blocks: tuple[tuple[int, int], ...]
    """(address, bytes) of the straight runs in order of execution; empty unless asked for. They need not be the blocks
    of a CFG: a run may begin inside one or span several that fall through."""
    stack_bytes: int
    """Greatest depth that was written below the stack pointer at entry, in bytes; 0 unless the trace is asked for. On
    cores with Thumb code only: at which another content was left."""

    @property
    def signed(self) -> int:
        """r0 as int32_t."""
        return self.r0 - ((self.r0 & 0x8000_0000) << 1)

    @property
    def uint64(self) -> int:
        """r1:r0 as uint64_t."""
        return self.r1 << 32 | self.r0

    @property
    def int64(self) -> int:
        """r1:r0 as int64_t."""
        return self.uint64 - ((self.uint64 & 1 << 63) << 1)

    @property
    def float32(self) -> float:
        """r0 as a soft-float single."""
        (value,) = struct.unpack("<f", struct.pack("<I", self.r0))
        return float(value)

    @property
    def float64(self) -> float:
        """r1:r0 as a soft-float double."""
        (value,) = struct.unpack("<d", struct.pack("<Q", self.uint64))
        return float(value)


def f32(value: float) -> int:
    """The word that passes `value` as a soft-float single."""
    (word,) = struct.unpack("<I", struct.pack("<f", value))
    return int(word)


Argument = int | float | Int64
"""An int is one word, a Python float a double, Int64 a pair of words; a single is written f32(x)."""


class Emulator:
    """One image loaded into one emulated core. Memory persists between calls until `reset`."""

    def __init__(self, elf: str | Path, cpu: str) -> None:
        """`cpu`: a core name as boards use it (arm7tdmi, arm920t, arm926ej-s, cortex-m0, cortex-m3, ...)."""
        from unicorn import UC_ARCH_ARM, UC_MODE_ARM, UC_MODE_MCLASS, UC_MODE_THUMB, Uc

        self.symbols, self._segments = _load(Path(elf))
        self.by_name = {symbol.name: symbol for symbol in self.symbols}
        self._thumb_only = cpu.startswith("cortex-m")
        mode = UC_MODE_THUMB | UC_MODE_MCLASS if self._thumb_only else UC_MODE_ARM
        self._uc: Any = Uc(UC_ARCH_ARM, mode, _model(cpu))
        self._lengths: dict[tuple[int, int], tuple[int, ...]] = {}
        pages = {page for at, data, size in self._segments for page in range(at & -_PAGE, at + size, _PAGE)}
        for page in sorted(pages):
            self._uc.mem_map(page, _PAGE)
        self._uc.mem_map(_STACK, _STACK_SIZE)
        self._uc.mem_map(_HEAP, _HEAP_SIZE)
        self._uc.mem_map(_RETURN, _PAGE)
        self.reset()

    def reset(self) -> None:
        """Bring memory back to the linked image: data as linked, bss, heap and stack zero, nothing allocated."""
        for at, data, size in self._segments:
            self._uc.mem_write(at, data + bytes(size - len(data)))
        self._uc.mem_write(_STACK, bytes(_STACK_SIZE))
        self._uc.mem_write(_HEAP, bytes(_HEAP_SIZE))
        self._free = _HEAP

    def address(self, function: str | int) -> int:
        """Call address of a symbol (with the Thumb bit where it applies), or the number itself."""
        if isinstance(function, int):
            return function
        symbol = self.by_name[function]
        return symbol.address | int(symbol.thumb)

    def alloc(self, content: bytes | int) -> int:
        """Address of a fresh 8-aligned object holding `content` (or that many zero bytes)."""
        data = bytes(content) if isinstance(content, int) else content
        address, self._free = self._free, (self._free + len(data) + 15) & -8
        if self._free > _HEAP + _HEAP_SIZE:
            raise EmulationError("the test's heap is full; call reset()")
        self._uc.mem_write(address, data)
        return address

    def read(self, address: int, size: int) -> bytes:
        """`size` bytes of memory."""
        return bytes(self._uc.mem_read(address, size))

    def write(self, address: int, data: bytes) -> None:
        """Write bytes to memory."""
        self._uc.mem_write(address, data)

    def unpack(self, address: int, layout: str) -> tuple[Any, ...]:
        """Memory read through a `struct` layout, e.g. "<3dI"."""
        return struct.unpack(layout, self.read(address, struct.calcsize(layout)))

    def call(
        self,
        function: str | int,
        args: Sequence[Argument] = (),
        max_instructions: int = 20_000_000,
        trace: bool = False,
    ) -> Execution:
        """Run `function` to its return and report the counts. Raises EmulationError when it does not return."""
        from unicorn import UC_HOOK_BLOCK, UC_HOOK_MEM_WRITE, UcError
        from unicorn import arm_const as arm

        start = self.address(function)
        top = self._pass(args)
        self._uc.reg_write(arm.UC_ARM_REG_LR, _RETURN | (start & 1))
        counts: dict[tuple[int, int], int] = {}
        order: list[tuple[int, int]] = []
        budget = [4 * max_instructions]
        lowest = [top]

        def on_block(uc: Any, address: int, size: int, _: object) -> None:
            if address == _RETURN:
                return
            key = (address, size)
            if key in counts:
                counts[key] += 1
            else:
                counts[key] = 1
                self._split(key)
            if trace:
                order.append(key)
            budget[0] -= size
            if budget[0] < 0:
                uc.emu_stop()

        def on_write(_uc: Any, _access: int, address: int, _size: int, _value: int, _: object) -> None:
            if _STACK <= address < lowest[0]:
                lowest[0] = address

        hooks = [self._uc.hook_add(UC_HOOK_BLOCK, on_block)]
        if trace and not self._thumb_only:  # with a hook on memory the emulator skips instructions after IT blocks
            hooks.append(self._uc.hook_add(UC_HOOK_MEM_WRITE, on_write))
        before = self.read(_STACK, top - _STACK)
        try:
            self._uc.emu_start(start, _RETURN)
        except UcError as error:
            raise EmulationError(f"{function}: {error} at {self._uc.reg_read(arm.UC_ARM_REG_PC):#x}") from error
        finally:
            for hook in hooks:
                self._uc.hook_del(hook)
        if self._uc.reg_read(arm.UC_ARM_REG_PC) != _RETURN:
            raise EmulationError(f"{function}: no return within {max_instructions} instructions")
        if trace and self._thumb_only:
            after = self.read(_STACK, top - _STACK)
            changed = (at for at, (old, new) in enumerate(zip(before, after, strict=True), _STACK) if old != new)
            lowest[0] = next(changed, top)
        executed: dict[int, int] = {}
        for block, times in counts.items():
            for address in self._lengths[block]:
                executed[address] = executed.get(address, 0) + times
        r0, r1 = self._uc.reg_read(arm.UC_ARM_REG_R0), self._uc.reg_read(arm.UC_ARM_REG_R1)
        return Execution(r0, r1, executed, sum(executed.values()), tuple(order), top - lowest[0])

    def _pass(self, args: Sequence[Argument]) -> int:
        """Place arguments as AAPCS (soft float) does; the stack pointer at entry."""
        from unicorn import arm_const as arm

        words: list[int] = []
        for argument in args:
            match argument:
                case int():
                    words.append(argument & 0xFFFF_FFFF)
                case float() | Int64():
                    if len(words) % 2:
                        words.append(0)
                    value = argument.value & (1 << 64) - 1 if isinstance(argument, Int64) else argument
                    words += struct.unpack("<II", struct.pack("<Q" if isinstance(argument, Int64) else "<d", value))
        on_stack = b"".join(struct.pack("<I", word) for word in words[4:])
        top = (_STACK + _STACK_SIZE - 64 - len(on_stack)) & -8
        self._uc.mem_write(top, on_stack)
        for register in range(13):
            self._uc.reg_write(arm.UC_ARM_REG_R0 + register, words[register] if register < min(4, len(words)) else 0)
        self._uc.reg_write(arm.UC_ARM_REG_SP, top)
        return top

    def _split(self, block: tuple[int, int]) -> None:
        """Remember the instruction addresses of a straight run, from the state the core is in now."""
        if block in self._lengths:
            return
        from unicorn import arm_const as arm

        address, size = block
        if not self._thumb_only and not self._uc.reg_read(arm.UC_ARM_REG_CPSR) & 0x20:
            self._lengths[block] = tuple(range(address, address + size, 4))
            return
        code, at, starts = self.read(address, size), 0, []
        while at < size:
            starts.append(address + at)
            at += 4 if code[at + 1] >> 3 in (0b11101, 0b11110, 0b11111) else 2
        self._lengths[block] = tuple(starts)


def _model(cpu: str) -> int:
    """The emulated core: ARMv4T and ARMv5TE share one, since code for the first runs on the second."""
    from unicorn import arm_const as arm

    models = {
        "cortex-m0": arm.UC_CPU_ARM_CORTEX_M0,
        "cortex-m0plus": arm.UC_CPU_ARM_CORTEX_M0,
        "cortex-m3": arm.UC_CPU_ARM_CORTEX_M3,
        "cortex-m4": arm.UC_CPU_ARM_CORTEX_M4,
        "cortex-m4f": arm.UC_CPU_ARM_CORTEX_M4,
    }
    return models.get(cpu, arm.UC_CPU_ARM_926)


def _load(path: Path) -> tuple[tuple[Symbol, ...], tuple[tuple[int, bytes, int], ...]]:
    """Symbols and loadable segments (address, content, size in memory) of an ELF."""
    from elftools.elf.elffile import ELFFile

    with path.open("rb") as stream:
        elf = ELFFile(stream)
        segments = tuple(
            (segment["p_vaddr"], segment.data(), segment["p_memsz"])
            for segment in elf.iter_segments("PT_LOAD")
            if segment["p_memsz"]
        )
        table = elf.get_section_by_name(".symtab")
        symbols = []
        for entry in table.iter_symbols() if table else ():
            kind = entry["st_info"]["type"]
            if entry.name and kind in ("STT_FUNC", "STT_OBJECT"):
                value, function = entry["st_value"], kind == "STT_FUNC"
                thumb = function and bool(value & 1)
                symbols.append(Symbol(entry.name, value & ~1 if thumb else value, entry["st_size"], thumb, function))
    return tuple(symbols), segments
