"""Routines of the C library whose time depends on what an executable does not say: told as one problem each.

A routine is known here by its name, as the C standard and the ARM run-time ABI (IHI 0043, 4.3.3 and 4.3.4) reserve it,
and only where its source lines, if the executable has any, lie in a library's folders: what a user wrote is told loop
by loop.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping

from mauve.records import changed, record
from mauve.wcet.flow.result import ContextKey, ProgramFlow
from mauve.wcet.result import Problem, ProblemKind

HEAD = "the time of the library's"
"""How the message of such a problem begins."""


@record
class Routine:
    """What a routine's time depends on, in words; `argument` is the slot (from 1) of a number that bounds it, 0 where
    no argument does; `strings` are the slots of strings whose lengths bound it."""

    reason: str
    argument: int = 0
    strings: tuple[int, ...] = ()


_SIZE = {
    3: "memcpy memmove memset memcmp memchr mempcpy strncpy strncmp __aeabi_memcpy __aeabi_memcpy4 __aeabi_memcpy8"
    " __aeabi_memmove __aeabi_memmove4 __aeabi_memmove8",
    2: "strnlen bzero __aeabi_memset __aeabi_memset4 __aeabi_memset8 __aeabi_memclr __aeabi_memclr4 __aeabi_memclr8",
}
_STRING = {
    (1,): "strlen strchr atoi atol atoll strtol strtoul strtoll strtoull strcmp",
    (2,): "strcpy",
    (1, 2): "strcat",
    (): "strrchr stpcpy strncat strstr strspn strcspn strpbrk strtok strtok_r strcasecmp strdup atof strtod strtof",
}
"""The routines that go through strings, by the arguments whose lengths bound them (none: loop by loop); of those that
stop at the first difference one string is enough."""
_HEAP = "malloc free calloc realloc _malloc_r _free_r _calloc_r _realloc_r"
_FORMAT = re.compile(r"_?v?(as|f|s|sn|asn|si|sni|i|fi)?(printf|scanf)(_r)?|puts|fputs|putchar|_puts_r|fwrite|fread")
_CLOSED = re.compile(
    r"_{1,2}s{0,2}v?f?i?w?(printf|scanf)_r|_printf_(float|i|common)|_strto(d|f|ld)_[rl]|_l?dtoa_r"
    r"|_(puts|fputs|fwrite|fread|fflush)_r|__sfvwrite_r|__s(flush|wsetup|refill)_r"
)
"""Names that the C standard reserves for the library, of newlib's routines that format, scan and write streams."""
_FOLDER = re.compile(r"(^|[/\\])(newlib|picolibc|libc|libm|libgcc|compiler[-_]rt|glibc|musl)[/\\]")
_SORT = {"qsort": 2, "bsearch": 3}


def routine(name: str) -> Routine | None:
    """What is known of a routine of this name; None for any other."""
    for slot, names in _SIZE.items():
        if name in names.split():
            return Routine(f"it takes as many bytes as its argument {slot} says, which is not known", slot)
    if name in _SORT:
        return Routine(f"it looks at as many elements as its argument {_SORT[name]} says, and calls back", _SORT[name])
    for slots, names in _STRING.items():
        if name in names.split():
            return Routine("it goes on to the end of a string, whose length is not known", strings=slots)
    if name in _HEAP.split():
        return Routine("it searches the heap: allocate before the periodic part, or from pools of fixed blocks")
    if _FORMAT.fullmatch(name):
        return Routine("it runs as the format and the stream say, and calls through pointers")
    return None


def is_closed(name: str) -> bool:
    """Whether a function of this name is one of the library's own whose loops and calls through pointers go as formats,
    numbers in text and streams say: following them takes long and bounds nothing."""
    return _CLOSED.fullmatch(name) is not None


def searches_heap(name: str) -> bool:
    """Whether a function of this name is one of newlib's own that search the heap: no bound comes of following them."""
    return name.startswith("_") and name in _HEAP.split()


def not_followed(name: str, address: int) -> Problem:
    """The problem that a routine is which is not followed."""
    known = routine(name) if searches_heap(name) else None
    streams = "it runs as a format, a text or a stream says, and calls through pointers"
    reason = streams if known is None else known.reason
    message = f"{HEAD} `{name}` has no bound: {reason}"
    return Problem(ProblemKind.LOOP, message, address, name)


def is_library(source: str) -> bool:
    """Whether a source line, as `file.c:41` or empty, is none that a user wrote."""
    return not source or _FOLDER.search(source) is not None


def facts(name: str) -> tuple[str, ...]:
    """The facts, as they stand in a deployment's binary, that bound a routine; empty where none do."""
    known = routine(name)
    if known is None:
        return ()
    if known.argument:
        return (f'assume "{name}" argument {known.argument} from 0 to N',)
    return tuple(f'assume "{name}" argument {slot} ends within NB' for slot in known.strings)


def is_told(problem: Problem) -> bool:
    """Whether a problem is one that `told_as_one` made."""
    return problem.message.startswith(HEAD)


def told_as_one(problems: Iterable[Problem], program: ProgramFlow, lines: Callable[[int], str]) -> Iterator[Problem]:
    """The problems, those inside one library routine as one at its first call: `call_path` says where they lie."""
    waiting: dict[str, list[Problem]] = {}
    for problem in problems:
        name = next((name for name in problem.call_path[1:] if routine(name) is not None), None)
        source = problem.source or ("" if problem.address is None else lines(problem.address))
        if name is None or not is_library(source):
            yield problem
        else:
            waiting.setdefault(name, []).append(problem)
    keys: dict[str, ContextKey] = {}
    for key, flow in program.functions.items():
        keys.setdefault(flow.cfg.name, key)
    for name, inside in waiting.items():
        path = min((p.call_path[: p.call_path.index(name) + 1] for p in inside), key=len)
        yield _one(name, keys[name][0] & ~1, path, inside, _call(program, path, lines))


def _one(name: str, address: int, path: tuple[str, ...], inside: list[Problem], source: str) -> Problem:
    known = routine(name)
    assert known is not None
    for problem in inside:
        if is_told(problem) and problem.function == name:
            return changed(problem, source=source, call_path=path)
    kinds = [problem.kind for problem in inside]
    kind = ProblemKind.LOOP if ProblemKind.LOOP in kinds else kinds[0]
    places = sorted({problem.address for problem in inside if problem.address is not None})
    suggested = facts(name)
    listed = not any(is_told(problem) for problem in inside)
    holes = f"; `mauvec facts` lists the {len(places)} place{'s' if len(places) > 1 else ''} in it that wait for facts"
    message = f"{HEAD} `{name}` has no bound: {known.reason}{holes if listed and not suggested else ''}"
    return Problem(kind, message, address, name, source, path, suggested)


def _call(program: ProgramFlow, path: tuple[str, ...], lines: Callable[[int], str]) -> str:
    """The source line of the first call of the last function on a path by the one before it; empty if unknown."""
    names: Mapping[ContextKey, str] = {key: flow.cfg.name for key, flow in program.functions.items()}
    for flow in program.functions.values():
        if flow.cfg.name != path[-2]:
            continue
        for index, callees in sorted(flow.calls.items()):
            if index not in flow.infeasible and path[-1] in {names.get(callee) for callee in callees}:
                source = lines(flow.cfg.blocks[flow.cfg.edges[index].source].instructions[-1].address)
                if source and not is_library(source):
                    return source
    return ""


__all__ = [
    *("Routine", "facts", "is_closed", "is_library", "is_told", "not_followed", "routine", "searches_heap"),
    "told_as_one",
]
