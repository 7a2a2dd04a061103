"""The pictures and cameras of a recording in the format of BOP (Hodan et al., 2018)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.bop_records import MM, BopFiles, PictureCamera, read_cameras, read_shared_camera
from coral.errors import InputError
from coral.foreign_file import read_picture_file

PERIOD_S = 0.1
"""Time between pictures if the recording states none."""
SUFFIXES = (".png", ".jpg", ".tif")


class BopPictures:
    """A folder with pictures in `depth` and `rgb`, and `scene_camera.json`, or `camera.json` for all pictures.

    Args:
        folder: The folder of the recording.

    Raises:
        InputError: A file is missing or broken.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._shared: PictureCamera | None = None
        self._cameras: dict[int, PictureCamera] = {}
        path = folder / BopFiles.CAMERAS
        if not path.is_file():
            for above in (folder, *folder.resolve().parents[:2]):
                if (above / BopFiles.SHARED_CAMERA).is_file():
                    self._shared = read_shared_camera(above / BopFiles.SHARED_CAMERA)
                    return
        self._cameras = read_cameras(path)

    @property
    def indices(self) -> list[int]:
        """Return the indices of the pictures of which depth was recorded, in order."""
        found = {
            int(path.stem)
            for path in (self.folder / BopFiles.DEPTH).glob("*")
            if path.suffix in SUFFIXES and path.stem.isdecimal() and path.stem.isascii()
        }
        return sorted(found if self._shared is not None else found & set(self._cameras))

    def camera(self, picture: int) -> PictureCamera:
        """Return the camera of a picture.

        Raises:
            InputError: There is none.
        """
        found = self._cameras.get(picture, self._shared)
        if found is None:
            where = str(self.folder / BopFiles.CAMERAS)
            raise InputError(where, str(picture), "missing", "a camera of each picture")
        return found

    def read_frame(self, picture: int, *, colours: bool = False) -> RgbdFrame:
        """Read a picture; nothing in it has a name.

        Args:
            picture: Its index.
            colours: Whether to read its colours too, if there are any.

        Raises:
            InputError: A file is missing or broken.
        """
        camera, stem = self.camera(picture), f"{picture:06d}"
        raw = self._read(BopFiles.DEPTH, stem)
        if raw.ndim != 2:
            raise InputError(str(self.folder / BopFiles.DEPTH), stem, f"{raw.shape[2]} channels", "one channel")
        depth = (raw * (MM * camera.depth_scale_mm)).astype(np.float32)
        rgb = None
        if colours and self._path(BopFiles.COLOURS, stem) is not None:
            bgr = self._read(BopFiles.COLOURS, stem)
            if bgr.shape != (*depth.shape, 3) or bgr.dtype != np.uint8:
                expected = f"{depth.shape[1]} x {depth.shape[0]} pixels with three colours, as its depth"
                raise InputError(str(self.folder / BopFiles.COLOURS), stem, f"an array of shape {bgr.shape}", expected)
            rgb = np.ascontiguousarray(bgr[..., ::-1])
        time_s = PERIOD_S * picture if camera.time_s is None else camera.time_s
        nothing = np.zeros(depth.shape, np.uint8)
        return RgbdFrame(depth, nothing, (), camera.lens, camera.T_world_camera, time_s, rgb)

    def _read(self, kind: str, stem: str) -> NDArray[Any]:
        """Read a picture file.

        Args:
            kind: Its folder.
            stem: Its name without suffix.

        Raises:
            InputError: It is missing or broken.
        """
        path = self._path(kind, stem)
        found = None if path is None else read_picture_file(path)
        if found is None:
            raise InputError(str(self.folder / kind), stem, "missing" if path is None else "broken", "a PNG picture")
        return np.asarray(found)

    def _path(self, kind: str, stem: str) -> Path | None:
        found = (self.folder / kind / f"{stem}{suffix}" for suffix in SUFFIXES)
        return next((path for path in found if path.is_file()), None)
