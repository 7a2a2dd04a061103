"""True motions to navigate along."""

import math

import numpy as np

from coral.reef.vehicle.sensing import Attitude
from coral.reef.world.geometry import Pose, wrap

LEVEL = Attitude(roll=0.0, pitch=0.0, depth_m=4.0, altitude_m=1.0)


def wander(seconds, seed=0, dt=0.1, speed_m_s=0.5):
    """Pose and body velocity every `dt` seconds: straight legs and turns, from rest."""
    rng = np.random.default_rng(seed)
    x = y = theta = u = turn = wanted = 0.0
    yield Pose(x, y, theta), (u, 0.0, turn)
    for k in range(round(seconds / dt)):
        wanted = rng.uniform(-0.3, 0.3) if k % 50 == 0 else wanted
        before, u = u, u + 0.05 * (speed_m_s - u)
        turn += 0.1 * (wanted - turn)
        middle, way = theta + 0.5 * turn * dt, 0.5 * (before + u) * dt
        x, y, theta = x + math.cos(middle) * way, y + math.sin(middle) * way, wrap(theta + turn * dt)
        yield Pose(x, y, theta), (u, 0.0, turn)
