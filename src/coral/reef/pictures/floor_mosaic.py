"""The sea floor from above, put together picture by picture from a camera that looks at a slant."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.drawing import Image
from coral.reef.map.belief import Belief
from coral.reef.pictures.mosaic_kernels import paint
from coral.reef.pictures.things import stretched
from coral.reef.vehicle.camera import CameraCfg, T_world_camera

CELL_PX = 2
"""Pixels of a question's mosaic along a cell of the map."""
RANGE_M = 3.5
"""Beyond this distance a picture gives a question's mosaic no colour: water and slant leave little of it."""
SHADE_SHARE = 0.05


class FloorMosaic:
    """Each point of the flat floor takes its detail from the picture that shows it best, its shade from all.

    Differences of light and exposure fade across seams (two bands, as Brown and Lowe, Automatic panoramic image
    stitching, 2007, blend more of them). What stands on the floor leans away from the camera that saw it, as in every
    orthomosaic without a surface model.
    """

    def __init__(self, shape: tuple[int, int], pixel_m: float, camera: CameraCfg, range_m: float) -> None:
        """Begin with `shape` (MY, MX) pixels, row 0 in the south; no picture gives a colour beyond `range_m`."""
        self.pixel_m, self.camera, self.range_m = pixel_m, camera, range_m
        self._best, self._weight = np.full(shape, np.inf, np.float32), np.zeros(shape, np.float32)
        self._shade, self._fine = np.zeros((*shape, 3), np.float32), np.zeros((*shape, 3), np.float32)

    def add(
        self,
        rgb: NDArray[np.uint8],
        depth: NDArray[np.float32],
        transform: NDArray[np.float64],
        shade_share: float = SHADE_SHARE,
    ) -> None:
        """Add a picture, Shape=(H, W, 3), of any size of the camera's shape, with its depth (m), Shape=(H, W).

        `transform` is T_c^w, the floor at 0 m, Shape=(4, 4); for `shade_share` see `split_bands`.
        """
        coarse, detail = split_bands(rgb, shade_share)
        fx, _, cx, cy = self.camera.intrinsics
        scale = rgb.shape[1] / self.camera.width
        lens = (scale * fx, scale * (cx + 0.5) - 0.5, scale * (cy + 0.5) - 0.5)
        paint(
            coarse, detail, depth, transform, lens, 0.0, self.range_m, self.camera.near_m, self.pixel_m,
            self._best, self._weight, self._shade, self._fine,
        )  # fmt: skip

    @property
    def rgba(self) -> NDArray[np.uint8]:
        """The floor; transparent where nothing was seen. Shape=(MY, MX, 4), row 0 in the south."""
        seen = np.isfinite(self._best)
        mean = self._shade / np.maximum(self._weight, 1e-12)[:, :, None] + self._fine
        rgb = np.round(np.clip(mean, 0.0, 255.0)).astype(np.uint8)
        rgb[~seen] = 0
        return np.dstack([rgb, np.where(seen, 255, 0).astype(np.uint8)])


def split_bands(rgb: NDArray[np.uint8], share: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Split a picture, Shape=(H, W, 3), into its shade and its detail, which add up to it. Shape=(H, W, 3) each.

    The shade is by a Gaussian, `share` of the picture's width wide (standard deviation); 0: all is detail.
    """
    picture = rgb.astype(np.float32)
    if share <= 0.0:
        return np.zeros_like(picture), picture
    coarse = np.asarray(cv2.GaussianBlur(picture, (0, 0), max(share * rgb.shape[1], 0.5)), np.float32)
    return coarse, picture - coarse


def seen_floor(belief: Belief) -> Image | None:
    """Return the floor as the robot has seen it, `CELL_PX` pixels to a cell; gray where it has not been near.

    Row 0 in the south, Shape=(CELL_PX H, CELL_PX W, 3); None if there are no colour pictures.
    """
    cells, camera = belief.map, belief.map.camera
    height, width = cells.target.shape
    shape = (CELL_PX * height, CELL_PX * width)
    mosaic = FloorMosaic(shape, cells.cfg.cell_m / CELL_PX, camera, RANGE_M)
    if not belief.glimpses.kept:
        return None
    for glimpse in belief.glimpses.kept:
        size = glimpse.picture.shape[1::-1]
        depth = cv2.resize(glimpse.depth, size, interpolation=cv2.INTER_NEAREST)
        mosaic.add(glimpse.picture, np.asarray(depth, np.float32), T_world_camera(glimpse.pose, camera))
    rgba = mosaic.rgba
    seen = rgba[..., 3] > 0
    floor = np.full((*shape, 3), 235, np.uint8)
    if seen.any():
        floor[seen] = stretched(rgba[seen][None, :, :3])[0]
    return floor
