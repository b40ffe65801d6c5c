"""A net in the format of LoLA, which knows no priorities: its readers see all interleavings.

    PLACE a, b;  MARKING a: 1;  TRANSITION t  CONSUME a: 1;  PRODUCE b: 1;

Without priorities a mission's net need not be 1-safe. `complete` makes it so: with a complement for each place, a
transition waits until the places that it fills are empty. This is for comparing tools on equal nets, not for analysis.
"""

from __future__ import annotations

import re

from mauve.mission.net import Net, Transition
from mauve.records import changed

__all__ = ["complete", "lola"]


def lola(net: Net) -> str:
    """The text of a LoLA net. Characters that LoLA keeps for itself become underscores; clashes get a number."""
    places, transitions = _words(net.places), _words([one.name for one in net.transitions])
    lines = [f"{{ {_word(net.name)}: without the priorities of its transitions }}", ""]
    lines += [f"PLACE {', '.join(places)};", "", f"MARKING {_tokens(places, net.initial)};", ""]
    for name, one in zip(transitions, net.transitions, strict=True):
        lines += [f"TRANSITION {name}", f"CONSUME {_tokens(places, one.before)};"]
        lines += [f"PRODUCE {_tokens(places, one.after)};", ""]
    return "\n".join(lines)


def complete(net: Net) -> Net:
    """The net with a complement for each place, all on one level: 1-safe whatever the order of firing."""
    count, marked = len(net.places), set(net.initial)

    def completed(one: Transition) -> Transition:
        taken, filled = set(one.before) - set(one.after), set(one.after) - set(one.before)
        before = (*one.before, *(count + place for place in sorted(filled)))
        after = (*one.after, *(count + place for place in sorted(taken)))
        return changed(one, before=before, after=after)

    initial = (*net.initial, *(count + place for place in range(count) if place not in marked))
    names = (*net.places, *(f"no {place}" for place in net.places))
    return changed(net, places=names, transitions=tuple(map(completed, net.transitions)), initial=initial)


def _tokens(names: list[str], places: tuple[int, ...]) -> str:
    return ", ".join(f"{names[place]}: 1" for place in places)


def _word(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_.]", "_", name)


def _words(names: tuple[str, ...] | list[str]) -> list[str]:
    taken: dict[str, str] = {}
    for name in names:
        word, number = _word(name), 2
        while word in taken:
            word, number = f"{_word(name)}_{number}", number + 1
        taken[word] = name
    return list(taken)
