"""Routines of the C library without a bound: one message each, at the call, with the fact that helps."""

from __future__ import annotations

from dataclasses import replace

from mauve.records import changed
from mauve.wcet.binary.graph import Block, Cfg, Edge, EdgeKind
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.binary.microop import Call, Condition, Instruction, Kind, Traits
from mauve.wcet.flow.result import FunctionFlow, ProgramFlow
from mauve.wcet.result import Problem, ProblemKind
from mauve.wcet.routines import facts, is_closed, is_library, is_told, not_followed, routine, searches_heap, told_as_one

CALLER, COPY = (0x8000, ""), (0x9000, "")


def program() -> ProgramFlow:
    call = Instruction(0x8000, 4, False, "bl", Condition.AL, (), Call(0x9000, False), Traits(Kind.ALU))
    caller = Cfg("step", 0x8000, False, 0, (Block(0, (call,)),), (Edge(0, 0, EdgeKind.CALL, (0x9000,)),))
    copy = Cfg("memcpy", 0x9000, False, 0, (), ())
    nest = LoopNest((), ())
    flows = {
        COPY: FunctionFlow(copy, nest, {}, frozenset(), {}, {}),
        CALLER: FunctionFlow(caller, nest, {}, frozenset(), {}, {0: (COPY,)}),
    }
    return ProgramFlow(CALLER, flows)


def loops(*addresses: int) -> list[Problem]:
    return [Problem(ProblemKind.LOOP, f"loop at {a:#x}", a, "memcpy", call_path=("step", "memcpy")) for a in addresses]


def test_the_loops_of_a_routine_are_one_problem_at_its_call() -> None:
    lines = {0x8000: "robot.c:12", 0x9010: "../newlib/libc/string/memcpy.c:50"}
    (told,) = told_as_one(loops(0x9010, 0x9020), program(), lambda at: lines.get(at, ""))
    assert (told.kind, told.address, told.source, told.function) == (ProblemKind.LOOP, 0x9000, "robot.c:12", "memcpy")
    assert told.suggestions == ('assume "memcpy" argument 3 from 0 to N',)
    assert is_told(told) and told.call_path == ("step", "memcpy")


def test_what_a_user_wrote_is_told_loop_by_loop() -> None:
    found = loops(0x9010, 0x9020)
    assert list(told_as_one(found, program(), lambda at: "drivers/memcpy.c:7" if at >= 0x9000 else "")) == found


def test_what_is_known_of_names() -> None:
    assert facts("__aeabi_memset") == ('assume "__aeabi_memset" argument 2 from 0 to N',)
    assert facts("strlen") == ('assume "strlen" argument 1 ends within NB',) and routine("strlen") is not None
    assert len(facts("strcat")) == 2 and facts("strtod") == () and routine("strtod") is not None
    assert routine("_vfprintf_r") is not None and routine("malloc") is not None
    assert routine("filter") is None and routine("memcpy_dma") is None
    assert is_library("") and is_library("../../newlib/libc/string/memset.c:3") and not is_library("src/app.c:3")


def test_what_formats_and_scans_is_not_followed_and_says_so_once() -> None:
    for name in (
        "_vfprintf_r",
        "_svfprintf_r",
        "_svfiprintf_r",
        "__ssvfscanf_r",
        "_strtod_l",
        "_dtoa_r",
        "_printf_float",
    ):
        assert is_closed(name), name
    assert searches_heap("_malloc_r") and not searches_heap("malloc") and not searches_heap("_step")
    assert "it searches the heap" in not_followed("_malloc_r", 0x8000).message
    for name in ("printf", "malloc", "_malloc_r", "strtol", "_step", "print_r", "qsort"):
        assert not is_closed(name), name
    problem = changed(not_followed("_vfprintf_r", 0x9100), call_path=("step", "printf", "_vfprintf_r"))
    flow = program()
    callee = flow.functions[COPY]
    printf = replace(callee, cfg=replace(callee.cfg, name="printf"))
    flow = changed(flow, functions={**flow.functions, COPY: printf})
    (told,) = told_as_one([problem], flow, lambda at: "robot.c:9" if at == 0x8000 else "")
    assert told.source == "robot.c:9" and "`printf` has no bound: it runs as the format" in told.message
    assert "mauvec facts" not in told.message
