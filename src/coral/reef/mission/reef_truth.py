"""What really happened in a simulated reef: coverage, imaging and contacts along a vehicle's true path."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from coral.reef.map.chain import Track
from coral.reef.mission.judge import MissionJudge
from coral.reef.mission.word_judge import WordJudge, told_verdict
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
        self.world, self._emit = world, emit
        self._coverage = CoverageMeter(scene, seen_through_water(cfg))
        self._imaging = ImagingMeter(scene, cfg.camera, cfg.imaging, visibility_m=cfg.noise.visibility_m)
        self._contacts = ContactCounter(scene.footprints(), cfg.vehicle.hull_radius_m)
        self._judge = MissionJudge(world, self._imaging, folder)
        self._camera = Camera(scene, cfg.camera)
        self._words = None if world.mission is None else WordJudge(world, scene, world.mission, cfg.camera)
        self._contacts_made, self._over = 0, False
        self._last: Pose | None = None
        self.covered: set[int] = set()
        """Indices of the clusters that have been covered."""

    @property
    def coverage(self) -> float:
        """Share of the true clusters covered so far."""
        return len(self.covered) / max(len(self.world.clusters), 1)

    def clearance_m(self, pose: Pose) -> float:
        """Return the true distance from the hull to the nearest obstacle (m)."""
        return self._contacts.clearance(pose.x, pose.y)

    def follow(self, step: int, t: float, pose: Pose) -> None:
        """Move on to the vehicle's true pose at a tick."""
        before = self._last or pose
        count = max(1, int(np.hypot(pose.x - before.x, pose.y - before.y) / PATH_M))
        track = np.linspace(before[:2], pose[:2], count + 1)[1:]
        for x, y, obstacle in self._contacts.follow(track):
            self._contacts_made += 1
            self._emit("collision", x=round(x, 3), y=round(y, 3), obstacle=obstacle)
        self._last = pose
        self._coverage.update(pose)
        self._imaging.update(pose)
        fractions = self._coverage.fractions
        for k in np.flatnonzero(self._coverage.covered()).tolist():
            if k not in self.covered:
                self.covered.add(k)
                name = self.world.clusters[k].name
                self._emit("cluster_covered", name=name, fraction=round(float(fractions[k]), 4))
        self._judge.note(step, t, *pose[:2])
        if self._words is not None and not self._over:
            self._words.note(t, pose, (pose, self._camera.render(pose)))

    def end_mission(self, answer: str) -> None:
        """Take the advisor's word that a mission in words is done: what the vehicle does after it counts no more."""
        if self._words is not None and not self._over:
            self._words.hear(answer)
        self._over = True

    def verdict(self, tracks: list[Track], instruction: str = "", answer: str | None = None) -> dict[str, Any]:
        """Return the fields of the `judged` event.

        `answer` is None if the advisor of a mission in words did not say that it was done.
        """
        if answer is not None:
            self.end_mission(answer)
        return {
            "clusters": self._judge.clusters(),
            "tracks": len(tracks),
            "phantoms": self._judge.phantoms(tracks),
            "oracle_time_to_90_s": None,
            **told_verdict(instruction, answer, self._words, self._contacts_made),
        }

    def close(self) -> None:
        """Close its file."""
        self._judge.close()
