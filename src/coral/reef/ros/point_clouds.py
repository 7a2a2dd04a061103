"""A sonar's echoes in ROS messages: sensor_msgs/PointCloud2 becomes points, and points a range image."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.vehicle.range_image import RangeImage

_KINDS = {7: "f4", 8: "f8"}
"""FLOAT32 and FLOAT64 of sensor_msgs/PointField."""


def points_in(message: Any, where: str) -> NDArray[np.float64]:
    """Return the finite points of a cloud, in the frame that its header names (m). Shape=(N, 3).

    Raises:
        InputError: It has no x, y and z, or fewer bytes than it says.
    """
    fields = {str(field.name): field for field in message.fields}
    if not {"x", "y", "z"} <= set(fields) or any(fields[name].datatype not in _KINDS for name in "xyz"):
        raise InputError(where, "fields", ", ".join(fields) or "none", "x, y and z as FLOAT32 or FLOAT64")
    count, step = int(message.width) * int(message.height), int(message.point_step)
    order = ">" if message.is_bigendian else "<"
    offsets = [int(fields[name].offset) for name in "xyz"]
    kinds = [np.dtype(order + _KINDS[fields[name].datatype]) for name in "xyz"]
    data = np.asarray(message.data, np.uint8)
    if data.size < count * step or any(o + kind.itemsize > step for o, kind in zip(offsets, kinds, strict=True)):
        raise InputError(where, "data", f"{data.size} bytes", f"{count} points of {step} bytes, x, y and z in each")
    layout = np.dtype({"names": list("xyz"), "formats": kinds, "offsets": offsets, "itemsize": step})
    cloud = np.frombuffer(data[: count * step].tobytes(), layout)
    points = np.stack([cloud[name].astype(np.float64) for name in "xyz"], axis=1)
    return points[np.isfinite(points).all(axis=1)]


def range_image_of(points: NDArray[np.float64], sonar: SonarCfg) -> RangeImage:
    """Sort points, x forward, y left, z up (m), Shape=(N, 3), into the beams of a sonar; the nearest one counts.

    A beam without a point has no echo. Points outside the sonar's field of view and range are left out.
    """
    away = np.linalg.norm(points, axis=1)
    azimuth = np.degrees(np.arctan2(points[:, 1], points[:, 0]))
    elevation = np.degrees(np.arctan2(points[:, 2], np.hypot(points[:, 0], points[:, 1])))
    column = np.round((0.5 - azimuth / sonar.hfov_deg) * (sonar.width - 1)).astype(np.intp)
    row = np.round((0.5 + elevation / sonar.vfov_deg) * (sonar.height - 1)).astype(np.intp)
    inside = (away > 0.0) & (away <= sonar.range_m)
    inside &= (column >= 0) & (column < sonar.width) & (row >= 0) & (row < sonar.height)
    ranges = np.full((sonar.height, sonar.width), np.inf, np.float32)
    np.minimum.at(ranges, (row[inside], column[inside]), away[inside].astype(np.float32))
    return RangeImage(ranges, sonar.hfov_deg, sonar.vfov_deg)
