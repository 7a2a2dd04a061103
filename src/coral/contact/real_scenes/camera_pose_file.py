"""Where a camera stands, as a file for `--camera-pose`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel

from coral.config import Signed, read_model
from coral.contact.scene.geometry import pose_matrix, rotation_of
from coral.contact.scene.observation import Array


def _of_length_1(quaternion: tuple[float, ...]) -> tuple[float, ...]:
    if not 0.99 < np.linalg.norm(quaternion) < 1.01:
        raise ValueError("(w, x, y, z) of length 1")
    return quaternion


class CameraPoseFile(BaseModel, frozen=True, extra="forbid"):
    """Where a camera stands."""

    format: Literal["coral-camera-pose/1"]
    position_m: tuple[Signed, Signed, Signed]
    """In the world."""
    quaternion: Annotated[tuple[Signed, Signed, Signed, Signed], AfterValidator(_of_length_1)]
    """Of its optical frame (x right, y down, z forward): (w, x, y, z)."""
    method: str = ""
    """How it was found."""
    residuals: dict[str, float] = {}
    """What the fit left, by name with unit."""


def read_camera_pose(path: Path) -> Array:
    """Read T_world_camera, Shape=(4, 4).

    Raises:
        InputError: The file is missing or broken.
    """
    found = read_model(path, CameraPoseFile)
    quaternion = np.array(found.quaternion)
    return pose_matrix(rotation_of(quaternion / np.linalg.norm(quaternion)), np.array(found.position_m))
