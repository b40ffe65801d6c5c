"""Every rule has a page, every page a rule, and every rule a test that shows its message."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from markdown_cases import cases

from mauve.diagnostics.explain import explanation, headline, near, rule_code
from mauve.diagnostics.rules import RULES

TESTS = Path(__file__).resolve().parents[1]
PAGES = TESTS.parent / "mauve" / "diagnostics" / "pages"
CODE = re.compile(r"\bMV\d{3}\b")


@pytest.mark.parametrize("code", RULES)
def test_a_rule_has_a_page_with_a_headline_three_parts_and_an_example(code: str) -> None:
    page = explanation(code)
    assert page is not None, f"write mauve/diagnostics/pages/{code}.md"
    title, *_ = page.split("\n")
    assert title.startswith(f"# {code} {RULES[code].slug}: ")
    assert (headline(code) or "").endswith(".")
    assert re.findall(r"^## (.*)$", page, re.M) == ["What it means", "Why it matters", "Example and remedy"]
    parts = re.split(r"^## .*$", page, flags=re.M)[1:]
    assert all(part.strip() for part in parts)
    assert parts[2].count("\n```") >= 2, "an example in a fenced block"
    assert "?" not in re.sub(r"```.*?```", "", page, flags=re.S), "a page states, it does not ask"
    assert set(CODE.findall(page)) <= set(RULES)


def test_a_page_has_a_rule() -> None:
    assert {path.name for path in PAGES.iterdir()} == {f"{code}.md" for code in RULES}


def test_codes_and_slugs_are_unique_and_codes_name_a_phase() -> None:
    slugs = [rule.slug for rule in RULES.values()]
    assert len(set(slugs)) == len(slugs)
    assert all(code == rule.code and re.fullmatch(r"MV[0-9]\d\d", code) for code, rule in RULES.items())
    assert all(re.fullmatch(r"[a-z]+(-[a-z]+)*", slug) for slug in slugs)


def test_a_rule_is_found_by_code_in_any_case_and_by_slug() -> None:
    assert rule_code("mv201") == rule_code(" MV201") == rule_code("type-mismatch") == "MV201"
    assert explanation("type-mismatch") == explanation("MV201")
    assert explanation("MV999") is None and explanation("../rules") is None


def test_an_unknown_code_has_near_ones() -> None:
    assert "MV201" in near("MV2O1")
    assert near("type-mismach") == ("MV201",)
    assert near("zebra crossing") == ()


def _strings(tree: ast.AST) -> Iterator[str]:
    """The string literals of a test file that are compared or fed to a test: all but the docstrings."""
    for node in ast.walk(tree):
        for child in ast.iter_child_nodes(node):
            if isinstance(node, ast.Expr) and isinstance(child, ast.Constant):
                continue
            if isinstance(child, ast.Constant) and isinstance(child.value, str):
                yield child.value


def codes_with_a_test() -> set[str]:
    """Codes in the messages that Markdown cases expect, and in the rooms' tests (renderers use codes as samples)."""
    found: set[str] = set()
    for page in (TESTS / "check").rglob("*.md"):
        for case in cases(page.read_text(encoding="utf-8")):
            found.update(CODE.findall(case.expected))
    for path in TESTS.rglob("test_*.py"):
        if path.parent in (TESTS / "diagnostics", TESTS / "packaging") or path.name == "test_markdown_cases.py":
            continue
        for text in _strings(ast.parse(path.read_text(encoding="utf-8"))):
            found.update(CODE.findall(text))
    return found


def test_a_rule_has_a_test() -> None:
    assert sorted(set(RULES) - codes_with_a_test()) == []


def test_a_code_that_the_sources_use_is_a_rule() -> None:
    used = {
        (code, path.name)
        for path in (TESTS.parent / "mauve").rglob("*.py")
        for code in CODE.findall(path.read_text(encoding="utf-8"))
    }
    assert {(code, name) for code, name in used if code not in RULES} == set()


def test_diagnostics_import_nothing_beyond_the_standard_library() -> None:
    program = (
        "import sys; before = set(sys.modules); import mauve.diagnostics.diagnostic, mauve.diagnostics.render_full\n"
        "import mauve.diagnostics.render, mauve.diagnostics.explain, mauve.diagnostics.allow\n"
        "new = {name.split('.')[0] for name in set(sys.modules) - before} - {'mauve'}\n"
        "print(sorted(new - set(sys.stdlib_module_names)), 'json' in new, 'importlib.resources' in sys.modules)"
    )
    ran = subprocess.run(
        [
            sys.executable,
            "-I",
            "-c",
            f"sys_path={str(TESTS.parent)!r}\nimport sys\nsys.path.insert(0, sys_path)\n{program}",
        ],
        capture_output=True,
        text=True,
    )
    assert ran.stdout.split("\n")[0] == "[] False False", ran.stderr
