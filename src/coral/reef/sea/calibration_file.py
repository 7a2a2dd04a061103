"""Calibrations as other tools write them, as the keys of a camera file.

ROS's camera_calibration, Kalibr, and OpenCV's FileStorage (YAML, XML or JSON).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from coral.errors import InputError, first_line
from coral.foreign_file import read_text
from coral.yaml_file import load_mapping

MODELS = {"radtan": "plumb_bob", "equi": "equidistant", "fisheye": "equidistant", "none": "plumb_bob"}
"""Names that Kalibr and OpenCV have for what sensor_msgs/CameraInfo names otherwise."""
MOUNT = ("pitch_down_deg", "altitude_m", "range_m", "near_m")
"""Keys of a camera file that no calibration has: they may be added to it, at its top level."""
_OPENCV_YAML = re.compile(r"\A%YAML[: ][0-9.]+")
"""OpenCV's first line, which is none of YAML; its JSON is YAML as it stands."""


def read_calibration(path: Path) -> dict[str, Any]:
    """Read a camera file or a calibration of another tool, as keys of `CameraFileCfg`.

    Raises:
        InputError: It cannot be read, is neither YAML, JSON nor OpenCV's XML, or is a calibration that is not whole.
    """
    where = str(path)
    text = read_text(path, "a camera file or a calibration")
    if text.lstrip().startswith("<"):
        return own_keys(_of_xml(text, where), where)
    text = _OPENCV_YAML.sub("", text).replace("!!opencv-matrix", "")
    return own_keys(load_mapping(text, where), where)


def own_keys(content: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return a calibration with the keys of `CameraFileCfg`; a file of ours as it is.

    Raises:
        InputError: It is a calibration of another tool, but not whole.
    """
    mount = {key: content[key] for key in MOUNT if key in content}
    lower = {str(key).lower(): value for key, value in content.items()}
    if "camera_matrix" in lower:  # OpenCV once wrote Camera_Matrix and image_Width
        return {**_of_ros(lower, where), **mount}
    cameras = [name for name, value in content.items() if isinstance(value, Mapping) and "intrinsics" in value]
    if cameras:
        if len(cameras) > 1:
            raise InputError(where, "", f"the cameras {', '.join(cameras)}", "the one that took the pictures")
        return {**_of_kalibr(content[cameras[0]], where, cameras[0]), **mount}
    model = content.get("model")
    return {**content, "model": MODELS.get(model, model)} if isinstance(model, str) else dict(content)


def _of_ros(content: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return the keys of a file of ROS's camera_calibration, or of one that OpenCV wrote, which names no model."""
    k = _numbers(content["camera_matrix"], where, "camera_matrix: data", 9)
    distortion = _numbers(content.get("distortion_coefficients", {"data": []}), where, "distortion_coefficients: data")
    usual = "plumb_bob" if len(distortion) <= 5 else "rational_polynomial"
    model = content.get("distortion_model", "equidistant" if content.get("fisheye_model") else usual)
    return {
        "width": _given(content, "image_width", where), "height": _given(content, "image_height", where),
        "fx": k[0], "fy": k[4], "cx": k[2], "cy": k[5],
        "model": MODELS.get(model, model) if isinstance(model, str) else model, "distortion": distortion,
    }  # fmt: skip


def _of_xml(text: str, where: str) -> dict[str, Any]:
    """Return what OpenCV's FileStorage wrote as XML, as it would be in YAML."""
    expected = "<opencv_storage> as OpenCV writes it, or a camera file (YAML)"
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InputError(where, "", "XML with definitions of its own", expected)
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise InputError(where, "", f"broken XML ({first_line(error)})", expected) from None
    if root.tag != "opencv_storage":
        raise InputError(where, "", f"XML of <{root.tag[:40]}>", expected)
    found: dict[str, Any] = {}
    for node in root:
        data = node.find("data")
        words = ((node if data is None else data).text or "").split()
        try:
            numbers = [int(word) if word.isdecimal() else float(word) for word in words]
        except ValueError:
            continue  # a name or a date
        found[node.tag] = {"data": numbers} if data is not None else numbers[0] if len(numbers) == 1 else None
    return found


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
        raise InputError(where, key, "nothing", "the size of the pictures (px): add it to the file")
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
