"""`mauvec wcet`: bounds of functions of an executable, without a model."""

from __future__ import annotations

import sys
from argparse import Namespace

from mauve.cli.output import style, table_width, write_file, write_json, write_messages, wrong_usage
from mauve.diagnostics.diagnostic import Diagnostic, Report
from mauve.pipeline import UnknownBoard, find_board, wcet
from mauve.verdict.facts import facts_for
from mauve.wcet.batch import Settings
from mauve.wcet.result import WcetResult


def run(arguments: Namespace) -> int:
    """Analyse and write the result; 0 where every function has a bound."""
    if arguments.write_lp and len(arguments.functions) != 1:
        return wrong_usage("--write-lp writes the program of one function: name exactly one")
    report = Report()
    board = find_board(arguments.board, report)
    if isinstance(board, UnknownBoard):
        return wrong_usage(board.message)
    facts = [fact for path in arguments.facts for fact in facts_for(arguments.elf, path, report)]
    if board is None or report.has_errors:
        _write_messages(arguments, report)
        return 1
    settings = Settings(board, tuple(facts), arguments.initial_data, arguments.timeout, not arguments.no_cache)
    if arguments.emit == "cfg":
        return _emit(arguments, report)
    results = _analyse(arguments, settings, report)
    _write_messages(arguments, report)
    _write_result(arguments, settings, results)
    written = not arguments.write_lp or _write_program(arguments, settings, results)
    return 0 if written and results and all(r.bounded for r in results) and not report.has_errors else 1


def _analyse(arguments: Namespace, settings: Settings, report: Report) -> tuple[WcetResult, ...]:
    from mauve.report.progress import progress

    with progress(sys.stderr, "functions") as told:
        return wcet(arguments.elf, arguments.functions, settings, report, arguments.jobs, told)


def _write_messages(arguments: Namespace, report: Report) -> None:
    """One line each, in the order found: those of a function stay together."""
    write_messages(tuple(report), "short", arguments, arguments.elf)


def _write_result(arguments: Namespace, settings: Settings, results: tuple[WcetResult, ...]) -> None:
    match arguments.format:
        case "json":
            from mauve.wcet.serialize import document

            write_json(document(arguments.elf, settings.board, results))
        case "csv":
            from mauve.report.wcet_csv import format_csv

            sys.stdout.write(format_csv(results))
        case _ if results:
            from mauve.report.wcet_text import format_explanation, format_wcet

            sys.stdout.write(format_wcet(arguments.elf, settings.board, results, style(arguments), table_width()))
            if arguments.explain:
                sys.stdout.write(format_explanation(arguments.elf, results, style(arguments), table_width()))


def _write_program(arguments: Namespace, settings: Settings, results: tuple[WcetResult, ...]) -> bool:
    """The integer linear program of the one function, where it has a bound."""
    from mauve.wcet.lp import linear_program

    text = linear_program(arguments.elf, arguments.functions[0], settings) if results[0].bounded else None
    if text is None:
        problem = f"`{arguments.functions[0]}` has no bound, so there is no program to write"
    else:
        reason = write_file(arguments.write_lp, text)
        problem = f"cannot write `{arguments.write_lp}`: {reason}" if reason else ""
    if problem:
        print(f"mauvec: {problem}", file=sys.stderr)
    return not problem


def _emit(arguments: Namespace, report: Report) -> int:
    """The graphs of the functions named, or of all."""
    from mauve.report.emit import function_graphs
    from mauve.wcet.batch import all_functions
    from mauve.wcet.result import Problem

    wanted = arguments.functions or all_functions(arguments.elf)
    if isinstance(wanted, Problem):
        report.add(Diagnostic("MV502", wanted.message, place=arguments.elf))
        wanted = ()
    texts, problems = function_graphs(arguments.elf, wanted)
    for text in texts:
        sys.stdout.write(text + "\n")
    for problem in problems:
        report.add(Diagnostic("MV501", problem, place=arguments.elf))
    _write_messages(arguments, report)
    return 1 if report.has_errors else 0
