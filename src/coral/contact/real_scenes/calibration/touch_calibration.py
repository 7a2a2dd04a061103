"""Calibration by touch: the hand touches points whose pixels are clicked, and two sets of points are aligned."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import BaseModel, Field

from coral.config import Signed, read_model
from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.calibration.camera_pose_file import CameraCalibration
from coral.contact.real_scenes.calibration.wrong_entry import check_fit
from coral.contact.scene.observation import Array
from coral.contact.scene.rigid_transform import pose_matrix
from coral.errors import InputError

LEAST, MOST = 4, 100
"""Number of points; three would leave nothing to check."""
LIMIT_M = 0.01
"""Largest root mean square of the residuals: the grip is 8 cm wide and objects are 5 cm, so more would miss."""
LEAST_SPREAD_M = 0.05
"""Least second axis of the points' spread: points on a line leave the rotation about it open."""
PATCH = 2
"""Depth is the median over this many pixels to each side."""


class Touch(BaseModel, frozen=True, extra="forbid"):
    """A point that was clicked and touched."""

    pixel: tuple[Signed, Signed]
    """Column and row."""
    touched_m: tuple[Signed, Signed, Signed]
    """In the world."""


class TouchesFile(BaseModel, frozen=True, extra="forbid"):
    """The points."""

    touches: Annotated[tuple[Touch, ...], Field(min_length=LEAST, max_length=MOST)]


def align_points(source: Array, target: Array) -> Array:
    """Compute the rigid transform, Shape=(4, 4), that moves points, Shape=(N, 3) m, best onto others (Kabsch, 1976)."""
    a, b = source.mean(axis=0), target.mean(axis=0)
    u, _, vt = np.linalg.svd((source - a).T @ (target - b))
    turn = vt.T @ np.diag([1.0, 1.0, np.sign(np.linalg.det(vt.T @ u.T))]) @ u.T
    return pose_matrix(turn, b - turn @ a)


def calibrate_by_touch(frame: RgbdFrame, touches: Sequence[Touch], where: str) -> CameraCalibration:
    """Compute where the camera stands from the picture that was clicked, whose pose is not read; `where` is for errors.

    Raises:
        InputError: A pixel has no depth, the points lie on a line, or they do not agree within `LIMIT_M`.
    """
    seen = np.array([_seen_point(frame, touch.pixel, f"touches[{k}].pixel", where) for k, touch in enumerate(touches)])
    touched = np.array([touch.touched_m for touch in touches])
    spread = np.linalg.svd(touched - touched.mean(axis=0), compute_uv=False) / np.sqrt(len(touched))
    if spread[1] < LEAST_SPREAD_M:
        found = f"points within {1e3 * spread[1]:.0f} mm of a line"
        raise InputError(where, "touches", found, f"points spread by {1e3 * LEAST_SPREAD_M:.0f} mm beside it")

    def fit(chosen: Sequence[int]) -> CameraCalibration:
        a, b = seen[chosen], touched[chosen]
        placed = align_points(a, b)
        left_mm = 1e3 * np.linalg.norm(a @ placed[:3, :3].T + placed[:3, 3] - b, axis=1)
        left = {"rms_mm": float(np.sqrt(np.mean(left_mm**2))), "largest_mm": float(left_mm.max())}
        return CameraCalibration(placed, left)

    def residual_mm(chosen: Sequence[int]) -> float:
        return fit(chosen).residuals["rms_mm"]

    check_fit(residual_mm, len(touches), 1e3 * LIMIT_M, "mm", LEAST, (where, "touches"))
    return fit(range(len(touches)))


def read_touches(path: Path) -> list[Touch]:
    """Read a file of touches: a list `touches` of `pixel: [column, row]` and `touched_m: [x, y, z]`.

    Raises:
        InputError: The file is missing or broken.
    """
    return list(read_model(path, TouchesFile).touches)


def _seen_point(frame: RgbdFrame, pixel: tuple[float, float], field: str, where: str) -> Array:
    """Return the point at a pixel in the camera frame, Shape=(3,) m."""
    height, width = frame.depth.shape
    column, row = round(pixel[0]), round(pixel[1])
    if not (0 <= column < width and 0 <= row < height):
        raise InputError(where, field, f"{column}, {row}", f"a pixel of {width} x {height}")
    patch = frame.depth[max(0, row - PATCH) : row + PATCH + 1, max(0, column - PATCH) : column + PATCH + 1]
    if not (patch > 0).any():
        raise InputError(where, field, f"no depth around {column}, {row}", "a pixel with depth")
    depth = float(np.median(patch[patch > 0]))
    fx, fy, cx, cy = frame.lens
    return np.array([(pixel[0] - cx) / fx * depth, (pixel[1] - cy) / fy * depth, depth])
