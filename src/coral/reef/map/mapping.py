"""The occupancy map: the spatial memory that every later stage reads (paper III-A)."""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import CellSize, Count, NonNegative, Positive
from coral.errors import InputError
from coral.reef.eyes.doubt import DoubtCfg, drop_doubtful
from coral.reef.map.carried import AROUND_M, Box, around, moved_cells
from coral.reef.map.eyesight import Eyesight, looks_of
from coral.reef.map.mapping_kernels import SATURATED, Counts, Nearness, classify, explore, project
from coral.reef.map.obstacle_layer import ObstacleLayer, SonarLayerCfg
from coral.reef.map.sight_layer import SightLayer, SightLayerCfg
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.vehicle.camera import CameraCfg, check_picture
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.vehicle.sensing import Attitude
from coral.reef.world.geometry import Frame, Pose

UNEXPLORED, FREE, OBSTACLE, TARGET = 0, 1, 2, 3
"""Cell classes, in the paper's colours: white, gray, black, green."""

_MEMORY = ("_targets", "_obstacles", "_ground", "explored", "nearest", "unseeable", "_hints")
"""Arrays that make a map; all others follow from them."""

NEAR_SLACK_M = 1.0
"""Distance that the robot may move before local distances are computed again, if no obstacle has changed."""


HINT_CELL_M = 0.5
"""Edge of a cell of the hints: at 8 to 12 m a row of pixels covers about as much of the seabed."""
HINT_HITS = 5
"""Pictures that must show oysters in such a cell, half a second of looking."""
AROUND_SEEN_M = 1.0
"""Boulders are smaller."""


@dataclass(frozen=True, kw_only=True)
class MapCfg:
    """Cell size, ranges and evidence thresholds of the occupancy map."""

    cell_m: CellSize = 0.05
    """Edge of a cell. The paper gives none; 0.05 m makes its A_min = 100 px equal to 0.25 m²."""
    range_m: float = 6.0
    """d_max of explored-area rays and of target detection (0-6 m in the paper's prompts). Of eyes that doubt, less
    counts as explored: only what they can tell from there."""
    obstacle_range_m: float = 4.0
    """Obstacle sensing range (paper IV-F)."""
    n_rays: Count = 360
    """N of the explored-area ray casting. 360 rays over 120° are 3.5 cm apart at 6 m, less than a cell."""
    target_hits: Count = 2
    """Pictures that must show oysters in a cell before it is a target. With 2, one wrong picture has no effect."""
    obstacle_hits: Count = 3
    """The same for obstacles. At 10 pictures per second and full speed the third picture comes 12 cm after the first,
    of the 4 m at which obstacles are seen."""
    target_ratio: NonNegative = 0.2
    """A cell is no target if fewer pictures show oysters there than this share of those that show seabed: correct
    pictures outvote wrong masks. A false patch now and then gives every cell two hits in the end; with 0.05 a mission
    in `hard` water ended with 20 to 30 clusters that were none. Seabed shows between oysters, so the share is small."""
    sharp_pixel_m: Positive = 0.05
    """Eyes that doubt: pixels at most this wide are sharp, 2.3 m away with the default camera. Where oysters have been
    looked for from this near, looks from farther away no longer count."""
    sharp_ratio: NonNegative = 2.0
    """A cell seen from that near is no target if fewer pictures show oysters than so many times those with seabed.
    On the pictures of seven missions without a sonar 0.5, 1 and 2 leave 7, 4 and 2 false clusters, mostly shadows,
    and no true one is lost (docs/research/network-eyes.md)."""
    obstacle_ratio: NonNegative = 0.3
    """The same for obstacles, which hide the seabed of their cells. Of 15 pictures with a mask
    that is wrong in 4 of 100 patches, 5 agree on a cell once in 5000."""
    remembered: Annotated[int, Field(ge=4, le=SATURATED - 1)] = 32
    """Pictures of one class at which all counts of a cell are halved: where the position drifts, hundreds of pictures
    of bare floor from long ago must not outvote the obstacle that is now in view."""
    obstacles: Literal["auto", "both", "sonar"] = "auto"
    """Whose obstacles the vehicle keeps clear of when it has a sonar. The paper's vehicle has its sonar for that, and
    its map takes obstacles from the camera too. auto: both, but the sonar's alone where eyes only estimate depth, whose
    obstacles have long shadows. Without a sonar it is the camera's."""
    sonar: SonarLayerCfg = field(default_factory=SonarLayerCfg)
    sight: SightLayerCfg = field(default_factory=SightLayerCfg)
    """Of eyes that doubt, on a vehicle without a sonar."""
    doubt: DoubtCfg = field(default_factory=DoubtCfg)
    """Doubt with which a pixel still counts, where perception states one."""


class OccupancyMap:
    """Persistent 2D grid over the survey area. Arrays are indexed [iy, ix], cell (0, 0) at the world's origin."""

    def __init__(
        self, size_m: tuple[float, float], camera: CameraCfg, cfg: MapCfg | None = None, sonar: SonarCfg | None = None
    ) -> None:
        """Set up an empty map of a survey area (m); `sonar` is None without one."""
        self.cfg = cfg = cfg or MapCfg()
        self.size_m = size_m
        shape = (math.ceil(size_m[1] / cfg.cell_m - 1e-9), math.ceil(size_m[0] / cfg.cell_m - 1e-9))
        self._targets = np.zeros(shape, np.uint16)
        self._obstacles = np.zeros(shape, np.uint16)
        self._ground = np.zeros(shape, np.uint16)
        self._sharp = np.zeros(shape, np.bool_)
        self._counts = Counts(self._targets, self._obstacles, self._ground, np.zeros(shape, np.int32), self._sharp)
        self._pictures = 0
        self.target = np.zeros(shape, np.bool_)
        """Oyster cells. Shape=(NY, NX)."""
        self.obstacle = np.zeros(shape, np.bool_)
        """Obstacle cells. Shape=(NY, NX)."""
        self.explored = np.zeros(shape, np.bool_)
        """Cells that have been in view. Shape=(NY, NX)."""
        self.layer = None if sonar is None or not sonar.enabled else ObstacleLayer(shape, cfg.cell_m, sonar, cfg.sonar)
        """Obstacles by the sonar; None without one."""
        self.sight: SightLayer | None = None
        """Obstacles of doubtful pictures; None before the first one, and with a sonar."""
        self._seen_obstacle = self.obstacle if self.layer is None else np.zeros(shape, np.bool_)
        self._closed = np.zeros(shape, np.bool_)
        self._saved, self._recalled = dict[str, NDArray[Any]](), np.zeros(shape, np.bool_)
        """What an earlier survey knew, and the cells that it knew."""
        self.estimated = False
        """Whether classes and depth of the pictures are estimates, by eyes that doubt."""
        self.version = 0
        """Grows whenever an obstacle cell appears or goes."""
        self.nearest = np.full(shape, np.inf, np.float32)
        """Smallest distance along the line of sight (m) from which each cell has been seen. Shape=(NY, NX)."""
        self._neared = np.zeros(shape, np.int32)
        self.unseeable = np.zeros(shape, np.bool_)
        """Cells that could not be seen from near enough, whatever was tried. Shape=(NY, NX)."""
        coarse = (math.ceil(size_m[1] / HINT_CELL_M), math.ceil(size_m[0] / HINT_CELL_M))
        self._hints, self._hinted = np.zeros(coarse, np.uint16), np.zeros(coarse, np.int32)
        self._whole: tuple[NDArray[np.bool_], NDArray[np.float32]] | None = None
        self._near = np.full(shape, np.inf, np.float32)
        self._near_key: tuple[int, float, float] | None = None
        self.camera = camera
        """The camera that takes the pictures."""
        self.eyesight = Eyesight(camera)
        """How far pictures that eyes doubt tell oysters from sea floor."""
        self._looks = looks_of(camera)
        self.focal_px = camera.intrinsics[0]
        """Focal length of the camera (px): a pixel is 1 / focal_px of its distance wide."""
        self._sharp_m = cfg.sharp_pixel_m * self.focal_px
        self._hfov = math.radians(camera.hfov_deg)
        self._reach = np.zeros(camera.width)

    def integrate(self, frame: Frame, pose: Pose, roll: float = 0.0, pitch: float = 0.0) -> None:
        """Fuse a camera picture taken at `pose`, the robot's own estimate, with roll and pitch as in `T_world_camera`.

        The grid is flat: of Eq. 1's point, its height is dropped. The camera's height is in the depth of the picture.

        Raises:
            InputError: The picture is not of the configured size and type, or the pose is not finite. The kernels check
                neither, and would write beyond their arrays.
        """
        check_picture(frame, self.camera)
        if not all(map(math.isfinite, (*pose, roll, pitch))):
            raise InputError("pose", "", (*pose, roll, pitch), "finite numbers")
        looks = looks_of(self.camera, roll, pitch) if roll or pitch else self._looks
        self.eyesight.look(frame, looks)
        frame = drop_doubtful(frame, self.cfg.doubt)
        cfg = self.cfg
        self._pictures += 1
        changed, obstacle_range_m = False, cfg.obstacle_range_m
        sharp_m = 0.0 if frame.doubt is None else self._sharp_m
        self.estimated |= frame.doubt is not None
        doubted = frame.doubt is not None and self.layer is None
        if doubted:
            self.sight = self.sight or self._begin_sight()
            changed = self.sight.integrate(frame, pose, (cfg.obstacle_range_m, self.sees_m), self.explored, roll, pitch)
            obstacle_range_m, sharp_m = -1.0, sharp_m if self.sight.counted else -1.0
        project(
            frame.depth,
            frame.labels,
            looks,
            (pose.x, pose.y, pose.theta),
            cfg.cell_m,
            cfg.range_m,
            obstacle_range_m,
            sharp_m,
            self._counts,
            Nearness(self.nearest, self._neared, self._hints, self._hinted, HINT_CELL_M),
            self._pictures,
            self._reach,
            cfg.remembered,
        )
        changed |= self._classify(self._window(pose, cfg.range_m))
        if changed:
            self.version += 1
            self._combine(self._window(pose, cfg.range_m))
        if doubted:
            return  # its lines of sight have told what is explored
        explore(
            self.explored,
            self.obstacle,
            (pose.x, pose.y),
            pose.theta,
            self._hfov,
            cfg.n_rays,
            self.sees_m,
            cfg.cell_m,
            math.tan(self._hfov / 2),
            self._reach,
        )

    @property
    def sees_m(self) -> float:
        """Distance (m) up to which what is in view counts as explored."""
        return min(self.cfg.range_m, self.eyesight.reach_m) if self.estimated else self.cfg.range_m

    def _begin_sight(self) -> SightLayer:
        """Leave the obstacles that are known to lines of sight."""
        self._obstacles[~self._closed] = 0
        self._seen_obstacle = self._closed.copy()
        return SightLayer(self.obstacle & ~self._closed, self.cfg.cell_m, self.camera, self._sharp_m, self.cfg.sight)

    def hear(self, image: RangeImage, pose: Pose, attitude: Attitude | None = None) -> None:
        """Fuse a range image of the sonar into the obstacle layer, apart from what the camera has seen.

        Without an attitude the body is level, at the camera's configured height.

        Raises:
            InputError: The map has no sonar, or the pose is not finite.
        """
        if self.layer is None:
            raise InputError("sonar", "", "a range image", "none: the map has been made without a sonar")
        if not all(map(math.isfinite, pose)):
            raise InputError("pose", "", tuple(pose), "finite numbers")
        known = attitude or Attitude(roll=0.0, pitch=0.0, depth_m=math.inf)
        altitude_m = self.camera.altitude_m if known.altitude_m is None else known.altitude_m
        changed = self.layer.integrate(
            image, pose, altitude_m, roll=known.roll, pitch=known.pitch, depth_m=known.depth_m
        )
        if changed:
            self.version += 1
            self._combine(self._window(pose, max(self.cfg.sonar.range_m, self.cfg.sonar.clear_m)))

    @property
    def sonar_alone(self) -> bool:
        """Whether only the sonar's obstacles count."""
        trusted = self.cfg.obstacles == "both" or (self.cfg.obstacles == "auto" and not self.estimated)
        return self.layer is not None and not trusted

    def _combine(self, window: Box) -> None:
        """Put together the obstacles of camera and sonar within a window."""
        layer = self.layer or self.sight
        if layer is None:
            return
        at = slice(*window[:2]), slice(*window[2:])
        self.obstacle[at] = layer.obstacle[at] | self._closed[at]
        if not self.sonar_alone:
            self.obstacle[at] |= self._seen_obstacle[at]
        self.target[at] &= ~self.obstacle[at]

    def distance_to_unknown(
        self, x: float, y: float, radius_m: float, trail: NDArray[np.float64], passed_m: float
    ) -> NDArray[np.float32]:
        """Return `distance_near` with all that nobody has found free as an obstacle, for a vehicle without a camera.

        Water within `passed_m` of its `trail`, Shape=(N, 2), metres, is free. Beyond `radius_m` distances are 0.
        """
        y0, y1, x0, x1 = self._window(Pose(x, y, 0.0), radius_m)
        free = self.explored[y0:y1, x0:x1].copy()
        if self.layer is not None:
            free |= self.layer.free[y0:y1, x0:x1]
        cell = self.cfg.cell_m
        near = trail[np.abs(trail - (x, y)).max(axis=1, initial=0.0) <= radius_m] if len(trail) else trail
        if len(near):
            been = np.ones(free.shape, np.uint8)
            column, row = (near[:, 0] // cell).astype(int) - x0, (near[:, 1] // cell).astype(int) - y0
            inside = (column >= 0) & (row >= 0) & (row < free.shape[0]) & (column < free.shape[1])
            been[row[inside], column[inside]] = 0
            free |= cv2.distanceTransform(been, cv2.DIST_L2, 5) * cell <= passed_m
        distance = np.zeros(self.obstacle.shape, np.float32)
        distance[y0:y1, x0:x1] = distance_to(~free | self.obstacle[y0:y1, x0:x1], cell)
        return distance

    def carry(self, before: Pose, after: Pose, *, anew: bool = False) -> None:
        """Take what is around the robot along when its estimated place jumps; oysters stay where they were mapped.

        What it saw last stands where it stood relative to the robot. Were it left behind, the robot would stand among
        obstacles that are not there, and beside some that are no longer on the map. What an earlier survey knew stays.
        `anew`: all that was seen since `recall` was put elsewhere, and goes but for what is carried.
        """
        to, source = moved_cells(self.obstacle.shape, self.cfg.cell_m, before, after)
        known = (self.explored | self.obstacle).flat[source] & ~(self._recalled.flat[source] | self._recalled.flat[to])
        to, source = to[known], source[known]
        carried = [grid.flat[source] for grid in self._carried()]
        if anew:
            for grid in () if self.layer is None else self.layer.grids:
                grid[...] = 0
            sighted, self.sight = self.sight is not None, None
            self._seen_obstacle = self.obstacle if self.layer is None else self._seen_obstacle
            self.recall(self._saved)
            self.sight = self._begin_sight() if sighted else None
        for grid, values in zip(self._carried(), carried, strict=True):
            grid.flat[to] = values
        self._obstacles[self._closed] = SATURATED
        window = self._window(after, AROUND_M)
        self._classify(window)
        self._combine(window)
        self.version += 1

    def _carried(self) -> list[NDArray[Any]]:
        layers = [layer.grids for layer in (self.layer, self.sight) if layer is not None]
        return [self._obstacles, self._ground, self.explored, *itertools.chain.from_iterable(layers)]

    def look_again(self, first: int, end: int) -> None:
        """Take back from how near cells were seen in some pictures: they were taken from somewhere else."""
        begin, stop = max(self._pictures - first, 1), self._pictures - end
        self.nearest[(self._neared >= begin) & (self._neared < stop)] = np.inf

    def close_off(self, cells: NDArray[np.bool_]) -> None:
        """Make cells, Shape=(NY, NX), obstacles for good, whatever a picture shows there: places not to go to."""
        if cells.any():
            self._obstacles[cells] = SATURATED
            self.obstacle |= cells
            self._seen_obstacle |= cells
            self._closed |= cells
            self.version += 1

    def hides(self, cells: NDArray[np.intp]) -> bool:
        """Check whether most of what is around some cells, (iy, ix) of each, has been seen, but not they. Shape=(M, 2).

        Then they lie on an obstacle: a boulder whose side was taken for oysters keeps its inside unexplored for ever.
        """
        y, x = (cells.mean(axis=0) + 0.5) * self.cfg.cell_m
        seen = int(np.count_nonzero(self.explored[cells[:, 0], cells[:, 1]]))
        return 2 * seen < len(cells) and self.unexplored_share(float(x), float(y), AROUND_SEEN_M) <= 0.5

    def disbelieve(self, cells: NDArray[np.intp]) -> None:
        """Take back oysters that eyes which doubt have shown in some cells, (iy, ix) of each. Shape=(M, 2)."""
        if self.estimated:
            at = cells[:, 0], cells[:, 1]
            self._targets[at], self._sharp[at], self.target[at] = 0, True, False

    def forget_doubt(self) -> bool:
        """Take away the obstacles that eyes which doubt have seen from one side and from afar; False without any."""
        doubtful = None if self.sight is None else self.sight.doubtful & self.obstacle & ~self._closed
        if self.sight is None or doubtful is None or not doubtful.any():
            return False
        self.obstacle[doubtful] = False
        self.sight.forget(doubtful)
        self.version += 1
        return True

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return the arrays from which `recall` makes the same map again, by name."""
        arrays = {name: getattr(self, name).copy() for name in _MEMORY}
        if self.sight is not None:
            least = np.maximum(self.cfg.obstacle_hits, np.ceil(self.cfg.obstacle_ratio * self._ground))
            arrays["_obstacles"][self.sight.obstacle] = least[self.sight.obstacle]
        return arrays

    def recall(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take over what another map of the same size knew.

        Raises:
            ValueError: An array is missing or has another shape or type.
        """
        for name in _MEMORY:
            mine, given = getattr(self, name), arrays.get(name)
            if given is None or given.shape != mine.shape or given.dtype != mine.dtype:
                raise ValueError(f"{name} is no array of {mine.shape} {mine.dtype}")
            mine[...] = given
        self._obstacles[self._closed], self._neared[...] = SATURATED, 0
        ny, nx = self.target.shape
        self._classify((0, ny, 0, nx))
        self._combine((0, ny, 0, nx))
        self._saved, self._recalled = {name: arrays[name] for name in _MEMORY}, self.explored | self.obstacle
        self.version += 1

    def agreement(self, cells: NDArray[np.intp]) -> float:
        """Return how far pictures agree that oysters lie in some cells, (iy, ix) of each, Shape=(M, 2), from 0 to 1.

        It is the mean over the cells of the share of pictures that show oysters there, of those that show oysters or
        seabed; 1 where nothing says otherwise. A picture that shows both counts for both.
        """
        hits, ground = (counts[cells[:, 0], cells[:, 1]].astype(np.float64) for counts in (self._targets, self._ground))
        against = ground / np.maximum(hits + ground, 1.0)
        return 1.0 - float(against.mean()) if len(cells) else 1.0

    def hints(self) -> list[tuple[float, float]]:
        """Return the centres (m) of the oysters that were seen beyond the map's range, where nothing is explored.

        Of eyes that doubt, none where most of what is around has been seen: a boulder taken for oysters from afar keeps
        its inside unexplored for ever.
        """
        cfg = self.cfg
        mask = self._hints >= HINT_HITS
        if not mask.any():
            return []
        iy, ix = np.nonzero(mask)
        centres = ((np.stack([iy, ix], axis=1) + 0.5) * HINT_CELL_M / cfg.cell_m).astype(np.int64)
        ny, nx = self.explored.shape
        known = self.explored[np.minimum(centres[:, 0], ny - 1), np.minimum(centres[:, 1], nx - 1)]
        mask[iy[known], ix[known]] = False
        _, _, _, centroids = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
        places = [(float((x + 0.5) * HINT_CELL_M), float((y + 0.5) * HINT_CELL_M)) for x, y in centroids[1:]]
        return [at for at in places if not self.estimated or self.unexplored_share(*at, AROUND_SEEN_M) > 0.5]

    def cells(self) -> NDArray[np.uint8]:
        """Return the class of every cell: UNEXPLORED, FREE, OBSTACLE or TARGET. Shape=(NY, NX)."""
        found = np.where(self.explored, np.uint8(FREE), np.uint8(UNEXPLORED))
        found[self.target], found[self.obstacle] = TARGET, OBSTACLE
        return found

    def snapshot(self) -> OccupancyMap:
        """Copy the masks, which later pictures change in place; nothing may be integrated into the copy."""
        copied = copy.copy(self)
        copied.target, copied.obstacle, copied.explored = self.target.copy(), self.obstacle.copy(), self.explored.copy()
        copied.sight = None if self.sight is None else self.sight.snapshot()
        return copied

    def distance(self) -> NDArray[np.float32]:
        """Return the distance (m) of every cell to the nearest obstacle cell, by centres. Shape=(NY, NX), read only."""
        if self._whole is None or not np.array_equal(self._whole[0], self.obstacle):
            self._whole = self.obstacle.copy(), distance_to(self.obstacle, self.cfg.cell_m)
        return self._whole[1]

    def distance_near(self, x: float, y: float, radius_m: float) -> NDArray[np.float32]:
        """Return `distance`, up to date only within `radius_m` of a point, which is enough for the controller."""
        key = self._near_key
        if key is not None and key[0] == self.version and math.hypot(x - key[1], y - key[2]) < NEAR_SLACK_M:
            return self._near
        self._near_key = (self.version, x, y)
        y0, y1, x0, x1 = self._window(Pose(x, y, 0.0), radius_m + NEAR_SLACK_M)
        self._near[y0:y1, x0:x1] = distance_to(np.ascontiguousarray(self.obstacle[y0:y1, x0:x1]), self.cfg.cell_m)
        return self._near

    def index(self, x: float, y: float) -> tuple[int, int]:
        """Return (iy, ix) of the cell that contains a world point, clipped to the map."""
        ny, nx = self.target.shape
        ix, iy = int(x // self.cfg.cell_m), int(y // self.cfg.cell_m)
        return min(max(iy, 0), ny - 1), min(max(ix, 0), nx - 1)

    def contains(self, x: float, y: float, margin_m: float = 0.0) -> bool:
        """Check whether a world point lies inside the survey area by at least `margin_m`."""
        width, height = self.size_m
        return margin_m <= x <= width - margin_m and margin_m <= y <= height - margin_m

    def unexplored_share(self, x: float, y: float, radius_m: float) -> float:
        """Return the share of the square of half-edge `radius_m` about a point that is unexplored survey area."""
        y0, y1, x0, x1 = self._window(Pose(x, y, 0.0), radius_m)
        patch = self.explored[y0:y1, x0:x1]
        return float(patch.size - np.count_nonzero(patch)) * (self.cfg.cell_m / (2.0 * radius_m)) ** 2

    def _classify(self, window: Box) -> bool:
        """Decide the cells of a window by what was counted in them. Return whether one of them changed."""
        cfg = self.cfg
        return bool(
            classify(
                self._counts,
                cfg.target_hits,
                cfg.obstacle_hits,
                cfg.target_ratio,
                cfg.sharp_ratio,
                cfg.obstacle_ratio,
                self.target,
                self._seen_obstacle,
                window,
            )
        )

    def _window(self, pose: Pose, radius_m: float) -> Box:
        return around(pose.x, pose.y, radius_m, self.cfg.cell_m, self.target.shape)


def distance_to(mask: NDArray[np.bool_], cell_m: float) -> NDArray[np.float32]:
    """Compute the distance (m) of every cell to the nearest True cell, inf if there is none. Shape=(NY, NX)."""
    if not mask.any():
        return np.full(mask.shape, np.inf, np.float32)
    distances = cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, 5)
    return np.asarray(distances * cell_m, dtype=np.float32)
