"""What is left to explore of a half explored box of 20 x 20 m, the robot in its middle."""

import math

import numpy as np
import pytest

from coral.reef.decide.outlook import Outlook
from coral.reef.decide.survey import SurveyCfg, idle_water, survey
from coral.reef.map.belief import Belief
from coral.reef.map.chain import Component
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.map.mapping import OccupancyMap
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose

HERE = Pose(10.0, 10.0, 0.0)


def known_west_of(x_m, pose=HERE, clusters=()):
    belief = Belief(OccupancyMap((20.0, 20.0), CameraCfg()))
    belief.pose = pose
    belief.map.explored[:, : round(x_m / 0.05)] = True
    belief.tracker.update([Component(x=x, y=y, area_px=200, length_m=1.0) for x, y in clusters])
    return belief


def left(belief, **changes):
    return survey(Outlook.now(belief), CostFieldCfg(), 1.0, SurveyCfg(**changes))


def test_frontiers_lie_on_the_border_of_the_known_and_shadows_are_ignored():
    belief = known_west_of(15.0)
    belief.map.explored[100:110, 100:110] = False
    found = left(belief).frontiers
    assert found
    assert all(abs(f.x - 15.0) < 0.3 for f in found)


def test_walled_off_water_is_no_frontier():
    belief = known_west_of(15.0)
    belief.map.obstacle[:, 280:284] = True
    assert left(belief).frontiers == ()


def test_frontiers_say_how_far_and_in_which_direction_they_lie():
    for heading, bearing in ((0.0, 0.0), (0.5 * math.pi, -0.5 * math.pi)):
        first, *others = left(known_west_of(15.0, Pose(10.0, 10.0, heading))).frontiers
        assert first.path_m == pytest.approx(5.0, abs=0.5)
        assert first.bearing == pytest.approx(bearing, abs=0.3)
        assert [f.path_m for f in others] == sorted(f.path_m for f in others)
        assert min(f.path_m for f in others) >= first.path_m


def test_half_of_the_water_about_a_frontier_is_unexplored():
    first = left(known_west_of(15.0)).frontiers[0]
    assert first.unexplored == pytest.approx(0.5, abs=0.1)


def test_distance_to_the_reef_is_that_to_the_nearest_known_cluster():
    assert math.isinf(left(known_west_of(15.0)).frontiers[0].reef_m)
    for f in left(known_west_of(15.0, clusters=[(12.0, 10.0), (12.0, 2.0)])).frontiers:
        assert f.reef_m == pytest.approx(min(math.dist((f.x, f.y), (12.0, y)) for y in (10.0, 2.0)))


def test_a_map_known_throughout_has_no_frontier_and_is_a_dead_end():
    found = left(known_west_of(20.0))
    assert found.frontiers == ()
    assert found.dead_end


def test_what_failed_too_often_is_no_frontier_any_more():
    belief = known_west_of(15.0)
    first = left(belief).frontiers[0]
    belief.goal = (first.x, first.y)
    for _ in range(belief.cfg.max_attempts):
        belief.goal_failed()
    assert all(math.dist((f.x, f.y), belief.goal) > 0.5 for f in left(belief).frontiers)


def test_ways_lead_around_walls_and_nowhere_through():
    belief = known_west_of(20.0)
    belief.map.obstacle[:300, 240:244] = True  # from the lower edge up to 15 m
    found = left(belief)
    around = math.dist((10, 10), (12.1, 15.4)) + math.dist((12.1, 15.4), (14, 10))
    assert around - 0.3 < found.path_m(14.0, 10.0) < around + 2.5
    assert found.path_m(8.0, 10.0) == pytest.approx(2.0, abs=0.2)
    belief.map.obstacle[:, 240:244] = True
    closed = left(belief)
    assert math.isinf(closed.path_m(14.0, 10.0))
    assert np.isinf(closed.field.lengths(np.array([8.0, 14.0]), np.array([10.0, 10.0]))).tolist() == [False, True]


def test_small_pieces_of_unexplored_water_and_the_rim_are_idle():
    belief = known_west_of(20.0)
    belief.map.explored[100:110, 100:110] = False  # half a metre wide
    belief.map.explored[200:300, 300:] = False
    idle = idle_water(belief.map, SurveyCfg())
    assert idle[105, 105]
    assert not idle[250, 350]
    assert idle[250, 395]  # the outermost half metre
    assert not idle[50, 50]  # explored
