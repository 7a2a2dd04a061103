"""The interface of what segments objects in pictures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


class MaskSource(Protocol):
    """Finds the pixels of known objects in one picture after the other."""

    def segment(self, frame: RgbdFrame, poses: Mapping[str, Array]) -> Mapping[str, Mask]:
        """Segment a picture.

        Args:
            frame: The picture; masks that it may hold are not read.
            poses: The last T_world_object, Shape=(4, 4), of each object that is tracked; lost ones are missing.

        Returns:
            The masks by name, Shape=(H, W) each; objects that were not found may be missing.

        Raises:
            InputError: The picture lacks colours that are needed.
        """
        ...
