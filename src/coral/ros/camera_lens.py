"""The lens that a sensor_msgs/CameraInfo states, of a bag or heard, for the pictures of a topic."""

from __future__ import annotations

from typing import Any

from coral.lens import Lens

NAMES = {"": "plumb_bob", "fisheye": "equidistant"}
"""Models by other names than those of sensor_msgs/distortion_models.hpp."""


def lens_of(message: Any, topic: str) -> Lens:
    """Return the lens for pictures of this topic as it is stated, unchecked; fx is 0 where nobody has calibrated it.

    K and D are of pictures as taken, P of those that image_proc has rectified. A binned picture, or one of a part of
    the sensor, has its own size and principal point. ROS 1 writes the matrices with capitals.
    """
    k, d, p = (getattr(message, name if hasattr(message, name) else name.upper()) for name in "kdp")
    rectified = "rect" in topic.replace("/", "_").split("_")
    fx, fy, cx, cy = (float(k[one]) for one in (0, 4, 2, 5))
    if rectified and float(p[0]) > 0.0:
        fx, fy, cx, cy = (float(p[one]) for one in (0, 5, 2, 6))
    part, across, down = message.roi, max(int(message.binning_x), 1), max(int(message.binning_y), 1)
    model: Any = message.distortion_model
    return Lens(
        width=(int(part.width) or int(message.width)) // across,
        height=(int(part.height) or int(message.height)) // down,
        fx=fx / across,
        fy=fy / down,
        cx=(cx - int(part.x_offset) + 0.5) / across - 0.5,
        cy=(cy - int(part.y_offset) + 0.5) / down - 0.5,
        model="plumb_bob" if rectified else NAMES.get(model, model),
        distortion=() if rectified else tuple(float(each) for each in d),
    )
