"""Input that no analysis can use: a located message, exit code 1, no traceback, bounded time and memory.

Long input is given to a process of its own, whose time and memory the operating system limits.
"""

from __future__ import annotations

import re
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from wcet.fixtures.bad_images import bad_images

from .conftest import ELF, MODEL, WITH_BINARY, Command, Run

MEMORY = 1 << 30
SECONDS = 30
LONG = 4000
"""Bytes of input from which on limits matter."""

MODELS: dict[str, tuple[bytes, str]] = {
    "empty": (b"", "MV001|MV003"),
    "not-utf-8": (b"mauve 1\n// caf\xe9\npackage small\n", "MV002"),
    "utf-16": (MODEL.encode("utf-16"), "MV002"),
    "zeros": (bytes(5000), "MV001|MV003"),
    "elf": (ELF.read_bytes(), "MV002"),
    "10-mb-of-braces": (b"mauve 1\n" + b"{" * 10_000_000, "MV008"),
    "braces-of-a-readable-size": (b"mauve 1\n" + b"{" * 1_000_000, "MV001|MV008"),
    "one-long-line": (b"mauve 1\ncomponent " + b"x" * 1_000_000 + b" {\n", "MV001"),
    "import-cycle": (b"mauve 1\npackage robot\nimport other\n", "MV105"),
    "imports-itself": (b"mauve 1\npackage robot\nimport robot\n", "MV105"),
    "missing-import": (b"mauve 1\nimport no.such.module\n", "MV104"),
    "period-of-0": (MODEL.replace("period 5ms", "period 0ms").encode(), r"MV\d{3}"),
    "negative-period": (MODEL.replace("period 5ms", "period -5ms").encode(), r"MV\d{3}"),
    "negative-time": (MODEL.replace("wcet 40us", "wcet -40us").encode(), r"MV\d{3}"),
    "period-below-a-picosecond": (MODEL.replace("period 5ms", "period 0.1ps").encode(), r"MV\d{3}"),
    "unit-that-does-not-exist": (MODEL.replace("period 5ms", "period 5fortnights").encode(), "MV004"),
    "time-without-unit": (MODEL.replace("period 5ms", "period 5").encode(), r"MV\d{3}"),
    "huge-number": (MODEL.replace("period 5ms", f"period {'9' * 10_000}s").encode(), r"MV\d{3}"),
    "frequency-of-0": (MODEL.replace("at 200MHz", "at 0MHz").encode(), "MV405"),
}

LOCATED = re.compile(r"^robot\.mauve(:\d+:\d+)?: error: .+ \[(MV\d{3})\]$", re.MULTILINE)


@pytest.mark.parametrize("name", MODELS)
def test_models(
    name: str, mauvec: Command, tmp_path: Path, environment: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    data, code = MODELS[name]
    (tmp_path / "robot.mauve").write_bytes(data)
    (tmp_path / "other.mauve").write_bytes(b"mauve 1\npackage other\nimport robot\n")
    monkeypatch.chdir(tmp_path)
    arguments = ["check", "robot.mauve", "--format", "short"]
    run = limited(arguments, tmp_path, environment) if len(data) > LONG else mauvec(*arguments)
    assert (run.code, run.out) == (1, ""), run.err[-2000:]
    assert "Traceback" not in run.err
    found = LOCATED.findall(run.err)
    assert found and re.fullmatch(code, found[0][1]), run.err[-2000:]
    assert len(run.err) < 100_000, "messages do not grow with the input"


@pytest.mark.parametrize("name", ["no-such-file.mauve", ".", "name\nwith lines.mauve"])
def test_files_that_cannot_be_read(name: str, mauvec: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run = mauvec("check", name, "--format", "short")
    assert (run.code, run.out) == (1, "")
    assert len(run.err.splitlines()) == 1 and run.err.endswith("[MV002]\n")


# ----------------------------------------------------------------------------------------------------- executables
IMAGES = bad_images(ELF.read_bytes())
USABLE = ("stripped", "without-sections", "last-byte-missing", "noise", "sections-of-size-zero", "names-outside")
"""These may be read as far as an analysis needs them; what they lack is then the function."""

BINARY_MODEL = MODEL.replace("codel step wcet 1ms", "codel step").replace(
    "  node base on desk {\n", '  node base on desk {\n    binary "bad.elf" {\n      Control.step = "sum"\n    }\n'
)


@pytest.mark.parametrize("name", sorted(IMAGES))
def test_executables_without_a_model(name: str, mauvec: Command, tmp_path: Path) -> None:
    """A message with a code that begins with the file or a source line; never a number for what cannot be read."""
    elf = tmp_path / "bad.elf"
    elf.write_bytes(IMAGES[name])
    run = mauvec("wcet", elf, "sum", "--board", "generic-arm7tdmi")
    assert run.code == (0 if name in USABLE and run.err == "" else 1)
    assert "Traceback" not in run.err and "internal error" not in run.err
    if run.code:
        assert re.search(r"^\S+: error: .+ \[MV5\d\d\]$", run.err, re.MULTILINE)
    if name not in USABLE:
        assert re.search("MV50[23]", run.err)
    assert mauvec("wcet", elf, "--board", "generic-arm7tdmi", "--timeout", "1", "--emit", "cfg").code in (0, 1)


@pytest.mark.parametrize("name", sorted(IMAGES))
def test_executables_of_a_model(name: str, mauvec: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message points at the binary in the model; the rest is still reported."""
    monkeypatch.chdir(tmp_path)
    Path("bad.elf").write_bytes(IMAGES[name])
    Path("robot.mauve").write_text(BINARY_MODEL, encoding="utf-8")
    run = mauvec("check", "robot.mauve", "--format", "short")
    assert "Traceback" not in run.err and "internal error" not in run.err
    if name in USABLE and run.code == 0:
        return
    assert run.code == 1
    assert re.search(r"^robot\.mauve:\d+:\d+: error: .+ \[MV5\d\d\]$", run.err, re.MULTILINE), run.err
    assert "Driver.read" in run.out and "bench: incomplete, no verdict" in run.out


def test_a_stripped_executable_says_what_to_do(mauvec: Command, tmp_path: Path) -> None:
    elf = tmp_path / "bad.elf"
    elf.write_bytes(IMAGES["stripped"])
    named = mauvec("wcet", elf, "sum", "--board", "generic-arm7tdmi")
    assert named.code == 1 and "stripped" in named.err
    every = mauvec("wcet", elf, "--board", "generic-arm7tdmi")
    assert (every.code, every.out) == (1, "")
    assert "no symbols" in every.err and "[MV501]" in every.err


def test_a_model_with_a_stripped_executable_says_so(mauvec: Command, model: Callable[[str], str]) -> None:
    file = model(WITH_BINARY.replace(str(ELF), "stripped.elf"))
    Path("stripped.elf").write_bytes(IMAGES["stripped"])
    run = mauvec("check", file)
    assert run.code == 1 and run.err.count("error[") == 1
    assert "the binary is stripped" in run.err and "sum" in run.err


def test_a_symbol_that_is_data(mauvec: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from mauve.wcet.binary.elf import Binary, load

    binary = load(ELF)
    assert isinstance(binary, Binary)
    data = next(symbol.name for symbol in binary.objects)
    run = mauvec("wcet", ELF, data, "--board", "generic-arm7tdmi")
    assert run.code == 1
    assert f"`{data}` is data at" in run.err and "[MV505]" in run.err
    monkeypatch.chdir(tmp_path)
    text = BINARY_MODEL.replace("bad.elf", str(ELF)).replace('"sum"', f'"{data}"')
    Path("robot.mauve").write_text(text, encoding="utf-8")
    checked = mauvec("check", "robot.mauve", "--format", "short")
    assert checked.code == 1
    assert re.search(r"^robot\.mauve:\d+:\d+: error: .+ \[MV505\]$", checked.err, re.MULTILINE)


def limited(arguments: list[str], folder: Path, environment: dict[str, str]) -> Run:
    """`mauvec` in a process of its own with an upper limit on memory and on time."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))

    done = subprocess.run(
        [sys.executable, "-m", "mauve", *arguments],
        cwd=folder, env=environment, preexec_fn=limit, capture_output=True, text=True, errors="replace",
        timeout=4 * SECONDS, check=False,
    )  # fmt: skip
    return Run(done.returncode, done.stdout, done.stderr)
