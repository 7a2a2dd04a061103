"""Names and axes drawn into a picture of the scene, so that the numbers of a prompt can be found in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.advisor.question import Picture
from coral.contact.perception.camera import RgbdFrame
from coral.contact.scene.observation import Array, Observation
from coral.contact.scene.task import Task

AXIS_M = 0.1
"""Length of the drawn axes."""
COLOURS = {"x": (230, 60, 60), "y": (60, 170, 60), "z": (70, 90, 240)}
CAPTION = (
    "The scene as the robot's camera sees it now. Drawn in: the names of objects, fixed things (brackets) and places "
    "(crosses), the hand, and the world's axes at the origin, 0.1 m long."
)


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
            {name: body.position for name, body in now.objects.items()},
            {item.name: np.asarray(item.position, float) for item in task.fixtures},
            {name: np.asarray(at, float) for name, at in task.places.items()},
            now.tool.position,
        )


def label_picture(frame: RgbdFrame, labels: PictureLabels) -> Picture:
    """Draw names and axes into the colours of a frame, and encode it as a picture for a question."""
    assert frame.rgb is not None
    image = np.ascontiguousarray(frame.rgb[..., ::-1])
    _draw_axes(image, frame)
    for name, at in labels.places.items():
        _draw_name(image, frame, name, at, cross=True)
    for name, at in labels.fixtures.items():
        _draw_name(image, frame, f"[{name}]", at)
    _draw_name(image, frame, "hand", labels.hand)
    for name, at in labels.objects.items():
        _draw_name(image, frame, name, at)
    done, data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 6])
    assert done
    return Picture(name="scene", png=bytes(data), caption=CAPTION)


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


def _draw_name(image: NDArray[np.uint8], frame: RgbdFrame, name: str, at: Array, cross: bool = False) -> None:
    pixel = pixel_of(frame, at)
    if pixel is None:
        return
    if cross:
        cv2.drawMarker(image, pixel, (0, 0, 0), cv2.MARKER_TILTED_CROSS, 14, 3, cv2.LINE_AA)
        cv2.drawMarker(image, pixel, (255, 255, 255), cv2.MARKER_TILTED_CROSS, 12, 1, cv2.LINE_AA)
    _write(image, name, (pixel[0] - 4 * len(name), pixel[1] + (20 if cross else 4)), (255, 255, 255))


def _write(image: NDArray[np.uint8], text: str, at: tuple[int, int], colour: tuple[int, int, int]) -> None:
    for thickness, ink in ((3, (0, 0, 0)), (1, colour[::-1])):
        cv2.putText(image, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.45, ink, thickness, cv2.LINE_AA)
