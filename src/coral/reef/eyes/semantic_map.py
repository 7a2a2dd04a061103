"""A user's semantic network as eyes: a map of class logits, with depth or without."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.onnx_file import OnnxFile
from coral.reef.eyes.doubt import choose_labels
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.perception import CameraAttitude, SeenPicture
from coral.reef.eyes.reef_net import OBSTACLE_FROM
from coral.reef.eyes.standing_depth import standing_depth
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label

CLASSES = len(Label)


class SemanticEyes:
    """Runs a network that maps RGB from 0 to 1, Shape=(1, 3, H, W), to logits in the order of `Label`.

    The output `logits` has Shape=(1, 4, h, w); a metric `depth`, Shape=(1, 1, h, w), is optional. Without it
    depth follows from the camera's height.
    """

    def __init__(self, file: OnnxFile, obstacle_from: float = OBSTACLE_FROM) -> None:
        """Check the layout.

        Raises:
            InputError: The file has another layout.
        """
        self.file, self.obstacle_from = file, obstacle_from
        for name, channels, needed in (("logits", CLASSES, True), ("depth", 1, False)):
            found = file.outputs.get(name)
            if (found is None and needed) or (
                found is not None and (len(found) != 4 or found[1] not in (channels, None))
            ):
                raise InputError(
                    file.path,
                    f"outputs.{name}",
                    found or f"only {', '.join(file.outputs)}",
                    f"a map of shape (1, {channels}, height, width)",
                )

    def perceive(self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude) -> SeenPicture:
        """Find classes and depth; pictures are scaled to the network's size, and results back."""
        height, width = self.file.input_shape[2] or camera.height, self.file.input_shape[3] or camera.width
        small = cv2.resize(rgb, (width, height), interpolation=cv2.INTER_AREA)
        out = self.file.run(np.ascontiguousarray(small.transpose(2, 0, 1)[None], np.float32) / np.float32(255.0))
        logits = resize_channels(out["logits"][0], camera)
        labels, doubt = choose_labels(logits, self.obstacle_from)
        if "depth" in out:
            depth = resize_channels(out["depth"][0], camera)[0]
        else:
            ground = ground_depth(camera, attitude.height, roll=attitude.roll, pitch=attitude.pitch)
            depth = standing_depth(labels, ground)
        depth = np.where((labels == Label.WATER) | ~(depth > 0.0), np.float32(np.inf), depth)
        return SeenPicture(labels, depth.astype(np.float32), doubt)


def resize_channels(maps: NDArray[np.float32], camera: CameraCfg) -> NDArray[np.float32]:
    """Scale maps to the camera's size. Shape=(C, h, w) to (C, H, W)."""
    if maps.shape[1:] == (camera.height, camera.width):
        return maps
    size = (camera.width, camera.height)
    return np.stack([cv2.resize(one, size, interpolation=cv2.INTER_LINEAR) for one in maps]).astype(np.float32)
