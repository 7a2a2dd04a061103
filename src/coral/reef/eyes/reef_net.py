"""Our own network as eyes: a picture and the sea floor's depth in; classes, depth and doubt out."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.onnx_file import OnnxFile
from coral.reef.eyes.doubt import choose_labels
from coral.reef.eyes.ground_plane import ground_depth, network_input
from coral.reef.eyes.perception import CameraAttitude, SeenPicture
from coral.reef.vehicle.camera import CameraCfg, ray_lengths
from coral.reef.world.geometry import Label

SHIPPED = Path(__file__).parent / "weights" / "reef_net.onnx"
REAL = SHIPPED.with_name("real_net.onnx")
"""The networks that come with the package: for the pictures that this package paints, and for real ones."""
WEIGHTS = REAL.with_suffix(".pt")
"""Weights of the latter, from which a training can begin."""
OUTPUTS = {"logits": 4, "depth": 1, "depth_doubt": 1}
"""Channels by name."""
MOST_PIXELS = 320 * 240
"""Pixels up to which a network that takes any size sees pictures as they are: more cost more time."""
SMALLEST_PX = 32
"""Least width and height that it sees."""
OYSTER_FROM_KEY = "oyster_from"
"""Key of a file's metadata: the probability from which a pixel is an oyster."""
OBSTACLE_FROM = 0.4
"""Probability from which a pixel is an obstacle."""


class ReefNetEyes:
    """Runs a network with the layout of `coral.reef.paint.unet`, on pictures of any size."""

    about: tuple[str, ...] = ()

    def __init__(self, file: OnnxFile, *, painted: bool = False) -> None:
        """Check the layout. Painted pictures need not be like real ones.

        Raises:
            InputError: The file has another layout.
        """
        self.file, self._painted = file, painted
        self.oyster_from = _share(file) if file.metadata.get(OYSTER_FROM_KEY) else None
        for name, channels in OUTPUTS.items():
            found = file.outputs.get(name)
            if found is None or len(found) != 4 or found[1] != channels:
                raise InputError(
                    file.path, f"outputs.{name}", found or "none", f"a map of shape (1, {channels}, height, width)"
                )
        shape = file.input_shape
        if (shape[2] is None) != (shape[3] is None):
            raise InputError(file.path, "inputs", str(shape), "a fixed height and width, or both free")
        self.fixed = None if shape[2] is None or shape[3] is None else (shape[3], shape[2])
        """Width and height of the network's own pictures (px); None where it takes any."""

    def perceive(self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude) -> SeenPicture:
        """Find classes and depth. A picture of another size or shape is scaled to fit, and so is the result."""
        out, rows, columns = self._run(rgb, camera, attitude)
        logits = np.ascontiguousarray(out["logits"][0, :, rows, columns])
        depth = out["depth"][0, 0, rows, columns]
        labels, doubt = choose_labels(logits, OBSTACLE_FROM, self.oyster_from)
        if labels.shape != (camera.height, camera.width):
            full = (camera.width, camera.height)
            labels = np.asarray(cv2.resize(labels, full, interpolation=cv2.INTER_NEAREST), np.uint8)
            doubt, depth = (
                np.asarray(cv2.resize(np.ascontiguousarray(image), full, interpolation=cv2.INTER_NEAREST), np.float32)
                for image in (doubt, depth)
            )
        far = (labels == Label.WATER) | (depth * np.float32(ray_lengths(camera)) > camera.range_m)
        depth = np.where(far, np.float32(np.inf), np.maximum(depth, np.float32(camera.near_m)))
        return SeenPicture(labels, depth.astype(np.float32), doubt, 0.0 if self._painted else _unlike(out))

    def compare(self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude) -> tuple[float, float]:
        """Return how far a picture is from real ones, and from painted ones, by a network that states both."""
        real, painted = (float(apart) for apart in self._run(rgb, camera, attitude)[0]["unlike"][0])
        return real, painted

    def _run(
        self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude
    ) -> tuple[dict[str, NDArray[np.float32]], slice, slice]:
        """Return the network's outputs, and where the picture lies in them."""
        width, height = size = self.fixed or network_size(camera)
        scale = min(width / camera.width, height / camera.height)
        inner = round(camera.width * scale), round(camera.height * scale)
        left, top = (width - inner[0]) // 2, (height - inner[1]) // 2
        same = (camera.width, camera.height) == size
        small = rgb if same else cv2.resize(rgb, inner, interpolation=cv2.INTER_AREA)
        view = camera if same else replace(camera, width=width, height=height)
        if inner != size:  # pixels stay square: what is missing of the network's picture repeats the edge
            below, beside = height - inner[1] - top, width - inner[0] - left
            small = cv2.copyMakeBorder(small, top, below, left, beside, cv2.BORDER_REPLICATE)
            focal = camera.intrinsics[0] * inner[0] / camera.width
            view = replace(view, hfov_deg=math.degrees(2.0 * math.atan(0.5 * width / focal)))
        ground = ground_depth(view, attitude.height, roll=attitude.roll, pitch=attitude.pitch)
        out = self.file.run(network_input(np.asarray(small, np.uint8), ground)[None])
        return out, slice(top, top + inner[1]), slice(left, left + inner[0])


def _unlike(out: dict[str, NDArray[np.float32]]) -> float:
    """Return 1 or more for a picture far from all real ones, or nearer to what is painted than to these."""
    if "unlike" not in out:
        return 0.0
    real, painted = (float(apart) for apart in out["unlike"][0])
    return max(real, real / max(painted, 1e-6))


def network_size(camera: CameraCfg) -> tuple[int, int]:
    """Return the width and height (px) at which a network that takes any size sees a camera's pictures.

    They stay as they are, but for those with more than `MOST_PIXELS`, which are shrunk.
    """
    scale = min(1.0, math.sqrt(MOST_PIXELS / (camera.width * camera.height)))
    width, height = (2 * math.ceil(scale * size / 2 - 1e-9) for size in (camera.width, camera.height))
    return max(width, SMALLEST_PX), max(height, SMALLEST_PX)


def _share(file: OnnxFile) -> float:
    text = file.metadata[OYSTER_FROM_KEY]
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < 1.0:
        raise InputError(file.path, f"metadata.{OYSTER_FROM_KEY}", text, "a number between 0 and 1")
    return value
