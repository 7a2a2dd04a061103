"""Where a task wants to be touched, from its goals: which side of which object, and how (for keys alone)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from coral.contact.plan.contact_regions import Region, closing_axis
from coral.contact.scene.geometry import rotate
from coral.contact.scene.trial import Trial

WITHIN_COS = 0.64
"""A face belongs to a side when its normal is within 50 degrees of it: two faces of a box meet halfway, at 45."""
Touch = dict[str, Any]
"""An `object`, `how` it is approached, the `side` (unit vector in the world, None for any), whether `high` on it."""


def touches(trial: Trial) -> list[Touch]:
    """The touches that help, one list for the whole task.

    What is to be pushed somewhere is touched on the side that faces away from there; what is to be lifted is pinched;
    what is to be tipped over is touched on the side that it turns away from: towards a wall, or away from the robot.
    """
    found: list[Touch] = []
    goals = [goal.model_dump(mode="json") for goal in trial.task.success.conditions]
    kinds = {goal["kind"] for goal in goals}
    for goal in goals:
        name = str(goal.get("object"))
        if goal["kind"] == "at":
            away = np.asarray(trial.task.places[goal["place"]]) - trial.objects[name].pose.position
            pushed = "steady-force" in kinds
            found.append(_push(name, away) if pushed else _pinch(name))
        elif goal["kind"] == "lifted":
            found.append(_pinch(name))
            if any("push" in word for word in trial.task.instruction.lower().split()):
                found.append(_push(name, np.array([0.0, 1.0, 0.0])))  # the table's left edge
        elif goal["kind"] == "flipped":
            wall = next((item for item in trial.task.fixtures if "wall" in item.name), None)
            found.append(_push(name, np.array([1.0, 0.0, 0.0])) | {"high": wall is None})
    return found


def fits(region: Region, name: str, touch: Touch, pose: Sequence[float], size: Sequence[float]) -> bool:
    """Whether a region is such a touch.

    Args:
        region: The region.
        name: Of its object.
        touch: The touch.
        pose: Of the object: x, y, z, qw, qx, qy, qz.
        size: Its full extents, m.
    """
    if name != touch["object"] or region.approach not in (None, *touch["how"]):
        return False
    if touch["side"] is None:
        # A grasp without a named approach is one if the fingers close there.
        return region.approach is not None or closing_axis(np.asarray(region.normal), np.asarray(size)) is not None
    turn = np.asarray(pose[3:])
    if touch.get("high") and rotate(turn, np.asarray(region.center))[2] <= 0.0:
        return False
    return float(rotate(turn, np.asarray(region.normal)) @ np.asarray(touch["side"])) >= WITHIN_COS


def _push(name: str, away: np.ndarray[Any, np.dtype[np.float64]]) -> Touch:
    level = np.array([away[0], away[1], 0.0])
    side = -level / max(float(np.linalg.norm(level)), 1e-9)
    return {"object": name, "how": ["push", "press"], "side": [round(float(v), 4) for v in side]}


def _pinch(name: str) -> Touch:
    return {"object": name, "how": ["pinch"], "side": None}
