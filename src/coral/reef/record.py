"""Record of a reef mission in its run folder, written during the mission."""

from __future__ import annotations

from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.config import Positive
from coral.reef.geometry import Frame
from coral.runs import RunWriter

COLUMNS = (
    "step",
    "t",
    "x",
    "y",
    "theta",
    "u",
    "v",
    "r",
    "est_x",
    "est_y",
    "est_theta",
    "v_cmd",
    "omega_cmd",
    "goal_x",
    "goal_y",
    "clearance",
    "planner_ok",
    "coverage",
    "clusters_covered",
    "odo_x",
    "odo_y",
    "odo_theta",
)
"""trajectory.csv: SI units, world frame for poses, body frame for velocities; goal empty when there is none.
est: where the robot believed it was; odo: where its odometry alone put it."""


@dataclass(frozen=True, kw_only=True)
class RecordCfg:
    """What a run folder holds besides its logs."""

    pictures: bool = True
    """Draw and keep the pictures of every question. An advisor that sees gets them in any case."""
    frames: bool = True
    """Keep the map and the camera pictures at intervals. The report's time slider and the video need them."""
    frame_period_s: Positive = 2.0
    report: bool = True
    """Write map.png and report.html at the end."""
    video: bool = False
    """Write mission.mp4 at the end."""


class FrameRecorder:
    """Writes the known map and the camera pictures every few seconds of simulated time, on a thread of its own."""

    def __init__(self, writer: RunWriter, cfg: RecordCfg, *, patient: bool = True) -> None:
        """Record into a run.

        Args:
            writer: The run's writer.
            cfg: What is kept.
            patient: Whether `offer` waits while two sets are still to be written, so that none is left out; if not,
                the new one is left out.
        """
        self._writer, self._cfg, self._patient = writer, cfg, patient
        self._due = 0.0
        self._thread = ThreadPoolExecutor(1, "coral-frames")
        self._open: deque[Future[None]] = deque()
        self.left_out = 0
        """Sets of pictures that were left out because the disk was too slow."""

    def offer(self, step: int, t: float, cells: Any, frame: Frame) -> None:
        """Write a set of pictures if it is due. `cells()` returns the classes of the map, Shape=(NY, NX).

        Raises:
            OSError: An earlier set could not be written.
        """
        if not self._cfg.frames or t < self._due - 1e-9:
            return
        self._due = t + self._cfg.frame_period_s
        self._finish(1)
        if len(self._open) > 1:
            self.left_out += 1
            return
        self._open.append(self._thread.submit(self._write, step, cells(), frame))

    def close(self) -> None:
        """Finish what was offered.

        Raises:
            OSError: A set could not be written.
        """
        self._patient = True
        try:
            self._finish(0)
        finally:
            self._thread.shutdown()

    def _finish(self, leaving: int) -> None:
        """Take note of the sets that have been written; wait until no more than `leaving` are open, if patient."""
        while self._open and (self._open[0].done() or (self._patient and len(self._open) > leaving)):
            self._open.popleft().result()

    def _write(self, step: int, cells: NDArray[np.uint8], frame: Frame) -> None:
        millimetres = np.where(np.isfinite(frame.depth), np.minimum(frame.depth * 1000.0, 65535.0), 0.0)
        for name, image in (("map", cells), ("depth", millimetres.astype(np.uint16)), ("labels", frame.labels)):
            self._writer.bytes(f"frames/{step:06d}_{name}.png", _png(image))
        if frame.rgb is not None:
            self._writer.bytes(f"frames/{step:06d}_rgb.png", _png(frame.rgb[..., ::-1]))


def _png(image: NDArray[Any]) -> bytes:
    ok, encoded = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 3])
    if not ok:
        raise RuntimeError("a picture could not be encoded as PNG")
    return encoded.tobytes()
