"""Resolved missions as text, for `--emit model`: one line a fact, objectives as a tree."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mauve.model.missions import (
    Activity,
    Block,
    Continue,
    Elementary,
    Mission,
    MissionPart,
    Parallel,
    Recover,
    Ref,
    Retry,
    Step,
)
from mauve.units import format_time


def format_missions(part: MissionPart) -> Iterator[str]:
    """Resources, activities, then missions."""
    for device in part.hardware:
        words = (" may fail" if device.may_fail else "") + (" may recover" if device.may_recover else "")
        yield f"hardware {device.name}{words}"
    for each in part.software:
        type_ = f": {each.type}" if each.type is not None else ""
        yield f"resource {each.name}{type_} {'shared' if each.shared else 'exclusive'}{' sink' if each.sink else ''}"
    for activity in part.activities:
        yield from _activity(activity)
    for mission in part.missions:
        yield from _mission(mission)


def _activity(activity: Activity) -> Iterator[str]:
    runs = f" runs {activity.runs.name}" if activity.runs else ""
    yield f"activity {activity.name}{runs}{' upgrades' if activity.upgrade else ''}"
    for one in activity.alternatives:
        words = [f"  alternative {one.name}" if one.name else "  always"]
        words += [f"consumes {_names(one.consumes)}"] if one.consumes else []
        words += [f"produces {_names(one.produces)}"] if one.produces else []
        words += [f"mode {one.mode.name}"] if one.mode else []
        words += [f"state {'.'.join((*one.mode.region, one.mode.state))}"] if one.mode and one.mode.state else []
        yield " ".join(words)


def _names(refs: Sequence[Ref]) -> str:
    return ", ".join(ref.name for ref in refs)


def _mission(mission: Mission) -> Iterator[str]:
    yield f"mission {mission.name}"
    yield from _block(mission.root, "  ")
    for claim in mission.claims:
        lost = f" with {claim.lost} lost of {', '.join(claim.among) or 'all'}" if claim.lost is not None else ""
        yield f"  check {claim.kind.value}{lost}"
    for ltl in mission.formulas:
        yield f"  {' '.join(ltl.span.text.split())}"
    if mission.accepts:
        yield f"  accepts single failure of {_names(mission.accepts)}"


def _block(block: Block, indent: str) -> Iterator[str]:
    match block:
        case Elementary(name, activities, timeout):
            limit = f" timeout {format_time(timeout)}" if timeout is not None else ""
            yield f"{indent}{name} does {_names(activities)}{limit}"
        case Parallel(name, children):
            yield f"{indent}parallel {name}"
            for child in children:
                yield f"{indent}  {'mandatory' if child.mandatory else 'optional'}"
                yield from _step(child.step, indent + "    ")
        case _:
            yield f"{indent}block {block.name}"
            for step in block.steps:
                yield from _step(step, indent + "  ")


def _step(step: Step, indent: str) -> Iterator[str]:
    yield from _block(step.block, indent)
    match step.on_failure:
        case Continue():
            yield f"{indent}on failure continue"
        case Retry(times):
            yield f"{indent}on failure retry {times}"
        case Recover(block, resume):
            yield f"{indent}on failure recover, then {'continue' if resume else 'abort'}"
            yield from _block(block, indent + "  ")
        case _:
            pass
