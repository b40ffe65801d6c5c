"""ARM executables: symbols, code and data as loaded. The only place that knows pyelftools.

`load` gives a `Binary` or an `ElfProblem`; damaged bytes never raise. Debug information is not touched here (see
`lines`).
"""

from __future__ import annotations

import bisect
import hashlib
import struct
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Any


class ElfProblemKind(Enum):
    """What is wrong with a file or a symbol."""

    NOT_A_FILE = "not-a-file"
    NOT_ELF = "not-elf"
    TRUNCATED = "truncated"
    DAMAGED = "damaged"
    NOT_ARM = "not-arm"
    BIG_ENDIAN = "big-endian"
    SIXTY_FOUR_BIT = "64-bit"
    RELOCATABLE = "relocatable"
    NO_CODE = "no-code"
    NOT_FOUND = "symbol-not-found"
    NOT_A_FUNCTION = "not-a-function"
    AMBIGUOUS = "ambiguous-symbol"


@dataclass(frozen=True, slots=True)
class ElfProblem:
    """Why there is no binary, or no function of that name; `message` is one sentence for the user."""

    kind: ElfProblemKind
    message: str


class Bind(Enum):
    """Who sees a symbol; the value is the encoding in st_info."""

    LOCAL = 0
    GLOBAL = 1
    WEAK = 2


class SymbolKind(Enum):
    """What a symbol says it names."""

    FUNCTION = "function"
    OBJECT = "object"
    LABEL = "label"
    """no type: hand-written assembly, or an address without a symbol"""


@dataclass(frozen=True, slots=True)
class Symbol:
    """A named address; `size` is 0 where the assembler gave none."""

    name: str
    address: int
    size: int
    bind: Bind
    thumb: bool = False
    kind: SymbolKind = SymbolKind.FUNCTION

    @property
    def key(self) -> int:
        """The address with bit 0 set for Thumb, as callees are named."""
        return self.address | self.thumb


@dataclass(frozen=True, slots=True)
class Segment:
    """Memory as loaded: `data` from the file, then zeros up to `size` bytes."""

    address: int
    size: int
    data: bytes = field(repr=False)
    writable: bool
    executable: bool

    @property
    def end(self) -> int:
        """The address after the segment."""
        return self.address + self.size

    @property
    def zero_fill(self) -> int:
        """Bytes that are zero at the start because the file holds none for them."""
        return self.size - len(self.data)


@dataclass(frozen=True, slots=True)
class Span:
    """Addresses from `start` up to but without `end`."""

    start: int
    end: int


class Content(Enum):
    """What a mapping symbol says of the bytes from its address on."""

    ARM = "a"
    THUMB = "t"
    DATA = "d"


@dataclass(frozen=True, slots=True, eq=False)
class Binary:
    """A loaded ARM executable. `functions` and `objects` are sorted by address; `constant` are the spans of memory that
    nothing writes; `entry` has bit 0 set for Thumb; `e_flags` is the header's word."""

    path: str
    sha256: str
    entry: int
    e_flags: int
    segments: tuple[Segment, ...]
    functions: tuple[Symbol, ...]
    objects: tuple[Symbol, ...]
    labels: tuple[Symbol, ...] = field(repr=False)
    constant: tuple[Span, ...] = field(repr=False)
    stripped: bool = False
    mapping: tuple[tuple[int, Content], ...] = field(default=(), repr=False)
    contents: bytes = field(default=b"", repr=False)
    """the whole file, for its debug information"""
    _by_name: dict[str, tuple[Symbol, ...]] = field(default_factory=dict, repr=False)
    _by_address: dict[int, Symbol] = field(default_factory=dict, repr=False)
    _starts: tuple[int, ...] = field(default=(), repr=False)
    _marks: tuple[int, ...] = field(default=(), repr=False)

    # ------------------------------------------------------------------------------------------------ memory
    def segment_at(self, address: int) -> Segment | None:
        """The segment that holds the byte at `address`."""
        for segment in self.segments:
            if segment.address <= address < segment.end:
                return segment
        return None

    def read(self, address: int, size: int) -> bytes | None:
        """Bytes as loaded (zeros where the file holds none), or None where a byte is outside all segments."""
        for segment in self.segments:
            start = address - segment.address
            if start >= 0 and start + size <= segment.size:
                found = segment.data[start : start + size]
                return found if len(found) == size else found.ljust(size, b"\0")
        return None

    def read_constant(self, address: int, size: int) -> bytes | None:
        """Bytes that no run can change: as `read`, but None for memory that is writable."""
        for span in self.constant:
            if span.start <= address and address + size <= span.end:
                return self.read(address, size)
        return None

    def read_code(self, address: int, size: int) -> bytes | None:
        """Bytes that may be executed: None outside executable segments and in the zero-filled part."""
        for segment in self.segments:
            start = address - segment.address
            if segment.executable and start >= 0 and start + size <= len(segment.data):
                return segment.data[start : start + size]
        return None

    def content_at(self, address: int) -> Content | None:
        """What the mapping symbols say of the byte at `address`; None where there are none."""
        at = bisect.bisect_right(self._marks, address) - 1
        if at < 0:
            return None
        mark, content = self.mapping[at]
        segment = self.segment_at(address)
        return content if segment is not None and segment.address <= mark else None

    def next_mark(self, address: int) -> int:
        """The next address at which `content_at` may change."""
        at = bisect.bisect_right(self._marks, address)
        return self._marks[at] if at < len(self._marks) else 1 << 32

    # ------------------------------------------------------------------------------------------------ symbols
    def function_names(self) -> tuple[str, ...]:
        """All names of functions, for spelling help."""
        return tuple(dict.fromkeys(symbol.name for symbol in self.functions))

    def function(self, name: str) -> Symbol | ElfProblem:
        """The function of that name; a number (decimal or 0x...) means the function at that address."""
        found = self._by_name.get(name, ())
        candidates = [s for s in found if s.kind is SymbolKind.FUNCTION]
        candidates = candidates or [s for s in found if s.kind is SymbolKind.LABEL and self._is_code(s)]
        candidates = [s for s in candidates if s.bind is not Bind.LOCAL] or candidates
        places = {s.key for s in candidates}
        if len(places) == 1:
            return candidates[0]
        if len(places) > 1:
            where = ", ".join(f"{key & ~1:#x}" for key in sorted(places))
            return ElfProblem(
                ElfProblemKind.AMBIGUOUS,
                f"`{name}` names several local functions, at {where}: give the address instead",
            )
        if found:
            return ElfProblem(
                ElfProblemKind.NOT_A_FUNCTION, f"`{name}` is data at {found[0].address:#x}, not a function"
            )
        address = _number(name)
        if address is not None:
            return self._function_by_number(address)
        hint = ""
        if self.stripped:
            hint = ": the binary is stripped; link without -s and do not run strip, or name the function by its address"
        return ElfProblem(ElfProblemKind.NOT_FOUND, f"there is no function `{name}` in the binary{hint}")

    def symbol_at(self, address: int) -> Symbol | None:
        """The function symbol exactly at `address` (bit 0 is ignored); a global one where there are several."""
        return self._by_address.get(address & ~1)

    def function_at(self, address: int) -> Symbol | None:
        """The function whose symbol covers `address`, by size, or by the next symbol where sizes are missing."""
        at = bisect.bisect_right(self._starts, address & ~1) - 1
        if at < 0:
            return None
        symbol = self._by_address[self._starts[at]]
        inside = address < symbol.address + symbol.size if symbol.size else True
        return symbol if inside and self.segment_at(address) is self.segment_at(symbol.address) else None

    def name_at(self, address: int) -> str:
        """A name for code at `address`: a symbol, a symbol and an offset, or the number."""
        symbol = self.function_at(address)
        if symbol is None:
            return f"{address & ~1:#x}"
        offset = (address & ~1) - symbol.address
        return f"{symbol.name}+{offset:#x}" if offset else symbol.name

    def _is_code(self, symbol: Symbol) -> bool:
        there = self.read_code(symbol.address, 2) is not None
        return there and self.content_at(symbol.address) is not Content.DATA

    def _function_by_number(self, number: int) -> Symbol | ElfProblem:
        known = self.symbol_at(number)
        if known is not None:
            return known
        if self.read_code(number & ~1, 2) is None:
            return ElfProblem(ElfProblemKind.NOT_A_FUNCTION, f"there is no code at {number & ~1:#x} in the binary")
        content = self.content_at(number & ~1)
        if content is Content.DATA:
            return ElfProblem(
                ElfProblemKind.NOT_A_FUNCTION, f"there is data at {number & ~1:#x} in the binary, not code"
            )
        thumb = bool(number & 1) or content is Content.THUMB
        return Symbol(f"{number & ~1:#x}", number & ~1, 0, Bind.LOCAL, thumb, SymbolKind.LABEL)


def _number(text: str) -> int | None:
    try:
        value = int(text, 0)
    except ValueError:
        return None
    return value if 0 <= value < 1 << 32 else None


# ---------------------------------------------------------------------------------------------------- loading
def load(path: str | Path) -> Binary | ElfProblem:
    """The executable in the file, or what is wrong with it."""
    name = str(path)
    try:
        data = Path(path).read_bytes()
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        return ElfProblem(ElfProblemKind.NOT_A_FILE, f"cannot read {name}: {reason}")
    return load_bytes(data, name)


def load_bytes(data: bytes, name: str) -> Binary | ElfProblem:
    """As `load`, for the contents of a file."""
    problem = _check_header(data, name)
    if problem is not None:
        return problem
    try:
        return _parse(data, name)
    except Exception as error:  # pyelftools raises many kinds on damaged bytes; all mean the same to the user
        return ElfProblem(ElfProblemKind.DAMAGED, f"{name} is damaged: {_one_line(error)}")


def _one_line(error: Exception) -> str:
    text = " ".join(str(error).split())
    return (text[:120] or type(error).__name__).rstrip(".")


def _check_header(data: bytes, name: str) -> ElfProblem | None:
    kinds = ElfProblemKind
    if data[:4] != b"\x7fELF":
        what = "an empty file" if not data else "not an ELF file"
        return ElfProblem(kinds.NOT_ELF, f"{name} is {what}")
    if len(data) < 52:
        return ElfProblem(kinds.TRUNCATED, f"{name} is truncated: {len(data)} bytes do not hold an ELF header")
    if data[4] == 2:
        return ElfProblem(kinds.SIXTY_FOUR_BIT, f"{name} is a 64-bit ELF file: only 32-bit ARM code can be analysed")
    big = data[5] == 2
    order = ">" if big else "<"
    kind, machine, _, _, phoff, shoff, flags, _, phentsize, phnum, shentsize, shnum = struct.unpack(
        order + "HHIIIIIHHHHH", data[16:50]
    )
    if machine != 40:
        return ElfProblem(kinds.NOT_ARM, f"{name} is not for ARM (e_machine is {machine}, ARM is 40)")
    if big:
        form = "BE8" if flags & 0x00800000 else "BE32"
        return ElfProblem(kinds.BIG_ENDIAN, f"{name} is big-endian ({form}): only little-endian code can be analysed")
    if data[4] != 1 or data[5] != 1:
        return ElfProblem(kinds.DAMAGED, f"{name} is damaged: the ELF header has an unknown class or byte order")
    if kind == 1:
        return ElfProblem(
            kinds.RELOCATABLE, f"{name} is a relocatable object file: link it first, addresses are not known"
        )
    if kind not in (2, 3):
        return ElfProblem(kinds.NO_CODE, f"{name} is not an executable (e_type is {kind})")
    for what, offset, size in (("program", phoff, phentsize * phnum), ("section", shoff, shentsize * shnum)):
        if offset + size > len(data):
            return ElfProblem(kinds.TRUNCATED, f"{name} is truncated: the {what} headers lie beyond its end")
    if phnum == 0:
        return ElfProblem(kinds.NO_CODE, f"{name} has no program headers: nothing would be loaded")
    return None


def _parse(data: bytes, name: str) -> Binary | ElfProblem:
    import io

    from elftools.elf.elffile import ELFFile

    elf = ELFFile(io.BytesIO(data))
    segments: list[Segment] = []
    for header in (segment.header for segment in elf.iter_segments()):
        if header.p_type != "PT_LOAD" or header.p_memsz == 0:
            continue
        end = header.p_offset + header.p_filesz
        if end > len(data):
            return ElfProblem(
                ElfProblemKind.TRUNCATED,
                f"{name} is truncated: it ends {end - len(data)} bytes before a loaded segment does",
            )
        if header.p_filesz > header.p_memsz or header.p_vaddr + header.p_memsz > 1 << 32:
            return ElfProblem(ElfProblemKind.DAMAGED, f"{name} is damaged: a segment does not fit into memory")
        contents = data[header.p_offset : end]
        writable, executable = bool(header.p_flags & 2), bool(header.p_flags & 1)
        segments.append(Segment(header.p_vaddr, header.p_memsz, contents, writable, executable))
    if not any(segment.executable for segment in segments):
        return ElfProblem(ElfProblemKind.NO_CODE, f"{name} has no executable segment")
    sections = list(elf.iter_sections()) if elf.header.e_shnum else []
    constant = _constant_spans(sections, segments)
    table = _symbol_table(sections, data)
    if isinstance(table, str):
        return ElfProblem(ElfProblemKind.TRUNCATED, f"{name} is truncated: {table}")
    return _binary(data, name, elf.header.e_entry, elf.header.e_flags, segments, constant, table)


def _constant_spans(sections: list[Any], segments: list[Segment]) -> tuple[Span, ...]:
    """Read-only memory: sections without the write flag; without sections, segments without it. Linkers put read-only
    and writable sections into one writable segment where the script says no better."""
    spans: list[Span] = []
    headers = [section.header for section in sections]
    allocated = [h for h in headers if h.sh_flags & 2 and h.sh_type != "SHT_NOBITS" and h.sh_size]
    if not allocated:
        return tuple(Span(s.address, s.address + len(s.data)) for s in segments if not s.writable)
    for header in sorted(allocated, key=lambda h: int(h.sh_addr)):
        if header.sh_flags & 1:
            continue
        start, end = header.sh_addr, header.sh_addr + header.sh_size
        if spans and spans[-1].end == start:
            spans[-1] = Span(spans[-1].start, end)
        else:
            spans.append(Span(start, end))
    return tuple(spans)


_Entry = tuple[str, int, int, int, int]
"""Name, value, size, info, section index of a symbol."""


def _symbol_table(sections: list[Any], data: bytes) -> list[_Entry] | str:
    """The entries of .symtab (empty when stripped), or what is missing. Read in one go: a symbol at a time is slow."""
    found = [s for s in sections if s.header.sh_type == "SHT_SYMTAB"]
    if not found:
        return []
    header = found[0].header
    names = sections[header.sh_link].header
    if max(header.sh_offset + header.sh_size, names.sh_offset + names.sh_size) > len(data):
        return "the symbol table lies beyond its end"
    strings = data[names.sh_offset : names.sh_offset + names.sh_size]
    raw = data[header.sh_offset : header.sh_offset + header.sh_size // 16 * 16]
    entries = []
    for name, value, size, info, _, index in struct.iter_unpack("<IIIBBH", raw):
        end = strings.find(b"\0", name)
        text = strings[name : end if end >= 0 else len(strings)].decode("utf-8", "replace")
        entries.append((text, value, size, info, index))
    return entries


_NOTYPE, _OBJECT, _FUNC, _IFUNC = 0, 1, 2, 10
_BINDS = {0: Bind.LOCAL, 1: Bind.GLOBAL, 2: Bind.WEAK}


def _binary(
    data: bytes,
    name: str,
    entry: int,
    e_flags: int,
    segments: list[Segment],
    constant: tuple[Span, ...],
    table: list[_Entry],
) -> Binary:
    functions: list[Symbol] = []
    objects: list[Symbol] = []
    labels: list[Symbol] = []
    mapping: dict[int, Content] = {}
    for text, value, size, info, index in table:
        kind, bind = info & 15, _BINDS.get(info >> 4, Bind.GLOBAL)
        if index == 0 or not text:
            continue
        if text[0] == "$" and kind == _NOTYPE and bind is Bind.LOCAL:
            if text[1:2] in ("a", "t", "d") and (len(text) == 2 or text[2] == "."):
                mapping[value] = Content(text[1])
        elif kind in (_FUNC, _IFUNC) and index < 0xFF00:
            functions.append(Symbol(text, value & ~1, size, bind, bool(value & 1)))
        elif kind == _OBJECT:
            objects.append(Symbol(text, value, size, bind, kind=SymbolKind.OBJECT))
        elif kind == _NOTYPE and index < 0xFF00:
            labels.append(Symbol(text, value, size, bind, kind=SymbolKind.LABEL))
    marks = tuple(sorted(mapping.items()))
    labels = [_with_state(label, marks) for label in labels]
    order = {Bind.GLOBAL: 0, Bind.WEAK: 1, Bind.LOCAL: 2}
    functions.sort(key=lambda s: (s.address, order[s.bind], -s.size, s.name))
    by_name: dict[str, list[Symbol]] = {}
    for symbol in (*functions, *objects, *labels):
        by_name.setdefault(symbol.name, []).append(symbol)
    by_address: dict[int, Symbol] = {}
    for symbol in functions:
        by_address.setdefault(symbol.address, symbol)
    return Binary(
        name, hashlib.sha256(data).hexdigest(), entry, e_flags, tuple(sorted(segments, key=lambda s: s.address)),
        tuple(functions), tuple(sorted(objects, key=lambda s: s.address)), tuple(labels), constant,
        not functions and not labels, marks, data, {k: tuple(v) for k, v in by_name.items()}, by_address,
        tuple(sorted(by_address)), tuple(address for address, _ in marks),
    )  # fmt: skip


def _with_state(label: Symbol, marks: tuple[tuple[int, Content], ...]) -> Symbol:
    at = bisect.bisect_right(marks, label.address, key=lambda mark: mark[0]) - 1
    thumb = at >= 0 and marks[at][1] is Content.THUMB
    return Symbol(label.name, label.address & ~1, label.size, label.bind, thumb, SymbolKind.LABEL)


# ---------------------------------------------------------------------------------------------------- debug information
@dataclass(frozen=True, slots=True)
class Unit:
    """A compiled source: its name and the directory of the compilation, as the compiler wrote them."""

    name: str
    directory: str


def debug_sections(binary: Binary, names: tuple[str, ...]) -> dict[str, bytes]:
    """The contents of sections, unpacked where compressed; those that are missing or damaged are left out."""
    import io

    from elftools.elf.elffile import ELFFile

    found: dict[str, bytes] = {}
    try:
        elf = ELFFile(io.BytesIO(binary.contents))
        for name in names:
            section = elf.get_section_by_name(name)
            if section is not None:
                found[name] = bytes(section.data())
    except Exception:  # damaged: pyelftools raises many kinds
        return found
    return found


def debug_units(binary: Binary) -> tuple[Unit, ...]:
    """The compilation units named in .debug_info, as far as it can be read."""
    import io

    from elftools.elf.elffile import ELFFile

    units: dict[Unit, None] = {}
    try:
        elf = ELFFile(io.BytesIO(binary.contents))
        if not elf.has_dwarf_info():
            return ()
        for unit in elf.get_dwarf_info().iter_CUs():
            attributes = unit.get_top_DIE().attributes
            texts = [attributes[key].value if key in attributes else b"" for key in ("DW_AT_name", "DW_AT_comp_dir")]
            name, directory = (t.decode("utf-8", "replace") if isinstance(t, bytes) else "" for t in texts)
            if name:
                units[Unit(name, directory)] = None
    except Exception:  # damaged: pyelftools raises many kinds
        return tuple(units)
    return tuple(units)
