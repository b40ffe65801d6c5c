"""The full format: header, excerpt, labels, notes and help, for every shape a span can have."""

from __future__ import annotations

import unicodedata

from diagnostic_samples import at, diagnostics, offsets, texts
from hypothesis import given, settings

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label, Severity
from mauve.diagnostics.display import show
from mauve.diagnostics.render_full import render_full, summary
from mauve.diagnostics.style import ANSI, RESET
from mauve.source import SourceFile, Span


def body(diagnostic: Diagnostic) -> str:
    """The message without the header and the closing count."""
    return render_full([diagnostic]).split("\n", 1)[1].rsplit("\n\n", 1)[0]


def test_labels_stand_in_line_order_with_dots_between_distant_lines() -> None:
    diagnostic = Diagnostic(
        "MV201",
        "a `Position` cannot flow into a port of type `Attitude`",
        Label(at("ig500.position")),
        labels=(Label(at("Attitude"), "read as `Attitude`"), Label(at("Position"), "written as `Position`")),
    )
    assert render_full([diagnostic]) == (
        """\
error[MV201 type-mismatch]: a `Position` cannot flow into a port of type `Attitude`
  --> ttrk.mauve:13:11
   |
 2 |   out port position: Position
   |                      -------- written as `Position`
...
 5 |   in port attitude: Attitude
   |                     -------- read as `Attitude`
...
13 |   connect ig500.position -> fusion.attitude
   |           ^^^^^^^^^^^^^^

1 error
"""
    )


def test_labels_on_one_line_hang_below_it_from_right_to_left() -> None:
    diagnostic = Diagnostic(
        "MV204",
        "backwards",
        Label(at("fusion.attitude"), "this one is read"),
        labels=(Label(at("ig500"), "an instance"), Label(at("connect"), "here"), Label(at("fusion"), "inner")),
        help=Fix("swap the ends", (Edit(at("ig500"), "x"),), Applicability.MACHINE),
    )
    assert body(diagnostic) == (
        """\
  --> ttrk.mauve:13:29
   |
13 |   connect ig500.position -> fusion.attitude
   |   ------- -----             ^^^^^^^^^^^^^^^ this one is read
   |   |       |
   |   |       an instance
   |   here
   |                             ------ inner
   = help: swap the ends [fixable]"""
    )


def test_a_label_in_another_file_has_its_own_part() -> None:
    types = SourceFile("types.mauve", "struct Attitude {\n\troll: f32 }\n")
    diagnostic = Diagnostic("MV201", "m", Label(at("Attitude")), labels=(Label(at("roll: f32", types), "declared"),))
    assert body(diagnostic) == (
        """\
  --> ttrk.mauve:5:21
   |
 5 |   in port attitude: Attitude
   |                     ^^^^^^^^
  ::: types.mauve:2:2
   |
 2 |     roll: f32 }
   |     --------- declared"""
    )


def test_a_span_over_lines_has_a_rail() -> None:
    diagnostic = Diagnostic("MV301", "m", Label(at("initial state", until="fuse\n    }"), "this state"))
    assert body(diagnostic) == (
        """\
  --> ttrk.mauve:7:5
   |
 7 | /     initial state Fusing {
 8 | |       run fuse
 9 | |     }
   | |_____^ this state"""
    )


def test_long_and_nested_spans_keep_their_rails_apart() -> None:
    diagnostic = Diagnostic(
        "MV301",
        "m",
        Label(at("StateFusion", until="\n}\n"), "all of it"),
        labels=(Label(at("Fusing", until="fuse\n    }"), "a part"),),
    )
    assert body(diagnostic) == (
        """\
  --> ttrk.mauve:4:11
   |
 4 |     component StateFusion {
   |  _____________^
...  |
 7 | |       initial state Fusing {
   | |  ___________________-
 8 | | |       run fuse
 9 | | |     }
   | | |_____- a part
10 | |     }
11 | |   }
   | |___^ all of it"""
    )


def test_tabs_wide_and_combining_characters_keep_marks_below_their_text() -> None:
    file = SourceFile("r.mauve", "\tport 漢字e\u0301: T\n")
    assert body(Diagnostic("MV102", "m", Label(at("T", file), "here"), labels=(Label(at("漢字e\u0301", file)),))) == (
        "  --> r.mauve:1:13\n   |\n 1 |     port 漢字e\u0301: T\n   |          -----  ^ here"
    )


def test_an_empty_span_is_one_caret_even_at_the_end_of_the_file() -> None:
    file = SourceFile("r.mauve", "state {\n")
    assert body(Diagnostic("MV001", "m", Label(Span(file, 8, 8), "the file ends here"))) == (
        "  --> r.mauve:2:1\n   |\n 2 |\n   | ^ the file ends here"
    )
    assert body(Diagnostic("MV001", "m", Label(Span(file, 7, 8), "`}` is missing"))) == (
        "  --> r.mauve:1:8\n   |\n 1 | state {\n   |        ^ `}` is missing"
    )


def test_a_place_in_a_binary_stands_where_no_source_does() -> None:
    diagnostic = Diagnostic(
        "MV511",
        "a loop of `StateFusion.fuse` has no bound",
        place="fusion.c:41:3 (0x8a34, in `mat_invert`)",
        notes=("by 10ms, 5ms of work is due:\n4.00ms  fusion\n1.00ms  ig500",),
        help=Fix('add `loop "fusion.c:41" max N`'),
    )
    assert body(diagnostic) == (
        """\
  --> fusion.c:41:3 (0x8a34, in `mat_invert`)
   = note: by 10ms, 5ms of work is due:
           4.00ms  fusion
           1.00ms  ig500
   = help: add `loop "fusion.c:41" max N`"""
    )


def test_the_last_line_counts_by_severity() -> None:
    def one(severity: Severity) -> Diagnostic:
        return Diagnostic("MV901", "m", severity=severity)

    assert summary([one(Severity.ERROR), one(Severity.WARNING), one(Severity.ERROR)]) == "2 errors, 1 warning"
    assert summary([one(Severity.NOTE)]) == "1 note"
    assert summary([]) == "" and render_full([]) == ""


def test_colours_add_escapes_and_change_nothing_else() -> None:
    diagnostic = Diagnostic("MV301", "m", Label(at("Fusing", until="fuse\n"), "x"), notes=("n",), help=Fix("h"))
    painted = render_full([diagnostic], ANSI)
    assert "\x1b[1;31merror[MV301 unreachable-state]" + RESET in painted
    for _, escape in ANSI.escapes:
        painted = painted.replace(escape, "")
    assert painted.replace(RESET, "") == render_full([diagnostic])


def test_no_character_of_a_source_reaches_the_terminal_as_a_command() -> None:
    file = SourceFile("r\x1b[2J.mauve", "a \x1b[31m \u202e b \x07 \ud800\n")
    text = render_full([Diagnostic("MV001", "bad \x1b[0m\nsecond", Label(Span(file, 0, 1), "x\x9b"))])
    assert all(c == "\n" or unicodedata.category(c) not in ("Cc", "Cf", "Cs") for c in text)


def test_a_line_of_megabytes_is_shown_through_a_window() -> None:
    file = SourceFile("r.mauve", "{" * 3_000_000 + "!" + "}" * 3_000_000)
    text = render_full([Diagnostic("MV001", "m", Label(Span(file, 3_000_000, 3_000_001), "this one"))])
    source, marks = text.split("\n")[3:5]
    assert len(source) < 200
    assert source.index("!") == marks.index("^")


@given(diagnostics())
@settings(max_examples=150, deadline=None)
def test_any_text_and_any_span_can_be_shown(diagnostic: Diagnostic) -> None:
    text = render_full([diagnostic])
    text.encode("utf-8")
    assert text.startswith(f"{diagnostic.severity.value}[{diagnostic.code}")
    assert text == "\n".join(text.splitlines()) + "\n"
    assert text.count("= help:") >= (diagnostic.help is not None)


@given(texts.map(lambda t: t.replace("\n", " ")), offsets, offsets)
@settings(max_examples=150, deadline=None)
def test_marks_end_where_their_text_ends(line: str, start: int, end: int) -> None:
    file = SourceFile("f", line)
    text = render_full([Diagnostic("MV001", "m", Label(Span(file, start, end)))])
    marks = next(row for row in text.split("\n") if row.lstrip(" |").startswith("^"))
    low = max(0, min(start, len(line)))
    high = max(low, min(end, len(line)))
    while high > low and line[high - 1] == "\r":
        high -= 1
    shown = show(file.line(1), [low])
    assert marks.index("^") == len("   | ") + shown.cell(low)
    assert marks.count("^") == max(1, shown.cell(high) - shown.cell(low))
    assert shown.cell(high) <= shown.cells[-1]
