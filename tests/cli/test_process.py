"""The command line as a process: usage, colours, interrupts, pipes, faults of our own, and what it imports."""

from __future__ import annotations

import os
import pty
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import mauve
from mauve.cli import main

from .conftest import ELF, MISSED, MODEL, WITH_BINARY, Command

Write = Callable[..., str]


# ------------------------------------------------------------------------------------------------------------- usage
def test_version(mauvec: Command) -> None:
    run = mauvec("--version")
    assert (run.code, run.out) == (0, f"mauvec {mauve.__version__}\n")


@pytest.mark.parametrize("command", [(), ("check",), ("wcet",), ("simulate",), ("explain",)])
def test_help(command: tuple[str, ...], mauvec: Command) -> None:
    """Every command has a description and says what each of its arguments is."""
    run = mauvec(*command, "--help")
    assert (run.code, run.err) == (0, "")
    options = re.findall(r"^  (-{1,2}\S+|[A-Z]+)(.*)$", run.out, re.MULTILINE)
    assert options
    assert run.out.startswith("usage: mauvec " + (command[0] if command else "["))
    assert ("exit" in run.out or "example" in run.out) and len(run.out) > 200


@pytest.mark.parametrize(
    "arguments",
    [
        (),
        ("check",),
        ("check", "robot.mauve", "--format", "xml"),
        ("check", "robot.mauve", "--method", "guess"),
        ("check", "robot.mauve", "--emit", "everything"),
        ("check", "robot.mauve", "--form", "short"),
        ("wcet", "robot.elf"),
        ("wcet", "robot.elf", "--board", "b", "--timeout", "-1"),
        ("wcet", "robot.elf", "--board", "b", "--timeout", "soon"),
        ("wcet", "robot.elf", "--board", "b", "--jobs", "0"),
        ("explain",),
        ("explain", "MV999"),
    ],
)
def test_wrong_usage(arguments: tuple[str, ...], mauvec: Command) -> None:
    run = mauvec(*arguments)
    assert (run.code, run.out) == (2, "")
    assert "mauvec" in run.err


@pytest.mark.parametrize(("typed", "meant"), [("chek", "check"), ("wect", "wcet"), ("explian", "explain")])
def test_a_misspelt_command(typed: str, meant: str, mauvec: Command) -> None:
    run = mauvec(typed, "robot.mauve")
    assert run.code == 2
    assert f"there is no command `{typed}`; did you mean `{meant}`?" in run.err


def test_an_unknown_deployment(mauvec: Command, model: Write) -> None:
    run = mauvec("check", model(MODEL), "--deployment", "bnech")
    assert (run.code, run.out) == (2, "")
    assert run.err == "mauvec: there is no deployment `bnech`; the model has `bench`\n"


def test_explain(mauvec: Command) -> None:
    run = mauvec("explain", "mv601")
    assert run.code == 0
    assert run.out.startswith("# MV601 deadline-missed")
    assert mauvec("explain", "deadline-missed").out == run.out


# ----------------------------------------------------------------------------------------------------------- colours
def on_a_terminal(arguments: list[str], environment: dict[str, str], **more: str) -> str:
    """What a person sees: standard output and error are one terminal of 100 columns."""
    master, slave = pty.openpty()
    child = {**environment, "TERM": "xterm", "COLUMNS": "100", **more}
    process = subprocess.Popen([sys.executable, "-m", "mauve", *arguments], stdout=slave, stderr=slave, env=child)
    os.close(slave)
    seen = b""
    while True:
        try:
            part = os.read(master, 65536)
        except OSError:
            break
        if not part:
            break
        seen += part
    os.close(master)
    process.wait(timeout=60)
    return seen.decode().replace("\r\n", "\n")


def test_colours_on_a_terminal_only(model: Write, mauvec: Command, environment: dict[str, str]) -> None:
    file = model(MODEL)
    assert "\x1b[" in on_a_terminal(["check", file], environment)
    assert "\x1b[" not in on_a_terminal(["check", file], environment, NO_COLOR="1")
    assert "\x1b[" not in on_a_terminal(["check", file], environment, TERM="dumb")
    assert "\x1b[" not in on_a_terminal(["check", file, "--color", "never"], environment)
    piped, forced = mauvec("check", file), mauvec("check", file, "--color", "always")
    assert "\x1b[" not in piped.out and "\x1b[" in forced.out
    assert re.sub(r"\x1b\[[0-9;]*m", "", forced.out) == piped.out, "colours change nothing else"


def test_tables_keep_to_the_width_of_a_terminal(model: Write, environment: dict[str, str]) -> None:
    long = "an_instance_name_of_a_length_that_only_a_generator_would_choose_to_give"
    file = model(MODEL.replace("control:", f"{long}:"))
    seen = on_a_terminal(["check", file, "--color", "never"], environment)
    rows = [line for line in seen.splitlines() if line.startswith("  an_inst")]
    assert len(rows) == 1 and "…" in rows[0]
    assert rows[0].endswith("holds"), "the verdict is never cut"
    assert max(len(line) for line in seen.splitlines() if line.startswith("  ") and "response times" not in line) <= 100


# ----------------------------------------------------------------------------------- interrupts, pipes, our own faults
def test_an_interrupt_ends_without_a_traceback(
    mauvec: Command, model: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("mauve.pipeline.check_deployment", interrupted)
    run = mauvec("check", model(MODEL))
    assert (run.code, run.out, run.err) == (130, "", "mauvec: interrupted\n")


def test_an_interrupt_ends_all_processes_of_a_batch(environment: dict[str, str]) -> None:
    """Ctrl-C while two processes work: one line, no traceback of anybody, nobody left behind."""
    process = subprocess.Popen(
        [sys.executable, "-m", "mauve", "wcet", str(ELF), "--board", "generic-arm7tdmi", "--jobs", "2", "--no-cache"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, start_new_session=True,
    )  # fmt: skip
    group = os.getpgid(process.pid)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    until = time.monotonic() + 60
    while len(children.read_text(encoding="ascii").split()) < 2 and time.monotonic() < until:
        time.sleep(0.05)
    time.sleep(0.3)
    os.kill(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, out, err) == (130, "", "mauvec: interrupted\n")
    with pytest.raises(ProcessLookupError):
        os.killpg(group, 0)


def test_a_reader_that_goes_away(model: Write, environment: dict[str, str]) -> None:
    file = model(MODEL)
    process = subprocess.Popen(
        [sys.executable, "-m", "mauve", "check", file], stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment
    )
    assert process.stdout is not None and process.stderr is not None
    process.stdout.close()
    err = process.stderr.read()
    process.stderr.close()
    assert (process.wait(timeout=60), err) == (141, b"")


@pytest.mark.parametrize("format_", ["full", "json"])
def test_a_disk_without_room_for_the_output(model: Write, environment: dict[str, str], format_: str) -> None:
    command = [sys.executable, "-m", "mauve", "check", model(MODEL), "--format", format_]
    with open("/dev/full", "wb") as full:
        run = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, env=environment, timeout=60)
    assert (run.returncode, run.stderr) == (74, "mauvec: cannot write the output: no space left on device\n")


@pytest.mark.parametrize("error", [ValueError("a\nb"), RecursionError(), MemoryError(), AssertionError()])
def test_a_fault_of_ours_is_one_line(
    error: Exception, mauvec: Command, model: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise error

    monkeypatch.setattr("mauve.pipeline.check_deployment", fails)
    run = mauvec("check", model(MODEL))
    assert (run.code, run.out) == (70, "")
    (line,) = run.err.splitlines()
    assert line.startswith(f"mauvec: internal error [MV901]: {type(error).__name__}") and "report" in line
    monkeypatch.setenv("MAUVEC_TRACEBACK", "1")
    with pytest.raises(type(error)):
        main(["check", "robot.mauve"])


def test_an_encoding_that_cannot_show_a_name(tmp_path: Path, environment: dict[str, str]) -> None:
    file = tmp_path / "röbot.mauve"
    file.write_text(MISSED, encoding="utf-8")
    environment = {**environment, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    command = [sys.executable, "-m", "mauve", "check", str(file), "--format", "github"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "r\\xf6bot.mauve" in done.stdout


# ---------------------------------------------------------------------------------------------------------- start-up
HEAVY = ("capstone", "pulp", "elftools", "numpy", "scipy", "networkx", "unicorn", "lark", "multiprocessing")


def imported(arguments: list[str], environment: dict[str, str]) -> set[str]:
    """The top-level packages that a run imports."""
    command = [sys.executable, "-X", "importtime", "-m", "mauve", *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-1000:]
    return {match.split(".")[0] for match in re.findall(r"^import time:.*\| +(\S+)$", done.stderr, re.MULTILINE)}


def test_a_check_without_binaries_imports_nothing_heavy(
    model: Write, mauvec: Command, environment: dict[str, str]
) -> None:
    file = model(MODEL)
    mauvec("check", file)
    found = imported(["check", file], environment)
    assert "mauve" in found
    assert found & {*HEAVY, "sqlite3"} == set()


def test_a_check_with_an_unchanged_binary_imports_nothing_heavy(
    model: Write, mauvec: Command, environment: dict[str, str]
) -> None:
    file = model(WITH_BINARY)
    assert mauvec("check", file).code == 0
    assert imported(["check", file], environment) & set(HEAVY) == set()
