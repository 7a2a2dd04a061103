"""The default advisor's rule for poses, from the bounding box of the measured depth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from coral.advisor.question import Rejection
from coral.contact.scene.geometry import rotation_of
from coral.contact.thinker.pose_question import LEAST_PIXELS, ObjectPose, PosesAnswer
from coral.contact.thinker.question_facts import PoseFacts


def estimate_poses(facts: PoseFacts, rejections: Sequence[Rejection] = ()) -> PosesAnswer:
    """Estimate poses: the usual orientation, at the centre of the box around the object's measured depth.

    The box contains only the sides that face the camera, so the estimate is biased towards the camera. For a refused
    pose, or for an object that is hardly visible, it returns the usual pose.
    """
    found = {}
    for name, item in facts["objects"].items():
        usual, seen = item["usual_pose"], item["seen_box_m"]
        turn = rotation_of(np.array(usual[3:]))
        half = float(np.abs(turn[2]) @ np.array(item["size_m"])) / 2
        x, y = (np.array(usual[:3]) + turn @ np.array(item["middle_m"]))[:2]
        z = half
        if seen is not None and item["pixels"] >= LEAST_PIXELS and not rejections:
            low, high = seen
            x, y, z = (low[0] + high[0]) / 2, (low[1] + high[1]) / 2, max(high[2] - half, 0.0)
        found[name] = ObjectPose(
            position=(round(x, 5), round(y, 5), round(z, 5)), quaternion=(usual[3], usual[4], usual[5], usual[6])
        )
    return PosesAnswer(found)
