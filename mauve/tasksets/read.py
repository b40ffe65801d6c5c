"""A file to task sets: which format it has, and its text."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Diagnostic, Label, Report
from mauve.source import SourceFile, Span
from mauve.tasksets.taskset import UNREADABLE, Document

LARGEST = 64 << 20
"""A longer file, in bytes, is refused."""


def read_tasksets(path: str, report: Report) -> Document:
    """The task sets of a file, by its name and its first character; what is wrong is reported.

    `.csv` is CSV, `.xml` or a text that begins with `<` Cheddar XML, `.json` or a text that begins with `{` or `[`
    mauve.taskset/1, all else MAST text.
    """
    file = _read(path, report)
    if file is None:
        return UNREADABLE
    name, text = path.lower(), file.text.lstrip()
    if name.endswith(".csv"):
        from mauve.tasksets.csv_input import read_csv

        return read_csv(file, report)
    if name.endswith((".xml", ".xmlv3")) or text.startswith("<"):
        from mauve.tasksets.cheddar_input import read_cheddar

        return read_cheddar(file, report)
    if name.endswith((".txt", ".mast", ".mdl")) and not text.startswith(("{", "[")):
        from mauve.tasksets.mast_input import read_mast

        return read_mast(file, report)
    from mauve.tasksets.json_input import read_json

    return read_json(file, report)


def _read(path: str, report: Report) -> SourceFile | None:
    data, problem = b"", ""
    try:
        with open(path, "rb") as stream:
            data = stream.read(LARGEST + 1)
    except OSError as error:
        missing = isinstance(error, FileNotFoundError)
        problem = f"cannot read `{path}`: {'there is no such file' if missing else (error.strerror or '').lower()}"
    except ValueError:
        problem = "cannot read a file with a NUL character in its name"
    if len(data) > LARGEST:
        problem = f"`{path}` has more than {LARGEST >> 20} MiB"
    if problem:
        report.add(Diagnostic("MV620", problem, place=path))
        return None
    data = data.removeprefix(b"\xef\xbb\xbf")
    try:
        return SourceFile(path, data.decode("utf-8"))
    except UnicodeDecodeError as error:
        file = SourceFile(path, data.decode("utf-8", errors="replace"))
        at = len(data[: error.start].decode("utf-8"))
        label = Label(Span(file, at, at + 1), f"the byte 0x{data[error.start]:02x}")
        report.add(Diagnostic("MV620", f"`{path}` is not UTF-8 text", label))
        return None
