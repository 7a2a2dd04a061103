"""Imaging coverage: the share of every cluster's oyster area that the true camera has seen."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from coral.config import CellSize, Positive
from coral.reef.simulation import imaging_kernels
from coral.reef.simulation.coverage import rasterise
from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.vehicle.collision import clearance
from coral.reef.world.geometry import Label, Pose
from coral.reef.world.scene import Scene

LEVELS = {"imaged": imaging_kernels.IMAGED, "inspected": imaging_kernels.INSPECTED}
"""The two levels at which a cluster's area is counted."""


@dataclass(frozen=True, kw_only=True)
class ImagingCfg:
    """Distance at which oysters count as imaged, and resolution at which they count as inspected."""

    range_m: Positive = 6.0
    """`imaged`: the paper's detection range (0-6 m in its prompts), measured along the line of sight."""
    pixel_m: Positive = 0.05
    """`inspected`: the largest pixel at which an ecologist can count oysters. The size of a pixel is its distance times
    the angle of a pixel at the picture's centre, that is, across the line of sight: the stretched pixels at the edges
    of a wide picture get no credit. To count oysters one must tell them apart. A human observer detects an object in
    half of the cases once two pixels lie across its smaller dimension (Johnson, Analysis of Image Forming Systems,
    1958: 2 ± 0.5). Seen from the side, this is an oyster's height, 0.10 m here, so 0.05 m: up to 2.3 m away with the
    default camera. This agrees with practice: geese are counted in aerial pictures of 4 to 5 cm (Chabot et al., An
    approach for using off-the-shelf object-based image analysis, 2018), and lengths measured in an ROV's stereo
    pictures are best at 2 to 3 m (Garner et al. 2021, PLOS ONE 16(3) e0247985)."""
    cell_m: CellSize = 0.05
    """Spacing of the points that sample the oysters' area."""


class ImagingMeter:
    """Samples the true oyster area and records how well each point has been seen. No decision reads it.

    A point counts when it lies inside both angles of view of the true camera, within the range and the water's
    visibility along the line of sight, and no obstacle hides it. Oysters are too low to hide one another. Points under
    an obstacle can never be seen and are not part of the area.
    """

    def __init__(
        self,
        scene: Scene,
        camera: CameraCfg | None = None,
        cfg: ImagingCfg | None = None,
        *,
        visibility_m: float | None = None,
    ) -> None:
        """Sample the true points; beyond `visibility_m` the water hides everything (None: clear water)."""
        self.cfg, self.camera = cfg or ImagingCfg(), camera or CameraCfg()
        self.names = scene.cluster_names
        self._seabed_z = scene.seabed_z
        focal, _, _, _ = self.camera.intrinsics
        edge_u, edge_v = 0.5 * self.camera.width / focal, 0.5 * self.camera.height / focal
        far = min(self.cfg.range_m, self.camera.range_m, math.inf if visibility_m is None else visibility_m)
        self.inspection_m: float = min(far, self.cfg.pixel_m * focal)
        """Largest distance of an inspected point (m)."""
        self.points, self.group = _points(scene, self.cfg.cell_m)
        """World points (m), Shape=(M, 3), and the cluster of each, Shape=(M,)."""
        self.size: NDArray[np.int64] = np.bincount(self.group, minlength=len(self.names)).astype(np.int64)
        hiders = np.flatnonzero(scene.label == Label.OBSTACLE)
        self._sight = imaging_kernels.Sight(
            (-edge_u, edge_u, -edge_v, edge_v),
            (self.camera.near_m, far, self.inspection_m),
            self.points,
            self.group,
            scene.kind[hiders],
            scene.center[hiders],
            np.ascontiguousarray(np.swapaxes(scene.rotation[hiders], 1, 2) / scene.half[hiders][:, :, None]),
            scene.solids.radius[hiders],
        )
        self.level: NDArray[np.uint8] = np.zeros(len(self.points), np.uint8)
        """Best level of every point so far. Shape=(M,)."""
        self._count = np.zeros((3, len(self.names)), np.int64)

    def update(self, pose: Pose) -> None:
        """Count the picture taken from a true body pose."""
        self.look(pose, self.level, self._count)

    def look(self, pose: Pose, level: NDArray[np.uint8], count: NDArray[np.int64]) -> None:
        """Count a picture in the caller's `level`, Shape=(M,), and `count`, Shape=(3, n_clusters), in place."""
        transform = T_world_camera(pose, self.camera, seabed_z=self._seabed_z)
        imaging_kernels.image(
            transform[:3, 3].copy(), np.ascontiguousarray(transform[:3, :3]), self._sight, level, count
        )

    def look_along(
        self,
        poses: NDArray[np.float64],
        level: NDArray[np.uint8],
        count: NDArray[np.int64],
        *,
        every: int = 1,
        target: float = math.inf,
    ) -> int | None:
        """Count the pictures of a drive, poses (x, y, theta) of the body, Shape=(K, 3), until a share is inspected.

        Only every n-th pose counts, and the last one. Returns the index at which the target was met; None: it never
        was.
        """
        k = imaging_kernels.image_along(
            poses,
            every,
            target,
            T_world_camera(Pose(0.0, 0.0, 0.0), self.camera, seabed_z=self._seabed_z),
            self._sight,
            level,
            count,
            self.size,
        )
        return int(k) if k >= 0 else None

    def fractions(self, name: str) -> NDArray[np.float64]:
        """Return the share of every cluster's oyster area that is `imaged` or `inspected`. Shape=(n_clusters,)."""
        return np.asarray(self._count[LEVELS[name]] / self.size)

    @property
    def imaged(self) -> float:
        """Mean over the clusters of the share seen within the detection range, 0 to 1."""
        return float(self.fractions("imaged").mean()) if self.names else 0.0

    @property
    def inspected(self) -> float:
        """Mean over the clusters of the share seen from close enough to count oysters, 0 to 1."""
        return float(self.fractions("inspected").mean()) if self.names else 0.0


@lru_cache(maxsize=4)
def _points(scene: Scene, cell_m: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the cells of every cluster's oysters, at the height of the highest oyster there, and their clusters."""
    hiders = scene.footprints()
    points: list[tuple[float, float, float]] = []
    group: list[int] = []
    for index in range(len(scene.cluster_names)):
        found: dict[tuple[float, float], float] = {}
        members = np.flatnonzero((scene.cluster == index) & (scene.label == Label.OYSTER))
        for member in members:
            height = float(scene.center[member, 2])
            for x, y in rasterise(scene.outlines(np.array([member])), cell_m, 0.0).round(6).tolist():
                found[x, y] = max(found.get((x, y), -math.inf), height)
        free = {at: z for at, z in found.items() if clearance(hiders, *at) > 0.0} or found
        points += [(x, y, z) for (x, y), z in free.items()]
        group += [index] * len(free)
    return np.array(points, np.float64).reshape(-1, 3), np.array(group, np.int64)
