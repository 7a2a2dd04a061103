"""Obstacles of eyes that doubt: lines of sight over the floor, and evidence that other places can outvote."""

import dataclasses

import numpy as np
import pytest
from echoes import SMALL

from coral.reef.map.mapping import MapCfg, OccupancyMap
from coral.reef.map.sight_layer import SightLayer, SightLayerCfg
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Label, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

CAMERA = CameraCfg()
POST = Obstacle(shape="cylinder", x=5.0, y=5.0, z=0.8, size=(0.2, 0.2, 0.8))
BALL = Obstacle(shape="sphere", x=5.0, y=5.0, z=0.8, size=(0.25, 0.25, 0.25))


def seen(pose, *obstacles, depth_error=1.0, doubt=0.0):
    """What eyes see that are wrong about the depth of obstacles only."""
    reef = Cluster(name="c", oysters=(Oyster(x=8.0, y=8.0, z=0.1, radii=(0.15, 0.15, 0.08)),))
    world = ReefWorld(name="w", size_m=(10, 10), start=Start(x=2, y=5), clusters=(reef,), obstacles=obstacles)
    exact = Camera(Scene.from_world(world), CAMERA).render(pose)
    depth = np.where(exact.labels == Label.OBSTACLE, exact.depth * np.float32(depth_error), exact.depth)
    return dataclasses.replace(
        exact, depth=depth.astype(np.float32), doubt=np.full(exact.labels.shape, doubt, np.float32)
    )


def drive(cells, places, *obstacles, heading=0.0, **error):
    for x, y in places:
        pose = Pose(x, y, heading)
        cells.integrate(seen(pose, *obstacles, **error), pose)


def distances(cells, x=5.0, y=5.0):
    iy, ix = np.nonzero(cells.obstacle)
    return np.hypot((ix + 0.5) * 0.05 - x, (iy + 0.5) * 0.05 - y)


APPROACH = [(2.5 + 0.1 * k, 5.0) for k in range(12)]


@pytest.mark.parametrize("depth_error", [1.0, 1.5, 3.0])
def test_an_obstacle_stands_at_its_foot_however_far_the_network_puts_it(depth_error):
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    drive(cells, APPROACH, POST, depth_error=depth_error)
    assert len(distances(cells)) > 3
    assert np.mean(np.abs(distances(cells) - 0.2) < 0.25) > 0.9  # lines past its sides meet no foot


def test_no_obstacle_is_under_the_vehicle():
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    drive(cells, [(2.0, 2.0)])
    false = np.s_[38:43, 36:50]  # from 0.2 m behind the vehicle's middle to 0.5 m before it
    cells.sight.obstacle[false] = cells.sight._sure[false] = True
    cells.sight.odds[false] = 4.0
    cells.integrate(seen(Pose(2.0, 2.0, 1.5)), Pose(2.0, 2.0, 1.5))
    away = distances(cells, 2.025, 2.025)
    assert 0.2 < away.min() < 0.26
    assert away.max() > 0.4
    assert cells.sight.odds[40, 40] == 0.0


@pytest.mark.parametrize(
    ("place", "freed"), [((0.02, 0.02), 17), ((9.98, 9.98), 17), ((-3.0, 5.0), 0), ((5.0, 14.0), 0)]
)
def test_the_vehicle_may_be_at_the_edge_of_the_map_and_beyond(place, freed):
    layer = SightLayer(np.ones((200, 200), np.bool_), 0.05, CAMERA, 2.3, SightLayerCfg())
    assert layer._clear_under(Pose(*place, 0.0)) is (freed > 0)
    assert (~layer.obstacle).sum() == freed


def test_a_thing_without_a_foot_is_where_its_depth_puts_it():
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    drive(cells, APPROACH, BALL)
    assert len(distances(cells)) > 3
    assert np.abs(distances(cells) - 0.25).max() < 0.25


def test_what_one_place_alone_shows_is_no_obstacle():
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    drive(cells, [(3.5, 5.0)] * 50, POST)
    assert not cells.obstacle.any()
    drive(cells, [(3.7, 5.0), (3.9, 5.0)], POST)
    assert cells.obstacle.any()


def test_water_is_free_again_once_it_is_looked_through():
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    drive(cells, APPROACH, POST)
    assert cells.obstacle.any()
    version = cells.version
    drive(cells, [(3.0 + 0.1 * k, 4.0) for k in range(12)], heading=0.4)
    assert not cells.obstacle.any()
    assert cells.version > version


def test_an_obstacle_is_doubtful_until_it_is_seen_from_another_side_or_from_near():
    afar, aside, near = ([(2.5, 5.0), (2.7, 5.0), (2.9, 5.0)], [(3.3, 4.0), (3.5, 4.0)], [(3.9, 5.0), (4.0, 5.0)])
    for then, heading, sure in ([], 0.0, False), (aside, 0.5, True), (near, 0.0, True):
        cells = OccupancyMap((10.0, 10.0), CAMERA)
        drive(cells, afar, POST)
        drive(cells, then, POST, heading=heading)
        assert cells.obstacle.any()
        assert bool((cells.obstacle & ~cells.sight.doubtful).any()) == sure


def test_what_is_forgotten_of_a_copy_stays_on_the_map():
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    drive(cells, [(2.5, 5.0), (2.7, 5.0), (2.9, 5.0)], POST)
    copied, before = cells.snapshot(), cells.obstacle.copy()
    assert copied.forget_doubt()
    assert not copied.obstacle.any()
    assert np.array_equal(cells.obstacle, before)
    assert cells.forget_doubt()
    assert not cells.obstacle.any()
    assert not cells.forget_doubt()


def test_nothing_behind_an_obstacle_is_explored_however_far_the_network_puts_it():
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    drive(cells, APPROACH, POST, depth_error=3.0)
    assert cells.explored[100, 80]
    assert not cells.explored[100, 112:].any()


@pytest.mark.parametrize(("doubt", "metres"), [(0.0, 4.8), (0.4, 0.0)])
def test_explored_is_floor_that_is_seen_without_much_doubt(doubt, metres):
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    drive(cells, [(3.0, 5.0)], doubt=doubt)
    iy, ix = np.nonzero(cells.explored)
    found = np.hypot((ix + 0.5) * 0.05 - 3.0, (iy + 0.5) * 0.05 - 5.0).max(initial=0.0)
    assert found == pytest.approx(metres, abs=0.3)


def test_nothing_is_explored_beyond_floor_that_is_missing():
    cells, pose = OccupancyMap((10.0, 10.0), CAMERA), Pose(3.0, 5.0, 0.0)
    picture = seen(pose)
    picture.labels[66:74], picture.depth[66:74] = Label.WATER, np.inf
    cells.integrate(picture, pose)
    assert cells.explored[100, 80]
    assert not cells.explored[100, 100:].any()


def test_a_near_look_replaces_what_was_seen_from_afar():
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    afar, near = Pose(2.0, 5.0, 0.0), Pose(4.5, 5.0, 0.0)
    floor = seen(afar)
    wrong = dataclasses.replace(
        floor, labels=np.where(floor.labels == Label.SEABED, np.uint8(Label.OYSTER), floor.labels)
    )
    for k in range(8):
        cells.integrate(wrong, Pose(afar.x - 0.2 * (k % 2), afar.y, 0.0))
    assert cells.target[95:105, 102:110].any()
    cells.integrate(seen(near), near)
    assert not cells.target[95:105, 102:110].any()
    for _ in range(8):
        cells.integrate(wrong, afar)
    assert not cells.target[95:105, 102:110].any()


def test_one_pixel_alone_is_no_obstacle():
    cells = OccupancyMap((10.0, 10.0), CAMERA, MapCfg(sight=SightLayerCfg(solid=0.1)))
    pose = Pose(3.0, 5.0, 0.0)
    picture = seen(pose)
    picture.labels[70, 80] = Label.OBSTACLE
    cells.integrate(picture, pose)
    assert not cells.obstacle.any()
    picture.labels[71, 80] = Label.OBSTACLE
    cells.integrate(picture, Pose(3.2, 5.0, 0.0))
    assert cells.obstacle.any()


def test_closed_off_cells_stay_obstacles_whatever_is_looked_through():
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    drive(cells, APPROACH[:1])
    shut = np.zeros(cells.obstacle.shape, np.bool_)
    shut[100, 90] = True
    cells.close_off(shut)
    drive(cells, APPROACH)
    assert np.array_equal(cells.obstacle, shut)


def test_exact_pictures_and_those_beside_a_sonar_need_no_second_place():
    exact = OccupancyMap((10.0, 10.0), CAMERA)
    sonar = OccupancyMap((10.0, 10.0), CAMERA, MapCfg(obstacles="both"), SMALL)
    pose = Pose(3.5, 5.0, 0.0)
    picture = seen(pose, POST)
    for _ in range(3):
        exact.integrate(dataclasses.replace(picture, doubt=None), pose)
        sonar.integrate(picture, pose)
    assert exact.sight is sonar.sight is None
    assert exact.obstacle.any()
    assert np.array_equal(exact.obstacle, sonar.obstacle)


def test_what_a_map_recalls_holds_the_obstacles_of_sight():
    cells, later = OccupancyMap((10.0, 10.0), CAMERA), OccupancyMap((10.0, 10.0), CAMERA)
    drive(cells, APPROACH, POST)
    later.recall(cells.memory())
    assert np.array_equal(later.obstacle, cells.obstacle)


@pytest.mark.parametrize("sonar", [None, SMALL])
def test_a_shadow_taken_for_oysters_from_afar_is_floor_once_it_is_looked_at_from_near(sonar):
    cells = OccupancyMap((10.0, 10.0), CAMERA, sonar=sonar)

    def look(x, oysters):
        pose = Pose(x, 5.0, 0.0)
        view = seen(pose)
        labels = np.where(view.labels == Label.SEABED, np.uint8(Label.OYSTER if oysters else Label.SEABED), view.labels)
        cells.integrate(dataclasses.replace(view, labels=labels), pose)

    for k in range(8):
        look(2.0 + 0.12 * k, True)
    assert cells.target[100, 120]  # 4 m away at first
    for k in range(2):
        look(4.2 + 0.12 * k, False)
    assert not cells.target[100, 120]
    for k in range(5):
        look(4.8 + 0.12 * k, True)
    assert cells.target[100, 120]
