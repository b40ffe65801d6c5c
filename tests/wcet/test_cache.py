"""The cache gives back what was put in, depends on everything that matters, and is never the reason for a failure."""

from __future__ import annotations

import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from mauve.records import changed
from mauve.wcet.cache import Cache, cache_path, decode, encode, result_key
from mauve.wcet.flow.facts import AtLine, Counting, LoopFact
from mauve.wcet.hardware.board import Board, Memory
from mauve.wcet.result import BlockResult, CallResult, LoopResult, Origin, Problem, ProblemKind, WcetResult

FULL = WcetResult(
    name="f",
    address=0x8000,
    cycles=10**15,
    time=5 * 10**18,
    blocks=(BlockResult(0x8000, 12, "f", 7, 9, "f.c:3", 60),),
    loops=(
        LoopResult(0x8004, "f", "f.c:4", 11, 55, Origin.ANNOTATION, "fact", "main>f"),
        LoopResult(0x8008, "f", "", None, None, None),
    ),
    calls=(CallResult("g", 0x9000, 3, 17),),
    notes=(Problem(ProblemKind.LOOP, "text", 0x8004, "f", "f.c:4", ("f",), ("try this",), "robot.mauve:3"),),
    assumptions=("one", "two"),
    stack=48,
    seconds=0.25,
)
FAILED = WcetResult("g", None, None, None, problems=(Problem(ProblemKind.SYMBOL, "no such function"),))
BOARD = Board("b", "arm7tdmi", 1000, (Memory("ram", 0, 16, 1),))


@pytest.mark.parametrize("result", [FULL, FAILED])
def test_results_come_back_as_they_were(tmp_path: Path, result: WcetResult) -> None:
    assert decode(encode(result)) == result
    cache = Cache(tmp_path / "deep" / "cache.sqlite")
    assert cache.get("key") is None
    cache.put("key", result)
    cache.put("other", FULL)
    assert Cache(cache.path).get("key") == result
    cache.clear()
    assert cache.get("key") is None


def test_the_key_depends_on_everything() -> None:
    fact = LoopFact(AtLine("f.c", 3), 6, Counting.BODY)
    keys = [
        result_key("hash", "f", BOARD, (), False),
        result_key("hash2", "f", BOARD, (), False),
        result_key("hash", "g", BOARD, (), False),
        result_key("hash", 0x8000, BOARD, (), False),
        result_key("hash", "f", changed(BOARD, hertz=2000), (), False),
        result_key("hash", "f", changed(BOARD, memories=(Memory("ram", 0, 16, 2),)), (), False),
        result_key("hash", "f", BOARD, (fact,), False),
        result_key("hash", "f", BOARD, (changed(fact, maximum=7),), False),
        result_key("hash", "f", BOARD, (), True),
    ]
    assert len(set(keys)) == len(keys)
    assert keys[0] == result_key("hash", "f", BOARD, (), False)


def test_a_damaged_or_foreign_file_is_no_cache(tmp_path: Path) -> None:
    path = tmp_path / "cache.sqlite"
    path.write_bytes(b"this is no database, whatever its name says" * 100)
    cache = Cache(path)
    cache.put("key", FULL)
    assert cache.get("key") is None
    other = tmp_path / "other.sqlite"
    with sqlite3.connect(other) as database:
        database.execute("CREATE TABLE results (key TEXT PRIMARY KEY, value TEXT, used INTEGER)")
        database.execute("INSERT INTO results VALUES ('key', '{\"name\": 3}', 0)")
    assert Cache(other).get("key") is None


def test_a_place_that_cannot_be_written_is_no_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    cache = Cache(tmp_path / "file" / "cache.sqlite")
    cache.put("key", FULL)
    assert cache.get("key") is None


def test_the_least_used_results_go_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mauve.wcet.cache.MOST_RESULTS", 3)
    cache = Cache(tmp_path / "cache.sqlite")
    for number in range(6):
        monkeypatch.setattr("mauve.wcet.cache.time.time", lambda number=number: 1000.0 + number)
        cache.put(f"key{number}", FULL)
    assert [cache.get(f"key{number}") is not None for number in range(6)] == [False] * 3 + [True] * 3


def test_processes_share_a_file(tmp_path: Path) -> None:
    path = tmp_path / "cache.sqlite"
    code = (
        "import sys; from pathlib import Path\n"
        "from mauve.wcet.cache import Cache; from mauve.wcet.result import WcetResult\n"
        "cache = Cache(Path(sys.argv[1]))\n"
        "for n in range(30): cache.put(f'{sys.argv[2]}-{n}', WcetResult(sys.argv[2], n, n, n))\n"
    )
    running = [subprocess.Popen([sys.executable, "-c", code, str(path), name]) for name in ("a", "b")]
    assert [process.wait(timeout=60) for process in running] == [0, 0]
    cache = Cache(path)
    assert all(cache.get(f"{name}-{n}") == WcetResult(name, n, n, n) for name in "ab" for n in range(30))


def test_where_the_file_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MAUVEC_CACHE", "/some/where")
    assert cache_path() == Path("/some/where/wcet.sqlite")
    monkeypatch.delenv("MAUVEC_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", "/cache")
    assert cache_path() == Path("/cache/mauvec/wcet.sqlite")
