"""Test set of the memory's retrieval: changed tasks, each with the remembered plan that should be found for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from pydantic import ValidationError

from coral.config import read_yaml
from coral.contact.scene.task import Task
from coral.contact.scene.task_file import load_task_file
from coral.contact.scene.task_validation import check_task
from coral.errors import InputError
from coral.validation_errors import input_error

SHIPPED_CASES = Path(__file__).parent / "retrieval_cases.yaml"
Half = Literal["development", "test"]
NOTHING = "none"
"""Stands for no plan at all in `RetrievalCase.fits`."""
REMEMBERED = (
    "push-pick-board",
    "pick-box",
    "pick-clutter",
    "push-force",
    "flip-box",
    "flip-wall",
    "close-lid",
    "insert-peg",
    "open-drawer",
    "push-gently",
    "stack-blocks",
)
"""The tasks in the memory: the six of the paper, and five of the unseen suite's development half. They stay as
they are: the cases were written and measured with these."""


@dataclass(frozen=True)
class RetrievalCase:
    """A task for which a remembered plan is looked up."""

    half: Half
    """`development` for building the retrieval, `test` for measuring it."""
    change: str
    """What differs from the remembered task: words, size, height, extra, several, other."""
    origin: str
    """Name of the task that was changed."""
    task: Task
    """The changed task."""
    fits: tuple[str, ...]
    """Names of the tasks whose plan would do; `none` for no plan."""


def load_retrieval_cases(half: str, path: Path = SHIPPED_CASES) -> list[RetrievalCase]:
    """Load one half of the test set.

    Args:
        half: `development` or `test`.
        path: The file of cases.

    Raises:
        InputError: There is no such half, or a case is invalid.
    """
    if half not in get_args(Half):
        raise InputError("--half", "", half, f"one of {', '.join(get_args(Half))}")
    cases: Sequence[Mapping[str, Any]] = read_yaml(path)["cases"]
    return [_case(case, f"{path}: cases[{k}]") for k, case in enumerate(cases) if case["half"] == half]


def _case(case: Mapping[str, Any], where: str) -> RetrievalCase:
    fits = case.get("fits", case["task"])
    return RetrievalCase(
        case["half"],
        case["change"],
        case["task"],
        change_task(load_task_file(case["task"]), case, where),
        (fits,) if isinstance(fits, str) else tuple(fits),
    )


def change_task(task: Task, change: Mapping[str, Any], where: str) -> Task:
    """Return a task with some things changed.

    Args:
        task: The task.
        change: `rename` (objects), `drop` (kinds of conditions), `add` (objects, fixtures, conditions), `set` (values
            by their path; an item of a list by its name or kind, or its index), `say` (the instruction); applied in
            this order.
        where: Origin of the change, for errors.

    Raises:
        InputError: A path leads nowhere, or the changed task is invalid.
    """
    content = deepcopy(task.model_dump(mode="json"))
    for old, new in change.get("rename", {}).items():
        for item in [*content["objects"], *content["success"]["conditions"]]:
            for key in ("name", "object"):
                if item.get(key) == old:
                    item[key] = new
        for item in content["objects"]:
            if item["name"] == new:
                item["label"] = new
    conditions = content["success"]["conditions"]
    for kind in change.get("drop", ()):
        conditions.remove(next(one for one in conditions if one["kind"] == kind))
    added = change.get("add", {})
    for kind in ("objects", "fixtures"):
        content[kind] = [*content[kind], *added.get(kind, ())]
    conditions += added.get("conditions", ())
    for path, value in change.get("set", {}).items():
        _set(content, path, value, where)
    content["instruction"] = change.get("say", content["instruction"])
    try:
        changed = Task.model_validate(content)
    except ValidationError as error:
        raise input_error(where, error, Task) from None
    check_task(changed, where)
    return changed


def _set(content: Any, path: str, value: Any, where: str) -> None:
    *way, last = path.split(".")
    at = content
    for step in way:
        at = at[_key(at, step, where, path)]
    at[_key(at, last, where, path)] = value


def _key(at: Any, step: str, where: str, path: str) -> Any:
    """Return the key or index of a step; the items of a list have a name, a kind or an index."""
    if isinstance(at, dict):
        if step not in at:
            raise InputError(where, f"set.{path}", step, f"one of {', '.join(at)}")
        return step
    found = [k for k, item in enumerate(at) if isinstance(item, dict) and step in (item.get("name"), item.get("kind"))]
    found += [int(step)] if step.isdigit() and int(step) < len(at) else []
    if not found:
        raise InputError(where, f"set.{path}", step, "the name, kind or index of an item")
    return found[0]
