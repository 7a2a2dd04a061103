"""Places for pictures: clear of obstacles, near oysters, decided by the seed."""

import math

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.paint.viewpoints import choose_viewpoints
from coral.reef.vehicle.collision import clearance
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start, load_world

SCENE = Scene.from_world(load_world("s1"))


def test_cameras_are_clear_of_obstacles_and_near_oysters():
    poses = choose_viewpoints(SCENE, 30, np.random.default_rng(0))
    assert len(poses) == 30
    oysters = SCENE.center[SCENE.cluster >= 0, :2]
    for pose in poses:
        assert clearance(SCENE.footprints(), pose.x, pose.y) > 0.35
        assert np.linalg.norm(oysters - (pose.x, pose.y), axis=1).min() < 5.0


def test_an_oyster_lies_ahead_of_most():
    poses = choose_viewpoints(SCENE, 30, np.random.default_rng(0))
    oysters = SCENE.center[SCENE.cluster >= 0, :2]
    ahead = 0
    for pose in poses:
        away = oysters - (pose.x, pose.y)
        angle = np.abs(np.angle(np.exp(1j * (np.arctan2(away[:, 1], away[:, 0]) - pose.theta))))
        ahead += bool(((angle < math.radians(40)) & (np.linalg.norm(away, axis=1) < 5.0)).any())
    assert ahead > 25


def test_a_reef_without_room_is_refused():
    oyster = Oyster(x=5.0, y=5.0, z=0.03, radii=(0.1, 0.1, 0.05))
    wall = Obstacle(shape="box", x=5.0, y=5.0, z=1.0, size=(9.0, 9.0, 1.0))
    world = ReefWorld(
        name="w",
        size_m=(10, 10),
        start=Start(x=1, y=1),
        clusters=(Cluster(name="c", oysters=(oyster,)),),
        obstacles=(wall,),
    )
    with pytest.raises(InputError, match="no room for a camera"):
        choose_viewpoints(Scene.from_world(world), 1, np.random.default_rng(0))
