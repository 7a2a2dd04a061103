"""Facts of a scene as plain numbers: the types of the JSON in questions and memories.

Metres, kilograms, quaternions (w, x, y, z), world frame. `thinker/scene_facts.py` collects them; checks, memory and
rules read them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.conditions import Condition


class PartFacts(TypedDict):
    """Bounding box of one part of an object, in the object's frame."""

    size_m: list[float]
    position: list[float]


class JointFacts(TypedDict):
    """What holds an object: `axis` and `point` in its frame; `range` and friction in degrees and N m, or m and N."""

    kind: str
    axis: list[float]
    point: list[float]
    range: list[float]
    now: float
    friction: float


class ObjectFacts(TypedDict):
    """One movable object.

    Args:
        label: Its name for people; its identifier if the task file has no label.
        size_m: Full extents of its bounding box.
        pose: Pose of its frame: x, y, z, qw, qx, qy, qz.
        shapes: Kinds of its parts, sorted.
        solid_share: Volume of the parts as a share of the box.
        parts: The parts that are neither meshes nor rotated.
        points: Named points in its frame.
        middle_m: Centre of its box in its frame; missing if it is the origin.
        joint: What holds it; missing if it moves freely.
        unseen: True before a picture has shown it: its pose is a guess.
        somewhere: From where to where it may be until then, by the task file; missing if something carries or holds it.
        lost: True while the tracker has lost it: its pose is the last one seen.
        mass_kg, friction: Beliefs; missing before the first belief.
    """

    label: str
    size_m: list[float]
    pose: list[float]
    shapes: list[str]
    solid_share: float
    parts: list[PartFacts]
    points: dict[str, list[float]]
    middle_m: NotRequired[list[float]]
    joint: NotRequired[JointFacts]
    mass_kg: NotRequired[float]
    friction: NotRequired[float]
    unseen: NotRequired[bool]
    somewhere: NotRequired[AreaFacts]
    lost: NotRequired[bool]


class FixtureFacts(TypedDict):
    """A fixed thing: its centre, full extents and rotation about z."""

    position: list[float]
    size_m: list[float]
    yaw_deg: float


class AreaFacts(TypedDict):
    """From where to where in x and y: the table's top, at z = 0, or the origin of an object's frame."""

    x: list[float]
    y: list[float]


class HandFacts(TypedDict):
    """The tool's pose, and the fingers' opening, present and widest."""

    pose: list[float]
    opening_m: float
    widest_opening_m: float


Goal = dict[str, Any]
"""A condition of the task file as JSON: `kind` says which of `conditions`, whose fields these are."""


class SceneFacts(TypedDict):
    """The whole scene, and what single questions add to it.

    Args:
        task: Name of the task.
        instruction: The task in words.
        goals: The conditions of the task file.
        objects, fixtures: Movable and fixed things by name.
        places: Named places of the task.
        numbers: Named numbers of the task.
        table: The table's top.
        hand: The hand.
        refused: Number of refused answers about the plan before the accepted one; regions must fit that one.
        diagnoses: Of questions about the plan: the diagnoses so far, in order.
        contact_strategy: Likewise: whether the plan may name contact regions.
        stages: Of the question about regions: the names of the plan's stages.
        fitted: Of a correction: mass and friction fitted to an object, and whether they explain the history better.
    """

    task: str
    instruction: str
    goals: list[Goal]
    objects: dict[str, ObjectFacts]
    fixtures: dict[str, FixtureFacts]
    places: dict[str, list[float]]
    numbers: dict[str, float]
    table: AreaFacts
    hand: HandFacts
    refused: NotRequired[int]
    diagnoses: NotRequired[Sequence[str]]
    contact_strategy: NotRequired[bool]
    stages: NotRequired[Sequence[str]]
    fitted: NotRequired[Mapping[str, Any]]


def goals_of(conditions: Sequence[Condition]) -> list[Goal]:
    """Convert conditions to JSON."""
    return [condition.model_dump(mode="json") for condition in conditions]


def on_table(table: AreaFacts, point: NDArray[np.float64]) -> bool:
    """Check whether a point, Shape=(2,) or (3,) m in the world, lies over the table."""
    (left, right), (near, far) = table["x"], table["y"]
    return bool(left <= point[0] <= right and near <= point[1] <= far)
