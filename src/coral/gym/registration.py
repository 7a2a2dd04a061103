"""Registers a Gymnasium environment for each reef and task of the package; imports nothing heavy."""

from __future__ import annotations

import gymnasium

from coral.contact.scene.task_names import every_task
from coral.reef.world.world_names import shipped_worlds


def register_environments() -> None:
    """Register the environments that are not registered yet."""
    reefs = {f"reef-{name}": ("reef_env:ReefEnv", {"world": name}) for name in shipped_worlds()}
    tasks = {name: ("contact_env:ContactEnv", {"task": name}) for name in every_task()}
    for name, (place, kwargs) in {**reefs, **tasks}.items():
        if f"coral/{name}-v0" not in gymnasium.registry:
            gymnasium.register(f"coral/{name}-v0", entry_point=f"coral.gym.{place}", kwargs=kwargs)
