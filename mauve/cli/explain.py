"""`mauvec explain`: the page of a message."""

from __future__ import annotations

from argparse import Namespace

from mauve.cli.output import wrong_usage
from mauve.diagnostics.explain import explanation, near


def run(arguments: Namespace) -> int:
    """Print the page; 2 where there is no such message."""
    text = explanation(arguments.code)
    if text is not None:
        print(text.rstrip())
        return 0
    similar = ", ".join(f"`{code}`" for code in near(arguments.code))
    return wrong_usage(f"there is no message `{arguments.code}`" + (f"; there is {similar}" if similar else ""))
