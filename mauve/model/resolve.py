"""Name resolution and typing: modules -> Model. The composition of this folder."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Diagnostic, Label, Report, Severity
from mauve.model.architecture import Context, resolve_architecture
from mauve.model.boards import resolve_board
from mauve.model.components import resolve_component
from mauve.model.deployments import Platform, resolve_deployment
from mauve.model.facts import module_facts
from mauve.model.model import Architecture, Board, Component, Model
from mauve.model.names import Scope, module_scope
from mauve.model.typing import TypeTable
from mauve.records import changed
from mauve.syntax import ast


def resolve(modules: tuple[ast.Module, ...], standard_boards: tuple[ast.Module, ...], report: Report) -> Model:
    """The model of the first module and what it imports; problems go to the report, what is sound is kept.

    `standard_boards` are the modules whose boards a node may name by a string.
    """
    every = (*modules, *(m for m in standard_boards if m not in modules))
    scopes = {id(module): module_scope(module, every, report) for module in every}
    scope_of = {id(d): scopes[id(module)] for module in every for d in module.declarations}
    tables = {key: TypeTable(scope, scope_of, report) for key, scope in scopes.items()}
    components: dict[int, Component] = {}
    for module in modules:
        for declaration in _first_of_each(module):
            types, scope = tables[id(module)], scopes[id(module)]
            if isinstance(declaration, (ast.StructDecl, ast.EnumDecl)):
                types.declaration(declaration)
            elif isinstance(declaration, ast.ComponentDecl):
                components[id(declaration)] = resolve_component(declaration, scope, types, report)
    boards = _boards(every, report)
    standard = {
        d.name.text: board
        for module in standard_boards
        for d in module.declarations
        if isinstance(d, ast.BoardDecl) and (board := boards.get(id(d))) is not None
    }
    architectures: dict[int, Architecture] = {}
    for module in modules:
        context = Context(scopes[id(module)], tables[id(module)], components)
        for declaration in _first_of_each(module):
            if isinstance(declaration, ast.ArchitectureDecl):
                architectures[id(declaration)] = resolve_architecture(declaration, context, report)
    deployments = []
    facts = tuple(f for module in modules for f in module_facts(module, _directory(module), report))
    for module in modules:
        platform = Platform(scopes[id(module)], architectures, boards, standard, _directory(module), facts)
        for declaration in _first_of_each(module):
            if isinstance(declaration, ast.DeploymentDecl):
                deployment = resolve_deployment(declaration, platform, report)
                if deployment is not None:
                    deployments.append(deployment)
    own_boards = tuple(b for m in modules for d in m.declarations if (b := boards.get(id(d))) is not None)
    if architectures and not any(not deployment.abstract for deployment in deployments):
        _nothing_to_check(modules, scopes, report)
    model = Model(tuple(components.values()), tuple(architectures.values()), own_boards, tuple(deployments))
    if not any(module.missions for module in modules):
        return model
    from mauve.model.mission_activities import Home
    from mauve.model.mission_resolve import resolve_missions

    tied = bool(model.components or model.architectures)
    homes = {key: Home(scopes[key], tables[key], components, model.architectures, tied) for key in scopes}
    return changed(model, missions=resolve_missions(modules, lambda module: homes[id(module)], report))


def _first_of_each(module: ast.Module) -> list[ast.Declaration]:
    """The declarations without those whose name an earlier one took (MV103 was reported)."""
    seen: set[str] = set()
    kept = []
    for declaration in module.declarations:
        if declaration.name.text not in seen:
            seen.add(declaration.name.text)
            kept.append(declaration)
    return kept


def _boards(modules: tuple[ast.Module, ...], report: Report) -> dict[int, Board | None]:
    return {
        id(d): resolve_board(d, report)
        for module in modules
        for d in module.declarations
        if isinstance(d, ast.BoardDecl)
    }


def _directory(module: ast.Module) -> str:
    """The directory of the module's file as the user named it; empty for the current one."""
    head, slash, _ = module.file.name.replace("\\", "/").rpartition("/")
    return head + slash


def _nothing_to_check(modules: tuple[ast.Module, ...], scopes: dict[int, Scope], report: Report) -> None:
    if any(isinstance(d, ast.DeploymentDecl) and not d.abstract for module in modules for d in module.declarations):
        return  # it is there and in error
    for module in modules:
        for declaration in module.declarations:
            if isinstance(declaration, ast.ArchitectureDecl):
                message = f"no deployment says where `{declaration.name}` runs, so there is no deadline to check"
                report.add(Diagnostic("MV406", message, Label(declaration.name.span), Severity.WARNING))
                return
