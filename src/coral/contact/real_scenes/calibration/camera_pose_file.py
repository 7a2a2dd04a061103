"""Files of poses: where a camera stands (`coral contact calibrate` writes it), and the hand's with a board in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, Field

from coral.config import Signed, read_model
from coral.contact.scene.geometry import pose_matrix, quaternion_of, rotation_of
from coral.contact.scene.observation import Array
from coral.errors import InputError
from coral.file_writer import write_whole
from coral.yaml_file import to_yaml

Place = tuple[Signed, Signed, Signed]


def _of_length_1(quaternion: tuple[float, ...]) -> tuple[float, ...]:
    if not 0.99 < np.linalg.norm(quaternion) < 1.01:
        raise ValueError("(w, x, y, z) of length 1")
    return quaternion


Quaternion = Annotated[tuple[Signed, Signed, Signed, Signed], AfterValidator(_of_length_1)]


class CameraPoseFile(BaseModel, frozen=True, extra="forbid"):
    """Where a camera stands."""

    format: Literal["coral-camera-pose/1"]
    position_m: Place
    quaternion: Quaternion
    """Of its optical frame (x right, y down, z forward): (w, x, y, z)."""
    method: str = ""
    """How it was found."""
    residuals: dict[str, float] = {}
    """What the fit left, by name with unit."""


@dataclass(frozen=True)
class CameraCalibration:
    """A fit of where a camera stands."""

    T_world_camera: Array
    """Shape=(4, 4)."""
    residuals: Mapping[str, float]
    """What the fit left, by name with unit."""


class HandPose(BaseModel, frozen=True, extra="forbid"):
    """Where the tool is."""

    position: Place
    quaternion: Quaternion


class HandPosesFile(BaseModel, frozen=True, extra="forbid"):
    """One pose for each picture of a board."""

    poses: Annotated[tuple[HandPose, ...], Field(min_length=1)]


def write_camera_pose(path: Path, found: CameraCalibration, method: str) -> None:
    """Write where a camera stands; see `CameraPoseFile`.

    Raises:
        InputError: Something is at the path already.
    """
    if path.exists():
        raise InputError("--out", "", str(path), "a new file")
    content = {
        "format": "coral-camera-pose/1",
        "position_m": [round(float(value), 6) for value in found.T_world_camera[:3, 3]],
        "quaternion": [round(float(value), 8) for value in quaternion_of(found.T_world_camera[:3, :3])],
        "method": method,
        "residuals": {name: round(float(value), 4) for name, value in found.residuals.items()},
    }
    write_whole(path, to_yaml(content))


def read_camera_pose(path: Path) -> Array:
    """Read T_world_camera, Shape=(4, 4).

    Raises:
        InputError: The file is missing or broken.
    """
    found = read_model(path, CameraPoseFile)
    return _pose(found.position_m, found.quaternion)


def read_hand_poses(path: Path) -> list[Array]:
    """Read T_world_tool, Shape=(4, 4), of each picture.

    Raises:
        InputError: The file is missing or broken.
    """
    return [_pose(one.position, one.quaternion) for one in read_model(path, HandPosesFile).poses]


def _pose(position: tuple[float, ...], quaternion: tuple[float, ...]) -> Array:
    return pose_matrix(rotation_of(np.array(quaternion) / np.linalg.norm(quaternion)), np.array(position))
