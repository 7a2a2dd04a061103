"""A recording as a camera: a folder of pictures in the format of BOP."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.bop_records import MM, BopFiles, PictureCamera, read_cameras, read_shared_camera
from coral.contact.real_scenes.cameras.bare_frame import bare_frame
from coral.contact.scene.observation import Array
from coral.errors import InputError
from coral.foreign_file import read_picture_file

PERIOD_S = 0.1
"""Time between pictures if the recording states none."""
SUFFIXES = (".png", ".jpg", ".tif")


class RecordedRgbdCamera:
    """Plays a scene in the format of BOP, a folder with `depth`, `rgb`, and `scene_camera.json` or `camera.json`.

    Masks and true poses are not read. By default the camera stands where the recording says.

    Raises:
        InputError: A file is missing or broken.
    """

    live = False

    def __init__(self, folder: Path, T_world_camera: Array | None = None) -> None:
        self.name, self._folder, self._placed = f"recording:{folder}", folder, T_world_camera
        if not folder.is_dir():
            raise InputError("--camera", "", self.name, "a folder of recorded pictures")
        found = {
            int(path.stem)
            for path in (folder / BopFiles.DEPTH).glob("*")
            if path.suffix in SUFFIXES and path.stem.isdecimal() and path.stem.isascii()
        }
        self._left = [(index, camera) for index, camera in _cameras(folder, found).items() if index in found]
        self._left.sort(key=lambda one: one[0], reverse=True)
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
        index, camera = self._left.pop()
        raw, bgr = self._read(BopFiles.DEPTH, index), self._read(BopFiles.COLOURS, index)
        if raw is None or raw.ndim != 2:
            found = "missing" if raw is None else f"{raw.shape[2]} channels"
            raise InputError(str(self._folder / BopFiles.DEPTH), f"{index:06d}", found, "a picture with one channel")
        depth = (raw * (MM * camera.depth_scale)).astype(np.float32)
        if bgr is not None and (bgr.shape != (*depth.shape, 3) or bgr.dtype != np.uint8):
            expected = f"{depth.shape[1]} x {depth.shape[0]} pixels with three colours, as its depth"
            found = f"an array of shape {bgr.shape}"
            raise InputError(str(self._folder / BopFiles.COLOURS), f"{index:06d}", found, expected)
        rgb = None if bgr is None else np.ascontiguousarray(bgr[..., ::-1])
        placed = camera.T_world_camera if self._placed is None else self._placed
        return bare_frame(depth, rgb, camera.lens, placed, PERIOD_S * index if camera.time_s is None else camera.time_s)

    def close(self) -> None:
        """See `RgbdCamera.close`."""
        self._left.clear()

    def _read(self, kind: str, index: int) -> NDArray[Any] | None:
        """Read a picture file; None if there is none."""
        files = (self._folder / kind / f"{index:06d}{suffix}" for suffix in SUFFIXES)
        path = next((path for path in files if path.is_file()), None)
        if path is None:
            return None
        found = read_picture_file(path)
        if found is None:
            raise InputError(str(path), "", "broken", "a picture")
        return np.asarray(found)


def _cameras(folder: Path, pictures: set[int]) -> dict[int, PictureCamera]:
    """Return the camera of each picture."""
    path = folder / BopFiles.CAMERAS
    for above in () if path.is_file() else (folder, *folder.resolve().parents[:2]):
        if (above / BopFiles.SHARED_CAMERA).is_file():
            return dict.fromkeys(pictures, read_shared_camera(above / BopFiles.SHARED_CAMERA))
    return read_cameras(path)
