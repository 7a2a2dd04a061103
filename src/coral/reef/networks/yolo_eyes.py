"""A user's YOLO segmentation network as eyes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.onnx_file import OnnxFile
from coral.reef.eyes.ground_plane import ground_depth, standing_depth
from coral.reef.eyes.perception import UNSTATED_DOUBT, CameraAttitude, SeenPicture
from coral.reef.networks.class_table import class_table
from coral.reef.networks.network_notes import UNIT, NetworkNotes, read_notes
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
GRAY = 114
"""Of the border; the value that YOLO networks are trained with."""
PROTOTYPES = 32
"""Mask prototypes of these networks (YOLACT, arXiv 1904.02689)."""
Layout = Literal["classes", "objectness", "chosen"]
"""Of a candidate. classes: in columns, a box and a score per class (YOLOv8, 11). objectness: in rows, a box, the score
of any object, and one per class given that (YOLOv5). chosen: in rows, two corners, score and class, after the network's
own suppression (YOLO26, `nms=True`)."""
_CHOSEN = 6 + PROTOTYPES
_MOST_CHOSEN = 1000
"""More rows than a network's own suppression leaves (300 by default)."""
_STRIDES, _ANCHORS = (8, 16, 32), 3
"""Pixels of the picture for a cell of each grid of candidates, and candidates in a cell of YOLOv5."""


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


@dataclass(frozen=True)
class Letterbox:
    """Where a picture lies in the network's picture: scaled, in the middle, with a gray border."""

    width: int
    height: int
    """Of the camera's picture (px)."""
    net_width: int
    net_height: int

    @property
    def scale(self) -> float:
        """Pixels of the network for one of the camera."""
        return min(self.net_width / self.width, self.net_height / self.height)

    @property
    def inner(self) -> tuple[int, int]:
        """Width and height of the scaled picture (px)."""
        return round(self.width * self.scale), round(self.height * self.scale)

    @property
    def corner(self) -> tuple[int, int]:
        """First column and row of the scaled picture."""
        width, height = self.inner
        return (self.net_width - width) // 2, (self.net_height - height) // 2

    def insert(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return the network's picture. Shape=(H, W, 3) to (net_height, net_width, 3)."""
        (x, y), (width, height) = self.corner, self.inner
        out = np.full((self.net_height, self.net_width, 3), GRAY, np.uint8)
        out[y : y + height, x : x + width] = cv2.resize(rgb, (width, height), interpolation=cv2.INTER_LINEAR)
        return out

    def extract(self, image: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the camera's part of a map of the network's picture, perhaps coarser, at the camera's size."""
        rows, columns = image.shape
        fx, fy = columns / self.net_width, rows / self.net_height
        (x, y), (width, height) = self.corner, self.inner
        # Middle of each of the camera's pixels in the map, with whole numbers at the middles of its pixels.
        u = ((np.arange(self.width) + 0.5) * width / self.width + x) * fx - 0.5
        v = ((np.arange(self.height) + 0.5) * height / self.height + y) * fy - 0.5
        grid_u, grid_v = np.meshgrid(u.astype(np.float32), v.astype(np.float32))
        out = cv2.remap(image, grid_u, grid_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(out, np.float32)


def layout_of(rows: int, columns: int, classes: int, size: tuple[int, int]) -> Layout | None:
    """Return the layout of an output of shape (1, rows, columns); None if it fits none, or not this many classes.

    The size of its pictures (px) tells YOLOv5 of one class from chosen objects.
    """
    anchors = _ANCHORS * sum((size[0] // stride) * (size[1] // stride) for stride in _STRIDES)
    if columns == _CHOSEN and rows <= _MOST_CHOSEN and not (classes == 1 and rows == anchors):
        return "chosen"
    if rows == 4 + classes + PROTOTYPES:
        return "classes"
    return "objectness" if columns == 5 + classes + PROTOTYPES else None


@dataclass(frozen=True)
class Detections:
    """N objects, the likeliest first."""

    boxes: NDArray[np.float32]
    """x0, y0, x1, y1 in pixels of the network's picture. Shape=(N, 4)."""
    scores: NDArray[np.float32]
    """Shape=(N,)."""
    classes: NDArray[np.intp]
    """Shape=(N,)."""
    coefficients: NDArray[np.float32]
    """Weights of the prototypes. Shape=(N, 32)."""


def decode(raw: NDArray[np.float32], layout: Layout, score: float = 0.25, overlap: float = 0.7) -> Detections:
    """Choose the objects: those with a score, without those that overlap a likelier one of their class.

    `raw` has Shape=(4 + classes + 32, M), (M, 5 + classes + 32) or (M, 6 + 32), as the layout says; `overlap` is the
    largest intersection over union of two boxes of a class.
    """
    if layout == "chosen":
        kept_rows = raw[np.argsort(-raw[:, 4], kind="stable")]
        kept_rows = kept_rows[kept_rows[:, 4] >= score]
        return Detections(
            kept_rows[:, :4], kept_rows[:, 4], kept_rows[:, 5].round().astype(np.intp),
            np.ascontiguousarray(kept_rows[:, 6:]),
        )  # fmt: skip
    if layout == "objectness":
        raw = raw.T
        raw = np.concatenate([raw[:4], raw[4] * raw[5:-PROTOTYPES], raw[-PROTOTYPES:]])
    raw = raw[:, raw[4:-PROTOTYPES].max(axis=0) >= score]
    classes, best = raw[4:-PROTOTYPES].argmax(axis=0), raw[4:-PROTOTYPES].max(axis=0)
    low, size = (raw[:2] - raw[2:4] / 2.0).T, raw[2:4].T
    boxes = np.concatenate([low, size], axis=1).tolist()
    kept = np.array(cv2.dnn.NMSBoxesBatched(boxes, best.tolist(), classes.tolist(), 0.0, overlap), np.intp)
    corners = np.concatenate([low, low + size], axis=1)[kept].astype(np.float32)
    return Detections(corners, best[kept], classes[kept], np.ascontiguousarray(raw[-PROTOTYPES:, kept].T))


def draw_masks(found: Detections, prototypes: NDArray[np.float32], net_size: tuple[int, int]) -> NDArray[np.float32]:
    """Return each object's mask: a weighted sum of prototypes, Shape=(32, h, w), cut at its box. Shape=(N, h, w)."""
    _, rows, columns = prototypes.shape
    sums = np.clip(np.tensordot(found.coefficients, prototypes, axes=1), -50.0, 50.0)
    masks = 1.0 / (1.0 + np.exp(-sums))
    x = (np.arange(columns) + 0.5) * net_size[0] / columns
    y = (np.arange(rows) + 0.5) * net_size[1] / rows
    x0, y0, x1, y1 = (found.boxes[:, k, None, None] for k in range(4))
    inside = (x >= x0) & (x <= x1) & (y[:, None] >= y0) & (y[:, None] <= y1)
    return np.where(inside, masks, 0.0).astype(np.float32)
