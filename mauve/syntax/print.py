"""The abstract syntax as a short indented text, one node a line: `--emit ast`, and golden tests."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from typing import Any

from mauve.records import field_names, is_record
from mauve.source import SourceFile, Span
from mauve.syntax import ast

FLAGS = ("expect_unschedulable", "report_cuts")
"""Fields whose span says only that the thing is written."""


def format_ast(module: ast.Module) -> str:
    """The tree of a module. Fields that are empty are left out; names and literals stand on the line of their node."""
    return "\n".join(_lines(module, "", 0)) + "\n"


def _lines(node: Any, label: str, depth: int) -> Iterator[str]:
    """A node's line with its short fields, then the lines of its other fields."""
    words, blocks = [f"{label}{type(node).__name__}"], []
    for field in field_names(node):
        value = getattr(node, field)
        if isinstance(value, (Span, SourceFile)) and field not in FLAGS:
            continue
        if value is None or value is False or value in ("", ()):
            continue
        if value is True or isinstance(value, Span):
            words.append(field)
            continue
        short = _short(value)
        if short is not None:
            words.append(f"{field}={short}")
        else:
            blocks.append((field, value))
    yield "  " * depth + " ".join(words)
    for name, value in blocks:
        many = isinstance(value, tuple)
        for child in value if many else (value,):
            yield from _lines(child, "" if many else f"{name}: ", depth + 1)


def _short(value: Any) -> str | None:
    """A value that fits on its owner's line; None for one that needs lines of its own."""
    match value:
        case ast.Name() | ast.Path():
            return str(value)
        case ast.Quantity(number, unit):
            return number + unit
        case ast.Number(text):
            return text
        case ast.String(text):
            return repr(text)
        case ast.Boolean(flag):
            return str(flag).lower()
        case ast.Record(pairs):
            return "{" + ", ".join(f"{name}: {_short(item)}" for name, item in pairs) + "}"
        case ast.List(items):
            return "[" + ", ".join(_short(item) or "" for item in items) + "]"
        case ast.TypeRef(path, dimensions):
            return str(path) + "".join(f"[{d.text}]" for d in dimensions)
        case ast.Parameter(name, type_):
            return f"{name}:{_short(type_)}"
        case ast.Every(period):
            return f"every({_short(period)})"
        case ast.Once(apart):
            return f"once({_short(apart) if apart else ''})"
        case ast.CodePlace(base, offset, _):
            return f"{_short(base)}" + (f"+{offset.text}" if offset is not None else "")
        case ast.Step(target, arguments, result, _):
            call = "" if arguments is None else "(" + ",".join(map(str, arguments)) + ")"
            return (f"{result}=" if result else "") + f"{target}{call}"
        case ast.GuardCodel(name):
            return str(name)
        case ast.GuardNot(operand, _):
            return f"(not {_short(operand)})"
        case ast.GuardBinary(is_and, left, right, _):
            return f"({_short(left)} {'and' if is_and else 'or'} {_short(right)})"
        case Enum():
            return str(value.value).replace(" ", "_")
        case str() | int():
            return repr(value) if isinstance(value, str) else str(value)
        case tuple() if not any(_block(item) for item in value):
            return "[" + ", ".join(_short(item) or "" for item in value) + "]"
    return None


def _block(item: Any) -> bool:
    return is_record(item) and _short(item) is None
