"""Types, their layout in C, and values of them."""

from __future__ import annotations

import ctypes

import pytest
from hypothesis import given
from hypothesis import strategies as st
from written import codes, model_of, resolved

from mauve.diagnostics.diagnostic import Severity
from mauve.model.types import BUILT_IN, Array, Enum, Type, alignment, make_struct, size_of

C = {
    "bool": ctypes.c_bool, "i8": ctypes.c_int8, "u8": ctypes.c_uint8, "i16": ctypes.c_int16, "u16": ctypes.c_uint16,
    "i32": ctypes.c_int32, "u32": ctypes.c_uint32, "i64": ctypes.c_int64, "u64": ctypes.c_uint64,
    "f32": ctypes.c_float, "f64": ctypes.c_double, "time": ctypes.c_int64,
}  # fmt: skip
"""Types whose layout on a 64-bit host is that of AAPCS."""

TYPES = st.recursive(
    st.sampled_from(sorted(C)),
    lambda inner: st.lists(inner, min_size=1, max_size=4).map(tuple) | st.tuples(inner, st.integers(1, 5)),
    max_leaves=8,
)


def _both(shape: object) -> tuple[Type, type]:
    """A type of the language and of C."""
    if isinstance(shape, str):
        return BUILT_IN[shape], C[shape]
    assert isinstance(shape, tuple)
    if len(shape) == 2 and isinstance(shape[1], int):
        element, c_element = _both(shape[0])
        return Array(element, shape[1]), c_element * shape[1]
    fields = [_both(one) for one in shape]
    ours = make_struct("S", tuple((f"f{n}", field) for n, (field, _) in enumerate(fields)))
    theirs = type("S", (ctypes.Structure,), {"_fields_": [(f"f{n}", c) for n, (_, c) in enumerate(fields)]})
    return ours, theirs


@given(TYPES)
def test_sizes_and_alignments_are_those_of_a_c_compiler(shape: object) -> None:
    ours, theirs = _both(shape)
    assert size_of(ours) == ctypes.sizeof(theirs)
    assert alignment(ours) == ctypes.alignment(theirs)


def test_an_enumeration_and_a_string_are_words() -> None:
    assert size_of(Enum("E", ("A",))) == alignment(Enum("E", ("A",))) == 4
    assert size_of(BUILT_IN["string"]) == 4


def test_a_type_prints_as_it_is_written() -> None:
    model = model_of("struct P { x: f64 }\nexternal component E {\n  out port p: P[2][3]\n}")
    assert str(model.components[0].ports[0].type) == "P[2][3]"
    assert size_of(model.components[0].ports[0].type) == 48


def test_structs_that_double_are_laid_out_in_linear_time_and_refused_when_they_fit_nowhere() -> None:
    lines = ["struct S0 { a: u8 }", *(f"struct S{n} {{ a, b: S{n - 1} }}" for n in range(1, 60))]
    _, report = resolved("\n".join(lines))
    assert codes(report) == ["MV209"]


def test_a_deep_nest_of_structs_is_refused_not_a_crash() -> None:
    lines = [f"struct S{n} {{ a: S{n + 1} }}" for n in range(2000)] + ["struct S2000 { a: u8 }"]
    _, report = resolved("\n".join(lines))
    assert "MV209" in codes(report)


def test_an_array_of_many_dimensions_is_refused_not_a_crash() -> None:
    _, report = resolved(f"external component E {{\n  out port p: u8{'[1]' * 3000}\n}}")
    assert codes(report) == ["MV209"]


@pytest.mark.parametrize(
    ("type_", "value"),
    [
        ("u8", "255"), ("i8", "-128"), ("u32", "0xFFFFFFFF"), ("f32", "-1.5e3"), ("f64", "2"), ("bool", "true"),
        ("string", '"a"'), ("time", "3ms"), ("Mode", "ON"), ("Mode", "Mode.ON"), ("Pose", "{ x: 1, y: 2.0 }"),
        ("Pose", "{ y: 2.0 }"), ("i16[2]", "[1, -2]"), ("Pose[1]", "[{ x: 1 }]"),
    ],
)  # fmt: skip
def test_values_of_a_type(type_: str, value: str) -> None:
    model_of(_property(type_, value))


@pytest.mark.parametrize(
    ("type_", "value"),
    [
        ("u8", "256"), ("u8", "-1"), ("i32", "1.5"), ("f32", "true"), ("bool", "1"), ("string", "1"), ("time", "3"),
        ("Mode", "OFF_"), ("Pose", "{ z: 1.0 }"), ("Pose", "{ x: 1.0, x: 2.0 }"), ("Pose", "[1.0]"),
        ("i16[2]", "[1]"), ("i16[2]", "[1, 70000]"), ("Pose[1]", "[{ x: true }]"),
    ],
)  # fmt: skip
def test_values_that_are_none(type_: str, value: str) -> None:
    _, report = resolved(_property(type_, value))
    assert codes(report) == ["MV208"]


def _property(type_: str, value: str) -> str:
    return (
        f"enum Mode {{ ON, OFF }}\nstruct Pose {{ x, y: f64 }}\nexternal component E {{\n"
        f"  property p: {type_} = {value}\n}}"
    )


@pytest.mark.parametrize(("written", "meant"), [("double", "f64"), ("uint8_t", "u8"), ("int", "i32"), ("f46", "f64")])
def test_types_of_other_languages_are_understood(written: str, meant: str) -> None:
    _, report = resolved(f"external component E {{\n  out port p: {written}\n}}")
    (diagnostic,) = report
    assert diagnostic.code == "MV102"
    if written != "f46":
        assert diagnostic.help is not None and meant in diagnostic.help.text


def test_what_has_an_unknown_type_is_known_all_the_same() -> None:
    for wrong in ("int", "Rnage", "Nothing"):
        _, report = resolved(
            f"struct Range {{ metres: f64 }}\nstruct Scan {{ first: {wrong} }}\n"
            f"external component A {{\n  out port scan: Scan\n  out port range: {wrong}\n}}\n"
            "external component B {\n  in port scan: Scan\n}\n"
            "architecture R {\n  instance a: A\n  instance b: B\n  connect a.scan -> b.scan\n}"
        )
        assert [d.code for d in report if d.severity is Severity.ERROR] == ["MV102"] * 2, wrong
