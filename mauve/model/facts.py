"""Flow facts as written to flow facts as meant: bounds of loops, numbers that are assumed, targets of branches."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.model.model import AssumedRange, CodePlace, ControlFact, LoopFact, RecursionFact
from mauve.records import record
from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.quantities import size_of

WIDTHS = (1, 2, 4)
"""The sizes of numbers that can be assumed, in bytes."""

FlowFact = LoopFact | RecursionFact | AssumedRange | ControlFact


@record
class BinaryFacts:
    """The flow facts of one declaration of a binary: those written there, and files by path with where they are named.
    """

    path: str
    facts: tuple[FlowFact, ...]
    files: tuple[tuple[str, Span], ...]
    span: Span


def binary_facts(item: ast.BinaryDecl, directory: str, report: Report) -> BinaryFacts:
    """The facts of a declaration; paths are relative to `directory`, that of the model's file."""
    found = (
        *(_loop(loop, report) for loop in item.loops),
        *(_recursion(one, report) for one in item.recursions),
        *(_range(one, report) for one in item.ranges),
        *(_control(one, report) for one in item.control),
    )
    facts = tuple(fact for fact in found if fact is not None)
    files = tuple((under(directory, f.path.value), f.path.span) for f in item.facts)
    return BinaryFacts(under(directory, item.path.value), facts, files, item.path.span)


def module_facts(module: ast.Module, directory: str, report: Report) -> tuple[BinaryFacts, ...]:
    """The facts of a module's binaries that stand outside of deployments; codels are bound in deployments only."""
    for item in module.binaries:
        for binding in item.symbols:
            help_ = Fix(f"move it to the `binary {item.path.span.text}` of a deployment")
            message = "outside of a deployment a binary has flow facts only, no codels"
            report.add(Diagnostic("MV516", message, Label(binding.span), help=help_))
    return tuple(binary_facts(item, directory, report) for item in module.binaries)


def under(directory: str, path: str) -> str:
    """A path relative to the model's file, in terms of the caller's directory."""
    import posixpath

    return path if path.startswith("/") or not directory else posixpath.normpath(posixpath.join(directory, path))


def _place(item: ast.CodePlace, report: Report) -> CodePlace | None:
    offset = item.offset
    if offset is not None and (not offset.is_integer or offset.integer < 0):
        report.add(Diagnostic("MV516", f"`{offset.text}` is no offset in bytes", Label(offset.span)))
        return None
    shift = offset.integer if offset is not None else 0
    if isinstance(item.base, ast.Number):
        if item.base.is_integer and item.base.integer >= 0:
            return CodePlace(None, None, None, item.base.integer + shift)
        report.add(Diagnostic("MV516", f"`{item.base.text}` is no address", Label(item.base.span)))
        return None
    text = item.base.value
    file, colon, line = text.rpartition(":")
    if colon and line.isdigit() and file:
        return CodePlace(file, int(line), None, 0)
    if text and not colon:
        return CodePlace(None, None, text, shift)
    help_ = Fix('write a source line `"file.c:41"`, a symbol `"function"+0x10`, or an address `0x8000`')
    report.add(Diagnostic("MV516", f"`{text}` is no place in a program", Label(item.base.span), help=help_))
    return None


def _count(number: ast.Number, what: str, report: Report) -> int | None:
    """The number of a fact, None where it is none or still has to be written."""
    if number.text == "?":
        message = f"the bound is still a `?`: write {what}"
        report.add(Diagnostic("MV516", message, Label(number.span), Severity.NOTE))
        return None
    if not number.is_integer or number.integer < 0:
        report.add(Diagnostic("MV516", f"`{number.text}` is no number of times", Label(number.span)))
        return None
    return number.integer


def _loop(item: ast.LoopFactDecl, report: Report) -> LoopFact | None:
    limits = (item.maximum, item.total)
    maximum, total = (_count(n, "how often the loop runs", report) if n is not None else None for n in limits)
    if any(n is not None and count is None for n, count in zip(limits, (maximum, total), strict=True)):
        return None
    place = _place(item.place, report)
    return None if place is None or limits == (None, None) else LoopFact(place, maximum, total, item.span)


def _recursion(item: ast.RecursionFactDecl, report: Report) -> RecursionFact | None:
    if item.maximum is None:
        return None
    maximum, place = _count(item.maximum, "how many calls are under way at once", report), _place(item.place, report)
    return RecursionFact(place, maximum, item.span) if place is not None and maximum is not None else None


def _control(item: ast.ControlFactDecl, report: Report) -> ControlFact | None:
    if item.word == "targets" and not item.targets:
        message = "the targets are still a `?`: write where it goes"
        report.add(Diagnostic("MV516", message, Label(item.span), Severity.NOTE))
        return None
    place, targets = _place(item.place, report), [_place(target, report) for target in item.targets]
    known = tuple(target for target in targets if target is not None)
    return ControlFact(place, known, item.span) if place is not None and len(known) == len(targets) else None


def _range(item: ast.AssumedRangeDecl, report: Report) -> AssumedRange | None:
    place, between = _place(item.place, report), _between(item, report)
    argument, width = item.argument, size_of(item.width, report) if item.width is not None else None
    ends = size_of(item.ends, report) if item.ends is not None else None
    if item.ends is not None and (argument is None or width is not None or ends == 0):
        help_ = Fix('write `assume "function" argument 1 ends within 64B`, of at least one byte')
        message = "a string that ends is what an argument points to"
        report.add(Diagnostic("MV516", message, Label(item.span), help=help_))
        return None
    if width is not None and width not in WIDTHS:
        help_ = Fix("write `each 1B`, `each 2B` or `each 4B`")
        report.add(Diagnostic("MV516", f"a number has no {width} bytes", Label(item.span), help=help_))
        return None
    if argument is not None and (not argument.is_integer or argument.integer < 1):
        help_ = Fix("arguments count from 1: r0 is the first, r3 the fourth, then the words on the stack")
        report.add(Diagnostic("MV516", f"`{argument.text}` is no argument", Label(argument.span), help=help_))
        return None
    if place is None or between is None:
        return None
    if place.file is not None or (argument is not None and (place.symbol is None or place.address)):
        what = "an argument is one of a function" if argument is not None else "a source line is no place of data"
        help_ = Fix('write `assume "function" argument 1 from 0 to 64`, or `assume "variable" from 0 to 64`')
        report.add(Diagnostic("MV516", what, Label(item.place.span), help=help_))
        return None
    return AssumedRange(place, argument.integer if argument else None, width, *between, item.span, ends)


def _between(item: ast.AssumedRangeDecl, report: Report) -> tuple[int | None, int | None] | None:
    """The ends of the range, both None for any number."""
    wrong = next((n for n in (item.low, item.high) if n is not None and not n.is_integer), None)
    if wrong is not None:
        report.add(Diagnostic("MV516", f"`{wrong.text}` is no whole number", Label(wrong.span)))
        return None
    if item.low is None or item.high is None:
        return None, None
    low, high = item.low.integer, item.high.integer
    if low > high:
        report.add(Diagnostic("MV516", f"there is no number from {low} to {high}", Label(item.span)))
        return None
    return low, high
