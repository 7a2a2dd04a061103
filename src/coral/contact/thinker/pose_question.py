"""The question about object poses, asked once about the first picture: the ablation without tracking (Table 1).

The advisor estimates the centre of an object's bounding box, which a picture shows. The origin of its frame, which the
rest of the package calls its position, may lie elsewhere (for a board with a handle, in the middle of the board).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from pydantic import BaseModel, RootModel

from coral.advisor.question import Rejection
from coral.contact.perception.advisor_camera import to_picture
from coral.contact.perception.camera import RgbdFrame
from coral.contact.scene.geometry import rotate
from coral.contact.scene.observation import BodyState, Observation
from coral.contact.scene.trial import Trial
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.scene_facts import pose, rounded, table_facts
from coral.contact.thinker.think_cfg import StandIn, stand_in

BESIDE_M, BELOW_M = 0.3, 0.02
"""Margin beside the table and below its top within which a centre is accepted."""


class ObjectPose(BaseModel):
    """One object's pose.

    Args:
        position: Of the centre of its bounding box in the world, m.
        quaternion: (w, x, y, z), of any length but 0.
    """

    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]


class PosesAnswer(RootModel[dict[str, ObjectPose]]):
    """Poses by the objects' names."""

    def bodies(self, facts: Mapping[str, Any]) -> dict[str, BodyState]:
        """Convert to an observation's bodies at rest, with positions at the frames' origins instead of box centres."""
        found = {}
        for name, one in self.root.items():
            quaternion = np.array(one.quaternion) / np.linalg.norm(one.quaternion)
            middle = np.array(facts["objects"][name]["middle_m"])
            found[name] = BodyState(np.array(one.position) - rotate(quaternion, middle), quaternion)
        return found


def verify_poses(answer: PosesAnswer, facts: Mapping[str, Any]) -> Rejection | None:
    """Return the reason why estimated poses are impossible, or None."""
    wanted, given = list(facts["objects"]), list(answer.root)
    if set(wanted) != set(given):
        return Rejection(
            code="objects",
            reason=f"poses of {', '.join(given) or 'nothing'}; give one for each of "
            f"{', '.join(wanted)} and for nothing else",
        )
    x, y = facts["table"]["x"], facts["table"]["y"]
    for name, one in answer.root.items():
        if not all(map(math.isfinite, (*one.position, *one.quaternion))) or not any(one.quaternion):
            return Rejection(
                code="pose", reason=f"the pose of {name} holds something that is no number, or a quaternion of zeros"
            )
        inside = all(
            low - BESIDE_M <= value <= high + BESIDE_M for value, (low, high) in zip(one.position, (x, y), strict=False)
        )
        if not inside or not -BELOW_M <= one.position[2] <= 1.0:
            return Rejection(
                code="place",
                reason=f"{name} would be at {list(one.position)}; the table reaches from "
                f"{x[0]:g} to {x[1]:g} m in x and from {y[0]:g} to {y[1]:g} m in y, and its top is at 0",
            )
    return None


def pose_facts(trial: Trial, now: Observation, frame: RgbdFrame) -> dict[str, Any]:
    """Collect the prior knowledge: shapes and the camera.

    Of each object: label and extents (m), the centre of its bounding box in its frame, and its points relative to that
    centre. The trial's poses are not read.
    """
    objects: dict[str, Any] = {}
    for item in trial.task.objects:
        corners = trial.corners(item.name)
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        objects[item.name] = {
            "label": item.label or item.name,
            "size_m": [round(float(v), 5) for v in trial.size(item.name)],
            "middle_m": rounded(middle),
            "points_m": {
                point: rounded(np.asarray(at) * trial.objects[item.name].scale - middle)
                for point, at in item.points.items()
            },
        }
    height, width = frame.depth.shape
    return {
        "task": trial.task.name,
        "instruction": trial.task.instruction,
        "objects": objects,
        "table": table_facts(trial),
        "hand": {"pose": pose(now.tool)},
        "camera": {
            "position": rounded(frame.T_world_camera[:3, 3]),
            "axes_right_down_forward": [rounded(axis) for axis in frame.T_world_camera[:3, :3].T],
            "focal_px": round(float(frame.lens[0]), 1),
            "width_px": width,
            "height_px": height,
        },
    }


def pose_prompt(facts: Mapping[str, Any]) -> dict[str, Any]:
    """Fill the template "object-poses": a model sees only the picture, no measured depth.

    Named points, relative to the centre of the box, distinguish an object's front from its back.
    """
    return {
        "task": facts["instruction"],
        "camera": facts["camera"],
        "table": facts["table"],
        "objects": {
            name: {key: item[key] for key in ("label", "size_m", "points_m") if item[key]}
            for name, item in facts["objects"].items()
        },
    }


def ask_poses(
    asker: Asker,
    trial: Trial,
    first: Observation,
    frame: RgbdFrame,
    emit: Callable[..., None],
    policy: StandIn = "prior",
) -> dict[str, BodyState]:
    """Ask an advisor for the objects' poses; the arguments are those of `pose_facts`.

    Raises:
        NoDecision: It gives none: where nothing is tracked, nothing can stand for them.
    """
    facts = pose_facts(trial, first, frame)
    outcome = asker.ask(
        "object-poses",
        PosesAnswer,
        facts,
        pose_prompt(facts),
        lambda answer: verify_poses(answer, facts),
        pictures=(to_picture(frame),),
    )
    if outcome.answer is None:
        stand_in(emit, policy, "poses", outcome.failure, "")
        raise AssertionError
    found = outcome.answer.bodies(facts)
    emit(
        "poses",
        failure=outcome.failure,
        attempts=outcome.attempts,
        refused=[rejection.reason for rejection in outcome.rejections],
        decided="poses",
        source=asker.source,
        **{name: pose(body) for name, body in found.items()},
    )
    return found
