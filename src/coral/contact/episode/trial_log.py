"""Record of a trial, the same for planner and policy: task, configuration, start and end reason."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from coral.contact.episode.recorder import numbers
from coral.contact.scene.judge import Judge
from coral.contact.scene.observation import Truth
from coral.contact.scene.trial import PhysicalParameters, Trial
from coral.run_files import RunFiles, TaskFiles
from coral.runs import RunWriter, provenance


def write_head(writer: RunWriter, trial: Trial, about: dict[str, Any], cfg: dict[str, Any]) -> None:
    """Write task.yaml and config.yaml; `about` are world, advisor, variant and what else identifies the run."""
    writer.yaml(TaskFiles.TASK, trial.task.model_dump(mode="json"))
    head = {"system": "contact", "task": trial.task.name, **about}
    writer.yaml(RunFiles.CONFIG, {**head, "episode": cfg, "provenance": provenance()})


def start_fields(trial: Trial, **about: Any) -> dict[str, Any]:
    """Return the fields of the event `start`: task, variant, advisor, and the true parameters for the record."""
    task = trial.task
    return {
        "task": task.name,
        "instruction": task.instruction,
        **about,
        "time_limit_s": task.time_limit_s,
        "trial": {
            name: {**parameter_fields(item.physical), "size_m": numbers(trial.size(name), 4)}
            for name, item in trial.objects.items()
        },
    }


def parameter_fields(physical: PhysicalParameters) -> dict[str, float]:
    """Return mass and friction in the form of events."""
    return {"mass_kg": round(physical.mass_kg, 5), "friction": round(physical.friction, 4)}


def end_reason(judge: Judge, truth: Truth, time_left: bool) -> str:
    """Return why the episode ends after a control step; "" while it continues. Call it at every control step."""
    done, lost = judge.success(truth), judge.failure(truth)
    if lost is not None:
        return lost
    if done:
        return "success"
    for condition in judge.broken:
        return f"broken: {condition.kind} of {condition.object}"
    return "" if time_left else "timeout"


def conditions_not_held(trial: Trial, holding: Sequence[bool], truth: Truth) -> str:
    """Return which of the task's conditions do not hold, and by how much; "" if they hold or were not checked."""
    conditions = trial.task.success.conditions[: len(holding)]
    names = []
    for one, holds in zip(conditions, holding, strict=True):
        target = next((found for key in ("place", "thing", "other") if (found := getattr(one, key, None))), "")
        words = (one.object, one.kind.replace("-", " "), "on" * (one.kind == "resting"), target)
        if not holds:
            names.append(": ".join(filter(None, (" ".join(filter(None, words)), one.found(trial, truth)))))
    return f"not held: {'; '.join(names)}" if names else ""
