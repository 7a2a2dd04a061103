"""Record of a reef mission in its run folder, written during the mission."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from coral.config import Positive
from coral.drawing import jpeg, png
from coral.errors import naming
from coral.file_writer import open_log
from coral.reef.eyes.doubt import pack_doubt
from coral.reef.world.geometry import Frame, Pose
from coral.run_files import SurveyFiles
from coral.runs import RunWriter

TRAJECTORY = {
    "step t": "number of the step and simulated time (s)",
    "x y theta": "true pose in the world (m, rad); at sea, where the vehicle believed it was",
    "u v r": "velocity, forward, to port and turning, in the body's frame (m/s, rad/s)",
    "est_x est_y est_theta": "where the robot believed it was; not at sea, where nobody knows better",
    "v_cmd omega_cmd": "commanded speed (m/s) and rate of turn (rad/s)",
    "goal_x goal_y": "the goal (m); empty without one",
    "clearance": "distance from the hull to the nearest obstacle (m), in truth; at sea, by its own map",
    "planner_ok": "whether the planner found a feasible rollout",
    "coverage clusters_covered": "share and number of the true clusters covered so far",
    "odo_x odo_y odo_theta": "where odometry alone put the robot",
}
"""Columns of trajectory.csv, SI units."""
COLUMNS = tuple(" ".join(TRAJECTORY).split())


POSE_COLUMNS = (
    "t", "x", "y", "z", "roll", "pitch", "yaw", "odo_x", "odo_y", "odo_yaw", "labels", "depth", "rgb",
    "doubt",
)  # fmt: skip
"""Columns of frames/poses.csv: where the robot believed the camera was, z being its height above the seabed; where
odometry alone put it; names of the pictures (empty where there is none: exact perception has no doubt). SI units, world
frame, REP-103."""


@dataclass(frozen=True, kw_only=True)
class PicturePose:
    """Where a picture was taken, by the robot's own estimate."""

    pose: Pose
    odometry: Pose
    """By odometry alone."""
    height_m: float
    """Height of the camera above the seabed (m)."""
    roll: float = 0.0
    pitch: float = 0.0


@dataclass(frozen=True, kw_only=True)
class RecordCfg:
    """What a run folder holds besides its logs."""

    pictures: bool = True
    """Draw and keep the pictures of every question. An advisor that sees gets them in any case."""
    frames: bool = True
    """Keep the map and the camera pictures at intervals. The report's time slider and the video need them. The final
    map is kept in any case."""
    frame_period_s: Positive = 2.0
    keyframes: bool = True
    """Keep camera pictures with their poses besides, for products, export and a map made anew: some 10 kB a second,
    twice that with colour, 70 kB with what a network saw and its doubt. Needs `frames`."""
    keyframe_period_s: Positive = 0.5
    """Time between keyframes. At full speed the vehicle moves 0.3 m in it."""
    report: bool = True
    """Write map.png and report.html at the end."""
    video: bool = False
    """Write mission.mp4 at the end."""


class FrameRecorder:
    """Writes the known map and the camera pictures every few seconds.

    `later` takes the writing of a set; None: a thread of its own, for which `offer` waits while two sets are still to
    be written.
    """

    def __init__(
        self, writer: RunWriter, cfg: RecordCfg, later: Callable[[Callable[[], None]], object] | None = None
    ) -> None:
        self._writer, self._cfg, self._later = writer, cfg, later or self._submit
        self._due = self._keyframe_due = 0.0
        self._poses: IO[str] | None = None
        self._thread = ThreadPoolExecutor(1, "coral-frames")
        self._open: deque[Future[None]] = deque()

    def offer(self, step: int, t: float, cells: Any, frame: Frame, taken_at: PicturePose | None = None) -> None:
        """Write a set of pictures if it is due.

        `cells` returns the classes of the map, Shape=(NY, NX). A picture is a keyframe only with the place where it was
        taken, if that is known and the pilot got it.

        Raises:
            OSError: An earlier set could not be written.
        """
        cfg = self._cfg
        with_map = cfg.frames and t >= self._due - 1e-9
        keyframe = cfg.frames and cfg.keyframes and taken_at is not None and t >= self._keyframe_due - 1e-9
        if not with_map and not keyframe:
            return
        if with_map:
            self._due = t + cfg.frame_period_s
        if keyframe:
            self._keyframe_due = t + cfg.keyframe_period_s
        now = cells() if with_map else None
        self._later(lambda: self._write(step, t, now, frame, taken_at if keyframe else None))

    def keep_final_map(self, step: int, cells: Callable[[], NDArray[np.uint8]]) -> None:
        """Write the map of a run that keeps no snapshots: some kB, without which its report would show none."""
        if not self._cfg.frames:
            self._writer.bytes(f"{SurveyFiles.FRAMES}{step:06d}_map.png", png(cells()))

    def close(self) -> None:
        """Finish what was offered.

        Raises:
            OSError: A set could not be written.
        """
        try:
            self._finish(0)
        finally:
            self._thread.shutdown()
            if self._poses is not None:
                self._poses.close()

    def _submit(self, write: Callable[[], None]) -> None:
        self._finish(1)
        self._open.append(self._thread.submit(write))

    def _finish(self, leaving: int) -> None:
        """Take note of the sets that have been written; wait until no more than `leaving` are open."""
        while self._open and (self._open[0].done() or len(self._open) > leaving):
            self._open.popleft().result()

    def _write(
        self, step: int, t: float, cells: NDArray[np.uint8] | None, frame: Frame, taken_at: PicturePose | None
    ) -> None:
        millimetres = np.where(np.isfinite(frame.depth), np.minimum(frame.depth * 1000.0, 65535.0), 0.0)
        images: dict[str, NDArray[Any]] = {"depth": millimetres.astype(np.uint16), "labels": frame.labels}
        if cells is not None:
            images["map"] = cells
        for name, image in images.items():
            self._writer.bytes(f"{SurveyFiles.FRAMES}{step:06d}_{name}.png", png(image))
        names = [f"{step:06d}_labels.png", f"{step:06d}_depth.png", "", ""]
        if frame.rgb is not None:
            names[2] = f"{step:06d}_rgb.jpg"
            self._writer.bytes(f"{SurveyFiles.FRAMES}{names[2]}", jpeg(frame.rgb))
        if taken_at is not None:
            if frame.doubt is not None:
                names[3] = f"{step:06d}_doubt.png"
                self._writer.bytes(f"{SurveyFiles.FRAMES}{names[3]}", png(pack_doubt(frame.doubt)))
            self._note_pose(t, taken_at, names)

    def _note_pose(self, t: float, at: PicturePose, names: list[str]) -> None:
        """Append a row to frames/poses.csv, after its pictures: a killed run has no row without them."""
        path = self._writer.folder / SurveyFiles.POSES
        with naming(path):
            if self._poses is None:
                self._poses = open_log(path)
                self._poses.write(",".join(POSE_COLUMNS) + "\n")
            values = (t, at.pose.x, at.pose.y, at.height_m, at.roll, at.pitch, at.pose.theta, *at.odometry)
            self._poses.write(",".join([*(f"{v:.9g}" for v in values), *names]) + "\n")
