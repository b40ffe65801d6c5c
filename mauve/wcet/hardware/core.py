"""Cores: the timing tables of processor cores, read from the data files in `cores/`.

A core file names its manual and section for every entry, and how sure we are of it. Two models interpret the tables:
`bus` counts the cycles of a single bus (S, N, I), `pipeline` counts cycles and the delays after which results can be
used.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from importlib import resources

from mauve.wcet.hardware.classes import TIMING_CLASSES


class CoreModel(Enum):
    """How the numbers of a core file add up."""

    BUS = "bus"
    PIPELINE = "pipeline"


@dataclass(frozen=True, slots=True)
class Linear:
    """constant + per_transfer * n + per_multiplier * m, as the manuals write cycles."""

    constant: int = 0
    per_transfer: int = 0
    per_multiplier: int = 0

    def at(self, transfers: int, multiplier: int) -> int:
        """The value for n words transferred and m multiplier cycles; never below 0."""
        return max(0, self.constant + self.per_transfer * transfers + self.per_multiplier * multiplier)


ZERO = Linear()
ONE = Linear(1)


@dataclass(frozen=True, slots=True)
class Timing:
    """The time of one class of instructions.

    `bus` model: fetches and data accesses, sequential and not, and internal cycles. `pipeline` model: `cycles`, the
    instruction `fetches` it can cause, and for its results `delay` (cycles after the instruction before they can be
    read), `late_delay` (before they can be read as store data or accumulator), `last_only`: only the last one is late.
    """

    source: str
    confidence: str
    cycles: Linear = ZERO
    fetches: Linear = ONE
    delay: int = 0
    late_delay: int = 0
    last_only: bool = False
    fetch_s: Linear = ZERO
    fetch_n: Linear = ZERO
    data_s: Linear = ZERO
    data_n: Linear = ZERO
    internal: Linear = ZERO


@dataclass(frozen=True, slots=True)
class Core:
    """A core. `multiplier` is the safe m of its multiplies. `compositional` says whether delays of different causes may
    be added (with the reason): a core without it gets no wait states and no additive preemption cost."""

    name: str
    title: str
    model: CoreModel
    states: tuple[str, ...]
    multiplier: int
    shared_bus: bool
    compositional: bool
    reason: str
    sources: tuple[str, ...]
    aliases: tuple[str, ...]
    timing: Mapping[str, Timing]


class CoreFileError(Exception):
    """A core file says something that has no meaning: a mistake in the distribution, not of the user."""


_TERM = re.compile(r"\s*([+-]?)\s*(?:(\d+)\s*\*?\s*([nm])?|([nm]))")


def parse_linear(text: str | int) -> Linear:
    """`2`, `n-1`, `m + 1`, `2n+4` as a Linear. CoreFileError for anything else."""
    if isinstance(text, int):
        return Linear(text)
    totals = {"": 0, "n": 0, "m": 0}
    position = 0
    while position < len(text):
        match = _TERM.match(text, position)
        if match is None or (position > 0 and not match[1]):
            raise CoreFileError(f"{text!r} is no sum of numbers, n and m")
        unit = match[3] or match[4] or ""
        value = int(match[2]) if match[2] else 1
        totals[unit] += -value if match[1] == "-" else value
        position = match.end()
    return Linear(totals[""], totals["n"], totals["m"])


_PIPELINE_FIELDS = frozenset({"cycles", "fetches", "delay", "late_delay", "delayed"})
_BUS_FIELDS = frozenset({"fetch_s", "fetch_n", "data_s", "data_n", "internal"})


def parse_timing(key: str, entry: Mapping[str, object], model: CoreModel) -> Timing:
    """An entry of a core file's [timing] table, checked."""
    allowed = _BUS_FIELDS if model is CoreModel.BUS else _PIPELINE_FIELDS
    unknown = set(entry) - allowed - {"source", "confidence"}
    if key not in TIMING_CLASSES:
        raise CoreFileError(f"{key} is no class of instructions")
    if unknown:
        raise CoreFileError(f"{key}: {', '.join(sorted(unknown))} means nothing in the {model.value} model")
    if not entry.get("source") or entry.get("confidence") not in ("high", "medium"):
        raise CoreFileError(f"{key} needs a source and a confidence (high or medium)")

    def linear(name: str, default: Linear) -> Linear:
        value = entry.get(name)
        if value is None:
            return default
        if not isinstance(value, (str, int)):
            raise CoreFileError(f"{key}.{name} is no cycle count")
        return parse_linear(value)

    def number(name: str, default: int) -> int:
        value = entry.get(name, default)
        if not isinstance(value, int) or value < 0:
            raise CoreFileError(f"{key}.{name} is no number of cycles")
        return value

    delay = number("delay", 0)
    timing = Timing(
        source=str(entry["source"]),
        confidence=str(entry["confidence"]),
        cycles=linear("cycles", ZERO),
        fetches=linear("fetches", ONE),
        delay=delay,
        late_delay=number("late_delay", delay),
        last_only=entry.get("delayed", "all") == "last",
        fetch_s=linear("fetch_s", ZERO),
        fetch_n=linear("fetch_n", ZERO),
        data_s=linear("data_s", ZERO),
        data_n=linear("data_n", ZERO),
        internal=linear("internal", ZERO),
    )
    least = timing.cycles if model is CoreModel.PIPELINE else timing.fetch_s
    if least.at(1, 1) == 0 and timing.fetch_n.at(1, 1) == 0:
        raise CoreFileError(f"{key} takes no time")
    return timing


TRANSFERS_OF_CONTROL = ("branch", "branch_link", "branch_exchange", "load_pc", "load_multiple_pc", "alu_pc")


def parse_core(text: str, parent: Core | None = None) -> Core:
    """A core file's text as a Core; `parent` is the core it inherits timing from. CoreFileError when it is
    malformed."""
    data = tomllib.loads(text)
    model = CoreModel(data["model"])
    timing = dict(parent.timing) if parent else {}
    timing |= {key: parse_timing(key, entry, model) for key, entry in data["timing"].items()}
    core = Core(
        name=data["name"],
        title=data["title"],
        model=model,
        states=tuple(data["states"]),
        multiplier=data["multiplier"],
        shared_bus=model is CoreModel.BUS or data.get("shared_bus", False),
        compositional=data["compositional"]["holds"],
        reason=data["compositional"]["reason"],
        sources=tuple(data["sources"]),
        aliases=tuple(data["aliases"]),
        timing=timing,
    )
    # Result delays are followed along straight code only: this makes every transfer of control long enough to hide
    # them.
    longest = max(max(entry.delay, entry.late_delay) for entry in timing.values())
    for key in TRANSFERS_OF_CONTROL:
        if key in timing and model is CoreModel.PIPELINE and timing[key].cycles.at(1, 0) < longest:
            raise CoreFileError(f"{core.name}: {key} is shorter than a result delay of {longest}")
    return core


def core_names() -> tuple[str, ...]:
    """The names of all cores, aliases included, in alphabetical order."""
    return tuple(sorted(_file_of_names()))


def load_core(name: str) -> Core | None:
    """The core of that name or alias (case does not matter), None when there is none."""
    file = _file_of_names().get(name.lower())
    return None if file is None else _load_file(file)


def _load_file(file: str) -> Core:
    text = (_folder() / file).read_text(encoding="utf-8")
    parent = tomllib.loads(text).get("inherits")
    return parse_core(text, load_core(parent) if parent else None)


def _file_of_names() -> dict[str, str]:
    """Core names and aliases with the name of their file. Reads only the heads of the files."""
    names: dict[str, str] = {}
    for file in sorted(_folder().iterdir(), key=lambda entry: entry.name):
        if file.name.endswith(".toml"):
            head = tomllib.loads(file.read_text(encoding="utf-8").partition("\n[timing]")[0])
            for name in (head["name"], *head["aliases"]):
                names[name.lower()] = file.name
    return names


def _folder() -> resources.abc.Traversable:
    return resources.files("mauve.wcet.hardware") / "cores"
