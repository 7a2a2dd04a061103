"""What really happened in a simulated reef: coverage, imaging and contacts along a vehicle's true path."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from coral.reef.map.chain import Track
from coral.reef.mission.judge import MissionJudge
from coral.reef.simulation.coverage import CoverageMeter
from coral.reef.simulation.imaging import ImagingMeter
from coral.reef.simulation.simulator import SimulatorCfg, seen_through_water
from coral.reef.vehicle.camera import Camera
from coral.reef.vehicle.collision import ContactCounter
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import ReefWorld

PATH_M = 0.02
"""Spacing of the points at which contacts are checked between two poses."""


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
