"""What the first comment of a program says of it: the function to analyse and which globals are its inputs.

    /* entry: run; inputs: text any, count 0..64, steps each 2B -5..5 */

`any` is any content; a range is that of the whole object, or with `each NB` of its elements of N bytes. What an input
is linked with is an example of what may come in. Other globals are state: they start as linked.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mauve.wcet.flow.facts import AssumeFact

HERE = Path(__file__).parent
PROGRAMS = HERE / "programs"
_INPUT = re.compile(r"(\w+)\s+(?:any|(?:each\s+(\d)B\s+)?(-?\d+)\s*\.\.\s*(-?\d+))$")


@dataclass(frozen=True)
class Input:
    """A global that the outside world writes. Without a range (`low` None) its content is any bytes; `width` 0: the
    object is one number."""

    name: str
    low: int | None = None
    high: int | None = None
    width: int = 0


@dataclass(frozen=True)
class Manifest:
    """A program of the corpus: its name, the function that is analysed, its inputs."""

    program: str
    entry: str
    inputs: tuple[Input, ...]

    def facts(self) -> tuple[AssumeFact, ...]:
        """What a user of mauvec would state: each input unknown, or within its range."""
        from mauve.wcet.flow.facts import AssumeFact, AtSymbol

        return tuple(AssumeFact(AtSymbol(one.name), one.low, one.high, one.width) for one in self.inputs)

    def text(self) -> str:
        """The same facts as `mauvec wcet --facts` reads them, without the binary's name."""
        lines = []
        for one in self.inputs:
            each = f" each {one.width}B" if one.width else ""
            said = " any" if one.low is None else f"{each} from {one.low} to {one.high}"
            lines.append(f'assume "{one.name}"{said}')
        return "\n".join(lines)


def read_manifest(source: Path) -> Manifest:
    """The manifest of a program; ValueError where its first comment is none."""
    text = source.read_text(encoding="utf-8")
    found = re.match(r"/\*(.*?)\*/", text, re.DOTALL)
    if found is None:
        raise ValueError(f"{source}: no manifest")
    entry, inputs = "", []
    for part in " ".join(found[1].split()).split(";"):
        key, _, value = part.partition(":")
        if key.strip() == "entry":
            entry = value.strip()
        elif key.strip() == "inputs":
            inputs = [_input(source, word.strip()) for word in value.split(",") if word.strip() not in ("", "none")]
    if not entry:
        raise ValueError(f"{source}: the manifest names no entry")
    return Manifest(source.stem, entry, tuple(inputs))


def _input(source: Path, text: str) -> Input:
    found = _INPUT.match(text)
    if found is None:
        raise ValueError(f"{source}: `{text}` is no input")
    name, width, low, high = found.groups()
    if low is None:
        return Input(name)
    return Input(name, int(low), int(high), int(width or 0))


def sources(only: str = "") -> list[Path]:
    """The programs, or those whose names are in a comma-separated list."""
    every = sorted(PROGRAMS.glob("*.c"))
    if not only:
        return every
    wanted = set(only.split(","))
    missing = wanted - {path.stem for path in every}
    if missing:
        raise SystemExit(f"no such program: {', '.join(sorted(missing))}")
    return [path for path in every if path.stem in wanted]


def content(one: Input, linked: bytes, random: Random) -> bytes:
    """Bytes that an input may hold: near the example it is linked with, small numbers, or anything in its range."""
    size = len(linked)
    if one.low is not None and one.high is not None:
        width = one.width or size
        corners = [value for value in (one.low, one.high, 0, 1) if one.low <= value <= one.high]
        ends = random.random() < 0.3
        numbers = [random.choice(corners) if ends else random.randint(one.low, one.high) for _ in range(size // width)]
        made = b"".join((n & (1 << 8 * width) - 1).to_bytes(width, "little") for n in numbers)
        return made + bytes(size - len(made))
    style = random.randrange(5)
    if style == 0:
        return random.randbytes(size)
    if style == 1:
        few = random.choice([2, 4, 16, 128])
        return bytes(random.randrange(few) for _ in range(size))
    if style == 2:
        return bytes([random.choice([0, 1, 0x20, 0x30, 0x7F, 0x80, 0xFF])]) * size
    changed = bytearray(linked)
    for _ in range(random.randrange(1, 4) if style == 3 else max(1, size // 4)):
        changed[random.randrange(size)] = random.choice([0, 1, 0x20, 0x2C, 0x30, 0x39, 0xFF, random.randrange(256)])
    return bytes(changed)
