"""A user's YOLO segmentation network as eyes."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.onnx_file import OnnxFile
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.letterbox import Letterbox
from coral.reef.eyes.perception import CameraAttitude, SeenPicture
from coral.reef.eyes.standing_depth import standing_depth
from coral.reef.eyes.yolo_masks import PROTOTYPES, Layout, decode, draw_masks, layout_of
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label

OYSTERS = {
    *("oyster", "oysters", "live oyster", "live oysters", "living oyster", "living oysters", "oyster cluster"),
    *(
        "oyster clusters",
        "oyster clump",
        "oyster reef",
        "oyster bed",
        "eastern oyster",
        "pacific oyster",
        "flat oyster",
    ),
    *("european oyster", "native oyster", "olympia oyster", "crassostrea virginica", "crassostrea gigas"),
    *("magallana gigas", "ostrea edulis", "ostrea lurida"),
}
"""Names of living oysters. An oyster drill is a snail, an oyster toadfish a fish, a dead oyster a shell."""
FLOOR = {
    *("seabed", "sea bed", "sea floor", "seafloor", "sand", "mud", "sediment", "bottom", "water", "water column"),
    *("background", "unlabeled", "unlabelled"),
}
"""Names of what is no object. Whatever has another name is an obstacle: a water bottle, too."""
_MASK_FROM = 0.5
_FLOOR_DOUBT = 0.3
"""Doubt of what is no object: these networks state none about it."""


def is_yolo(file: OnnxFile) -> bool:
    """Check whether the outputs are candidates and 32 mask prototypes."""
    shapes = list(file.outputs.values())
    return len(shapes) == 2 and len(shapes[0]) == 3 and len(shapes[1]) == 4 and shapes[1][1] == PROTOTYPES


class YoloEyes:
    """Objects become oysters and obstacles; below the horizon the rest is sea floor, and depth follows from height."""

    def __init__(self, file: OnnxFile, score: float = 0.25, overlap: float = 0.7) -> None:
        """Read the names of the classes.

        Raises:
            InputError: None of them is an oyster, or the outputs fit no layout with so many classes.
        """
        self.file, self.score, self.overlap = file, score, overlap
        shape = file.input_shape
        if shape[2] is None or shape[3] is None:
            raise InputError(file.path, "inputs", str(shape), "a fixed height and width")
        self.net_size = shape[3], shape[2]
        _, rows, columns = next(iter(file.outputs.values()))
        names = file.metadata.get("names")
        table = None if names is None else read_names(names, file.path)
        layout = layout_of(rows or 0, columns or 0, None if table is None else len(table))
        if layout is None:
            found = f"1 x {rows or '?'} x {columns or '?'}" + ("" if table is None else f" for {len(table)} classes")
            expected = "1 x (4 + classes + 32) x M, 1 x M x (5 + classes + 32) or 1 x M x 38, of fixed size"
            raise InputError(file.path, "outputs", found, expected)
        self.layout: Layout = layout
        classes = 1 if layout == "chosen" else (rows or 0) - 36 if layout == "classes" else (columns or 0) - 37
        self.labels = class_labels(table or {k: "oyster" if k == 0 else "object" for k in range(classes)}, file.path)

    def perceive(self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude) -> SeenPicture:
        """Find objects and their depth. Where objects overlap, the likeliest one counts."""
        box = Letterbox(camera.width, camera.height, *self.net_size)
        tensor = box.insert(rgb).transpose(2, 0, 1)[None].astype(np.float32) / np.float32(255.0)
        raw, prototypes = (value[0] for value in self.file.run(tensor).values())
        found = decode(raw, self.layout, self.score, self.overlap)
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


def read_names(names: str, path: str) -> dict[int, str]:
    """Read the names of classes in a file's metadata: {0: 'oyster', 1: 'rock'}.

    Raises:
        InputError: They are no such text.
    """
    try:
        return {int(key): str(name) for key, name in dict(ast.literal_eval(names)).items()}
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        raise InputError(path, "metadata.names", repr(names[:60]), "names by number, such as {0: 'oyster'}") from None


def class_labels(names: Mapping[int, str], path: str) -> dict[int, Label]:
    """Return what the classes of a network are to us, by their whole names: `OYSTERS`, `FLOOR`, else obstacles.

    Raises:
        InputError: None is an oyster.
    """
    plain = {key: " ".join(re.split(r"[\s_-]+", name.strip().lower())) for key, name in names.items()}
    labels = {
        key: Label.OYSTER if name in OYSTERS else Label.OBSTACLE for key, name in plain.items() if name not in FLOOR
    }
    if Label.OYSTER not in labels.values():
        raise InputError(
            path, "metadata.names", ", ".join(names.values()), f"a class named as one of {', '.join(sorted(OYSTERS))}"
        )
    return labels
