"""The file with the hand's poses at which a board was photographed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.config import read_yaml
from coral.contact.real_scenes.calibration.camera_pose_file import read_pose
from coral.errors import InputError

Array = NDArray[np.float64]


def read_hand_poses(path: Path) -> list[Array]:
    """Read T_world_tool, Shape=(4, 4) each, from a list `poses` of `position` (m) and `quaternion` (w, x, y, z).

    Raises:
        InputError: The file is missing or broken.
    """
    entries = read_yaml(path).get("poses")
    if not isinstance(entries, list) or not entries:
        raise InputError(str(path), "poses", "no list", "a list of position and quaternion")
    return [read_pose(entry, str(path), f"poses[{k}]", "position") for k, entry in enumerate(entries)]
