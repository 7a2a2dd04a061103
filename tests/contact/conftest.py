"""Lets the tests of the contact half share what they stage trials with."""

import sys
from pathlib import Path

import pytest

from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.plan.sampled_states import sample_states
from coral.contact.scene.task import Task
from coral.contact.scene.trial import sample_trial, stated_beliefs
from coral.contact.tasks import load_task
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.worlds.hand_world import HandWorld

sys.path.insert(0, str(Path(__file__).parent))


class Scene:
    """A trial at its beginning, with a planning world that believes the middle of what the task states."""

    def __init__(self, task, seed=0):
        self.trial = sample_trial(load_task(task) if isinstance(task, str) else task, seed)
        self.real = HandWorld(self.trial)
        self.now = self.real.reset()
        self.beliefs = stated_beliefs(self.trial)
        self.world = PlanningWorld(self.trial, self.beliefs, self.now, PlanningCfg(threads=1))
        self.facts = scene_facts(self.trial, self.now, self.beliefs)
        self.sizes = {name: self.trial.size(name) for name in self.trial.objects}

    @property
    def samples(self):
        return sample_states(self.world, self.now, self.sizes)


@pytest.fixture
def scene():
    made = []

    def make(task, seed=0):
        made.append(Scene(task, seed))
        return made[-1]

    yield make
    for one in made:
        one.world.close()


@pytest.fixture
def place(tmp_path):
    """Where a memory of some name is to be."""
    return lambda name: str(tmp_path / f"{name}.sqlite")


@pytest.fixture(scope="session")
def trial():
    """A box in front of a wall, and a can."""

    def thing(name, part, **more):
        return {"name": name, "parts": [part], "mass_kg": 0.2, "friction": 0.5, **more}

    return sample_trial(
        Task.model_validate(
            {
                "format": "coral-contact/1",
                "name": "test",
                "title": "Test",
                "instruction": "Test.",
                "time_limit_s": 10,
                "fixtures": [{"name": "wall", "size": [0.04, 0.6, 0.3], "position": [0.32, 0, 0.15]}],
                "objects": [
                    thing(
                        "box", {"shape": "box", "size": [0.12, 0.08, 0.06]}, x=0.0, y=0.05, yaw_deg=20, symmetry="box"
                    ),
                    thing(
                        "can", {"shape": "cylinder", "size": [0.07, 0.07, 0.11]}, x=-0.15, y=-0.1, symmetry="cylinder"
                    ),
                ],
                "success": {"conditions": [{"kind": "lifted", "object": "box", "height_m": 0.1}]},
            }
        ),
        seed=0,
    )
