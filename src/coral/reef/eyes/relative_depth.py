"""Depth Anything V2 as ONNX: relative inverse depth, made metric by points of known depth or by the known height."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.onnx_file import OnnxFile
from coral.reef.vehicle.camera import CameraCfg

_MEAN, _SPREAD = np.array([0.485, 0.456, 0.406], np.float32), np.array([0.229, 0.224, 0.225], np.float32)
"""Of ImageNet, by which these networks' inputs are normalised."""
_PATCH = 14
"""Sizes are multiples of the transformer's patch."""
_ROUNDS, _OUTLIER = 10, 3.0
"""Rounds of reweighting; residuals beyond this multiple of their median count as outliers."""


@dataclass(frozen=True)
class ScaleShift:
    """1 / depth = scale * relative + shift."""

    scale: float
    shift: float
    error: float
    """Median error of 1 / depth at the points (1/m)."""

    def metres(self, relative: NDArray[np.float32], farthest_m: float = 100.0) -> NDArray[np.float32]:
        """Return the depth (m) of relative inverse depth, at most `farthest_m`. Any shape."""
        inverse = np.maximum(self.scale * relative + self.shift, 1.0 / farthest_m)
        return np.asarray(1.0 / inverse, np.float32)


def fit_scale_shift(relative: NDArray[np.float32], depth: NDArray[np.float32]) -> ScaleShift:
    """Fit scale and shift by least squares in inverse depth, reweighted so that outliers do not count (MiDaS, SPADE).

    Args:
        relative: Relative inverse depth at the points; larger is nearer. Shape=(N,).
        depth: True depth along the optical axis there (m), as by a sonar. Shape=(N,).

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


def floor_points(
    relative: NDArray[np.float32], floor: NDArray[np.bool_], ground: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return points of known depth from the height alone: pixels of the sea floor, at the depth of its plane.

    Args:
        relative: Relative inverse depth. Shape=(H, W).
        floor: Pixels that show the sea floor. Shape=(H, W).
        ground: Of `ground_depth`. Shape=(H, W).

    Returns:
        Arguments of `fit_scale_shift`. Shape=(N,) each.
    """
    chosen = floor & np.isfinite(ground)
    return relative[chosen], ground[chosen]


class DepthAnything:
    """Runs Depth Anything V2: `pixel_values` in, `predicted_depth` out."""

    def __init__(self, file: OnnxFile, size: tuple[int, int] = (252, 182)) -> None:
        """Check the layout.

        Args:
            file: The network.
            size: Width and height of its pictures where the file leaves them open (px), multiples of 14.

        Raises:
            InputError: The file has another layout.
        """
        for kind, names, name in (
            ("inputs", file.inputs, "pixel_values"),
            ("outputs", file.outputs, "predicted_depth"),
        ):
            if name not in names:
                raise InputError(file.path, kind, ", ".join(names), name)
        shape = file.input_shape
        self.file, self.size = file, (shape[3] or size[0], shape[2] or size[1])
        if any(n % _PATCH for n in self.size):
            raise InputError(
                file.path, "inputs.pixel_values", self.size, f"a width and height of multiples of {_PATCH}"
            )

    def relative(self, rgb: NDArray[np.uint8], camera: CameraCfg) -> NDArray[np.float32]:
        """Return the relative inverse depth of a picture. Shape=(H, W)."""
        scaled = cv2.resize(rgb, self.size, interpolation=cv2.INTER_CUBIC).astype(np.float32) / np.float32(255.0)
        tensor = ((scaled - _MEAN) / _SPREAD).transpose(2, 0, 1)[None]
        out = self.file.run(np.ascontiguousarray(tensor, np.float32))["predicted_depth"]
        relative = out.reshape(out.shape[-2:])
        return np.asarray(
            cv2.resize(relative, (camera.width, camera.height), interpolation=cv2.INTER_LINEAR), np.float32
        )
