"""Source lines of addresses: the line number programs of .debug_line, DWARF 2 to 5.

`load_lines` never fails: damaged or missing debug information leaves places without a line. Line programs are run
here, on bytes, because their number is large; sections and compilation units come from `elf`.
"""

from __future__ import annotations

import bisect
import posixpath
from contextlib import suppress
from dataclasses import dataclass, field

from mauve.wcet.binary.elf import Binary, Unit, debug_sections, debug_units

_ROW_LIMIT = 4_000_000


@dataclass(frozen=True, slots=True)
class Row:
    """Addresses `start` up to but without `end` belong to a line of a file (an index into `LineTable.files`)."""

    start: int
    end: int
    file: int
    line: int
    is_stmt: bool


@dataclass(frozen=True, slots=True, eq=False)
class LineTable:
    """Rows by address. `files` are the paths as the line table has them; `units` name the sources that were compiled,
    with the directory they were compiled in."""

    files: tuple[str, ...] = ()
    units: tuple[Unit, ...] = ()
    rows: tuple[Row, ...] = field(default=(), repr=False)
    statements: tuple[tuple[int, int, int], ...] = field(default=(), repr=False)
    """(file, line, address) of every row that starts a statement, those without code of their own included"""
    _starts: tuple[int, ...] = field(default=(), repr=False)

    def location(self, address: int) -> tuple[str, int] | None:
        """File and line of the code at `address` (bit 0 is ignored)."""
        at = bisect.bisect_right(self._starts, address & ~1) - 1
        if at < 0 or self.rows[at].end <= address & ~1 or self.rows[at].line == 0:
            return None
        row = self.rows[at]
        return self.files[row.file], row.line

    def source(self, address: int) -> str:
        """`file:line`, or nothing."""
        found = self.location(address)
        return f"{found[0]}:{found[1]}" if found is not None else ""

    def addresses(self, file: str, line: int) -> tuple[int, ...]:
        """Where the statements of a line start, in order; where no statement does, where its code starts."""
        numbers = {number for number, path in enumerate(self.files) if same_file(path, file)}
        found = {address for number, at, address in self.statements if at == line and number in numbers}
        found = found or {row.start for row in self.rows if row.line == line and row.file in numbers}
        return tuple(sorted(found))


def same_file(path: str, wanted: str) -> bool:
    """Whether a path of the line table is the wanted one: equal, or one of them is the last components of the other
    (the table's path is relative where the compiler was given a relative one)."""
    path, wanted = (posixpath.normpath(name.replace("\\", "/")) for name in (path, wanted))
    if path == wanted or path.endswith("/" + wanted):
        return True
    return path not in ("", ".") and not path.startswith("/") and wanted.endswith("/" + path)


def load_lines(binary: Binary) -> LineTable:
    """The line table of a binary; empty where it has none."""
    sections = debug_sections(binary, (".debug_line", ".debug_line_str", ".debug_str"))
    data = sections.get(".debug_line")
    if not data:
        return LineTable()
    files: dict[str, int] = {}
    sequences: list[_Sequence] = []
    offset = read = 0
    while offset + 4 <= len(data) and read < _ROW_LIMIT:
        program = _Program(data, offset, sections, files, _ROW_LIMIT - read)
        with suppress(IndexError, ValueError):  # damaged: what was read before stays
            program.run()
        sequences += program.sequences
        read += sum(len(sequence.rows) for sequence in program.sequences)
        if program.end <= offset:
            break
        offset = program.end
    linked = _linked(binary, sequences)
    kept = [
        row
        for sequence in linked
        for row in sequence.rows
        if row.start < row.end and binary.read_code(row.start, 1) is not None
    ]
    kept.sort(key=lambda row: row.start)
    marks = tuple(m for sequence in linked for m in sequence.statements if binary.read_code(m[2], 1) is not None)
    return LineTable(tuple(files), debug_units(binary), tuple(kept), marks, tuple(row.start for row in kept))


@dataclass(slots=True)
class _Sequence:
    """What one sequence of a line number program says of one piece of code."""

    rows: list[Row] = field(default_factory=list)
    statements: list[tuple[int, int, int]] = field(default_factory=list)

    @property
    def start(self) -> int:
        return self.rows[0].start if self.rows else -1

    @property
    def end(self) -> int:
        return self.rows[-1].end if self.rows else -1


def _linked(binary: Binary, sequences: list[_Sequence]) -> list[_Sequence]:
    """The sequences of code that is there. A linker that drops a function leaves its lines at address 0: they would lie
    over the code that is really at low addresses, so of several sequences at 0 only one that fits the function there
    stays."""
    at_zero = [sequence for sequence in sequences if sequence.start == 0]
    others = [s for s in sequences if s.start > 0 and binary.read_code(s.start, 1) is not None]
    if binary.read_code(0, 1) is None:
        return others
    if len(at_zero) > 1:
        symbol = binary.symbol_at(0)
        at_zero = [s for s in at_zero if symbol is not None and s.end == symbol.address + symbol.size][:1]
    return [*at_zero, *others]


class _Reader:
    """Numbers and strings out of bytes; IndexError past the end."""

    def __init__(self, data: bytes, at: int) -> None:
        self.data, self.at = data, at

    def unsigned(self, size: int) -> int:
        end = self.at + size
        if end > len(self.data):
            raise IndexError
        value = int.from_bytes(self.data[self.at : end], "little")
        self.at = end
        return value

    def uleb(self) -> int:
        value = shift = 0
        while True:
            byte = self.data[self.at]
            self.at += 1
            value |= (byte & 127) << shift
            if byte < 128:
                return value
            shift += 7
            if shift > 70:
                raise ValueError("a number that does not end")

    def sleb(self) -> int:
        start = self.at
        value = self.uleb()
        bits = 7 * (self.at - start)
        return value - (1 << bits) if self.data[self.at - 1] & 64 else value

    def string(self) -> str:
        end = self.data.index(b"\0", self.at)
        text = self.data[self.at : end].decode("utf-8", "replace")
        self.at = end + 1
        return text


class _Program:
    """The line number program of one unit (DWARF 5, section 6.2)."""

    def __init__(
        self,
        data: bytes,
        offset: int,
        sections: dict[str, bytes],
        files: dict[str, int],
        limit: int,
    ) -> None:
        self.reader = _Reader(data, offset)
        self.sections, self.files, self.limit = sections, files, limit
        self.sequences: list[_Sequence] = []
        self.wide = 4
        length = self.reader.unsigned(4)
        if length == 0xFFFFFFFF:
            self.wide = 8
            length = self.reader.unsigned(8) if len(data) >= offset + 12 else len(data)
        self.end = self.reader.at + length

    def run(self) -> None:
        """Read the header, then run the program."""
        reader = self.reader
        if self.end > len(reader.data):
            self.end = len(reader.data)
        version = reader.unsigned(2)
        if not 2 <= version <= 5:
            return
        if version >= 5:
            reader.unsigned(2)
        header = reader.unsigned(self.wide)
        start = reader.at + header
        self.least = reader.unsigned(1)
        if version >= 4:
            reader.unsigned(1)
        self.default_stmt = bool(reader.unsigned(1))
        self.line_base = (reader.unsigned(1) ^ 128) - 128
        self.line_range = reader.unsigned(1) or 1
        self.opcode_base = reader.unsigned(1)
        self.lengths = [reader.unsigned(1) for _ in range(self.opcode_base - 1)]
        self.paths = self._paths5() if version >= 5 else self._paths2()
        reader.at = start
        while reader.at < self.end and self.limit > 0:
            self._sequence()
            self.limit -= len(self.sequences[-1].rows)

    def _paths2(self) -> list[int]:
        """The files of DWARF 2 to 4: numbered from 1, directory 0 is that of the compilation."""
        directories = [""]
        while self.reader.data[self.reader.at]:
            directories.append(self.reader.string())
        self.reader.at += 1
        paths = [self._file("")]
        while self.reader.data[self.reader.at]:
            name = self.reader.string()
            directory = self.reader.uleb()
            self.reader.uleb()
            self.reader.uleb()
            paths.append(self._file(posixpath.join(directories[directory], name)))
        return paths

    def _paths5(self) -> list[int]:
        """The files of DWARF 5: numbered from 0, directory 0 is that of the compilation."""
        directories = [str(entry.get(1, "")) for entry in self._entries()]
        paths: list[int] = []
        for entry in self._entries():
            number = int(entry.get(2, 0))
            directory = "" if number == 0 else directories[number]
            paths.append(self._file(posixpath.join(directory, str(entry.get(1, "")))))
        return paths

    def _entries(self) -> list[dict[int, int | str]]:
        reader = self.reader
        formats = [(reader.uleb(), reader.uleb()) for _ in range(reader.unsigned(1))]
        count = reader.uleb()
        if count > len(reader.data):
            raise ValueError("more files than bytes")
        return [{kind: self._form(form) for kind, form in formats} for _ in range(count)]

    def _form(self, form: int) -> int | str:
        reader = self.reader
        match form:
            case 0x08:
                return reader.string()
            case 0x1F | 0x0E:
                at = reader.unsigned(self.wide)
                return _Reader(self.sections.get(".debug_line_str" if form == 0x1F else ".debug_str", b""), at).string()
            case 0x0F:
                return reader.uleb()
            case 0x0B | 0x05 | 0x06 | 0x07:
                return reader.unsigned({0x0B: 1, 0x05: 2, 0x06: 4, 0x07: 8}[form])
            case 0x1E:
                reader.unsigned(16)
                return 0
            case 0x09:
                reader.unsigned(reader.uleb())
                return 0
        raise ValueError("a form that line tables do not have")

    def _file(self, path: str) -> int:
        return self.files.setdefault(posixpath.normpath(path) if path else "", len(self.files))

    def _sequence(self) -> None:
        """One run from the initial state to the end of a sequence."""
        reader = self.reader
        self.sequences.append(_Sequence())
        address, file, line, stmt = 0, 1, 1, self.default_stmt
        last: tuple[int, int, int, bool] | None = None
        while reader.at < self.end and len(self.sequences[-1].rows) < self.limit:
            opcode = reader.unsigned(1)
            emits = False
            if opcode >= self.opcode_base:
                adjusted = opcode - self.opcode_base
                address += adjusted // self.line_range * self.least
                line += self.line_base + adjusted % self.line_range
                emits = True
            elif opcode == 0:
                length = reader.uleb()
                following = reader.at + length
                kind = reader.unsigned(1)
                if kind == 1:
                    self._emit(last, address)
                    reader.at = following
                    return
                if kind == 2:
                    address = reader.unsigned(length - 1)
                reader.at = following
            elif opcode == 1:
                emits = True
            elif opcode == 2:
                address += reader.uleb() * self.least
            elif opcode == 3:
                line += reader.sleb()
            elif opcode == 4:
                file = reader.uleb()
            elif opcode == 6:
                stmt = not stmt
            elif opcode == 8:
                address += (255 - self.opcode_base) // self.line_range * self.least
            elif opcode == 9:
                address += reader.unsigned(2)
            else:
                for _ in range(self.lengths[opcode - 1]):
                    reader.uleb()
            if emits:
                self._emit(last, address)
                last = (address, file, line, stmt)
                if stmt:
                    self.sequences[-1].statements.append((self.paths[file], line, address))

    def _emit(self, last: tuple[int, int, int, bool] | None, address: int) -> None:
        """Close the row before at the address where it ends; of several rows that start at one address the last one
        counts."""
        if last is not None and last[0] < address:
            start, file, line, stmt = last
            self.sequences[-1].rows.append(Row(start, address, self.paths[file], max(line, 0), stmt))
