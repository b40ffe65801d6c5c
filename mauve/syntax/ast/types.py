"""Type references, structs and enumerations as written."""

from __future__ import annotations

from mauve.records import record
from mauve.source import Span
from mauve.syntax.ast.names import Name, Number, Path


@record
class TypeRef:
    """A type by name with array dimensions: `Task[64]`."""

    path: Path
    dimensions: tuple[Number, ...]
    span: Span


@record
class Field:
    """One field of a struct (`x, y: f64` gives two)."""

    name: Name
    type: TypeRef
    doc: str = ""


@record
class StructDecl:
    """`struct Pose { x, y, heading: f64 }`."""

    name: Name
    fields: tuple[Field, ...]
    span: Span
    doc: str = ""


@record
class EnumDecl:
    """`enum LinkStatus { OK, TIMEOUT }`."""

    name: Name
    literals: tuple[Name, ...]
    span: Span
    doc: str = ""
