"""Pictures of a recording as files: classes, depth in millimetres, colour."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.foreign_file import read_bytes
from coral.limits import PICTURE_BYTES
from coral.reef.eyes.doubt import unpack_doubt
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.world.geometry import Label
from coral.ros.camera_pictures import COLOUR, decode

Image = NDArray[Any]

NO_OBJECTS = np.empty((0, 0), np.int32)
"""A recording knows no objects."""


def read_picture(path: Path, where: str, field: str) -> Image:
    """Read and decode a file of a recording; colours, of the field rgb, red first.

    Raises:
        InputError: It cannot be read, is no regular file, is larger than any picture, or is none.
    """
    try:
        content = read_bytes(path, "a picture", PICTURE_BYTES)
    except InputError as error:
        raise InputError(where, field, f"{path.name}: {error.found}", "a picture") from None
    return decode(content, where, field, COLOUR)[:, :, ::-1] if field == "rgb" else decode(content, where, field)


def labels_of(image: Image, camera: RecordedCamera, where: str) -> NDArray[np.uint8]:
    """Return decoded classes, as the camera's view shows them. Shape=(H, W).

    Raises:
        InputError: They are of another kind or size.
    """
    _check_size(image, camera, where, "labels")
    if image.dtype != np.uint8 or image.ndim != 2 or int(image.max()) > max(Label):
        raise InputError(where, "labels", _kind(image), f"8 bits in one channel, classes 0 to {int(max(Label))}")
    labels = image if camera.rectifier is None else camera.rectifier.values(image)
    return np.ascontiguousarray(labels, np.uint8)


def depth_of(image: Image, camera: RecordedCamera, where: str) -> NDArray[np.float32]:
    """Return decoded depth in metres, as the camera's view shows it; inf where nothing is seen. Shape=(H, W).

    `image` has millimetres of 16 bits, or metres as float32 (REP-118); 0 or nan where nothing is seen.

    Raises:
        InputError: It is of another kind or size.
    """
    _check_size(image, camera, where, "depth")
    if image.ndim != 2 or image.dtype not in (np.uint16, np.float32):
        raise InputError(where, "depth", _kind(image), "millimetres, 16 bits in one channel")
    if camera.rectifier is not None:
        image = camera.rectifier.values(image)
    metres = image.astype(np.float32) / np.float32(1000.0 if image.dtype == np.uint16 else 1.0)
    metres[~(metres > 0.0)] = np.inf
    return metres


def doubt_of(image: Image, camera: RecordedCamera, where: str) -> NDArray[np.float32]:
    """Return decoded doubt as the camera's view shows it. Shape=(H, W).

    Raises:
        InputError: It is of another kind or size.
    """
    _check_size(image, camera, where, "doubt")
    if image.dtype != np.uint8 or image.ndim != 2:
        raise InputError(where, "doubt", _kind(image), "8 bits in one channel")
    return unpack_doubt(image if camera.rectifier is None else camera.rectifier.values(image))


def colours_of(rgb: Image, camera: RecordedCamera, where: str) -> NDArray[np.uint8]:
    """Return decoded colours, red first, as the camera's view shows them. Shape=(H, W, 3).

    Raises:
        InputError: They have another size.
    """
    _check_size(rgb, camera, where, "rgb")
    if camera.rectifier is None:
        return np.ascontiguousarray(rgb, np.uint8)
    return camera.rectifier.colours(np.ascontiguousarray(rgb, np.uint8))


def encode_depth(depth: NDArray[np.float32]) -> NDArray[np.uint16]:
    """Return depth in millimetres, 0 where nothing is seen; what is too far for 16 bits is as far as they reach."""
    millimetres = np.where(np.isfinite(depth), np.minimum(np.round(depth * 1000.0), 65535.0), 0.0)
    return millimetres.astype(np.uint16)


def encode_png(image: NDArray[np.uint8] | NDArray[np.uint16]) -> bytes:
    """Encode a picture without loss."""
    return _encoded(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 3])


def encode_jpeg(rgb: NDArray[np.uint8], quality: int = 92) -> bytes:
    """Encode a colour picture, Shape=(H, W, 3), red first."""
    return _encoded(".jpg", rgb[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])


def _check_size(image: Image, camera: RecordedCamera, where: str, field: str) -> None:
    width, height = camera.size
    if image.shape[:2] != (height, width):
        raise InputError(
            where, field, f"{image.shape[1]} x {image.shape[0]} pixels", f"{width} x {height}, the size of the camera"
        )


def _encoded(kind: str, image: NDArray[np.uint8] | NDArray[np.uint16], options: list[int]) -> bytes:
    ok, encoded = cv2.imencode(kind, image, options)
    if not ok:
        raise RuntimeError(f"a picture could not be encoded as {kind[1:]}")
    return encoded.tobytes()


def _kind(image: Image) -> str:
    return f"{8 * image.dtype.itemsize} bits in {1 if image.ndim == 2 else image.shape[2]} channels"
