"""Questions for a plan of each task of the unseen suite: what a reader outside answers, and an episode scores."""

from __future__ import annotations

from dataclasses import replace

from coral.contact.scene.task_file import unseen_tasks
from coral.exam.contact_questions import plan_question
from coral.exam.item import ExamItem


def unseen_items(half: str, seed: int) -> list[ExamItem]:
    """Make one question for a plan of each task.

    Args:
        half: "development" or "test".
        seed: Of the trials.

    Raises:
        InputError: There is no such half.
    """
    items = [(task, plan_question(task, seed)) for task in unseen_tasks(half)]
    return [
        replace(item, id=f"{item.kind}-{number:03d}", group=f"{task}-{seed}")
        for number, (task, item) in enumerate(items)
    ]
