"""Cases of `mauvec check` written in Markdown: sources and the exact expected messages side by side.

A case is a run of fenced blocks that ends with a `text` block:

* `mauve` is a source file; the first one of a case is the one checked. Its name is `robot.mauve` unless the fence says
  `title="other.mauve"`. Further sources, and blocks of any language that have a title, are files beside it. With
  `shared=yes` a file is there for every later case of the page.
* `files` copies files of the checkout: `robot.elf = tests/check/data/some.elf`, one a line.
* `options` adds command line arguments, one or more a line.
* `text` is what the command prints on standard error, in the format `full` without colour. The exit code must be 1
  where it holds an error, else 0; `exit=N` on the fence says otherwise.

Everything else is prose. A case is named after the nearest heading above it.
"""

from __future__ import annotations

import contextlib
import difflib
import io
import re
import shlex
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

Main = Callable[[list[str]], int]

_FENCE = re.compile(r"```(\w+)\s*(.*)")
_ATTRIBUTE = re.compile(r'(\w+)=(?:"([^"]*)"|(\S+))')


@dataclass
class Case:
    """One check: the files to write, what to copy, the arguments, and the expected messages.

    `line` is the line of the `text` fence (from 1), `block` the ordinal of that block among all fenced blocks.
    """

    name: str
    line: int
    block: int
    expected: str
    files: dict[str, str]
    copies: dict[str, str] = field(default_factory=dict)
    options: list[str] = field(default_factory=list)
    exit_code: int | None = None


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, attributes and text, and the index of the lines between its fences."""

    language: str
    attributes: dict[str, str]
    first: int
    last: int
    text: str


def blocks(markdown: str) -> list[tuple[str, Block]]:
    """The fenced blocks of a page, each with the heading it stands under."""
    found: list[tuple[str, Block]] = []
    heading = ""
    lines = markdown.split("\n")
    index = 0
    while index < len(lines):
        fence = _FENCE.fullmatch(lines[index].rstrip())
        if fence is None:
            if lines[index].startswith("#"):
                heading = lines[index].lstrip("#").strip()
            index += 1
            continue
        end = next((i for i in range(index + 1, len(lines)) if lines[i].rstrip() == "```"), None)
        if end is None:
            raise ValueError(f"the fence of line {index + 1} is not closed")
        attributes = {name: quoted or bare for name, quoted, bare in _ATTRIBUTE.findall(fence[2])}
        text = "\n".join(lines[index + 1 : end])
        found.append((heading, Block(fence[1], attributes, index + 1, end, text)))
        index = end + 1
    return found


def cases(markdown: str) -> list[Case]:
    """The cases of a page, in order. Raises ValueError where blocks do not add up to cases."""
    found: list[Case] = []
    shared: dict[str, str] = {}
    current = Case("", 0, 0, "", {})
    for number, (heading, block) in enumerate(blocks(markdown)):
        match block.language:
            case "text":
                if not current.files:
                    raise ValueError(f"the messages of line {block.first} have no source before them")
                count = sum(c.name.split(" #")[0] == heading for c in found)
                current.name = f"{heading} #{count + 1}" if count else heading
                current.line, current.block, current.expected = block.first, number, block.text
                current.files |= shared
                current.exit_code = int(block.attributes["exit"]) if "exit" in block.attributes else None
                found.append(current)
                current = Case("", 0, 0, "", {})
            case "options":
                current.options.extend(shlex.split(block.text))
            case "files":
                pairs = (line.partition("=") for line in block.text.splitlines() if line.strip())
                current.copies.update({name.strip(): source.strip() for name, _, source in pairs})
            case language:
                title = block.attributes.get("title", "robot.mauve" if language == "mauve" else "")
                if title in current.files or title in shared:
                    raise ValueError(f"the file {title} of line {block.first} is given twice")
                if title:
                    files = shared if "shared" in block.attributes else current.files
                    files[title] = block.text + ("\n" if block.text else "")
    if current.files:
        raise ValueError(f"the last source ({next(iter(current.files))}) has no messages after it")
    return found


def run(case: Case, main: Main, folder: Path, root: Path) -> tuple[int, str]:
    """Exit code and standard error of `mauvec check` on a case, run in an empty folder."""
    for name, text in case.files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    for name, source in case.copies.items():
        shutil.copy(root / source, folder / name)
    checked = next(name for name in case.files if name.endswith(".mauve"))
    out, err = io.StringIO(), io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main(["check", checked, "--format", "full", *case.options])
        except SystemExit as stop:
            code = stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    return code, err.getvalue()


def difference(case: Case, code: int, printed: str) -> str:
    """What is not as the case says, as a diff; empty where all is."""
    expected, got = case.expected.strip("\n"), printed.strip("\n")
    if expected != got:
        diff = difflib.unified_diff(expected.split("\n"), got.split("\n"), "expected", "printed", lineterm="", n=99)
        return "\n".join(diff)
    wanted = case.exit_code if case.exit_code is not None else int("error[" in expected)
    return "" if code == wanted else f"the messages are as expected, the exit code is {code}, not {wanted}"


def rewritten(markdown: str, block: int, printed: str) -> str:
    """The page with the text of one block replaced."""
    chosen = blocks(markdown)[block][1]
    lines = markdown.split("\n")
    body = printed.strip("\n")
    lines[chosen.first : chosen.last] = body.split("\n") if body else []
    return "\n".join(lines)
