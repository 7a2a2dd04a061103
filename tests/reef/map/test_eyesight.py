"""How far oysters are told from sea floor: by the pixels' size, and by the doubt of the floor with its distance."""

import dataclasses

import numpy as np
import pytest

from coral.reef.map.eyesight import Eyesight, looks_of
from coral.reef.map.mapping import OccupancyMap
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Oyster, ReefWorld, Start

CAMERA = CameraCfg()
REEF = Cluster(name="c", oysters=(Oyster(x=1.0, y=1.0, z=0.1, radii=(0.15, 0.15, 0.08)),))
WORLD = ReefWorld(name="w", size_m=(20, 20), start=Start(x=2, y=10), clusters=(REEF,))
BARE = Camera(Scene.from_world(WORLD), CAMERA)
LOOKS = looks_of(CAMERA)
POSE = Pose(4.0, 10.0, 0.0)


def seen(near=0.001, far=0.001, from_m=3.0):
    """A bare floor, whose doubt is another from some distance on."""
    exact = BARE.render(POSE)
    away = exact.depth * np.hypot(LOOKS[..., 0], LOOKS[..., 1])
    return dataclasses.replace(exact, doubt=np.where(away < from_m, near, far).astype(np.float32))


@pytest.mark.parametrize(
    ("doubt", "metres"),
    [
        ({}, 4.8),  # a row of pixels covers half a metre
        ({"far": 0.2}, 2.4),
        ({"far": 0.2, "from_m": 2.0}, 1.6),
        ({"near": 0.3, "far": 0.3}, 4.8),  # a network that states none
        ({"near": 0.1, "far": 0.15}, 4.8),
        ({"near": 0.1, "far": 0.4}, 2.4),
        ({"near": 1.0, "far": 1.0}, 0.0),  # a picture that is not judged
    ],
)
def test_eyes_see_as_far_as_the_floor_is_beyond_doubt(doubt, metres):
    eyesight = Eyesight(CAMERA)
    eyesight.look(seen(**doubt), LOOKS)
    assert eyesight.reach_m == pytest.approx(metres, abs=0.26)


def test_one_picture_among_many_changes_little():
    eyesight = Eyesight(CAMERA)
    for _ in range(100):
        eyesight.look(seen(far=0.2), LOOKS)
    eyesight.look(seen(), LOOKS)
    assert eyesight.reach_m < 3.5
    for _ in range(100):
        eyesight.look(seen(), LOOKS)
    assert eyesight.reach_m > 4.5


@pytest.mark.parametrize("sonar", [None, SonarCfg(enabled=True)])
def test_what_is_beyond_the_eyes_is_not_explored(sonar):
    cells = OccupancyMap((20.0, 20.0), CAMERA, sonar=sonar)
    cells.integrate(seen(far=0.2, from_m=2.5), POSE)
    assert cells.sees_m == pytest.approx(2.0, abs=0.26)
    assert cells.explored[200, int(5.8 / 0.05)]
    assert not cells.explored[:, int(6.4 / 0.05) :].any()


def test_exact_pictures_see_as_far_as_the_map_reaches():
    cells = OccupancyMap((20.0, 20.0), CAMERA)
    cells.integrate(BARE.render(POSE), POSE)
    assert cells.sees_m == 6.0
    assert cells.explored[200, int(9.8 / 0.05)]
