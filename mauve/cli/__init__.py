"""The command line: arguments, a module for each command, and what no command may let out.

Exit codes: 0 everything holds; 1 the input has errors, or a requirement does not hold, or an analysis is incomplete;
2 wrong usage; 70 a bug of ours; 74 no room for the output; 130 interrupted; 141 the reader of the output went away.
Results go to standard output, messages and progress to standard error.
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any

from mauve import __version__

EXIT_HOLDS, EXIT_FAILS, EXIT_USAGE, EXIT_BUG, EXIT_NO_ROOM, EXIT_INTERRUPTED, EXIT_PIPE = 0, 1, 2, 70, 74, 130, 141

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns its exit code and never lets an exception out."""
    try:
        _survive_any_encoding(sys.stdout)
        code = _run(sys.argv[1:] if argv is None else argv)
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        print("mauvec: interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        # The reader went away (`mauvec check ... | head`): nothing is left to say, and nothing to flush at exit.
        _drop_output()
        return EXIT_PIPE
    except Exception as error:
        if isinstance(error, OSError) and error.errno in NO_ROOM:
            print(f"mauvec: cannot write the output: {(error.strerror or '').lower()}", file=sys.stderr)
            _drop_output()
            return EXIT_NO_ROOM
        if os.environ.get("MAUVEC_TRACEBACK"):
            raise
        _report_bug(error)
        return EXIT_BUG


def _run(argv: Sequence[str]) -> int:
    from mauve.cli.arguments import parse

    try:
        arguments = parse(argv)
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else EXIT_HOLDS
    code: int = import_module(f"mauve.cli.{arguments.command}").run(arguments)
    return code


def _drop_output() -> None:
    """Let what is still buffered go nowhere, so that the flush at exit does not fail again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _survive_any_encoding(stream: Any) -> None:
    """What the terminal's encoding cannot show is escaped instead of ending the program."""
    if hasattr(stream, "reconfigure"):
        stream.reconfigure(errors="backslashreplace")


def _report_bug(error: Exception) -> None:
    """One line that asks for a report; never a traceback."""
    frame = error.__traceback__
    while frame is not None and frame.tb_next is not None:
        frame = frame.tb_next
    where = f"{os.path.basename(frame.tb_frame.f_code.co_filename)}:{frame.tb_lineno}" if frame else "?"
    text = " ".join(str(error).split())[:200]
    print(
        f"mauvec: internal error [MV901]: {type(error).__name__}: {text} (at {where}); this is a bug of mauvec "
        f"{__version__}: please report it with the input, and set MAUVEC_TRACEBACK=1 to see more",
        file=sys.stderr,
    )
