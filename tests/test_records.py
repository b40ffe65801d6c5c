"""Records: what a frozen slotted dataclass promises, at less cost to declare."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
import timeit
from dataclasses import dataclass, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mauve.records import changed, field_names, is_record, record


@record
class Point:
    """A place."""

    x: int
    y: int = 0
    name: str = ""


@dataclass(frozen=True, slots=True)
class PlainPoint:
    x: int
    y: int = 0
    name: str = ""


@record
class Other:
    x: int
    y: int = 0
    name: str = ""


@record
class One:
    only: object


@record
class Nothing:
    """A record without fields."""


@record
class Checked:
    size: int

    def __post_init__(self) -> None:
        if self.size < 0:
            raise ValueError("negative")

    @property
    def twice(self) -> int:
        return 2 * self.size

    def __str__(self) -> str:
        return f"size {self.size}"


@record
class OwnEquality:
    key: int
    rest: int

    def __eq__(self, other: object) -> bool:
        return isinstance(other, OwnEquality) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


values = st.one_of(st.integers(-2, 2), st.text("ab", max_size=2), st.tuples(st.integers(0, 1)), st.none())
rows = st.tuples(values, values, values)
calls = st.tuples(
    st.lists(values, max_size=4),
    st.dictionaries(st.sampled_from(["x", "y", "name", "z"]), values, max_size=3),
)


def made(cls: type, positional: list[object], named: dict[str, object]) -> object:
    """The object, or the fact that there is none."""
    try:
        return cls(*positional, **named)
    except TypeError:
        return TypeError


@given(calls)
def test_construction_is_that_of_a_dataclass(call):
    plain, ours = made(PlainPoint, *call), made(Point, *call)
    assert (plain is TypeError) == (ours is TypeError)
    if ours is not TypeError:
        assert [getattr(ours, name) for name in field_names(ours)] == [plain.x, plain.y, plain.name]
        assert repr(ours) == repr(plain).replace("PlainPoint", "Point")


@given(rows, rows)
def test_equality_and_hash_are_those_of_a_dataclass(first, second):
    assert (Point(*first) == Point(*second)) == (PlainPoint(*first) == PlainPoint(*second))
    assert hash(Point(*first)) == hash(PlainPoint(*first))
    assert Point(*first) != Other(*first)
    assert Point(*first) != first


@given(rows, st.sampled_from(["x", "y", "name"]), values)
def test_changing_is_replacing(row, name, value):
    before = Point(*row)
    after, plain = changed(before, **{name: value}), replace(PlainPoint(*row), **{name: value})
    assert [after.x, after.y, after.name] == [plain.x, plain.y, plain.name]
    assert before == Point(*row)


@given(rows)
def test_copies_are_equal(row):
    one = Point(Point(*row), (One(row[0]), Nothing()))
    copies = [copy.copy(one), copy.deepcopy(one), changed(one)]
    copies += [pickle.loads(pickle.dumps(one, protocol)) for protocol in range(pickle.HIGHEST_PROTOCOL + 1)]
    assert all(each == one and each is not one and hash(each) == hash(one) for each in copies)


def test_a_record_never_changes():
    one = Point(1, 2)
    for name in ("x", "unknown"):
        with pytest.raises(AttributeError):
            setattr(one, name, 5)
        with pytest.raises(AttributeError):
            delattr(one, name)
    assert one == Point(1, 2)
    assert not hasattr(one, "__dict__")


def test_no_field_no_change():
    with pytest.raises(TypeError):
        changed(Point(1), z=3)


def test_matching_by_position_and_by_name():
    match Point(1, 2, "a"):
        case Point(x, 2, name=name):
            assert (x, name) == (1, "a")
        case _:
            pytest.fail("no match")


def test_records_of_few_fields():
    assert (Nothing(), hash(Nothing()), repr(Nothing())) == (Nothing(), hash(()), "Nothing()")
    assert (One((1,)), repr(One(1))) == (One((1,)), "One(only=1)")
    assert One((1,)) != One(1)
    with pytest.raises(TypeError):
        hash(One([]))
    with pytest.raises(TypeError):
        Nothing(1)


def test_methods_of_the_class_are_kept():
    assert (Checked(2).twice, str(Checked(2)), repr(Checked(2))) == (4, "size 2", "Checked(size=2)")
    assert OwnEquality(1, 2) == OwnEquality(1, 3)
    assert len({OwnEquality(1, 2), OwnEquality(1, 3)}) == 1


def test_a_record_may_check_itself():
    for _ in range(2):
        with pytest.raises(ValueError, match="negative"):
            Checked(-1)
    with pytest.raises(ValueError, match="negative"):
        changed(Checked(1), size=-1)


def test_what_the_class_tells():
    assert field_names(Point) == field_names(Point(1)) == ("x", "y", "name")
    assert is_record(Point(1))
    assert not is_record(Point)
    assert not is_record(PlainPoint(1))
    assert (Point.__doc__, Point.__module__, Point.__qualname__) == ("A place.", __name__, "Point")


def test_classes_that_break_the_rules():
    with pytest.raises(TypeError, match="has a base class"):
        record(type("Child", (Point,), {}))
    with pytest.raises(TypeError, match="without a default"):
        record(type("Late", (), {"__annotations__": {"a": "int", "b": "int"}, "a": 1}))


def test_construction_is_no_slower_than_that_of_a_dataclass():
    rounds = [
        [timeit.timeit(lambda cls=cls: cls(1, 2, "a"), number=20_000) for cls in (Point, PlainPoint)] for _ in range(5)
    ]
    assert min(ours for ours, _ in rounds) < 1.2 * min(plain for _, plain in rounds)


def test_a_check_without_binaries_imports_nothing_of_dataclasses(tmp_path):
    """Importing `dataclasses` brings in `inspect` and costs as much as a hundred records."""
    model = tmp_path / "small.mauve"
    model.write_text("mauve 1\nenum Link { OK, LOST }\n")
    program = (
        "import sys; from mauve.cli import main; main(sys.argv[1:]); "
        "dear = ('dataclasses', 'inspect', 'importlib.resources', 'mauve.wcet.result'); "
        "print([name for name in dear if name in sys.modules])"
    )
    command = [sys.executable, "-S", "-c", program, "check", str(model)]
    found = subprocess.run(command, capture_output=True, text=True, check=True)
    assert found.stdout.splitlines()[-1] == "[]"
