"""Hand-written costs for the six tasks, as a single stage and as a state machine (Table 1's expert baselines).

A wing. It needs no other.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from coral.contact.control.quantities import task_schema_of
from coral.contact.cost.context import Context
from coral.contact.cost.stages import Strategy
from coral.contact.experts import board, flip, pick, place, push, wall
from coral.contact.scene.task import Task
from coral.errors import InputError

Kind = Literal["expert", "expert-fsm"]
_EXPERTS = {
    "push-pick-board": board,
    "pick-box": pick,
    "pick-clutter": place,
    "push-force": push,
    "flip-box": flip,
    "flip-wall": wall,
}
"""Costs of the paper's tasks: each module has `single` and `fsm`."""
_MORE_FSM = {"push-gently": push, "push-past-glass": push, "topple-gently": flip, "scoop-box": wall}
"""Tasks of the unseen suite that the same state machines do."""


def expert(task: Task, kind: Kind) -> Strategy:
    """Return the hand-written strategy of a task. Tasks to pick, or to pick and place, share theirs.

    Raises:
        InputError: There is none for this task.
    """
    modules = {**_EXPERTS, **_MORE_FSM} if kind == "expert-fsm" else _EXPERTS
    table: dict[str, Callable[[Task], Strategy]] = {
        name: module.fsm if kind == "expert-fsm" else module.single for name, module in modules.items()
    }
    if task.name not in table and place.places(task):
        return table["pick-clutter"](task)
    if task.name not in table and pick.picks(task):
        return table["pick-box"](task)
    if task.name not in table:
        raise InputError("task", "name", task.name, f"one that an expert has written costs for: {', '.join(table)}")
    try:
        strategy = table[task.name](task)
        _try_out(strategy, task)
    except (AttributeError, KeyError, StopIteration) as error:
        raise InputError(
            "task",
            "name",
            task.name,
            f"also {str(error).strip(chr(39)) or 'what else'} that the costs "
            f"written for it read; or a name of its own, and --variant full",
        ) from None
    return strategy


def _try_out(strategy: Strategy, task: Task) -> None:
    """Evaluate the strategy once: a file with a shipped task's name may lack quantities of the shipped one."""
    anywhere = {
        name: np.ones((1, 1, *([found.size] if found.size else []))) for name, found in task_schema_of(task).items()
    }
    state = Context(anywhere, (1, 1))
    for stage in strategy.stages:
        tests = (stage.until, *(test for _, test in stage.next), *(guide.points for guide in stage.guides))
        for read in (stage.cost, *tests):
            if read is not None:
                read(state)
