"""`mauvec schedule`: response times of plain task sets, without a model."""

from __future__ import annotations

import sys
from argparse import Namespace

from mauve import __version__
from mauve.cli.output import style, table_width, write_file, write_messages
from mauve.diagnostics.diagnostic import Report
from mauve.tasksets.answer import Answer, Request, answer
from mauve.tasksets.messages import report_answer
from mauve.tasksets.read import read_tasksets
from mauve.tasksets.taskset import Document
from mauve.timing.priorities import Policy
from mauve.timing.response import Method


def run(arguments: Namespace) -> int:
    """Analyse the sets of a file, or write them in another format; 0 where every deadline of each holds."""
    report = Report()
    document = read_tasksets(arguments.file, report)
    if arguments.export:
        return _export(arguments, document, report)
    request = Request(Method(arguments.method), Policy(arguments.priorities), arguments.sensitivity)
    answers: list[Answer | None] = [answer(one, request) if one is not None else None for one in document.sets]
    for one in answers:
        if one is not None:
            report_answer(one, report)
    _write(arguments, answers, document.listed, report)
    return 0 if not report.has_errors and all(one is not None and one.holds for one in answers) else 1


def _write(arguments: Namespace, answers: list[Answer | None], listed: bool, report: Report) -> None:
    if arguments.format == "json":
        from mauve.report.exact_json import dumps
        from mauve.report.schedule_json import schedule_document

        write_messages(report.sorted(), "short", arguments, arguments.file)
        sys.stdout.write(dumps(schedule_document(answers, listed, report.sorted(), __version__)))
    else:
        from mauve.report.schedule_text import format_schedule

        write_messages(report.sorted(), "full", arguments, arguments.file)
        sys.stdout.write(format_schedule(answers, style(arguments), table_width()))


def _export(arguments: Namespace, document: Document, report: Report) -> int:
    """Write the one set of the file as MAST text."""
    from mauve.tasksets.mast_output import format_mast

    text = format_mast(document, report)
    write_messages(report.sorted(), "short", arguments, arguments.file)
    if text is None or report.has_errors:
        return 1
    if arguments.output is None:
        sys.stdout.write(text)
        return 0
    problem = write_file(arguments.output, text)
    if problem:
        print(f"mauvec: cannot write `{arguments.output}`: {problem}", file=sys.stderr)
    return 1 if problem else 0
