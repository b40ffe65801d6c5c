"""`mauvec check`: does every deadline of a model hold."""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from collections.abc import Sequence
from typing import TYPE_CHECKING

from mauve import __version__
from mauve.cli.output import style, table_width, write_json, write_messages, wrong_usage
from mauve.diagnostics.allow import filter_allowed
from mauve.diagnostics.diagnostic import Diagnostic, Report
from mauve.pipeline import Options, check, read_model
from mauve.report.progress import progress
from mauve.timing.response import Method
from mauve.verdict.result import CheckResult

if TYPE_CHECKING:
    from mauve.timing.priorities import Policy


def run(arguments: Namespace) -> int:
    """Check the model and write the result; 0 where every deployment has the verdict that it asks for."""
    report = Report()
    if arguments.emit in ("ast", "model"):
        result = CheckResult(arguments.file, *read_model(arguments.file, report), ())
    else:
        method, workers = Method(arguments.method), os.cpu_count() or 1
        with progress(sys.stderr, "codels") as told:
            policy = _policy(arguments.priorities)
            options = Options(
                arguments.deployment, method, not arguments.no_cache, workers, told, arguments.sensitivity, policy
            )
            result = check(arguments.file, options, report)
    unknown = unknown_deployment(arguments.deployment, result)
    if unknown and not report.has_errors:
        return wrong_usage(unknown)
    messages = filter_allowed(report)
    if arguments.emit:
        from mauve.report.emit import emit

        _write_beside(arguments, messages)
        sys.stdout.write(emit(arguments.emit, result))
    else:
        _write_result(arguments, result, messages)
    return 0 if result.passes(report) else 1


def _policy(name: str | None) -> Policy | None:
    if name is None:
        return None
    from mauve.timing import priorities

    return priorities.Policy(name)


def unknown_deployment(wanted: str | None, result: CheckResult) -> str:
    """What to say where the deployment asked for does not exist; empty where it does."""
    names = [deployment.name for deployment in result.model.deployments] if result.model else []
    if wanted is None or result.model is None or wanted in names:
        return ""
    from mauve.diagnostics.suggest import closest

    known = ", ".join(f"`{name}`" for name in closest(wanted, names) or names) or "none"
    return f"there is no deployment `{wanted}`; the model has {known}"


def _write_result(arguments: Namespace, result: CheckResult, messages: Sequence[Diagnostic]) -> None:
    """The result on standard output, messages on standard error; the formats for programs are one document."""
    match arguments.format:
        case "json":
            from mauve.report.check_json import check_document

            write_json(check_document(result, messages, __version__))
        case "sarif" | "github":
            from mauve.diagnostics.render import render

            sys.stdout.write(render(messages, arguments.format, file=arguments.file, version=__version__))
        case _:
            from mauve.report.check_text import format_check

            _write_beside(arguments, messages)
            sys.stdout.write(format_check(result, style(arguments), table_width(), arguments.details))


def _write_beside(arguments: Namespace, messages: Sequence[Diagnostic]) -> None:
    """The messages beside a result. In full, default values (MV420) are left to the tables, which mark them."""
    if arguments.format in ("short", "github"):
        write_messages(messages, arguments.format, arguments, arguments.file)
    else:
        shown = [message for message in messages if message.code != "MV420"]
        write_messages(shown, "full", arguments, arguments.file)
