"""A user's YOLO segmentation network as eyes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.onnx_file import OnnxFile
from coral.reef.eyes.ground_plane import ground_depth, standing_depth
from coral.reef.eyes.perception import UNSTATED_DOUBT, CameraAttitude, SeenPicture
from coral.reef.networks.class_table import class_table
from coral.reef.networks.letterbox import Letterbox
from coral.reef.networks.network_notes import NetworkNotes, read_notes
from coral.reef.networks.picture_input import UNIT
from coral.reef.networks.yolo_masks import PROTOTYPES, Layout, decode, draw_masks, layout_of
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label

_MASK_FROM = 0.5
_SIZE = 640
"""Width and height of the network's pictures (px), where neither shape nor metadata say it: the default of exports."""
LAYOUTS: dict[Layout, str] = {
    "classes": "scores by class (YOLOv8, 11)", "objectness": "objectness and classes (YOLOv5)",
    "chosen": "chosen by itself (YOLO26, nms=True)",
}  # fmt: skip
OUTPUTS: dict[Layout, str] = {
    "classes": "1 x (4 + classes + 32) x M", "objectness": "1 x M x (5 + classes + 32)", "chosen": "1 x M x 38"
}  # fmt: skip
"""Shape of the candidates in each layout; the other output holds 32 mask prototypes."""


def is_yolo(file: OnnxFile) -> bool:
    """Check whether the outputs are candidates and 32 mask prototypes, in either order."""
    shapes = sorted(file.outputs.values(), key=len)
    return [len(shape) for shape in shapes] == [3, 4] and shapes[1][1] in (PROTOTYPES, None)


class YoloEyes:
    """Objects become oysters and obstacles; below the horizon the rest is sea floor, and depth follows from height."""

    def __init__(self, file: OnnxFile, notes: NetworkNotes | None = None) -> None:
        """Tell the layout by metadata and shape together.

        Raises:
            InputError: They contradict each other, or no class is an oyster.
        """
        notes = read_notes(file) if notes is None else notes
        self.pixels = notes.picture_input(UNIT)
        if notes.task == "semantic":
            raise InputError(file.path, "metadata.task", notes.task, "segment, as the outputs are")
        _, _, rows, columns = file.input_shape
        stated = notes.size or (_SIZE, _SIZE)
        self.net_size = columns or stated[0], rows or stated[1]
        if notes.size is not None and self.net_size != notes.size:
            found = f"{notes.size[0]} x {notes.size[1]}"
            raise InputError(
                file.path, "metadata.imgsz", found, f"{self.net_size[0]} x {self.net_size[1]}, the input's"
            )
        self.file = file.with_shapes_of(*self.net_size)
        outputs = self.file.outputs
        self._candidates, self._prototypes = sorted(outputs, key=lambda name: len(outputs[name]))
        self.table = class_table(notes.names, notes.stated.classes, file.path)
        self.layout = self._tell_layout(len(self.table.names), notes.suppressed)
        self.about: tuple[str, ...] = (
            f"YOLO, {LAYOUTS[self.layout]}, {self.net_size[0]} x {self.net_size[1]}, {self.pixels.describe()}",
            f"classes: {self.table.describe()}",
        )

    def _tell_layout(self, classes: int, suppressed: bool | None) -> Layout:
        _, rows, columns = self.file.outputs[self._candidates]
        layout = layout_of(rows or 0, columns or 0, classes, self.net_size)
        if layout is None:
            found = f"1 x {rows or '?'} x {columns or '?'} for {classes} classes"
            raise InputError(self.file.path, "outputs", found, " or ".join(OUTPUTS.values()))
        if suppressed is not None and suppressed != (layout == "chosen"):
            found = f"metadata: {'doubles left out' if suppressed else 'all candidates'} (end2end, nms)"
            raise InputError(self.file.path, "outputs", f"{LAYOUTS[layout]}, {found}", "one of them")
        return layout

    def perceive(self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude) -> SeenPicture:
        """Find objects and their depth. Where objects overlap, the likeliest one counts.

        Raises:
            InputError: An object is of a class that the network has not.
        """
        box = Letterbox(camera.width, camera.height, *self.net_size)
        out = self.file.run(self.pixels.tensor(box.insert(rgb)))
        found = decode(out[self._candidates][0], self.layout)
        masks = draw_masks(found, out[self._prototypes][0], self.net_size)
        ground = ground_depth(camera, attitude.height, roll=attitude.roll, pitch=attitude.pitch)
        labels = np.where(np.isfinite(ground), np.uint8(Label.SEABED), np.uint8(Label.WATER))
        doubt = np.full(ground.shape, UNSTATED_DOUBT, np.float32)
        for k in range(len(found.scores) - 1, -1, -1):  # the likeliest last: it stays
            label = self.table.labels.get(int(found.classes[k]))
            if label is None:
                expected = f"one of the {len(self.table.names)} classes that have names"
                raise InputError(self.file.path, "outputs", f"an object of class {found.classes[k]}", expected)
            if label in (Label.SEABED, Label.WATER):
                continue
            inside = box.extract(masks[k]) >= _MASK_FROM
            labels[inside], doubt[inside] = label, 1.0 - found.scores[k]
        return SeenPicture(labels.astype(np.uint8), standing_depth(labels, ground), doubt)
