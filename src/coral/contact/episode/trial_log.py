"""Record of a trial, the same for planner and policy: task, configuration, start and end, for one of a few reasons."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from coral.contact.episode.recorder import numbers
from coral.contact.scene.judge import Judge
from coral.contact.scene.observation import Truth
from coral.contact.scene.trial import PhysicalParameters, Trial
from coral.run_files import RunFiles, TaskFiles
from coral.runs import RunWriter, provenance

END_REASONS = {
    "success": "all of the task's conditions held long enough",
    "timeout": "the task's time limit was reached",
    "dropped": "an object fell off the table",
    "broken": "a condition of success was broken that can never hold again",
    "tunnelling": "an object went through the table or a fixture: the simulation cannot be trusted",
    "diverged": "the evaluation world's simulation diverged",
    "unreachable": "the arm stays away from its commanded pose although it touches nothing",
    "camera-off": "poses come from a camera, and no picture arrived for half a second",
    "tracker-failed": "the server of the tracker does not answer, or gives no poses",
    "not-found": "poses come from a camera, and no object was found within the first second",
    "limit": "the arm was stopped at a limit: joint, speed, workspace, self-collision or contact force",
    "poses-lost": "the arm was stopped because an object was not seen any more",
    "link-lost": "the arm was stopped because no state came from it",
    "watchdog": "the arm was stopped because the program showed no sign of life",
    "arm-fault": "the arm refused to obey",
    "no-strategy": "no answer of the advisor contained a usable plan",
    "no-decision": "the advisor did not decide, and nothing else could or was allowed to",
    "advisor failed": "the advisor did not decide, and the fallback policy ends the run",
    "cost-error": "the cost could not be evaluated, and no repair was left or none helped",
    "no-plan": "25 plans in a row had no usable rollout, or a plan contained a value that is not a number",
    "policy": "a served policy gave no valid actions",
    "operator-failure": "the operator judges, and said that the task had failed",
    "stopped by the operator": "Ctrl-C or the stop button; of another signal its name: `stopped by SIGTERM`",
    "failed": "an error in the program",
    "killed": "the program was killed, or still runs",
}
"""Explanation of each end reason of an episode. A reason may be followed by a colon and what or why."""


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
