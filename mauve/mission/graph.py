"""The alternatives graph: the stable states of a mission and the events between them (mission paper, section 7)."""

from __future__ import annotations

from mauve.records import record


@record
class Edge:
    """An event leads from one stable state to another; states are indices."""

    source: int
    event: str
    target: int


@record
class StateView:
    """What a person sees of a stable state.

    objectives: paths of the active ones; running: (activity, alternative); lost: hardware out of service; outcome:
    "success", "failure" or "" while the mission goes on.
    """

    objectives: tuple[str, ...]
    running: tuple[tuple[str, str], ...]
    lost: tuple[str, ...]
    outcome: str
