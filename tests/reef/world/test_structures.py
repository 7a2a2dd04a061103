"""Tethers, walls and tanks, as the solids that sensors and collisions know."""

import math

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.vehicle.collision import clearance
from coral.reef.world.scene import Scene
from coral.reef.world.structures import TANK_SIDES, Obstacle, Tank, Tether, Wall, structures
from coral.reef.world.world import Cluster, Oyster, ReefWorld, Start, check_world, load_world, save_world

BALL = Obstacle(shape="sphere", x=2.0, y=1.0, z=0.9, size=(0.1, 0.1, 0.1), tether=Tether())


def pool(**changes):
    parts = {
        "name": "pool",
        "size_m": (4.0, 4.0),
        "start": Start(x=2.0, y=2.0),
        "clusters": (Cluster(name="c", oysters=(Oyster(x=2.8, y=2.0, z=0.03, radii=(0.06, 0.05, 0.03)),)),),
        "tank": Tank(x=2.0, y=2.0, radius_m=1.8),
    }
    return ReefWorld(**{**parts, **changes})


def test_a_tank_keeps_its_inner_radius_in_every_direction():
    outlines = Scene.from_world(pool()).footprints()
    assert len(outlines.kind) == TANK_SIDES
    for angle in np.linspace(0.0, 2.0 * math.pi, 29):
        x, y = 2.0 + 1.5 * math.cos(angle), 2.0 + 1.5 * math.sin(angle)
        assert clearance(outlines, x, y) == pytest.approx(0.3, abs=0.005)
        beyond = 2.0 + 1.85 * math.cos(angle), 2.0 + 1.85 * math.sin(angle)
        assert clearance(outlines, *beyond) < 0.0  # no gap between two sides


def test_a_ball_hangs_on_a_line_from_its_anchor():
    line, anchor = structures((BALL,), (), None, 0.1)
    assert line.shape == "cylinder"
    assert (line.z + line.size[2], line.z - line.size[2]) == pytest.approx((0.8, 0.1))
    assert (anchor.shape, anchor.z - anchor.size[2]) == ("box", pytest.approx(0.1))
    assert {(part.x, part.y) for part in (line, anchor)} == {(2.0, 1.0)}


def test_a_wall_stands_between_its_ends():
    (box,) = structures((), (Wall(begin=(1.0, 1.0), end=(1.0, 3.0), thickness_m=0.2, height_m=1.0),), None, 0.0)
    assert (box.x, box.y, box.z, box.size) == (1.0, 2.0, 0.5, (1.0, 0.1, 0.5))
    assert box.yaw == pytest.approx(math.pi / 2)


def test_the_files_obstacles_come_first_so_that_events_name_them():
    world = pool(obstacles=(BALL,))
    assert world.solids[0] is BALL
    assert len(world.solids) == 3 + TANK_SIDES


def test_a_pool_survives_its_file(tmp_path):
    world = pool(obstacles=(BALL,), walls=(Wall(begin=(1.0, 3.0), end=(3.0, 3.0)),), water_depth_m=1.5)
    save_world(world, tmp_path / "pool.yaml")
    assert load_world(tmp_path / "pool.yaml") == world


def test_what_a_world_does_not_have_is_not_written(tmp_path):
    save_world(pool(tank=None), tmp_path / "open.yaml")
    text = (tmp_path / "open.yaml").read_text()
    assert not any(word in text for word in ("tank", "walls", "water_depth", "tether", "null"))


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"tank": Tank(x=2.0, y=1.0, radius_m=1.8)}, "tank.y"),
        ({"tank": Tank(x=1.2, y=2.0, radius_m=0.5), "start": Start(x=3.0, y=2.0)}, "start"),
        ({"start": Start(x=3.7, y=2.0)}, "start"),
        ({"walls": (Wall(begin=(1.0, 1.0), end=(5.0, 1.0)),)}, r"walls\[0\].end.x"),
        ({"obstacles": (BALL.model_copy(update={"z": 0.05}),)}, r"obstacles\[0\].tether"),
    ],
)
def test_a_faulty_structure_is_named(changes, field):
    with pytest.raises(InputError, match=field):
        check_world(pool(**changes), "pool.yaml")


def test_a_wall_without_length_is_refused():
    with pytest.raises(ValueError, match="different places"):
        Wall(begin=(1.0, 1.0), end=(1.0, 1.0))
