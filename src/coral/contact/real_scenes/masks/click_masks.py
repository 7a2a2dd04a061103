"""Masks from one click per object: grown by depth and colour at first, then following the tracked pose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field

from coral.config import Signed, read_model
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.object_model import ObjectModel
from coral.contact.real_scenes.masks.mask_source import Mask, clean_mask
from coral.contact.real_scenes.object_drawing import draw_depth
from coral.contact.scene.observation import Array
from coral.contact.scene.rigid_transform import inverse_transform
from coral.errors import InputError

Pixel = tuple[Signed, Signed]
LEFT = 0.3
"""A lost object has left its place if a smaller share of its last drawing is still there."""
NEAR_CLICK = 2
"""A click on a hole of the depth counts for the nearest measured pixel within this distance (pixels)."""


TABLE_M = 0.004
"""Points below this height in the world are the table's: two standard deviations of depth."""
JUMP_M = 0.01
"""Neighbouring pixels with a larger difference in depth belong to different things."""
COLOUR = 0.06
"""Distance between two colours, as shares of red and green in all light, below which they are the same."""
DILATION_M = 0.025
"""The next mask is searched so far around the object's last drawing: 0.25 m/s at 10 Hz."""
FIT_M = 0.035
"""Depth fits if it is as near as this to that of the last drawing: a face that moves by `DILATION_M` and is seen at
45 degrees."""


class ClicksFile(BaseModel, frozen=True, extra="forbid"):
    """Column and row of each object in the first picture."""

    objects: Annotated[dict[str, Pixel], Field(min_length=1)]


@dataclass
class _Followed:
    """What is known of one object."""

    pose: Array | None = None
    before: Array | None = None
    colour: Array | None = None


class ClickMasks:
    """Follows objects from a click, column and row, in the first picture.

    In the first picture a mask is what is connected with the click in depth and colour, above the table, and no larger
    than the object. Afterwards it is what lies near the last drawing of the object and fits it in depth and colour. The
    tracker says where that drawing is. A lost object that has left its place is searched for by its colour in the whole
    picture; without colours, it is not found again if it has moved far.
    """

    def __init__(self, clicks: Mapping[str, Pixel], models: Mapping[str, ObjectModel]) -> None:
        self.clicks, self._models = dict(clicks), models
        self._followed: dict[str, _Followed] = {}

    def segment(self, frame: RgbdFrame, poses: Mapping[str, Array]) -> Mapping[str, Mask]:
        """See `MaskSource.segment`.

        Raises:
            InputError: A click is outside of the first picture, or nothing was measured there.
        """
        heights, tint = _heights(frame), _tint(frame)
        found = {}
        for name, click in self.clicks.items():
            one = self._followed.get(name)
            if one is None:
                mask = self._grow(frame, heights, tint, name, click)
                self._followed[name] = _Followed(colour=None if tint is None else np.median(tint[mask], axis=0))
            else:
                if name in poses:
                    one.before, one.pose = one.pose, poses[name]
                else:
                    one.before = None
                mask = self._follow(frame, heights, tint, name, one, name not in poses)
            found[name] = mask
        return found

    def _grow(self, frame: RgbdFrame, heights: Array, tint: Array | None, name: str, click: Pixel) -> Mask:
        column, row = _measured_pixel(frame, name, click)
        points = _points(frame)
        centre = points[row, column]
        near = (frame.depth > 0) & (heights > TABLE_M)
        near &= np.linalg.norm(points - centre, axis=2) <= self._models[name].diameter
        if tint is not None:
            near &= np.linalg.norm(tint - tint[row, column], axis=2) < COLOUR
        joined = _connected(frame.depth, near, row, column, JUMP_M)
        mask = clean_mask(joined)
        if not mask.any():
            where = f"the click of {name} at {column}, {row}"
            raise InputError("--masks", where, "nothing that stands out", "a pixel of an object above the table")
        return mask

    def _follow(
        self, frame: RgbdFrame, heights: Array, tint: Array | None, name: str, one: _Followed, lost: bool
    ) -> Mask:
        if one.pose is None:  # not found yet: its colours and depth are where they were
            return self._grow(frame, heights, tint, name, self.clicks[name])
        pose = one.pose
        if one.before is not None:  # at the velocity of the last two pictures
            pose = one.pose.copy()
            pose[:3, 3] += one.pose[:3, 3] - one.before[:3, 3]
        placed = inverse_transform(frame.T_world_camera) @ pose
        drawn = draw_depth(self._models[name].solids, placed, frame)
        inside = np.isfinite(drawn)
        if not inside.any():
            return inside
        middle_m = float(np.median(drawn[inside]))
        reach_px = max(2.0, DILATION_M * float(frame.lens[0]) / middle_m)
        distance, nearest = cv2.distanceTransformWithLabels(
            (~inside).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
        )
        depth_of = np.zeros(int(nearest.max()) + 1)
        depth_of[nearest[inside]] = drawn[inside]
        fits = (frame.depth > 0) & (distance <= reach_px) & (heights > TABLE_M)
        fits &= np.abs(frame.depth - depth_of[nearest]) < FIT_M
        if tint is not None and one.colour is not None:
            same = np.linalg.norm(tint - one.colour, axis=2) < COLOUR
            fits &= same
            if lost and fits.sum() < LEFT * inside.sum():  # it is no longer there: its colour, wherever it is
                fits = same & (frame.depth > 0) & (heights > TABLE_M)
        return clean_mask(fits)


def read_clicks(path: Path) -> dict[str, Pixel]:
    """Read a file of clicks: `objects`, a mapping of names to [column, row].

    Raises:
        InputError: The file is missing or broken.
    """
    return read_model(path, ClicksFile).objects


def _measured_pixel(frame: RgbdFrame, name: str, click: Pixel) -> tuple[int, int]:
    """Return column and row of the measured pixel nearest to a click."""
    height, width = frame.depth.shape
    column, row = round(click[0]), round(click[1])
    if not (0 <= column < width and 0 <= row < height):
        raise InputError("--masks", f"the click of {name}", f"{column}, {row}", f"a pixel of {width} x {height}")
    rows, columns = np.nonzero(frame.depth > 0)
    away = np.hypot(rows - row, columns - column)
    if not len(away) or away.min() > NEAR_CLICK:
        raise InputError("--masks", f"the click of {name}", f"no depth at {column}, {row}", "a pixel with depth")
    nearest = int(away.argmin())
    return int(columns[nearest]), int(rows[nearest])


def _connected(depth: NDArray[np.float32], allowed: Mask, row: int, column: int, jump_m: float) -> Mask:
    """Return the allowed pixels that are reached from one of them without a jump of depth."""
    height, width = depth.shape
    wall = np.zeros((height + 2, width + 2), np.uint8)
    wall[1:-1, 1:-1] = ~allowed
    if wall[row + 1, column + 1]:
        return np.zeros(depth.shape, bool)
    smooth = cv2.medianBlur(np.ascontiguousarray(depth, np.float32), 3)
    cv2.floodFill(smooth, wall, (column, row), 0.0, jump_m, jump_m, 4 | (2 << 8) | cv2.FLOODFILL_MASK_ONLY)
    return np.asarray(wall[1:-1, 1:-1] == 2)


def _points(frame: RgbdFrame) -> Array:
    """Return the measured points in the camera frame, Shape=(H, W, 3) m."""
    height, width = frame.depth.shape
    fx, fy, cx, cy = frame.lens
    u, v = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    depth = frame.depth.astype(float)
    return np.stack([(u - cx) / fx * depth, (v - cy) / fy * depth, depth], axis=2)


def _heights(frame: RgbdFrame) -> Array:
    """Return the height of the measured points in the world, Shape=(H, W) m."""
    return np.asarray(_points(frame) @ frame.T_world_camera[2, :3] + frame.T_world_camera[2, 3])


def _tint(frame: RgbdFrame) -> Array | None:
    """Return the shares of red and green in all light, which shading does not change. Shape=(H, W, 2)."""
    if frame.rgb is None:
        return None
    rgb = cv2.GaussianBlur(frame.rgb, (3, 3), 0).astype(float)
    return np.asarray(rgb[..., :2] / np.maximum(rgb.sum(axis=2, keepdims=True), 1.0))
