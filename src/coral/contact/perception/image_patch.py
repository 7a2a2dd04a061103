"""The patch of a picture that is searched for an object: depth, mask and distance to the mask, at a chosen size."""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.scene.observation import Array

ROBOT_NAME = "robot"
"""Name of the robot in pictures, where the camera labels it: occlusion by the robot is then known."""
ROBOT, OCCLUDED_RIM = 1, 2
"""`ImagePatch.occlusion`: a pixel of the robot; a pixel at which an occluder ends the object's mask."""
NEARER = 0.012
"""Anything nearer than the object by more than this (m) occludes it: six standard deviations of depth at 1 m."""


class ImagePatch(NamedTuple):
    """A crop of a picture, possibly at lower resolution, for the alignment kernels."""

    depth: NDArray[np.float32]
    """Depth, Shape=(H, W) m, 0 where nothing was measured."""
    mask: NDArray[np.bool_]
    """Mask of the object, Shape=(H, W)."""
    mask_distance: NDArray[np.float32]
    """Signed distance to the mask, Shape=(H, W) pixels: 0 on its rim, negative inside."""
    occlusion: NDArray[np.uint8]
    """Shape=(H, W): `ROBOT` outside the mask, `OCCLUDED_RIM` inside it, else 0."""
    lens: Array
    """Intrinsics of the patch in its own pixels, Shape=(4,): fx, fy, cx, cy."""


def robot_mask(frame: RgbdFrame) -> NDArray[np.bool_]:
    """Return the robot's mask, Shape=(H, W); empty if the camera does not label it."""
    return frame.mask(ROBOT_NAME) if ROBOT_NAME in frame.names else np.zeros(frame.depth.shape, bool)


def crop_patch(
    depth: NDArray[np.float32],
    mask: NDArray[np.bool_],
    robot: NDArray[np.bool_],
    lens: Array,
    box: tuple[int, int, int, int],
    pixels: int,
) -> ImagePatch:
    """Crop a picture to `box` (left, right, top, bottom; ends excluded), and keep at most so many `pixels`.

    Every n-th row and column is kept. Depth is in metres, 0 where nothing was measured; the masks, Shape=(H, W) too,
    are those of the object and of the robot; the lens is fx, fy, cx, cy in pixels.
    """
    left, right, top, bottom = box
    step = 1
    while (right - left) * (bottom - top) > pixels * step * step:
        step += 1
    part = np.ascontiguousarray(mask[top:bottom:step, left:right:step])
    seen = np.ascontiguousarray(depth[top:bottom:step, left:right:step], np.float32)
    inside = part.astype(np.uint8)
    occlusion = (robot[top:bottom:step, left:right:step] & ~part).astype(np.uint8)
    field = cv2.distanceTransform(1 - inside, cv2.DIST_L2, 5)
    if not part.all():
        within, nearest = cv2.distanceTransformWithLabels(inside, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
        field = np.where(part, 1.0 - within, field)
        # For each pixel of the mask, look up the nearest one outside: is it the robot's, or well in front?
        bound = np.zeros(int(nearest.max()) + 1, np.float32)
        bound[nearest[~part]] = np.where(occlusion > 0, NEARER, np.where(seen > 0, seen, np.inf))[~part]
        hidden = bound[nearest] < seen - NEARER
        occlusion = np.where(part, OCCLUDED_RIM * hidden, ROBOT * occlusion).astype(np.uint8)
    own_lens = np.array([lens[0] / step, lens[1] / step, (lens[2] - left) / step, (lens[3] - top) / step])
    return ImagePatch(seen, part, field.astype(np.float32), occlusion, own_lens)


def box_of(mask: NDArray[np.bool_], margin: int, points: Array | None = None) -> tuple[int, int, int, int]:
    """Return the bounding box (left, right, top, bottom) of a mask, not empty, and of points, inside the picture.

    The margin and the points, Shape=(n, 2), are in pixels.
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
    """Project points, Shape=(n, 3) m in the camera frame, without those behind it. Shape=(m, 2) pixels."""
    ahead = points[points[:, 2] > 0.02]
    return lens[2:] + lens[:2] * ahead[:, :2] / ahead[:, 2:]
