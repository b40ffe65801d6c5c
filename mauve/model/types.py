"""Data types of ports, properties and parameters, with their size in C (AAPCS)."""

from __future__ import annotations

from mauve.records import record


@record
class Scalar:
    """A built-in type. `size` in bytes, which is also its alignment."""

    name: str
    size: int

    def __str__(self) -> str:
        return self.name


@record
class Enum:
    """An enumeration; a 32-bit integer in C."""

    name: str
    literals: tuple[str, ...]

    def __str__(self) -> str:
        return self.name


@record
class Struct:
    """A struct; build it with `make_struct`, which lays it out. Two structs of one name with the same fields are the
    same type."""

    name: str
    fields: tuple[tuple[str, Type], ...]
    size: int
    alignment: int

    def __str__(self) -> str:
        return self.name

    def field(self, name: str) -> Type | None:
        """The type of a field."""
        return dict(self.fields).get(name)


@record
class Array:
    """A fixed number of elements."""

    element: Type
    length: int

    def __str__(self) -> str:
        lengths = ""
        inner: Type = self
        while isinstance(inner, Array):
            lengths += f"[{inner.length}]"
            inner = inner.element
        return f"{inner}{lengths}"


Type = Scalar | Enum | Struct | Array

BUILT_IN: dict[str, Scalar] = {
    name: Scalar(name, size)
    for name, size in (
        ("bool", 1), ("i8", 1), ("u8", 1), ("i16", 2), ("u16", 2), ("i32", 4), ("u32", 4), ("i64", 8), ("u64", 8),
        ("f32", 4), ("f64", 8), ("time", 8), ("string", 4),
    )
}  # fmt: skip
"""`time` is a 64-bit count of nanoseconds, `string` a pointer to characters."""

INTEGER_RANGES: dict[str, tuple[int, int]] = {
    "i8": (-(1 << 7), (1 << 7) - 1), "u8": (0, (1 << 8) - 1),
    "i16": (-(1 << 15), (1 << 15) - 1), "u16": (0, (1 << 16) - 1),
    "i32": (-(1 << 31), (1 << 31) - 1), "u32": (0, (1 << 32) - 1),
    "i64": (-(1 << 63), (1 << 63) - 1), "u64": (0, (1 << 64) - 1),
}  # fmt: skip


def make_struct(name: str, fields: tuple[tuple[str, Type], ...]) -> Struct:
    """The struct of these fields, in order, with padding as in C (AAPCS section 5.3.5)."""
    offset, largest = 0, 1
    for _, field in fields:
        align = alignment(field)
        offset = -(-offset // align) * align + size_of(field)
        largest = max(largest, align)
    return Struct(name, fields, -(-offset // largest) * largest, largest)


def alignment(type_: Type) -> int:
    """Alignment in bytes (AAPCS section 5)."""
    match type_:
        case Scalar(size=size):
            return size
        case Enum():
            return 4
        case Struct(alignment=align):
            return align
        case Array(element=element):
            return alignment(element)


def size_of(type_: Type) -> int:
    """Size in bytes, padding included (AAPCS section 5)."""
    match type_:
        case Scalar(size=size) | Struct(size=size):
            return size
        case Enum():
            return 4
        case Array(element=element, length=length):
            return size_of(element) * length
