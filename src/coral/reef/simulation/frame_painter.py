"""What gives a simulated camera's frames their colours; a wing paints them."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.plugins import our_part
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import WaterType


class FramePainter(Protocol):
    """Paints frames of one scene."""

    @property
    def water(self) -> WaterType:
        """Return the water in the pictures."""
        ...

    def paint(
        self,
        frame: Frame,
        pose: Pose,
        *,
        height: float | None = None,
        roll: float = 0.0,
        pitch: float = 0.0,
        t: float = 0.0,
        velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> NDArray[np.uint8]:
        """Paint a frame. Height (m; None: as configured), roll and pitch (rad) are the camera's, velocity the body's.

        Returns:
            Shape=(H, W, 3), sRGB.
        """
        ...


def make_painter(scene: Scene, camera: CameraCfg, water: WaterType, cfg: PainterCfg, seed: int) -> FramePainter:
    """Make the painter of a simulated camera.

    Raises:
        InputError: The wing that paints is not installed.
    """
    painter: FramePainter = our_part("painter", "reef", "--cfg.simulator.pictures")(scene, camera, water, cfg, seed)
    return painter
