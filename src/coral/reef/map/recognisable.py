"""What of a true world a robot can recognise: clusters large and dense enough for its map, obstacles in its view."""

from __future__ import annotations

import math

import numpy as np

from coral.reef.map.chain import ChainCfg, components
from coral.reef.map.mapping import MapCfg
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.world_model import Cluster, ReefWorld


def unrecognisable(world: ReefWorld) -> list[str]:
    """Return a sentence for each cluster and obstacle that a robot with the default settings hardly recognises."""
    cfg, cell_m = ChainCfg(), MapCfg().cell_m
    found = [
        f"clusters[{k}] {cluster.name!r}: too few oysters to be recognised, which takes "
        f"{cfg.min_area_px * cell_m**2:g} m² with gaps of at most {cfg.closing_m:g} m"
        for k, cluster in enumerate(world.clusters)
        if cluster.kind is None and not components(_seen_from_above(cluster, cell_m), cell_m, cfg)
    ]
    swims_m = CameraCfg().altitude_m
    for k, obstacle in enumerate(world.obstacles):
        top_m = obstacle.z + obstacle.size[2] - world.seabed.z_m
        if top_m < swims_m and obstacle.thing is None and obstacle.tether is None:
            found.append(
                f"obstacles[{k}]: {top_m:.2g} m high, lower than the robot swims ({swims_m:g} m): it may look over it, "
                "but touching it counts"
            )
    return found


def _seen_from_above(cluster: Cluster, cell_m: float) -> np.ndarray[tuple[int, int], np.dtype[np.bool_]]:
    """Return the cells of a cluster's oysters on a grid of its own. Shape=(NY, NX)."""
    low = np.min([(one.x - max(one.radii), one.y - max(one.radii)) for one in cluster.oysters], axis=0)
    high = np.max([(one.x + max(one.radii), one.y + max(one.radii)) for one in cluster.oysters], axis=0)
    x, y = (np.arange(low[k], high[k] + cell_m, cell_m) for k in (0, 1))
    cells = np.zeros((len(y), len(x)), bool)
    for one in cluster.oysters:
        c, s = math.cos(one.rpy[2]), math.sin(one.rpy[2])
        dx, dy = x[None, :] - one.x, y[:, None] - one.y
        cells |= ((c * dx + s * dy) / one.radii[0]) ** 2 + ((c * dy - s * dx) / one.radii[1]) ** 2 <= 1.0
    return cells
