"""The part of a picture in which an object is looked for: depth, mask, distance to the mask, at a chosen coarseness."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception import agreement_kernels
from coral.contact.perception import align_kernels as kernels
from coral.contact.perception.object_model import ObjectModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class View:
    """A cut-out of a picture.

    Args:
        depth: Shape=(H, W) m, 0 where nothing was measured.
        mask: Shape=(H, W), where the object is seen.
        field: Shape=(H, W) pixels, distance to the mask; 0 on its rim, negative further inside.
        cover: Shape=(H, W): `ROBOT` and `BESIDE` of `align_kernels`, else 0.
        lens: Shape=(4,): fx, fy, cx, cy of the cut-out in its own pixels.
    """

    depth: NDArray[np.float32]
    mask: NDArray[np.bool_]
    field: NDArray[np.float32]
    cover: NDArray[np.uint8]
    lens: Array

    def count(self, model: ObjectModel, T_camera_object: Array, margin_m: float) -> Array:
        """How well a pose explains the cut-out: the tally of `agreement_kernels.count`. Shape=(7,)."""
        s, tally = model.solids, np.empty(7)
        turn, shift = T_camera_object[:3, :3].copy(), T_camera_object[:3, 3].copy()
        agreement_kernels.count(
            turn,
            shift,
            s.kind,
            s.center,
            s.rotation,
            s.size,
            s.first,
            s.count,
            s.triangles,
            self.depth,
            self.mask,
            self.field,
            self.cover,
            self.lens,
            margin_m,
            tally,
        )
        return tally

    def place(self, model: ObjectModel, T_camera_object: Array, rounds: int = 2) -> Array:
        """The pose shifted so that its drawing has the mask's centre and depth. Shape=(4, 4)."""
        s = model.solids
        turn, shift = T_camera_object[:3, :3].copy(), T_camera_object[:3, 3].copy()
        agreement_kernels.place(
            turn,
            shift,
            s.kind,
            s.center,
            s.rotation,
            s.size,
            s.first,
            s.count,
            s.triangles,
            self.depth,
            self.mask,
            self.lens,
            rounds,
        )
        return _pose(turn, shift)

    def align(
        self,
        model: ObjectModel,
        T_camera_object: Array,
        iterations: int,
        wide_m: float,
        tight_m: float,
        outline: float,
        hold: float = 0.0,
    ) -> Array:
        """The pose after some Gauss-Newton steps of `align_kernels.align`. Shape=(4, 4)."""
        s = model.solids
        turn, shift = T_camera_object[:3, :3].copy(), T_camera_object[:3, 3].copy()
        kernels.align(
            turn,
            shift,
            model.pivot,
            s.kind,
            s.center,
            s.rotation,
            s.size,
            s.first,
            s.count,
            s.triangles,
            self.depth,
            self.mask,
            self.field,
            self.cover,
            self.lens,
            iterations,
            wide_m,
            tight_m,
            outline,
            hold,
        )
        return _pose(turn, shift)


def cut(
    depth: NDArray[np.float32],
    mask: NDArray[np.bool_],
    robot: NDArray[np.bool_],
    lens: Array,
    box: tuple[int, int, int, int],
    pixels: int,
) -> View:
    """Columns and rows of `box` (left, right, top, bottom; ends excluded), every n-th: at most `pixels` remain.

    Args:
        depth: Shape=(H, W) m, 0 where nothing was measured.
        mask: Shape=(H, W), where the object is seen.
        robot: Shape=(H, W), where the robot is seen.
        lens: Shape=(4,): fx, fy, cx, cy in pixels.
        box: What to cut out.
        pixels: How many to keep.
    """
    left, right, top, bottom = box
    step = 1
    while (right - left) * (bottom - top) > pixels * step * step:
        step += 1
    part = np.ascontiguousarray(mask[top:bottom:step, left:right:step])
    seen = np.ascontiguousarray(depth[top:bottom:step, left:right:step], np.float32)
    inside = part.astype(np.uint8)
    cover = (robot[top:bottom:step, left:right:step] & ~part).astype(np.uint8)
    field = cv2.distanceTransform(1 - inside, cv2.DIST_L2, 5)
    if not part.all():
        within, nearest = cv2.distanceTransformWithLabels(inside, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
        field = np.where(part, 1.0 - within, field)
        # Every pixel of the mask gets the one outside that is nearest: the robot, or something well before the object?
        bound = np.zeros(int(nearest.max()) + 1, np.float32)
        bound[nearest[~part]] = np.where(cover > 0, kernels.NEARER, np.where(seen > 0, seen, np.inf))[~part]
        hidden = bound[nearest] < seen - kernels.NEARER
        cover = np.where(part, kernels.BESIDE * hidden, kernels.ROBOT * cover).astype(np.uint8)
    return View(
        seen,
        part,
        field.astype(np.float32),
        cover,
        np.array([lens[0] / step, lens[1] / step, (lens[2] - left) / step, (lens[3] - top) / step]),
    )


def box_of(mask: NDArray[np.bool_], margin: int, points: Array | None = None) -> tuple[int, int, int, int]:
    """Left, right, top, bottom of a mask, and of some pixels, with a margin inside the picture.

    Args:
        mask: Shape=(H, W), not empty.
        margin: Pixels.
        points: Shape=(n, 2), pixels to hold too.
    """
    columns, rows = np.flatnonzero(mask.any(0)), np.flatnonzero(mask.any(1))
    low, high = np.array([columns[0], rows[0]]), np.array([columns[-1], rows[-1]])
    if points is not None and len(points):
        low = np.minimum(low, np.floor(points.min(0)).clip(-1e6, 1e6)).astype(int)
        high = np.maximum(high, np.ceil(points.max(0)).clip(-1e6, 1e6)).astype(int)
    height, width = mask.shape
    return (
        max(0, int(low[0]) - margin),
        min(width, int(high[0]) + margin + 1),
        max(0, int(low[1]) - margin),
        min(height, int(high[1]) + margin + 1),
    )


def project(points: Array, lens: Array) -> Array:
    """Pixels of points in front of the camera. Shape=(m, 2).

    Args:
        points: Shape=(n, 3) m in the camera frame.
        lens: Shape=(4,).
    """
    ahead = points[points[:, 2] > 0.02]
    return lens[2:] + lens[:2] * ahead[:, :2] / ahead[:, 2:]


def _pose(turn: Array, shift: Array) -> Array:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn, shift
    return pose
