"""Results as data: the JSON document `mauve.wcet/1` (docs/schema/wcet-1.schema.json)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from mauve.wcet.hardware.board import Board
from mauve.wcet.result import BlockResult, CallResult, ExclusiveResult, LoopResult, Problem, WcetResult

SCHEMA = "mauve.wcet/1"


def document(binary: str, board: Board, results: Iterable[WcetResult]) -> dict[str, Any]:
    """The document of one run: the executable's name as given, the board, and every function's result."""
    return {
        "schema": SCHEMA,
        "binary": binary,
        "board": {"name": board.name, "core": board.core, "hertz": board.hertz},
        "functions": [function(result) for result in results],
    }


def function(result: WcetResult) -> dict[str, Any]:
    """One function. `wcet_cycles` and `wcet_ns` (rounded up) are null exactly when `unresolved` is not empty."""
    return {
        "name": result.name,
        "address": result.address,
        "wcet_cycles": result.cycles,
        "wcet_ns": None if result.time is None else -(-result.time // 1000),
        "blocks": [_block(block) for block in result.blocks],
        "loops": [_loop(loop) for loop in result.loops],
        "calls": [_call(call) for call in result.calls],
        "unresolved": [_problem(problem) for problem in result.problems],
        "notes": [_problem(note) for note in result.notes],
        "assumptions": list(result.assumptions),
        "stack_bytes": result.stack,
        "globals": [{"symbol": use.symbol, "reads": use.reads, "writes": use.writes} for use in result.globals],
        "exclusive": [_exclusive(group) for group in result.exclusive],
        "seconds": round(result.seconds, 6),
    }


def _block(block: BlockResult) -> dict[str, Any]:
    return {
        "address": block.address,
        "size": block.size,
        "function": block.function,
        "source": block.source,
        "count": block.count,
        "cycles": block.cycles,
        "total_cycles": block.total,
    }


def _loop(loop: LoopResult) -> dict[str, Any]:
    return {
        "header": loop.header,
        "source": loop.source,
        "function": loop.function,
        "context": loop.context,
        "bound": loop.bound,
        "total": loop.total,
        "origin": None if loop.origin is None else loop.origin.value,
        "method": loop.method,
    }


def _exclusive(group: ExclusiveResult) -> dict[str, Any]:
    branches = [{"address": b.address, "source": b.source, "condition": b.condition} for b in group.branches]
    return {"function": group.function, "loop": group.loop, "branches": branches}


def _call(call: CallResult) -> dict[str, Any]:
    return {"function": call.function, "address": call.address, "count": call.count, "cycles": call.cycles}


def _problem(problem: Problem) -> dict[str, Any]:
    return {
        "kind": problem.kind.value,
        "address": problem.address,
        "function": problem.function,
        "source": problem.source,
        "message": problem.message,
        "call_path": list(problem.call_path),
        "suggestions": list(problem.suggestions),
        "written": problem.written,
    }
