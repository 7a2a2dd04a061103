"""Where the pixels of a keyframe lie on the sea floor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.reef.eyes.doubt import drop_doubtful
from coral.reef.recordings.recording import PosedFrame, Recording
from coral.reef.vehicle.camera import T_world_camera
from coral.reef.world.geometry import Frame, Label


@dataclass(frozen=True)
class SeenPoints:
    """A keyframe's pixels on a grid over the sea floor."""

    frame: Frame
    """Without pixels that are too doubtful for the map."""
    cell: NDArray[np.int64]
    """Number of the cell, iy NX + ix; -1 for none. Shape=(H, W)."""


def find_points(
    keyframe: PosedFrame, recording: Recording, cell_m: float, shape: tuple[int, int], range_m: float = math.inf
) -> SeenPoints:
    """Find the cell of a grid in which each pixel of a keyframe lies, the height of its point left out (Eq. 1).

    `range_m` is the largest distance along the line of sight (m).
    """
    frame = drop_doubtful(keyframe.frame, recording.map.doubt)
    transform, (focal, cx, cy) = transform_of(keyframe, recording), lens_of(recording)
    rows, columns = frame.depth.shape
    p, q = (np.arange(columns) - cx) / focal, ((np.arange(rows) - cy) / focal)[:, None]
    z = np.where(np.isfinite(frame.depth), frame.depth, np.float32(0.0))
    ix, iy = (
        np.floor((origin + z * (right * p + down * q + forward)) / cell_m).astype(np.int64)
        for right, down, forward, origin in transform[:2]
    )
    there = (z > 0.0) & (z * np.sqrt(1.0 + p * p + q * q) <= range_m)
    there &= (ix >= 0) & (iy >= 0) & (ix < shape[1]) & (iy < shape[0])
    return SeenPoints(frame, np.where(there, iy * shape[1] + ix, -1))


def count_looks(recording: Recording) -> NDArray[np.uint16]:
    """Return how many pictures of a located recording show each cell, within the map's range. Shape=(NY, NX)."""
    shape = grid_shape(recording, recording.map.cell_m)
    looks = np.zeros(shape, np.uint16)
    for keyframe in recording.keyframes():
        points = find_points(keyframe, recording, recording.map.cell_m, shape, recording.map.range_m)
        shown = points.cell[(points.cell >= 0) & (points.frame.labels != Label.WATER)]
        looks.flat[np.unique(shown)] += np.uint16(1)
    return looks


def grid_shape(recording: Recording, cell_m: float) -> tuple[int, int]:
    """Return (NY, NX) of a grid over a located recording's area."""
    width, height = recording.size_m
    return math.ceil(height / cell_m - 1e-9), math.ceil(width / cell_m - 1e-9)


def transform_of(keyframe: PosedFrame, recording: Recording) -> NDArray[np.float64]:
    """Return T_c^w of a keyframe, the sea floor at 0 m. Shape=(4, 4)."""
    return T_world_camera(
        keyframe.pose, recording.camera, altitude=keyframe.height_m, roll=keyframe.roll, pitch=keyframe.pitch
    )


def lens_of(recording: Recording) -> tuple[float, float, float]:
    """Return focal length and principal point of the camera (px)."""
    focal, _, cx, cy = recording.camera.intrinsics
    return focal, cx, cy
