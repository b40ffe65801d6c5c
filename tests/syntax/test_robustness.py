"""Whatever the text: the parser answers, soon, with a module and located messages."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.diagnostics.diagnostic import Report
from mauve.diagnostics.rules import RULES
from mauve.source import SourceFile
from mauve.syntax import ast
from mauve.syntax.parse import parse
from mauve.syntax.print import format_ast
from mauve.syntax.table import load_table
from mauve.syntax.tokens import scan

DATA = Path(__file__).parent / "data"
VALID = [path.read_text(encoding="utf-8") for path in sorted(DATA.glob("*.mauve"))]
WORDS = [
    *load_table().words,
    *load_table().marks,
    *["x", "y.z", "10ms", "3", "4-way", '"s"', '"open', "0x1F", "// c\n", "/// d\n", "\n", ";", "@", "é", "=>", "'q'"],
]


def check(text: str) -> None:
    report = Report()
    file = SourceFile("f.mauve", text)
    module = parse(file, report)
    assert isinstance(module, ast.Module)
    assert format_ast(module).startswith("Module")
    for diagnostic in report:
        assert diagnostic.code in RULES
        assert diagnostic.primary is not None
        labels = [diagnostic.primary, *diagnostic.labels]
        assert all(0 <= label.span.start <= label.span.end <= len(text) for label in labels)
        if diagnostic.help:
            assert all(0 <= edit.span.start <= edit.span.end <= len(text) for edit in diagnostic.help.edits)


@given(st.text(max_size=200))
@settings(max_examples=150, deadline=None)
def test_any_text(text: str) -> None:
    check(text)


@given(st.lists(st.sampled_from(WORDS), max_size=60))
@settings(max_examples=200, deadline=None)
def test_any_mixture_of_words(words: list[str]) -> None:
    check("mauve 1\n" + " ".join(words))


@given(st.sampled_from(VALID), st.data())
@settings(max_examples=120, deadline=None)
def test_a_valid_file_with_a_few_changes(text: str, data: st.DataObject) -> None:
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        end = min(len(text), start + data.draw(st.integers(0, 30)))
        text = text[:start] + data.draw(st.sampled_from(["", " ", *WORDS])) + text[end:]
    check(text)


@pytest.mark.parametrize("text", VALID)
def test_spans_lie_inside_each_other(text: str) -> None:
    module = parse(SourceFile("f", text), Report())
    for declaration in module.declarations:
        assert declaration.span.start <= declaration.name.span.start < declaration.name.span.end <= declaration.span.end
        assert text[declaration.name.span.start : declaration.name.span.end] == declaration.name.text
        if not isinstance(declaration, ast.EnumDecl):
            assert declaration.span.text.endswith("}")


@pytest.mark.parametrize(
    ("prefix", "unit", "count"),
    [
        ("", "{", 200_000),
        ("", "}", 100_000),
        ("component A ", "state ", 60_000),
        ("component A {", "in port x: T;\n", 5_000),
        ("component A { behaviour { state S { -> S when ", "not ", 50_000),
        ("component A { behaviour { state S { -> S when ", "a and ", 50_000),
        ("", "/*", 100_000),
        ("", '"', 100_000),
        ("", " ", 1_000_000),
        ("struct A {\n", "state: T\n", 10_000),
        ("", "component A {\n", 5_000),
    ],
)
def test_repeated_text_takes_time_in_proportion(prefix: str, unit: str, count: int) -> None:
    text = "mauve 1\n" + prefix + unit * count
    begin = time.process_time()
    parse(SourceFile("f", text), Report())
    assert time.process_time() - begin < 5


def test_ten_thousand_lines_are_parsed_in_time() -> None:
    body = VALID[0].split("\n", 3)[3] + "\n"
    text = "mauve 1\npackage big\n" + body * (10_000 // body.count("\n") + 1)
    begin = time.process_time()
    module = parse(SourceFile("f", text), Report())
    assert time.process_time() - begin < 5
    assert text.count("\n") >= 10_000 and len(module.declarations) > 500


def test_comments_are_kept_apart() -> None:
    text = "// a\nmauve 1 // b\n/// c\npackage p\nenum E { A } /// d\n"
    scanned = scan(SourceFile("f", text), Report())
    assert [comment.text for comment in scanned.comments] == ["// a", "// b", "/// c", "/// d"]
    assert list(scanned.docs.values()) == ["c"]
