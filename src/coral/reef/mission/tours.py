"""Plans made before the dive, and the missions that follow one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.reef.mission.bound import oracle_bound
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.tour import drive_lines, lanes
from coral.reef.mission.word_oracle import word_tour
from coral.reef.world.geometry import Pose
from coral.reef.world.world import ReefWorld


def planned(world: ReefWorld, cfg: MissionCfg) -> NDArray[np.float64] | None:
    """Plan the commands of the oracle's tour or of a blind sweep, Shape=(K, 2); None where questions are asked."""
    if cfg.decider not in ("oracle", "sweep"):
        return None
    sim, start = cfg.simulator, Pose(world.start.x, world.start.y, world.start.theta)
    if cfg.decider == "sweep":
        return drive_lines(lanes(world.size_m, cfg.lane_m, start), start, sim.vehicle, cfg.control_period_s)
    if world.mission is not None:
        return word_tour(world, sim.vehicle, cfg.control_period_s)
    visibility_m = sim.noise.visibility_m
    return oracle_bound(world, sim.camera, sim.imaging, visibility_m, sim.vehicle, cfg.control_period_s).commands
