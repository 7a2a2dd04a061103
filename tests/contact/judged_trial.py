"""A shipped task at its beginning, its judge, and states of it made by hand."""

import numpy as np

from coral.contact.scene.geometry import from_rotvec, multiply
from coral.contact.scene.judge import Judge
from coral.contact.scene.observation import BodyState, HandForce, Truth
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task

STEP_S = 0.02


class JudgedTrial:
    """A shipped task at its beginning, and states of it made by hand."""

    def __init__(self, name):
        self.trial = sample_trial(load_task(name), 0)
        self.name = self.trial.task.objects[0].name
        self.start = self.trial.objects[self.name].pose
        self.judge = Judge(self.trial)
        self.time_s = 0.0

    def succeeds(self, states):
        """Whether the judge is content at the end of these states: (body, contacts, force) of the first object."""
        said = False
        for state, contacts, *force in states:
            forces = {self.name: HandForce(np.array([force[0], 0, 0]), force[0])} if force and force[0] else {}
            others = {name: item.pose for name, item in self.trial.objects.items()}
            moved = state if isinstance(state, dict) else {self.name: state}
            said = self.judge.success(
                Truth(self.time_s, self.start, 0.08, others | moved, tuple(contacts), hand_forces=forces)
            )
            self.time_s += STEP_S
        return said

    def turned(self, axis, degrees, away=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0)):
        """The object turned about an axis of its own, and moved."""
        about = multiply(self.start.quaternion, from_rotvec(np.radians(degrees) * np.array(axis, dtype=float)))
        return BodyState(self.start.position + np.array(away), about, np.array(velocity, dtype=float))


def still(state, contacts, seconds=1.0):
    return [(state, contacts)] * round(seconds / STEP_S)
