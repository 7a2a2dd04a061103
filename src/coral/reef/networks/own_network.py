"""A user's network of classes, told by the layout of its file."""

from __future__ import annotations

from coral.errors import InputError
from coral.onnx_file import OnnxFile
from coral.reef.eyes.perception import RgbPerception
from coral.reef.eyes.reef_net import OUTPUTS
from coral.reef.networks.network_notes import read_notes
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
    return YoloEyes(file, notes) if is_yolo(file) else SemanticEyes(file, notes)
