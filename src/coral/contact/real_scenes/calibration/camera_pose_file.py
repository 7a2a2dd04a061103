"""The file that says where a camera stands, which `coral contact calibrate` writes and `--camera-pose` reads."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.config import read_yaml
from coral.contact.scene.geometry import quaternion_of, rotation_of
from coral.contact.scene.rigid_transform import pose_matrix
from coral.errors import MALFORMED, InputError
from coral.file_writer import write_whole
from coral.yaml_file import to_yaml

Array = NDArray[np.float64]
FORMAT = "coral-camera-pose/1"
KEYS = ("format", "position_m", "quaternion", "method", "residuals")


def write_camera_pose(path: Path, T_world_camera: Array, method: str, residuals: Mapping[str, float]) -> None:
    """Write where a camera stands.

    Args:
        path: A new file.
        T_world_camera: Shape=(4, 4), optical frame (x right, y down, z forward) to world.
        method: How it was found.
        residuals: What the fit left, by name with unit.

    Raises:
        InputError: Something is at the path already.
    """
    if path.exists():
        raise InputError("--out", "", str(path), "a new file")
    content: dict[str, Any] = {
        "format": FORMAT,
        "position_m": [round(float(value), 6) for value in T_world_camera[:3, 3]],
        "quaternion": [round(float(value), 8) for value in quaternion_of(T_world_camera[:3, :3])],
        "method": method,
        "residuals": {name: round(float(value), 4) for name, value in residuals.items()},
    }
    write_whole(path, to_yaml(content))


def read_camera_pose(path: Path) -> Array:
    """Read T_world_camera, Shape=(4, 4), from a file; position in m, quaternion as (w, x, y, z).

    Raises:
        InputError: The file is missing or broken.
    """
    content = read_yaml(path)
    if content.get("format") != FORMAT:
        raise InputError(str(path), "format", repr(content.get("format"))[:40], FORMAT)
    if unknown := [key for key in content if key not in KEYS]:
        raise InputError(str(path), str(unknown[0]), "an unknown key", f"one of {', '.join(KEYS)}")
    return read_pose(content, str(path))


def read_pose(entry: Any, where: str, field: str = "", position_key: str = "position_m") -> Array:
    """Read a pose, Shape=(4, 4), from a mapping with a position and a quaternion.

    Raises:
        InputError: A value is missing or broken.
    """
    prefix = f"{field}." if field else ""
    numbers = {}
    for key, count in ((position_key, 3), ("quaternion", 4)):
        try:
            found = np.asarray(entry[key], float)
        except MALFORMED:
            found = np.empty(0)
        if found.shape != (count,) or not np.isfinite(found).all():
            raise InputError(where, f"{prefix}{key}", "missing or broken", f"{count} finite numbers")
        numbers[key] = found
    length = float(np.linalg.norm(numbers["quaternion"]))
    if not 0.99 < length < 1.01:
        raise InputError(where, f"{prefix}quaternion", f"length {length:.3f}", "(w, x, y, z) of length 1")
    return pose_matrix(rotation_of(numbers["quaternion"] / length), numbers[position_key])
