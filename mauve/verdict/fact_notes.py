"""What several analyses of one binary noticed about flow facts, put together.

A fact that matches nothing in one function usually belongs to another: it is unused only when no function used it.
"""

from __future__ import annotations

from collections.abc import Sequence

from mauve.wcet.result import Problem, ProblemKind, WcetResult


def collected_notes(results: Sequence[WcetResult]) -> tuple[Problem, ...]:
    """Each note once, in the order found, without facts that some other function of the run used."""
    notes: dict[tuple[object, ...], Problem] = {}
    unused_in: dict[str, int] = {}
    for result in results:
        for note in result.notes:
            notes.setdefault((note.kind, note.written, note.message), note)
        for written in {n.written for n in result.notes if n.kind is ProblemKind.FACT_NOWHERE}:
            unused_in[written] = unused_in.get(written, 0) + 1
    return tuple(
        note
        for note in notes.values()
        if note.kind is not ProblemKind.FACT_NOWHERE or unused_in[note.written] == len(results)
    )
