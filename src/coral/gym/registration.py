"""Registers a Gymnasium environment for each reef and task of the package; imports nothing heavy."""

from __future__ import annotations

import gymnasium

from coral.contact.scene.task_names import every_task

REEFS = ("l1", "l2", "s1", "s2", "k1", "k2", "e1", "e2", "o1", "o2")


def register_environments() -> None:
    """Register the environments that are not registered yet."""
    for name in REEFS:
        _register(f"coral/reef-{name}-v0", "coral.gym.reef_env:ReefEnv", {"world": name})
    for name in every_task():
        _register(f"coral/{name}-v0", "coral.gym.contact_env:ContactEnv", {"task": name})


def _register(name: str, entry_point: str, kwargs: dict[str, str]) -> None:
    if name not in gymnasium.registry:
        gymnasium.register(name, entry_point=entry_point, kwargs=kwargs)
