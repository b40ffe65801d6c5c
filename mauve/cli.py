"""The command line: parse arguments, call the pipeline, choose a renderer, return the exit code.

Exit codes: 0 everything holds; 1 the input has errors, or a requirement does not hold, or an analysis is incomplete;
2 wrong usage; 70 a bug of ours. Results go to standard output, diagnostics and progress to standard error.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, TextIO

from mauve import __version__

if TYPE_CHECKING:
    from mauve.diagnostics.diagnostic import Report
    from mauve.diagnostics.style import Style
    from mauve.model.model import Model
    from mauve.pipeline import CheckResult

EXIT_HOLDS, EXIT_FAILS, EXIT_USAGE, EXIT_BUG, EXIT_INTERRUPTED = 0, 1, 2, 70, 130

STAGES = ("ast", "model", "cfg", "psm", "traces", "tasks")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns its exit code and never lets an exception out."""
    try:
        arguments = _parser().parse_args(argv)
    except SystemExit as stop:
        return int(stop.code or 0)
    try:
        code: int = arguments.run(arguments)
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        print("mauvec: interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        # the reader went away (`mauvec check ... | head`): nothing is left to say, and nothing to flush at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_FAILS
    except Exception as error:
        if os.environ.get("MAUVEC_TRACEBACK"):
            raise
        _report_bug(error)
        return EXIT_BUG


def _report_bug(error: Exception) -> None:
    """One line that asks for a report; never a traceback."""
    frame = error.__traceback__
    while frame is not None and frame.tb_next is not None:
        frame = frame.tb_next
    where = f"{os.path.basename(frame.tb_frame.f_code.co_filename)}:{frame.tb_lineno}" if frame else "?"
    text = " ".join(str(error).split())[:200]
    print(
        f"mauvec: internal error [MV901]: {type(error).__name__}: {text} (at {where}); this is a bug of mauvec "
        f"{__version__}: please report it with the input, and set MAUVEC_TRACEBACK=1 to see more",
        file=sys.stderr,
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="mauvec",
        description="Does every deadline of the robot hold, always, and why: from the ARM binary to response times.",
        epilog="`mauvec COMMAND --help` tells more about a command.",
    )
    parser.add_argument("--version", action="version", version=f"mauvec {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    _add_check(commands)
    _add_wcet(commands)
    _add_explain(commands)
    return parser


Commands = argparse._SubParsersAction  # type: ignore[type-arg]  # argparse exports no public name for it


def _add_common(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--color", choices=("auto", "always", "never"), default="auto", help="colours (default: on a terminal only)"
    )
    parser.add_argument("--no-cache", action="store_true", help="neither use nor keep results of earlier runs")


def _add_check(commands: Commands) -> None:
    parser = commands.add_parser(
        "check",
        help="does every deadline of a model hold",
        description="Check every deployment of a model: WCET of each codel from the binary, WCRT of each component, "
        "a verdict for each deadline.",
    )
    parser.add_argument("file", metavar="FILE", help="the model, e.g. robot.mauve")
    parser.add_argument("--deployment", metavar="D", help="check this deployment only")
    parser.add_argument(
        "--method",
        choices=("trace", "exact", "paper", "sporadic"),
        default="trace",
        help="how response times are computed (default: trace; paper is the MAUVE paper's own, unsound beyond R <= T)",
    )
    parser.add_argument(
        "--format",
        choices=("full", "short", "json", "sarif", "github"),
        default="full",
        help="how messages and results are shown (default: full)",
    )
    parser.add_argument("--emit", choices=STAGES, metavar="STAGE", help="print a stage: " + ", ".join(STAGES))
    _add_common(parser)
    parser.set_defaults(run=_check)


def _check(arguments: argparse.Namespace) -> int:
    from mauve.diagnostics.diagnostic import Report
    from mauve.pipeline import Options, check
    from mauve.timing.response import Method

    report = Report()
    options = Options(arguments.deployment, Method(arguments.method), not arguments.no_cache)
    result = check(arguments.file, options, report)
    if result.model is not None and not report.has_errors and not _deployment_known(arguments, result.model):
        return EXIT_USAGE
    if arguments.emit:
        from mauve.report.emit import emit

        sys.stdout.write(emit(arguments.emit, result))
        _write_diagnostics(arguments, report)
    else:
        _write_result(arguments, result, report)
    return EXIT_HOLDS if result.passes(report) else EXIT_FAILS


def _deployment_known(arguments: argparse.Namespace, model: Model) -> bool:
    """Whether the deployment asked for exists; says so where it does not."""
    names = [deployment.name for deployment in model.deployments]
    if arguments.deployment is None or arguments.deployment in names:
        return True
    known = ", ".join(f"`{name}`" for name in names) or "none"
    print(f"mauvec: there is no deployment `{arguments.deployment}`; the model has {known}", file=sys.stderr)
    return False


def _write_result(arguments: argparse.Namespace, result: CheckResult, report: Report) -> None:
    """The result on standard output, the diagnostics on standard error; the machine formats are one document."""
    from mauve.diagnostics.allow import filter_allowed
    from mauve.diagnostics.render import render

    match arguments.format:
        case "json":
            from mauve.report.check_json import check_document

            _write_json(check_document(result, filter_allowed(report), __version__))
        case "sarif" | "github":
            text = render(filter_allowed(report), arguments.format, file=arguments.file, version=__version__)
            sys.stdout.write(text)
        case _:
            from mauve.report.check_text import format_check

            _write_diagnostics(arguments, report)
            sys.stdout.write(format_check(result, _style(arguments, sys.stdout)))


def _write_diagnostics(arguments: argparse.Namespace, report: Report) -> None:
    from mauve.diagnostics.allow import filter_allowed
    from mauve.diagnostics.render import render

    format_ = arguments.format if arguments.format in ("full", "short", "github") else "full"
    text = render(filter_allowed(report), format_, colour=_coloured(arguments, sys.stderr), file=arguments.file)
    sys.stderr.write(text)
    sys.stderr.flush()


def _write_json(document: object) -> None:
    import json

    json.dump(document, sys.stdout, indent=2)
    sys.stdout.write("\n")


def _coloured(arguments: argparse.Namespace, stream: TextIO) -> bool:
    if arguments.color != "auto":
        return bool(arguments.color == "always")
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def _style(arguments: argparse.Namespace, stream: TextIO) -> Style:
    from mauve.diagnostics.style import ANSI, PLAIN

    return ANSI if _coloured(arguments, stream) else PLAIN


def _add_wcet(commands: Commands) -> None:
    parser = commands.add_parser(
        "wcet",
        help="the WCET of functions of a binary, without a model",
        description="Bound the worst-case execution time of functions of an ARM executable.",
    )
    parser.add_argument("elf", metavar="ELF", help="the executable")
    parser.add_argument(
        "functions", metavar="FUNCTION", nargs="*", help="symbols or addresses (default: every function)"
    )
    parser.add_argument(
        "--board", metavar="B", required=True, help="a board of the standard library, or FILE.mauve:BOARD"
    )
    parser.add_argument("--facts", metavar="FILE", action="append", default=[], help="flow facts (.ff)")
    parser.add_argument(
        "--initial-data", action="store_true", help="start from the linked data, not from unknown globals"
    )
    parser.add_argument("--timeout", metavar="S", type=_seconds, help="seconds spent on one function at most")
    parser.add_argument("--format", choices=("table", "json", "csv"), default="table", help="(default: table)")
    parser.add_argument("--explain", action="store_true", help="show the worst path, block by block, on source lines")
    parser.add_argument("--write-lp", metavar="FILE", help="write the integer linear program of the (one) function")
    parser.add_argument("--emit", choices=("cfg",), help="print the control flow graphs instead")
    _add_common(parser)
    parser.set_defaults(run=_wcet)


def _seconds(text: str) -> float:
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is no number of seconds above 0")
    return value


def _wcet(arguments: argparse.Namespace) -> int:
    from mauve.batch import run_wcet

    return run_wcet(arguments, _style(arguments, sys.stdout), _write_json)


def _add_explain(commands: Commands) -> None:
    parser = commands.add_parser("explain", help="what a message means", description="Explain a message by its code.")
    parser.add_argument("code", metavar="CODE", help="e.g. MV601, or its name, deadline-missed")
    parser.set_defaults(run=_explain)


def _explain(arguments: argparse.Namespace) -> int:
    from mauve.diagnostics.explain import explanation, near

    text = explanation(arguments.code)
    if text is None:
        similar = near(arguments.code)
        known = f"; there is {', '.join(f'`{code}`' for code in similar)}" if similar else ""
        print(f"mauvec: there is no message `{arguments.code}`{known}", file=sys.stderr)
        return EXIT_USAGE
    print(text.rstrip())
    return EXIT_HOLDS


if __name__ == "__main__":
    sys.exit(main())
