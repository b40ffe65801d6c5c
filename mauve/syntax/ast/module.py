"""One file as written, and the declarations it may hold."""

from __future__ import annotations

from mauve.records import record
from mauve.source import SourceFile, Span
from mauve.syntax.ast.architecture import ArchitectureDecl
from mauve.syntax.ast.behaviour import LifecycleDecl
from mauve.syntax.ast.boards import BoardDecl
from mauve.syntax.ast.components import ComponentDecl
from mauve.syntax.ast.deployments import BinaryDecl, DeploymentDecl
from mauve.syntax.ast.missions import MissionPart
from mauve.syntax.ast.names import Name, Path
from mauve.syntax.ast.types import EnumDecl, StructDecl

Declaration = StructDecl | EnumDecl | ComponentDecl | LifecycleDecl | ArchitectureDecl | BoardDecl | DeploymentDecl


@record
class Import:
    """`import std.lifecycle`, optionally `as life`."""

    path: Path
    alias: Name | None
    span: Span


@record
class Module:
    """One file. `version` is the language version of its first line, None when that line is missing.

    The declarations of missions stand apart: their names are a space of their own. `binaries` are those outside of
    deployments: flow facts of an executable, wherever it is deployed.
    """

    file: SourceFile
    version: int | None
    package: Path | None
    imports: tuple[Import, ...]
    declarations: tuple[Declaration, ...]
    doc: str = ""
    missions: tuple[MissionPart, ...] = ()
    binaries: tuple[BinaryDecl, ...] = ()
