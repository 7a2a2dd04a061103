"""Reads the cameras of recorded pictures in the format of BOP (Hodan et al., 2018).

Lengths are millimetres there, and metres here.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.rigid_transform import inverse_transform, pose_matrix
from coral.errors import InputError
from coral.foreign_file import read_json

Array = NDArray[np.float64]
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


@dataclass(frozen=True)
class PictureCamera:
    """The camera of one picture."""

    lens: Array
    """Shape=(4,): fx, fy, cx, cy in pixels."""
    depth_scale_mm: float
    """Millimetres per unit of its depth picture."""
    T_world_camera: Array
    """Shape=(4, 4); if the recording states no pose of the camera, its frame is the world's."""
    time_s: float | None = None
    """Time of the picture, which BOP does not have; None where the recording does not tell it."""


def read_cameras(path: Path) -> dict[int, PictureCamera]:
    """Read `scene_camera.json`: the camera of each picture.

    Raises:
        InputError: The file is missing or broken.
    """
    return {_index(key, path): _camera(entry, path, key) for key, entry in _read_object(path).items()}


def read_shared_camera(path: Path) -> PictureCamera:
    """Read `camera.json`: one camera for all pictures of a data set.

    Raises:
        InputError: The file is missing or broken.
    """
    found = _read_object(path)
    lens = np.array([_numbers(found, name, 1, path)[0] for name in ("fx", "fy", "cx", "cy")])
    return PictureCamera(_checked_lens(lens, path, ""), _depth_scale(found, path, ""), np.eye(4))


def _read_object(path: Path) -> dict[str, Any]:
    if not path.exists() and (others := sorted(one.name for one in path.parent.glob(f"{path.stem}_*.json"))):
        expected = f"the files of one camera under their plain names: {path.name}, depth, rgb"
        raise InputError(str(path), "", f"{', '.join(others)} instead, of one camera among several", expected)
    found = read_json(path, "a JSON file of BOP")
    if not isinstance(found, dict):
        raise InputError(str(path), "", type(found).__name__, "an object with named values")
    return found


def _index(key: str, path: Path) -> int:
    if not (key.isascii() and key.isdecimal() and len(key) < 10):
        raise InputError(str(path), key[:40], "no index", "the index of a picture")
    return int(key)


def _numbers(entry: Any, name: str, count: int, path: Path, key: str = "") -> Array:
    """Return some numbers of an entry, Shape=(count,)."""
    try:
        found = np.asarray(entry[name], float).ravel()
    except (TypeError, KeyError, ValueError, OverflowError):
        found = np.empty(0)
    if found.size != count or not np.isfinite(found).all():
        raise InputError(str(path), f"{key}.{name}".lstrip("."), "missing or broken", f"{count} finite numbers")
    return found


def _rigid(entry: Any, kind: str, path: Path, key: str) -> Array:
    turn = _numbers(entry, f"cam_R_{kind}", 9, path, key).reshape(3, 3)
    left, _, right = np.linalg.svd(turn)
    nearest = left @ right
    # Data sets such as LM-O hold rotations that are off by some thousandths.
    if np.abs(turn - nearest).max() > 0.02 or np.linalg.det(nearest) < 0:
        raise InputError(str(path), f"{key}.cam_R_{kind}", "no rotation", "a rotation matrix, row by row")
    return pose_matrix(nearest, MM * _numbers(entry, f"cam_t_{kind}", 3, path, key))


def _camera(entry: Any, path: Path, key: str) -> PictureCamera:
    if isinstance(entry, dict) and "cam_model" in entry and "cam_K" not in entry:
        model = entry["cam_model"]
        kind = model.get("projection_model_type") if isinstance(model, dict) else model
        expected = "cam_K, of pictures whose distortion was removed"
        raise InputError(str(path), f"{key}.cam_model", repr(kind)[:60], expected)
    lens = _numbers(entry, "cam_K", 9, path, key)[[0, 4, 2, 5]]
    placed = inverse_transform(_rigid(entry, "w2c", path, key)) if "cam_R_w2c" in entry else np.eye(4)
    time_s = float(_numbers(entry, "time_s", 1, path, key)[0]) if "time_s" in entry else None
    return PictureCamera(_checked_lens(lens, path, key), _depth_scale(entry, path, key), placed, time_s)


def _checked_lens(lens: Array, path: Path, key: str) -> Array:
    if not (lens[:2] > 0).all():
        raise InputError(str(path), f"{key} focal length".strip(), lens[:2].tolist(), "numbers above 0")
    return lens


def _depth_scale(entry: Any, path: Path, key: str) -> float:
    return float(_numbers(entry, "depth_scale", 1, path, key)[0]) if "depth_scale" in entry else 1.0
