"""Fits a picture into a network's square without changing its proportions, and maps of the square back."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

GRAY = 114
"""Of the border; the value that YOLO networks are trained with."""


@dataclass(frozen=True)
class Letterbox:
    """Where a picture lies in the network's picture: scaled, in the middle, with a gray border."""

    width: int
    height: int
    """Of the camera's picture (px)."""
    net_width: int
    net_height: int

    @property
    def scale(self) -> float:
        """Pixels of the network for one of the camera."""
        return min(self.net_width / self.width, self.net_height / self.height)

    @property
    def inner(self) -> tuple[int, int]:
        """Width and height of the scaled picture (px)."""
        return round(self.width * self.scale), round(self.height * self.scale)

    @property
    def corner(self) -> tuple[int, int]:
        """First column and row of the scaled picture."""
        width, height = self.inner
        return (self.net_width - width) // 2, (self.net_height - height) // 2

    def insert(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return the network's picture. Shape=(H, W, 3) to (net_height, net_width, 3)."""
        (x, y), (width, height) = self.corner, self.inner
        out = np.full((self.net_height, self.net_width, 3), GRAY, np.uint8)
        out[y : y + height, x : x + width] = cv2.resize(rgb, (width, height), interpolation=cv2.INTER_LINEAR)
        return out

    def extract(self, image: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the camera's part of a map of the network's picture, perhaps coarser, at the camera's size."""
        rows, columns = image.shape
        fx, fy = columns / self.net_width, rows / self.net_height
        (x, y), (width, height) = self.corner, self.inner
        # Middle of each of the camera's pixels in the map, with whole numbers at the middles of its pixels.
        u = ((np.arange(self.width) + 0.5) * width / self.width + x) * fx - 0.5
        v = ((np.arange(self.height) + 0.5) * height / self.height + y) * fy - 0.5
        grid_u, grid_v = np.meshgrid(u.astype(np.float32), v.astype(np.float32))
        out = cv2.remap(image, grid_u, grid_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(out, np.float32)
