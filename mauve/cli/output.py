"""What the commands share when they write: messages, colours, widths, whole files."""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from collections.abc import Sequence
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from mauve.diagnostics.diagnostic import Diagnostic
    from mauve.diagnostics.style import Style


def write_messages(messages: Sequence[Diagnostic], format_: str, arguments: Namespace, file: str) -> None:
    """Messages on standard error, in a format for diagnostics; `file` is named by those without a place."""
    from mauve.diagnostics.render import render

    text = render(messages, format_, colour=coloured(arguments, sys.stderr), file=file)
    sys.stderr.write(text + ("\n" if text and format_ == "full" else ""))
    sys.stderr.flush()


def write_json(document: object) -> None:
    """One document on standard output, in ASCII, so that no encoding can break it."""
    import json

    sys.stdout.write(json.dumps(document, indent=2, allow_nan=False) + "\n")


def write_file(path: str, text: str) -> str:
    """Write a file whole or not at all; what went wrong, or an empty text. A device or a pipe is written directly."""
    if os.path.exists(path) and not os.path.isfile(path):
        return _write(path, text)
    draft = f"{path}.{os.getpid()}.part"
    problem = _write(draft, text)
    if not problem:
        try:
            os.replace(draft, path)
            return ""
        except OSError as error:
            problem = error.strerror or str(error)
    if os.path.exists(draft):
        os.unlink(draft)
    return problem


def _write(path: str, text: str) -> str:
    try:
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(text)
    except OSError as error:
        return error.strerror or str(error)
    return ""


def wrong_usage(message: str) -> int:
    """Say what is wrong with the arguments; the exit code."""
    print(f"mauvec: {message}", file=sys.stderr)
    return 2


def coloured(arguments: Namespace, stream: TextIO) -> bool:
    """Whether to colour what goes to a stream (https://no-color.org for NO_COLOR)."""
    if arguments.color != "auto":
        return bool(arguments.color == "always")
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def style(arguments: Namespace) -> Style:
    """The look of tables on standard output."""
    from mauve.diagnostics.style import ANSI, PLAIN

    return ANSI if coloured(arguments, sys.stdout) else PLAIN


def table_width() -> int | None:
    """The width that tables keep to: that of a terminal; none for a pipe or a file, where nothing is cut."""
    if not sys.stdout.isatty():
        return None
    from shutil import get_terminal_size

    return max(80, get_terminal_size().columns)
