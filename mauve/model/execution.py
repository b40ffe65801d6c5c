"""Execution attributes of instances and threads: periods, separations, deadlines, priorities, checked and converted."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.model import Setting
from mauve.model.names import duplicate
from mauve.syntax import ast
from mauve.syntax.quantities import time_of

PRIORITIES = range(1 << 16)


def execution_settings(attributes: tuple[ast.ExecutionAttribute, ...], report: Report) -> dict[ast.Execution, Setting]:
    """The execution attributes by kind, in picoseconds; bad and repeated ones are reported (MV401) and left out."""
    settings: dict[ast.Execution, Setting] = {}
    for attribute in attributes:
        kind, value = attribute.kind, attribute.value
        if kind in settings:
            first = settings[kind].span or attribute.span
            name = ast.Name(kind.value, attribute.span)
            report.add(duplicate("attribute", name, first))
            continue
        if isinstance(value, ast.Number):
            number = value.integer if value.is_integer else None
            if kind is not ast.Execution.PRIORITY:
                help_ = Fix(f"write `{kind.value} {value.text}ms`, or another unit of time")
                message = f"the {kind.value} `{value.text}` has no unit"
                report.add(Diagnostic("MV004", message, Label(value.span), help=help_))
            elif number is None or number not in PRIORITIES:
                message = f"`{value.text}` is no priority"
                label = f"a whole number from {PRIORITIES.start} to {PRIORITIES.stop - 1}; larger is more urgent"
                report.add(Diagnostic("MV401", message, Label(value.span, label)))
            else:
                settings[kind] = Setting(number, attribute.span)
            continue
        if kind is ast.Execution.PRIORITY:
            report.add(Diagnostic("MV401", "a priority is a number without a unit", Label(value.span)))
            continue
        time = time_of(value, report)
        may_be_zero = kind in (ast.Execution.OFFSET, ast.Execution.JITTER)
        if time is not None and (time < 0 or (time == 0 and not may_be_zero)):
            message = f"a {kind.value} of {value.span.text}"
            label = "cannot be negative" if may_be_zero else "must be longer than 0"
            report.add(Diagnostic("MV401", message, Label(value.span, label)))
        elif time is not None:
            settings[kind] = Setting(time, attribute.span)
    return settings
