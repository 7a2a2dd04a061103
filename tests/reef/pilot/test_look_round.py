"""What doubtful obstacles fence in: a turn on the spot, then the way through them, then the end."""

import math

import numpy as np
import pytest

from coral.reef.map.belief import Belief
from coral.reef.map.mapping import OccupancyMap
from coral.reef.map.sight_layer import SightLayer, SightLayerCfg
from coral.reef.pilot import look_round
from coral.reef.pilot.look_round import LookRound
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose

WALL = np.s_[:, 150:152]


def fenced(sure=False):
    """A belief with a wall across the map, of obstacles that were seen from afar."""
    belief = Belief(OccupancyMap((10.0, 10.0), CameraCfg()))
    cells = belief.map
    wall = np.zeros(cells.obstacle.shape, np.bool_)
    wall[WALL] = True
    cells.sight = SightLayer(wall.copy(), cells.cfg.cell_m, cells.camera, 2.3, SightLayerCfg())
    cells.sight._sure[:] = sure
    cells.obstacle |= wall
    belief.pose = Pose(3.0, 5.0, 0.5)
    return belief


def shut(belief):
    return bool(belief.map.obstacle[WALL].any())


def test_it_turns_once_round_then_forgets_the_doubtful_obstacles_then_gives_up():
    belief = fenced()
    look = LookRound(belief)
    assert look.command() is None
    assert look.step(shut) == "turn"
    turned = 0.0
    while (command := look.command()) is not None:
        assert command == (0.0, look_round.YAW_RATE_RAD_S)
        belief.pose = belief.pose._replace(theta=math.remainder(belief.pose.theta + 0.05, math.tau))
        turned += 0.05
    assert turned == pytest.approx(math.tau, abs=0.06)
    assert shut(belief)
    assert look.step(shut) == "forget"
    assert not shut(belief)
    assert look.step(shut) is None


@pytest.mark.parametrize("angle", [-7.0, 9.0])
def test_it_turns_by_an_angle_beyond_a_whole_turn_on_either_side(angle):
    belief = fenced()
    look = LookRound(belief)
    look.turn(angle)
    turned, step = 0.0, math.copysign(0.05, angle)
    while look.turning and (command := look.command()) is not None:
        assert command == (0.0, math.copysign(look_round.YAW_RATE_RAD_S, angle))
        belief.pose = belief.pose._replace(theta=math.remainder(belief.pose.theta + step, math.tau))
        turned += step
    assert turned == pytest.approx(angle, abs=0.06)


def test_the_map_is_sure_where_obstacles_are_or_where_nothing_lies_beyond_them():
    assert LookRound(fenced(sure=True)).step(shut) is None
    assert LookRound(fenced()).step(lambda belief: True) is None
    assert LookRound(Belief(OccupancyMap((10.0, 10.0), CameraCfg()))).step(shut) is None


def test_what_it_asks_about_is_a_copy():
    belief = fenced()
    assert LookRound(belief).step(lambda other: shut(other) or not shut(belief)) == "turn"


def test_another_place_is_worth_another_turn_but_not_for_ever(monkeypatch):
    monkeypatch.setattr(look_round, "MOST_TURNS", 2)
    belief = fenced()
    look = LookRound(belief)
    assert look.step(shut) == "turn"
    belief.pose = Pose(4.5, 5.0, 0.0)
    assert look.step(shut) == "turn"
    belief.pose = Pose(6.0, 5.0, 0.0)
    assert look.step(shut) is None
