"""Pictures of a live camera as those of the camera that the robot reckons with: rectified, and small."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.sea.recorded_camera import RecordedCamera, read_camera
from coral.reef.vehicle.camera import CameraCfg

ALIKE = 0.02
"""Relative difference of two pictures' proportions that makes no difference."""
WIDEST_PX = 320
"""Wider pictures are reduced to this: eyes and map keep a camera's rate with it. Twice what the networks here see."""


@dataclass(frozen=True)
class LiveView:
    """A calibrated camera under way."""

    recorded: RecordedCamera
    camera: CameraCfg
    """The camera that `picture` returns pictures of."""

    @classmethod
    def of_file(cls, path: Path) -> LiveView:
        """Read a camera file.

        Raises:
            InputError: It is no camera file.
        """
        recorded = read_camera(path)
        view = recorded.view
        if view.width > WIDEST_PX:
            view = replace(view, width=WIDEST_PX, height=max(2, round(view.height * WIDEST_PX / view.width)))
        return cls(recorded, view)

    def picture(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return a picture of the camera rectified and reduced. Shape=(H, W, 3).

        Raises:
            ValueError: It has another size than the camera file says.
        """
        size = (rgb.shape[1], rgb.shape[0])
        if size != self.recorded.size:
            width, height = self.recorded.size
            raise ValueError(f"pictures of {size[0]}x{size[1]} px, where the camera file says {width}x{height}")
        if self.recorded.rectifier is not None:
            rgb = self.recorded.rectifier.colours(rgb)
        return resized(rgb, self.camera)


def resized(rgb: NDArray[np.uint8], camera: CameraCfg) -> NDArray[np.uint8]:
    """Return a picture in the size of a camera with the same view. Shape=(H, W, 3).

    Raises:
        ValueError: It has other proportions: then it is not of this camera.
    """
    height, width = rgb.shape[:2]
    if abs(width * camera.height / (height * camera.width) - 1.0) > ALIKE:
        raise ValueError(
            f"pictures of {width}x{height} px, where the camera is configured with {camera.width}x{camera.height}: "
            "give its size and lens by --lens camera.yaml"
        )
    if (width, height) == (camera.width, camera.height):
        return rgb
    return np.asarray(cv2.resize(rgb, (camera.width, camera.height), interpolation=cv2.INTER_AREA), np.uint8)
