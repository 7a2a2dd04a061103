"""What Blender is told: the same solids, camera and water. No Blender is needed."""

import json
import math

import numpy as np
import pytest

from coral.reef.paint.blender_scene import CyclesCfg, describe_scene, describe_view, solid_of_index
from coral.reef.simulation.daylight import PainterCfg, sun_direction
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import find_water
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

OYSTER = Oyster(x=4.0, y=5.0, z=0.03, radii=(0.1, 0.07, 0.05), rpy=(0.1, 0.2, 0.3))
WORLD = ReefWorld(
    name="w",
    size_m=(12, 12),
    start=Start(x=1, y=1),
    clusters=(Cluster(name="c", oysters=(OYSTER,)),),
    obstacles=(Obstacle(shape="cylinder", x=6, y=5, z=1, size=(0.2, 0.2, 1.0)),),
)
SCENE = Scene.from_world(WORLD)


def job(water="bay"):
    return describe_scene(SCENE, CameraCfg(), find_water(water), PainterCfg(), CyclesCfg(), seed=3)


def test_a_job_is_plain_json():
    assert json.loads(json.dumps(job())) == job()


def test_every_solid_is_described_as_it_is():
    shell, pile = job()["solids"]
    assert (shell["shape"], shell["material"]) == ("ellipsoid", "shell")
    assert (pile["shape"], pile["material"]) == ("cylinder", "pile")
    assert shell["center"] == [4.0, 5.0, 0.03]
    assert shell["half"] == [0.1, 0.07, 0.05]
    np.testing.assert_allclose(shell["rotation"], SCENE.rotation[0])


def test_half_of_the_scattering_counts_as_straight():
    water, told = find_water("bay"), job()["water"]
    np.testing.assert_allclose(told["scattering"], 0.5 * np.array(water.scattering))
    np.testing.assert_allclose(np.add(told["scattering"], told["absorption"]), water.lost)


def test_the_camera_looks_along_its_own_minus_z_with_y_up():
    view = describe_view("a", Pose(2.0, 3.0, 0.5), CameraCfg(pitch_down_deg=0.0), SCENE, 0)
    matrix = np.array(view["T_world_camera"])
    np.testing.assert_allclose(-matrix[:3, 2], [math.cos(0.5), math.sin(0.5), 0.0], atol=1e-12)
    np.testing.assert_allclose(matrix[:3, 1], [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(matrix[:3, 3], [2.0, 3.0, 1.0])


def test_the_sun_stands_higher_under_water():
    x, y, z = sun_direction(PainterCfg(sun_elevation_deg=30.0, sun_azimuth_deg=90.0))
    assert math.hypot(x, y, z) == pytest.approx(1.0)
    assert math.hypot(x, y) == pytest.approx(math.cos(math.radians(30.0)) / 1.34)
    assert (round(x, 9), y > 0.0) == (0.0, True)


def test_indices_of_blender_become_solids():
    instances, floor = solid_of_index(np.array([[0, 1, 2, 7]], np.int32))
    assert instances.tolist() == [[-1, -1, 0, 5]]
    assert floor.tolist() == [[False, True, False, False]]
