"""Plans of missions as text of the language."""

from __future__ import annotations

from mauve.mission.plan import (
    Abort,
    Activity,
    Block,
    Continue,
    Elementary,
    Mission,
    OnFailure,
    OnRecovery,
    Parallel,
    Recover,
    Retry,
    Sequence,
    Step,
)


def text_of(mission: Mission) -> str:
    """A file with the mission; each block and each objective is a declaration of its own."""
    lines = ["mauve 1"]
    for device in mission.hardware:
        may = [word for word, so in (("may fail", device.may_fail), ("may recover", device.may_recover)) if so]
        lines.append(f"hardware {device.name}: device {', '.join(may)}")
    for resource in mission.software:
        lines.append(f"resource {resource.name}{' shared' if resource.shared else ''}")
    for activity in mission.activities:
        lines += _activity(activity)
    objectives: dict[str, str] = {}
    steps = _steps(mission.root, objectives)
    lines += [f"objective {name} {{ {body} }}" for name, body in objectives.items()]
    return "\n".join([*lines, f"mission {mission.name} {{ {steps} }}"]) + "\n"


def _activity(activity: Activity) -> list[str]:
    ways = [
        f"  alternative {one.name} priority {-number} {{ {_clauses('consumes', one.consumes)}"
        f"{_clauses('produces', one.produces)}}}"
        for number, one in enumerate(activity.alternatives)
    ]
    upgrade = ["  on recovery upgrade"] if activity.on_recovery is OnRecovery.UPGRADE else []
    return [f"activity {activity.name} {{", *ways, *upgrade, "}"]


def _clauses(word: str, names: tuple[str, ...]) -> str:
    return f"{word} {', '.join(names)} " if names else ""


def _steps(block: Sequence, objectives: dict[str, str]) -> str:
    return " ; ".join(_step(step, objectives) for step in block.steps)


def _step(step: Step, objectives: dict[str, str]) -> str:
    return _block(step.block, objectives) + _on_failure(step.on_failure, objectives)


def _block(block: Block, objectives: dict[str, str]) -> str:
    match block:
        case Elementary(name, activities, timeout):
            limit = f" timeout {timeout}ps -> failure" if timeout is not None else ""
            objectives[name] = f"does {', '.join(activities)}{limit}"
            return name
        case Parallel(name, children):
            words = ((("optional", "mandatory")[child.mandatory], _step(child.step, objectives)) for child in children)
            return f"parallel {name} {{ {' '.join(f'{word} {step}' for word, step in words)} }}"
        case _:
            objectives[block.name] = _steps(block, objectives)
            return block.name


def _on_failure(reaction: OnFailure, objectives: dict[str, str]) -> str:
    match reaction:
        case Abort():
            return ""
        case Continue():
            return " on failure continue"
        case Retry(times):
            return f" on failure retry {times}"
        case Recover(block, resume):
            return f" on failure recover {{ {_steps(block, objectives)} }} {'continue' if resume else 'abort'}"
