"""The parse table of the grammar: Lark builds it (LALR(1), see mauve.lark), a file of the user's cache keeps it.

Building takes a quarter of a second and loading the file a few milliseconds, without importing Lark. The file is plain
JSON and holds the grammar it was built from: a table of another grammar, or a damaged one, is built anew.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
from functools import cache
from pathlib import Path
from typing import Any

from mauve.records import record

FORMAT = 1
"""Changes whenever the meaning of the cached file changes."""


@record
class Table:
    """A deterministic parser.

    `patterns` are the terminals given by a regular expression, in the order in which they are tried; `words` and
    `marks` map the text of a keyword or of punctuation to its terminal. `actions[state][symbol]` is the next state
    when not negative, else `~rule`, to be reduced. A rule is the symbol it makes and how many symbols it takes.
    `symbols[state]` is the one symbol by which a state is entered. Parsing ends in `final`.
    """

    patterns: tuple[tuple[str, str], ...]
    words: dict[str, str]
    marks: dict[str, str]
    actions: tuple[dict[str, int], ...]
    rules: tuple[tuple[str, int], ...]
    symbols: tuple[str, ...]
    start: int
    final: int


def grammar_text() -> str:
    """The text of mauve.lark, wherever the package is installed."""
    return package_text("mauve.syntax", "mauve.lark")


def package_text(package: str, name: str) -> str:
    """A text file that is installed with a package, `/` between folders; OSError where there is none.

    Where files are only read, `importlib.resources` would import archives, temporary files and random numbers.
    """
    from pkgutil import get_data

    data = get_data(package, name)
    if data is None:
        raise FileNotFoundError(name)
    return data.decode("utf-8")


@cache
def load_table() -> Table:
    """The table of mauve.lark: from the cache where it is there and fits, else built (and kept, where possible)."""
    grammar = grammar_text()
    path = cache_path(grammar)
    found = read_cached(path, grammar) if path else None
    if found is not None:
        return found
    data = build(grammar)
    if path:
        write_cached(path, data)
    return from_json(data)


def cache_directory() -> Path | None:
    """Where caches live: MAUVEC_CACHE (empty: nowhere), else XDG_CACHE_HOME/mauvec, else ~/.cache/mauvec."""
    chosen = os.environ.get("MAUVEC_CACHE")
    if chosen is not None:
        return Path(chosen) if chosen else None
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(base) / "mauvec" if os.path.isabs(base) else None


def cache_path(grammar: str) -> Path | None:
    """The file that keeps the table of a grammar; None where nothing is to be kept."""
    from zlib import crc32

    folder = cache_directory()
    return folder / f"grammar-{FORMAT}-{crc32(grammar.encode()):08x}.json" if folder else None


def read_cached(path: Path, grammar: str) -> Table | None:
    """The cached table, or None where it is missing, damaged or of another grammar."""
    try:
        data = json.loads(path.read_bytes())
        if data["grammar"] != grammar or data["format"] != FORMAT:
            return None
        return from_json(data)
    except (OSError, ValueError, KeyError, TypeError, IndexError, AttributeError, RecursionError):
        return None


def write_cached(path: Path, data: dict[str, Any]) -> None:
    """Write the table so that a reader sees all of it or nothing; a directory that cannot be written is no error."""
    from tempfile import NamedTemporaryFile

    temporary = ""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with NamedTemporaryFile("w", encoding="utf-8", dir=path.parent, prefix=".grammar-", delete=False) as file:
            temporary = file.name
            json.dump(data, file, separators=(",", ":"))
        os.replace(temporary, path)
    except OSError:
        if temporary:
            with contextlib.suppress(OSError):
                os.unlink(temporary)


def from_json(data: dict[str, Any]) -> Table:
    """The table that `build` wrote down. Raises KeyError, TypeError, IndexError or ValueError where it is damaged."""
    names: list[str] = data["names"]
    return Table(
        patterns=tuple((name, pattern) for name, pattern in data["patterns"]),
        words=dict(data["words"]),
        marks=dict(data["marks"]),
        actions=tuple({names[symbol]: action for symbol, action in row} for row in data["actions"]),
        rules=tuple((names[symbol], size) for symbol, size in data["rules"]),
        symbols=tuple(names[symbol] for symbol in data["symbols"]),
        start=data["start"],
        final=data["final"],
    )


def build(grammar: str) -> dict[str, Any]:
    """Let Lark build the table and write it down in plain lists, strings and numbers."""
    from lark import Lark
    from lark.grammar import Rule
    from lark.lexer import TerminalDef

    lark = Lark(grammar, parser="lalr", lexer="contextual")
    frozen, memo = lark.memo_serialize([TerminalDef, Rule])
    tables = frozen["parser"]["parser"]
    rules = sorted(key for key, entry in memo.items() if entry["__type__"] == "Rule")
    terminals = [entry for entry in memo.values() if entry["__type__"] == "TerminalDef"]
    number = {key: position for position, key in enumerate(rules)}

    names = list(tables["tokens"].values())
    index = {name: position for position, name in enumerate(names)}
    states = sorted(tables["states"])
    row_of = {state: position for position, state in enumerate(states)}
    symbols = [0] * len(states)
    actions: list[list[list[int]]] = []
    for state in states:
        row = []
        for token, (kind, target) in tables["states"][state].items():
            symbol = index[tables["tokens"][token]]
            if kind:
                row.append([symbol, ~number[target["@"]]])
            else:
                row.append([symbol, row_of[target]])
                symbols[row_of[target]] = symbol
        actions.append(row)
    return {
        "format": FORMAT,
        "grammar": grammar,
        "names": names,
        "actions": actions,
        "symbols": symbols,
        "rules": [[index[memo[key]["origin"]["name"]], len(memo[key]["expansion"])] for key in rules],
        "start": row_of[tables["start_states"]["start"]],
        "final": row_of[tables["end_states"]["start"]],
        **_terminals(terminals, {name for name in names if name.isupper()}),
    }


def _terminals(terminals: list[dict[str, Any]], used: set[str]) -> dict[str, Any]:
    """Regular expressions by priority, keywords, and punctuation with the longest first."""
    fixed = {t["pattern"]["value"]: t["name"] for t in terminals if t["pattern"]["__type__"] == "PatternStr"}
    regular = [t for t in terminals if t["pattern"]["__type__"] == "PatternRE" and t["name"] in used]
    regular.sort(key=lambda t: -t["priority"])
    marks = sorted((text for text in fixed if not re.fullmatch(r"\w+", text)), key=lambda text: (-len(text), text))
    return {
        "patterns": [[t["name"], t["pattern"]["value"]] for t in regular],
        "words": {text: name for text, name in fixed.items() if re.fullmatch(r"\w+", text)},
        "marks": {text: fixed[text] for text in marks},
    }
