"""The rotational symmetry of an object, and the choice among its equal poses."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from coral.contact.scene.geometry import body_to_matrix, quaternion_of, rotation_about, rotation_angle, spread_rotations
from coral.contact.scene.observation import Array, BodyState
from coral.errors import InputError


@dataclass(frozen=True)
class Symmetry:
    """The rotations about one point that map an object onto itself, declared as in BOP (Hodan et al., 2018)."""

    rotations: Array = field(default_factory=lambda: np.eye(3)[None])
    """The finite rotations, Shape=(n, 3, 3), the identity first."""
    axis: Array | None = None
    """Unit axis of a continuous symmetry, Shape=(3,); None without one."""
    center: Array = field(default_factory=lambda: np.zeros(3))
    """The fixed point, Shape=(3,) m."""
    sphere: bool = False
    """Whether every rotation is a symmetry."""

    def members(self, steps: int = 36) -> Array:
        """Return transforms of the object onto itself, a continuous symmetry in `steps` steps. Shape=(m, 4, 4)."""
        turns = self.rotations
        if self.sphere:
            turns = spread_rotations(8 * steps)
        elif self.axis is not None:
            spins = np.array([rotation_about(self.axis, 2 * math.pi * k / steps) for k in range(steps)])
            turns = (turns[:, None] @ spins[None]).reshape(-1, 3, 3)
        transforms = np.tile(np.eye(4), (len(turns), 1, 1))
        transforms[:, :3, :3] = turns
        transforms[:, :3, 3] = self.center - turns @ self.center
        return transforms

    def nearest(self, pose: Array, reference: Array) -> Array:
        """Choose, among equal poses, the one whose orientation is nearest to that of `reference`, in the same frame."""
        if self.sphere:
            best = pose[:3, :3].T @ reference[:3, :3]
        else:
            angles, turns = [], []
            for turn in self.rotations:
                if self.axis is not None:
                    turn = turn @ rotation_about(self.axis, self._spin_angle(pose[:3, :3] @ turn, reference[:3, :3]))
                turns.append(turn)
                angles.append(-float(np.trace(reference[:3, :3].T @ pose[:3, :3] @ turn)))
            best = turns[int(np.argmin(angles))]
        result = pose.copy()
        result[:3, :3] = pose[:3, :3] @ best
        result[:3, 3] = pose[:3, 3] + pose[:3, :3] @ (self.center - best @ self.center)
        return result

    def _spin_angle(self, turn: Array, reference: Array) -> float:
        """Compute the angle about the axis that brings `turn` nearest to `reference`: the twist between them."""
        assert self.axis is not None
        q = quaternion_of(turn.T @ reference)
        return 2.0 * math.atan2(float(q[1:] @ self.axis), float(q[0]))

    def difference(self, pose: Array, truth: Array) -> tuple[float, float]:
        """Compute distance (m) of the symmetry's centre and angle (rad) between two poses, modulo the symmetry."""
        equal = self.nearest(pose, truth)
        shift = equal[:3, :3] @ self.center + equal[:3, 3] - truth[:3, :3] @ self.center - truth[:3, 3]
        return float(np.linalg.norm(shift)), rotation_angle(equal[:3, :3], truth[:3, :3])


@dataclass(frozen=True)
class PoseDifference:
    """The error of one object's pose at one time; for reports, never for decisions."""

    off_m: float
    off_rad: float
    """Difference between the true pose and the planner's estimate, modulo the object's symmetry."""
    lost: bool
    """Whether the tracker had lost the object."""


def compare_poses(symmetry: Symmetry, believed: BodyState, true: BodyState, lost: bool) -> PoseDifference:
    """Compute the error of one object's pose."""
    shift, turn = symmetry.difference(body_to_matrix(believed), body_to_matrix(true))
    return PoseDifference(float(shift), float(turn), lost)


def of_kind(kind: str, extents: Array, center: Array | None = None) -> Symmetry:
    """Make a declared symmetry along an object's own axes, about `center` (m), by default the origin.

    It is "none", "box" (half turns about all axes), "square-box" (quarter turns about the odd one, whose extent differs
    most), "cube", "cylinder" (about z, and end over end) or "sphere".
    """
    middle = np.zeros(3) if center is None else np.asarray(center, float)
    axes = np.eye(3)
    half = [rotation_about(a, math.pi) for a in axes]
    if kind == "none":
        return Symmetry(center=middle)
    if kind == "sphere":
        return Symmetry(center=middle, sphere=True)
    if kind == "cylinder":
        return Symmetry(np.stack([np.eye(3), half[0]]), axes[2], middle)
    if kind == "box":
        return Symmetry(np.stack([np.eye(3), *half]), None, middle)
    quarter = [rotation_about(a, math.pi / 2) for a in axes]
    if kind == "square-box":
        odd = int(np.argmax(np.abs(extents - np.median(extents))))
        return Symmetry(_generate_group([quarter[odd], half[(odd + 1) % 3]]), None, middle)
    if kind == "cube":
        return Symmetry(_generate_group(quarter), None, middle)
    raise InputError("object", "symmetry", kind, "none, box, square-box, cube, cylinder or sphere")


def _generate_group(by: list[Array]) -> Array:
    """Generate the finite group of some rotations, the identity first. Shape=(n, 3, 3)."""
    group = [np.eye(3)]
    for member in group:  # the loop extends the list
        for turn in by:
            new = np.rint(turn @ member)
            if not any(np.array_equal(new, known) for known in group):
                group.append(new)
    return np.array(group)


def of_shape(points: Array, distance: Callable[[Array], Array], tolerance_m: float = 0.001) -> Symmetry:
    """Find the symmetry of a shape about the centre of its bounding box, among those along its own axes.

    A rotated point of the surface, Shape=(n, 3) m, has at most the tolerated `distance` to it.
    """
    center = (points.max(0) + points.min(0)) / 2

    def keeps(turn: Array) -> bool:
        return float(distance((points - center) @ turn.T + center).max()) < tolerance_m

    axes = np.eye(3)
    # No finite group of these axes contains these angles: a shape invariant under them is invariant under all.
    free = [a for a in axes if keeps(rotation_about(a, 1.0)) and keeps(rotation_about(a, 2.4))]
    if len(free) > 1:
        return Symmetry(center=center, sphere=True)
    if free:
        flip = rotation_about(axes[(int(np.argmax(free[0])) + 1) % 3], math.pi)
        return Symmetry(np.stack([np.eye(3), flip]) if keeps(flip) else np.eye(3)[None], free[0], center)
    cube = _generate_group([rotation_about(a, math.pi / 2) for a in axes])
    return Symmetry(np.array([turn for turn in cube if keeps(turn)]), None, center)
