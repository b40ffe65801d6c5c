"""Each planted mistake gives one message, at its line, and nothing after it."""

from __future__ import annotations

import pytest

from mauve.diagnostics.diagnostic import Diagnostic, Report
from mauve.source import SourceFile
from mauve.syntax import ast
from mauve.syntax.parse import parse

SOUND = """mauve 1
package t
struct P { x, y: f64 }
enum E { A, B }
component C {
  in port a: P
  out port b: P
  property gain: f64 = 0.5
  var v: P
  method send(v: P): E
  codel move reads a, gain writes b wcet 1ms
  codel ready reads a returns bool
  behaviour {
    initial state Idle {
      entry move
      run move then send(v)
      -> Busy when ready and not ready
    }
    state Busy {
      run move
      -> Idle
    }
  }
}
passive component D {
  operation send(v: P): E = act runs in caller
  codel act
}
architecture X {
  instance c: C { period 10ms priority 3 gain = 0.1 }
  instance d: D
  connect c.send -> d.send
  connect c.b -> c.a buffered size 4
}
board b {
  cpu "arm7tdmi" at 60MHz
  icache off
  memory ram at 0x0 size 64KiB wait 1cycles
}
deployment bench of X {
  node n on b {
    binary "x.elf" {
      C.move = "c_move"
      loop "c.c:10" max 6
    }
    assume others wcet 1ms
  }
}
"""

PLANTED = [
    # what stands there, what is planted, the code, a part of the message
    ("struct P { x, y: f64 }", "struct P { x y: f64 }", "MV001", "expected `,` after `x`"),
    ("struct P { x, y: f64 }", "struct P { x, y f64 }", "MV001", "expected `:` between the field and its type"),
    ("struct P { x, y: f64 }", "struct { x, y: f64 }", "MV001", "expected the name of the struct after `struct`"),
    ("enum E { A, B }", "enum E { A, }", "MV001", "expected a name after `,`"),
    ("component C {", "componnent C {", "MV001", "unknown word `componnent`"),
    ("component C {", "component C extends Base {", "MV001", "expected `{`"),
    ("in port a: P", "in port a P", "MV001", "expected `:` between the port and its type"),
    ("in port a: P", "port in a: P", "MV001", "the direction comes before `port`"),
    ("in port a: P", "port a: P", "MV001", "the port has no direction"),
    ("in port a: P", "in port a: P;", "MV001", "a line ends without `;`"),
    ("in port a: P", "in port a:", "MV001", "expected a type after `:`"),
    ("in port a: P", "inn port a: P", "MV001", "unknown word `inn`"),
    ("in port a: P", "in port a: P /* the input */", "MV001", "comments begin with `//`"),
    ("property gain: f64 = 0.5", "property gain: f64 := 0.5", "MV001", "there is no `:=`"),
    ("property gain: f64 = 0.5", 'property gain: f64 = "a', "MV001", "no closing quote"),
    ("property gain: f64 = 0.5", "property gain: f64 = 'a'", "MV001", "strings stand in double quotes"),
    ("var v: P", "var after: P", "MV005", "`after` is a reserved word"),
    ("var v: P", "var v: P @", "MV001", "found `@`"),
    ("var v: P", "var vé: P", "MV001", "a name has no `é`"),
    ("reads a, gain writes", "reads a gain writes", "MV001", "expected `,` after `a`"),
    ("wcet 1ms", "wcet 1 ms", "MV001", "a unit stands against its number"),
    ("wcet 1ms", "wcet 1", "MV004", "the number `1` has no unit"),
    ("wcet 1ms", "wcet", "MV001", "expected a number with its unit after `wcet`"),
    ("wcet 1ms", "wcet 1ms wcet 2ms", "MV001", "`wcet` is given twice"),
    ("behaviour {", "behavior {", "MV001", "unknown word `behavior`"),
    ("initial state Idle {", "initial Idle {", "MV001", "expected `state`"),
    ("run move then send(v)", "run then send(v)", "MV001", "expected a codel or a call after `run`"),
    ("run move then send(v)", "run move then send(v", "MV001", "expected `)` after `v`"),
    ("run move then send(v)", "run move then", "MV001", "expected a codel or a call after `then`"),
    ("run move then send(v)", "run move send(v)", "MV001", "expected"),
    ("-> Busy when", "=> Busy when", "MV001", "there is no `=>`"),
    ("-> Busy when", "Busy when", "MV001", "expected `->`"),
    ("ready and not ready", "ready && not ready", "MV001", "there is no `&&`"),
    ("ready and not ready", "ready and", "MV001", "expected a bool codel after `and`"),
    ("ready and not ready", "(ready and not ready", "MV001", "expected `)`"),
    ("ready and not ready", "ready == ready", "MV001", "`==`"),
    ("= act runs in caller", "= act in caller", "MV001", "expected `runs` before `in caller`"),
    ("period 10ms", "period 10", "MV004", "has no unit"),
    ("period 10ms", "period 10 ms", "MV001", "a unit stands against its number"),
    ("period 10ms", "perod 10ms", "MV001", "there is no execution attribute `perod`"),
    ("priority 3", "priority 3ms", "MV001", "a priority has no unit"),
    ("priority 3", "priority 3 priority 4", "MV001", "`priority` is given twice"),
    ("instance c: C", "instance c C", "MV001", "expected `:` between the instance and its component"),
    ("connect c.send -> d.send", "connect c.send d.send", "MV001", "expected `->` between the two ends"),
    ("buffered size 4", "buffered size 4B", "MV001", "expected a number without a unit"),
    ("buffered size 4", "size 4", "MV001", "`size` belongs to a buffered connection"),
    ('"arm7tdmi" at', "arm7tdmi-s at", "MV001", "expected a text in quotes"),
    ("icache off", "icache", "MV001", "expected"),
    ('binary "x.elf" {', "binary x.elf {", "MV001", "expected a text in quotes"),
    ('C.move = "c_move"', 'C.move "c_move"', "MV001", "expected `=` between the codel and its symbol"),
    ('loop "c.c:10" max 6', 'loop "c.c:10"', "MV001", "needs `max` or `total`"),
    ('loop "c.c:10" max 6', 'loop "c.c:10" max', "MV001", "expected a number after `max`"),
    ('loop "c.c:10" max 6', 'max 6', "MV001", "`max` follows a loop"),
    ('loop "c.c:10" max 6', 'assume "n"', "MV001", "needs either a range or `any`"),
    ('loop "c.c:10" max 6', 'assume "n" from 1 2', "MV001", "expected `to`"),
    ('loop "c.c:10" max 6', 'each 2B', "MV001", "`each` follows an assumption"),
]


def messages(text: str) -> tuple[ast.Module, list[Diagnostic]]:
    report = Report()
    return parse(SourceFile("f.mauve", text), report), report.sorted()


def lines(found: list[Diagnostic]) -> list[tuple[int, str]]:
    return [(d.primary.span.first.line if d.primary else 0, d.message) for d in found]


def test_the_sound_text_is_sound() -> None:
    module, found = messages(SOUND)
    assert (len(module.declarations), found) == (7, [])


@pytest.mark.parametrize(("right", "wrong", "code", "part"), PLANTED, ids=[p[1] for p in PLANTED])
def test_one_mistake_is_one_message_at_its_line(right: str, wrong: str, code: str, part: str) -> None:
    rows = SOUND.split("\n")
    line = next(number for number, row in enumerate(rows, 1) if right in row)
    rows[line - 1] = rows[line - 1].replace(right, wrong)
    module, found = messages("\n".join(rows))
    assert [row for row, _ in lines(found)] == [line], lines(found)
    assert found[0].code == code and part in found[0].message
    assert len(module.declarations) == 7


BRACES = [row for row, text in enumerate(SOUND.split("\n"), 1) if text.strip() == "}"]


@pytest.mark.parametrize("line", BRACES)
def test_a_missing_brace_is_one_message_at_the_brace_it_closes(line: int) -> None:
    rows = SOUND.split("\n")
    indent = rows[line - 1].index("}")
    opening = max(
        row for row, text in enumerate(rows[: line - 1], 1)
        if text.endswith("{") and len(text) - len(text.lstrip()) == indent
    )  # fmt: skip
    del rows[line - 1]
    module, found = messages("\n".join(rows))
    assert lines(found) == [(opening, "this `{` is not closed")]
    assert len(module.declarations) == 7


@pytest.mark.parametrize("line", BRACES)
def test_a_brace_too_many_is_one_message(line: int) -> None:
    rows = SOUND.split("\n")
    rows.insert(line - 1, rows[line - 1])
    _, found = messages("\n".join(rows))
    assert len(found) == 1 and line <= lines(found)[0][0], lines(found)


def test_mistakes_on_neighbouring_lines_are_all_reported() -> None:
    text = "mauve 1\ncomponent A {\n  out port b P\n  port in c: P\n  codel when reads a\n  behavior {\n  }\n}\n"
    assert [row for row, _ in lines(messages(text)[1])] == [3, 4, 5, 6]


def test_fixes_that_a_tool_may_apply_mend_the_text() -> None:
    for right, wrong, *_ in PLANTED:
        text = SOUND.replace(right, wrong, 1)
        found = messages(text)[1]
        help_ = found[0].help
        if help_ is None or not help_.edits or help_.applicability.value != "machine-applicable":
            continue
        for edit in sorted(help_.edits, key=lambda e: -e.span.start):
            text = text[: edit.span.start] + edit.text + text[edit.span.end :]
        if "port a: P" not in wrong or wrong.startswith("port in"):
            assert messages(text)[1] == [], wrong


@pytest.mark.parametrize("end", range(0, len(SOUND), 7))
def test_a_text_cut_anywhere_gives_few_messages_and_a_module(end: int) -> None:
    module, found = messages(SOUND[:end])
    assert len(found) <= 3
    assert isinstance(module, ast.Module)
    assert found or SOUND[:end].rstrip().endswith(("}", "1", "t"))


# ------------------------------------------------------------------------------------------------ other rules of form
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty"),
        ("\n\n  \n", "the file is empty"),
        ("package a\n", "the file does not begin with its language version"),
        ("mauve\npackage a\n", "the language version is a whole number"),
        ("mauve 1.5\n", "the language version is a whole number"),
        ("mauve 2\nnot ours {{{\n", "this file is written in version 2 of the language; this tool reads version 1"),
        ("mauve 0\n", "this file is written in version 0 of the language; this tool reads version 1"),
    ],
)
def test_the_first_line_states_the_version(text: str, message: str) -> None:
    found = messages(text)[1]
    assert [(d.code, d.message) for d in found] == [("MV003", message)]


def test_comments_may_come_before_the_version() -> None:
    assert messages("// licence\n\nmauve 1\n")[1] == []


def test_a_byte_order_mark_tabs_and_carriage_returns_are_white_space() -> None:
    assert messages("\ufeffmauve 1\r\n\tpackage a\r\n\r\nstruct A {\r\n\tx: f64\r\n}\r\n")[1] == []


CROWDED = [
    ("component A {\n  in port x: T  in port y: T  in port z: T\n  codel a\n}", 2),
    ("component A {\n  behaviour {\n    state S { run a } state T { run a }\n  }\n}", 3),
    ("component A {\n  behaviour {\n    state S {\n      run a -> S when b\n    }\n  }\n}", 4),
    ("architecture A {\n  instance a: B instance b: B\n}", 2),
    ("struct A { x: f64 } struct B { x: f64 }", 1),
]
ROOMY = [
    "component A { in port x: T  in port y: T }",
    "component A {\n  behaviour { state S { run a  -> S when b } }\n}",
    "component A {\n  behaviour o { start a  update b\n  stop c  cleanup d }\n}",
    "struct A {\n  x: f64  y: f64\n  z: f64\n}",
    "architecture A {\n  instance a: B { period 1ms\n    priority 3  deadline 1ms }\n}",
    "deployment D of A {\n  process n.p {\n    thread t { a  b\n      c  d }\n  }\n}",
    "component A {\n  behaviour {\n    state S { run a\n      -> S when b\n      -> T }\n  }\n}",
]


@pytest.mark.parametrize(("text", "line"), CROWDED)
def test_members_of_a_block_of_several_lines_do_not_share_a_line(text: str, line: int) -> None:
    found = messages("mauve 1\n" + text)[1]
    assert [(d.code, d.primary.span.first.line if d.primary else 0) for d in found] == [("MV006", line + 1)]
    fixed = "mauve 1\n" + text
    assert found[0].help is not None
    for edit in sorted(found[0].help.edits, key=lambda e: -e.span.start):
        fixed = fixed[: edit.span.start] + edit.text + fixed[edit.span.end :]
    assert messages(fixed)[1] == []


@pytest.mark.parametrize("text", ROOMY)
def test_lists_and_blocks_of_one_line_are_free(text: str) -> None:
    assert messages("mauve 1\n" + text)[1] == []


def test_numbers_and_nesting_have_limits() -> None:
    long = messages("mauve 1\ncomponent A { property x: u8 = " + "9" * 50 + " }")[1]
    assert [d.code for d in long] == ["MV007"]
    deep = messages("mauve 1\n" + "component A { property x: u8 = " + "[" * 5000 + "]" * 5000 + " }")[1]
    assert [d.code for d in deep] == ["MV008"]
    guard = "not " * 200 + "a"
    nested = messages(f"mauve 1\ncomponent A {{ behaviour {{ state S {{ -> S when {guard} }} }} }}")[1]
    assert [d.code for d in nested] == ["MV008"]
    chain = " and ".join(["a"] * 100)
    assert messages(f"mauve 1\ncomponent A {{ behaviour {{ state S {{ -> S when {chain} }} }} }}")[1] == []


def test_a_file_of_errors_is_given_up() -> None:
    found = messages("mauve 1\n" + "component A { in port x T }\n" * 200)[1]
    assert len(found) == 26 and "more than 25 syntax errors" in found[-1].message
