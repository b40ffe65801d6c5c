"""A controller as C11: no heap, no recursion, no function pointer in a step, and loops with constant bounds.

`NAME_step` takes an event and tells whether it was accepted. The tables are `const`; a state is a struct of 64-bit
words that the caller keeps. Each loop of a step has a bound that is a constant of the generated file, so that the time
of a step can be bounded on the binary. `NAME_report` calls back for each activity that a step stopped or started.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from string import Template

from mauve.mission import controller_code as code
from mauve.mission.cascades import bits
from mauve.mission.controller import WORD, Cascades, Controller, Observer, Rules, identifiers
from mauve.records import record

__all__ = ["CFiles", "c_files"]

TAIL = (1 << WORD) - 1


@record
class CFiles:
    """The texts of `stem.h` and `stem.c`; all names that a linker sees begin with the stem, as far as C allows."""

    stem: str
    header: str
    source: str


def c_files(controller: Controller, stem: str | None = None) -> CFiles:
    """The controller in C. The stem is made from the mission's name where none is given.

    A stem that is no name in C, as `coral-2`, names the files; the names in them have `_` for what C does not allow.
    """
    name = re.sub(r"[^A-Za-z0-9]", "_", controller.name.lower() if stem is None else stem)
    if not re.match(r"[A-Za-z]", name):
        name = f"mission_{name}"
    stem = name if stem is None else stem
    reaction = controller.reaction
    step = _rules(reaction) if isinstance(reaction, Rules) else _cascades(reaction)
    source = "\n".join([code.SOURCE_HEAD, _names(controller), _reset(controller), step, _observers(controller)])
    words = {"file": stem, "name": name, "NAME": name.upper(), "words": str(controller.words)}
    return CFiles(stem, Template(_header(controller)).substitute(words), Template(source).substitute(words))


def _header(controller: Controller) -> str:
    names = identifiers(controller)

    def constants(words: tuple[str, ...], count: str) -> str:
        return "\n".join(["enum {", *(f"    ${{NAME}}_{word}," for word in words), f"    ${{NAME}}_{count}", "};", ""])

    return "\n".join([
        code.HEADER_HEAD.replace("MISSION", controller.name.replace("*/", "* /").replace("$", "$$")),
        "/* Events. */", constants(names.events, "EVENTS"),
        "/* Elementary objectives, by path. */", constants(names.objectives, "OBJECTIVES"),
        "/* Activities, each with one of its alternatives. */", constants(names.alternatives, "ALTERNATIVES"),
        "/* Activities that can be left without an alternative while an objective asks for them. */",
        constants(names.failed, "FAILURES"),
        "/* Hardware that can be out of service. */", constants(names.resources, "RESOURCES"),
        code.HEADER_TAIL,
    ])  # fmt: skip


def _names(controller: Controller) -> str:
    events = [event.name for event in controller.events]
    return _texts("event", events) + _texts("alternative", [".".join(one.names) for one in controller.alternatives])


def _reset(controller: Controller) -> str:
    words = [
        f"    state->words[{at}] = {_hex(word)};\n" for at, word in enumerate(_words(controller, controller.initial))
    ]
    return code.RESET.replace("WORDS\n", "".join(words))


def _rules(rules: Rules) -> str:
    """Tables of conditions and effects, one entry per word concerned, and the search for the rule that applies."""
    tests, effects, heads, first = list[str](), list[str](), list[str](), [0]
    most_tests = most_effects = 1
    for of_event in rules.by_event:
        for tested, value, cleared, filled in of_event:
            test, effect = _cells(tested, value), _cells(cleared, filled)
            heads.append(f"{{{len(tests)}, {len(effects)}, {len(test)}, {len(effect)}}}")
            most_tests, most_effects = max(most_tests, len(test)), max(most_effects, len(effect))
            tests += test
            effects += effect
        first.append(len(heads))
    bounds = (
        f"enum {{ MOST_RULES = {max(1, rules.most)}, MOST_TESTS = {most_tests}, MOST_EFFECTS = {most_effects} }};\n"
    )
    tables = _table("cell", "tests", tests) + _table("cell", "effects", effects) + _table("rule", "rules", heads)
    return "\n".join(
        [code.RULE_TYPES, bounds, tables + _table("uint32_t", "first_rule", map(str, first)), code.RULE_STEP]
    )


def _cascades(net: Cascades) -> str:
    """The transitions as lists of places, and the cascade: the candidates are kept as bits, most urgent first."""
    lists: dict[str, Sequence[Sequence[int]]] = {
        "needs": [list(bits(one[0])) for one in net.transitions],
        "takes": [list(bits(one[1])) for one in net.transitions],
        "fills": [list(bits(one[2])) for one in net.transitions],
        "waiting": net.waiting,
        "starts": net.starts,
    }
    bounds = {"LONGEST": net.longest, "CANDIDATE_WORDS": max(1, -(-net.levels[-1] // 32))}
    bounds |= {f"MOST_{name.upper()}": max(1, *map(len, items)) for name, items in lists.items()}
    constants = "".join(f"    {name} = {value},\n" for name, value in bounds.items())
    tables = "".join(_lists(name, items) for name, items in lists.items())
    return "\n".join([f"enum {{\n{constants}}};\n", tables, code.CASCADE_STEP])


def _observers(controller: Controller) -> str:
    kinds: tuple[tuple[str, str, tuple[Observer, ...]], ...] = (
        ("pursued", "OBJECTIVES", controller.objectives),
        ("running", "ALTERNATIVES", controller.alternatives),
        ("failed", "FAILURES", controller.failed),
        ("out_of_service", "RESOURCES", controller.resources),
    )
    texts = [code.MEETS]
    for name, count, observers in kinds:
        if not observers:
            texts.append(code.BLIND_OBSERVER.replace("KIND", name))
            continue
        rows = [_row(controller, one.places) for one in observers]
        texts.append(_table("uint64_t", f"{name}_places", rows, "[${words}]"))
        texts.append(code.OBSERVER.replace("KIND", name).replace("COUNT", count))
    for name, places in (("succeeded", controller.success), ("has_failed", controller.failure)):
        texts.append(code.OUTCOME.replace("KIND", name).replace("ROW", _row(controller, places)))
    return "\n".join([*texts, code.REPORT])


# ------------------------------------------------------------------------------------------------------------ details
def _words(controller: Controller, state: int) -> list[int]:
    return [state >> WORD * at & TAIL for at in range(controller.words)]


def _row(controller: Controller, places: int) -> str:
    return "{" + ", ".join(map(_hex, _words(controller, places))) + "}"


def _cells(first: int, second: int) -> list[str]:
    """One entry for each word in which one of two bit sets is not empty."""
    cells = []
    for at in range(-(-max(first.bit_length(), second.bit_length()) // WORD)):
        one, other = first >> WORD * at & TAIL, second >> WORD * at & TAIL
        if one or other:
            cells.append(f"{{{_hex(one)}, {_hex(other)}, {at}}}")
    return cells


def _lists(name: str, lists: Sequence[Sequence[int]]) -> str:
    """A table of all items, and one of where each list begins."""
    begins = [0]
    for one in lists:
        begins.append(begins[-1] + len(one))
    items = [str(item) for one in lists for item in one] or ["0"]
    return _table("uint32_t", name, items) + _table("uint32_t", f"{name}_at", map(str, begins))


def _table(kind: str, name: str, entries: Iterable[str], inner: str = "") -> str:
    lines = [f"static const {kind} {name}[]{inner} = {{"]
    line = "   "
    for entry in list(entries) or ["{0}"]:
        if len(line) + len(entry) > 110:
            lines.append(line)
            line = "   "
        line += f" {entry},"
    return "\n".join([*lines, line, "};", "", ""])


def _texts(kind: str, texts: list[str]) -> str:
    entries = [f'    "{text}",' for text in (re.sub(r"[^A-Za-z0-9 _.:-]", "_", text) for text in texts)]
    return "\n".join([f"const char *const ${{name}}_{kind}_names[] = {{", *(entries or ["    0,"]), "};", "", ""])


def _hex(word: int) -> str:
    return f"0x{word:x}u" if word < 1 << 32 else f"0x{word:x}ull"
