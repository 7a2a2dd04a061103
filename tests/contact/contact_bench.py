"""Trials and states of the world made by hand, for the tests of the contact half."""

import copy
import struct

import numpy as np
import yaml

from coral.contact.scene.geometry import from_rpy_deg
from coral.contact.scene.observation import BodyState, Contact, Observation, Truth
from coral.contact.scene.task import Task
from coral.contact.scene.trial import Trial, sample_trial
from coral.contact.tasks import load_task

DOWN = np.array([0.0, 1.0, 0.0, 0.0])

PLAIN = {
    "name": "bench",
    "title": "Bench",
    "instruction": "Do it.",
    "time_limit_s": 10,
    "fixtures": [{"name": "wall", "size": [0.04, 0.4, 0.2], "position": [0.25, 0, 0.1]}],
    "objects": [
        {
            "name": "box",
            "parts": [{"size": [0.06, 0.06, 0.06]}],
            "mass_kg": 0.2,
            "friction": 0.5,
            "x": 0,
            "y": 0,
            "points": {"corner": [0.03, 0.03, 0.03]},
        }
    ],
    "places": {"goal": [0.1, 0, 0.03]},
    "numbers": {"lift_height": 0.12},
    "success": {"hold_s": 0.1, "conditions": [{"kind": "released", "object": "box"}]},
}


def plain() -> dict:
    """A small valid task as the plain values of a file."""
    return copy.deepcopy(PLAIN)


def changed(path: str, value: object) -> dict:
    """The small task with one value put somewhere, such as at `objects.0.x`; None takes it away."""
    task = plain()
    *parents, last = [int(part) if part.isdigit() else part for part in path.split(".")]
    place = task
    for part in parents:
        place = place[part]
    if value is None:
        del place[last]
    else:
        place[last] = value
    return task


def make_trial(*conditions: dict, seed: int = 0, **changes: object) -> Trial:
    """The small task, drawn, with other conditions or other values."""
    content = plain() | changes
    if conditions:
        content["success"] = {"hold_s": 0.1, "conditions": [{"object": "box"} | one for one in conditions]}
    return sample_trial(Task.model_validate(content), seed)


def written(folder, content: object):
    """A task loaded from a file with this content: text, bytes, or values to be written as YAML."""
    path = folder / "task.yaml"
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        path.write_text(content if isinstance(content, str) else yaml.safe_dump(content), encoding="utf-8")
    return load_task(path)


def stl(path, corners=((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)), at=(0.0, 0.0, 0.0)):
    """A tetrahedron as a binary STL file."""
    points = np.asarray(corners, dtype=float) + at
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    rows = b"".join(struct.pack("<12fH", 0, 0, 0, *points[list(face)].ravel(), 0) for face in faces)
    path.write_bytes(bytes(80) + struct.pack("<I", 4) + rows)
    return path


def body(
    position=(0.0, 0.0, 0.03), rpy_deg=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0), spin=(0.0, 0.0, 0.0)
) -> BodyState:
    return BodyState(
        np.array(position, dtype=float),
        from_rpy_deg(rpy_deg),
        np.array(velocity, dtype=float),
        np.array(spin, dtype=float),
    )


def touch(first: str, second: str, force=(0.0, 0.0, 1.0)) -> Contact:
    """Touch, with the force (N) of the first on the second."""
    force = np.array(force, dtype=float)
    if first > second:
        first, second, force = second, first, -force
    return Contact(first, second, force, np.zeros(3))


def truth(time_s: float = 0.0, box: BodyState | None = None, *contacts: Contact, **others: BodyState) -> Truth:
    return Truth(time_s, body((0, 0, 0.3)), 0.08, {"box": box or body(), **others}, contacts)


def seen(
    trial: Trial, tool=(-0.1, 0.0, 0.25), opening_m: float = 0.08, quaternion=DOWN, **objects: BodyState
) -> Observation:
    """What is measured with the hand and the objects at rest, by default where they stand at first."""
    poses = {name: item.pose for name, item in trial.objects.items()} | objects
    return Observation(
        0.0, BodyState(np.array(tool, dtype=float), np.asarray(quaternion, dtype=float)), opening_m, np.zeros(6), poses
    )
