"""The source files that an executable was built from, as its debug information names them."""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path

from mauve.wcet.cache import Cache, tool_state


def source_files(binary: str | Path, cache: Cache | None = None) -> tuple[str, ...]:
    """The paths of all sources and headers with code in the line table, as written there; empty where there are none.

    Kept in the cache, so that an unchanged executable is not parsed again. An unreadable executable has no sources.
    """
    try:
        data = Path(binary).read_bytes()
    except OSError:
        return ()
    key = sha256(f"sources {tool_state()} {sha256(data).hexdigest()}".encode()).hexdigest()
    known = None if cache is None else cache.get_text(key)
    if known is not None:
        files = json.loads(known)
        if isinstance(files, list):
            return tuple(str(file) for file in files)
    found = _read(data, str(binary))
    if cache is not None:
        cache.put_text(key, json.dumps(found))
    return found


def _read(data: bytes, name: str) -> tuple[str, ...]:
    from mauve.wcet.binary.elf import ElfProblem, load_bytes
    from mauve.wcet.binary.lines import load_lines

    loaded = load_bytes(data, name)
    if isinstance(loaded, ElfProblem):
        return ()
    table = load_lines(loaded)
    used = {row.file for row in table.rows}
    return tuple(path for number, path in enumerate(table.files) if number in used)
