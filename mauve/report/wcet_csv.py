"""Bounds of functions as comma-separated values, a row each (RFC 4180, with plain line ends)."""

from __future__ import annotations

from collections.abc import Sequence

from mauve.wcet.result import WcetResult

HEADINGS = (
    "name", "address", "wcet_cycles", "wcet_ns", "stack_bytes", "loops", "problem", "place", "message", "seconds",
)  # fmt: skip


def format_csv(results: Sequence[WcetResult]) -> str:
    """The table with its headings. What is unknown is empty; `problem`, `place` and `message` are those of the first
    reason for having no bound."""
    import csv
    from io import StringIO

    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADINGS)
    writer.writerows(_row(result) for result in results)
    return text.getvalue()


def _row(result: WcetResult) -> tuple[object, ...]:
    first = result.problems[0] if result.problems else None
    address = "" if result.address is None else f"{result.address:#x}"
    place = ""
    if first is not None:
        place = first.source or ("" if first.address is None else f"{first.address:#x}")
    return (
        result.name,
        address,
        result.cycles,
        None if result.time is None else -(-result.time // 1000),
        result.stack,
        len({(loop.header, loop.function) for loop in result.loops}),
        first.kind.value if first else "",
        place,
        first.message if first else "",
        round(result.seconds, 6),
    )
