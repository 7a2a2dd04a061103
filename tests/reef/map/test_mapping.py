import dataclasses
import math
from dataclasses import replace

import numpy as np
import pytest
from echoes import SMALL, flat_floor

from coral.errors import InputError
from coral.reef.map.mapping import FREE, OBSTACLE, TARGET, UNEXPLORED, MapCfg, OccupancyMap
from coral.reef.map.mapping_kernels import Counts, classify
from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.vehicle.sensing import Attitude
from coral.reef.world.geometry import Frame, Label, Pose

CAMERA = CameraCfg(width=40, height=30)


def frame(depth, labels):
    return Frame(depth.astype(np.float32), labels.astype(np.uint8), np.full(depth.shape, -1, np.int32))


def empty_frame():
    shape = (CAMERA.height, CAMERA.width)
    return frame(np.full(shape, np.inf), np.zeros(shape))


def project_by_hand(u, v, z, pose):
    """Eq. 1, written out with homogeneous coordinates."""
    fx, fy, cx, cy = CAMERA.intrinsics
    p = T_world_camera(pose, CAMERA) @ np.array([(u - cx) / fx * z, (v - cy) / fy * z, z, 1.0])
    return p[:3] / p[3]


@pytest.mark.parametrize(("label", "cell"), [(Label.OYSTER, TARGET), (Label.OBSTACLE, OBSTACLE)])
def test_a_pixel_lands_in_the_cell_of_equation_1(label, cell):
    pose = Pose(4.0, 5.0, 0.7)
    view = empty_frame()
    view.depth[20, 25], view.labels[20, 25] = 2.0, label
    grid = OccupancyMap((10.0, 10.0), CAMERA, MapCfg(target_hits=1, obstacle_hits=1))
    grid.integrate(view, pose)
    x, y, _ = project_by_hand(25, 20, 2.0, pose)
    expected = np.full(grid.target.shape, UNEXPLORED)
    expected[int(y / 0.05), int(x / 0.05)] = cell
    marked = grid.cells()
    assert np.array_equal(np.where(marked == FREE, UNEXPLORED, marked), expected)


@pytest.mark.parametrize(("label", "pictures", "cell"), [(Label.OYSTER, 2, TARGET), (Label.OBSTACLE, 3, OBSTACLE)])
def test_a_cell_counts_once_enough_pictures_agree_however_many_pixels_they_put_there(label, pictures, cell):
    view = empty_frame()
    view.depth[18:22, 25], view.labels[18:22, 25] = 2.0, label
    grid = OccupancyMap((10.0, 10.0), CAMERA)
    for _ in range(pictures):
        assert not np.any(grid.cells() == cell)
        grid.integrate(view, Pose(4.0, 5.0, 0.0))
    assert np.any(grid.cells() == cell)


def test_a_picture_counts_a_cell_once_for_each_class_that_it_shows_there():
    view = empty_frame()
    view.depth[18:22, 25] = 2.0
    view.labels[18:22, 25] = Label.OBSTACLE, Label.SEABED, Label.OBSTACLE, Label.OYSTER
    grid = OccupancyMap((10.0, 10.0), CAMERA)
    for _ in range(5):
        grid.integrate(view, Pose(4.0, 5.0, 0.0))
    assert [counts.max() for counts in (grid._targets, grid._obstacles, grid._ground)] == [5, 5, 5]


def test_obstacles_beyond_the_sensing_range_are_left_out():
    view = empty_frame()
    view.depth[15, 20], view.labels[15, 20] = 5.0, Label.OBSTACLE
    grid = OccupancyMap((20.0, 20.0), CAMERA, MapCfg(obstacle_hits=1))
    grid.integrate(view, Pose(4.0, 10.0, 0.0))
    assert not grid.obstacle.any()


def test_explored_is_the_visible_sector_and_stops_at_an_obstacle():
    view = frame(np.full((CAMERA.height, CAMERA.width), 10.0), np.zeros((CAMERA.height, CAMERA.width)))
    grid = OccupancyMap((20.0, 20.0), CAMERA)
    wall = int(7.0 / 0.05)
    grid.obstacle[int(9.0 / 0.05) : int(11.0 / 0.05), wall] = True
    grid._obstacles[grid.obstacle] = 10
    grid.integrate(view, Pose(5.0, 10.0, 0.0))
    ys, xs = np.nonzero(grid.explored)
    forward, left = (xs + 0.5) * 0.05 - 5.0, (ys + 0.5) * 0.05 - 10.0
    assert np.all(np.hypot(forward, left) <= 6.0 + 0.08)
    assert np.all(np.abs(np.degrees(np.arctan2(left, forward)))[np.hypot(forward, left) > 1.0] <= 62.5)
    straight = grid.explored[int(10.0 / 0.05)]
    assert straight[wall]
    assert not straight[wall + 1 :].any()
    sector = math.pi * 36 / 3
    assert 0.6 * sector < grid.explored.sum() * 0.05**2 < sector


def test_nothing_is_explored_where_the_camera_had_no_return():
    grid = OccupancyMap((20.0, 20.0), CAMERA)
    grid.integrate(empty_frame(), Pose(5.0, 10.0, 0.0))
    assert not grid.explored.any()


def test_wrong_obstacle_pixels_are_outvoted_by_the_seabed():
    pose, grid = Pose(4.0, 5.0, 0.0), OccupancyMap((10.0, 10.0), CAMERA)
    view = empty_frame()
    view.depth[25, 20], view.labels[25, 20] = 1.0, Label.OBSTACLE
    for _ in range(3):
        grid.integrate(view, pose)
    assert grid.obstacle.sum() == 1
    version = grid.version
    view.labels[25, 20] = Label.SEABED
    for _ in range(11):
        grid.integrate(view, pose)
    assert not grid.obstacle.any()
    assert grid.version > version


def test_bare_floor_of_long_ago_does_not_outvote_an_obstacle_that_is_in_view_now():
    pose, grid = Pose(4.0, 5.0, 0.0), OccupancyMap((10.0, 10.0), CAMERA)
    view = empty_frame()
    view.depth[25, 20], view.labels[25, 20] = 1.0, Label.SEABED
    for _ in range(300):
        grid.integrate(view, pose)
    view.labels[25, 20] = Label.OBSTACLE
    for _ in range(10):
        grid.integrate(view, pose)
    assert grid.obstacle.sum() == 1


@pytest.mark.parametrize(("wrong", "believed"), [(6, False), (40, True)])
def test_oysters_in_a_few_of_many_pictures_are_outvoted_by_the_seabed(wrong, believed):
    grid, views = OccupancyMap((10.0, 10.0), CAMERA), empty_frame()
    views.depth[25, 20] = 1.0
    for k in range(100):
        views.labels[25, 20] = Label.OYSTER if k % 100 < wrong else Label.SEABED
        grid.integrate(views, Pose(4.0, 5.0, 0.0))
    assert grid.target.any() == believed


def test_agreement_is_the_mean_share_of_the_pictures_with_oysters():
    grid = OccupancyMap((10.0, 10.0), CAMERA)
    grid._targets[4, 5], grid._ground[4, 5] = 3, 1
    grid._targets[4, 6], grid._ground[4, 6] = 2, 6
    assert grid.agreement(np.array([[4, 5], [4, 6]])) == pytest.approx(0.5)
    assert grid.agreement(np.empty((0, 2), np.intp)) == grid.agreement(np.array([[9, 9]])) == 1.0


def test_local_distances_agree_with_the_whole_map():
    rng = np.random.default_rng(0)
    grid = OccupancyMap((20.0, 20.0), CAMERA)
    grid.obstacle[:] = rng.random(grid.obstacle.shape) < 0.002
    near, full = grid.distance_near(10.0, 10.0, 5.0), grid.distance()
    window = slice(int(8 / 0.05), int(12 / 0.05))
    assert np.allclose(near[window, window], full[window, window], atol=1e-6)


def test_local_distances_follow_a_new_obstacle():
    grid = OccupancyMap((20.0, 20.0), CAMERA, MapCfg(obstacle_hits=1))
    assert np.isinf(grid.distance_near(10.0, 10.0, 5.0)).all()
    view = empty_frame()
    view.depth[15, 20], view.labels[15, 20] = 2.0, Label.OBSTACLE
    grid.integrate(view, Pose(10.0, 10.0, 0.0))
    assert grid.distance_near(10.0, 10.0, 5.0).min() == 0.0


def test_distances_follow_the_obstacles():
    grid = OccupancyMap((20.0, 20.0), CAMERA)
    grid.obstacle[100, 100] = True
    first = grid.distance()
    assert grid.distance() is first
    grid.obstacle[100, 110] = True
    assert grid.distance()[100, 110] == 0.0
    grid.obstacle[:] = False
    assert np.all(np.isinf(grid.distance()))


def test_cells_are_classified_as_their_counts_say():
    rng = np.random.default_rng(6)
    counts = rng.integers(0, 4, (3, 40, 40)).astype(np.uint16)
    counts[2] *= rng.integers(0, 60, (40, 40)).astype(np.uint16)
    target, obstacle = rng.random((2, 40, 40)) < 0.2
    before = obstacle.copy()
    solid = (counts[1] >= 3) & (counts[1] >= 0.3 * counts[2])
    sharp = rng.random((40, 40)) < 0.5
    soft = (counts[0] >= 2) & (counts[0] >= np.where(sharp, 0.1, 0.05) * counts[2]) & ~solid
    seen = Counts(*counts, np.zeros((40, 40), np.int32), sharp)
    changed = classify(seen, 2, 3, 0.05, 0.1, 0.3, target, obstacle, (0, 40, 0, 40))
    assert np.array_equal(obstacle, solid)
    assert np.array_equal(target, soft)
    assert changed == np.count_nonzero(before != solid)


def test_a_closed_off_cell_stays_an_obstacle_whatever_is_seen_there():
    grid = OccupancyMap((10.0, 10.0), CAMERA)
    closed = np.zeros(grid.target.shape, np.bool_)
    closed[90:110, 110:130] = True
    before = grid.version
    grid.close_off(closed)
    assert grid.version == before + 1
    view = empty_frame()
    view.depth[20:30], view.labels[20:30] = 1.5, Label.SEABED
    for _ in range(50):
        grid.integrate(view, Pose(5.0, 5.0, 0.0))
    assert np.array_equal(grid.obstacle, closed)


def test_a_map_recalls_what_another_knew():
    view = empty_frame()
    view.depth[15:25], view.labels[15:25] = 2.0, Label.OYSTER
    view.depth[15:25, :10], view.labels[15:25, :10] = 2.0, Label.OBSTACLE
    first, second = (OccupancyMap((10.0, 10.0), CAMERA) for _ in range(2))
    for _ in range(4):
        first.integrate(view, Pose(4.0, 5.0, 0.0))
    second.recall(first.memory())
    assert np.array_equal(first.cells(), second.cells())
    assert np.array_equal(first.nearest, second.nearest)
    with pytest.raises(ValueError, match="explored"):
        second.recall({**first.memory(), "explored": np.zeros((3, 3), np.bool_)})


@pytest.mark.parametrize(
    "change",
    [
        {"depth": np.ones((480, 640), np.float32), "labels": np.ones((480, 640), np.uint8)},
        {"labels": np.ones((29, 40), np.uint8)},
        {"depth": np.ones((30, 40))},
        {"labels": np.ones((30, 40), np.int64)},
    ],
)
def test_a_picture_of_another_size_or_type_never_reaches_the_kernels(change):
    cells = OccupancyMap((4.0, 4.0), CAMERA)
    with pytest.raises(InputError, match=r"float32 of shape \(30, 40\)|uint8 of shape \(30, 40\)"):
        cells.integrate(dataclasses.replace(empty_frame(), **change), Pose(2.0, 2.0, 0.0))


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_pose_that_is_not_finite_never_reaches_the_kernels(bad):
    with pytest.raises(InputError, match="pose"):
        OccupancyMap((4.0, 4.0), CAMERA).integrate(empty_frame(), Pose(2.0, bad, 0.0))


@pytest.mark.parametrize(("roll", "pitch"), [(0.3, 0.0), (0.0, -0.25), (-0.2, 0.15)])
def test_a_picture_of_a_tilted_vehicle_lands_where_equation_1_puts_it(roll, pitch):
    pose, (u, v, z) = Pose(4.0, 5.0, 0.7), (25, 20, 2.0)
    view = empty_frame()
    view.depth[v, u], view.labels[v, u] = z, Label.OYSTER
    grid = OccupancyMap((10.0, 10.0), CAMERA, MapCfg(target_hits=1))
    grid.integrate(view, pose, roll, pitch)
    fx, fy, cx, cy = CAMERA.intrinsics
    p = T_world_camera(pose, CAMERA, roll=roll, pitch=pitch) @ [(u - cx) / fx * z, (v - cy) / fy * z, z, 1.0]
    assert np.argwhere(grid.target).tolist() == [[int(p[1] / 0.05), int(p[0] / 0.05)]]


def ahead(range_m=2.0):
    """An image with one echo: straight ahead, 15 degrees down, from a post."""
    image = flat_floor()
    image.ranges[10, 15] = range_m
    return image


def seen_post(x=8.0):
    """A picture of an obstacle somewhere else."""
    view = empty_frame()
    view.depth[10:20, 10:14], view.labels[10:20, 10:14] = 2.0, Label.OBSTACLE
    return view


@pytest.mark.parametrize("whose", ["auto", "both", "sonar"])
def test_the_sonars_obstacles_are_a_layer_of_their_own(whose):
    grid, pose = OccupancyMap((10.0, 10.0), CAMERA, MapCfg(obstacles=whose), SMALL), Pose(4.0, 5.0, 0.0)
    for _ in range(3):
        grid.integrate(seen_post(), pose)
        grid.hear(ahead(), pose)
    heard = int(5.0 / 0.05), int((4.0 + 2.0 * math.cos(math.radians(15.0))) / 0.05)
    assert grid.obstacle[heard]
    assert grid.layer.obstacle.sum() == 1
    assert (grid.obstacle.sum() > 1) == (whose != "sonar")
    assert grid.sonar_alone == (whose == "sonar")
    grid.integrate(seen_post(), pose)  # the camera cannot see it, and says nothing about it
    assert grid.obstacle[heard]


@pytest.mark.parametrize("whose", ["auto", "both"])
def test_beside_a_sonar_obstacles_of_estimated_depth_do_not_count(whose):
    grid, pose = OccupancyMap((10.0, 10.0), CAMERA, MapCfg(obstacles=whose), SMALL), Pose(4.0, 5.0, 0.0)
    view = seen_post()
    view = replace(view, doubt=np.zeros(view.labels.shape, np.float32))
    for _ in range(3):
        grid.integrate(view, pose)
        grid.hear(ahead(), pose)
    assert grid.sonar_alone == (whose == "auto")
    assert (grid.obstacle.sum() > 1) == (whose == "both")


def test_closed_off_cells_stay_obstacles_whatever_the_sonar_hears():
    grid = OccupancyMap((10.0, 10.0), CAMERA, MapCfg(obstacles="sonar"), SMALL)
    cells = np.zeros(grid.obstacle.shape, np.bool_)
    cells[100, 118:122] = True
    grid.close_off(cells)
    for _ in range(3):
        grid.hear(ahead(), Pose(4.0, 5.0, 0.0), Attitude(roll=0.0, pitch=0.0, depth_m=5.0, altitude_m=1.0))
    assert grid.obstacle[cells].all()


def test_a_recalled_map_keeps_what_the_sonar_has_heard_since():
    first, pose = OccupancyMap((10.0, 10.0), CAMERA), Pose(4.0, 5.0, 0.0)
    for _ in range(3):
        first.integrate(seen_post(), pose)
    grid = OccupancyMap((10.0, 10.0), CAMERA, MapCfg(), SMALL)
    for _ in range(3):
        grid.hear(ahead(), pose)
    grid.recall(first.memory())
    assert np.array_equal(grid.obstacle, first.obstacle | grid.layer.obstacle)


def test_a_map_without_a_sonar_takes_no_range_image():
    with pytest.raises(InputError, match="without a sonar"):
        OccupancyMap((10.0, 10.0), CAMERA).hear(ahead(), Pose(4.0, 5.0, 0.0))


def test_unknown_water_is_an_obstacle_for_a_blind_vehicle_but_not_where_it_has_been():
    fine = dataclasses.replace(SMALL, width=121, height=61)
    grid, pose = OccupancyMap((10.0, 10.0), CAMERA, MapCfg(), fine), Pose(4.0, 5.0, 0.0)
    grid.hear(flat_floor(fine), pose)
    distance = grid.distance_to_unknown(4.0, 5.0, 3.0, np.array([[3.0, 5.0], [4.0, 5.0]]), 0.45)
    row = distance[100]
    assert row[80] > 0.3  # where it is
    assert row[60] > 0.3  # where it was
    assert row[122] > 0.1  # clear by sonar, 2.1 m ahead
    assert distance[160, 80] == 0.0  # beside it
    assert distance[100, 10] == 0.0  # far away


def test_doubtful_oysters_are_no_evidence():
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    labels = np.full((CAMERA.height, CAMERA.width), Label.OYSTER, np.uint8)
    depth, nobody = np.full(labels.shape, 2.0, np.float32), np.full(labels.shape, -1, np.int32)
    for k in range(3):
        cells.integrate(
            Frame(depth, labels, nobody, doubt=np.full(labels.shape, 0.9, np.float32)), Pose(5.0 + 0.2 * k, 5.0, 0.0)
        )
    assert not cells.target.any()
    for k in range(3):
        cells.integrate(
            Frame(depth, labels, nobody, doubt=np.full(labels.shape, 0.1, np.float32)), Pose(5.0 + 0.2 * k, 5.0, 0.0)
        )
    assert cells.target.any()


@pytest.mark.parametrize("estimated", [False, True])
def test_the_unexplored_inside_of_a_boulder_is_no_hint_of_eyes_that_doubt(estimated):
    cells = OccupancyMap((10.0, 10.0), CAMERA)
    cells.estimated = estimated
    cells._hints[10, 4] = cells._hints[10, 14] = 5
    cells.explored[:, :120] = True
    cells.explored[95:115, 35:55] = False  # about a metre wide, at x = 2.25
    assert [round(x, 2) for x, _ in cells.hints()] == ([7.25] if estimated else [2.25, 7.25])
