"""A shipped task at its beginning, its judge, and states of it made by hand."""

import numpy as np
from contact_bench import touch

from coral.contact.scene.geometry import from_rotvec, multiply
from coral.contact.scene.judge import Judge
from coral.contact.scene.observation import BodyState, Contact, HandForce, Truth
from coral.contact.scene.trial import move_joint, sample_trial
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


def touches(name, *things):
    return [touch(name, thing) for thing in things]


def gripped(one, name, body, point):
    """Both fingers touch an object at a named point of it."""
    at = one.trial.point(name, point, body)
    return [Contact(*sorted((name, finger)), np.array([0.0, 0.0, 1.0]), at) for finger in ("left", "right")]


def placed(one, name, position=None, axis=(0.0, 0.0, 1.0), degrees=0.0):
    """An object moved to a position (None: as it was) and turned about an axis of its own."""
    start = one.trial.objects[name].pose
    at = [old if new is None else new for new, old in zip(position or [None] * 3, start.position, strict=True)]
    turn = from_rotvec(np.radians(degrees) * np.array(axis))
    return BodyState(np.array(at), multiply(start.quaternion, turn))


def at_rest(body):
    return BodyState(body.position, body.quaternion)


def slid(one, to, things=("hand", "table"), force=0.0, pace=0.05):
    """States in which the first object is moved straight to a point (x, y) at a pace (m/s)."""
    start = one.start
    way = np.array([*to, start.position[2]]) - start.position
    count = max(2, round(np.linalg.norm(way) / pace / STEP_S))
    velocity = way / count / STEP_S
    contacts = touches(one.name, *things)
    return [
        (BodyState(start.position + way * share, start.quaternion, velocity), contacts, force)
        for share in np.linspace(0, 1, count)
    ]


def on_joint(one, name, to):
    """An object on its joint at a position, in degrees or metres."""
    item, start = one.trial.task.object(name), one.trial.objects[name].pose
    goal = np.radians(to) if item.joint.kind == "hinge" else to
    return move_joint(item.joint, start, goal - one.trial.joint_position(name, start))
