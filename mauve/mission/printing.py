"""A net as text for people: its places by the part they belong to, its transitions by level."""

from __future__ import annotations

from mauve.mission.net import Level, Net, Transition

TITLES = {
    Level.RESOURCE: "level 4: resources and activities",
    Level.CHOICE: "level 3: choice of alternatives",
    Level.STOP: "level 2: stop of what nobody asks for",
    Level.MISSION: "level 1: mission",
    Level.EVENT: "level 0: events",
}


def net_text(net: Net) -> str:
    """The net: `*` marks places with a token at first, `?` places that are only read."""
    lines = [f"net {net.name}: {len(net.places)} places, {len(net.transitions)} transitions", "", "places"]
    marked = frozenset(net.initial)
    groups: dict[str, list[str]] = {}
    for place, name in enumerate(net.places):
        group = net.groups[place] if net.groups else ""
        short = name.removeprefix(f"{group}.") if group else name
        groups.setdefault(group, []).append(short + ("*" if place in marked else ""))
    width = max((len(group) for group in groups), default=0)
    for group, names in groups.items():
        lines += _wrapped(f"  {group or '(mission)':{max(width, 9)}}  ", names)
    for level in reversed(Level):
        of_level = [one for one in net.transitions if one.level is level]
        if of_level:
            lines += ["", TITLES[level]]
            lines += [f"  {_transition(net, one)}" for one in of_level]
    return "\n".join(lines) + "\n"


def _transition(net: Net, one: Transition) -> str:
    after = frozenset(one.after)
    before = [net.places[place] + ("?" if place in after else "") for place in one.before]
    new = [net.places[place] for place in one.after if place not in one.before]
    event = f"  [{one.event}]" if one.event else ""
    return f"{one.name}: {' + '.join(before)} -> {' + '.join(new) or '-'}{event}"


def _wrapped(title: str, names: list[str], width: int = 118) -> list[str]:
    lines, line = [], title
    for name in names:
        if len(line) + len(name) > width and line.strip():
            lines.append(line.rstrip())
            line = " " * len(title)
        line += name + "  "
    return [*lines, line.rstrip()]
