"""A recorded scene in the format of BOP (Hodan et al., 2018): pictures, cameras, objects' models and true poses."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.mesh_file import read_mesh
from coral.contact.perception.object_model import ObjectModel, from_surface
from coral.contact.real_scenes.bop_pictures import BopPictures
from coral.contact.real_scenes.bop_records import MM, BopFiles, PictureCamera, read_symmetry, read_truth
from coral.contact.real_scenes.mesh_reduction import reduce_mesh
from coral.errors import InputError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
MOST_TRIANGLES = 3000
"""Triangles of a model that is tracked: a tracker draws it hundreds of times in a registration."""


class BopScene:
    """A folder with the files of `BopFiles`.

    Args:
        folder: The folder of the scene.
        models: The folder of the models, `obj_000001.ply` (or .obj, .stl) and so on; by default `models_eval` or
            `models`, in the scene or in one of the two folders above it.

    Raises:
        InputError: A file is missing or broken.
    """

    def __init__(self, folder: Path, models: Path | None = None) -> None:
        self.folder = folder
        self.placed = read_truth(folder / BopFiles.TRUTH)
        self._pictures = BopPictures(folder)
        self.cameras: Mapping[int, PictureCamera] = {k: self._pictures.camera(k) for k in sorted(self.placed)}
        self.models = models or self._find_models()

    @property
    def pictures(self) -> list[int]:
        """Return the indices of the pictures, in order."""
        return sorted(self.placed)

    @property
    def objects(self) -> list[int]:
        """Return the numbers of the objects that are seen."""
        return sorted({one.number for each in self.placed.values() for one in each})

    @property
    def has_depth(self) -> bool:
        """Return whether depth was recorded."""
        return self._pictures.has_depth

    def truth(self, picture: int, k: int) -> Array:
        """Return T_world_object, Shape=(4, 4), of the k-th object in a picture."""
        return self.cameras[picture].T_world_camera @ self.placed[picture][k].T_camera_object

    def read_frame(self, picture: int) -> RgbdFrame:
        """Read a picture; the k-th object in it is named `str(k)`.

        Raises:
            InputError: A file is missing or broken.
        """
        bare, count = self._pictures.read_frame(picture), len(self.placed[picture])
        instance = np.zeros(bare.depth.shape, np.uint8)
        for k in range(count):
            instance[self._read_mask(picture, k, bare.depth.shape)] = 1 + k
        return RgbdFrame(bare.depth, instance, names_of(count), bare.lens, bare.T_world_camera, bare.time_s)

    def read_bare_frame(self, picture: int) -> RgbdFrame:
        """Read a picture as a camera delivers it: depth and colours, no masks.

        Raises:
            InputError: A file is missing or broken.
        """
        return self._pictures.read_frame(picture, colours=True)

    def size(self, picture: int) -> tuple[int, int]:
        """Return height and width of a picture; see `BopPictures.size`."""
        return self._pictures.size(picture)

    def triangles(self, number: int) -> Array:
        """Read the surface of an object, Shape=(M, 3, 3) m.

        Raises:
            InputError: The file is missing or broken.
        """
        for suffix in (".ply", ".obj", ".stl"):
            path = self.models / f"obj_{number:06d}{suffix}"
            if path.is_file():
                return read_mesh(path, MM)
        raise InputError(str(self.models), "", f"no obj_{number:06d}.ply", "a model of each object")

    def model(self, number: int) -> ObjectModel:
        """Return the model that a tracker uses.

        Its symmetry is the one that `models_info.json` declares, or that of its shape.

        Raises:
            InputError: A file is missing or broken.
        """
        triangles = reduce_mesh(self.triangles(number), MOST_TRIANGLES)
        info, symmetry = self.models / BopFiles.INFO, None
        if info.is_file():
            corners = triangles.reshape(-1, 3)
            symmetry = read_symmetry(info, number, (corners.min(axis=0) + corners.max(axis=0)) / 2)
        return from_surface(f"obj {number}", triangles, symmetry)

    def _find_models(self) -> Path:
        for folder in (self.folder, *self.folder.resolve().parents[:2]):
            for name in ("models_eval", BopFiles.MODELS):
                if (folder / name).is_dir():
                    return folder / name
        raise InputError(
            str(self.folder), "", "no models", "a folder models with obj_000001.ply and so on, or --models"
        )

    def _read_mask(self, picture: int, k: int, shape: tuple[int, ...]) -> Mask:
        raw = self._pictures.read(BopFiles.MASKS, f"{picture:06d}_{k:06d}")
        if raw.shape[:2] != tuple(shape):
            found, expected = (f"{size[1]} x {size[0]}" for size in (raw.shape, shape))
            raise InputError(
                str(self.folder / BopFiles.MASKS), f"{picture:06d}_{k:06d}", found, f"{expected}, as its depth"
            )
        return np.asarray((raw if raw.ndim == 2 else raw.max(axis=2)) > 0)


def names_of(count: int) -> tuple[str, ...]:
    """Return the names of the objects in a picture."""
    return tuple(str(k) for k in range(count))
