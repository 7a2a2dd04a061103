"""Missions that follow a plan made before the dive: the oracle's tour, a blind sweep, and lanes around obstacles."""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from coral.reef.decide.mission_planner import MissionPlanner
from coral.reef.pilot.pilot import Command, Pilot
from coral.reef.vehicle.sensing import Velocity
from coral.reef.vehicle.tour_kernels import follow
from coral.reef.vehicle.vehicle import VehicleCfg
from coral.reef.world.geometry import Pose

BORDER_M = 1.0
"""Distance between the ends of lanes and the edge of the survey area."""
PASSED_M = 1.0
"""A point of a lane is passed within this distance: the vehicle need not slow down for it."""
STRIDE_M = 4.0
"""Largest distance between points of a lane that goes around obstacles."""
LANES_DONE = "all lanes are done"
PATIENCE_S = 5.0
"""Time for turning towards a point of a lane."""


class TourPilot(Pilot):
    """Executes planned commands while the sensors are good. The map is kept for the report alone."""

    commands: NDArray[np.float64] = np.empty((0, 2))
    """Forward speed (m/s) and yaw rate (rad/s) of each tick. Shape=(K, 2)."""
    _next = 0

    def _steer(self, t: float, pose: Pose, velocity: Velocity) -> Command:
        """Return the next command of the plan."""
        if self._next >= len(self.commands):
            self.end_reason = "the tour is done"
            return 0.0, 0.0
        v, omega = self.commands[self._next].tolist()
        self._next += 1
        return v, omega


class LanesPilot(Pilot):
    """Follows lanes planned before the dive around what is on the map, with the controller of the whole system.

    The classical survey (boustrophedon): nothing is asked. A point of a lane counts as passed within `PASSED_M`, and is
    given up where the map shows no way to it, or after twice the time that the way takes at cruise speed. A mission in
    words is then said to be done, without an answer.
    """

    points: list[tuple[float, float]]
    """What is left of the lanes (m), the next one first."""
    _until = -math.inf

    def _watch(self, t: float, speed: float) -> None:
        """Go on to the next point of the lanes when the present one is passed or given up."""
        if self.homing or self.end_reason:
            return
        pose, goal = self.belief.pose, self.belief.goal
        assert self.field is not None
        assert goal is not None
        if t < self._until and math.dist(pose[:2], goal) > PASSED_M and self.field.reaches(pose.x, pose.y):
            return
        if not self.points:
            self.end_reason = LANES_DONE
            if isinstance(self.planner, MissionPlanner):
                self._emit("held", source="lanes", decision=None, reason=LANES_DONE, answer="")
            return
        x, y = self.points.pop(0)
        self.goals.go_to(x, y, t, source="lanes", reason="the next point of the lanes")
        self._until = t + PATIENCE_S + 2.0 * math.dist(pose[:2], (x, y)) / self.planner.cfg.route.cruise_m_s


def lanes(size_m: tuple[float, float], spacing_m: float, start: Pose) -> NDArray[np.float64]:
    """Return straight lanes along x, `spacing_m` apart, so that no place is farther than half of that from a lane.

    They lie symmetrically in the area, and begin at the corner nearest to the start. Waypoints (m), Shape=(2 N + 1, 2).
    """
    width, height = size_m
    count = max(1, math.ceil(height / spacing_m - 1e-9))
    ys = [height / 2 + spacing_m * (k - (count - 1) / 2) for k in range(count)]
    if start.y > height / 2:
        ys.reverse()
    ends = [min(BORDER_M, width / 2), max(width - BORDER_M, width / 2)]
    if start.x > width / 2:
        ends.reverse()
    points = [(x, y) for k, y in enumerate(ys) for x in (ends if k % 2 == 0 else ends[::-1])]
    return np.array([start[:2], *points])


def along(points: NDArray[np.float64], stride_m: float = STRIDE_M) -> list[tuple[float, float]]:
    """Return points (m) along straight lines, Shape=(N, 2), at most `stride_m` apart, without the first one."""
    found: list[tuple[float, float]] = []
    for a, b in itertools.pairwise(points):
        n = max(1, math.ceil(math.dist(a, b) / stride_m - 1e-9))
        found += [(float(x), float(y)) for x, y in a + (b - a) * np.arange(1, n + 1)[:, None] / n]
    return found


def drive_lines(points: NDArray[np.float64], start: Pose, vehicle: VehicleCfg, dt: float) -> NDArray[np.float64]:
    """Compute commands that drive straight from point to point, Shape=(N, 2), at cruise speed and turn on the spot.

    The first point is at the start (m). Shape=(K, 2), one command every `dt` (s).
    """
    parts = []
    for a, b in itertools.pairwise(points):
        n = max(1, math.ceil(math.dist(a, b) / 0.05))
        parts.append(a + (b - a) * np.arange(n)[:, None] / n)
    return drive_path(np.concatenate([*parts, points[-1:]]), start, vehicle, dt, 200 * len(points))[0]


def drive_path(
    path: NDArray[np.float64], start: Pose, vehicle: VehicleCfg, dt: float, spare: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compute the drive along points (m) 0.05 m apart, Shape=(N, 2): commands, Shape=(K, 2), and the poses after them.

    It ends after four times the ticks that its length takes at cruise speed, and `spare` more: whoever is not there
    then never arrives.
    """
    most = int(4.0 * len(path) * 0.05 / (vehicle.max_speed_m_s * dt)) + spare
    commands, poses = np.empty((most, 2)), np.empty((most, 3))
    begin = (float(start.x), float(start.y), float(start.theta))
    n = follow(begin, path, vehicle.max_speed_m_s, vehicle.max_yaw_rate_rad_s, dt, most, commands, poses)
    return commands[:n], poses[:n]
