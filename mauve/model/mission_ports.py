"""Whether the component that an activity runs can carry its resources: ports of their types (MV716)."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.missions import Activity, MissionPart, Ref
from mauve.model.model import Component, PortKind


def check_ports(activity: Activity, part: MissionPart, report: Report) -> None:
    """An out port for each resource produced, an in port for each one consumed; turned around for a sink."""
    component = activity.runs.component if activity.runs else None
    if component is None or (not component.ports and not component.codels):
        return
    software = {each.name: each for each in part.software}
    for refs, produced in (
        ([ref for one in activity.alternatives for ref in one.produces], True),
        ([ref for one in activity.alternatives for ref in one.consumes], False),
    ):
        for ref in {ref.name: ref for ref in reversed(refs)}.values():
            resource = software.get(ref.name)
            if resource is None or resource.type is None:
                continue
            outward = produced != resource.sink
            kinds = (PortKind.OUT,) if outward else (PortKind.IN, PortKind.EVENT)
            if not any(port.kind in kinds and port.type == resource.type for port in component.ports):
                report.add(_lacking(activity, component, ref, str(resource.type), outward, produced))


def _lacking(
    activity: Activity, component: Component, ref: Ref, type_: str, outward: bool, produced: bool
) -> Diagnostic:
    kind = "out" if outward else "in"
    verb = "produces" if produced else "consumes"
    message = f"`{activity.name}` {verb} `{ref.name}`, but `{component.name}` has no {kind} port of type `{type_}`"
    ports = [port for port in component.ports if (port.kind is PortKind.OUT) == outward]
    labels = [Label(port.type_span, f"its {kind} port `{port.name}` has the type `{port.type}`") for port in ports[:3]]
    labels.append(Label(component.span, "the component"))
    help_ = Fix(f"give `{component.name}` the port, or the resource another type")
    return Diagnostic("MV716", message, Label(ref.span), labels=tuple(labels), help=help_)
