"""Calibrations as other tools write them, as the keys of a camera file: ROS's camera_calibration, and Kalibr."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from coral.errors import InputError

MODELS = {"radtan": "plumb_bob", "equi": "equidistant", "fisheye": "equidistant", "none": "plumb_bob"}
"""Names that Kalibr and OpenCV have for what sensor_msgs/CameraInfo names otherwise."""


def own_keys(content: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return a calibration with the keys of `CameraFileCfg`; a file of ours as it is.

    Raises:
        InputError: It is a calibration of another tool, but not whole.
    """
    if "camera_matrix" in content:
        return _of_ros(content, where)
    cameras = [name for name, value in content.items() if isinstance(value, Mapping) and "intrinsics" in value]
    if cameras:
        if len(cameras) > 1:
            raise InputError(where, "", f"the cameras {', '.join(cameras)}", "the one that took the pictures")
        return _of_kalibr(content[cameras[0]], where, cameras[0])
    model = content.get("model")
    return {**content, "model": MODELS.get(model, model)} if isinstance(model, str) else dict(content)


def _of_ros(content: Mapping[str, Any], where: str) -> dict[str, Any]:
    k = _numbers(content["camera_matrix"], where, "camera_matrix: data", 9)
    distortion = _numbers(content.get("distortion_coefficients", {"data": []}), where, "distortion_coefficients: data")
    model = content.get("distortion_model", "plumb_bob")
    return {
        "width": _given(content, "image_width", where), "height": _given(content, "image_height", where),
        "fx": k[0], "fy": k[4], "cx": k[2], "cy": k[5],
        "model": MODELS.get(model, model) if isinstance(model, str) else model, "distortion": distortion,
    }  # fmt: skip


def _of_kalibr(camera: Mapping[str, Any], where: str, name: str) -> dict[str, Any]:
    kind = camera.get("camera_model", "pinhole")
    if kind != "pinhole":
        raise InputError(where, f"{name}: camera_model", repr(kind), "pinhole, with radtan or equi distortion")
    k = _numbers({"data": camera["intrinsics"]}, where, f"{name}: intrinsics", 4)
    size = _numbers({"data": _given(camera, "resolution", where)}, where, f"{name}: resolution", 2)
    model = camera.get("distortion_model", "radtan")
    return {
        "width": size[0], "height": size[1], "fx": k[0], "fy": k[1], "cx": k[2], "cy": k[3],
        "model": MODELS.get(model, model) if isinstance(model, str) else model,
        "distortion": _numbers({"data": camera.get("distortion_coeffs", [])}, where, f"{name}: distortion_coeffs"),
    }  # fmt: skip


def _given(content: Mapping[str, Any], key: str, where: str) -> Any:
    if key not in content:
        raise InputError(where, key, "nothing", "the size of the pictures (px)")
    return content[key]


def _numbers(matrix: Any, where: str, field: str, count: int | None = None) -> list[Any]:
    data = matrix.get("data") if isinstance(matrix, Mapping) else None
    if (
        isinstance(data, list)
        and all(isinstance(one, int | float) for one in data)
        and len(data) == (count or len(data))
    ):
        return data
    raise InputError(where, field, repr(data)[:80], f"{count or 'some'} numbers")
