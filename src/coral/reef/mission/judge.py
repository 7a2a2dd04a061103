"""The judge of a mission, who knows the truth: what was covered, imaged and inspected, and what words asked for."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from coral.file_writer import open_log
from coral.reef.map.chain import Track
from coral.reef.map.mapping import distance_to
from coral.reef.mission.word_judge import WordJudge, told_verdict
from coral.reef.simulation.coverage import CoverageMeter
from coral.reef.simulation.imaging import ImagingMeter
from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import ReefWorld
from coral.run_files import SurveyFiles

COLUMNS = ("step", "t", "imaged", "inspected", "reef_m")
"""Mean share of the clusters' oyster area imaged and inspected so far, and distance from the reef (m)."""
CELL_M = 0.1
"""Edge of a cell of the grid of distances from the reef."""
MATCH_M = 1.0
"""A track within this distance of a true cluster's oysters matches it. d_merge of the robot's own tracker."""


class MissionJudge:
    """Records the truth of one mission in `judge.csv`. No decision reads it."""

    def __init__(
        self,
        world: ReefWorld,
        scene: Scene,
        coverage: CoverageMeter,
        meter: ImagingMeter,
        folder: Path,
        emit: Callable[..., None],
    ) -> None:
        """Begin the record in `folder`; `emit(event, **fields)` is told of covered clusters. Others move the meters."""
        self.world, self.meter, self._coverage, self._emit = world, meter, coverage, emit
        self.words = None if world.mission is None else WordJudge(world, scene, world.mission, meter.camera)
        """Judges a mission in words; None for others."""
        self.covered: set[int] = set()
        """Indices of the clusters that have been covered."""
        self._over = False
        spine = [point for line in world.spine for point in _dense(np.array(line))]
        reef = np.concatenate([np.array(spine).reshape(-1, 2), meter.points[:, :2]])
        width, height = (math.ceil(edge / CELL_M) for edge in world.size_m)
        there = np.zeros((height, width), np.bool_)
        there[_cells(reef[:, 1], height), _cells(reef[:, 0], width)] = True
        self._away = distance_to(there, CELL_M) if len(reef) else np.full(there.shape, np.nan, np.float32)
        self._file: IO[str] = open_log(folder / SurveyFiles.JUDGE)
        self._file.write(",".join(COLUMNS) + "\n")

    @property
    def coverage(self) -> float:
        """Share of the true clusters covered so far."""
        return len(self.covered) / max(len(self.world.clusters), 1)

    def note(self, step: int, t: float, pose: Pose, taken: tuple[Pose, Frame] | None = None) -> None:
        """Take in a tick: the true pose, and what the last picture shows in truth, from where."""
        fractions, meter = self._coverage.fractions, self.meter
        for k in np.flatnonzero(self._coverage.covered()).tolist():
            if k not in self.covered:
                self.covered.add(k)
                name = self.world.clusters[k].name
                self._emit("cluster_covered", name=name, fraction=round(float(fractions[k]), 4))
        reef_m = self.reef_m(pose.x, pose.y)
        self._file.write(f"{step},{t:.6g},{meter.imaged:.6g},{meter.inspected:.6g},{reef_m:.4g}\n")
        if self.words is not None and not self._over:
            self.words.note(t, pose, taken)

    def end_mission(self, answer: str) -> None:
        """Take the advisor's word that a mission in words is done: what the vehicle does after it counts no more."""
        if self.words is not None and not self._over:
            self.words.hear(answer)
        self._over = True

    def verdict(
        self,
        tracks: Sequence[Track],
        contacts: int,
        instruction: str = "",
        answer: str | None = None,
        oracle_s: float | None = None,
    ) -> dict[str, Any]:
        """Return the fields of the `judged` event; `answer` is what the advisor said to end a mission in words."""
        if answer is not None:
            self.end_mission(answer)
        return {
            "clusters": self.clusters(),
            "tracks": len(tracks),
            "phantoms": self.phantoms(tracks),
            "oracle_time_to_90_s": oracle_s,
            **told_verdict(instruction, answer, self.words, contacts),
        }

    def reef_m(self, x: float, y: float) -> float:
        """Return the distance (m) from a point to the reef, its oysters or spine, to a decimetre; nan without one."""
        height, width = self._away.shape
        j, i = min(max(int(y / CELL_M), 0), height - 1), min(max(int(x / CELL_M), 0), width - 1)
        return float(self._away[j, i])

    def phantoms(self, tracks: Sequence[Track]) -> int:
        """Count the robot's clusters that match no true cluster."""
        oysters = self.meter.points[:, :2]
        return sum(
            not len(oysters) or float(np.hypot(*(oysters - (track.x, track.y)).T).min()) > MATCH_M for track in tracks
        )

    def clusters(self) -> list[dict[str, Any]]:
        """Return the share of every true cluster that has been imaged and inspected."""
        shares = zip(self.meter.names, *(self.meter.fractions(n) for n in ("imaged", "inspected")), strict=True)
        return [{"name": name, "imaged": round(float(a), 4), "inspected": round(float(b), 4)} for name, a, b in shares]

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def _cells(values: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    return np.clip((values / CELL_M).astype(np.int64), 0, count - 1)


def _dense(line: NDArray[np.float64], step_m: float = 0.2) -> list[tuple[float, float]]:
    """Sample points along a polyline."""
    found = [(float(x), float(y)) for x, y in line[:1]]
    for a, b in itertools.pairwise(line):
        n = max(1, math.ceil(math.dist(a, b) / step_m))
        found += [(float(x), float(y)) for x, y in a + (b - a) * np.arange(1, n + 1)[:, None] / n]
    return found
