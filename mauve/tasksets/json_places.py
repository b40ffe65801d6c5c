"""Where the values of a JSON document stand: read only when a message needs a place, without recursion."""

from __future__ import annotations

import re
from collections.abc import Iterator

from mauve.source import SourceFile, Span
from mauve.tasksets.taskset import Path

_TOKEN = re.compile(r'[\s]*(?:("(?:[^"\\]|\\.)*")|([\[\]{}:,])|([^\s\[\]{}:,"]+))')


class JsonSpans:
    """The spans of the values of a document that the standard library has parsed."""

    __slots__ = ("_known", "_left", "file")

    def __init__(self, file: SourceFile) -> None:
        self.file = file
        self._known: dict[Path, tuple[int, int]] = {}
        self._left = _values(file.text)

    def of(self, path: Path) -> Span:
        """The span of a value, or of the nearest one around it; reads no further than it must."""
        if path not in self._known:
            for one, start, end in self._left:
                self._known[one] = start, end
                if one == path:
                    break
        for length in range(len(path), -1, -1):
            if path[:length] in self._known:
                return Span(self.file, *self._known[path[:length]])
        return Span(self.file, 0, 0)


def _values(text: str) -> Iterator[tuple[Path, int, int]]:
    """Every value with its path, in order; the span of an object or a list is its first character."""
    path: list[str | int] = []
    # Per open list True, per open object False; for an object, whether a key comes next.
    lists: list[bool] = []
    key_next = False
    for match in _TOKEN.finditer(text):
        string, mark, _ = match.groups()
        start, end = match.span(match.lastindex or 0)
        match mark:
            case "{" | "[":
                yield tuple(path), start, end
                lists.append(mark == "[")
                path.append(0 if mark == "[" else "")
                key_next = mark == "{"
            case "}" | "]":
                if lists:
                    lists.pop()
                    path.pop()
                key_next = False
            case ",":
                if lists and lists[-1]:
                    last = path[-1]
                    path[-1] = last + 1 if isinstance(last, int) else last
                key_next = bool(lists) and not lists[-1]
            case ":":
                key_next = False
            case _:
                if key_next and string is not None:
                    path[-1] = _unquoted(string)
                    yield (*path[:-1], f"key {path[-1]}"), start, end
                else:
                    yield tuple(path), start, end


def _unquoted(text: str) -> str:
    import json

    try:
        value = json.loads(text)
    except ValueError:
        return text[1:-1]
    return value if isinstance(value, str) else text[1:-1]
