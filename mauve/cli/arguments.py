"""The arguments of every command. What a command does is in the module of its name, imported when it runs."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from mauve import __version__
from mauve.units import TIME_UNITS

STAGES = ("ast", "model", "cfg", "psm", "traces", "tasks", "objectives", "net", "alternatives")
METHODS = ("trace", "exact", "paper", "sporadic")
FORMS = (
    "objectives", "net", "alternatives", "dot", "net-dot", "json", "pnml", "tina", "lola", "c", "c-header", "python",
)  # fmt: skip
"""What `mauvec mission --emit` writes (mauve.report.mission_emit)."""

FORMATS = ("full", "short", "json", "sarif", "github")

CODES = "exit codes: 0 everything holds; 1 it does not, or the input is in error; 2 wrong usage; 70 a bug of mauvec"


def parse(argv: Sequence[str]) -> argparse.Namespace:
    """The arguments; `command` names the module that runs them. SystemExit after help, a version, or wrong usage."""
    top = argparse.ArgumentParser(
        prog="mauvec",
        description="Does every deadline of the robot hold, always, and why: from the ARM binary to response times.",
        epilog=f"`mauvec COMMAND --help` tells more about a command. {CODES}.",
        allow_abbrev=False,
    )
    top.add_argument("--version", action="version", version=f"mauvec {__version__}")
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command, add in COMMANDS.items():
        add(_Commands(commands, command))
    _check_command(top, argv)
    return top.parse_args(argv)


def _check_command(top: argparse.ArgumentParser, argv: Sequence[str]) -> None:
    """Say which command may have been meant where there is none of that name."""
    given = argv[0] if argv else "-"
    if given.startswith("-") or given in COMMANDS:
        return
    from mauve.diagnostics.suggest import closest

    near = closest(given, COMMANDS)
    known = f"did you mean `{near[0]}`?" if near else f"there is {', '.join(f'`{name}`' for name in COMMANDS)}"
    top.error(f"there is no command `{given}`; {known}")


class _Commands:
    """Where a command adds its parser."""

    def __init__(self, commands: Any, name: str) -> None:
        self.commands = commands
        self.name = name

    def parser(self, help_: str, description: str, epilog: str) -> argparse.ArgumentParser:
        """The parser of the command, with its texts."""
        parser = self.commands.add_parser(
            self.name, help=help_, description=description, epilog=epilog, allow_abbrev=False
        )
        assert isinstance(parser, argparse.ArgumentParser)
        parser.set_defaults(command=self.name)
        return parser


def _add_common(parser: argparse.ArgumentParser) -> None:
    color = "colours: on a terminal unless NO_COLOR is set (auto, the default), always, or never"
    parser.add_argument("--color", choices=("auto", "always", "never"), default="auto", help=color)
    parser.add_argument("--no-cache", action="store_true", help="neither use nor keep results of earlier runs")


def _add_check(commands: _Commands) -> None:
    parser = commands.parser(
        "does every deadline of a model hold",
        "Check the deployments of a model: the WCET of each codel from the binary, the WCRT of each component, and a "
        "verdict for each deadline. The tables go to standard output, messages to standard error.",
        f"example: mauvec check robot.mauve. {CODES}.",
    )
    add = parser.add_argument
    add("file", metavar="FILE", help="the model, e.g. robot.mauve")
    add("--deployment", metavar="D", help="check this deployment only (default: all that are not abstract)")
    method = "how responses are bounded (default: trace; paper: as printed in the MAUVE paper, unsound beyond R <= T)"
    add("--method", choices=METHODS, default="trace", help=method)
    format_ = "full: for people (default); short: messages one a line; json, sarif, github: for programs"
    add("--format", choices=FORMATS, default="full", help=format_)
    add("--emit", choices=STAGES, help="print what this stage made instead of the tables")
    add("--sensitivity", action="store_true", help="show how much codels, periods, priorities and clock may change")
    propose = "propose priorities: optimal (Audsley), rm (by period), dm (by deadline), or show the given ones"
    add("--priorities", choices=("optimal", "rm", "dm", "given"), help=propose)
    add("--details", action="store_true", help="show responses term by term, per state and transition; shares of flows")
    _add_common(parser)


def _add_wcet(commands: _Commands) -> None:
    parser = commands.parser(
        "the WCET of functions of a binary, without a model",
        "Bound the worst-case execution time of functions of an ARM executable, callees included. What keeps a "
        "function from having a bound is told on standard error, with its source line.",
        f"example: mauvec wcet robot.elf control_step --board generic-arm926ej-s. {CODES}.",
    )
    add = parser.add_argument
    add("elf", metavar="ELF", help="the executable")
    add("functions", metavar="FUNCTION", nargs="*", help="symbols or addresses (default: every function with a symbol)")
    add("--board", metavar="B", required=True, help="a board of the standard library, or FILE.mauve:BOARD")
    add("--facts", metavar="FILE", action="append", default=[], help="flow facts (.mauve or .ff); several if need be")
    add("--initial-data", action="store_true", help="start from the linked data, not from unknown globals")
    add("--timeout", metavar="S", type=_seconds, help="seconds spent on one function at most")
    add("--format", choices=("table", "json", "csv"), default="table", help="how results are shown (default: table)")
    add("--explain", action="store_true", help="show the worst path by source line, dearest lines first")
    add("--emit", choices=("cfg",), help="print the control flow graphs, callees included, instead of bounds")
    add("--write-lp", metavar="FILE", help="write the integer linear program of the one function named")
    add("--jobs", metavar="N", type=_count, default=os.cpu_count() or 1, help="processes (default: one per processor)")
    _add_common(parser)


def _add_mission(commands: _Commands) -> None:
    parser = commands.parser(
        "build, check, simulate and export a mission",
        "From objectives, activities and resources to a Petri net, the graph of its stable states, its properties, and "
        "the controller. The verdicts go to standard output, messages to standard error.",
        f"example: mauvec mission robot.mauve. {CODES}.",
    )
    add = parser.add_argument
    add("file", metavar="FILE", help="the model, e.g. robot.mauve")
    add("--mission", metavar="M", help="this mission only (default: all of the model)")
    add("--simulate", action="store_true", help="step the mission from events on standard input")
    add("--events", metavar="SCRIPT", help="with --simulate: a file of events, one a line")
    add("--markings", action="store_true", help="build the graph of all markings, too, transient ones included")
    add("--budget", metavar="N", type=_count, default=1_000_000, help="stable states at most (default: 1000000)")
    add("--format", choices=("text", "json"), default="text", help="how verdicts are shown (default: text)")
    add("--emit", choices=FORMS, help="write this form of the mission instead of its verdicts")
    add("-o", "--output", metavar="FILE", help="write to a file; with --emit c also the header beside it")
    add("--messages", choices=("full", "short", "github"), default="full", help="the form of messages (default: full)")
    _add_common(parser)


def _seconds(text: str) -> float:
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is no number of seconds above 0")
    return value


def _count(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is no number above 0")
    return value


def _add_facts(commands: _Commands) -> None:
    parser = commands.parser(
        "the flow facts that are missing, as a template",
        "Print the flow facts that the bounds of functions of an executable still need: loops without a bound, nested "
        "as they are and with their source lines, and branches without targets. Everything else is bounded already.",
        f"example: mauvec facts robot.elf control_step > robot-facts.mauve. {CODES}.",
    )
    add = parser.add_argument
    add("elf", metavar="ELF", help="the executable")
    add("functions", metavar="FUNCTION", nargs="+", help="symbols or addresses")
    add("--facts", metavar="FILE", action="append", default=[], help="facts known already (.mauve or .ff)")
    add("--initial-data", action="store_true", help="start from the linked data, not from unknown globals")
    add("--timeout", metavar="S", type=_seconds, help="seconds spent on one function at most")
    add("--format", choices=("mauve", "ff"), default="mauve", help="for a model (default), or for OTAWA")
    _add_common(parser)


def _add_simulate(commands: _Commands) -> None:
    parser = commands.parser(
        "one run of the schedule, as tables or a Gantt chart",
        "Simulate the schedule of each deployment, event by event and exactly: responses seen, preemptions, context "
        "switches, idle time. It is one run out of many: only `mauvec check` bounds them.",
        f"example: mauvec simulate robot.mauve --format svg -o robot.svg. {CODES}.",
    )
    add = parser.add_argument
    add("file", metavar="FILE", help="a model, e.g. robot.mauve, or a plain task set: .json, .csv, .mast, .txt, .xml")
    add("--deployment", metavar="D", help="simulate this deployment only (default: all that are not abstract)")
    formats = "text (default); json; svg: a Gantt chart; perfetto: a trace for ui.perfetto.dev; csv: jobs or segments"
    add("--format", choices=("text", "json", "svg", "perfetto", "csv", "segments-csv"), default="text", help=formats)
    add("-o", "--output", metavar="FILE", help="write the result to a file instead of standard output")
    length = "simulate so long, e.g. 1s (default: the hyperperiod, as far as it is within reach)"
    add("--for", "--until", metavar="TIME", dest="length", type=_duration, help=length)
    add("--hyperperiod", action="store_true", help="simulate the whole hyperperiod, also a long one")
    add("--from", metavar="TIME", dest="start", type=_duration, help="show jobs and segments from this time on")
    add("--to", metavar="TIME", dest="end", type=_duration, help="show jobs and segments up to this time")
    offsets = "when tasks start: all at 0 (default), or each at random"
    add("--offsets", choices=("synchronous", "random"), default="synchronous", help=offsets)
    runs = "transitions taken: the dearest runs (default), at random, or always the first"
    add("--runs", choices=("worst", "random", "first"), default="worst", help=runs)
    add("--jitter", choices=("worst", "random", "none"), help="how late jobs are released (default: as the runs)")
    sporadic = "whether tasks that events wake may come later than their separation says (default: periodic)"
    add("--arrivals", choices=("periodic", "sporadic"), default="periodic", help=sporadic)
    add("--execution", choices=("worst", "random"), default="worst", help="how long codels take (default: worst)")
    order = "who goes first among equal priorities (default: fifo)"
    add("--order", choices=("fifo", "declared", "name", "random"), default="fifo", help=order)
    protocol = "critical sections: immediate ceiling (default), eager ceiling, or ignored"
    add("--protocol", choices=("ceiling", "eager", "none"), default="ceiling", help=protocol)
    add("--seed", metavar="N", type=int, default=0, help="of all random choices (default: 0)")
    add("--events", metavar="N", type=_count, default=1_000_000, help="stop after so many events (default: 1000000)")
    _add_common(parser)


def _duration(text: str) -> tuple[Fraction, str]:
    """A time that is not negative, as a number and its unit (empty for none)."""
    number = text.strip().rstrip("".join(sorted(set("".join(TIME_UNITS)))))
    unit = text.strip()[len(number) :]
    digits = number.strip().replace(".", "", 1)
    if not digits.isdecimal() or not digits.isascii() or len(digits) > 18 or (unit and unit not in TIME_UNITS):
        raise argparse.ArgumentTypeError(f"`{text}` is no time, e.g. 20ms")
    return Fraction(number.strip()), unit


def _add_explain(commands: _Commands) -> None:
    about = "Explain a message: what it means, why it matters, and what to do."
    parser = commands.parser("what a message means", about, "example: mauvec explain MV601")
    parser.add_argument("code", metavar="CODE", help="e.g. MV601, or its name, deadline-missed")


def _add_schedule(commands: _Commands) -> None:
    parser = commands.parser(
        "response times of a plain task set, without a model",
        "Bound the response time of each task of a set with fixed priorities on one processor: mauve.taskset/1 (JSON), "
        "CSV with the columns name, T, D, C, prio, J and B, MAST text, or Cheddar XML.",
        f"example: mauvec schedule tasks.json --sensitivity. {CODES}.",
    )
    add = parser.add_argument
    add("file", metavar="TASKS", help="the task set: .json, .csv, .txt or .mast (MAST), .xml (Cheddar)")
    add("--method", choices=METHODS, default="trace", help="how responses are bounded (default: trace)")
    add("--format", choices=("text", "json"), default="text", help="how the answer is shown (default: text)")
    policy = "given (default; what is missing by rate), rm: rate, dm: deadline monotonic, optimal: Audsley's assignment"
    add("--priorities", choices=("given", "rm", "dm", "optimal"), default="given", help=policy)
    sensitivity = "how much costs, periods, priorities and the processor's speed may change"
    add("--sensitivity", action="store_true", help=sensitivity)
    add("--export", choices=("mast",), help="write the set in this format instead of analysing it")
    add("-o", "--output", metavar="FILE", help="where --export writes (default: standard output)")
    color = "colours: on a terminal unless NO_COLOR is set (auto, the default), always, or never"
    add("--color", choices=("auto", "always", "never"), default="auto", help=color)


COMMANDS: dict[str, Callable[[_Commands], None]] = {
    "check": _add_check,
    "wcet": _add_wcet,
    "facts": _add_facts,
    "mission": _add_mission,
    "simulate": _add_simulate,
    "schedule": _add_schedule,
    "explain": _add_explain,
}
"""What adds the parser of each command; `mauve.cli.NAME.run` runs it."""
