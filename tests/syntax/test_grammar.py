from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from lark import Lark

from mauve.diagnostics.diagnostic import Report
from mauve.source import SourceFile
from mauve.syntax import table as tables
from mauve.syntax.actions import ACTIONS
from mauve.syntax.machine import RESERVED
from mauve.syntax.parse import parse
from mauve.syntax.print import format_ast
from mauve.syntax.table import build, cache_path, from_json, grammar_text, load_table, read_cached, write_cached

DATA = Path(__file__).parent / "data"
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def strict() -> Lark:
    """Strict mode refuses any conflict of rules and any collision of terminals."""
    return Lark(grammar_text(), parser="lalr", lexer="contextual", strict=True)


def test_the_grammar_has_no_conflict(strict: Lark) -> None:
    assert strict.parse("mauve 1\npackage a\n") is not None


def test_the_published_grammar_is_the_one_in_use() -> None:
    assert (ROOT / "grammar" / "mauve.lark").read_text(encoding="utf-8") == grammar_text()


@pytest.mark.parametrize("path", sorted([*DATA.glob("*.mauve"), *(ROOT / "mauve" / "std").glob("*.mauve")]), ids=str)
def test_our_machine_and_lark_accept_the_same_files(path: Path, strict: Lark) -> None:
    text = path.read_text(encoding="utf-8")
    report = Report()
    parse(SourceFile(path.name, text), report)
    assert strict.parse(text) is not None
    assert report.diagnostics == []


def test_each_rule_has_an_action_or_passes_its_only_child_on() -> None:
    rules = load_table().rules
    assert [rule for rule in rules if rule[0] not in ACTIONS and not rule[0].startswith("__") and rule[1] != 1] == []
    assert set(ACTIONS) <= {name for name, _ in rules}


EVERYWHERE = """mauve 1
package {w}
import {w}.{w} as {w}
struct {w} {{ {w}, {w}: {w} {w}: {w}.{w}[2] }}
enum {w} {{ {w}, {w} }}
component {w} {{
  in port {w}: {w}
  event {w}, {w}
  property {w}: {w} = {w}
  var {w}: {w}
  operation {w}({w}: {w}): {w} = {w} runs in caller
  method {w}({w}: {w}): {w}
  init codel {w} reads {w}, {w} writes {w} returns {w} wcet 1ms symbol "s"
  behaviour {{
    region {w} {{
      initial state {w} {{
        entry {w} then {w} = {w}({w}, {w}) once, at least 1ms apart
        run {w} every 1ms
        -> {w} on {w} when {w} and not ({w} or {w}) after 1ms do {w} then {w}({w}) emit {w}, {w}
        -> {w}
      }}
    }}
  }}
}}
component {w} {{
  behaviour {w}.{w} {{ {w} {w} then {w} {w} {w} = {w}() }}
}}
lifecycle {w} {{
  hook {w}, {w}
  state {w} {{ run {w} }}
}}
architecture {w} {{
  instance {w}: {w}.{w} {{ period 1ms priority 3 {w} = {w} {w} = {{ {w}: {w} }} {w} = [{w}] }}
  connect {w}.{w} -> {w}.{w}, {w} buffered size 2 drop oldest initial {w}
  external {w}.{w}, {w}
}}
board {w} {{
  memory {w} at 0x0 size 1KiB wait 1cycles write wait 2cycles
  os {w} {{ context_switch 1us tick every 1ms cost 1us }}
}}
abstract deployment {w} of {w} extends {w} {{
  node {w} on {w} {{
    interrupt {w} every 1ms wcet 1us
    binary "b" {{
      {w}.{w} = "s"
      {w} = "s"
      loop "f.c:1" max 2 total 3
      {w}.{w}.{w} = "s"
      facts "f"
    }}
    assume {w}.{w}, {w} wcet 1us
    schedule {w} preemptive
    process {w} {{
      lock {w}
      exchange {w} 1us
      thread {w} priority 1 {{ {w} {w}.{w} }}
    }}
  }}
  process {w}.{w} {{ thread {w} {{ {w} }} }}
}}
hardware {w}: {w} may fail, may recover
hardware {w}
resource {w}: {w}.{w} shared
activity {w} {{
  consumes {w}, {w}
  produces {w}
  runs {w}.{w}
  mode {w} = state {w}.{w}
  alternative {w} {{ consumes {w} mode {w} }}
  alternative {w} priority 2 {{ }}
  on recovery upgrade
}}
objective {w} {{ does {w}, {w} timeout 1min -> failure }}
objective {w} {{ {w} }}
objective {w} {{ {w} ; {w} on failure recover {{ {w} ; }} continue ; parallel {w} {{ mandatory {w} optional {w} }} ; }}
mission {w} {{
  {w} ;
  {w} on failure retry 3 ;
  parallel {{ optional {w} on failure continue }} ;
  check live, bounded, success reachable with at most 1 of {w}, {w} out of service, deterministic
  check ltl {w}: always (running({w}.{w}) until active({w}) implies not out_of_service({w}) or true)
  report cuts
  generate controller runs {w} {{ period 1ms priority 3 wcet 1us }}
  accepts single failure of {w}, {w}
}}
mission {w} {{
  {w}
  check success reachable with at most 1 out of service
  generate controller
}}
"""


@pytest.mark.parametrize("word", sorted(set(load_table().words) - RESERVED))
def test_a_word_of_the_language_is_a_name_wherever_one_is_expected(word: str) -> None:
    report, plain = Report(), Report()
    module = parse(SourceFile("f", EVERYWHERE.format(w=word)), report)
    usual = parse(SourceFile("f", EVERYWHERE.format(w="zebra")), plain)
    assert [d.message for d in report] == []
    assert len(format_ast(module).splitlines()) == len(format_ast(usual).splitlines())


@pytest.mark.parametrize("word", sorted(RESERVED))
def test_a_reserved_word_is_no_name(word: str) -> None:
    report = Report()
    module = parse(SourceFile("f", f"mauve 1\ncomponent A {{\n  codel {word} reads x\n  codel b\n}}\n"), report)
    assert [(d.code, d.primary.span.text if d.primary else "") for d in report] == [("MV005", word)]
    assert len(module.declarations) == 1


# ------------------------------------------------------------------------------------------------ the cached table
def test_the_table_survives_the_cache(tmp_path: Path) -> None:
    grammar = grammar_text()
    data = build(grammar)
    path = tmp_path / "deep" / "table.json"
    write_cached(path, data)
    assert read_cached(path, grammar) == from_json(data)
    assert [entry.name for entry in path.parent.iterdir()] == ["table.json"]


@pytest.mark.parametrize("damage", [b"", b"{", b"[1]", b"null", b'{"grammar": 1}', b"\xff\xfe", b"[" * 5000])
def test_a_damaged_cache_is_no_cache(tmp_path: Path, damage: bytes) -> None:
    path = tmp_path / "table.json"
    path.write_bytes(damage)
    assert read_cached(path, grammar_text()) is None


def test_a_truncated_or_foreign_table_is_no_cache(tmp_path: Path) -> None:
    data = build(grammar_text())
    path = tmp_path / "table.json"
    path.write_text(json.dumps({**data, "grammar": "another"}), encoding="utf-8")
    assert read_cached(path, grammar_text()) is None
    path.write_text(json.dumps({k: v for k, v in data.items() if k != "rules"}), encoding="utf-8")
    assert read_cached(path, grammar_text()) is None


def test_a_directory_that_cannot_be_written_is_no_error(tmp_path: Path) -> None:
    occupied = tmp_path / "file"
    occupied.write_text("")
    write_cached(occupied / "table.json", {"a": 1})
    assert occupied.read_text() == ""


def test_where_the_cache_is(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("MAUVEC_CACHE", str(tmp_path))
    found = cache_path("g")
    assert found is not None and found.parent == tmp_path
    monkeypatch.setenv("MAUVEC_CACHE", "")
    assert cache_path("g") is None
    monkeypatch.delenv("MAUVEC_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert tables.cache_directory() == tmp_path / "mauvec"


def test_importing_the_parser_does_not_import_lark() -> None:
    import subprocess
    import sys

    program = "import sys, mauve.syntax.parse, mauve.syntax.load; print('lark' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, env=os.environ)
    assert done.stdout.strip() == "False"
