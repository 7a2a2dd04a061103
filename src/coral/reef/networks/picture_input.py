"""How a network wants its pictures: order of the channels and scaling of the values."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class PictureInput:
    """value = (byte * factor - mean) / spread, by channel."""

    name: str
    """Of the scaling, for people."""
    factor: float = 1.0 / 255.0
    mean: tuple[float, float, float] = (0.0, 0.0, 0.0)
    spread: tuple[float, float, float] = (1.0, 1.0, 1.0)
    bgr: bool = False
    """Blue first; mean and spread are in the order of the channels."""

    def tensor(self, rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
        """Return a picture as a network reads it. Shape=(H, W, 3), red first, to (1, 3, H, W)."""
        ordered = rgb[:, :, ::-1] if self.bgr else rgb
        scaled = ordered.astype(np.float32) * np.float32(self.factor)
        values = (scaled - np.array(self.mean, np.float32)) / np.array(self.spread, np.float32)
        return np.ascontiguousarray(values.transpose(2, 0, 1)[None])

    def describe(self) -> str:
        """Say it in a few words."""
        return f"{'BGR' if self.bgr else 'RGB'}, {self.name}"


UNIT = PictureInput("0 to 1")
BYTES = PictureInput("0 to 255", factor=1.0)
IMAGENET = PictureInput("normalised as ImageNet", mean=(0.485, 0.456, 0.406), spread=(0.229, 0.224, 0.225))
SCALINGS = {"unit": UNIT, "bytes": BYTES, "imagenet": IMAGENET}
"""By the name that a user states."""
