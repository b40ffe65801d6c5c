"""A net in the format of TINA (`.net`), with its priorities.

    net NAME
    pl PLACE (1)
    tr TRANSITION : EVENT [0,w[ PLACE .. -> PLACE ..
    pr TRANSITION .. > TRANSITION ..

Names that are more than letters, digits and underscores stand in braces. A place on both sides is consumed and filled
again, which in a net without time is a test. An event is the label of its transition.
"""

from __future__ import annotations

import re

from mauve.mission.net import Level, Net

__all__ = ["tina"]


def tina(net: Net) -> str:
    """The text of a .net file. Each level is written as more urgent than all levels below it."""
    lines = [f"net {_word(net.name)}"]
    lines += [f"pl {_word(net.places[place])} (1)" for place in sorted(net.initial)]
    marked = set(net.initial)
    lines += [f"pl {_word(place)} (0)" for number, place in enumerate(net.places) if number not in marked]
    for one in net.transitions:
        label = f" : {_word(one.event)}" if one.event else ""
        before = "".join(f" {_word(net.places[place])}" for place in one.before)
        after = "".join(f" {_word(net.places[place])}" for place in one.after)
        lines.append(f"tr {_word(one.name)}{label} [0,w[{before} ->{after}")
    for level in sorted(Level, reverse=True):
        urgent = [_word(one.name) for one in net.transitions if one.level == level]
        others = [_word(one.name) for one in net.transitions if one.level < level]
        if urgent and others:
            lines.append(f"pr {' '.join(urgent)} > {' '.join(others)}")
    return "\n".join(lines) + "\n"


def _word(name: str) -> str:
    if re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name) and name not in ("net", "tr", "pl", "pr", "lb", "nt", "w"):
        return name
    return "{" + re.sub(r"([\\{}])", r"\\\1", name) + "}"
