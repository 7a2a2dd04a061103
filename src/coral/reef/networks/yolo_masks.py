"""Decodes the outputs of YOLO segmentation networks: boxes, class scores and coefficients of mask prototypes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

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
    scores = raw[4:-PROTOTYPES]
    classes = scores.argmax(axis=0)
    best = scores.max(axis=0)
    order = np.argsort(-best, kind="stable")
    order = order[best[order] >= score]
    middle, half = raw[:2, order].T, raw[2:4, order].T / 2.0
    boxes = np.concatenate([middle - half, middle + half], axis=1)
    kept: list[int] = []
    for k in range(len(order)):
        rivals = [j for j in kept if classes[order[j]] == classes[order[k]]]
        if not rivals or box_overlap(boxes[k], boxes[rivals]).max() <= overlap:
            kept.append(k)
    chosen = order[kept]
    return Detections(
        boxes[kept].astype(np.float32), best[chosen], classes[chosen], np.ascontiguousarray(raw[-PROTOTYPES:, chosen].T)
    )


def box_overlap(box: NDArray[np.float32], others: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the intersection over union of a box with others. Shape=(4,) and (N, 4) to (N,)."""
    low, high = np.maximum(box[:2], others[:, :2]), np.minimum(box[2:], others[:, 2:])
    common = np.prod(np.maximum(high - low, 0.0), axis=1)
    area = float(np.prod(box[2:] - box[:2])) + np.prod(others[:, 2:] - others[:, :2], axis=1)
    return np.asarray(common / np.maximum(area - common, 1e-9), np.float64)


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
