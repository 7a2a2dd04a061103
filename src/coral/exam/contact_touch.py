"""The contact that a task wants, from its goals: side of the object and approach (ground truth, for keys alone)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from coral.contact.plan.contact_regions import Region, closing_axis
from coral.contact.scene.geometry import rotate
from coral.contact.scene.trial import Trial

WITHIN_COS = 0.64
"""A face belongs to a side if its normal is within 50 degrees of it; a box turned by 45 shows two faces to a side."""
Touch = dict[str, Any]
"""An `object`, `how` it is approached, the `side` (unit vector in the world, None for any), whether `high` on it."""


def touches(trial: Trial) -> list[Touch]:
    """Derive the helpful contacts of a task; one list for all its stages.

    An object to be pushed is touched on the side opposite to its goal; an object to be lifted is pinched; an object to
    be flipped is touched on the side from which it turns over: towards a wall, or away from the robot.
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
    """Check whether a region is such a contact.

    Args:
        region: The region.
        name: Name of its object.
        touch: The wanted contact.
        pose: Pose of the object: x, y, z, qw, qx, qy, qz.
        size: Full extents of the object, m.
    """
    if name != touch["object"] or region.approach not in (None, *touch["how"]):
        return False
    if touch["side"] is None:
        # A region without a named approach counts as a pinch if the fingers can close there.
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
