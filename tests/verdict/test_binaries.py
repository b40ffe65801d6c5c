"""Problems of binaries as messages: each kind has a code, a place and what to do."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from written import codes, model_of

from mauve.diagnostics.diagnostic import Diagnostic, Report, Severity
from mauve.diagnostics.rules import RULES
from mauve.lower.codels import choose_times, plan_codels
from mauve.model.model import Deployment
from mauve.verdict.binaries import CODES, NOTES, place, problem_diagnostic
from mauve.verdict.derive import derive
from mauve.verdict.stale import check_stale
from mauve.wcet import batch
from mauve.wcet.result import Problem, ProblemKind, WcetResult

FIXTURES = Path(__file__).resolve().parents[1] / "wcet" / "fixtures"

TEXT = """
component Fusion {
  codel fuse
  codel reset %s
  behaviour {
    initial state On {
      entry reset
      run fuse
    }
  }
}
board desk {
  cpu "arm7tdmi" at 60MHz
  memory all at 0x0 size 1MiB wait 0cycles
}
architecture R {
  instance fusion: Fusion { period 10ms }
}
deployment d of R {
  node n on desk {
    binary "%s" {
      %s
    }
    %s
  }
}
"""


def _deployment(declared: str = "", path: str = "robot.elf", inside: str = "", beside: str = "") -> Deployment:
    return model_of(TEXT % (declared, path, inside, beside)).deployments[0]


@pytest.fixture
def answers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[dict[str, tuple[Problem, ...]]]:
    """What the engine answers per symbol: its problems, or 1000 cycles where it has none."""
    problems: dict[str, tuple[Problem, ...]] = {}
    monkeypatch.chdir(tmp_path)
    Path("robot.elf").write_bytes(b"")

    def answer(_path: str, symbols: list[str], *_: object) -> tuple[WcetResult, ...]:
        return tuple(
            WcetResult(s, None, None, None, problems=problems[s]) if s in problems else WcetResult(s, 1, 1000, 1000)
            for s in symbols
        )

    monkeypatch.setattr(batch, "analyse_batch", answer)
    yield problems


def _run(deployment: Deployment) -> Report:
    report = Report()
    plans = plan_codels(deployment)
    found = derive(deployment, plans, False, report)
    choose_times(plans, deployment, found.codels, report)
    return report


def _problem(kind: ProblemKind, address: int | None = 0x8A34) -> Problem:
    return Problem(kind, "what is wrong", address, "mat_invert", "fusion.c:41", ("Fusion_fuse", "mat_invert"))


@pytest.mark.parametrize("kind", ProblemKind)
def test_every_kind_of_problem_has_a_code_and_a_message(kind: ProblemKind) -> None:
    assert (kind in CODES) or (kind in NOTES)
    code = CODES.get(kind) or NOTES[kind][0]
    assert code in RULES
    if kind in CODES:
        deployment = _deployment()
        plan = plan_codels(deployment)[0]
        node = deployment.nodes[0]
        found = problem_diagnostic(_problem(kind), plan, node.binaries[0], node.board, deployment, False)
        assert found.code == code and found.primary is not None and found.severity is Severity.ERROR


@pytest.mark.parametrize(
    ("kind", "code"),
    [
        (ProblemKind.DECODE, "MV506"), (ProblemKind.IRREDUCIBLE, "MV512"), (ProblemKind.LIMIT, "MV517"),
        (ProblemKind.OUTSIDE, "MV509"), (ProblemKind.FACT_CONTRADICTED, "MV515"), (ProblemKind.LOOP, "MV511"),
    ],
)  # fmt: skip
def test_a_problem_is_shown_where_it_is_in_the_binary(
    answers: dict[str, tuple[Problem, ...]], kind: ProblemKind, code: str
) -> None:
    answers["Fusion_fuse"] = (_problem(kind),)
    (found,) = [d for d in _run(_deployment(declared="wcet 1ms")) if d.code != "MV420"]
    assert found.code == code
    assert found.place == "fusion.c:41 (0x8a34, in mat_invert, called from Fusion_fuse)"


def test_a_place_without_a_line_is_an_address() -> None:
    assert place(Problem(ProblemKind.LOOP, "", 0x10, "f")) == "0x10, in f"
    assert place(Problem(ProblemKind.LOOP, "")) == ""


def test_a_loop_that_keeps_two_codels_from_a_bound_is_one_message(answers: dict[str, tuple[Problem, ...]]) -> None:
    for codel in ("fuse", "reset"):
        answers[f"Fusion_{codel}"] = (
            Problem(ProblemKind.LOOP, "", 0x8A34, "div", "div.c:3", (f"Fusion_{codel}", "div")),
        )
    (found,) = _run(_deployment())
    assert found.code == "MV511"
    assert found.notes == ("the same keeps `Fusion.fuse` from having a WCET",), "in the order of use"
    assert found.help is not None and found.help.text.startswith('add `loop "div.c:3" max N`')


def test_what_is_wrong_with_a_binary_is_said_once(answers: dict[str, tuple[Problem, ...]]) -> None:
    for kind, code in ((ProblemKind.NOT_ARM, "MV503"), (ProblemKind.BINARY, "MV502")):
        problem = Problem(kind, "robot.elf is for another processor")
        answers.update({"Fusion_fuse": (problem,), "Fusion_reset": (problem,)})
        assert codes(_run(_deployment())) == [code]


def test_a_missing_file_is_one_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (found,) = _run(_deployment(path="nothing.elf"))
    assert (found.code, found.message) == ("MV502", "the binary `nothing.elf` does not exist")


MISSING = (Problem(ProblemKind.SYMBOL, "there is no such function"),)


@pytest.mark.parametrize(
    ("declared", "inside", "beside", "expected"),
    [
        ("", "", "", [("MV501", Severity.ERROR)]),
        ("wcet 1ms", "", "", []),
        ("", "", "assume Fusion.reset wcet 1ms", []),
        ("", "", "assume others wcet 1ms", []),
        ("wcet 1ms", 'Fusion.reset = "Fusion_reset"', "", [("MV501", Severity.WARNING)]),
    ],
)
def test_a_function_that_is_missing_matters_where_it_is_named_or_nothing_else_gives_a_time(
    answers: dict[str, tuple[Problem, ...]],
    declared: str,
    inside: str,
    beside: str,
    expected: list[tuple[str, Severity]],
) -> None:
    answers["Fusion_reset"] = MISSING
    report = _run(_deployment(declared, "robot.elf", inside, beside))
    assert [(d.code, d.severity) for d in report] == expected


def test_an_assumed_time_stands_in_for_one_that_cannot_be_derived(answers: dict[str, tuple[Problem, ...]]) -> None:
    answers["Fusion_fuse"] = (_problem(ProblemKind.LOOP),)
    report = _run(_deployment(beside="assume Fusion.fuse wcet 1ms"))
    (found,) = report
    assert found.severity is Severity.WARNING
    assert "the assumed or declared time is used instead" in found.notes


def test_the_handler_of_an_interrupt_is_derived_too(answers: dict[str, tuple[Problem, ...]]) -> None:
    deployment = _deployment(beside='interrupt uart every 87us symbol "uart_isr"')
    report = Report()
    assert derive(deployment, plan_codels(deployment), False, report).handlers == {"uart": 1000}
    answers["uart_isr"] = (_problem(ProblemKind.LOOP),)
    found = derive(deployment, plan_codels(deployment), False, report)
    assert not found.complete and codes(report) == ["MV520"]


def test_a_binary_older_than_its_source_is_a_warning(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(FIXTURES / "arm7tdmi-arm-O1.elf", "robot.elf")
    shutil.copy(FIXTURES / "loops.c", "loops.c")
    binary = _deployment().nodes[0].binaries[0]

    def stale(source_time: float) -> list[Diagnostic]:
        os.utime("robot.elf", (1_000_000, 1_000_000))
        os.utime("loops.c", (source_time, source_time))
        report = Report()
        check_stale(binary, None, report)
        return list(report)

    assert stale(999_000) == [] and stale(1_000_001) == []
    (found,) = stale(1_000_100)
    assert found.code == "MV504" and "loops.c" in found.message


def test_the_wrong_processor_is_one_message_for_all_its_instructions(answers: dict[str, tuple[Problem, ...]]) -> None:
    answers["Fusion_fuse"] = tuple(_problem(ProblemKind.HARDWARE, 0x8000 + 4 * n) for n in range(14))
    (found,) = _run(_deployment("wcet 1ms"))
    assert found.code == "MV510" and "the same holds for 13 more places" in found.notes
    assert found.help is not None and "-mcpu=arm7tdmi" in found.help.text


def test_loops_without_a_bound_are_told_each(answers: dict[str, tuple[Problem, ...]]) -> None:
    answers["Fusion_fuse"] = tuple(_problem(ProblemKind.LOOP, 0x8000 + 4 * n) for n in range(3))
    assert [d.code for d in _run(_deployment("wcet 1ms"))] == ["MV511"] * 3
