"""Depth Anything V2 as ONNX: relative inverse depth, made metric by points of known depth or by the known height."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.onnx_file import OnnxFile, open_picture_network
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.perception import CameraAttitude, RgbPerception, SeenPicture
from coral.reef.networks.network_notes import IMAGENET, read_notes
from coral.reef.networks.pixel_check import CAMERA, depth_kind, shipped_picture
from coral.reef.vehicle.camera import CameraCfg, ray_lengths
from coral.reef.world.geometry import Label

_SAME_SHAPE = 0.05
"""Share by which the proportions of a map may differ from its picture's: maps have whole pixels."""
SIZE = 252, 182
"""Width and height of its pictures where a file leaves them open (px): multiples of 14."""
FARTHEST_M = 100.0
MOST_POINTS = 2000
"""Of the floor, evenly spread over its pixels: more do not change two numbers."""
FARTHEST_FLOOR_M = 6.0
"""The sea floor gives points of known depth up to here; farther away a degree of pitch is a metre of depth."""
SURE = 0.5
"""Floor pixels with more doubt than this give no points."""
_ROUNDS, _OUTLIER = 10, 3.0
"""Rounds of reweighting; residuals beyond this multiple of their median count as outliers."""


@dataclass(frozen=True)
class ScaleShift:
    """1 / depth = scale * relative + shift."""

    scale: float
    shift: float
    error: float
    """Median error of 1 / depth at the points (1/m)."""

    def metres(self, relative: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the depth (m) of relative inverse depth, at most `FARTHEST_M`. Any shape."""
        inverse = np.maximum(self.scale * relative + self.shift, 1.0 / FARTHEST_M)
        return np.asarray(1.0 / inverse, np.float32)


def fit_scale_shift(relative: NDArray[np.float32], depth: NDArray[np.float32]) -> ScaleShift:
    """Fit scale and shift by least squares in inverse depth, reweighted so that outliers do not count (MiDaS, SPADE).

    `relative` is larger for what is nearer, `depth` is true, along the optical axis (m). Shape=(N,) each.

    Raises:
        ValueError: There are fewer than two points, all at the same relative depth, or nearer ones look farther.
    """
    good = np.isfinite(relative) & np.isfinite(depth) & (depth > 0.0)
    x, y = relative[good].astype(np.float64), 1.0 / depth[good].astype(np.float64)
    if len(x) < 2 or np.ptp(x) < 1e-9:
        raise ValueError("scale and shift need points at two relative depths")
    weight = np.ones(len(x))
    for _ in range(_ROUNDS):
        root = np.sqrt(weight)
        (scale, shift), *_ = np.linalg.lstsq(np.stack([root * x, root], axis=1), root * y, rcond=None)
        residual = np.abs(scale * x + shift - y)
        limit = max(_OUTLIER * float(np.median(residual)), 1e-9)
        weight = np.where(residual > limit, 0.05 * limit / np.maximum(residual, 1e-12), 1.0)
    if scale <= 0.0:
        raise ValueError("nearer points have a smaller relative inverse depth")
    return ScaleShift(float(scale), float(shift), float(np.median(residual)))


def is_depth(file: OnnxFile) -> bool:
    """Check whether the only output is a map of one number a pixel: (1, h, w) or (1, 1, h, w), shaped as the picture.

    Boxes of a detector are (1, rows, columns), too, but never shaped so.
    """
    if len(file.outputs) != 1:
        return False
    ((name, shape),) = file.outputs.items()
    if "int" in file.kinds.get(name, "") or not (len(shape) == 3 or (len(shape) == 4 and shape[1] == 1)):
        return False
    height, width, rows, columns = (size or 0 for size in (*file.input_shape[2:], *shape[-2:]))
    known = height * width * rows * columns
    return not known or abs(columns * height / (rows * width) - 1.0) < _SAME_SHAPE


class DepthAnything:
    """Runs Depth Anything V2, relative or metric, in any export with one picture in and one map out.

    transformers names them `pixel_values` and `predicted_depth`, other exports `image` and `depth`.
    """

    def __init__(self, file: OnnxFile) -> None:
        """Check the layout, and whether the network's map is relative or metric: larger is nearer, or farther.

        Raises:
            InputError: The file has another layout, or what is stated contradicts what it does.
        """
        shape = file.input_shape
        self.size = shape[3] or SIZE[0], shape[2] or SIZE[1]
        self.file = file = file.with_shapes_of(*self.size)
        if shape[1] not in (3, None) or not is_depth(file):
            found = ", ".join(f"{name} {of}" for name, of in (*file.inputs.items(), *file.outputs.items()))
            expected = "a picture (1, 3, height, width) in, and one map of depth (1, height, width) out"
            raise InputError(file.path, "inputs, outputs", found, expected)
        notes = read_notes(file)
        self.pixels = notes.picture_input(IMAGENET)
        rgb, _ = shipped_picture()
        kind = depth_kind(self._map(rgb, CAMERA))
        if notes.depth and kind and kind != notes.depth:
            raise InputError(file.path, "depth", f"stated as {notes.depth}", f"{kind}, as the shipped picture shows")
        self.metric = (notes.depth or kind) == "metric"
        told = "as stated" if notes.depth else "as the shipped picture shows" if kind else "as is usual"
        self.about: tuple[str, ...] = (
            f"a depth network, {'metric' if self.metric else 'relative'} {told}, {self.size[0]} x {self.size[1]}, "
            f"{self.pixels.describe()}; scale and shift are fitted to each picture",
        )

    def relative(self, rgb: NDArray[np.uint8], camera: CameraCfg) -> NDArray[np.float32]:
        """Return the relative inverse depth of a picture. Shape=(H, W)."""
        found = self._map(rgb, camera)
        return np.asarray(1.0 / np.maximum(found, np.float32(0.01)), np.float32) if self.metric else found

    def _map(self, rgb: NDArray[np.uint8], camera: CameraCfg) -> NDArray[np.float32]:
        scaled = cv2.resize(rgb, self.size, interpolation=cv2.INTER_CUBIC)
        (out,) = self.file.run(self.pixels.tensor(np.asarray(scaled, np.uint8))).values()
        found = out.reshape(out.shape[-2:])
        return np.asarray(cv2.resize(found, (camera.width, camera.height), interpolation=cv2.INTER_LINEAR), np.float32)


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
        looks, depths = relative[floor], ground[floor]
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
        far = (seen.labels == Label.WATER) | (depth * np.float32(ray_lengths(camera)) > camera.range_m)
        return SeenPicture(seen.labels, np.where(far, np.float32(np.inf), depth).astype(np.float32), seen.doubt)


def with_depth(eyes: RgbPerception, path: Path) -> RelativeDepthEyes:
    """Return eyes whose depth is that of a relative network in a file.

    Raises:
        InputError: The file cannot be used, or has another layout.
    """
    return RelativeDepthEyes(eyes, DepthAnything(open_picture_network(path, "--depth")))


def _thinned(values: NDArray[np.float32], most: int) -> NDArray[np.float32]:
    step = -(-len(values) // max(most, 1))
    return values[:: max(step, 1)]
