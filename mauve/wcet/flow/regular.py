"""Calls of floating-point helpers whose operands are never subnormal numbers: zero or of full precision, or no numbers.

libgcc's multiplication and division normalise a subnormal operand in a loop of up to 52 passes, ten times as long as
the rest. Where a routine of libm is proven never to pass one (`library/regular.toml`), its calls are contexts in which
these loops are not entered.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib import resources

from mauve.records import record
from mauve.wcet.binary.graph import Cfg, EdgeKind
from mauve.wcet.flow.library import FORMAT, Recognised, fingerprint
from mauve.wcet.flow.result import FunctionFlow

WORDS = "no subnormal operands"
"""What the context is called."""


@record
class Regular:
    """A routine whose calls of helpers pass no subnormal operands, but for those at some offsets from its start; one
    that `reduces` an angle takes twenty times as long for a large one."""

    names: tuple[str, ...]
    found: tuple[str, ...]
    but: frozenset[int]
    proof: str
    reduces: bool = False


def regular_calls(cfg: Cfg) -> frozenset[int]:
    """The edges of calls that pass no subnormal operands; empty for a function that is not in the table."""
    known = regular_routines().get(fingerprint(cfg))
    if known is None:
        return frozenset()
    return frozenset(
        index
        for index, edge in enumerate(cfg.edges)
        if edge.kind is EdgeKind.CALL
        and cfg.blocks[edge.source].instructions[-1].address - cfg.address not in known.but
    )


def reduces(cfg: Cfg) -> bool:
    """Whether a function reduces an angle, a double in r0 and r1, to what is left of a multiple of pi/2."""
    known = regular_routines().get(fingerprint(cfg)) if cfg.name.startswith("_") else None
    return known is not None and known.reduces


def without_subnormals(flow: FunctionFlow, recognised: tuple[Recognised, ...]) -> FunctionFlow | None:
    """A helper's flow where no operand is subnormal; None where that changes nothing."""
    cfg = flow.cfg
    headers = {
        part.address + loop.offset: part.blocks for part in recognised for loop in part.known.loops if loop.subnormal
    }
    entering: set[int] = set()
    for loop in flow.nest.loops:
        if loop.header in headers.get(cfg.blocks[loop.header].address, ()):
            entering |= {i for i, edge in enumerate(cfg.edges) if edge.target == loop.header} - set(loop.back_edges)
    return None if entering <= flow.infeasible else replace(flow, infeasible=flow.infeasible | entering)


@cache
def regular_routines() -> Mapping[str, Regular]:
    """The table, by fingerprint."""
    text = resources.files("mauve.wcet.flow").joinpath("library", "regular.toml").read_text(encoding="utf-8")
    data = tomllib.loads(text)
    if data["format"] != FORMAT:
        return {}
    return {
        entry["fingerprint"]: Regular(
            tuple(entry["names"]),
            tuple(entry["found"]),
            frozenset(entry["but"]),
            data["proofs"][entry["proof"]],
            entry["proof"] == "reduction",
        )
        for entry in data["routine"]
    }
