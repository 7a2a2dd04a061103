"""Eyes whose depth comes from Depth Anything V2, made metric by a sonar's echoes and the sea floor."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.reef.eyes.ground_plane import ground_depth, ray_lengths
from coral.reef.eyes.perception import CameraAttitude, RgbPerception, SeenPicture
from coral.reef.eyes.relative_depth import DepthAnything, fit_scale_shift, floor_points
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label

MOST_POINTS = 2000
"""Of the floor, evenly spread over its pixels: more do not change two numbers."""
FARTHEST_FLOOR_M = 6.0
"""The sea floor gives points of known depth up to here; farther away a degree of pitch is a metre of depth."""
SURE = 0.5
"""Floor pixels with more doubt than this give no points."""


class RelativeDepthEyes:
    """Classes by other eyes, depth by a relative network. Scale and shift are fitted anew to every picture."""

    def __init__(self, eyes: RgbPerception, network: DepthAnything) -> None:
        self.eyes, self.network = eyes, network
        self.about: tuple[str, ...] = (*eyes.about, *network.about)

    def perceive(self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude) -> SeenPicture:
        """Find classes and depth. Where nothing gives scale and shift, depth is that of the other eyes."""
        seen = self.eyes.perceive(rgb, camera, attitude)
        relative = self.network.relative(rgb, camera)
        ground = ground_depth(camera, attitude.height, roll=attitude.roll, pitch=attitude.pitch)
        floor = (seen.labels == Label.SEABED) & (seen.doubt <= SURE) & (ground <= FARTHEST_FLOOR_M)
        looks, depths = floor_points(relative, floor, ground)
        echoes = attitude.echoes
        if echoes is not None and len(echoes):
            at = np.round(echoes[:, :2]).astype(np.intp)
            # As many points of the floor as echoes: the floor is a plane by assumption, the echoes were measured.
            looks, depths = _thinned(looks, len(echoes)), _thinned(depths, len(echoes))
            looks = np.concatenate([looks, relative[at[:, 1], at[:, 0]]])
            depths = np.concatenate([depths, echoes[:, 2]])
        try:
            fit = fit_scale_shift(_thinned(looks, MOST_POINTS), _thinned(depths, MOST_POINTS))
        except ValueError:
            return seen
        depth = np.maximum(fit.metres(relative), np.float32(camera.near_m))
        far = (seen.labels == Label.WATER) | (depth * ray_lengths(camera) > camera.range_m)
        return SeenPicture(seen.labels, np.where(far, np.float32(np.inf), depth).astype(np.float32), seen.doubt)


def _thinned(values: NDArray[np.float32], most: int) -> NDArray[np.float32]:
    step = -(-len(values) // max(most, 1))
    return values[:: max(step, 1)]
