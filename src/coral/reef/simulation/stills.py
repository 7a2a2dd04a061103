"""Colour pictures of a simulated reef: what paints a camera's frames, and stills of full size for questions."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.plugins import our_part
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import WaterType

STILL_PX = (1280, 960)
"""Width and height of a still: of the camera's shape, as small as a person can tell kinds from at 4 m."""


def make_painter(scene: Scene, camera: CameraCfg, water: WaterType, cfg: PainterCfg, seed: int) -> Any:
    """Make the painter of a simulated camera, the `Painter` of `coral.reef.paint.painter`, which is a wing.

    Raises:
        InputError: The wing is not installed.
    """
    return our_part("painter", "reef", "--cfg.simulator.pictures")(scene, camera, water, cfg, seed)


class Stills:
    """Takes stills of a simulated reef."""

    def __init__(self, scene: Scene, camera: CameraCfg, water: WaterType, painter: PainterCfg, seed: int) -> None:
        """Set up; the painter is made with the first still, since it takes a while. Stills are large pictures."""
        self._scene, self._camera = scene, replace(camera, width=STILL_PX[0], height=STILL_PX[1])
        self._make = partial(make_painter, scene, self._camera, water, painter, seed)
        self._painter: Any = None

    def make_ready(self) -> Stills:
        """Make the painter and take a first still, before time matters; seconds."""
        self._take(Pose(0.0, 0.0, 0.0), 0.0)
        return self

    def of(self, frame: Frame, pose: Pose, t: float) -> Frame:
        """Return a picture taken at `t` (s) that can be asked for its still. Deterministic: it need not be at once."""
        return replace(frame, still=partial(self._take, pose, t))

    def _take(self, pose: Pose, t: float) -> NDArray[np.uint8]:
        if self._painter is None:
            self._painter = self._make()
        frame = Camera(self._scene, self._camera).render(pose, t=t)
        return np.asarray(self._painter.paint(frame, pose, t=t), np.uint8)
