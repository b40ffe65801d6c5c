"""A response time and a missed deadline are explained as a bill, and by what would have to shrink."""

from __future__ import annotations

import pytest
from hypothesis import given, settings

from mauve.records import changed
from mauve.timing.bill import SHOWN_JOBS, Bill, deadline_bill, first_finish, worst_bill
from mauve.timing.psm import CostPart, Psm, PsmTransition, make_psm
from mauve.timing.response import Method, Reason, analyse
from mauve.timing.shrink import What, capped, shrink_to_fit
from mauve.timing.task import Interrupt, Platform, Task, constant, frames, machine, on_platform, table

from .systems import systems

US = 1_000_000
MS = 1_000 * US


def command_psm() -> Psm:
    """Rotating and Reaching: a change from one to the other is dear, but never twice in a row."""

    def step(source: str, target: str, label: str, **parts: int) -> PsmTransition:
        items = tuple(CostPart(name, cost * US) for name, cost in parts.items())
        return PsmTransition(source, target, sum(part.cost for part in items), label, items)

    return make_psm(
        "command",
        "Rotating",
        [
            step("Rotating", "Rotating", "", rotate=400, send=90, aligned=10),
            step("Rotating", "Reaching", "when aligned", rotate=400, send=90, aligned=10, halt=200),
            step("Reaching", "Reaching", "", reach=200, send=90, strayed=10),
            step("Reaching", "Rotating", "when strayed", reach=200, send=90, strayed=10),
        ],
    )


def robot(fusion: int = 4900 * US) -> list[Task]:
    """Priorities and periods of the TTRK robot, at a load of 0.99."""
    return [
        Task("ig500", 20, 10 * MS, 10 * MS, (constant("ig500", 1 * MS),)),
        Task("chr6dm", 30, 1 * MS, 1 * MS, (constant("chr6dm", 350 * US),)),
        Task("fusion", 15, 10 * MS, 10 * MS, (constant("fusion", fusion),)),
        Task("command", 10, 10 * MS, 10 * MS, (machine(command_psm()),)),
    ]


def test_the_bill_of_a_missed_deadline() -> None:
    found = analyse(robot())
    command = found.result("command")
    assert (command.wcrt, command.deadline, command.schedulable) == (19_500 * US, 10 * MS, False)
    assert [found.result(name).schedulable for name in ("ig500", "chr6dm", "fusion")] == [True, True, True]
    bill = deadline_bill(found, "command")
    assert bill is not None
    assert (bill.job, bill.window, bill.due, bill.excess) == (1, 10 * MS, 10_100 * US, 100 * US)
    assert [(line.task, line.jobs, line.cost, line.priority) for line in bill.others] == [
        ("fusion", 1, 4_900 * US, 15),
        ("chr6dm", 10, 3_500 * US, 30),
        ("ig500", 1, 1_000 * US, 20),
    ]
    assert bill.own.cost == 700 * US
    (transition,) = bill.own.work[0].run
    assert (transition.source, transition.target, transition.label) == ("Rotating", "Reaching", "when aligned")
    assert [part.label for part in transition.parts] == ["rotate", "send", "aligned", "halt"]


def test_by_how_much_each_contributor_would_have_to_shrink() -> None:
    found = {(one.what, one.task, one.name): one for one in shrink_to_fit(analyse(robot()), "command")}
    fusion = found[What.WORK, "fusion", "fusion"]
    assert (fusion.now, fusion.at_most) == (4_900 * US, 4_800 * US)
    assert found[What.WORK, "chr6dm", "chr6dm"].at_most == 340 * US
    assert found[What.WORK, "ig500", "ig500"].at_most == 900 * US
    assert found[What.WORK, "command", "command"].at_most == 600 * US
    assert found[What.CODEL, "", "halt"].at_most == 100 * US
    assert found[What.CODEL, "", "aligned"].at_most is None
    assert ("codel", "strayed") not in {(one.what.value, one.name) for one in found.values() if one.at_most is not None}


def test_the_answer_of_shrink_is_the_greatest_that_fits() -> None:
    assert analyse(robot(4800 * US)).result("command").wcrt == 10 * MS
    assert not analyse(robot(4800 * US + 1)).result("command").schedulable
    assert shrink_to_fit(analyse(robot(4800 * US)), "command") == ()


def test_the_bill_of_a_response_sums_to_its_window() -> None:
    found = analyse(robot())
    bill = worst_bill(found, "command")
    assert bill is not None
    assert (bill.window, bill.excess) == (19_500 * US, 0)
    assert {line.task: line.jobs for line in bill.others} == {"fusion": 2, "chr6dm": 20, "ig500": 2}
    assert bill.others[0].work[0].trace == (4_900 * US, 4_900 * US)


def test_merged_alternatives_count_when_the_dearest_shrinks() -> None:
    psm = make_psm(
        "m",
        "s",
        [
            PsmTransition("s", "s", 8, "left", (CostPart("left", 8),)),
            PsmTransition("s", "s", 7, "right", (CostPart("right", 7),)),
        ],
    )
    tasks = [Task("m", 1, 10, 6, (machine(psm),))]
    found = {one.name: one.at_most for one in shrink_to_fit(analyse(tasks), "m")}
    assert found == {"m": 6, "left": None, "right": None}


def test_an_overload_still_has_a_bill_and_a_first_response() -> None:
    tasks = [Task("a", 2, 10, 10, (constant("a", 6),)), Task("b", 1, 10, 10, (constant("b", 5),))]
    found = analyse(tasks)
    assert found.result("b").reason is Reason.OVERLOAD
    bill = deadline_bill(found, "b")
    assert bill is not None
    assert (bill.job, bill.window, bill.due) == (1, 10, 11)
    assert first_finish(found, "b") == 17
    assert worst_bill(found, "b") is None
    assert [one.at_most for one in shrink_to_fit(found, "b")] == [4, 5]


def test_a_deadline_that_only_a_later_job_misses() -> None:
    tasks = [Task("high", 2, 12, 12, (constant("high", 5),)), Task("m", 1, 8, 12, (frames("m", (6, 3)),))]
    bill = deadline_bill(analyse(tasks), "m")
    assert bill is not None
    assert (bill.job, bill.window, bill.own.cost) == (3, 28, 15)
    assert bill.due == 15 + 3 * 5


def test_jitter_beyond_the_deadline_is_a_window_of_nothing() -> None:
    tasks = [Task("a", 1, 20, 5, (constant("a", 1),), jitter=9)]
    bill = deadline_bill(analyse(tasks), "a")
    assert bill is not None
    assert (bill.window, bill.due) == (0, 1)


def test_overhead_and_blocking_have_their_own_place_in_the_bill() -> None:
    tasks = [
        Task("a", 2, 50, 50, (constant("a", 10),)),
        Task("b", 1, 100, 40, (constant("b", 20),), blocking=7),
    ]
    found = analyse(on_platform(tasks, Platform(2, (Interrupt("uart", 30, 1),))))
    bill = worst_bill(found, "b")
    assert bill is not None
    assert (bill.blocking, bill.own.overhead, bill.own.cost) == (7, 4, 24)
    assert [(line.task, line.kind.value, line.cost, line.overhead) for line in bill.others] == [
        ("a", "task", 14, 4),
        ("uart", "interrupt", 2, 0),
    ]
    by_name = {one.name: one.at_most for one in shrink_to_fit(found, "b")}
    assert by_name["context switches"] == 0
    assert by_name["blocking"] == 0


def test_a_capped_curve_is_never_dearer() -> None:
    assert [capped(table("t", (6, 8, 14)).curve, 5).total(n) for n in (1, 2, 3)] == [5, 8, 14]
    assert capped(frames("f", (5, 1)).curve, 3).total(2) == 4
    assert capped(machine(command_psm()).curve, 600 * US).total(1) == 600 * US


def check(bill: Bill) -> None:
    assert bill.due == bill.blocking + bill.own.cost + sum(line.cost for line in bill.others)
    for line in (bill.own, *bill.others):
        assert line.cost == line.overhead + sum(work.cost for work in line.work)
        for work in line.work:
            assert len(work.trace) == min(work.jobs, SHOWN_JOBS)
            assert sum(work.trace) == work.cost or work.jobs > SHOWN_JOBS
            assert not work.run or sum(t.cost for t in work.run) == work.cost


@pytest.mark.parametrize("method", [Method.TRACE, Method.PAPER, Method.SPORADIC])
@settings(max_examples=50, deadline=None)
@given(tasks=systems(size=3))
def test_bills_add_up(method: Method, tasks: list[Task]) -> None:
    found = analyse(tasks, method)
    for result in found.results:
        bill = worst_bill(found, result.task)
        if bill is not None:
            check(bill)
            assert bill.excess == 0
        late = deadline_bill(found, result.task)
        assert late is None or not result.schedulable
        if result.wcrt is not None and not result.schedulable:
            assert late is not None
            check(late)
            assert late.excess > 0 or late.window == 0


@settings(max_examples=60, deadline=None)
@given(tasks=systems(size=3))
def test_what_shrink_promises_holds_and_one_more_does_not(tasks: list[Task]) -> None:
    found = analyse(tasks)
    for result in found.results:
        for one in shrink_to_fit(found, result.task):
            if one.what is not What.WORK:
                continue
            owner = found.task(one.task)
            for cost, expected in ((one.at_most, True), (0 if one.at_most is None else one.at_most + 1, False)):
                if cost is None:
                    continue
                work = tuple(
                    part if part.name != one.name else type(part)(part.name, capped(part.curve, cost), part.period)
                    for part in owner.work
                )
                changed = [with_work(t, work) if t.name == one.task else t for t in tasks]
                assert analyse(changed).result(result.task).schedulable is expected


@settings(max_examples=40, deadline=None)
@given(tasks=systems(size=3))
def test_contributors_ruled_out_without_an_analysis_would_not_fit_at_no_cost(tasks: list[Task]) -> None:
    found = analyse(tasks)
    for result in found.results:
        for one in shrink_to_fit(found, result.task):
            if one.what is What.OVERHEAD and one.at_most is None:
                free = [with_overhead(task, 0) for task in tasks]
                assert not analyse(free).result(result.task).schedulable


def with_overhead(task: Task, overhead: int) -> Task:
    return changed(task, overhead=overhead)


def with_work(task: Task, work: tuple[object, ...]) -> Task:
    return changed(task, work=work)
