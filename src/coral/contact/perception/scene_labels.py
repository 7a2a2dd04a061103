"""Names and axes drawn into a picture of the scene, so that the numbers of a prompt can be found in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.advisor.question import Picture
from coral.contact.perception.camera import RgbdFrame
from coral.contact.scene.observation import Array, Observation
from coral.contact.scene.task import Task

AXIS_M = 0.1
"""Length of the drawn axes."""
MARGIN = 0.1
"""Margin around what is named, as a share of the picture."""
MOST_ZOOM = 3.0
"""Greatest enlargement."""
POINT, MOST_AWAY = 6, 120
"""Half the side of the square around a named point that no name covers, and the farthest that a name is from its
point, pixels."""
AROUND = ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (-1, 1), (1, -1), (-1, -1))
"""Where a name may stand beside its point, in the order in which it is tried: right is (1, 0), below is (0, 1)."""
FONT = 0.45
BLACK, WHITE = (0, 0, 0), (255, 255, 255)
Box = tuple[int, int, int, int]
"""Left, top, right, bottom, pixels."""
COLOURS = {"x": (230, 60, 60), "y": (60, 170, 60), "z": (70, 90, 240)}
CAPTION = (
    "The scene as the robot's camera sees it now, cut to it. Drawn in: the names of objects, fixed things (brackets) "
    "and places (crosses), the hand, and the world's axes at the origin, 0.1 m long."
)
ABOVE = "The same from above: x points up in the picture, y to the left."


@dataclass(frozen=True, eq=False)
class PictureLabels:
    """What is drawn: positions in the world, m, by name."""

    objects: Mapping[str, Array]
    """Believed positions of the objects."""
    fixtures: Mapping[str, Array]
    """Centres of the fixed things."""
    places: Mapping[str, Array]
    """Places of the task."""
    hand: Array
    """The tool."""

    @staticmethod
    def of(task: Task, now: Observation) -> PictureLabels:
        """Collect what a task names, where it is observed."""
        return PictureLabels(
            {name: body.position for name, body in now.objects.items() if name not in now.unseen},
            {item.name: np.asarray(item.position, float) for item in task.fixtures},
            {name: np.asarray(at, float) for name, at in task.places.items()},
            now.tool.position,
        )


def label_picture(frame: RgbdFrame, labels: PictureLabels, name: str = "scene", caption: str = CAPTION) -> Picture:
    """Draw names and axes into the part of a frame that shows the scene, and encode it as a picture for a question."""
    axes = [AXIS_M * axis for axis in (np.zeros(3), *np.eye(3))]
    named = [*labels.places.values(), *labels.fixtures.values(), labels.hand, *labels.objects.values()]
    frame = zoomed(frame, [*axes, *named])
    assert frame.rgb is not None
    image = np.ascontiguousarray(frame.rgb[..., ::-1])
    _draw_axes(image, frame)
    marks = [
        *_marks(frame, {f"[{name}]": at for name, at in labels.fixtures.items()}),
        *_marks(frame, {"hand": labels.hand}),
        *_marks(frame, labels.objects),
        *_marks(frame, labels.places),
    ]
    for place in labels.places:
        for pixel in (at for text, at in marks if text == place):
            cv2.drawMarker(image, pixel, BLACK, cv2.MARKER_TILTED_CROSS, 14, 3, cv2.LINE_AA)
            cv2.drawMarker(image, pixel, WHITE, cv2.MARKER_TILTED_CROSS, 12, 1, cv2.LINE_AA)
    boxes = place_names([(_size(text), at) for text, at in marks], image.shape[1], image.shape[0])
    for (text, pixel), box in zip(marks, boxes, strict=True):
        _draw_name(image, text, pixel, box, text not in labels.places)
    done, data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 6])
    assert done
    return Picture(name=name, png=bytes(data), caption=caption)


def zoomed(frame: RgbdFrame, points: Sequence[Array]) -> RgbdFrame:
    """Cut a frame to some points with a margin, and enlarge it to its size again; its lens changes with it.

    Points (m, world) that it does not show do not count.
    """
    height, width = frame.depth.shape
    pixels = (pixel_of(frame, point) for point in points)
    seen = [at for at in pixels if at and 0 <= at[0] < width and 0 <= at[1] < height]
    if not seen:
        return frame
    low, high = np.min(seen, axis=0), np.max(seen, axis=0)
    share = max(1.0 / MOST_ZOOM, *((high - low) / (width, height) + 2 * MARGIN))
    if share >= 1.0:
        return frame
    columns, rows = round(share * width), round(share * height)
    left, top = (
        int(np.clip(round(middle - size / 2), 0, whole - size))
        for middle, size, whole in zip((low + high) / 2, (columns, rows), (width, height), strict=True)
    )
    factors = width / columns, height / rows

    def cut(image: NDArray[Any], how: int) -> NDArray[Any]:
        part = image[top : top + rows, left : left + columns]
        return np.asarray(cv2.resize(part, (width, height), interpolation=how))

    fx, fy, cx, cy = frame.lens
    lens = np.array([fx * factors[0], fy * factors[1], (cx - left) * factors[0], (cy - top) * factors[1]])
    return replace(
        frame,
        depth=cut(frame.depth, cv2.INTER_NEAREST),
        instance=cut(frame.instance, cv2.INTER_NEAREST),
        rgb=None if frame.rgb is None else cut(frame.rgb, cv2.INTER_CUBIC),
        lens=lens,
    )


def place_names(names: Sequence[tuple[tuple[int, int], tuple[int, int]]], width: int, height: int) -> list[Box]:
    """Find room for names beside the points that they name, so that none covers another or a named point.

    Of each name its size (width, height) is given, and the pixel of its point. Returns boxes: left, top, right, bottom.
    """
    taken: list[Box] = [(x - POINT, y - POINT, x + POINT, y + POINT) for _, (x, y) in names]
    found: list[Box] = []
    for (wide, high), (x, y) in names:
        spots = (
            _box(x + away * dx - (1 - dx) * wide / 2, y + away * dy - (1 - dy) * high / 2, wide, high)
            for away in range(POINT + 2, MOST_AWAY, 6)
            for dx, dy in AROUND
        )
        inside = [box for box in spots if box[0] >= 0 and box[1] >= 0 and box[2] <= width and box[3] <= height]
        free = (box for box in inside if not any(_overlap(box, other) for other in taken))
        box = next(free, inside[0] if inside else _box(x, y, wide, high))
        found.append(box)
        taken.append(box)
    return found


def pixel_of(frame: RgbdFrame, point: Array) -> tuple[int, int] | None:
    """Return the pixel (column, row) of a point in the world, or None if it is not before the camera."""
    local = frame.T_world_camera[:3, :3].T @ (np.asarray(point) - frame.T_world_camera[:3, 3])
    if local[2] <= 0.01:
        return None
    fx, fy, cx, cy = frame.lens
    return round(float(fx * local[0] / local[2] + cx)), round(float(fy * local[1] / local[2] + cy))


def _draw_axes(image: NDArray[np.uint8], frame: RgbdFrame) -> None:
    begin = pixel_of(frame, np.zeros(3))
    for axis, (name, colour) in enumerate(COLOURS.items()):
        end = pixel_of(frame, AXIS_M * np.eye(3)[axis])
        if begin is not None and end is not None:
            cv2.arrowedLine(image, begin, end, colour[::-1], 2, cv2.LINE_AA, tipLength=0.2)
            _write(image, name, (end[0] + 3, end[1] - 3), colour)


def _marks(frame: RgbdFrame, points: Mapping[str, Array]) -> list[tuple[str, tuple[int, int]]]:
    found = ((name, pixel_of(frame, at)) for name, at in points.items())
    return [(name, pixel) for name, pixel in found if pixel is not None]


def _size(text: str) -> tuple[int, int]:
    (width, height), below = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, FONT, 3)
    return width + 2, height + below


def _box(left: float, top: float, width: int, height: int) -> Box:
    return round(left), round(top), round(left) + width, round(top) + height


def _overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _draw_name(image: NDArray[np.uint8], text: str, pixel: tuple[int, int], box: Box, dot: bool) -> None:
    nearest = int(np.clip(pixel[0], box[0], box[2])), int(np.clip(pixel[1], box[1], box[3]))
    for thickness, ink in ((3, BLACK), (1, WHITE)):
        if np.hypot(nearest[0] - pixel[0], nearest[1] - pixel[1]) > 2 * POINT:
            cv2.line(image, pixel, nearest, ink, thickness, cv2.LINE_AA)
        if dot:
            cv2.circle(image, pixel, thickness, ink, -1, cv2.LINE_AA)
    _, below = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, FONT, 3)
    _write(image, text, (box[0] + 1, box[3] - below), WHITE)


def _write(image: NDArray[np.uint8], text: str, at: tuple[int, int], colour: tuple[int, int, int]) -> None:
    for thickness, ink in ((3, BLACK), (1, colour[::-1])):
        cv2.putText(image, text, at, cv2.FONT_HERSHEY_SIMPLEX, FONT, ink, thickness, cv2.LINE_AA)
