from __future__ import annotations

import re
from pathlib import Path

import pytest

from mauve.diagnostics.diagnostic import Report
from mauve.source import SourceFile
from mauve.syntax import ast
from mauve.syntax.machine import RESERVED
from mauve.syntax.parse import parse
from mauve.syntax.print import format_ast
from mauve.syntax.table import load_table

ROOT = Path(__file__).resolve().parents[2]
DATA = Path(__file__).parent / "data"
PAGES = ("language.md", "missions.md")
REFERENCE = "\n".join((ROOT / "docs" / "reference" / page).read_text(encoding="utf-8") for page in PAGES)
EXAMPLES = re.findall(r"```mauve\n(.*?)```", REFERENCE, re.S)


def sound(text: str) -> ast.Module:
    report = Report()
    module = parse(SourceFile("f.mauve", text), report)
    assert [d.message for d in report] == []
    return module


@pytest.mark.parametrize("text", EXAMPLES)
def test_the_examples_of_the_reference_are_valid(text: str) -> None:
    assert sound(text).version == 1


def test_the_reference_shows_each_word_of_the_language() -> None:
    shown = set(re.findall(r"\w+", " ".join(EXAMPLES) + " ".join(re.findall(r"`([^`\n]*)`", REFERENCE))))
    assert set(load_table().words) - shown == set()
    assert all(word in REFERENCE for word in RESERVED)


@pytest.mark.parametrize("name", ["ttrk", "auv"])
def test_whole_files_have_the_expected_tree(name: str) -> None:
    text = (DATA / f"{name}.mauve").read_text(encoding="utf-8")
    assert format_ast(sound(text)) == (DATA / f"{name}.ast").read_text(encoding="utf-8")


TREES = [
    (
        "component A {\n  /// first\n  /// second\n  in port x: T[2][0x3]  /// not this one\n  event port, Done\n}",
        """
Module version=1
  ComponentDecl name=A kind=active
    PortDecl kind=in name=x type=T[2][0x3] doc='first\\nsecond'
    EventDecl names=[port, Done]
""",
    ),
    (
        "component A { behaviour { state S {\nrun a then r = b(x, y) then c() once\n"
        "-> T when not a or b and (c or d) } } }",
        """
Module version=1
  ComponentDecl name=A kind=active
    behaviour: Machine
      RegionDecl
        StateDecl name=S
          Activity role=run steps=[a, r=b(x,y), c()] timing=once()
          Transition target=T guard=((not a) or (b and (c or d)))
""",
    ),
    (
        "architecture A {\n  connect a.b -> c.d buffered size 4 drop newest initial [OK, { x: true }]\n}",
        """
Module version=1
  ArchitectureDecl name=A
    ConnectDecl source=a.b targets=[c.d]
      policy: Policy buffered size=4 overflow=drop_newest initial=[OK, {x: true}]
""",
    ),
    (
        "deployment D of A {\n  expect unschedulable\n"
        '  node n on "b" { binary "e" { loop "s" + 0x10 max 3 total 9 } }\n}',
        """
Module version=1
  DeploymentDecl name=D architecture=A expect_unschedulable
    NodeDecl name=n board='b'
      BinaryDecl path='e'
        LoopFactDecl place='s'+0x10 maximum=3 total=9
""",
    ),
]


@pytest.mark.parametrize(("text", "tree"), TREES)
def test_constructs_have_the_expected_tree(text: str, tree: str) -> None:
    assert format_ast(sound("mauve 1\n" + text)) == tree.lstrip("\n")


def test_values_of_leaves() -> None:
    members = 'property a: T = "q\\"\\\\n\\n\\t"  property b: T = 5\u03bcs  property c: T = 007'
    module = sound(f"mauve 1\ncomponent A {{ {members} }}")
    (component,) = module.declarations
    assert isinstance(component, ast.ComponentDecl)
    a, b, c = (member.default for member in component.members if isinstance(member, ast.PropertyDecl))
    assert isinstance(a, ast.String) and a.value == 'q"\\n\n\t'
    assert isinstance(b, ast.Quantity) and (b.number, b.unit) == ("5", "\u00b5s")
    assert isinstance(c, ast.Number) and c.integer == 7


def test_the_documentation_of_a_file_is_that_before_its_package() -> None:
    assert sound("mauve 1\n/// about\npackage a\n/// b\nenum E { A }").doc == "about"
