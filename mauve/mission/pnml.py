"""A net in PNML (ISO/IEC 15909-2): a place/transition net, with priorities and events as tool-specific data.

Core PNML has no priorities: a reader that ignores `toolspecific` sees more behaviour than there is.
"""

from __future__ import annotations

from xml.sax.saxutils import escape, quoteattr

from mauve.mission.net import Net, Transition

__all__ = ["pnml"]

SPACE = "http://www.pnml.org/version-2009/grammar/pnml"
TYPE = "http://www.pnml.org/version-2009/grammar/ptnet"


def pnml(net: Net) -> str:
    """The text of a PNML file with one page. Identifiers are p0, p1, .. and t0, t1, .. in the order of the net."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f"<pnml xmlns={quoteattr(SPACE)}>"]
    lines += [f'  <net id="net" type={quoteattr(TYPE)}>', f"    {_name(net.name)}", '    <page id="page">']
    marked = set(net.initial)
    for number, place in enumerate(net.places):
        tokens = "<initialMarking><text>1</text></initialMarking>" if number in marked else ""
        lines.append(f'      <place id="p{number}">{_name(place)}{tokens}</place>')
    for number, transition in enumerate(net.transitions):
        lines.append(f'      <transition id="t{number}">{_name(transition.name)}{_priority(transition)}</transition>')
    for number, transition in enumerate(net.transitions):
        lines += [f"      {_arc(f'p{place}', f't{number}')}" for place in transition.before]
        lines += [f"      {_arc(f't{number}', f'p{place}')}" for place in transition.after]
    return "\n".join([*lines, "    </page>", "  </net>", "</pnml>", ""])


def _name(text: str) -> str:
    return f"<name><text>{escape(text)}</text></name>"


def _priority(transition: Transition) -> str:
    event = f"<event>{escape(transition.event)}</event>" if transition.event else ""
    inside = f"<priority>{int(transition.level)}</priority>{event}"
    return f'<toolspecific tool="mauvec" version="1">{inside}</toolspecific>'


def _arc(source: str, target: str) -> str:
    return f'<arc id="{source}_{target}" source="{source}" target="{target}"/>'
