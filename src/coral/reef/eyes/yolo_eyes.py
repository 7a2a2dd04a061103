"""A user's YOLO segmentation network as eyes."""

from __future__ import annotations

import ast

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.onnx_file import OnnxFile
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.letterbox import Letterbox
from coral.reef.eyes.perception import CameraAttitude, SeenPicture
from coral.reef.eyes.standing_depth import standing_depth
from coral.reef.eyes.yolo_masks import PROTOTYPES, decode, draw_masks
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label

_MASK_FROM = 0.5
_FLOOR_DOUBT = 0.3
"""Doubt of what is no object: these networks state none about it."""


def is_yolo(file: OnnxFile) -> bool:
    """Check whether the outputs are candidates and 32 mask prototypes."""
    shapes = list(file.outputs.values())
    return (
        len(shapes) == 2
        and len(shapes[0]) == 3
        and len(shapes[1]) == 4
        and shapes[1][1] == PROTOTYPES
        and (shapes[0][1] or 0) > 4 + PROTOTYPES
    )


class YoloEyes:
    """Objects become oysters and obstacles; below the horizon the rest is sea floor, and depth follows from height."""

    def __init__(self, file: OnnxFile, score: float = 0.25, overlap: float = 0.7) -> None:
        """Read the names of the classes.

        Raises:
            InputError: None of them is an oyster.
        """
        self.file, self.score, self.overlap = file, score, overlap
        shape = file.input_shape
        if shape[2] is None or shape[3] is None:
            raise InputError(file.path, "inputs", str(shape), "a fixed height and width")
        self.net_size = shape[3], shape[2]
        classes = (next(iter(file.outputs.values()))[1] or 0) - 4 - PROTOTYPES
        self.labels = class_labels(file.metadata.get("names"), classes, file.path)

    def perceive(self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude) -> SeenPicture:
        """Find objects and their depth. Where objects overlap, the likeliest one counts."""
        box = Letterbox(camera.width, camera.height, *self.net_size)
        tensor = box.insert(rgb).transpose(2, 0, 1)[None].astype(np.float32) / np.float32(255.0)
        raw, prototypes = (value[0] for value in self.file.run(tensor).values())
        found = decode(raw, self.score, self.overlap)
        masks = draw_masks(found, prototypes, self.net_size)
        ground = ground_depth(camera, attitude.height, roll=attitude.roll, pitch=attitude.pitch)
        labels = np.where(np.isfinite(ground), np.uint8(Label.SEABED), np.uint8(Label.WATER))
        doubt = np.full(ground.shape, _FLOOR_DOUBT, np.float32)
        for k in range(len(found.scores) - 1, -1, -1):  # the likeliest last: it stays
            label = self.labels.get(int(found.classes[k]))
            if label is None:
                continue
            inside = box.extract(masks[k]) >= _MASK_FROM
            labels[inside], doubt[inside] = label, 1.0 - found.scores[k]
        return SeenPicture(labels.astype(np.uint8), standing_depth(labels, ground), doubt)


def class_labels(names: str | None, classes: int, path: str) -> dict[int, Label]:
    """Return what the classes of a network are to us.

    Args:
        names: Of the file's metadata: {0: 'oyster', 1: 'rock'}. None: the first is oysters, the others obstacles.
        classes: Number of classes.
        path: For errors.

    Returns:
        Oyster for names with "oyster" in them; nothing for a sea floor or water; all else is an obstacle.

    Raises:
        InputError: The names are no such text, or none is an oyster.
    """
    if names is None:
        return {k: Label.OYSTER if k == 0 else Label.OBSTACLE for k in range(classes)}
    try:
        table = {int(key): str(name).lower() for key, name in dict(ast.literal_eval(names)).items()}
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        raise InputError(path, "metadata.names", repr(names[:60]), "names by number, such as {0: 'oyster'}") from None
    labels = {
        key: Label.OYSTER if "oyster" in name else Label.OBSTACLE
        for key, name in table.items()
        if not any(word in name for word in ("seabed", "sea floor", "sand", "water", "background"))
    }
    if Label.OYSTER not in labels.values():
        raise InputError(path, "metadata.names", ", ".join(table.values()), "a class with oyster in its name")
    return labels
