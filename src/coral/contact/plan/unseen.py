"""What waits for an object that was never seen: the costs, conditions and guides that read it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from coral.contact.cost.context import Context, Cost, ReadingCost, Schema, Terms
from coral.contact.cost_program.state import objects_of

KNOWN = ("_seen", "_size", "_mass", "_friction")
"""Ends of the quantities of an object that are known or believed before it is seen."""


def objects_read(program: Cost, schema: Schema) -> tuple[str, ...]:
    """Return the objects whose state a program reads; one that does not declare what it reads waits for nothing."""
    reads = program.reads if isinstance(program, ReadingCost) else []
    state = [name for name in reads if not name.endswith(KNOWN)]
    return tuple(thing for thing in objects_of(schema) if any(f"_{thing}_" in f"_{name}_" for name in state))


def unseen_of(state: Context, objects: Sequence[str]) -> list[str]:
    """Return which of these objects have not been seen yet: the state has a `NAME_guessed` for them, beyond its schema.

    Objects lost on the way are none: a hand that hides what it reaches for would turn back.
    """
    return [name for name in objects if f"{name}_guessed" in state]


def waiting_cost(cost: Callable[[Context], Terms], objects: Sequence[str]) -> Callable[[Context], Terms]:
    """Return a cost that keeps the hand where its stage began while an object that it reads was never seen."""
    if not objects:
        return cost

    def evaluate(state: Context) -> Terms:
        missing = unseen_of(state, objects)
        if not missing:
            return cost(state)
        off = np.linalg.norm(state.ee_pos - state.ee_stage_pos, axis=-1)
        return {f"wait for {', '.join(missing)}": 20.0 * off + 2.0 * np.linalg.norm(state.ee_vel, axis=-1)}

    return evaluate
