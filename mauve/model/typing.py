"""From written types to types, and whether a written value has a type."""

from __future__ import annotations

from collections.abc import Mapping

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.diagnostics.suggest import closest
from mauve.model.names import Scope, unknown
from mauve.model.types import BUILT_IN, INTEGER_RANGES, Array, Enum, Scalar, Struct, Type, make_struct, size_of
from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.quantities import time_of

LARGEST_OBJECT = 1 << 28
"""Bytes; larger types are refused (MV209), since no target of this tool could hold one."""

MOST_DIMENSIONS = 16

DEEPEST_STRUCT = 100
"""Structs in structs that are resolved at most."""


class TypeTable:
    """The types that a module's names stand for. Each struct is resolved once; one that contains itself is MV203."""

    def __init__(self, scope: Scope, scopes: Mapping[int, Scope], report: Report) -> None:
        self._scope = scope
        self._scopes = scopes
        self._report = report
        self._done: dict[int, Type | None] = {}
        self._open: list[ast.StructDecl] = []

    def resolve(self, ref: ast.TypeRef) -> Type | None:
        """The type written, or None after a diagnostic."""
        return self._resolve(ref, self._scope)

    def declaration(self, declaration: ast.StructDecl | ast.EnumDecl) -> Type | None:
        """The type that a declaration defines."""
        if id(declaration) in self._done:
            return self._done[id(declaration)]
        if isinstance(declaration, ast.EnumDecl):
            result: Type | None = self._enum(declaration)
        else:
            result = self._struct(declaration)
        self._done[id(declaration)] = result
        return result

    def _resolve(self, ref: ast.TypeRef, scope: Scope) -> Type | None:
        name = str(ref.path)
        base: Type | None = BUILT_IN.get(name)
        if base is None:
            found = scope.find(ref.path, (ast.StructDecl, ast.EnumDecl))
            if not isinstance(found, (ast.StructDecl, ast.EnumDecl)):
                visible = scope.of_kind((ast.StructDecl, ast.EnumDecl))
                known = {n: d.name.span for n, d in visible.items()}
                message = f"there is no type `{name}`"
                near_builtin = _builtin_spelling(name)
                diagnostic = unknown("MV102", message, scope.where(), ref.path.span, known, "a type")
                if diagnostic.help is None and near_builtin:
                    help_ = Fix(f"the built-in type is called `{near_builtin}`")
                    diagnostic = Diagnostic("MV102", message, diagnostic.primary, help=help_)
                self._report.add(diagnostic)
                return self._array(self._meant(name, near_builtin, visible), ref)
            base = self.declaration(found)
        return self._array(base, ref)

    def _meant(self, name: str, builtin: str | None, visible: Mapping[str, ast.Declaration]) -> Type | None:
        """The type that stands in for an unknown one, so that one wrong name is one message."""
        near = closest(name.rsplit(".", 1)[-1], visible)
        found = visible[near[0]] if near else None
        if isinstance(found, (ast.StructDecl, ast.EnumDecl)):
            return self.declaration(found)
        return BUILT_IN[builtin] if builtin else make_struct(name, ())

    def _array(self, base: Type | None, ref: ast.TypeRef) -> Type | None:
        if len(ref.dimensions) > MOST_DIMENSIONS:
            message = f"an array has at most {MOST_DIMENSIONS} dimensions"
            self._report.add(Diagnostic("MV209", message, Label(ref.dimensions[MOST_DIMENSIONS].span, "one too many")))
            return None
        for dimension in reversed(ref.dimensions):
            if not dimension.is_integer or dimension.integer < 1:
                message = f"an array cannot have {dimension.text} elements"
                self._report.add(Diagnostic("MV209", message, Label(dimension.span, "a whole number from 1 on")))
                return None
            if base is not None:
                base = Array(base, dimension.integer)
                if size_of(base) > LARGEST_OBJECT:
                    message = f"`{ref.span.text}` takes {size_of(base)} bytes, more than any target can hold"
                    self._report.add(Diagnostic("MV209", message, Label(dimension.span, "too many elements")))
                    return None
        return base

    def _enum(self, declaration: ast.EnumDecl) -> Enum:
        seen: dict[str, Span] = {}
        for literal in declaration.literals:
            if literal.text in seen:
                labels = (Label(seen[literal.text], "first here"),)
                message = f"`{declaration.name}` has the literal `{literal}` twice"
                self._report.add(Diagnostic("MV103", message, Label(literal.span, "and again here"), labels=labels))
            seen.setdefault(literal.text, literal.span)
        return Enum(declaration.name.text, tuple(seen))

    def _struct(self, declaration: ast.StructDecl) -> Struct | None:
        if any(declaration is other for other in self._open):
            at = next(i for i, other in enumerate(self._open) if other is declaration)
            walk = self._open[at:]
            names = " -> ".join(f"`{d.name}`" for d in (*walk, declaration))
            self._report.add(
                Diagnostic(
                    "MV203",
                    f"the struct `{declaration.name}` contains itself",
                    Label(declaration.name.span, "its size would be infinite"),
                    notes=(f"the walk is {names}",),
                )
            )
            return None
        if len(self._open) >= DEEPEST_STRUCT:
            message = f"structs are nested more than {DEEPEST_STRUCT} deep"
            self._report.add(Diagnostic("MV209", message, Label(declaration.name.span)))
            return None
        self._open.append(declaration)
        fields: dict[str, Type] = {}
        spans: dict[str, Span] = {}
        complete = True
        for field in declaration.fields:
            type_ = self._resolve(field.type, self._scopes.get(id(declaration), self._scope))
            if field.name.text in spans:
                labels = (Label(spans[field.name.text], "first here"),)
                message = f"`{declaration.name}` has two fields named `{field.name}`"
                self._report.add(Diagnostic("MV103", message, Label(field.name.span, "and again here"), labels=labels))
                continue
            spans[field.name.text] = field.name.span
            if type_ is None:
                complete = False
            else:
                fields[field.name.text] = type_
        self._open.pop()
        if not complete:
            return None
        result = make_struct(declaration.name.text, tuple(fields.items()))
        if result.size > LARGEST_OBJECT:
            message = f"the struct `{declaration.name}` takes {result.size} bytes, more than any target can hold"
            self._report.add(Diagnostic("MV209", message, Label(declaration.name.span, "too large")))
            return None
        return result


def _builtin_spelling(name: str) -> str | None:
    """The built-in type that people of other languages mean."""
    words = {
        "double": "f64", "float": "f32", "float64": "f64", "float32": "f32",
        "int": "i32", "unsigned": "u32", "char": "u8", "byte": "u8",
        "boolean": "bool", "str": "string", "duration": "time",
    }  # fmt: skip
    for sign, letter in (("uint", "u"), ("int", "i")):
        words |= {f"{sign}{bits}{suffix}": f"{letter}{bits}" for bits in (8, 16, 32, 64) for suffix in ("", "_t")}
    return words.get(name)


def check_value(value: ast.Value, type_: Type, report: Report) -> bool:
    """Whether a written value has a type; where it has not, MV208 says what was expected."""
    problem = _mismatch(value, type_, report)
    if problem is None:
        return True
    span, text, expected = problem
    message = text if text else f"`{span.text}` is no value of type `{expected}`"
    report.add(Diagnostic("MV208", message, Label(span, f"expected {_describe(expected)}")))
    return False


def _mismatch(value: ast.Value, type_: Type, report: Report) -> tuple[Span, str, Type] | None:
    match type_, value:
        case Scalar(name="string"), ast.String():
            return None
        case Scalar(name="bool"), ast.Boolean():
            return None
        case Scalar(name="time"), ast.Quantity():
            time_of(value, report)
            return None
        case Scalar(name="f32" | "f64"), ast.Number():
            return None
        case Scalar(name=name), ast.Number() if name in INTEGER_RANGES and value.is_integer:
            low, high = INTEGER_RANGES[name]
            if low <= value.integer <= high:
                return None
            return value.span, f"{value.text} does not fit into `{name}` ({low} to {high})", type_
        case Enum(literals=literals), ast.Path() if value.parts[-1].text in literals and len(value.parts) <= 2:
            return None
        case Struct(), ast.Record():
            written: set[str] = set()
            for field, item in value.fields:
                field_type = type_.field(field.text)
                if field_type is None:
                    return field.span, f"`{type_}` has no field `{field}`", type_
                if field.text in written:
                    return field.span, f"the field `{field}` is given twice", type_
                written.add(field.text)
                problem = _mismatch(item, field_type, report)
                if problem is not None:
                    return problem
            return None
        case Array(element=element, length=length), ast.List():
            if len(value.items) != length:
                return value.span, f"{len(value.items)} elements where `{type_}` has {length}", type_
            problems = (_mismatch(item, element, report) for item in value.items)
            return next((problem for problem in problems if problem is not None), None)
    return value.span, "", type_


def _describe(type_: Type) -> str:
    match type_:
        case Scalar(name="time"):
            return "a time such as `10ms`"
        case Scalar(name="string"):
            return 'a string such as `"/dev/ttyS1"`'
        case Scalar(name="bool"):
            return "`true` or `false`"
        case Scalar(name="f32" | "f64"):
            return "a number"
        case Scalar(name=name):
            return f"a whole number of type `{name}`"
        case Enum(literals=literals):
            return "one of " + ", ".join(f"`{literal}`" for literal in literals)
        case Struct(fields=fields):
            return "a record `{ " + ", ".join(f"{name}: ..." for name, _ in fields[:2]) + " }`"
        case Array(length=length):
            return f"a list of {length} values `[ ... ]`"
