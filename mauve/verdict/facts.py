"""Files of flow facts, read for an analysis; what is wrong with them told as messages.

A file that ends in `.mauve` gives the facts of its binaries, in or outside of deployments; every other one is taken for
OTAWA's .ff.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from mauve.diagnostics.diagnostic import Diagnostic, Label, Report, Severity
from mauve.source import SourceFile, Span
from mauve.syntax.ast.deployments import BinaryDecl, DeploymentDecl

if TYPE_CHECKING:
    from mauve.model.facts import BinaryFacts
    from mauve.wcet.flow.facts import Fact

LARGEST = 16 << 20
"""A longer file, in bytes, is refused."""


def facts_for(elf: str, path: str, report: Report) -> tuple[Fact, ...]:
    """The facts of a file of either kind that speak of an executable: in a model, those of the binaries that are the
    same file, or where there are none those of the same name (a build may have moved it)."""
    if not path.endswith(".mauve"):
        return read_facts(path, None, report)
    from mauve.lower.platform import flow_facts

    declared = _declared(path, report)
    mine = [facts for facts in declared if _same_file(facts.path, elf)]
    mine = mine or [facts for facts in declared if Path(facts.path).name == Path(elf).name]
    if not mine and not report.has_errors:
        known = ", ".join(f"`{name}`" for name in dict.fromkeys(facts.path for facts in declared))
        reason = f"it has those of {known}" if known else "it declares no binary"
        report.add(Diagnostic("MV516", f"`{path}` has no flow facts of `{Path(elf).name}`: {reason}", place=path))
    written = flow_facts(tuple(fact for facts in mine for fact in facts.facts))
    files = (fact for facts in mine for file, span in facts.files for fact in read_facts(file, span, report))
    return (*written, *files)


def _declared(path: str, report: Report) -> tuple[BinaryFacts, ...]:
    """The facts of all binaries that a module declares, without what it imports."""
    from mauve.model.facts import binary_facts, module_facts
    from mauve.syntax.load import load_modules

    modules = load_modules(Path(path), report)[:1]
    head, slash, _ = path.replace("\\", "/").rpartition("/")
    found = [facts for module in modules for facts in module_facts(module, head + slash, report)]
    for module in modules:
        for declaration in module.declarations:
            if isinstance(declaration, DeploymentDecl):
                found += [binary_facts(item, head + slash, report) for item in _binaries(declaration)]
    return tuple(found)


def _binaries(deployment: DeploymentDecl) -> Iterator[BinaryDecl]:
    for process in deployment.processes:
        yield from process.binaries
    for node in deployment.nodes:
        yield from node.binaries
        for process in node.processes:
            yield from process.binaries


def _same_file(first: str, second: str) -> bool:
    try:
        return Path(first).samefile(second)
    except OSError:
        return False


def read_facts(path: str, named: Span | None, report: Report) -> tuple[Fact, ...]:
    """The facts of an OTAWA file; MV516 for what is wrong, at its place. `named` is where a model names the file."""
    from mauve.wcet.flow.otawa import parse_facts

    text = _text(path, named, report)
    if text is None:
        return ()
    parsed = parse_facts(text, path)
    file = SourceFile(path, text)
    for problem in parsed.problems:
        line = min(problem.line, len(file.line_starts))
        start = min(file.line_starts[line - 1] + problem.column - 1, len(text))
        span = Span(file, start, min(start + 1, len(text)))
        severity = Severity.ERROR if problem.is_error else Severity.NOTE
        report.add(Diagnostic("MV516", problem.message, Label(span), severity))
    return parsed.facts


def _text(path: str, named: Span | None, report: Report) -> str | None:
    try:
        with Path(path).open("rb") as stream:
            data = stream.read(LARGEST + 1)
        if len(data) <= LARGEST:
            return data.decode("utf-8")
        reason = f"it has more than {LARGEST >> 20} MiB"
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
    except UnicodeDecodeError:
        reason = "it is not UTF-8 text"
    except ValueError:
        reason = "its name has a NUL character"
    primary = Label(named) if named is not None else None
    message = f"the flow facts `{path}` cannot be read: {reason}"
    report.add(Diagnostic("MV516", message, primary, place="" if primary else path))
    return None
