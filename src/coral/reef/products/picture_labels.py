"""Labels of some pictures for people to correct, so that the next network learns them: outlines and points."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.config import Count
from coral.drawing import jpeg
from coral.file_writer import write_whole
from coral.reef.products.map_files import write_table
from coral.reef.products.product_files import ProductFiles
from coral.reef.products.seen_points import lens_of, transform_of
from coral.reef.recordings.recording import PosedFrame, Recording
from coral.reef.world.geometry import Label

COCO, CORALNET, POINTS = (Path(name).name for name in (ProductFiles.COCO, ProductFiles.CORALNET, ProductFiles.POINTS))
CORALNET_COLUMNS = ("Name", "Row", "Column", "Label")
POINT_COLUMNS = (*CORALNET_COLUMNS, "Doubt", "x_m", "y_m")
_LEAST_PIXELS = 6
"""Of an outline: smaller patches are noise to correct."""


@dataclass(frozen=True, kw_only=True)
class LabelsCfg:
    """Which pictures and points people get to correct."""

    pictures: int = 20
    """Pictures, spread evenly over the survey; 0 for none."""
    points: Count = 50
    """Points of a picture, one at random in each part of a grid over it."""


def write_labels(recording: Recording, count: int, cfg: LabelsCfg, folder: Path) -> list[str]:
    """Write some of a located recording's `count` pictures and what was seen in them; return the files, if any."""
    if not (cfg.pictures and count):
        return []
    images: list[dict[str, Any]] = []
    outlines: list[dict[str, Any]] = []
    points: list[dict[str, Any]] = []
    step = -(-count // cfg.pictures)
    for k, keyframe in enumerate(recording.keyframes()):
        rgb = keyframe.frame.rgb
        if rgb is None:
            return []
        if k % step:
            continue
        name = f"{recording.name}_{k:06d}.jpg"
        write_whole(folder / name, jpeg(rgb))
        number = len(images) + 1
        images.append({"id": number, "file_name": name, "width": rgb.shape[1], "height": rgb.shape[0]})
        for one in find_outlines(keyframe.frame.labels):
            outlines.append({"id": len(outlines) + 1, "image_id": number, "category_id": 1, "iscrowd": 0, **one})
        points += [{"Name": name, **one} for one in choose_points(keyframe, recording, cfg.points, k)]
    content = {
        "info": {"description": f"oysters in pictures of {recording.name}, as seen by {recording.seen_by}; to correct"},
        "images": images, "categories": [{"id": 1, "name": "oyster"}], "annotations": outlines,
    }  # fmt: skip
    write_whole(folder / COCO, json.dumps(content))
    write_table(folder / CORALNET, CORALNET_COLUMNS, [{key: one[key] for key in CORALNET_COLUMNS} for one in points])
    write_table(folder / POINTS, POINT_COLUMNS, points)
    return [COCO, CORALNET, POINTS, *(str(one["file_name"]) for one in images)]


def find_outlines(labels: NDArray[np.uint8]) -> Iterator[Mapping[str, Any]]:
    """Yield the outline of each patch of oysters in labels as COCO has it: segmentation, box and area (px)."""
    mask = (labels == Label.OYSTER).astype(np.uint8)
    rings, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    for ring in rings:
        x, y, width, height = cv2.boundingRect(ring)
        inside = np.zeros((height, width), np.uint8)
        cv2.drawContours(inside, [ring], 0, 1, -1, offset=(-x, -y))
        if len(ring) >= 3 and inside.sum() >= _LEAST_PIXELS:
            area = int(inside.sum())
            yield {"segmentation": [ring.reshape(-1).tolist()], "bbox": [x, y, width, height], "area": area}


def choose_points(keyframe: PosedFrame, recording: Recording, count: int, seed: int) -> Iterator[Mapping[str, Any]]:
    """Yield about `count` points, rows and columns from 0, with class, doubt, and place on the map where known."""
    frame, rng = keyframe.frame, np.random.default_rng([seed, 11])
    height, width = frame.labels.shape
    columns = max(round((count * width / height) ** 0.5), 1)
    rows = max(round(count / columns), 1)
    focal, cx, cy = lens_of(recording)
    transform = transform_of(keyframe, recording)
    for i in range(rows * columns):
        row = int((i // columns + rng.random()) * height / rows)
        column = int((i % columns + rng.random()) * width / columns)
        depth = float(frame.depth[row, column])
        place: Any = (None, None)
        if np.isfinite(depth):
            ray = np.array([(column - cx) * depth / focal, (row - cy) * depth / focal, depth, 1.0])
            place = np.round((transform @ ray)[:2], 3).tolist()
        yield {
            "Row": row, "Column": column, "Label": Label(int(frame.labels[row, column])).name.lower(),
            "Doubt": None if frame.doubt is None else round(float(frame.doubt[row, column]), 3),
            "x_m": place[0], "y_m": place[1],
        }  # fmt: skip
