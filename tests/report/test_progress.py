"""The progress line: only for a terminal, and gone in the end."""

from __future__ import annotations

import io

from mauve.report.progress import progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_nobody_watches_a_pipe() -> None:
    stream = io.StringIO()
    with progress(stream, "functions") as told:
        assert told is None
    assert stream.getvalue() == ""


def test_a_terminal_sees_one_line_that_is_wiped() -> None:
    stream = Terminal()
    with progress(stream, "functions") as told:
        assert told is not None
        told(1, 2, "evil\x1b[2J" + "x" * 500)
        told(2, 2, "too soon after the first")
    written = stream.getvalue().split("\r")
    assert written[0] == "" and written[1].startswith("1/2 functions: evil")
    assert "\x1b" not in stream.getvalue() and "\n" not in stream.getvalue()
    assert len(written) == 4 and written[2] == " " * 78 and written[3] == "", "wiped, and only one update"
    assert max(len(part) for part in written) == 78


def test_it_is_wiped_after_an_interrupt() -> None:
    stream = Terminal()
    try:
        with progress(stream, "functions") as told:
            assert told is not None
            told(1, 9, "f")
            raise KeyboardInterrupt
    except KeyboardInterrupt:
        pass
    assert stream.getvalue().endswith("\r" + " " * 78 + "\r")
