"""What colour pictures of a recording show, by eyes: found once, and kept for the passes that products need."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.eyes.doubt import pack_doubt, unpack_doubt
from coral.reef.eyes.perception import CameraAttitude, RgbPerception, perceive_frame
from coral.reef.recordings.picture_files import (
    NO_OBJECTS,
    colours_of,
    depth_of,
    doubt_of,
    encode_depth,
    labels_of,
)
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.world.geometry import Frame, Label


class PicturePerception:
    """Sees what pictures of a recording show. Products go through a recording several times: it looks once.

    Depth is kept in millimetres and doubt in bytes (`pack_doubt`), in a folder that goes with this object.
    """

    def __init__(self, eyes: RgbPerception, name: str) -> None:
        """Use eyes, whose name is that of a network, for the record."""
        self._eyes, self.name = eyes, name
        self._folder = tempfile.TemporaryDirectory(prefix="coral-seen-")
        self._seen: dict[str, int] = {}

    def frame(self, rgb: NDArray[np.uint8], camera: RecordedCamera, attitude: CameraAttitude, where: str) -> Frame:
        """Return a colour picture, Shape=(H, W, 3), sRGB, with classes, depth and doubt; `where` names it."""
        number = self._seen.get(where)
        if number is None:
            seen = perceive_frame(Frame.of_colours(rgb), self._eyes, camera.view, attitude)
            number = self._seen[where] = len(self._seen)
            self._keep(number, seen, camera)
        with np.load(self._path(number)) as kept:
            labels, depth, doubt = kept["labels"], kept["depth"], kept["doubt"]
        metres = np.where(depth > 0, depth.astype(np.float32) / np.float32(1000.0), np.float32(np.inf))
        return Frame(metres.astype(np.float32), labels, NO_OBJECTS, rgb, doubt=unpack_doubt(doubt))

    def _keep(self, number: int, seen: Frame, camera: RecordedCamera) -> None:
        assert seen.doubt is not None
        labels, depth = seen.labels, encode_depth(seen.depth)
        if camera.rectifier is not None:
            labels = np.where(camera.rectifier.outside, np.uint8(Label.WATER), labels).astype(np.uint8)
            depth = np.where(camera.rectifier.outside, np.uint16(0), depth).astype(np.uint16)
        np.savez_compressed(self._path(number), labels=labels, depth=depth, doubt=pack_doubt(seen.doubt))

    def _path(self, number: int) -> Path:
        return Path(self._folder.name) / f"{number:06d}.npz"


def recorded_frame(
    images: Mapping[str, Callable[[], NDArray[Any]]],
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
    rgb = colours_of(images["rgb"](), camera, where) if "rgb" in images else None
    if perception is None and "labels" in images and "depth" in images:
        doubt = doubt_of(images["doubt"](), camera, where) if "doubt" in images else None
        labels, depth = labels_of(images["labels"](), camera, where), depth_of(images["depth"](), camera, where)
        return Frame(depth, labels, NO_OBJECTS, rgb, doubt=doubt)
    if rgb is None:
        found = f"no colours, only {', '.join(images) or 'nothing'}"
        raise InputError(where, "rgb", found, "colour, or both labels and depth" if perception is None else "colour")
    if perception is None:
        raise InputError(
            where, "labels, depth", "colour pictures only",
            "--perception rgb, painted or FILE.onnx, or pictures of classes and depth beside them",
        )  # fmt: skip
    return perception.frame(rgb, camera, attitude, where)
