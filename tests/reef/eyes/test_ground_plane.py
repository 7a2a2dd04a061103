import numpy as np

from coral.reef.eyes.ground_plane import ground_depth, network_input, standing_depth
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Label, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import load_world

CAMERA = CameraCfg(width=32, height=24)


def test_ground_depth_is_what_the_camera_sees_of_the_bare_floor():
    frame = Camera(Scene.from_world(load_world("s1")), CAMERA).render(Pose(1.0, 2.0, 0.3), 0.8, roll=0.05, pitch=-0.04)
    depth = ground_depth(CAMERA, 0.8, roll=0.05, pitch=-0.04)
    floor = frame.labels == Label.SEABED
    assert floor.any()
    np.testing.assert_allclose(depth[floor], frame.depth[floor], rtol=1e-4)


def test_there_is_no_ground_above_the_horizon():
    depth = ground_depth(CameraCfg(width=4, height=4, pitch_down_deg=0.0))
    assert np.isinf(depth[:2]).all()
    assert np.isfinite(depth[2:]).all()


def test_the_network_reads_colours_about_zero_and_inverse_depth():
    rgb = np.zeros((2, 2, 3), np.uint8)
    rgb[0, 0] = (255, 0, 0)
    picture = network_input(rgb, np.array([[2.0, np.inf], [0.1, 4.0]], np.float32))
    assert picture[:, 0, 0].tolist() == [1.0, -1.0, -1.0, 0.5]
    assert picture[3].tolist() == [[0.5, 0.0], [4.0, 0.25]]


def test_floor_lies_on_the_plane_and_obstacles_stand_on_it():
    labels = np.array([[0, 2, 2], [3, 2, 0], [3, 1, 3]], np.uint8)
    ground = np.array([[np.inf] * 3, [4.0] * 3, [2.0] * 3], np.float32)
    expected = [[np.inf, 4.0, np.inf], [4.0, 4.0, np.inf], [2.0, 2.0, 2.0]]
    assert standing_depth(labels, ground).tolist() == expected


def test_each_obstacle_of_a_column_has_its_own_foot():
    labels = np.array([[2], [3], [2], [2]], np.uint8)
    ground = np.array([[8.0], [4.0], [3.0], [2.0]], np.float32)
    assert standing_depth(labels, ground).ravel().tolist() == [8.0, 4.0, 2.0, 2.0]
