"""A simulated vehicle in a pool with one post."""

import numpy as np
import pytest

from coral.reef.simulation.simulated_vehicle import SimulatedVehicle
from coral.reef.simulation.simulator import ReefSimulator, SimulatorCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

POOL = ReefWorld(
    name="pool",
    size_m=(10.0, 10.0),
    start=Start(x=3.0, y=5.0),
    clusters=(Cluster(name="a", oysters=(Oyster(x=8.0, y=8.0, z=0.05, radii=(0.1, 0.1, 0.05)),)),),
    obstacles=(Obstacle(shape="cylinder", x=4.0, y=5.0, z=0.8, size=(0.2, 0.2, 0.8)),),
)


def vehicle(told):
    world = ReefSimulator(POOL, SimulatorCfg(), np.random.default_rng(0))
    return SimulatedVehicle(world, 0.1, lambda event, **fields: told.append({"event": event, **fields}))


def test_everything_is_measured_at_the_tick():
    one = vehicle([])
    seen = one.observe(0.7)
    assert (seen.pose.t, seen.velocity.t, seen.frame.t, seen.attitude.t) == (0.7, 0.7, 0.7, 0.7)
    assert seen.pose.value == Pose(3.0, 5.0, 0.0)


def test_a_command_moves_it_and_a_contact_is_told_once_with_the_obstacle():
    told = []
    one = vehicle(told)
    for _ in range(30):
        one.command((0.6, 0.0))
    (contact,) = told
    assert (contact["event"], contact["obstacle"]) == ("collision", 0)
    assert contact["x"] == pytest.approx(3.5, abs=0.02)
