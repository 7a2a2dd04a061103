"""Places from which a reef is worth a picture: clear of obstacles, with oysters ahead."""

from __future__ import annotations

import math

import numpy as np

from coral.errors import InputError
from coral.reef.vehicle.collision import clearance
from coral.reef.world.geometry import Label, Pose, wrap
from coral.reef.world.scene import Scene

_TRIES = 2000


def choose_viewpoints(
    scene: Scene,
    count: int,
    rng: np.random.Generator,
    *,
    wanted: Label = Label.OYSTER,
    aside_rad: float = 0.35,
    free_m: float = 0.35,
) -> list[Pose]:
    """Choose poses 0.5 to 5 m from a solid of the wanted class, at random, that look at it more or less.

    `aside_rad` is the standard deviation of their direction from that to the solid, `free_m` the least distance to an
    obstacle; by default the hull of a vehicle fits.

    Raises:
        InputError: There is no room among the obstacles.
    """
    among, hiders = np.flatnonzero(scene.label == wanted), scene.footprints()
    found: list[Pose] = []
    for _ in range(_TRIES + 20 * count):
        x, y = scene.center[among[rng.integers(len(among))], :2]
        away, way = rng.uniform(0.5, 5.0), rng.uniform(-math.pi, math.pi)
        heading = wrap(way + float(rng.normal(0.0, aside_rad)))
        pose = Pose(float(x - away * math.cos(way)), float(y - away * math.sin(way)), heading)
        if clearance(hiders, pose.x, pose.y) > free_m:
            found.append(pose)
            if len(found) == count:
                return found
    raise InputError("world", "obstacles", "no room for a camera", f"{count} places near oysters")
