"""A user's network of classes, told by the layout of its file."""

from __future__ import annotations

from copy import copy
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.onnx_file import OnnxFile
from coral.reef.eyes.perception import CameraAttitude, RgbPerception
from coral.reef.eyes.reef_net import OUTPUTS
from coral.reef.networks.network_notes import SUFFIX, PictureInput, read_notes
from coral.reef.networks.pixel_check import CAMERA, check_pixels
from coral.reef.networks.relative_depth import is_depth
from coral.reef.networks.semantic_map import SemanticEyes
from coral.reef.networks.yolo_eyes import YoloEyes, is_yolo


def open_classes(file: OnnxFile) -> RgbPerception:
    """Return the eyes of a network that is none of ours.

    Raises:
        InputError: Its layout is not known, or files about it contradict each other.
    """
    if file.input_shape[1] not in (3, None):
        found = f"{file.input_shape[1]} channels"
        raise InputError(file.path, "inputs", found, f"3, a picture, or 4 with outputs {', '.join(OUTPUTS)}")
    notes = read_notes(file)
    if notes.task not in ("", "segment", "semantic"):
        raise InputError(file.path, "metadata.task", notes.task, "segment: outlines, not boxes alone")
    if is_depth(file):
        only = next(iter(file.outputs))
        raise InputError(file.path, "outputs", f"{only} alone", "classes; for depth give this file to --depth")
    eyes = YoloEyes(file, notes) if is_yolo(file) else SemanticEyes(file, notes)
    if notes.stated.channels is None and notes.stated.pixels is None:
        told = check_pixels(partial(_labels, eyes), eyes.pixels)
        eyes.about += (f"{told} in {Path(file.path).with_suffix(SUFFIX).name}",) if told else ()
    return eyes


def _labels(eyes: YoloEyes | SemanticEyes, rgb: NDArray[np.uint8], pixels: PictureInput) -> NDArray[np.uint8]:
    """Return the classes of a picture of the simulated camera that is given to a network in another way."""
    other = copy(eyes)
    other.pixels = pixels
    return other.perceive(rgb, CAMERA, CameraAttitude()).labels
