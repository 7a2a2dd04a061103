"""The obstacle layer: echoes, clear water and the kernel's twin."""

import dataclasses
import math

import numpy as np
import pytest
from echoes import SMALL, flat_floor

from coral.reef.map.layer_kernels import HIT, LEVEL, LOW, THROUGH, mark
from coral.reef.map.obstacle_layer import ObstacleLayer, SonarLayerCfg
from coral.reef.map.sonar_3d15 import Sonar3d15, sonar_attitude
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

CELL_M = 0.1
HERE = Pose(2.0, 3.0, 0.0)
POST = Obstacle(shape="cylinder", x=4.5, y=3.2, z=0.7, size=(0.2, 0.2, 0.7))
BALL = Obstacle(shape="sphere", x=4.5, y=2.6, z=0.9, size=(0.12, 0.12, 0.12))
FINE = dataclasses.replace(SMALL, width=121, height=61)


def layer(sonar=SMALL, **cfg):
    return ObstacleLayer((60, 80), CELL_M, sonar, SonarLayerCfg(**cfg))


def device(*obstacles, cfg=SMALL):
    reef = Cluster(name="c", oysters=(Oyster(x=5.0, y=3.9, z=0.1, radii=(0.15, 0.15, 0.08)),))
    start = Start(x=2, y=3)
    world = ReefWorld(name="w", size_m=(8, 6), start=start, clusters=(reef,), obstacles=obstacles)
    return Sonar3d15(Scene.from_world(world), cfg, np.random.default_rng(0))


def at(cells, x, y):
    return bool(cells[int(y / CELL_M), int(x / CELL_M)])


def mark_by_hand(image, turn, place, cfg, height, shape):
    """The kernel again, cell by cell and without its shortcuts."""
    said, beams, (x0, y0, z0) = np.zeros(shape, np.uint8), image.directions() @ turn.T, place
    for u in range(image.ranges.shape[1]):
        echoes = np.isfinite(image.ranges[:, u]).sum()
        for v in range(image.ranges.shape[0]):
            r, d = float(image.ranges[v, u]), beams[v, u]
            flat = math.hypot(d[0], d[1])
            if math.isfinite(r):
                z = z0 + r * d[2]
                if r * flat <= cfg.range_m and cfg.floor_m < z < z0 + cfg.above_m:
                    iy, ix = int((y0 + r * d[1]) // CELL_M), int((x0 + r * d[0]) // CELL_M)
                    if 0 <= iy < shape[0] and 0 <= ix < shape[1]:
                        said[iy, ix] |= HIT
                reach = min(r * flat - cfg.back_m, cfg.clear_m)
            elif 4 * echoes >= image.ranges.shape[0] and d[2] > -0.05:
                reach = cfg.clear_m
            else:
                continue
            for k in range(int(reach / CELL_M)) if v % 2 == 0 else ():
                s = (k + 0.5) * CELL_M / flat
                x, y, z = x0 + s * d[0], y0 + s * d[1], z0 + s * d[2]
                iy, ix = int(y // CELL_M), int(x // CELL_M)
                if z < 0.0 or not (0 <= iy < shape[0] and 0 <= ix < shape[1]):
                    break
                said[iy, ix] |= LOW * (z <= cfg.low_m) | LEVEL * (abs(z - z0) <= cfg.level_m)
                if math.isfinite(r) and abs(z - height[iy, ix]) < 0.1:
                    said[iy, ix] |= THROUGH
    return said


def test_the_kernel_marks_what_its_twin_marks():
    image = device(POST, BALL).image(HERE, 1.0)
    turn, cfg, shape = sonar_attitude(0.3, 0.1, -0.05, 15.0), SonarLayerCfg(), (60, 80)
    height = np.full(shape, np.nan, np.float32)
    height[30:40, 40:50] = 0.7
    expected = mark_by_hand(image, turn, (2.0, 3.0, 1.0), cfg, height.copy(), shape)
    said = np.zeros(shape, np.uint8)
    mark(
        image.ranges, image.directions(), turn, (2.0, 3.0, 1.0), CELL_M, (cfg.floor_m, 1.0 + cfg.above_m), cfg.low_m,
        (1.0 - cfg.level_m, 1.0 + cfg.level_m), cfg.clear_m, cfg.range_m, cfg.back_m, height, said,
    )  # fmt: skip
    assert all((expected & bit).any() for bit in (HIT, LOW, LEVEL, THROUGH))
    # Echoes change the heights of their cells on the way, so only THROUGH may differ, and there only.
    assert np.array_equal(said & (HIT | LOW | LEVEL), expected & (HIT | LOW | LEVEL))
    assert ((said ^ expected)[(expected & HIT) == 0] == 0).mean() > 0.999


def test_obstacles_stand_where_they_are_and_oysters_and_floor_are_none():
    cells, sonar = layer(), device(POST, BALL)
    for _ in range(3):
        cells.integrate(sonar.image(HERE, 1.0), HERE, 1.0)
    found = (np.argwhere(cells.obstacle)[:, ::-1] + 0.5) * CELL_M
    from_post, from_ball = (np.hypot(*(found - (o.x, o.y)).T) - o.size[0] for o in (POST, BALL))
    assert (np.minimum(from_post, from_ball) < CELL_M).all()
    assert (from_post < CELL_M).any()
    assert (from_ball < CELL_M).any()


def test_a_tilted_vehicle_finds_the_same_post():
    cells, sonar = layer(), device(POST)
    for roll, pitch in ((0.2, 0.0), (-0.2, 0.1), (0.1, -0.1)):
        cells.integrate(sonar.image(HERE, 1.1, roll=roll, pitch=pitch), HERE, 1.1, roll=roll, pitch=pitch)
    found = (np.argwhere(cells.obstacle)[:, ::-1] + 0.5) * CELL_M
    assert len(found)
    assert (np.hypot(*(found - (POST.x, POST.y)).T) < 0.2 + CELL_M).all()


def test_one_echo_is_no_obstacle():
    cells, sonar = layer(hits=2), device(POST)
    assert not cells.integrate(sonar.image(HERE, 1.0), HERE, 1.0)
    assert not cells.obstacle.any()
    assert cells.integrate(sonar.image(HERE, 1.0), HERE, 1.0)
    assert cells.obstacle.any()


def test_beams_that_pass_outvote_echoes_that_came_by_a_detour():
    cells = layer(hits=1, ratio=0.5)
    ghost = flat_floor()
    ghost.ranges[14, 15] = 2.0  # one beam, 0.9 m above the floor at 4 m
    cells.integrate(ghost, HERE, 1.0)
    assert cells.obstacle.sum() == 1
    wall = flat_floor()
    wall.ranges[:] = np.minimum(wall.ranges, 5.0)  # beams at that height go on beyond the cell
    for _ in range(3):
        cells.integrate(wall, HERE, 1.0)
    assert not cells.obstacle[:, :45].any()


def test_old_clear_water_does_not_outvote_a_new_echo():
    cells, echo, wall = layer(hits=1, ratio=0.5), flat_floor(), flat_floor()
    echo.ranges[14, 15] = 2.0
    wall.ranges[:] = np.minimum(wall.ranges, 5.0)
    cells.integrate(echo, HERE, 1.0)
    for _ in range(300):
        cells.integrate(wall, HERE, 1.0)
    assert not cells.obstacle[:, :45].any()
    for _ in range(20):
        cells.integrate(echo, HERE, 1.0)
    assert cells.obstacle[:, :45].any()


def test_clear_is_what_beams_have_passed_both_low_and_at_the_vehicles_height():
    cells = layer(FINE)
    cells.integrate(flat_floor(FINE), HERE, 1.0)
    assert at(cells.free, 4.5, 3.4)
    assert not at(cells.free, 2.4, 3.0)  # below the lowest beams
    assert not at(cells.free, 2.0, 5.0)  # beside the field of view
    steep = dataclasses.replace(FINE, pitch_down_deg=45.0)  # sees the floor, but not what floats ahead
    blinkered = layer(steep)
    blinkered.integrate(flat_floor(steep), HERE, 1.0)
    assert not blinkered.free[:, 32:].any()  # from 1.2 m ahead on


def test_behind_a_post_nothing_is_known_to_be_clear():
    cells, sonar = layer(FINE), device(POST, cfg=FINE)
    cells.integrate(sonar.image(HERE, 1.0), HERE, 1.0)
    assert at(cells.free, 3.8, 3.15)
    assert not at(cells.free, 5.2, 3.36)


def test_the_surface_is_no_obstacle():
    image = flat_floor()
    image.ranges[-1, :] = 0.4 / math.sin(math.radians(5.0)) * 0.5  # 0.2 m above the vehicle, 2.3 m ahead
    open_water, shallow = layer(hits=1), layer(hits=1)
    open_water.integrate(image, HERE, 1.0)
    shallow.integrate(image, HERE, 1.0, depth_m=0.3)
    assert open_water.obstacle.any()
    assert not shallow.obstacle.any()


@pytest.mark.parametrize("pose", [Pose(-30.0, 3.0, 0.0), Pose(2.0, 90.0, 1.0), Pose(0.0, 0.0, math.pi)])
def test_a_vehicle_beside_the_map_marks_nothing_outside(pose):
    cells = layer()
    cells.integrate(flat_floor(), pose, 1.0)
    assert not cells.obstacle.any()


def test_an_image_of_another_mode_is_placed_by_its_own_field_of_view():
    image = RangeImage(np.full((9, 9), np.inf, np.float32), 40.0, 40.0)
    image.ranges[6, 0] = 2.0  # azimuth 20 degrees to the left, 5 degrees below the horizon
    cells = layer(hits=1)
    cells.integrate(image, HERE, 1.0)
    ((iy, ix),) = np.argwhere(cells.obstacle)
    assert ((ix + 0.5) * CELL_M, (iy + 0.5) * CELL_M) == pytest.approx((2 + 1.87, 3 + 0.67), abs=0.06)
