"""A recording as a camera: a folder of pictures in the format of BOP."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.bop_pictures import BopPictures
from coral.contact.real_scenes.bop_records import BopFiles
from coral.errors import InputError

Array = NDArray[np.float64]


class RecordedRgbdCamera:
    """Plays a folder that `coral contact track --export` wrote, or a scene of BOP. Masks and true poses are not read.

    Args:
        folder: The folder, with `depth`, `rgb`, and `scene_camera.json` or `camera.json`.
        T_world_camera: Shape=(4, 4); by default what the recording says.

    Raises:
        InputError: A file is missing or broken.
    """

    live = False

    def __init__(self, folder: Path, T_world_camera: Array | None = None) -> None:
        self.name = f"recording:{folder}"
        if not folder.is_dir():
            raise InputError("--camera", "", self.name, "a folder of recorded pictures")
        self._pictures, self._placed = BopPictures(folder), T_world_camera
        self._left = list(reversed(self._pictures.indices))
        if not self._left:
            raise InputError(str(folder / BopFiles.DEPTH), "", "no picture", "pictures of depth: 000000.png and so on")

    def start(self) -> None:
        """See `RgbdCamera.start`."""

    def newest(self) -> RgbdFrame | None:
        """Return the next picture; None after the last one.

        Raises:
            InputError: A picture is missing or broken.
        """
        if not self._left:
            return None
        frame = self._pictures.read_frame(self._left.pop(), colours=True)
        return frame if self._placed is None else replace(frame, T_world_camera=self._placed)

    def close(self) -> None:
        """See `RgbdCamera.close`."""
        self._left.clear()
