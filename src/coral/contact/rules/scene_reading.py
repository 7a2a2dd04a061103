"""The scene's facts as the composing rules read them: sizes, axes and directions in the world frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.contact.plan.contact_regions import Region
from coral.contact.plan.cost_plan import StageAnswer
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.geometry import rotation_of

Array = NDArray[np.float64]
GRASP_M = 0.074
"""Widest part that fits between the fingers with some clearance: the hand opens to 0.08 m."""


@dataclass(frozen=True, kw_only=True)
class SkillAdjustment:
    """Adjustment of a composed plan by repairs."""

    turn: int = 0
    """Number of the grasp or side to use, among those that fit."""
    lower_m: float = 0.0
    """How much lower the tool grasps or pushes, m."""
    press: float = 1.0
    """Factor on the forces of pressing, squeezing and pushing."""
    careful: float = 1.0
    """Factor on the sampling noise of stages in contact; below 1 the hand moves more carefully."""
    loose: float = 1.0
    """Factor on how near the hand must come, and how square, before a stage that reaches for something ends."""


@dataclass
class Draft:
    """Stages and regions of a plan under construction."""

    stages: list[StageAnswer] = field(default_factory=list)
    regions: list[tuple[str, Region]] = field(default_factory=list)
    words: list[str] = field(default_factory=list)


class Thing:
    """A movable object in its present pose."""

    def __init__(self, name: str, facts: SceneFacts) -> None:
        item = facts["objects"][name]
        self.name, self.shapes = name, tuple(item["shapes"])
        self.size = np.asarray(item["size_m"], dtype=float)
        self.middle = np.asarray(item.get("middle_m", (0.0, 0.0, 0.0)), dtype=float)
        """Extents of its bounding box, in its frame."""
        self.position = np.asarray(item["pose"][:3], dtype=float)
        self.rotation = rotation_of(item["pose"][3:])
        self.parts = [
            (np.asarray(part["position"], dtype=float), np.asarray(part["size_m"], dtype=float) / 2)
            for part in item.get("parts", ())
        ] or [(self.middle, self.size / 2)]
        self.points = {key: np.asarray(at, dtype=float) for key, at in item["points"].items()}
        self.mass, self.friction = float(item.get("mass_kg", 0.3)), float(item.get("friction", 0.5))

    @property
    def up(self) -> int:
        """Return the axis closest to vertical."""
        return int(np.argmax(np.abs(self.rotation[2])))

    @property
    def up_sign(self) -> float:
        """Return 1 if that axis points up, else -1."""
        return 1.0 if self.rotation[2, self.up] > 0 else -1.0

    @property
    def height(self) -> float:
        """Return the vertical extent, m."""
        return float(self.size[self.up])

    @property
    def low(self) -> float:
        """Return the height of the underside, m."""
        return float(self.position[2] + self.rotation[2] @ self.middle - self.height / 2)

    def to_face(self, axis: int, sign: float) -> float:
        """Return the distance (m) from the origin of the object's frame to the face that an axis points to."""
        return float(self.size[axis] / 2 + sign * self.middle[axis])

    @property
    def lying(self) -> list[int]:
        """Return the two axes closest to horizontal."""
        return [k for k in range(3) if k != self.up]

    def toward(self, direction: Array) -> tuple[int, float]:
        """Return the lying axis closest to a horizontal direction, and its sign."""
        k = max(self.lying, key=lambda axis: abs(float(self.rotation[:, axis] @ direction)))
        return k, 1.0 if float(self.rotation[:, k] @ direction) >= 0 else -1.0

    def closings(self) -> list[int]:
        """Return the lying axes along which the fingers can close from above, narrowest first."""
        fits = [k for k in self.lying if self.size[k] <= GRASP_M]
        return sorted(fits, key=lambda k: self.size[k])

    def room_behind(self, point: Array, direction: Array) -> float:
        """Return the distance (m) from an inner point to the surface, against a direction; both in the object's frame.

        Each part counts as its bounding box; if several contain the point, the farthest surface counts.
        """
        found = [0.0]
        for middle, half in self.parts:
            off = point - middle
            if (np.abs(off) <= half + 1e-6).all():
                way = np.where(direction > 0, off + half, half - off) / np.maximum(np.abs(direction), 1e-9)
                found.append(float(way.min()))
        return max(found)

    def face(self, axis: int, sign: float, at: Mapping[int, float] | None = None) -> tuple[list[float], list[float]]:
        """Return centre and normal of a face in the object's frame; `at` shifts along the other axes, -1 to 1."""
        center, normal = self.middle.copy(), np.zeros(3)
        center[axis] += sign * self.size[axis] / 2
        normal[axis] = sign
        for k, share in (at or {}).items():
            center[k] += share * self.size[k] / 2
        return [round(float(v), 4) for v in center], [float(v) for v in normal]


def others(facts: SceneFacts, name: str) -> list[str]:
    """Return the other movable objects."""
    return [other for other in facts["objects"] if other != name]


def disturbance_term(facts: SceneFacts, name: str) -> str:
    """Return a program line that penalises moving other objects; "" if there are none."""
    speeds = " + ".join(f"norm(self.{other}_vel)" for other in others(facts, name))
    return f"    terms['leave others alone'] = 3.0 * ({speeds})\n" if speeds else ""


def number(value: float) -> str:
    """Format a number as program text."""
    return f"{round(float(value), 4) + 0.0:g}"


def vector(values: Any) -> str:
    """Format a vector as program text."""
    return f"np.array([{', '.join(f'{round(float(v), 4) + 0.0:.4g}' for v in values)}])"


def axis_of(name: str, axis: int, sign: float = 1.0, quat: str = "quat") -> str:
    """Return an axis of an object as program text."""
    return f"{'-1.0 * ' if sign < 0 else ''}quat_axis(self.{name}_{quat}, {axis})"
