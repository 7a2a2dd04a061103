"""The seam between a recording's colour pictures and what is seen in them."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.geometry import Frame


class Perceive(Protocol):
    """Makes classes and metric depth of a colour picture."""

    def __call__(self, rgb: NDArray[np.uint8], *, height_m: float, roll: float, pitch: float, where: str) -> Frame:
        """Return what a picture shows.

        Args:
            rgb: The picture. Shape=(H, W, 3), sRGB.
            height_m: Height of the camera above the seabed (m).
            roll: About body x (rad).
            pitch: About body y (rad).
            where: The picture's place in the recording, for messages.
        """
        ...


def perceive_nothing(rgb: NDArray[np.uint8], *, height_m: float, roll: float, pitch: float, where: str) -> Frame:
    """Refuse: the recording itself must tell what its pictures show.

    Raises:
        InputError: Always.
    """
    raise InputError(where, "labels, depth", "colour pictures only", "pictures of classes and depth beside them")
