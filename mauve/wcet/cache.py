"""Results kept between runs: one SQLite file, keyed by the hash of everything a result depends on.

The file may be shared by processes and survives being killed (each result is one transaction). A cache that cannot be
read or written is no error: the analysis runs again.
"""

from __future__ import annotations

import json
import os
import sqlite3
import time
from contextlib import closing, suppress
from enum import Enum
from functools import lru_cache
from hashlib import sha256
from importlib import resources
from pathlib import Path
from typing import Any

from mauve import __version__
from mauve.records import field_names, is_record
from mauve.wcet.flow.facts import Fact
from mauve.wcet.hardware.board import Board
from mauve.wcet.result import (
    BlockResult,
    BranchResult,
    CallResult,
    ExclusiveResult,
    GlobalUse,
    LoopResult,
    Origin,
    Problem,
    ProblemKind,
    WcetResult,
)

MOST_RESULTS = 5000
"""Results kept; the ones unused for longest go first."""

REFRESH_SECONDS = 86_400
"""A result that is used again is marked so at most once in this time: reading does not write."""

WAIT_SECONDS = 5.0
"""How long to wait for another process that writes."""


def cache_path() -> Path:
    """The cache file wcet.sqlite in the directory `MAUVEC_CACHE` (empty: nothing is kept), else in `mauvec` in the XDG
    cache directory."""
    given = os.environ.get("MAUVEC_CACHE")
    if given is not None:
        return Path(given or os.devnull, "wcet.sqlite")  # below the null device no file is ever found or made
    home = os.environ.get("XDG_CACHE_HOME")
    return (Path(home) if home else Path.home() / ".cache") / "mauvec" / "wcet.sqlite"


def result_key(
    binary: str, function: str | int, board: Board, facts: tuple[Fact, ...], initial_data: bool
) -> str:
    """The key of a result: the hash of the executable's hash, the function, board, facts, options and the tool
    itself."""
    parts = (tool_state(), binary, function, repr(board), repr(facts), initial_data)
    return sha256(json.dumps(parts).encode()).hexdigest()


_TABLE = "CREATE TABLE IF NOT EXISTS results (key TEXT PRIMARY KEY, value TEXT NOT NULL, used INTEGER NOT NULL)"
_TRIM = "DELETE FROM results WHERE key IN (SELECT key FROM results ORDER BY used DESC LIMIT -1 OFFSET ?)"


class Cache:
    """An open cache file. Every method is safe when the file is missing, locked or damaged."""

    def __init__(self, path: Path | None = None) -> None:
        """The cache at `path`, created on the first write."""
        self.path = path or cache_path()

    def get(self, key: str) -> WcetResult | None:
        """The result kept under a key."""
        text = self.get_text(key)
        if text is not None:
            with suppress(ValueError, KeyError, TypeError):
                return decode(json.loads(text))
        return None

    def put(self, key: str, result: WcetResult) -> None:
        """Keep a result."""
        self.put_text(key, json.dumps(encode(result), separators=(",", ":")))

    def get_text(self, key: str) -> str | None:
        """The text kept under a key."""
        if not self.path.is_file():
            return None
        with suppress(sqlite3.Error), closing(self._open()) as database:
            row = database.execute("SELECT value, used FROM results WHERE key = ?", (key,)).fetchone()
            if row is not None:
                now = int(time.time())
                if now - row[1] > REFRESH_SECONDS:
                    with suppress(sqlite3.Error), database:
                        database.execute("UPDATE results SET used = ? WHERE key = ?", (now, key))
                return str(row[0])
        return None

    def put_text(self, key: str, text: str) -> None:
        """Keep a text."""
        with suppress(sqlite3.Error, OSError):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with closing(self._open()) as database, database:
                database.execute(_TABLE)
                database.execute("INSERT OR REPLACE INTO results VALUES (?, ?, ?)", (key, text, int(time.time())))
                database.execute(_TRIM, (MOST_RESULTS,))

    def clear(self) -> None:
        """Forget everything."""
        with suppress(OSError):
            self.path.unlink(missing_ok=True)

    def _open(self) -> sqlite3.Connection:
        return sqlite3.connect(self.path, timeout=WAIT_SECONDS)


@lru_cache(maxsize=1)
def tool_state() -> str:
    """The version of the tool and the state of the engine's own files: a changed analysis never answers from old
    results."""
    marks = [__version__]
    waiting = [resources.files("mauve.wcet")]
    while waiting:
        for entry in sorted(waiting.pop().iterdir(), key=lambda e: e.name):
            if entry.is_dir():
                waiting.append(entry)
            elif entry.name.endswith((".py", ".toml")):
                with suppress(OSError, TypeError):
                    state = os.stat(str(entry))
                    marks.append(f"{entry.name} {state.st_size} {state.st_mtime_ns}")
    return sha256("\n".join(marks).encode()).hexdigest()


# -------------------------------------------------------------------------------------------------------- values
def encode(result: WcetResult) -> dict[str, Any]:
    """A result as plain JSON values."""
    return {name: _plain(getattr(result, name)) for name in field_names(result)}


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    if is_record(value):
        return {name: _plain(getattr(value, name)) for name in field_names(value)}
    return value.value if isinstance(value, Enum) else value


def decode(data: dict[str, Any]) -> WcetResult:
    """The result that `encode` wrote; KeyError, TypeError or ValueError for anything else."""
    fields = dict(data)
    fields["blocks"] = tuple(BlockResult(**block) for block in data["blocks"])
    fields["loops"] = tuple(_loop(loop) for loop in data["loops"])
    fields["calls"] = tuple(CallResult(**call) for call in data["calls"])
    fields["problems"] = tuple(_problem(problem) for problem in data["problems"])
    fields["notes"] = tuple(_problem(problem) for problem in data["notes"])
    fields["assumptions"] = tuple(data["assumptions"])
    fields["globals"] = tuple(GlobalUse(**use) for use in data["globals"])
    fields["exclusive"] = tuple(_exclusive(group) for group in data["exclusive"])
    return WcetResult(**fields)


def _exclusive(data: dict[str, Any]) -> ExclusiveResult:
    return ExclusiveResult(**{**data, "branches": tuple(BranchResult(**branch) for branch in data["branches"])})


def _loop(data: dict[str, Any]) -> LoopResult:
    origin = data["origin"]
    return LoopResult(**{**data, "origin": None if origin is None else Origin(origin)})


def _problem(data: dict[str, Any]) -> Problem:
    lists = {name: tuple(data[name]) for name in ("call_path", "suggestions")}
    return Problem(**{**data, **lists, "kind": ProblemKind(data["kind"])})
