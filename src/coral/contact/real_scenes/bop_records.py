"""The files of recorded pictures in the format of BOP (Hodan et al., 2018), and their cameras.

Lengths are millimetres there, and metres here.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Final

import numpy as np
from pydantic import AfterValidator, BaseModel, Field, ValidationError

from coral.config import Positive, Signed, read_model
from coral.contact.scene.observation import Array
from coral.contact.scene.rigid_transform import inverse_transform, pose_matrix
from coral.foreign_file import read_json
from coral.validation_errors import input_error

MM = 0.001


class BopFiles:
    """Files in the folder of a recording."""

    CAMERAS: Final = "scene_camera.json"
    """`cam_K` and `depth_scale` of each picture; `cam_R_w2c`, `cam_t_w2c` if the camera moves."""
    SHARED_CAMERA: Final = "camera.json"
    """One camera for all pictures, instead; also in a folder above."""
    DEPTH: Final = "depth"
    """Depth of each picture, 16 bits: `000000.png` and so on."""
    COLOURS: Final = "rgb"
    """Its colours, if there are any."""


def _nearest_rotation(matrix: tuple[float, ...]) -> tuple[float, ...]:
    """Return the rotation: data sets such as LM-O hold some that are off by some thousandths."""
    turn = np.reshape(matrix, (3, 3))
    left, _, right = np.linalg.svd(turn)
    nearest = left @ right
    if np.abs(turn - nearest).max() > 0.02 or np.linalg.det(nearest) < 0:
        raise ValueError("a rotation matrix, row by row")
    return tuple(nearest.ravel().tolist())


def _with_focal_lengths(matrix: tuple[float, ...]) -> tuple[float, ...]:
    if not min(matrix[0], matrix[4]) > 0.0:
        raise ValueError("focal lengths above 0")
    return matrix


Matrix = Annotated[tuple[Signed, ...], Field(min_length=9, max_length=9)]


class PictureCamera(BaseModel, frozen=True):
    """The camera of one picture."""

    cam_K: Annotated[Matrix, AfterValidator(_with_focal_lengths)]
    depth_scale: Positive = 1.0
    """Millimetres per unit of its depth picture."""
    cam_R_w2c: Annotated[Matrix, AfterValidator(_nearest_rotation)] | None = None
    cam_t_w2c: tuple[Signed, Signed, Signed] = (0.0, 0.0, 0.0)
    time_s: Signed | None = None
    """Time of the picture, which BOP does not have; None where the recording does not tell it."""

    @property
    def lens(self) -> Array:
        """Return fx, fy, cx, cy in pixels, Shape=(4,)."""
        return np.array(self.cam_K)[[0, 4, 2, 5]]

    @property
    def T_world_camera(self) -> Array:
        """Return it, Shape=(4, 4); if the recording states no pose of the camera, its frame is the world's."""
        turn = np.eye(3) if self.cam_R_w2c is None else np.reshape(self.cam_R_w2c, (3, 3))
        return inverse_transform(pose_matrix(turn, MM * np.array(self.cam_t_w2c)))


class _Cameras(BaseModel):
    pictures: dict[Annotated[int, Field(ge=0, lt=10**9)], PictureCamera]


class _SharedCamera(BaseModel):
    fx: Positive
    fy: Positive
    cx: Signed
    cy: Signed
    depth_scale: Positive = 1.0


def read_cameras(path: Path) -> dict[int, PictureCamera]:
    """Read `scene_camera.json`: the camera of each picture.

    Raises:
        InputError: The file is missing or broken.
    """
    try:
        return _Cameras(pictures=read_json(path, "a JSON file of BOP")).pictures
    except ValidationError as error:
        raise input_error(str(path), error, _Cameras) from None


def read_shared_camera(path: Path) -> PictureCamera:
    """Read `camera.json`: one camera for all pictures of a data set.

    Raises:
        InputError: The file is missing or broken.
    """
    one = read_model(path, _SharedCamera)
    return PictureCamera(cam_K=(one.fx, 0, one.cx, 0, one.fy, one.cy, 0, 0, 1), depth_scale=one.depth_scale)
