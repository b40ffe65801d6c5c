"""Collects every tests/check/**/*.md as tests; markdown_cases.py says what a page may contain.

To accept the messages as printed: `pytest tests/check --rewrite-messages` (or MAUVEC_REWRITE_MESSAGES=1), then read the
difference that version control shows.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from markdown_cases import Case, cases, difference, rewritten, run

ROOT = Path(__file__).resolve().parents[2]


class MessagesDiffer(Exception):
    """The command printed other messages than the page says."""


class MarkdownFile(pytest.File):
    def collect(self) -> Iterator[pytest.Item]:
        for case in cases(self.path.read_text(encoding="utf-8")):
            yield MarkdownItem.from_parent(self, name=case.name, case=case)


class MarkdownItem(pytest.Item):
    def __init__(self, *, case: Case, **rest: object) -> None:
        super().__init__(**rest)  # type: ignore[arg-type]
        self.case = case

    def runtest(self) -> None:
        from mauve.cli import main

        with tempfile.TemporaryDirectory() as folder:
            code, printed = run(self.case, main, Path(folder), ROOT)
        if wants_rewrite(self.config):
            page = self.path.read_text(encoding="utf-8")
            self.path.write_text(rewritten(page, self.case.block, printed), encoding="utf-8")
            return
        problem = difference(self.case, code, printed)
        if problem:
            raise MessagesDiffer(problem)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: object = None) -> object:
        if isinstance(excinfo.value, MessagesDiffer):
            return f"{self.path}:{self.case.line}: {self.name}\n{excinfo.value}"
        return super().repr_failure(excinfo)

    def reportinfo(self) -> tuple[Path, int, str]:
        return self.path, self.case.line - 1, self.name


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--rewrite-messages", action="store_true", help="write the printed messages into the pages")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> MarkdownFile | None:
    if file_path.suffix == ".md":
        return MarkdownFile.from_parent(parent, path=file_path)
    return None


def wants_rewrite(config: pytest.Config) -> bool:
    return bool(config.getoption("--rewrite-messages", default=False)) or "MAUVEC_REWRITE_MESSAGES" in os.environ
