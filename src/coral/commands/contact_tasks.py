"""`coral contact tasks`: list the tasks, or describe one with its ranges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from coral.contact.scene.instruction_check import unmatched_words
from coral.contact.scene.task import Task
from coral.contact.scene.task_names import shipped_tasks
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.flags import Argument
from coral.yaml_file import to_yaml

DRAWN = 5
"""Number of sampled trials that check whether all objects find a place."""


@dataclass(frozen=True, kw_only=True)
class ContactTasks:
    """List the shipped contact tasks, or check and describe the given task files."""

    tasks: Annotated[tuple[str, ...], Argument(metavar="[TASK ...]", names=shipped_tasks)] = ()
    """Names or task files; by default all shipped tasks are listed."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        tasks = {name: load_task(name) for name in self.tasks or shipped_tasks()}
        for name, task in tasks.items():
            for seed in range(DRAWN):
                sample_trial(task, seed, name)
        return {"tasks": [described(task) for task in tasks.values()]}

    def describe(self, result: Mapping[str, Any]) -> str:
        if not self.tasks:
            width = max((len(task["name"]) for task in result["tasks"]), default=0)
            return "\n".join(f"{task['name']:<{width}}  {task['instruction']}" for task in result["tasks"])
        return "\n---\n".join(_full_text(task) for task in result["tasks"])


def described(task: Task) -> dict[str, Any]:
    """Return what the file of a task would hold, and words of its instruction that nothing in it matches."""
    written: dict[str, Any] = task.model_dump(mode="json", exclude_unset=True)
    return {**written, "unmatched_words": unmatched_words(task)}


def _full_text(task: Mapping[str, Any]) -> str:
    written = {key: value for key, value in task.items() if key != "unmatched_words"}
    lines = [to_yaml(written, default_flow_style=None, width=120).rstrip()]
    return "\n".join([*lines, *(f"# instruction: {word}" for word in task["unmatched_words"])])
