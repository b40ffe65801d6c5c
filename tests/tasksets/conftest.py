"""What the tests of task sets share: the command, run inside this process."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from mauve.cli import main


@dataclass(frozen=True)
class Run:
    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


Schedule = Callable[..., Run]


@pytest.fixture
def schedule(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Schedule:
    """Write a set (text, or a document for JSON) to a file of a name, and run `mauvec schedule` on it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("MAUVEC_TRACEBACK", raising=False)

    def run(content: object, *options: str, name: str = "tasks.json") -> Run:
        text = content if isinstance(content, str) else json.dumps(content)
        Path(name).write_text(text, encoding="utf-8")
        capsys.readouterr()
        code = main(["schedule", name, *options])
        captured = capsys.readouterr()
        return Run(code, captured.out, captured.err)

    return run
