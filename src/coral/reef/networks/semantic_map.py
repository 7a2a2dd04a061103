"""A user's semantic network as eyes: a map of classes or of their logits, with depth or without."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.onnx_file import OnnxFile
from coral.reef.eyes.doubt import choose_labels
from coral.reef.eyes.ground_plane import ground_depth, standing_depth
from coral.reef.eyes.perception import UNSTATED_DOUBT, CameraAttitude, SeenPicture
from coral.reef.eyes.reef_net import OBSTACLE_FROM
from coral.reef.networks.class_table import ClassTable, class_table
from coral.reef.networks.network_notes import UNIT, NetworkNotes, read_notes
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label

OWN_CLASSES = ClassTable({k: label.name.lower() for k, label in enumerate(Label)}, dict(enumerate(Label)))
"""Of four logits without names: water, oyster, obstacle, sea floor."""
OUTPUTS = (
    "logits of shape (1, classes, height, width), or classes as whole numbers of shape (1, height, width); "
    "perhaps depth of shape (1, 1, height, width)"
)
_STEP = 32
"""Where a file leaves the size open, pictures have a multiple of this (px), which U-Nets and SegFormers can halve."""
_NO = -30.0
"""Logit of what no class means."""


class SemanticEyes:
    """Runs a network that maps a picture, Shape=(1, 3, H, W), to classes.

    The output is one of logits or probabilities, Shape=(1, C, h, w), at any size (SegFormer's are a quarter), or of
    classes as whole numbers, Shape=(1, h, w) or (1, 1, h, w). A metric `depth`, Shape=(1, 1, h, w), is optional.
    Without it depth follows from the camera's height.
    """

    def __init__(self, file: OnnxFile, notes: NetworkNotes | None = None) -> None:
        """Tell the layout by metadata and shape together.

        Raises:
            InputError: They contradict each other, or no class is an oyster.
        """
        notes = read_notes(file) if notes is None else notes
        self.pixels = notes.picture_input(UNIT)
        if notes.task == "segment":
            raise InputError(file.path, "metadata.task", notes.task, "candidates and 32 mask prototypes, two outputs")
        _, _, rows, columns = file.input_shape
        self._size = notes.size if rows is None and columns is None else None
        self.file = file.with_shapes_of(*(self._size or (columns or 4 * _STEP, rows or 4 * _STEP)))
        outputs = self.file.outputs
        named = [name for name in outputs if name != "depth"]
        self._classes = "logits" if "logits" in outputs else named[0] if len(named) == 1 else ""
        shape = outputs.get(self._classes, ())
        whole = "int" in file.kinds.get(self._classes, "")
        chosen = whole and (len(shape) == 3 or (len(shape) == 4 and shape[1] == 1))
        depth = outputs.get("depth", (1, 1, 1, 1))
        if not (chosen or (not whole and len(shape) == 4 and (shape[1] or 0) > 1)) or len(depth) != 4 or depth[1] != 1:
            found = ", ".join(f"{name} {file.kinds.get(name, '')} {of}" for name, of in outputs.items())
            raise InputError(file.path, "outputs", found, OUTPUTS)
        self._chosen = chosen
        count = None if chosen else shape[1]
        ours = count == len(Label) and self._classes == "logits" and "pixel_values" not in file.inputs
        if ours and not notes.names and not notes.stated.classes:
            self.table = OWN_CLASSES
        else:
            self.table = class_table(notes.names, notes.stated.classes, file.path)
        if count is not None and set(self.table.labels) != set(range(count)):
            found = f"{count} channels for the classes {', '.join(map(str, sorted(self.table.labels)))}"
            raise InputError(file.path, f"outputs.{self._classes}", found, "a channel for each class")
        kind = "classes as whole numbers" if chosen else f"logits of {count} classes"
        self.about: tuple[str, ...] = (
            f"a semantic network, {kind}, {self.pixels.describe()}", f"classes: {self.table.describe()}",
        )  # fmt: skip

    def perceive(self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude) -> SeenPicture:
        """Find classes and depth; pictures are scaled to the network's size, and results back.

        Raises:
            InputError: A pixel is of a class that the network has not.
        """
        _, _, rows, columns = self.file.input_shape
        open_size = self._size or tuple(-(-side // _STEP) * _STEP for side in (camera.width, camera.height))
        small = cv2.resize(rgb, (columns or open_size[0], rows or open_size[1]), interpolation=cv2.INTER_AREA)
        out = self.file.run(self.pixels.tensor(np.asarray(small, np.uint8)))
        if self._chosen:
            labels = self._labels(out[self._classes], camera)
            doubt = np.full(labels.shape, UNSTATED_DOUBT, np.float32)
        else:
            logits = resize_channels(gather_labels(out[self._classes][0], self.table), camera)
            labels, doubt = choose_labels(logits, OBSTACLE_FROM)
        if "depth" in out:
            depth = resize_channels(out["depth"][0], camera)[0]
        else:
            ground = ground_depth(camera, attitude.height, roll=attitude.roll, pitch=attitude.pitch)
            depth = standing_depth(labels, ground)
        depth = np.where((labels == Label.WATER) | ~(depth > 0.0), np.float32(np.inf), depth)
        return SeenPicture(labels, depth.astype(np.float32), doubt)

    def _labels(self, classes: NDArray[np.float32], camera: CameraCfg) -> NDArray[np.uint8]:
        coarse = classes.reshape(classes.shape[-2:]).astype(np.int64)
        strange = sorted(set(np.unique(coarse).tolist()) - set(self.table.labels))
        if strange:
            known = f"one of {', '.join(map(str, sorted(self.table.labels)))}"
            raise InputError(self.file.path, f"outputs.{self._classes}", f"class {strange[0]}", known)
        of = np.zeros(max(self.table.labels) + 1, np.uint8)
        of[list(self.table.labels)] = list(self.table.labels.values())
        size = (camera.width, camera.height)
        return np.asarray(cv2.resize(of[coarse], size, interpolation=cv2.INTER_NEAREST), np.uint8)


def gather_labels(maps: NDArray[np.float32], table: ClassTable) -> NDArray[np.float32]:
    """Return the logits of what the classes are to us, in the order of `Label`: log of the sum of their powers.

    `maps`, Shape=(C, h, w), are logits, or probabilities that sum to 1. Shape=(4, h, w).
    """
    if maps.min() >= 0.0 and np.abs(maps.sum(axis=0) - 1.0).max() < 1e-2:
        maps = np.log(np.maximum(maps, np.float32(1e-12)))
    gathered = np.full((len(Label), *maps.shape[1:]), maps.max(axis=0) + np.float32(_NO), np.float32)
    for label in Label:
        of = [key for key, meant in table.labels.items() if meant == label]
        if len(of) == 1:
            gathered[label] = maps[of[0]]
        elif of:
            gathered[label] = np.logaddexp.reduce(maps[of], axis=0)
    return gathered


def resize_channels(maps: NDArray[np.float32], camera: CameraCfg) -> NDArray[np.float32]:
    """Scale maps to the camera's size. Shape=(C, h, w) to (C, H, W)."""
    if maps.shape[1:] == (camera.height, camera.width):
        return maps
    size = (camera.width, camera.height)
    return np.stack([cv2.resize(one, size, interpolation=cv2.INTER_LINEAR) for one in maps]).astype(np.float32)
