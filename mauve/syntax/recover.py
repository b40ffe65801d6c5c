"""What happens at a syntax error."""

from __future__ import annotations

from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.machine import Machine


def recover(machine: Machine) -> ast.Module:
    """Report the error and end."""
    token = machine.tokens[machine.at]
    machine.context.error(f"unexpected `{token.text}`", Span(machine.file, token.start, token.end))
    return ast.Module(machine.file, 1, None, (), ())
