"""Pictures of a recording as files: classes, depth in millimetres, colour."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.camera import CameraCfg
from coral.reef.geometry import Frame, Label

NO_OBJECTS = np.empty((0, 0), np.int32)
"""A recording knows no objects."""


def read_picture(path: Path, where: str, field: str) -> bytes:
    """Read a file of a recording.

    Raises:
        InputError: It cannot be read.
    """
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(where, field, f"{path.name}: {error.strerror or error}", "a picture") from None


def decode_labels(content: bytes, camera: CameraCfg, where: str) -> NDArray[np.uint8]:
    """Decode a picture of classes (`Label`), 8 bits in one channel. Shape=(H, W).

    Raises:
        InputError: It is none, or has another size than the camera's.
    """
    image = _decoded(content, camera, where, "labels")
    if image.dtype != np.uint8 or image.ndim != 2 or int(image.max()) > max(Label):
        raise InputError(where, "labels", _kind(image), f"8 bits in one channel, classes 0 to {int(max(Label))}")
    return np.ascontiguousarray(image)


def decode_depth(content: bytes, camera: CameraCfg, where: str) -> NDArray[np.float32]:
    """Decode a picture of depth along the optical axis, in millimetres of 16 bits; 0 where nothing is seen.

    Returns:
        Metres, inf where nothing is seen. Shape=(H, W), float32.

    Raises:
        InputError: It is none, or has another size than the camera's.
    """
    image = _decoded(content, camera, where, "depth")
    if image.dtype != np.uint16 or image.ndim != 2:
        raise InputError(where, "depth", _kind(image), "millimetres, 16 bits in one channel")
    metres = image.astype(np.float32) / np.float32(1000.0)
    metres[image == 0] = np.inf
    return metres


def decode_rgb(content: bytes, camera: CameraCfg, where: str) -> NDArray[np.uint8]:
    """Decode a colour picture. Shape=(H, W, 3), red first.

    Raises:
        InputError: It is none, or has another size than the camera's.
    """
    image = _decoded(content, camera, where, "rgb", cv2.IMREAD_COLOR)
    return np.ascontiguousarray(image[:, :, ::-1])


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


def frame_of(labels: NDArray[np.uint8], depth: NDArray[np.float32], rgb: NDArray[np.uint8] | None) -> Frame:
    """Return the pictures of one moment."""
    return Frame(depth=depth, labels=labels, instances=NO_OBJECTS, rgb=rgb)


def _decoded(
    content: bytes, camera: CameraCfg, where: str, field: str, mode: int = cv2.IMREAD_UNCHANGED
) -> NDArray[np.uint8] | NDArray[np.uint16]:
    image = cv2.imdecode(np.frombuffer(content, np.uint8), mode) if content else None
    if image is None:
        raise InputError(where, field, "no picture", "a PNG or JPEG picture")
    if image.shape[:2] != (camera.height, camera.width):
        raise InputError(
            where, field, f"{image.shape[1]} x {image.shape[0]} pixels",
            f"{camera.width} x {camera.height}, the size of the camera",
        )  # fmt: skip
    return image  # type: ignore[return-value]


def _encoded(kind: str, image: NDArray[np.uint8] | NDArray[np.uint16], options: list[int]) -> bytes:
    ok, encoded = cv2.imencode(kind, image, options)
    if not ok:
        raise RuntimeError(f"a picture could not be encoded as {kind[1:]}")
    return encoded.tobytes()


def _kind(image: NDArray[np.uint8] | NDArray[np.uint16]) -> str:
    return f"{8 * image.dtype.itemsize} bits in {1 if image.ndim == 2 else image.shape[2]} channels"
