"""A small reef that a mission covers in under a minute of simulated time."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

sys.path.insert(0, str(Path(__file__).parent))


def bed(name: str, x: float, y: float, seed: int) -> Cluster:
    """Forty oysters about a point."""
    rng = np.random.default_rng(seed)
    return Cluster(
        name=name,
        oysters=tuple(
            Oyster(x=float(px), y=float(py), z=0.05, radii=(0.12, 0.09, 0.06), rpy=(0.0, 0.0, float(yaw)))
            for (px, py), yaw in zip(rng.normal((x, y), 0.4, (40, 2)), rng.uniform(-3, 3, 40), strict=True)
        ),
    )


@pytest.fixture(scope="session")
def pond() -> ReefWorld:
    """Three clusters round a corner, four obstacles on the way, 14 x 14 m."""
    posts = [(4.5, 3.6), (6.5, 2.3), (8.3, 4.8), (10.8, 6.3)]
    return ReefWorld(
        name="pond",
        size_m=(14.0, 14.0),
        start=Start(x=2.0, y=3.0, theta=0.0),
        clusters=(bed("near", 6.0, 3.5, 1), bed("corner", 10.0, 3.5, 2), bed("far", 10.5, 9.5, 3)),
        obstacles=tuple(Obstacle(shape="cylinder", x=x, y=y, z=0.8, size=(0.2, 0.2, 0.8)) for x, y in posts),
    )
