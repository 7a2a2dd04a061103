"""A recording: camera pictures with the poses they were taken from, wherever they come from."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from coral.errors import InputError
from coral.reef.map.mapping import MapCfg, OccupancyMap
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Pose

MARGIN_M = 6.5
"""What a map without a stated area reaches beyond the outermost pose: the map's range, and half a metre."""
LARGEST_M = 500.0
RECORDED, EXACT = "recorded", "exact"


@dataclass(frozen=True, kw_only=True)
class PosedFrame:
    """A picture and where it was taken."""

    t: float
    """Time since the recording's start (s)."""
    pose: Pose
    """Of the camera in the plane, world ENU."""
    height_m: float
    """Height of the camera above the seabed (m)."""
    frame: Frame
    roll: float = 0.0
    pitch: float = 0.0
    """Of the body, without the camera's own tilt (rad, REP-103)."""
    odometry: Pose | None = None
    """The same pose by odometry alone; None where it is not known apart."""


@dataclass(frozen=True, kw_only=True)
class Recording:
    """A survey that was recorded. Poses are in a plane frame, x east and y north where it has a compass."""

    name: str
    source: str
    """Path, for messages."""
    camera: CameraCfg
    keyframes: Callable[[], Iterator[PosedFrame]]
    """Reads the keyframes, in order of time; may be called again."""
    area: tuple[float, float, float, float] | None = None
    """x and y of the south-west corner of the area to be mapped, its width and height (m); None: about the poses."""
    map: MapCfg = field(default_factory=MapCfg)
    """How pictures become a map."""
    start: Pose | None = None
    """Pose at the start of the survey; None: of the first keyframe."""
    seen_by: str = RECORDED
    """Who found classes and depth: "recorded", nobody knows; "exact", a simulator; or the name of a network."""
    datum: tuple[float, float] | None = None
    """Latitude and longitude of the start, if the recording knows them (degrees); x is east and y north there."""
    remarks: tuple[str, ...] = ()
    """What the user should know of how it was read."""
    omitted: set[float] = field(default_factory=set)
    """Times of pictures that were left out for want of a pose near them (s); known after all have been read."""

    def located(self) -> Recording:
        """Return the recording with its area in full cells, and poses from the area's corner on.

        Raises:
            InputError: There is no keyframe, or the area is too large to be mapped.
        """
        area, start = self.area, self.start
        if area is None or start is None:
            poses = [keyframe.pose for keyframe in self.keyframes()]
            if not poses:
                raise InputError(self.source, "", "no picture with a pose", "at least one")
            area, start = area or _around(poses, self.map.cell_m), start or poses[0]
        x, y, width, height = area
        if not (0.0 < width <= LARGEST_M and 0.0 < height <= LARGEST_M):
            raise InputError(
                self.source, "area", f"{width:.0f} x {height:.0f} m", f"a survey of at most {LARGEST_M:.0f} m"
            )
        read = self.keyframes

        def moved() -> Iterator[PosedFrame]:
            for keyframe in read():
                yield replace(keyframe, pose=_moved(keyframe.pose, x, y))

        corner_free = (0.0, 0.0, width, height)
        unchanged = (x, y) == (0.0, 0.0)
        return replace(
            self,
            keyframes=read if unchanged else moved,
            area=corner_free,
            start=start if unchanged else _moved(start, x, y),
        )

    @property
    def size_m(self) -> tuple[float, float]:
        """Width and height of the area of a located recording (m)."""
        assert self.area is not None
        return self.area[2], self.area[3]


def map_of(recording: Recording) -> OccupancyMap:
    """Make the occupancy map of a located recording.

    Raises:
        InputError: A picture is not one of the recording's camera.
    """
    cells = OccupancyMap(recording.size_m, recording.camera, recording.map)
    for keyframe in recording.keyframes():
        cells.integrate(keyframe.frame, keyframe.pose, keyframe.roll, keyframe.pitch)
    return cells


def _moved(pose: Pose, x: float, y: float) -> Pose:
    return Pose(pose.x - x, pose.y - y, pose.theta)


def _around(poses: list[Pose], cell_m: float) -> tuple[float, float, float, float]:
    """Return the area that holds all that can be seen from some poses, in whole cells of the world's grid."""
    at = np.array([pose[:2] for pose in poses])
    low = np.floor((at.min(axis=0) - MARGIN_M) / cell_m) * cell_m
    high = np.ceil((at.max(axis=0) + MARGIN_M) / cell_m) * cell_m
    if not np.isfinite(at).all() or math.hypot(*(high - low)) > 10 * LARGEST_M:
        return float(low[0]), float(low[1]), math.inf, math.inf
    width, height = high - low
    return float(low[0]), float(low[1]), round(float(width), 6), round(float(height), 6)
