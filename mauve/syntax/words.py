"""Symbols of the grammar in a reader's words, for messages about syntax."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from mauve.syntax.table import Table
from mauve.syntax.tokens import END, Token

GROUPS: tuple[tuple[str, frozenset[str], str], ...] = (
    (
        "STRUCT",
        frozenset({"STRUCT", "ENUM", "COMPONENT", "PASSIVE", "EXTERNAL", "LIFECYCLE"})
        | {"ARCHITECTURE", "BOARD", "ABSTRACT", "DEPLOYMENT", "BINARY"}
        | {"HARDWARE", "RESOURCE", "ACTIVITY", "OBJECTIVE", "MISSION"},
        "a declaration",
    ),
    ("PROPERTY", frozenset({"IN", "OUT", "EVENT"}), "a port"),
    ("PROPERTY", frozenset({"PROPERTY", "VAR", "OPERATION", "METHOD", "BEHAVIOUR"}), "another member"),
    ("PROPERTY", frozenset({"CODEL", "INIT"}), "a codel"),
    ("RUN", frozenset({"ENTRY", "MESSAGE", "METHOD", "RUN", "EXIT"}), "an activity"),
    ("RUN", frozenset({"ARROW"}), "a transition"),
    ("RUN", frozenset({"REGION"}), "a region"),
    ("STATE", frozenset({"STATE", "INITIAL", "FINAL"}), "a state"),
    ("REGION", frozenset({"REGION"}), "a region"),
    ("INSTANCE", frozenset({"INSTANCE"}), "an instance"),
    ("INSTANCE", frozenset({"CONNECT", "EXTERNAL"}), "a connection"),
    ("INSTANCE", frozenset({"FLOW"}), "a flow"),
    ("CPU", frozenset({"CPU", "ICACHE", "DCACHE", "MMU", "PREFETCH", "MEMORY", "OS"}), "a part of the board"),
    ("CHECK", frozenset({"CHECK", "REPORT", "GENERATE", "ACCEPTS"}), "a check or another item of the mission"),
    ("ALWAYS", frozenset({"NOT", "ALWAYS", "EVENTUALLY", "NEXT", "LPAR", "RUNNING", "OUT_OF_SERVICE", "ACTIVE"})
     | {"SUCCESS", "FAILURE", "TRUE", "FALSE"}, "a formula"),
    ("LIVE", frozenset({"LIVE", "BOUNDED", "DETERMINISTIC", "SUCCESS"}), "a property"),
    ("NUMBER", frozenset({"NUMBER", "HEX", "EXPONENT"}), "a number"),
    ("QUANTITY", frozenset({"QUANTITY"}), "a number with its unit"),
    ("STRING", frozenset({"STRING"}), "a text in quotes"),
)
"""Where the first terminal may stand, the set is told by the words."""

DECLARED = {
    "COMPONENT": "component", "STRUCT": "struct", "ENUM": "enumeration", "CODEL": "codel", "STATE": "state",
    "REGION": "region", "PORT": "port", "PROPERTY": "property", "VAR": "variable", "EVENT": "event",
    "OPERATION": "operation", "METHOD": "method", "INSTANCE": "instance", "ARCHITECTURE": "architecture",
    "BOARD": "board", "DEPLOYMENT": "deployment", "NODE": "node", "PROCESS": "process", "THREAD": "thread",
    "LIFECYCLE": "lifecycle", "MEMORY": "memory", "OS": "operating system", "INTERRUPT": "interrupt",
    "PACKAGE": "package", "HOOK": "hook", "HARDWARE": "hardware", "RESOURCE": "resource", "ACTIVITY": "activity",
    "ALTERNATIVE": "alternative", "OBJECTIVE": "objective", "MISSION": "mission", "MODE": "mode", "LTL": "check",
    "PARALLEL": "parallel block", "FLOW": "flow",
}  # fmt: skip
"""What a name after a keyword is the name of."""

NAMED = {
    "THEN": "a codel or a call", "DO": "a codel or a call",
    "READS": "a port, a property or a variable", "WRITES": "a port, a property or a variable",
    "WHEN": "a bool codel", "AND": "a bool codel", "OR": "a bool codel", "NOT": "a bool codel",
    "ON": "an event", "EMIT": "an event", "RETURNS": "a type", "IMPORT": "a module", "OF": "an architecture",
    "EXTENDS": "a deployment", "ASSUME": "a codel", "CONNECT": "a port or a method", "EQUAL": "a value",
    "CONSUMES": "a resource", "PRODUCES": "a resource", "RUNS": "a component", "DOES": "an activity",
    "MANDATORY": "an objective", "OPTIONAL": "an objective", "SEMICOLON": "an objective",
    "SCHEDULE": "a scheduling policy", "LOCK": "a locking protocol", "INITIAL": "a value",
}  # fmt: skip
"""What a name after a symbol refers to."""

SEPARATES: dict[tuple[str, str], tuple[str, str]] = {
    ("COLON", "PORT"): ("between the port and its type", "the type starts here"),
    ("COLON", "PROPERTY"): ("between the property and its type", "the type starts here"),
    ("COLON", "VAR"): ("between the variable and its type", "the type starts here"),
    ("COLON", "LPAR"): ("between the parameter and its type", "the type starts here"),
    ("COLON", "STRUCT"): ("between the field and its type", "the type starts here"),
    ("COLON", "INSTANCE"): ("between the instance and its component", "the component starts here"),
    ("ARROW", "CONNECT"): ("between the two ends of the connection", "the other end starts here"),
    ("ARROW", "FLOW"): ("between two points of the flow", "the next point starts here"),
    ("COLON", "FLOW"): ("between the flow and its points", "the first point starts here"),
    ("ARROW", "STATE"): ("before the state that a transition leads to", "the state is here"),
    ("EQUAL", "BINARY"): ("between the codel and its symbol", "the symbol starts here"),
    ("EQUAL", "INSTANCE"): ("between the property and its value", "the value starts here"),
    ("COMMA", "ONCE"): ("after `once`", ""),
    ("COLON", "HARDWARE"): ("between the hardware and its kind", "the kind starts here"),
    ("COLON", "RESOURCE"): ("between the resource and its type", "the type starts here"),
    ("COLON", "LTL"): ("between the check and its formula", "the formula starts here"),
    ("SEMICOLON", "OBJECTIVE"): ("between two steps", "the next step starts here"),
    ("SEMICOLON", "MISSION"): ("between two steps", "the next step starts here"),
}
"""The place and the label of a missing mark, by the mark and the keyword of the construct it belongs to."""


def quoted(table: Table, kind: str) -> str:
    """A terminal as it is written."""
    for known in (table.words, table.marks):
        for text, name in known.items():
            if name == kind:
                return f"`{text}`"
    return {"NAME": "a name", "WAYS": "the ways of a cache", END: "the end of the file"}.get(kind, kind)


def found(token: Token) -> str:
    """What stands there instead."""
    if token.kind == END:
        return "the end of the file"
    text = token.text if len(token.text) <= 40 else token.text[:37] + "..."
    return f"`{text}`"


def expected(table: Table, symbols: Sequence[str], kinds: Iterable[str]) -> str:
    """What may stand after the symbols, in words: "a port, a codel or `}`"."""
    every = frozenset(kinds)
    rest = set(every)
    told: list[str] = []
    for key, members, words in GROUPS:
        if key in every and rest & members:
            told.append(words)
            rest -= members
    names = [_named(symbols)] if "NAME" in rest else []
    marks = sorted(rest - {"NAME", "RBRACE", END}, key=lambda kind: (kind not in table.words.values(), kind))
    tail = [kind for kind in ("RBRACE", END) if kind in rest]
    return listed([*names, *(quoted(table, kind) for kind in marks), *told, *(quoted(table, kind) for kind in tail)])


def _named(symbols: Sequence[str]) -> str:
    """What a name would stand for after the symbols."""
    last = symbols[-1] if symbols else ""
    if last in ("ENTRY", "MESSAGE", "RUN", "EXIT", "role") or (last == "METHOD" and "STATE" in symbols):
        return "a codel or a call"
    if last in DECLARED:
        return f"the name of the {DECLARED[last]}"
    if last == "ARROW":
        return "a port or an operation" if "CONNECT" in symbols[-3:] else "a state"
    if last == "COLON":
        return "a component" if "INSTANCE" in symbols[-3:] else "a type"
    if last == "ON" and "NODE" in symbols[-3:]:
        return "a board"
    return NAMED.get(last, "a name")


def listed(items: Sequence[str]) -> str:
    """Items joined by commas and a final "or"."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} or {items[-1]}"
