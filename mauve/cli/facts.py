"""`mauvec facts`: the flow facts that a function's bound still waits for, as a template."""

from __future__ import annotations

import sys
from argparse import Namespace

from mauve.cli.output import write_messages
from mauve.diagnostics.diagnostic import Report
from mauve.pipeline import missing


def run(arguments: Namespace) -> int:
    """Write the template; 0 where it was written or nothing is missing."""
    from mauve.verdict.facts import facts_for

    report = Report()
    facts = [fact for path in arguments.facts for fact in facts_for(arguments.elf, path, report)]
    found = None
    if not report.has_errors:
        found = missing(arguments.elf, arguments.functions, facts, arguments.initial_data, arguments.timeout, report)
    write_messages(tuple(report), "short", arguments, arguments.elf)
    if found is None:
        return 1
    if not found:
        names = ", ".join(f"`{name}`" for name in arguments.functions)
        sys.stdout.write(f"// nothing is missing: {names} needs no flow facts\n")
        return 0
    from mauve.report.facts_text import format_ff, format_model

    write = format_ff if arguments.format == "ff" else format_model
    sys.stdout.write(write(arguments.elf, found))
    return 0
