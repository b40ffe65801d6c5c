"""Files to modules: reading bytes, following imports, finding the standard library.

`import a.b` is the file a/b.mauve below the root: the directory above those that the checked file's package names, as
far as the file lies in such ones (two levels up for `package a.b` in a/b.mauve), else the file's own. `import std.x` is
the standard library.
"""

from __future__ import annotations

import os
from pathlib import Path

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label, Report
from mauve.diagnostics.suggest import closest
from mauve.records import record
from mauve.source import SourceFile, Span
from mauve.syntax import ast
from mauve.syntax.parse import parse
from mauve.syntax.table import package_text

LARGEST = 4 << 20
"""A longer file, in bytes, is refused: no model written by a person comes near."""

MOST_CANDIDATES = 1000
"""How many files of the root are looked at for a name near to a missing import."""


def read_source(path: Path, report: Report, imported: Span | None = None) -> SourceFile | None:
    """The text of a file; None after reporting why it cannot be read (MV002, MV008).

    `imported` is where the model names the file.
    """
    name = str(path)
    primary = Label(imported, "imported here") if imported else None
    try:
        if path.is_dir():
            report.add(_unreadable(f"cannot read `{name}`: it is a directory", name, primary))
            return None
        with path.open("rb") as stream:
            data = stream.read(LARGEST + 1)
    except OSError as error:
        reason = "there is no such file" if isinstance(error, FileNotFoundError) else _reason(error)
        report.add(_unreadable(f"cannot read `{name}`: {reason}", name, primary))
        return None
    except ValueError:
        report.add(_unreadable("cannot read a file with a NUL character in its name", name, primary))
        return None
    if len(data) > LARGEST:
        message = f"`{name}` has more than {LARGEST >> 20} MiB, which no model needs"
        report.add(Diagnostic("MV008", message, primary, place=name if primary is None else ""))
        return None
    return _decode(name, data, report)


def _reason(error: OSError) -> str:
    text = error.strerror or str(error)
    return text[:1].lower() + text[1:]


def _unreadable(message: str, name: str, primary: Label | None) -> Diagnostic:
    return Diagnostic("MV002", message, primary, place=name if primary is None else "")


def _decode(name: str, data: bytes, report: Report) -> SourceFile | None:
    """UTF-8 with or without a byte order mark; another encoding is reported at its first wrong byte."""
    data = data.removeprefix(b"\xef\xbb\xbf")
    try:
        return SourceFile(name, data.decode("utf-8"))
    except UnicodeDecodeError as error:
        file = SourceFile(name, data.decode("utf-8", errors="replace"))
        at = len(data[: error.start].decode("utf-8"))
        label = Label(Span(file, at, at + 1), f"the byte 0x{data[error.start]:02x}")
        utf16 = data.startswith((b"\xff\xfe", b"\xfe\xff"))
        help_ = Fix("it looks like UTF-16: save it as UTF-8" if utf16 else "save the file as UTF-8")
        report.add(Diagnostic("MV002", f"`{name}` is not UTF-8 text", label, help=help_))
        return None


def load_modules(path: Path, report: Report) -> tuple[ast.Module, ...]:
    """The module in a file and all it imports, directly or not, each once, the given one first.

    Empty where the file itself cannot be read. A missing import is MV104, a cycle of imports MV105.
    """
    file = read_source(path, report)
    if file is None:
        return ()
    module = parse(file, report)
    loader = _Loader(root_of(path, module), report)
    loader.modules.append(module)
    loader.follow(module)
    return tuple(loader.modules)


def standard_module(name: str, report: Report) -> ast.Module | None:
    """A module of the standard library: `boards` gives std.boards. None where there is none of that name."""
    try:
        text = package_text("mauve", f"std/{name}.mauve")
    except OSError:
        return None
    return parse(SourceFile(f"std/{name}.mauve", text), report)


def standard_names() -> tuple[str, ...]:
    """The modules of the standard library."""
    from importlib.resources import files

    entries = files("mauve").joinpath("std").iterdir()
    return tuple(sorted(e.name.removesuffix(".mauve") for e in entries if e.name.endswith(".mauve")))


def root_of(path: Path, module: ast.Module) -> Path:
    """The directory that imports start from: above the package's directories, where the file lies in such ones."""
    package = [part.text for part in module.package.parts] if module.package else []
    places = path.absolute().with_suffix("").parts
    for levels, parts in ((len(package), places), (len(package) + 1, places[:-1])):
        if package and list(parts[-len(package) :]) == package:
            return _up(path, levels)
    return path.parent


def _up(path: Path, levels: int) -> Path:
    """The directory `levels` names above, as a relative path where the user gave one."""
    above = path.absolute()
    for _ in range(levels):
        above = above.parent
    return above if path.is_absolute() else Path(os.path.relpath(above))


@record
class _Step:
    """An import on the way to a module: the importing module's dotted name and the import."""

    importer: str
    import_: ast.Import


class _Loader:
    """Depth-first over the imports."""

    def __init__(self, root: Path, report: Report) -> None:
        self.root = root
        self.report = report
        self.modules: list[ast.Module] = []
        self.known: dict[str, ast.Module | None] = {}
        self.cycles: set[frozenset[str]] = set()

    def follow(self, first: ast.Module) -> None:
        """Load what a module imports, and so on; an explicit stack, as chains of imports may be long."""
        name = str(first.package) if first.package else Path(first.file.name).stem
        same = {name, Path(first.file.name).stem} if len(name.split(".")) == 1 else {name}
        self.known.update(dict.fromkeys(same, first))
        walk: list[_Step] = []
        active = [name]
        pending = [(name, iter(first.imports))]
        while pending:
            importer, imports = pending[-1]
            import_ = next(imports, None)
            if import_ is None:
                pending.pop()
                active.pop()
                if walk:
                    walk.pop()
                continue
            target = str(import_.path)
            if target in self.known:
                found = self.known[target]
                at = next((i for i, n in enumerate(active) if self.known.get(n) is found and found is not None), None)
                if at is not None:
                    self._cycle([*walk[at:], _Step(importer, import_)])
                continue
            module = self._load(import_)
            self.known[target] = module
            if module is not None:
                self.modules.append(module)
                walk.append(_Step(importer, import_))
                active.append(target)
                pending.append((target, iter(module.imports)))

    def _load(self, import_: ast.Import) -> ast.Module | None:
        parts = [part.text for part in import_.path.parts]
        if parts[0] == "std":
            module = standard_module("/".join(parts[1:]), self.report) if len(parts) > 1 else None
            if module is None:
                self._missing(import_, [f"std.{name}" for name in standard_names()], "the standard library")
            return module
        path = self.root.joinpath(*parts[:-1], parts[-1] + ".mauve")
        if not path.exists():
            self._missing(import_, self._candidates(), f"there is no file `{path}`")
            return None
        file = read_source(path, self.report, import_.path.span)
        if file is None:
            return None
        module = parse(file, self.report)
        self._check_package(import_, module)
        return module

    def _check_package(self, import_: ast.Import, module: ast.Module) -> None:
        """An imported file is known by its package, so that must be the name it is imported by."""
        wanted, found = str(import_.path), str(module.package) if module.package else ""
        if found == wanted or (not found and "." not in wanted) or self.report.has_errors:
            return
        says = f"is the package `{found}`" if found else "names no package"
        labels = (Label(module.package.span, "the package is named here"),) if module.package else ()
        fix = Fix(f"write `package {wanted}` in `{module.file.name}`")
        label = Label(import_.path.span, f"the file {says}")
        message = f"`{module.file.name}` {says}, it is imported as `{wanted}`"
        self.report.add(Diagnostic("MV104", message, label, labels=labels, help=fix))

    def _candidates(self) -> list[str]:
        """Dotted names of the files below the root, as far as they are quickly found."""
        found: list[str] = []
        looked = 0
        for folder, folders, names in os.walk(self.root):
            folders[:] = sorted(f for f in folders if not f.startswith("."))
            below = Path(folder).relative_to(self.root).parts
            if len(below) >= 3:
                folders.clear()
            found += [".".join((*below, n.removesuffix(".mauve"))) for n in sorted(names) if n.endswith(".mauve")]
            looked += len(names) + len(folders) + 1
            if looked > MOST_CANDIDATES:
                break
        return found

    def _missing(self, import_: ast.Import, candidates: list[str], where: str) -> None:
        span = import_.path.span
        fix = None
        near = closest(str(import_.path), candidates)
        if near:
            edit = Edit(span, near[0])
            fix = Fix(f"there is a module `{near[0]}`", (edit,), Applicability.MAYBE)
        standard = str(import_.path).startswith("std")
        if standard and fix is None:
            fix = Fix("the modules of the standard library are " + ", ".join(f"`{name}`" for name in candidates))
        message = f"there is no module `{import_.path}`"
        self.report.add(Diagnostic("MV104", message, Label(span, f"not in {where}" if standard else where), help=fix))

    def _cycle(self, steps: list[_Step]) -> None:
        """Report a cycle once, as a walk along its imports."""
        names = frozenset(str(step.import_.path) for step in steps)
        if names in self.cycles:
            return
        self.cycles.add(names)
        walk = " -> ".join([*(f"`{step.importer}`" for step in steps), f"`{steps[-1].import_.path}`"])
        labels = tuple(
            Label(step.import_.span, f"`{step.importer}` imports `{step.import_.path}` here") for step in steps
        )
        message = f"these modules import each other: {walk}"
        if len(steps) == 1:
            message = f"`{steps[0].importer}` imports itself"
        help_ = Fix("move what both need into a module that imports neither")
        self.report.add(Diagnostic("MV105", message, labels[0], labels=labels[1:], help=help_))
