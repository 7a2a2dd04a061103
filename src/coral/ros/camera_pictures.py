"""What cameras send over ROS: sensor_msgs/Image, CompressedImage and the lens in CameraInfo; PNG and JPEG as bytes."""

from __future__ import annotations

import struct
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.foreign_file import decode_picture
from coral.lens import Lens

_PLAIN: dict[str, tuple[str, int]] = {
    "mono8": ("u1", 1), "8UC1": ("u1", 1), "mono16": ("u2", 1), "16UC1": ("u2", 1), "32FC1": ("f4", 1),
    "rgb8": ("u1", 3), "bgr8": ("u1", 3), "8UC3": ("u1", 3), "rgba8": ("u1", 4), "bgra8": ("u1", 4),
    "bayer_rggb8": ("u1", 1), "bayer_bggr8": ("u1", 1), "bayer_gbrg8": ("u1", 1), "bayer_grbg8": ("u1", 1),
    "yuv422": ("u1", 2), "yuv422_yuy2": ("u1", 2),
}  # fmt: skip
"""Type and channels by encoding (sensor_msgs/image_encodings.hpp)."""
_TO_RGB = {
    "mono8": cv2.COLOR_GRAY2RGB, "8UC1": cv2.COLOR_GRAY2RGB, "bgr8": cv2.COLOR_BGR2RGB, "8UC3": cv2.COLOR_BGR2RGB,
    "rgba8": cv2.COLOR_RGBA2RGB, "bgra8": cv2.COLOR_BGRA2RGB,
    # OpenCV names a Bayer pattern by its second row and column.
    "bayer_rggb8": cv2.COLOR_BayerBG2RGB, "bayer_bggr8": cv2.COLOR_BayerRG2RGB,
    "bayer_gbrg8": cv2.COLOR_BayerGR2RGB, "bayer_grbg8": cv2.COLOR_BayerGB2RGB,
    "yuv422": cv2.COLOR_YUV2RGB_UYVY, "yuv422_yuy2": cv2.COLOR_YUV2RGB_YUYV,
}  # fmt: skip
_HEADER = struct.Struct("<iff")
"""Of compressed_depth_image_transport, before the PNG: a number of the format, and A and B of a quantised depth."""
VIDEO = ("h264", "h265", "hevc", "av1", "vp8", "vp9", "mpeg4")
"""Formats of CompressedImage that are videos, whose pictures need the ones before them."""


COLOUR = cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION
"""Pixels as they lie in the file: a camera that looks down tells any orientation, and calibrations are of pixels."""

_MODELS = {"": "plumb_bob", "fisheye": "equidistant"}
"""Models by other names than those of sensor_msgs/distortion_models.hpp."""


def decode(content: bytes, where: str, field: str, mode: int = cv2.IMREAD_UNCHANGED) -> NDArray[Any]:
    """Decode a PNG or JPEG picture.

    Raises:
        InputError: It is none.
    """
    try:
        image = decode_picture(content, mode)
    except ValueError as error:
        raise InputError(where, field, error, "a camera's picture") from None
    if image is None:
        raise InputError(where, field, "no picture", "a PNG or JPEG picture")
    return image


def colours_in(message: Any, where: str) -> NDArray[np.uint8]:
    """Return the colour picture of a message, red first. Shape=(H, W, 3).

    Raises:
        InputError: It is none, or has an encoding that is not read here.
    """
    if hasattr(message, "format"):  # CompressedImage
        if str(message.format).lower() in VIDEO:
            raise InputError(where, "format", repr(str(message.format)), "JPEG or PNG pictures; decode a video first")
        return np.asarray(decode(bytes(message.data), where, "rgb", COLOUR)[:, :, ::-1], np.uint8)
    image, encoding = _plain(message, where), str(message.encoding)
    if encoding == "rgb8":
        return np.asarray(image, np.uint8)
    if encoding not in _TO_RGB:
        raise InputError(where, "encoding", repr(encoding), f"one of rgb8, {', '.join(_TO_RGB)}")
    return np.asarray(cv2.cvtColor(np.ascontiguousarray(image), _TO_RGB[encoding]), np.uint8)


def values_in(message: Any, where: str, field: str) -> NDArray[Any]:
    """Return the picture of classes or of depth of a message, as it is. Shape=(H, W).

    Raises:
        InputError: It is none, or has an encoding that is not read here.
    """
    if not hasattr(message, "format"):
        return _plain(message, where)
    content, form = bytes(message.data), str(message.format)
    if "compressedDepth" not in form:
        return decode(content, where, field)
    if "rvl" in form.lower():
        raise InputError(where, field, f"compressedDepth as RVL ({form!r})", "compressedDepth as PNG, or raw pictures")
    if len(content) <= _HEADER.size:
        raise InputError(where, field, f"{len(content)} bytes", "compressedDepth: 12 bytes before a PNG")
    _, a, b = _HEADER.unpack_from(content)
    image = decode(content[_HEADER.size :], where, field)
    if not form.startswith("32FC1"):
        return image
    # 32 bits are kept as inverse depths: raw = A / depth + B.
    inverse = image.astype(np.float64) - b
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where((image > 0) & (inverse > 0.0), a / inverse, np.nan).astype(np.float32)


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
        model="plumb_bob" if rectified else _MODELS.get(model, model),
        distortion=() if rectified else tuple(float(each) for each in d),
    )


def _plain(message: Any, where: str) -> NDArray[Any]:
    encoding = str(message.encoding)
    if encoding not in _PLAIN:
        raise InputError(where, "encoding", repr(encoding), f"one of {', '.join(_PLAIN)}")
    kind, channels = _PLAIN[encoding]
    dtype = np.dtype(kind).newbyteorder(">" if message.is_bigendian else "<")
    width, height, step = int(message.width), int(message.height), int(message.step)
    data = np.asarray(message.data).view(np.uint8)
    used = width * channels * dtype.itemsize
    if min(width, height) < 1 or step < used or data.size < step * height:
        raise InputError(where, "data", f"{data.size} bytes", f"{height} rows of {step} bytes, {used} of them pixels")
    rows = data[: step * height].reshape(height, step)[:, :used]
    image = np.ascontiguousarray(rows).view(dtype).reshape((height, width, channels))
    return image.astype(dtype.newbyteorder("="))[:, :, 0] if channels == 1 else image
