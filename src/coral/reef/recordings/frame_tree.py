"""The tree of frames of a recording, as /tf and /tf_static give it, and where a body was in its map at any time."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from coral.reef.recordings.transforms import StampedTransforms, Transform, euler_of
from coral.reef.world.geometry import Pose

MAP = "map"
"""Frame of the map (REP-105)."""
_DOWNWARD = re.compile(r"(^|[_/.-])(ned|frd)($|[_/.-])", re.IGNORECASE)


def frame_name(text: str) -> str:
    """Return a frame's name without the slash that ROS 1 put before it."""
    return text.lstrip("/")


def points_down(frame: str) -> bool:
    """Whether a frame's name says that its z axis points down: world_ned, base_link_frd."""
    return _DOWNWARD.search(frame) is not None


class FrameTree:
    """Transforms between frames, by the child's name. A static one holds at every time."""

    def __init__(self) -> None:
        self._parents: dict[str, str] = {}
        self._static: dict[str, Transform] = {}
        self._moving: dict[str, StampedTransforms] = {}

    def add(self, parent: str, child: str, transform: Transform, t: float | None) -> None:
        """Add T_child^parent at time `t` (s); None: at every time.

        Raises:
            ValueError: The child has another parent already, or time goes back.
        """
        parent, child = frame_name(parent), frame_name(child)
        if self._parents.setdefault(child, parent) != parent:
            raise ValueError(f"{child} below {parent} and below {self._parents[child]}: a frame has one parent")
        if t is None:
            self._static[child] = transform
        else:
            self._moving.setdefault(child, StampedTransforms()).add(t, transform)

    def _way(self, ancestor: str, frame: str) -> list[str] | None:
        """Return the frames from below `ancestor` down to `frame`; None if it is no ancestor."""
        way: list[str] = []
        while frame != ancestor:
            parent = self._parents.get(frame)
            if parent is None or frame in way:
                return None
            way.append(frame)
            frame = parent
        return way[::-1]

    def joins(self, ancestor: str, frame: str) -> bool:
        """Whether a chain of transforms leads from a frame up to another."""
        return self._way(ancestor, frame) is not None

    def at(self, ancestor: str, frame: str, t: float, *, latest: bool = False) -> Transform | None:
        """Return T_frame^ancestor at a time (s), for a frame below the ancestor. Shape=(4, 4).

        `latest` takes the stamp nearest in time however far it is, as for what corrects an odometry; otherwise None
        where no stamp is near.
        """
        whole: Transform = np.eye(4)
        for child in self._way(ancestor, frame) or ():
            step = self._static.get(child)
            if step is None:
                moving = self._moving[child]
                step = moving.transforms[moving.nearest(t)] if latest else moving.at(t)
            if step is None:
                return None
            whole = whole @ step
        return whole

    def first(self, ancestor: str, frame: str) -> Transform | None:
        """Return the first T_frame^ancestor that is known; None if no chain leads there. Shape=(4, 4)."""
        way = self._way(ancestor, frame)
        if way is None:
            return None
        starts = [self._moving[child].times[0] for child in way if child not in self._static]
        return self.at(ancestor, frame, max(starts, default=0.0), latest=True)

    def frames(self) -> Iterator[str]:
        """Return the names of all frames."""
        return iter(sorted({*self._parents, *self._parents.values()}))


@dataclass
class BodyTrack:
    """Poses of a body in the map: odometry, and what the tree of frames corrects of it."""

    tree: FrameTree = field(default_factory=FrameTree)
    odometry: StampedTransforms = field(default_factory=StampedTransforms)
    """T_body^odom."""
    parent: str = ""
    child: str = ""
    """Frames of the odometry and of the body."""
    lift: Transform = field(default_factory=lambda: np.eye(4))
    """Transform to a map whose z counts from the sea floor; by default the map's own does. Shape=(4, 4)."""

    def at(self, t: float) -> tuple[Transform, Pose | None] | None:
        """Return T_body^map, and the pose by odometry alone if it is corrected; None where no pose is near."""
        body = self.odometry.at(t)
        if body is None:
            return None
        body = self.lift @ body
        if self.parent == MAP or not self.tree.joins(MAP, self.parent):
            return body, None
        correction = self.tree.at(MAP, self.parent, t, latest=True)
        assert correction is not None
        return correction @ body, Pose(float(body[0, 3]), float(body[1, 3]), euler_of(body[:3, :3])[2])
