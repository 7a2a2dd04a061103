from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from coral.contact.scene.observation import HandTarget, Observation
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.panda.world import PandaWorld

SCENE = """
format: coral-contact/1
name: bench
title: Bench
instruction: Press the block and hold the box.
time_limit_s: 10
table: {size: [0.7, 0.6, 0.05]}
fixtures:
  - {name: block, size: [0.1, 0.1, 0.1], position: [0.1, -0.1, 0.05]}
objects:
  - {name: box, parts: [{size: [0.05, 0.04, 0.06]}], mass_kg: 0.3, friction: 0.5, x: -0.1, y: 0.1}
success: {conditions: [{kind: lifted, object: box, height_m: 0.1}]}
"""
DOWN = np.array([0.0, 1.0, 0.0, 0.0])
Go = Callable[..., Observation]


@pytest.fixture(scope="session")
def panda(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PandaWorld]:
    path: Path = tmp_path_factory.mktemp("scene") / "bench.yaml"
    path.write_text(SCENE)
    world = PandaWorld(sample_trial(load_task(path), 0))
    yield world
    world.close()


@pytest.fixture
def world(panda: PandaWorld) -> PandaWorld:
    panda.reset()
    return panda


@pytest.fixture
def go(world: PandaWorld) -> Go:
    def move(
        position,
        steps,
        *,
        quaternion=DOWN,
        opening=0.08,
        stiffness=600.0,
        force=(0.0, 0.0, 0.0),
    ):
        target = HandTarget(np.array(position), quaternion, opening, stiffness, np.array(force))
        for _ in range(steps):
            observed = world.step(target)
        return observed

    return move
