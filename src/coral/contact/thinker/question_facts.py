"""Facts of the question about poses, which objects do not have yet, for advisors without vision."""

from __future__ import annotations

from typing import TypedDict

from coral.contact.scene.facts import TableFacts


class UnposedObjectFacts(TypedDict):
    """An object whose pose is to be estimated.

    Args:
        label: Its name for people.
        size_m: Full extents of its bounding box.
        middle_m: Centre of that box in the object's frame.
        points_m: Named points, relative to the centre of the box.
        usual_pose: Pose in the task file: x, y, z, qw, qx, qy, qz.
        pixels: Number of its pixels with a measured depth.
        seen_box_m: Lowest and highest corner of the measured points, in the world; None without any.
    """

    label: str
    size_m: list[float]
    middle_m: list[float]
    points_m: dict[str, list[float]]
    usual_pose: list[float]
    pixels: int
    seen_box_m: list[list[float]] | None


class CameraFacts(TypedDict):
    """The camera: position (m) and axes in the world, intrinsics and picture size."""

    position: list[float]
    axes_right_down_forward: list[list[float]]
    focal_px: float
    width_px: int
    height_px: int


class ToolFacts(TypedDict):
    """The tool's pose: x, y, z, qw, qx, qy, qz."""

    pose: list[float]


class PoseFacts(TypedDict):
    """Facts of the question about the objects' poses."""

    task: str
    instruction: str
    objects: dict[str, UnposedObjectFacts]
    table: TableFacts
    hand: ToolFacts
    camera: CameraFacts
