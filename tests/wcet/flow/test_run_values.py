"""The values of a run cover the numbers that they stand for: operations, flags, branches, memory, meetings."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.wcet.binary.elf import Binary, Segment, load
from mauve.wcet.binary.microop import Op
from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import MASK, Range
from mauve.wcet.flow.run import flags, operations
from mauve.wcet.flow.run.content import Given
from mauve.wcet.flow.run.covering import covers, merge, widened
from mauve.wcet.flow.run.layers import branch
from mauve.wcet.flow.run.memory import Memory
from mauve.wcet.flow.run.narrow import sides, told
from mauve.wcet.flow.run.paths import Counters, Meeting
from mauve.wcet.flow.run.paths import Path as Way
from mauve.wcet.flow.run.words import Some, Stack, Undecided, Word, made, range_of

WHOLE = Path(__file__).parent / "whole"
words = st.integers(0, MASK) | st.integers(0, 40) | st.integers(MASK - 40, MASK) | st.integers(0x7FFF_FFF0, 0x8000_0010)


@st.composite
def members(draw: st.DrawFn) -> tuple[int, Word]:
    """A number and a word that may be it."""
    number = draw(words)
    if draw(st.integers(0, 4)) == 0:
        return number, number
    step = draw(st.sampled_from([1, 1, 2, 4, 3]))
    below, above = draw(st.integers(0, 20)), draw(st.integers(0, 20))
    if draw(st.booleans()):
        return number, made(domain.of([number, *draw(st.lists(words, max_size=3))]))
    return number, made(domain.progression(number - below * step, step, below + above))


OPERATIONS = {
    "+": lambda a, b: (a + b) & MASK,
    "-": lambda a, b: (a - b) & MASK,
    "*": lambda a, b: (a * b) & MASK,
    "&": lambda a, b: a & b,
    "|": lambda a, b: a | b,
    "^": lambda a, b: a ^ b,
    "x & (x - 1)": lambda a, b: a & ((a - 1) & MASK),
    "<<": lambda a, b: operations.shift_left(a, b),
    ">>": lambda a, b: operations.shift_right(a, b),
    "asr": lambda a, b: operations.shift_right_signed(a, b),
    "ror": lambda a, b: operations.rotate(a, b),
    "udiv": lambda a, b: operations.divide(a, b),
    "sdiv": lambda a, b: operations.binary(Op.SDIV, a, b),
    "umulh": lambda a, b: operations.high_unsigned(a, b),
    "smulh": lambda a, b: operations.high_signed(a, b),
    "sxtb": lambda a, b: operations.extend_byte(a),
    "sxth": lambda a, b: operations.extend_half(a),
    "clz": lambda a, b: operations.leading_zeros(a),
}


@settings(max_examples=400, deadline=None)
@given(members(), members(), st.sampled_from(sorted(OPERATIONS)))
def test_operations_cover_what_the_numbers_give(a: tuple[int, Word], b: tuple[int, Word], name: str) -> None:
    compute = OPERATIONS[name]
    assert covers(compute(a[1], b[1]), compute(a[0], b[0]))


@settings(max_examples=500, deadline=None)
@given(members(), members(), st.sampled_from([0, 2, 4, 8, 10, 12]), st.sampled_from(["a - b", "a + b", "a", "a & 7"]))
def test_what_a_branch_tells_holds_for_the_numbers(
    a: tuple[int, Word], b: tuple[int, Word], code: int, kind: str
) -> None:
    """A decided condition is that of the numbers, and narrowing keeps them."""
    if kind == "a - b":
        known, asked = (
            flags.of_difference(a[0], b[0]),
            flags.Flags(flags.Source.DIFFERENCE, a[1], b[1], (a[1] - b[1]) & MASK),
        )
    elif kind == "a + b":
        known, asked = flags.of_sum(a[0], b[0]), flags.Flags(flags.Source.SUM, a[1], b[1], (a[1] + b[1]) & MASK)
    else:
        low = MASK if kind == "a" else 7
        known = (*flags.of_result(a[0] & low), 0, 0)
        asked = flags.Flags(flags.Source.RESULT, a[1] & low)
        code = code if code in (0, 4) else 0
    holds = flags.holds(code, *known)
    with suppress(Undecided):
        assert asked.holds(code) == holds
    found = told(asked, code, holds)
    assert found is not None
    result = (a[0] - b[0] if kind == "a - b" else a[0] + b[0]) & MASK
    numbers = {id(a[1]): a[0], id(b[1]): b[0], id(asked.result): result}
    if kind.startswith("a") and asked.source is flags.Source.RESULT:
        numbers[id(asked.a)] = a[0] & (MASK if kind == "a" else 7)
    for word, kept in found:
        assert numbers[id(word)] in kept
    side = sides(asked, code, negated=not holds)[0]
    assert all(covers(new, numbers[old]) for old, new in side.items())


@settings(max_examples=150, deadline=None)
@given(members(), members())
def test_one_word_covers_two(a: tuple[int, Word], b: tuple[int, Word]) -> None:
    for number in (a[0], b[0]):
        assert covers(merge(a[1], b[1]), number) and covers(widened(a[1], b[1]), number)
    assert covers(merge(Stack(4), Stack(12)), Stack(12)) and covers(merge(Stack(4), 3), 3) is not False


def test_copies_of_a_word_know_of_each_other() -> None:
    """Sums keep their distance; low bits tell of the whole."""
    word = Some(domain.between(0, 100))
    assert (word + 3) - (word + 1) == 2 and (word + 3) != word + 1
    found = dict(told(flags.Flags(flags.Source.RESULT, word & 1), 0, True) or ())
    assert found[word] == Range(0, 2, 50)


def memory(*given_: Given) -> Memory:
    whole = load(WHOLE / "cortex-m3-O2.elf")
    assert isinstance(whole, Binary)
    data = Segment(0x2000_0000, 0x46, bytes(range(0x40)), True, False)
    return Memory(replace(whole, segments=(data,)), True, given_)


def test_memory_starts_as_given() -> None:
    """Numbers of each size in their ranges, also in a word that the segment ends in; other bytes as linked."""
    bytes_ = Given(0x2000_0000, 0x2000_0003, 1, domain.between(-5, 5))
    halves = Given(0x2000_0044, 0x2000_0046, 2, domain.between(-3, 300))
    numbers = Given(0x2000_0010, 0x2000_0018, 4, domain.between(7, 9))
    found = memory(bytes_, halves, numbers)
    site = found.site()
    assert range_of(found.load_signed_byte(0x2000_0002, site)) == domain.between(-5, 5)
    assert found.load_byte(0x2000_0003, site) == 3
    assert range_of(found.load_signed_half(0x2000_0044, site)) == domain.between(-3, 300)
    assert range_of(found.load(0x2000_0014, site)) == domain.between(7, 9)
    assert found.load(0x2000_0014, site) is found.load(0x2000_0014, site)
    assert found.load(0x2000_0010, site) is not found.load(0x2000_0014, site)


def test_a_store_by_an_unknown_index_stays_where_it_can_go() -> None:
    found = memory()
    site = found.site()
    found.store(Some(domain.progression(0x2000_0010, 4, 1)), 1, site)
    assert range_of(found.load(0x2000_0010, site)) == domain.of([0x1312_1110, 1])
    assert found.load(0x2000_0018, site) == 0x1B1A_1918
    found.store(Some(domain.TOP), 1, site)
    found.store(Stack(-8), 5, site)
    assert range_of(found.load(0x2000_0018, site)) == domain.TOP and found.load(Stack(-8), site) == 5


def test_where_paths_meet_memory_covers_both() -> None:
    """What was one word on both paths is one word afterwards."""
    found = memory()
    site = found.site()
    start = found.layer
    paths = []
    for value in (1, 2):
        found.enter(branch(start))
        found.store(0x2000_0000, value, site)
        registers = [value, value, 7, *[0] * 59]
        paths.append(Way(0, registers, found.layer, Counters([], [], [], {})))
    met = Meeting(found).join(*paths)
    found.enter(met.layer)
    assert met.registers[0] is met.registers[1] and met.registers[2] == 7
    assert range_of(found.load(0x2000_0000, site)) == domain.of([1, 2])
    assert found.load(0x2000_0004, site) == 0x0706_0504
