"""The run folder of a survey in real time, written off the control thread."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from coral.advisor.consult import Attempt
from coral.advisor.log import AttemptRecorder
from coral.config import to_mapping
from coral.reef.map.belief import Belief
from coral.reef.map.chain import Track
from coral.reef.map.landmark_map import LandmarkMap
from coral.reef.mission.judge import MissionJudge
from coral.reef.mission.record import COLUMNS, FrameRecorder, RecordCfg
from coral.reef.sea.background import BackgroundWork
from coral.reef.sea.frames import LocalFrame
from coral.reef.sea.safety import SailCfg
from coral.reef.sea.saved_survey import save_survey
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.simulation.coverage import CoverageMeter
from coral.reef.simulation.imaging import ImagingMeter
from coral.reef.simulation.simulator import SimulatorCfg, seen_through_water
from coral.reef.vehicle.camera import Camera
from coral.reef.vehicle.collision import ContactCounter
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import ReefWorld, save_world
from coral.run_files import RunFiles, SurveyFiles
from coral.runs import RunWriter, provenance

OWN_COLUMNS = tuple(name for name in COLUMNS if not name.startswith("est_"))
"""Columns of a vehicle of which nobody knows the truth: x, y and theta are where it believed it was."""
SAVE_S, SAVE_SHARE = 5.0, 0.05
"""Least time from one saving of the map to the next (s), and the largest share of the time that they take: a large map
on a busy machine must not hold up the rows."""
PATH_M = 0.02
"""Spacing of the points at which contacts are checked between two poses."""


class SeaRecord:
    """Takes what happens from the control loop and writes it in the background.

    If the disk fills up, the recording stops and says so; the loop continues.
    """

    def __init__(
        self,
        folder: Path,
        record: RecordCfg,
        world: ReefWorld | None,
        simulator: SimulatorCfg,
        *,
        threaded: bool = True,
    ) -> None:
        """Create the folder; `world` is None where the reef is real and nobody knows the truth.

        Without `threaded`, for tests, `work.drain` writes.

        Raises:
            InputError: The folder cannot be used.
        """
        self.folder, self._world = folder, world
        self.writer = RunWriter(folder, COLUMNS if world is not None else OWN_COLUMNS)
        self.work = BackgroundWork(threaded=threaded)
        self.listeners: list[Callable[[dict[str, Any]], None]] = []
        """Functions called with every event, on the thread that emits it."""
        self.frames, self._attempts = FrameRecorder(self.writer, record, self.work.offer), AttemptRecorder(folder)
        self._save_due_s = SAVE_S
        self._truth_step, self._truth_t = 0, 0.0
        self.truth = None if world is None else ReefTruth(world, simulator, folder, self._told_by_truth)

    def head(
        self, area: SurveyArea, about: Mapping[str, Any], cfg: SailCfg, response: VehicleResponse, frame: LocalFrame
    ) -> None:
        """Write world.yaml (in real water the area with its outlines) and config.yaml, which begins with `about`."""
        if self._world is not None:
            save_world(self._world, self.folder / SurveyFiles.WORLD)
        else:
            outlines = [{"name": name, "metres": [list(p) for p in ring]} for name, ring in area.keep_out]
            fence = [list(p) for p in area.fence]
            content = {
                "name": area.name,
                "size_m": list(area.size_m),
                "start": area.start._asdict(),
                "datum": None if area.origin is None else list(area.origin.to_degrees(area.start.x, area.start.y)),
                "geofence": fence,
                "keep_out": outlines,
            }
            self.writer.yaml(SurveyFiles.WORLD, content)
        self.writer.yaml(
            RunFiles.CONFIG,
            {
                "system": "reef",
                **about,
                "mission": to_mapping(cfg.mission),
                "safety": to_mapping(cfg.safety),
                "depth_m": cfg.depth_m,
                "response": to_mapping(response),
                "frame": dataclasses.asdict(frame),
                "provenance": provenance(),
            },
        )

    def event(self, step: int, t: float, event: str, **fields: Any) -> None:
        """Record an event."""
        self.work.offer(lambda: self.writer.event(step, t, event, **fields))
        for hear in self.listeners:
            hear({"step": step, "t": t, "event": event, **fields})

    def attempt(self, attempt: Attempt) -> None:
        """Record an attempt at a decision, with its pictures."""
        self.work.offer(lambda: self._attempts(attempt))

    def tick(
        self,
        step: int,
        t: float,
        pose: Pose,
        odometry: Pose,
        true_pose: Pose | None,
        state: tuple[float, ...],
        own: tuple[float, float, int],
    ) -> None:
        """Record one control tick: where the vehicle believed it was, by odometry alone, and truly if that is known.

        `state` goes from u to goal_y, as in `OWN_COLUMNS`, nan where there is no goal, then planner_ok. `own` is by the
        vehicle's own map: distance to an obstacle (m), share of its clusters done, their number.
        """

        def write() -> None:
            u, v, r, v_cmd, omega_cmd, goal_x, goal_y, planner_ok = state
            goal = ("", "") if goal_x != goal_x else (goal_x, goal_y)
            if self.truth is None or true_pose is None:
                self.writer.row(
                    step, t, *pose, u, v, r, v_cmd, omega_cmd, *goal, own[0], planner_ok, *own[1:], *odometry
                )
                return
            self._truth_step, self._truth_t = step, t
            self.truth.follow(step, t, true_pose)
            judge = self.truth.judge
            judged = (self.truth.clearance_m(true_pose), planner_ok, judge.coverage, len(judge.covered))
            self.writer.row(step, t, *true_pose, u, v, r, *pose, v_cmd, omega_cmd, *goal, *judged, *odometry)

        self.work.offer(write)

    def offer_survey(self, t: float, belief: Belief, landmarks: LandmarkMap, *, last: bool = False) -> None:
        """Save the map if it is due, or if this is the last time, so that a killed survey can be gone on with.

        The map may change while it is copied. Then it has half of a picture, whose cells are evidence by themselves.
        """
        if not last and t < self._save_due_s:
            return
        self._save_due_s = math.inf
        tracks = tuple(belief.tracks)

        def save() -> None:
            begun = time.monotonic()
            save_survey(self.folder, belief, landmarks, tracks)
            self._save_due_s = t + max(SAVE_S, (time.monotonic() - begun) / SAVE_SHARE)

        if not self.work.offer(save):
            self._save_due_s = t + SAVE_S

    def close(self) -> None:
        """Write what waits and close all files."""
        self.work.offer(self.frames.close)
        self.work.close()
        self._attempts.close()
        self.writer.close()
        if self.truth is not None:
            self.truth.judge.close()

    def _told_by_truth(self, event: str, **fields: Any) -> None:
        """Record an event of the truth; this is the background's thread."""
        self.writer.event(self._truth_step, self._truth_t, event, **fields)
        for hear in self.listeners:
            hear({"step": self._truth_step, "t": self._truth_t, "event": event, **fields})


class ReefTruth:
    """Counts as the simulator does, for a vehicle that moves by itself. No decision reads it."""

    def __init__(self, world: ReefWorld, cfg: SimulatorCfg, folder: Path, emit: Callable[..., None]) -> None:
        """Begin a record in `folder`; `emit(event, **fields)` is told of contacts and covered clusters."""
        scene = Scene.from_world(world)
        self._emit = emit
        self._last: Pose | None
        self._coverage = CoverageMeter(scene, seen_through_water(cfg))
        self._imaging = ImagingMeter(scene, cfg.camera, cfg.imaging, visibility_m=cfg.noise.visibility_m)
        self._contacts = ContactCounter(scene.footprints(), cfg.vehicle.hull_radius_m)
        self._camera, self._last = Camera(scene, cfg.camera), None
        self.judge = MissionJudge(world, scene, self._coverage, self._imaging, folder, emit)

    def clearance_m(self, pose: Pose) -> float:
        """Return the true distance from the hull to the nearest obstacle (m)."""
        return self._contacts.clearance(pose.x, pose.y)

    def follow(self, step: int, t: float, pose: Pose) -> None:
        """Move on to the vehicle's true pose at a tick."""
        before = self._last or pose
        count = max(1, int(np.hypot(pose.x - before.x, pose.y - before.y) / PATH_M))
        track = np.linspace(before[:2], pose[:2], count + 1)[1:]
        for x, y, obstacle in self._contacts.follow(track):
            self._emit("collision", x=round(x, 3), y=round(y, 3), obstacle=obstacle)
        self._last = pose
        self._coverage.update(pose)
        self._imaging.update(pose)
        self.judge.note(step, t, pose, None if self.judge.words is None else (pose, self._camera.render(pose)))

    def verdict(self, tracks: Sequence[Track], instruction: str = "", answer: str | None = None) -> dict[str, Any]:
        """Return the fields of the `judged` event, as the judge does."""
        return self.judge.verdict(tracks, self._contacts.count, instruction, answer)
