"""`coral contact tasks`: list the tasks, or describe one with its ranges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from coral.contact.scene.instruction_check import unmatched_words
from coral.contact.scene.task import Task
from coral.contact.scene.task_file import shipped_tasks
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.flags import Argument

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
        """Load and check the tasks."""
        tasks = {name: load_task(name) for name in self.tasks or shipped_tasks()}
        for name, task in tasks.items():
            for seed in range(DRAWN):
                sample_trial(task, seed, name)
        return {"tasks": [described(task) for task in tasks.values()]}

    def describe(self, result: Mapping[str, Any]) -> str:
        """Return a list, or each task in full."""
        if not self.tasks:
            width = max((len(task["name"]) for task in result["tasks"]), default=0)
            return "\n".join(f"{task['name']:<{width}}  {task['instruction']}" for task in result["tasks"])
        return "\n\n".join(_full_text(task) for task in result["tasks"])


def described(task: Task) -> dict[str, Any]:
    """Return a task as plain values, ranges as [low, high]."""
    return {
        "name": task.name,
        "title": task.title,
        "instruction": task.instruction,
        "time_limit_s": task.time_limit_s,
        "objects": [
            {
                "name": item.name,
                "label": item.label,
                "parts": [part.shape for part in item.parts],
                "mass_kg": list(item.mass_kg),
                "friction": list(item.friction),
                "scale": [list(axis) for axis in item.scale],
                "x_m": list(item.x),
                "y_m": list(item.y),
                "yaw_deg": list(item.yaw_deg),
                "points": sorted(item.points),
            }
            for item in task.objects
        ],
        "fixtures": [item.name for item in task.fixtures],
        "places": {name: list(p) for name, p in task.places.items()},
        "numbers": dict(task.numbers),
        "marks": [mark.place for mark in task.marks],
        "unmatched_words": unmatched_words(task),
        "hold_s": task.success.hold_s,
        "success": [condition.model_dump(mode="json", exclude_none=True) for condition in task.success.conditions],
    }


def _full_text(task: Mapping[str, Any]) -> str:
    lines = [f"{task['name']}: {task['title']}", f"  {task['instruction']}", f"  at most {task['time_limit_s']:g} s"]
    for item in task["objects"]:
        label = f" ({item['label']})" if item["label"] else ""
        lines.append(f"  {item['name']}{label}: {' + '.join(item['parts'])}")
        for key, name, unit in (
            ("mass_kg", "mass", " kg"),
            ("friction", "friction", ""),
            ("x_m", "x", " m"),
            ("y_m", "y", " m"),
            ("yaw_deg", "heading", "°"),
        ):
            lines.append(f"    {name:<10}{_range(item[key])}{unit}")
        if item["scale"] != [[1.0, 1.0]] * 3:
            lines.append(f"    {'scale':<10}{', '.join(map(_range, item['scale']))} (x, y, z)")
        if item["points"]:
            lines.append(f"    {'points':<10}{', '.join(item['points'])}")
    for key in ("places", "numbers"):
        lines += [f"  {name} = {value}" for name, value in task[key].items()]
    if task["fixtures"]:
        lines.append(f"  fixtures: {', '.join(task['fixtures'])}")
    lines.append(f"  done when all hold for {task['hold_s']:g} s:")
    for condition in task["success"]:
        details = ", ".join(f"{key} {value}" for key, value in condition.items() if key not in ("kind", "object"))
        lines.append(f"    {condition['object']} {condition['kind']}{f' ({details})' if details else ''}")
    lines += [f"  instruction: {word}" for word in task["unmatched_words"]]
    return "\n".join(lines)


def _range(ends: list[float]) -> str:
    low, high = ends
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"
