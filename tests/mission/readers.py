"""Readers of the exported texts and an explorer, which share no code with what wrote them."""

from __future__ import annotations

import re
from xml.etree import ElementTree

Read = tuple[frozenset[str], dict[str, tuple[frozenset[str], frozenset[str], int]]]
"""The marked places; per transition what it consumes, what it fills, and its priority."""


def read_pnml(text: str) -> Read:
    space = {"p": "http://www.pnml.org/version-2009/grammar/pnml"}
    page = ElementTree.fromstring(text).find("p:net/p:page", space)
    assert page is not None
    marked = {
        place.attrib["id"]
        for place in page.findall("p:place", space)
        if place.findtext("p:initialMarking/p:text", "0", space) == "1"
    }
    found: dict[str, tuple[set[str], set[str], int]] = {
        one.attrib["id"]: (set(), set(), int(one.findtext("p:toolspecific/p:priority", "0", space)))
        for one in page.findall("p:transition", space)
    }
    for arc in page.findall("p:arc", space):
        source, target = arc.attrib["source"], arc.attrib["target"]
        if source in found:
            found[source][1].add(target)
        else:
            found[target][0].add(source)
    return frozenset(marked), {name: (frozenset(a), frozenset(b), c) for name, (a, b, c) in found.items()}


def read_tina(text: str) -> Read:
    word = re.compile(r"\{(?:\\.|[^\\{}])*\}|[^\s]+")
    marked, found, above = set(), {}, dict[str, set[str]]()
    for line in text.splitlines():
        words = word.findall(line)
        if words[0] == "pl" and words[2] == "(1)":
            marked.add(words[1])
        elif words[0] == "tr":
            arrow = words.index("->")
            found[words[1]] = (frozenset(words[words.index("[0,w[") + 1 : arrow]), frozenset(words[arrow + 1 :]))
        elif words[0] == "pr":
            for low in words[words.index(">") + 1 :]:
                above.setdefault(low, set()).update(words[1 : words.index(">")])
    ranks = sorted({len(one) for one in above.values()} | {0}, reverse=True)  # more above it: a lower level
    level = {name: ranks.index(len(above.get(name, ()))) for name in found}
    return frozenset(marked), {name: (*arcs, level[name]) for name, arcs in found.items()}


def read_lola(text: str) -> Read:
    text = re.sub(r"\{[^}]*\}", "", text)
    head, *parts = re.split(r"TRANSITION\s+(\S+)", text)

    def names(listed: str) -> frozenset[str]:
        return frozenset(item.split(":")[0].strip() for item in listed.split(",") if item.strip())

    marking = re.search(r"MARKING([^;]*);", head)
    assert marking is not None
    declared = re.search(r"PLACE([^;]*);", head)
    assert declared is not None and names(marking[1]) <= names(declared[1])
    found = {}
    for name, body in zip(parts[::2], parts[1::2], strict=True):
        arcs = re.fullmatch(r"\s*CONSUME([^;]*);\s*PRODUCE([^;]*);\s*", body)
        assert arcs is not None and names(arcs[1]) | names(arcs[2]) <= names(declared[1])
        found[name] = (names(arcs[1]), names(arcs[2]), 0)
    return names(marking[1]), found


def explore(net: Read, limit: int = 1_000_000) -> tuple[int, int]:
    """How many markings can be reached, and by how many firings. A second token on a place is an error."""
    start, transitions = net
    seen, todo, firings = {start}, [start], 0
    while todo:
        marking = todo.pop()
        enabled = [one for one in transitions.values() if one[0] <= marking]
        urgent = max((level for *_, level in enabled), default=0)
        for before, after, level in enabled:
            if level == urgent:
                firings += 1
                assert not (marking - before) & after, "not 1-safe"
                reached = (marking - before) | after
                if reached not in seen:
                    seen.add(reached)
                    todo.append(reached)
                    assert len(seen) <= limit
    return len(seen), firings
