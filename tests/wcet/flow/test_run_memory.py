"""The memory of a run against executions on plain bytes: what it answers covers what each of them holds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from mauve.wcet.binary.elf import Binary, Segment, load
from mauve.wcet.flow import domain
from mauve.wcet.flow.run.compared import Compared, Register
from mauve.wcet.flow.run.compile import RELATED
from mauve.wcet.flow.run.content import Given
from mauve.wcet.flow.run.flags import CS, EQ, GE, GT, HI, Flags, Source
from mauve.wcet.flow.run.layers import branch, release
from mauve.wcet.flow.run.learn import learn
from mauve.wcet.flow.run.memory import Lost, Memory
from mauve.wcet.flow.run.narrow import told, within
from mauve.wcet.flow.run.paths import Counters, Meeting
from mauve.wcet.flow.run.paths import Path as Way
from mauve.wcet.flow.run.related import base_of, told_apart
from mauve.wcet.flow.run.repeats import includes, keep, widen
from mauve.wcet.flow.run.words import MASK, Low, Ranged, Some, Stack, Stacks, Unknown, Word, made

WHOLE = Path(__file__).parent / "whole"
START, SIZE, BYTES = 0x2000_0000, 0x60, 0x5E
TOP_OF_STACK, DEPTH = 0x2008_0000, 0x20
REGISTERS, SLOTS = 6, 62
FACTORS = (1, 2, 4, -1, -2, -4)
LOADS = {"load": 4, "load_byte": 1, "load_signed_byte": 1, "load_half": 2, "load_signed_half": 2}
GIVEN = (
    Given(START + 0x10, START + 0x1A),
    Given(START + 0x20, START + 0x26, 1, domain.between(-5, 5)),
    Given(START + 0x28, START + 0x30, 2, domain.between(-3, 300)),
    Given(START + 0x34, START + 0x40, 4, domain.between(-2, 70000)),
)


@cache
def image() -> Binary:
    found = load(WHOLE / "cortex-m3-O2.elf")
    assert isinstance(found, Binary)
    return found


@dataclass(eq=False)
class Execution:
    """Bytes by address, and registers."""

    data: dict[int, int]
    registers: list[int]

    def copy(self) -> Execution:
        return Execution(dict(self.data), list(self.registers))

    def load(self, address: int, name: str) -> int:
        size = LOADS[name]
        value = sum(self.data[address + i] << 8 * i for i in range(size))
        return (value - (1 << 8 * size) if "signed" in name and value >> 8 * size - 1 else value) & MASK

    def store(self, address: int, value: int, size: int) -> None:
        for i in range(size):
            self.data[address + i] = value >> 8 * i & 0xFF


@dataclass(eq=False)
class Followed:
    """A path and executions that take it."""

    way: Way
    executions: list[Execution]


def holds(word: Any, number: int) -> bool:
    """Whether a word may be this number."""
    match word:
        case int():
            return word == number
        case Some():
            return number in word.range
        case Stack():
            return (TOP_OF_STACK + word.offset) & MASK == number
        case Stacks():
            return (number - TOP_OF_STACK) & MASK in word.range
        case Low():
            return word.bits == number & 7
    return isinstance(word, Unknown)


COMPARED = Compared(
    tuple((Register(i), Register(j)) for i in range(REGISTERS) for j in range(i)),
    tuple(Register(i) for i in range(REGISTERS)),
    {Register(1): frozenset({7, 8, 9})},
)


def compares(code: int, a: int, b: int) -> bool:
    """Whether a condition (its even encoding) holds after a comparison of two numbers."""
    if code in (GE, GT):
        a, b = domain.signed(a), domain.signed(b)
    return a == b if code == EQ else a >= b if code in (CS, GE) else a > b


class Trial:
    """Random work on a memory, done by executions as well."""

    def __init__(self, seed: int, unaligned: bool, leaks: bool) -> None:
        self.random, self.unaligned, self.leaks = Random(seed), unaligned, leaks
        content = bytes(range(0x40))
        data = Segment(START, BYTES, content, True, False)
        self.memory = Memory(replace(image(), segments=(data,)), unaligned, GIVEN)
        self.site = self.memory.site()
        start = [self.execution(content) for _ in range(4)]
        registers: list[Any] = [0] * SLOTS
        registers[RELATED] = {}
        self.paths = [Followed(Way(0, registers, self.memory.layer, Counters([], [], [], {})), start)]

    def execution(self, content: bytes) -> Execution:
        data = {START + i: (content[i] if i < len(content) else 0) for i in range(BYTES)}
        data |= {TOP_OF_STACK - DEPTH + i: self.random.randrange(256) for i in range(DEPTH)}
        one = Execution(data, [0] * REGISTERS)
        for given_ in GIVEN:
            width = given_.width or 1
            for address in range(given_.start, given_.end, width):
                one.store(address, given_.values.low + self.random.randrange(given_.values.size), width)
        return one

    # ------------------------------------------------------------------------------------------------ choices
    def address(self, size: int) -> tuple[Word, list[int]]:
        """An address and the numbers that it may be."""
        random = self.random
        in_stack = random.random() < 0.3
        low, length = (-DEPTH, DEPTH) if in_stack else (0, BYTES)
        unit = 1 if self.unaligned and random.random() < 0.15 else size
        step = unit * random.choice([1, 1, 1, 2, 3, 4])
        most = (length - size) // step
        count = random.choice([1, 1, 1, 2, 3, most + 1, random.randint(1, most + 1)])
        count = min(count, most + 1)
        first = random.randrange(0, (length - size - (count - 1) * step) // unit + 1) * unit + low
        values = domain.progression(first, step, count - 1)
        if count > 4 and random.random() < 0.2:
            values = domain.of(first + step * k for k in random.sample(range(count), 3))
        numbers = [domain.signed(value) for value in values.members()]
        if in_stack:
            word: Word = Stack(numbers[0]) if len(numbers) == 1 else Stacks(values)
            return word, [TOP_OF_STACK + number for number in numbers]
        return made(domain.shift(values, START)), [START + number for number in numbers]

    def value(self, path: Followed) -> tuple[Word, list[int]]:
        """A word to write, and its number in each of the executions."""
        random, executions = self.random, path.executions
        choice = random.random()
        if choice < 0.35:
            register = random.randrange(REGISTERS)
            return path.way.registers[register], [one.registers[register] for one in executions]
        if choice < 0.6:
            number = random.choice([0, 1, 7, 255, 256, 0x1234, MASK, random.getrandbits(32)])
            return number, [number] * len(executions)
        if self.leaks and choice < 0.65:
            return Stack(-8), [TOP_OF_STACK - 8] * len(executions)
        low = random.choice([0, 3, -4, 100, 0x7FF0, random.getrandbits(32)])
        values = domain.progression(low, random.choice([1, 1, 4]), random.choice([1, 5, 40, 255]))
        members = list(values.members())
        return made(values), [random.choice(members) for _ in executions]

    # ------------------------------------------------------------------------------------------------ work
    def work(self) -> None:
        for _ in range(self.random.randint(10, 50)):
            path = self.random.choice(self.paths)
            self.memory.enter(path.way.layer)
            path.way.layer = self.memory.layer
            pick = self.random.random()
            if pick < 0.2:
                self.load(path)
            elif pick < 0.26:
                self.add(path)
            elif pick < 0.34:
                self.tell(path)
            elif pick < 0.7:
                self.store(path)
            elif pick < 0.74:
                self.narrow(path)
            elif pick < 0.77 and not self.leaks:
                self.forget(path)
            elif pick < 0.88 and len(self.paths) < 5:
                self.fork(path)
            elif pick < 0.91:
                self.iterate(path)
            elif len(self.paths) > 1:
                self.join()
        for path in self.paths:
            self.check(path)

    def load(self, path: Followed) -> None:
        name = self.random.choice(list(LOADS))
        address, numbers = self.address(LOADS[name])
        found = getattr(self.memory, name)(address, self.site)
        register = self.random.randrange(REGISTERS)
        path.way.registers[register] = found
        for one in path.executions:
            one.registers[register] = one.load(self.random.choice(numbers), name)
            assert holds(found, one.registers[register])
        self.compare(path)

    def store(self, path: Followed) -> None:
        name = self.random.choice(["store", "store_byte", "store_half"])
        size = {"store": 4, "store_byte": 1, "store_half": 2}[name]
        address, numbers = self.address(size)
        for _ in range(self.random.choice([1, 1, 2])):
            word, values = self.value(path)
            getattr(self.memory, name)(address, word, self.site)
            for one, value in zip(path.executions, values, strict=True):
                one.store(self.random.choice(numbers), value, size)

    def narrow(self, path: Followed) -> None:
        """A branch tells that a register has the lower or the upper half of its values."""
        register = self.random.randrange(REGISTERS)
        word = path.way.registers[register]
        if type(word) is not Some:
            return
        low, high = word.range.unsigned_bounds()
        middle = (low + high) // 2
        for least, most in ((low, middle), (middle + 1, high)):
            kept = [one for one in path.executions if least <= one.registers[register] <= most]
            values = domain.meet(word.range, domain.between(least, most))
            if kept and values is not None:
                narrower = within(word, values)
                assert narrower is not None
                path.executions = kept
                self.memory.narrow(word, narrower)
                for number, other in enumerate(path.way.registers):
                    if other is word:
                        path.way.registers[number] = narrower
                return

    def add(self, path: Followed) -> None:
        """A register becomes the sum of two, or of one and a number."""
        registers, random = path.way.registers, self.random
        target, first, second = (random.randrange(REGISTERS) for _ in range(3))
        if random.random() < 0.6:
            number = random.choice([1, 2, 4, MASK])
            registers[target] = (registers[first] + number) & MASK
            for one in path.executions:
                one.registers[target] = (one.registers[first] + number) & MASK
        elif random.random() < 0.3:
            difference = registers[first] - registers[second]
            if type(difference) in (int, Some):
                registers[target] = difference & MASK
                for one in path.executions:
                    one.registers[target] = (one.registers[first] - one.registers[second]) & MASK
        elif random.random() < 0.3 and type(registers[first]) in (int, Some):
            by = random.choice([1, 2])
            registers[target] = (registers[first] << by) & MASK
            for one in path.executions:
                one.registers[target] = (one.registers[first] << by) & MASK
        elif type(registers[first]) in (int, Some) and type(registers[second]) in (int, Some):
            registers[target] = (registers[first] + registers[second]) & MASK
            for one in path.executions:
                one.registers[target] = (one.registers[first] + one.registers[second]) & MASK
        self.compare(path)

    def step(self, path: Followed) -> None:
        """Two registers move in step."""
        registers, random = path.way.registers, self.random
        far, times = random.choice([1, MASK, 2]), random.choice([1, 2, 4, MASK])
        for register, number in zip(random.sample(range(REGISTERS), 2), (far, far * times & MASK), strict=True):
            registers[register] = (registers[register] + number) & MASK
            for one in path.executions:
                one.registers[register] = (one.registers[register] + number) & MASK
        self.compare(path)

    def tell(self, path: Followed) -> None:
        """A branch that compares two registers; only executions that agree with it go on."""
        registers, random = path.way.registers, self.random
        i, j = random.sample(range(REGISTERS), 2)
        a, b = registers[i], registers[j]
        if not isinstance(a, Ranged) and not isinstance(b, Ranged):
            return
        code, is_true = random.choice([EQ, CS, HI, GE, GT]), random.random() < 0.5
        kept = [one for one in path.executions if compares(code, one.registers[i], one.registers[j]) == is_true]
        if not kept:
            return
        path.executions = kept
        flags = Flags(Source.DIFFERENCE, a, b)
        alone, apart = told(flags, code, is_true), told_apart(flags, code, is_true, registers[RELATED])
        assert alone is not None and apart is not None
        registers[RELATED] = apart[1]
        learn(registers, self.memory, alone + apart[0])
        self.compare(path)

    def forget(self, path: Followed) -> None:
        """A store that may go anywhere but to the stack."""
        self.memory.store(made(domain.TOP), 5, self.site)
        for one in path.executions:
            one.store(START + 4 * self.random.randrange(BYTES // 4), 5, 4)

    def fork(self, path: Followed) -> None:
        layer, way = path.way.layer, path.way
        self.paths.remove(path)
        for _ in range(2):
            other = Way(0, way.registers[:], branch(layer), way.counters)
            self.paths.append(Followed(other, [one.copy() for one in path.executions if self.random.random() < 0.7]))
        release(layer)

    def join(self) -> None:
        first, second = self.random.sample(self.paths, 2)
        self.paths.remove(first)
        self.paths.remove(second)
        met = Meeting(self.memory).join(first.way, second.way, COMPARED.pairs)
        both = first.executions + second.executions
        self.paths.append(Followed(met, self.random.sample(both, min(len(both), 6))))
        self.memory.enter(met.layer)
        met.layer = self.memory.layer
        self.compare(self.paths[-1])

    def iterate(self, path: Followed) -> None:
        """Stores of one more iteration of a loop; the memory is compared with the earlier one's and widened."""
        before = keep(self.memory, path.way, COMPARED.places, COMPARED.pairs)
        early = [one.copy() for one in path.executions]
        self.memory.enter(branch(before.path.layer))
        path.way.layer = self.memory.layer
        for _ in range(self.random.randint(0, 3)):
            self.random.choice([self.store, self.add, self.step, self.step, self.tell])(path)
        if includes(self.memory, before, path.way):
            self.check(Followed(before.path, path.executions))
        path.way = widen(self.memory, before, path.way, COMPARED, ())
        release(before.path.layer)
        self.memory.enter(path.way.layer)
        path.way.layer = self.memory.layer
        path.executions = (path.executions + early)[:6]
        self.compare(path)

    # ------------------------------------------------------------------------------------------------ checks
    def compare(self, path: Followed) -> None:
        """Registers cover those of all executions, and words with a known distance have that distance."""
        registers = path.way.registers[:REGISTERS]
        for one in path.executions:
            for word, number in zip(registers, one.registers, strict=True):
                assert holds(word, number)
            for i, word in enumerate(registers):
                for j, other in enumerate(registers):
                    if type(word) is type(other) and isinstance(word, Ranged) and word.base is other.base:
                        assert (word.offset - other.offset - one.registers[i] + one.registers[j]) & MASK == 0
                    self.compare_difference(path, one, i, j)

    def compare_difference(self, path: Followed, one: Execution, i: int, j: int) -> None:
        """What a path knows of the difference of a register and a multiple of another is so in an execution."""
        word, other = path.way.registers[i], path.way.registers[j]
        (first, moved), (second, shifted) = base_of(word), base_of(other)
        numbers = [
            number - (TOP_OF_STACK if type(at) in (Stack, Stacks) else 0)
            for at, number in ((word, one.registers[i]), (other, one.registers[j]))
        ]
        for factor in FACTORS:
            found = path.way.registers[RELATED].get((id(first), id(second), factor))
            if found is not None:
                assert (numbers[0] - moved - factor * (numbers[1] - shifted)) & MASK in found[2]

    def check(self, path: Followed) -> None:
        """All that can be read."""
        self.memory.enter(branch(path.way.layer))
        self.compare(path)
        for name in self.random.sample(list(LOADS), 3):
            size = LOADS[name]
            places: list[tuple[Word, int]] = [(START + i, START + i) for i in range(0, BYTES - size + 1, size)]
            places += [(Stack(i), TOP_OF_STACK + i) for i in range(-DEPTH, 0, size)]
            for address, number in places:
                found = getattr(self.memory, name)(address, self.site)
                assert all(holds(found, one.load(number, name)) for one in path.executions)
        release(self.memory.layer)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 1 << 32), st.booleans(), st.booleans())
@example(4_294_901_760, False, False)
def test_what_is_read_covers_what_executions_hold(seed: int, unaligned: bool, leaks: bool) -> None:
    Trial(seed, unaligned, leaks).work()


def start() -> Memory:
    data = Segment(START, 0x1000, bytes(range(0x40)), True, False)
    return Memory(replace(image(), segments=(data,)), True)


def parted(memory: Memory) -> tuple[Way, Way]:
    """Two paths from here."""
    layer = memory.layer
    ways = [Way(0, [*[0] * RELATED, {}, *[0] * (SLOTS - 16)], branch(layer), Counters([], [], [], {})) for _ in "ab"]
    release(layer)
    return ways[0], ways[1]


def test_a_device_answers_anew_each_time() -> None:
    memory = start()
    site = memory.site()
    for name in LOADS:
        read = getattr(memory, name)
        assert read(0x7000_1000, site) is not read(0x7000_1000, site)
        several = Some(domain.progression(0x7000_1000, 4, 10))
        assert read(several, site) is not read(several, site)


def test_a_word_of_small_numbers_does_not_cover_any_four_bytes() -> None:
    """Though each of its bytes may be any: those of -4 and of 36."""
    memory = start()
    site = memory.site()
    memory.store(START, Some(domain.between(-4, 36)), site)
    before, after = parted(memory)
    memory.enter(after.layer)
    memory.store_byte(START + 1, Some(domain.BYTE), site)
    after.layer = memory.layer
    assert not includes(memory, keep(memory, before, ()), after)
    memory.enter(before.layer)
    memory.store_half(START + 8, Some(domain.between(-3, 300)), site)
    before.layer = memory.layer
    memory.enter(after.layer)
    memory.store(START, Some(domain.between(0, 36)), site)
    memory.store_half(START + 8, Some(domain.between(0, 0xFFFF)), site)
    after.layer = memory.layer
    assert not includes(memory, keep(memory, before, ()), after)
    memory.store_half(START + 8, Some(domain.between(0xFFFF, 0x1_0005)), site)  # -1 to 5
    after.layer = memory.layer
    assert includes(memory, keep(memory, before, ()), after)


def test_words_of_one_path_meet_bytes_of_the_other() -> None:
    """Each cell for itself, though the bytes of words live no longer than the joining of a cell."""
    memory = start()
    site = memory.site()
    words, bytes_ = parted(memory)
    memory.enter(words.layer)
    numbers = [0x0101_0101 * i for i in range(1, 40)]
    for i, number in enumerate(numbers):
        memory.store(START + 4 * i, Some(domain.between(number, number + 2)), site)
    words.layer = memory.layer
    memory.enter(bytes_.layer)
    for i in range(len(numbers)):
        memory.store(START + 4 * i, 0, site)
        memory.store_byte(START + 4 * i, Some(domain.BIT), site)
    bytes_.layer = memory.layer
    memory.enter(Meeting(memory).join(words, bytes_).layer)
    for i, number in enumerate(numbers):
        assert all(holds(memory.load(START + 4 * i, site), one) for one in (number, number + 2, 0, 1))
        assert not holds(memory.load_byte(START + 4 * i + 3, site), 0xFF)


def test_cells_of_which_the_same_is_known_are_one_object() -> None:
    """And a store that tells nothing new changes nothing, though what is read then is another word."""
    memory = start()
    site = memory.site()
    array = Some(domain.between(START, START + 0x3FF))
    for _ in range(2):
        memory.store_byte(array, Some(domain.between(0, 99)), site)
    zeros = [memory.look(memory.layer, START + at) for at in range(0x40, 0x400, 4)]
    assert all(cell is zeros[0] for cell in zeros)
    found = memory.load_byte(START + 0x41, site)
    assert found is memory.load_byte(START + 0x41, site) and found is not memory.load_byte(START + 0x42, site)
    memory.store_byte(array, 5, site)
    again = memory.load_byte(START + 0x41, site)
    assert again is not found and holds(again, 99) and not holds(again, 100)


def test_a_store_through_a_range_keeps_to_what_can_be_written() -> None:
    """What lies in no segment is a device's, and constants are not written; they are read as they start."""
    data = Segment(START, 0x22, bytes(range(0x22)), True, False)
    constants = Segment(START + 0x100, 0x20, bytes(range(0x20)), False, False)
    memory = Memory(replace(image(), segments=(data, constants)), True)
    site = memory.site()
    for name, step in (("store_byte", 1), ("store_half", 2), ("store", 4), ("store", 12)):
        getattr(memory, name)(Some(domain.progression(START - 0x10 * step, step, 0x20)), 77, site)
    assert {key for key in memory.cells if key < START + 0x100} <= set(range(START, START + 0x24, 4))
    assert holds(memory.load_byte(START + 0x20, site), 0x20) and holds(memory.load_byte(START + 0x20, site), 77)
    with pytest.raises(Lost):
        memory.store(Some(domain.progression(START + 0x10, 0x10, 0x10)), 77, site)
    assert memory.load(START + 0x104, site) == memory.load(START + 0x104, site) == 0x0706_0504
    assert holds(memory.load_byte(Some(domain.between(START + 0x100, START + 0x11F)), site), 0x1F)
    memory.restart((Given(START + 0x104, START + 0x108),))
    assert type(memory.load(START + 0x104, site)) is Some
