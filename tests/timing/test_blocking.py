"""Blocking by critical sections under the immediate ceiling protocol."""

from __future__ import annotations

from mauve.records import changed
from mauve.timing.blocking import blockers, blocking_sections, longest, with_blocking
from mauve.timing.response import Caveat, Method, analyse
from mauve.timing.task import Section, Task, constant


def test_blocking_by_its_definition() -> None:
    short, long = Section("r", "a", "x", 2), Section("s", "a", "y", 5)
    assert longest([short, changed(short, length=1), long]) == (short, long)
    assert blockers([(1, (short, long)), (2, (long,)), (3, (short,))]) == [None, long, short]
    assert blockers([(1, (short,)), (1, (short,))]) == [None, None], "equals interfere, they do not block"
    assert blockers([(1, (short,)), (2, ())]) == [None, None]


def task(name: str, priority: int, *sections: Section, **rest: object) -> Task:
    return Task(name, priority, 100, 100, (constant(name, 10),), sections=sections, **rest)  # type: ignore[arg-type]


def test_a_section_above_all_blocks_who_does_not_use_its_resource() -> None:
    low = task("low", 1, Section("irq", "low", "with interrupts off", 4, above_all=True))
    assert [task.blocking for task in with_blocking([low, task("mid", 2), task("high", 3)])] == [0, 4, 4]


def test_a_task_without_preemption_blocks_for_its_whole_job_and_one_with_a_tail_for_that() -> None:
    whole, tail = task("low", 1, preemptive=False, overhead=2), task("low", 1, tail=3)
    assert [task.blocking for task in with_blocking([whole, task("high", 2)])] == [0, 12]
    assert [task.blocking for task in with_blocking([tail, task("high", 2)])] == [0, 3]
    named = blocking_sections([whole, task("high", 2)])[1]
    assert named is not None and (named.holder, named.what) == ("low", "the whole of `low`")


def test_a_section_may_reach_into_an_end_that_is_not_preempted() -> None:
    # The section [2, 5) of `low` is left within its end [4, 10): who arrives at 2 and uses nothing waits for both.
    low, user = task("low", 1, Section("r", "low", "in `r`", 3), tail=6), task("user", 3, Section("r", "user", "", 1))
    assert [one.blocking for one in with_blocking([low, user, task("mid", 2)])] == [0, 9, 9]
    named = blocking_sections([low, user])[1]
    assert named is not None and named.what == "in `r` and the end of `low`"
    assert [one.blocking for one in with_blocking([changed(low, tail=8), user])] == [0, 10], "no longer than the job"
    assert [one.blocking for one in with_blocking([low, changed(user, sections=())])] == [0, 6]


def test_blocking_that_was_given_stays_where_it_is_longer() -> None:
    low, high = task("low", 1, Section("r", "low", "", 4)), task("high", 2, Section("r", "high", "", 1), blocking=7)
    assert analyse([low, high]).result("high").wcrt == 17
    assert analyse([low, changed(high, blocking=3)]).result("high").wcrt == 14


def test_the_paper_method_leaves_sections_out_and_says_so() -> None:
    low, high = task("low", 1, Section("r", "low", "", 4)), task("high", 2, Section("r", "high", "", 1))
    found = analyse([low, high], Method.PAPER).result("high")
    assert (found.wcrt, found.caveats) == (10, (Caveat.BLOCKING,))
