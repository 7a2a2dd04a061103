"""What pictures of a recording show: its own classes, depth and doubt, or what eyes see in its colours."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.foreign_file import read_bytes
from coral.limits import PICTURE_BYTES
from coral.reef.eyes.doubt import pack_doubt, unpack_doubt
from coral.reef.eyes.perception import CameraAttitude, RgbPerception, perceive_frame
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.world.geometry import Frame, Label
from coral.ros.camera_pictures import COLOUR, decode

Image = NDArray[Any]
NO_OBJECTS = np.empty((0, 0), np.int32)
"""A recording knows no objects."""
KINDS: dict[str, tuple[tuple[type, ...], str]] = {
    "labels": ((np.uint8,), f"8 bits in one channel, classes 0 to {int(max(Label))}"),
    "depth": ((np.uint16, np.float32), "millimetres, 16 bits in one channel"),
    "doubt": ((np.uint8,), "8 bits in one channel"),
}
"""What pixels of a kind of picture may be, for the machine and for people."""


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


def rectify(image: Image, camera: RecordedCamera, where: str, field: str) -> Image:
    """Return a decoded picture as the camera's view shows it.

    rgb: red first, Shape=(H, W, 3), uint8; labels: `Label`, Shape=(H, W), uint8; doubt: Shape=(H, W), float32; depth:
    metres, inf where nothing is seen, Shape=(H, W), float32. Pictures of doubt have steps of 1/255; those of depth
    millimetres of 16 bits, or metres as float32 (REP-118), 0 or nan where nothing is seen.

    Raises:
        InputError: It is of another kind or size.
    """
    width, height = camera.size
    if image.shape[:2] != (height, width):
        raise InputError(
            where, field, f"{image.shape[1]} x {image.shape[0]} pixels", f"{width} x {height}, the size of the camera"
        )
    if field == "rgb":
        rgb = np.ascontiguousarray(image, np.uint8)
        return rgb if camera.rectifier is None else camera.rectifier.colours(rgb)
    kinds, expected = KINDS[field]
    if image.ndim != 2 or image.dtype not in kinds or (field == "labels" and int(image.max()) > max(Label)):
        channels = 1 if image.ndim == 2 else image.shape[2]
        raise InputError(where, field, f"{8 * image.dtype.itemsize} bits in {channels} channels", expected)
    values = image if camera.rectifier is None else camera.rectifier.values(image)
    if field == "labels":
        return np.ascontiguousarray(values, np.uint8)
    return unpack_doubt(values) if field == "doubt" else metres_of(values)


def metres_of(depth: Image) -> NDArray[np.float32]:
    """Return depth of millimetres as uint16, or of metres, in metres; inf where it is 0 or nan. Shape=(H, W)."""
    metres = depth.astype(np.float32) / np.float32(1000.0 if depth.dtype == np.uint16 else 1.0)
    metres[~(metres > 0.0)] = np.inf
    return metres


def encode_depth(depth: NDArray[np.float32]) -> NDArray[np.uint16]:
    """Return depth in millimetres, 0 where nothing is seen; what is too far for 16 bits is as far as they reach."""
    millimetres = np.where(np.isfinite(depth), np.minimum(np.round(depth * 1000.0), 65535.0), 0.0)
    return millimetres.astype(np.uint16)


class PicturePerception:
    """Sees what pictures of a recording show. Products go through a recording several times: it looks once.

    Depth is kept in millimetres and doubt in bytes (`pack_doubt`), in a folder that goes with this object.
    """

    def __init__(self, eyes: RgbPerception, name: str) -> None:
        """Use eyes, whose name is that of a network, for the record."""
        self._eyes, self.name = eyes, name
        self._folder = tempfile.TemporaryDirectory(prefix="coral-seen-")
        self._seen: dict[str, Path] = {}

    def frame(self, rgb: NDArray[np.uint8], camera: RecordedCamera, attitude: CameraAttitude, where: str) -> Frame:
        """Return a colour picture, Shape=(H, W, 3), sRGB, with classes, depth and doubt; `where` names it."""
        path = self._seen.get(where)
        if path is None:
            seen = perceive_frame(Frame.of_colours(rgb), self._eyes, camera.view, attitude)
            path = self._seen[where] = Path(self._folder.name) / f"{len(self._seen):06d}.npz"
            _keep(path, seen, camera)
        with np.load(path) as kept:
            labels, depth, doubt = kept["labels"], kept["depth"], kept["doubt"]
        return Frame(metres_of(depth), labels, NO_OBJECTS, rgb, doubt=unpack_doubt(doubt))


def recorded_frame(
    images: Mapping[str, Callable[[], Image]],
    camera: RecordedCamera,
    perception: PicturePerception | None,
    attitude: CameraAttitude,
    where: str,
) -> Frame:
    """Return the pictures of one moment, with the recording's own classes and depth, or with those that eyes see.

    `images` decode rgb, labels, depth and doubt, as far as they are there.

    Raises:
        InputError: Something is missing, or a picture is none of its kind.
    """
    wanted = ("rgb",) if perception else ("rgb", "labels", "depth", "doubt")
    shown = {name: rectify(images[name](), camera, where, name) for name in wanted if name in images}
    if "labels" in shown and "depth" in shown:
        return Frame(shown["depth"], shown["labels"], NO_OBJECTS, shown.get("rgb"), doubt=shown.get("doubt"))
    if "rgb" not in shown:
        found = f"no colours, only {', '.join(images) or 'nothing'}"
        raise InputError(where, "rgb", found, "colour, or both labels and depth" if perception is None else "colour")
    if perception is None:
        raise InputError(
            where, "labels, depth", "colour pictures only",
            "--perception rgb, painted or FILE.onnx, or pictures of classes and depth beside them",
        )  # fmt: skip
    return perception.frame(shown["rgb"], camera, attitude, where)


def _keep(path: Path, seen: Frame, camera: RecordedCamera) -> None:
    assert seen.doubt is not None
    labels, depth = seen.labels, encode_depth(seen.depth)
    if camera.rectifier is not None:
        labels = np.where(camera.rectifier.outside, np.uint8(Label.WATER), labels).astype(np.uint8)
        depth = np.where(camera.rectifier.outside, np.uint16(0), depth).astype(np.uint16)
    np.savez_compressed(path, labels=labels, depth=depth, doubt=pack_doubt(seen.doubt))
