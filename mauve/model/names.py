"""Which declarations a module sees: its own, those of its imports, and both under their packages' names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label, Report
from mauve.diagnostics.suggest import closest
from mauve.records import record
from mauve.source import Span
from mauve.syntax import ast


@record
class Scope:
    """The names of one module. `own` are its declarations, `imported` those of each import by simple name,
    `qualified` all of them behind the package's name or the import's alias."""

    package: str
    own: Mapping[str, ast.Declaration]
    imported: Mapping[str, tuple[ast.Declaration, ...]]
    qualified: Mapping[str, ast.Declaration]
    imports: int

    def find(self, path: ast.Path, kinds: tuple[type[ast.Declaration], ...]) -> ast.Declaration | None:
        """The declaration of one of the kinds that `path` names; an own one hides an imported one."""
        text = str(path)
        candidates = [self.own.get(text), *self.imported.get(text, ()), self.qualified.get(text)]
        return next((found for found in candidates if isinstance(found, kinds)), None)

    def of_kind(self, kinds: tuple[type[ast.Declaration], ...]) -> dict[str, ast.Declaration]:
        """Every visible declaration of the kinds by its shortest name."""
        found = {name: d for name, ds in self.imported.items() for d in ds[:1] if isinstance(d, kinds)}
        found |= {name: d for name, d in self.own.items() if isinstance(d, kinds)}
        return found

    def where(self) -> str:
        """In words, where a name was looked for."""
        package = f"package `{self.package}`" if self.package else "this file"
        if self.imports == 0:
            return f"not found in {package}, which imports nothing"
        return f"not found in {package} nor in its {self.imports} import{'s' if self.imports > 1 else ''}"


class _Tables:
    def __init__(self) -> None:
        self.own: dict[str, ast.Declaration] = {}
        self.imported: dict[str, tuple[ast.Declaration, ...]] = {}
        self.qualified: dict[str, ast.Declaration] = {}


def module_scope(module: ast.Module, modules: Iterable[ast.Module], report: Report) -> Scope:
    """The scope of `module` among all loaded ones; a name declared twice in it is MV103."""
    package = str(module.package) if module.package else ""
    tables = _Tables()
    for declaration in module.declarations:
        name = declaration.name
        if name.text in tables.own:
            report.add(duplicate("declaration", name, tables.own[name.text].name.span))
            continue
        tables.own[name.text] = declaration
        if package:
            tables.qualified[f"{package}.{name.text}"] = declaration
    by_package = {package_of(other): other for other in modules if other is not module}
    for import_ in module.imports:
        other = by_package.get(str(import_.path))
        if other is None:
            continue
        prefix = import_.alias.text if import_.alias else str(import_.path)
        for declaration in other.declarations:
            name_text = declaration.name.text
            seen = tables.imported.get(name_text, ())
            if declaration not in seen:
                tables.imported[name_text] = (*seen, declaration)
            tables.qualified[f"{prefix}.{name_text}"] = declaration
    return Scope(package, tables.own, tables.imported, tables.qualified, len(module.imports))


def package_of(module: ast.Module) -> str:
    """The dotted name under which other modules import this one: its package, else its file's name."""
    if module.package is not None:
        return str(module.package)
    return module.file.name.replace("\\", "/").rsplit("/", 1)[-1].removesuffix(".mauve")


def duplicate(what: str, name: ast.Name, first: Span) -> Diagnostic:
    """MV103: a second declaration of a name."""
    return Diagnostic(
        "MV103",
        f"there are two {what}s named `{name.text}`",
        Label(name.span, "declared again here"),
        labels=(Label(first, "first declared here"),),
        help=Fix("rename one of them"),
    )


def unknown(
    code: str,
    message: str,
    label: str,
    span: Span,
    candidates: Mapping[str, Span] | Iterable[str],
    what: str,
) -> Diagnostic:
    """A diagnostic for a name that is not known, with the declaration of the nearest known one, and a fix that
    writes it.

    `what` names the kind of thing with its article, as in "a port".
    """
    known = candidates if isinstance(candidates, Mapping) else dict.fromkeys(candidates)
    near = closest(span.text.rsplit(".", 1)[-1], known)
    labels: tuple[Label, ...] = ()
    help_: Fix | None = None
    if near:
        at = known[near[0]]
        if at is not None:
            labels = (Label(at, f"{what} with a similar name is declared here"),)
        dot = span.text.rfind(".") + 1
        edit = Edit(Span(span.file, span.start + dot, span.end), near[0])
        help_ = Fix(f"there is {what} with a similar name: `{near[0]}`", (edit,), Applicability.MAYBE)
    return Diagnostic(code, message, Label(span, label), labels=labels, help=help_)
