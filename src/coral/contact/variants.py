"""Baselines and ablations of the contact pipeline by name (Table 1)."""

from __future__ import annotations

from collections.abc import Callable

from coral.contact.experts import expert
from coral.contact.mind import Fixed, Mind
from coral.contact.task import Task
from coral.errors import InputError, nearest

Make = Callable[[Task], Mind]

VARIANTS: dict[str, Make] = {
    "expert": lambda task: Fixed(expert(task, "expert")),
    "expert-fsm": lambda task: Fixed(expert(task, "expert-fsm")),
}
"""Who decides in each variant."""
ALONE = ("expert", "expert-fsm")
"""Variants that ask no advisor."""


def make_mind(variant: str, task: Task) -> Mind:
    """Who decides in a variant.

    Raises:
        InputError: There is no such variant, or it has nothing for this task.
    """
    check_variant(variant)
    return VARIANTS[variant](task)


def check_variant(variant: str, where: str = "--variant") -> None:
    """See that a variant exists.

    Raises:
        InputError: It does not.
    """
    if variant not in VARIANTS:
        raise InputError(where, "", repr(variant), f"one of {', '.join(VARIANTS)}{nearest(variant, VARIANTS)}")
