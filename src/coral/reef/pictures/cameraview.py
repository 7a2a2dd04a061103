"""Pictures of one camera frame: colours, classes and depth."""

from __future__ import annotations

from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.drawing import Image, draw_text
from coral.reef.world.geometry import Frame

LABEL_COLORS: NDArray[np.uint8] = np.array([(164, 205, 230), (38, 166, 76), (33, 33, 40), (168, 165, 158)], np.uint8)
"""Colours in the order of `Label`: water pale blue, oysters green, obstacles dark, seabed gray."""
DEPTH_MAX_M = 8.0
"""Far end of the depth colours; a fixed scale keeps pictures of one mission comparable."""
CLASS_SHARE = 0.5
"""How strongly classes are drawn over the colour picture."""
Kind = Literal["colour", "segmentation", "depth"]
NOTHING: tuple[int, int, int] = (14, 16, 28)


_RAMP = np.linspace(245, 20, 256).astype(np.uint8).reshape(-1, 1)
DEPTH_PALETTE = np.asarray(cv2.applyColorMap(_RAMP, cv2.COLORMAP_VIRIDIS)[:, 0, ::-1], np.uint8)
"""Near bright to far dark, perceptually uniform; the last one is for nothing. Shape=(256, 3), RGB."""
DEPTH_PALETTE[255] = NOTHING


def depth_levels(depth: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Map depth (m, inf or 0 without a measurement) to indices into `DEPTH_PALETTE`. Shape=(H, W)."""
    seen = np.isfinite(depth) & (depth > 0)
    levels = np.clip(np.where(seen, depth, 0) * (254 / DEPTH_MAX_M), 0, 254)
    return np.where(seen, levels, 255).astype(np.uint8)


def camera_picture(frame: Frame, kind: Kind = "segmentation", size: tuple[int, int] = (640, 480)) -> Image:
    """Draw a frame of the front camera. Shape=(size[1], size[0], 3) RGB.

    Args:
        frame: The camera frame.
        kind: "colour" (what the camera took), "segmentation" (green oysters, gray seabed, dark obstacles, blue water;
            drawn over the colour picture if there is one) or "depth" (bright near, dark far, with a scale in metres).
        size: Width and height (px).

    Raises:
        ValueError: The frame has no colours, and the colour picture is asked for.
    """
    if kind == "colour":
        if frame.rgb is None:
            raise ValueError("the frame has no colour picture")
        return np.asarray(cv2.resize(frame.rgb, size, interpolation=cv2.INTER_CUBIC), np.uint8)
    if kind == "segmentation" and frame.rgb is not None:
        classes = cv2.resize(LABEL_COLORS[frame.labels], size, interpolation=cv2.INTER_NEAREST)
        below = camera_picture(frame, "colour", size)
        return np.asarray(cv2.addWeighted(classes, CLASS_SHARE, below, 1.0 - CLASS_SHARE, 0.0), np.uint8)
    if kind == "segmentation":
        return np.asarray(cv2.resize(LABEL_COLORS[frame.labels], size, interpolation=cv2.INTER_NEAREST), np.uint8)
    levels = DEPTH_PALETTE[depth_levels(frame.depth)]
    picture = np.asarray(cv2.resize(levels, size, interpolation=cv2.INTER_NEAREST), np.uint8)
    _metre_scale(picture)
    return picture


def _metre_scale(rgb: Image) -> None:
    height, width = rgb.shape[:2]
    unit = max(8, height // 40)
    length, x, y = width // 2, width // 4, height - 3 * unit
    rgb[y - unit // 2 - unit // 3 :, x - 2 * unit : x + length + 5 * unit] = (250, 250, 250)
    ramp = DEPTH_PALETTE[np.linspace(0, 254, length).astype(np.uint8)]
    rgb[y - unit // 2 : y + unit // 2, x : x + length] = ramp
    for metres in range(0, int(DEPTH_MAX_M) + 1, 2):
        column = x + length * metres / DEPTH_MAX_M
        name = f"{metres} m" if metres == int(DEPTH_MAX_M) else str(metres)
        draw_text(rgb, name, column, y + 1.55 * unit, size=round(1.25 * unit), color=(30, 34, 42), anchor="mm")
